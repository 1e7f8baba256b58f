//! Why a part is not run in a format.

use std::fmt;

use c_code::CError;
use feed_plan::PlanError;
use nurbs_core::{CompileError, CurveError};
use real::FormatName;
use secant_interp::NoStream;

/// Why a part is not run in a format.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub enum Refusal {
    /// The curve does not fit the format, or is no valid curve after rounding.
    Curve(CurveError),
    /// A limit of the machine, in mm and periods, is beyond the format's range or rounds to zero.
    Limit {
        /// The limit.
        what: &'static str,
        /// Its value.
        value: f64,
        /// The format.
        format: FormatName,
    },
    /// No plan can be made in the format that was chosen for planning.
    PlanIn(FormatName, Box<Refusal>),
    /// No plan exists.
    Plan(PlanError),
    /// No plan leads along a move of the part.
    PlanAt {
        /// Name of the part.
        part: String,
        /// Line of the move.
        line: usize,
        /// The reason.
        error: PlanError,
    },
    /// The pieces do not fit the format.
    Compile(CompileError),
    /// A curve of the part cannot be compiled to pieces.
    CurveAt {
        /// Name of the part.
        part: String,
        /// Line of the move.
        line: usize,
        /// The reason.
        error: CompileError,
    },
    /// The interpolator with one global parameter runs a single curve; the path has so many.
    ManyCurves(usize),
    /// A plan through a window does not see what these axes beside the path leave for it.
    SideAxesInWindow(String),
    /// A controller has no type of this format.
    NoType(FormatName),
    /// C cannot hold the part.
    C(CError),
    /// The part is too long for a stream.
    Stream(NoStream),
    /// A section is longer than the buffer through which it is to be read.
    SectionTooLong {
        /// Name of the part.
        part: String,
        /// The lines of its first and its last move, if they are known.
        lines: Option<(usize, usize)>,
        /// The section, from 0.
        section: usize,
        /// Its bytes.
        bytes: u32,
        /// Bytes of the buffer.
        buffer: usize,
    },
    /// The run was given up.
    Unfinished {
        /// The periods after which it was given up.
        periods: usize,
        /// The format.
        format: FormatName,
    },
}

impl Refusal {
    /// Whether it says of which part it is, and where in it.
    #[must_use]
    pub fn names_its_place(&self) -> bool {
        match self {
            Self::CurveAt { .. } | Self::PlanAt { .. } | Self::SectionTooLong { .. } => true,
            Self::PlanIn(_, refusal) => refusal.names_its_place(),
            _ => false,
        }
    }
}

impl fmt::Display for Refusal {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Curve(error) => error.fmt(f),
            Self::Limit { what, value, format } => {
                write!(f, "{what} = {value:.3e} (mm, periods) is out of range or zero in {format}")
            }
            Self::PlanIn(format, refusal) => write!(f, "planning in {format}: {refusal}"),
            Self::Plan(error) => write!(f, "planning failed: {error}"),
            Self::PlanAt { part, line, error } => write!(f, "{part}:{line}: planning failed: {error}"),
            Self::Compile(error) => error.fmt(f),
            Self::CurveAt { part, line, error } => write!(f, "{part}:{line}: {error}"),
            Self::ManyCurves(count) => write!(f, "one global parameter runs one curve, not {count}"),
            Self::SideAxesInWindow(letters) => {
                write!(f, "{letters} beside the path: a plan through a window does not keep their limits")
            }
            Self::NoType(format) => {
                write!(f, "{format} is no type of a controller: expected a float, or 8, 16, 32 or 64 bits")
            }
            Self::C(error) => error.fmt(f),
            Self::Stream(error) => error.fmt(f),
            Self::SectionTooLong { part, lines, section, bytes, buffer } => {
                let too_long = format!("takes {bytes} bytes, and the buffer has {buffer}");
                match lines {
                    Some((line, last)) if line == last => {
                        write!(f, "{part}:{line}: section {section} {too_long}")
                    }
                    Some((from, to)) => {
                        write!(f, "{part}:{from}: section {section}, up to line {to}, {too_long}")
                    }
                    None => write!(f, "{part}: section {section} {too_long}"),
                }
            }
            Self::Unfinished { periods, format } => {
                write!(f, "the run in {format} is not at the end of the path after {periods} periods")
            }
        }
    }
}

impl std::error::Error for Refusal {}

impl From<CurveError> for Refusal {
    fn from(error: CurveError) -> Self {
        Self::Curve(error)
    }
}

impl From<PlanError> for Refusal {
    fn from(error: PlanError) -> Self {
        Self::Plan(error)
    }
}

impl From<CompileError> for Refusal {
    fn from(error: CompileError) -> Self {
        Self::Compile(error)
    }
}
