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
    Trans {
        adds: bool,
    },
    /// `ROT`, `SCALE`, `MIRROR` and what adds to them, or replaces them: turned and scaled coordinates.
    Frame {
        adds: bool,
    },
    /// `SD=`, spline degree.
    SplineDegree,
    /// `PW=`, point weight.
    PointWeight,
    /// `PL=`, parameter interval length.
    IntervalLength,
    /// `CIP`, an arc through a point, and `CT`, one that is tangent to the move before.
    ThroughPoint,
    Tangent,
    /// `I1=`, `J1=` and `K1=`: the point that CIP passes, by its axis.
    Middle(usize),
    /// `TURN=`: full turns beside those that reach the end.
    Turns,
    /// `AR=`: the angle of an arc, in degrees.
    ArcAngle,
    /// `CHF=`: the length of the line that cuts the corner off.
    Chamfer,
    /// `CR=`, circle radius.
    CircleRadius,
    /// `,R` or `RND=`: the radius of the corner behind the move.
    CornerRadius,
    /// `,C` or `CHR=`: the length of the corner that is cut off.
    CornerDistance,
}

/// The addresses that are names.
pub(super) const NAMES: [(&str, Key); 20] = [
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
    ("CIP", Key::ThroughPoint),
    ("CT", Key::Tangent),
    ("TURN", Key::Turns),
    ("AR", Key::ArcAngle),
    ("CHF", Key::Chamfer),
    ("RND", Key::CornerRadius),
    ("CHR", Key::CornerDistance),
];

/// A word: its address, its number and its place.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Word {
    pub(crate) key: Key,
    pub(crate) value: f64,
    pub(crate) span: Span,
    /// Where the number counts from, whatever G90 or G91 says.
    pub(crate) count: Option<Count>,
}

/// Where a coordinate counts from: `X=AC(5)` from 0, `X=IC(5)` from the place of the tool.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Count {
    Absolute,
    Incremental,
}

/// Names of Siemens that leave the path as it is: messages, the preprocessing of blocks, how axes are accelerated, where F
/// holds on arcs, the sides of a compensation that is off, and the graphics of a simulation.
pub(super) const PASSED: [&str; 40] = [
    "BRISK",
    "BRISKA",
    "CFC",
    "CFIN",
    "CFTCP",
    "COMPOF",
    "CUT2D",
    "CUT2DF",
    "CUT3DC",
    "CUT3DF",
    "CUT3DFF",
    "CUT3DFS",
    "DIAMOF",
    "DISPLOF",
    "DISPLON",
    "DRIVE",
    "DRIVEA",
    "FFWOF",
    "FFWON",
    "FIFOCTRL",
    "GROUP_BEGIN",
    "GROUP_END",
    "KONT",
    "KONTC",
    "KONTT",
    "MSG",
    "NORM",
    "ORIAXES",
    "ORIMKS",
    "ORIWKS",
    "PROC",
    "SAVE",
    "SETMS",
    "SOFT",
    "SOFTA",
    "STOPRE",
    "TOROTOF",
    "TRAFOOF",
    "WALIMOF",
    "WALIMON",
];
/// Names of Siemens that let the path be another within a tolerance.
pub(super) const COMPRESSORS: [&str; 5] = ["COMPCAD", "COMPCURV", "COMPON", "COMPSURF", "CYCLE832"];

impl Key {
    /// Whether it is a name without a number.
    pub(super) fn is_command(self) -> bool {
        matches!(
            self,
            Self::Bspline | Self::ThroughPoint | Self::Tangent | Self::Trans { .. } | Self::Frame { .. }
        )
    }
}

/// M17, which ends a program of Siemens as RET does.
pub(super) const END_OF_SUBPROGRAM: f64 = 17.0;
