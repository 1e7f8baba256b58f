//! How corners are to be smoothed.

use nurbs_core::{CornerLambda, CornerStyle};

/// The tolerance, and the wanted form of outer corners.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Options {
    /// Largest distance between the smoothed path and the part's moves, both ways, in mm; above 0.
    pub tolerance_mm: f64,
    /// The form of outer corners, which turn in the same sense as their outline: a loop around the corner, or a cut
    /// like the others. Corners of less than [`LEAST_LOOPED_DEG`](crate::LEAST_LOOPED_DEG) are always cut.
    pub outer: CornerStyle,
    /// The shape factor λ of the corners' splines. With [`CornerLambda::Auto`] each corner has the λ of the greatest
    /// least radius, and a stretch that is slower with it has λ = 1.
    pub lambda: CornerLambda,
}
