//! Side axes: A, B and C, in degrees, and U, V and W, in mm, which move beside the path of X, Y and Z.

/// The letters of the side axes, in the order of all arrays of them.
pub const SIDE_AXES: [char; 6] = ['A', 'B', 'C', 'U', 'V', 'W'];

/// How the side axes move along a curve, or where they stand from its begin on.
///
/// Along the curve each moves evenly with the way: at the arc length s of a curve of length L it is at
/// `from + (to - from) s/L`. Turns are not taken out: 400° is one turn and 40° on.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SideMove {
    /// Number of the curve in the part.
    pub curve: usize,
    /// The places at the begin of the curve, in degrees and mm.
    pub from: [f64; 6],
    /// The places at its end, which hold until the next of these moves.
    pub to: [f64; 6],
}

impl SideMove {
    /// The side axes on their places from a curve on.
    pub(crate) fn standing(curve: usize, at: [f64; 6]) -> Self {
        Self { curve, from: at, to: at }
    }

    /// Whether an axis moves along the curve.
    #[must_use]
    pub fn moves(&self) -> bool {
        self.from != self.to
    }
}
