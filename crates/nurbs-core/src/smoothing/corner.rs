//! Corner smoothing: a path of straight moves and arcs, each corner replaced by one trigonometric segment.
//!
//! At a corner in B the direction turns by φ, from `t_1` to `t_2`. A segment that joins the moves smoothly is given by its ends
//! and the derivatives there, along `t_1` and `t_2`, with k = -1 and λ = 1: only then is it symmetric, and the error the same
//! whichever way the path is followed.
//!
//! **The cut** leaves the incoming move at a distance d before B, and meets the outgoing one at d behind it:
//!
//! `q_0 = B - d t_1`, `q_1 = B + d t_2`, `D_0 = m d t_1`, `D_1 = m d t_2`.
//!
//! It comes nearest to B in the middle, where `H_00 = 1/2` and `H_10 = -H_11 = η`, `η = (√2 - 1)/π`; there its distance, the
//! corner error, is
//!
//! `ε = d sin(φ/2) (1 - 2 η m)`,
//!
//! so the distance for a given error is known. What is left is m, the length of the end derivatives. The longest curve is not
//! the best; the feed on a bend follows from its curvature, so m is taken where the product of greatest curvature and error is
//! least: for φ = 90° that is π/2, the quarter circle, and elsewhere it comes within 21 % of a circle's, which no tangent arc
//! betters.
//!
//! **The loop** leaves B itself along the first move, turns round outside, and comes back to B along the second:
//!
//! `q_0 = q_1 = B`, `D_0 = ℓ t_1`, `D_1 = ℓ t_2`.
//!
//! The corner stays sharp and both moves whole; the way is longer, and the curvature twelve times that of a cut of the same error at
//! 90°. It begins and ends with curvature 0.
//!
//! Two corners share each move: each may take half of it, and more where the other needs less.

/// How a corner is smoothed.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum CornerStyle {
    /// Cut off, on the inside.
    Cut,
    /// Left and met again in a loop, on the outside.
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

/// What became of a corner.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Corner<const D: usize> {
    /// Where it is, and how sharp.
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
        /// Distance between the segment and what it replaces: largest one both ways, in mm.
        error_mm: f64,
    },
    /// It stays as it is.
    Left(Reason),
}

/// Why a corner stays as it is.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub enum Reason {
    /// The moves join smoothly: there is no corner.
    Tangent,
    /// The path turns back on itself, by more than 170°: whatever passes there all but stops.
    Reversal,
    /// The outgoing move does not begin where the incoming one ends.
    NotJoined,
    /// A neighbour is neither a line nor an arc.
    NotLineOrArc,
    /// No segment within the tolerance was found: the moves are too short, or an arc bends too much.
    NoRoom,
    /// The caller wants it so.
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
