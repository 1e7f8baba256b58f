//! Where on its path a piece lies.

/// Where a piece lies on the path it was cut from.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Place {
    /// Index of the curve.
    pub curve: usize,
    /// The parameter at which the piece begins, as a sum of two floats.
    pub begin: (f64, f64),
    /// The parameter at which it ends.
    pub end: (f64, f64),
}

impl Place {
    /// By how much the parameter grows over the piece.
    pub(crate) fn width(&self) -> f64 {
        (self.end.0 - self.begin.0) + (self.end.1 - self.begin.1)
    }
}
