//! The places of axes other than X, Y and Z.

/// The axes that are not followed.
pub(crate) const OTHERS: [u8; 6] = *b"ABCUVW";

/// The places of the other axes, in the units of the program.
#[derive(Default)]
pub(crate) struct OtherAxes {
    pub(crate) rotary: [Option<f64>; OTHERS.len()],
    /// The filament that has been pushed, in mm.
    pub(crate) extruder_mm: f64,
    /// M83: E counts from its present place.
    pub(crate) is_relative: bool,
    /// Words of a printer have been met.
    pub(crate) is_printer: bool,
}
