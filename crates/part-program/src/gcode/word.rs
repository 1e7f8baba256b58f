//! Words: their addresses and their numbers.

use crate::source::Span;

/// The address of a word.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Key {
    /// A letter, in upper case.
    Letter(u8),
    /// `BSPLINE`, which has no number.
    Bspline,
    /// `TRANS`, and `ATRANS`, which adds: a shift of the coordinates.
    Trans { adds: bool },
    /// `ROT`, `SCALE`, `MIRROR` and what adds to them, or replaces them: turned and scaled coordinates.
    Frame { adds: bool },
    /// `SD=`, spline degree.
    SplineDegree,
    /// `PW=`, point weight.
    PointWeight,
    /// `PL=`, parameter interval length.
    IntervalLength,
    /// `CR=`, circle radius.
    CircleRadius,
    /// `,R` or `RND=`: the radius of the corner behind the move.
    CornerRadius,
    /// `,C` or `CHR=`: the length of the corner that is cut off.
    CornerDistance,
}

/// The addresses that are names.
pub(super) const NAMES: [(&str, Key); 15] = [
    ("BSPLINE", Key::Bspline),
    ("TRANS", Key::Trans { adds: false }),
    ("ATRANS", Key::Trans { adds: true }),
    ("ROT", Key::Frame { adds: false }),
    ("AROT", Key::Frame { adds: true }),
    ("SCALE", Key::Frame { adds: false }),
    ("ASCALE", Key::Frame { adds: true }),
    ("MIRROR", Key::Frame { adds: false }),
    ("AMIRROR", Key::Frame { adds: true }),
    ("SD", Key::SplineDegree),
    ("PW", Key::PointWeight),
    ("PL", Key::IntervalLength),
    ("CR", Key::CircleRadius),
    ("RND", Key::CornerRadius),
    ("CHR", Key::CornerDistance),
];

/// A word: its address, its number and its place.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Word {
    pub(crate) key: Key,
    pub(crate) value: f64,
    pub(crate) span: Span,
}

impl Key {
    /// Whether it is a name without a number.
    pub(super) fn is_command(self) -> bool {
        matches!(self, Self::Bspline | Self::Trans { .. } | Self::Frame { .. })
    }
}
