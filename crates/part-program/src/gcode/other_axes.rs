//! The places of axes other than X, Y and Z.

/// The axes that are not followed.
pub(crate) const OTHERS: [u8; 6] = *b"ABCUVW";

/// The feed of a printer, which M220 scales.
pub(crate) struct ScaledFeed {
    /// The last F of G94.
    pub(crate) commanded_mm_per_s: Option<f64>,
    /// What moves take of it.
    pub(crate) scale: f64,
    /// The scale that `M220 R` brings back.
    pub(crate) kept_scale: f64,
}

impl Default for ScaledFeed {
    fn default() -> Self {
        Self { commanded_mm_per_s: None, scale: 1.0, kept_scale: 1.0 }
    }
}

/// The places of the other axes, in the units of the program.
#[derive(Default)]
pub(crate) struct OtherAxes {
    pub(crate) feed: ScaledFeed,
    pub(crate) rotary: [Option<f64>; OTHERS.len()],
    /// The filament that has been pushed, in mm.
    pub(crate) extruder_mm: f64,
    /// M83: E counts from its present place.
    pub(crate) is_relative: bool,
    /// Words of a printer have been met.
    pub(crate) is_printer: bool,
}
