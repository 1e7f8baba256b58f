//! Which tool cuts.

/// The tool in the spindle, and what names one.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct ToolInUse {
    /// The last T.
    pub(crate) prepared: Option<f64>,
    /// The T of the last M6.
    pub(crate) loaded: Option<f64>,
    /// The last D of a block without G41 or G42, of a control that is not named.
    pub(crate) offset: Option<f64>,
}
