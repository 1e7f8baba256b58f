//! Corner smoothing: in a path of straight moves and arcs, one trigonometric segment replaces each corner.
//!
//! At a corner in B the direction turns by φ, from `t_1` to `t_2`. A segment that joins the moves smoothly is given by
//! its ends and by its derivatives there, along `t_1` and `t_2`, with k = -1 and λ = 1. Only with these factors is the
//! segment symmetric, so that the error is the same in both directions of travel. Other λ, and the best λ of each
//! corner, are in `corner_shape`: their segments are not symmetric.
//!
//! **The cut** leaves the incoming move at a distance d before B, and meets the outgoing move at d behind B:
//!
//! `q_0 = B - d t_1`, `q_1 = B + d t_2`, `D_0 = m d t_1`, `D_1 = m d t_2`.
//!
//! It comes nearest to B in the middle, where `H_00 = 1/2` and `H_10 = -H_11 = η`, `η = (√2 - 1)/π`. Its distance
//! there, the corner error, is
//!
//! `ε = d sin(φ/2) (1 - 2 η m)`,
//!
//! so the distance d for a given error is known. The length m of the end derivatives is free. The longest curve is not
//! the best. The feed on a bend follows from its curvature, so m is taken where the product of greatest curvature and
//! error is least. For φ = 90° that is π/2, the quarter circle. At other angles the product is within 21 % of that of a
//! circular arc tangent to both moves.
//!
//! **The loop** leaves the first move in B itself, turns round outside, and comes back to B along the second move:
//!
//! `q_0 = q_1 = B`, `D_0 = ℓ t_1`, `D_1 = ℓ t_2`.
//!
//! The corner stays sharp and both moves stay whole. The path is longer, and at 90° the curvature is twelve times that
//! of a cut of the same error. The loop begins and ends with curvature 0.
//!
//! Two corners share each move: each may take half of the move, and more where the other needs less.

/// How a corner is smoothed.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum CornerStyle {
    /// Cut off, on the inside.
    Cut,
    /// Passed in a loop on the outside, which leaves the corner and comes back to it.
    Loop,
}

/// A place where two moves meet.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Turn<const D: usize> {
    /// Index of the incoming move.
    pub before: usize,
    /// Index of the outgoing move: the next that has a length.
    pub after: usize,
    /// The corner B.
    pub point: [f64; D],
    /// φ, the angle by which the direction turns, in rad, from 0 to π.
    pub turn_rad: f64,
}

/// A corner and its outcome.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Corner<const D: usize> {
    /// Where the corner is, and by how much it turns.
    pub turn: Turn<D>,
    /// Whether it was smoothed.
    pub outcome: CornerOutcome,
}

/// Whether a corner was smoothed.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum CornerOutcome {
    /// A segment replaces it.
    Smoothed {
        /// How.
        style: CornerStyle,
        /// Index of the segment among the curves of the smooth path.
        curve: usize,
        /// Largest distance between the segment and the part of the moves that it replaces, measured both ways, in mm.
        error_mm: f64,
        /// The segment's shape factor λ.
        lambda: f64,
    },
    /// It stays as it is.
    Left(Reason),
}

/// Why a corner stays as it is.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub enum Reason {
    /// The moves join smoothly: there is no corner to smooth.
    Tangent,
    /// The path turns back on itself, by more than 170°: any path there almost stops.
    Reversal,
    /// The outgoing move does not begin where the incoming one ends.
    NotJoined,
    /// A neighbour is neither a line nor an arc.
    NotLineOrArc,
    /// No segment within the tolerance was found: the moves are too short, or an arc bends too much.
    NoRoom,
    /// The caller asked to leave it.
    Wanted,
}

impl core::fmt::Display for Reason {
    fn fmt(&self, f: &mut core::fmt::Formatter<'_>) -> core::fmt::Result {
        f.write_str(match self {
            Self::Tangent => "smooth as it is",
            Self::Reversal => "turns back on itself",
            Self::NotJoined => "moves do not meet",
            Self::NotLineOrArc => "next to a spline",
            Self::NoRoom => "no room within the tolerance",
            Self::Wanted => "to be left",
        })
    }
}
