//! Units of length.

/// Millimetres of an inch.
pub(crate) const INCH: f64 = 25.4;
