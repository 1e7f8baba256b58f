//! Why a kernel cannot be judged at all.

use std::fmt;

use crate::ended::Ended;
use crate::input::InputError;

/// The fault of a kernel or of a request.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub enum Refusal {
    /// An input is wrong.
    Input(InputError),
    /// A column has another number of values than there are steps.
    Length {
        /// The input, or the output whose right values these are.
        what: String,
        /// Number of values.
        found: usize,
        /// Number of steps.
        steps: usize,
    },
    /// Number of steps.
    Steps(usize),
    /// An output has no requirement, or a limit that is no number or below 0.
    Requirement(&'static str),
    /// Two inputs or two outputs have the same name.
    TwiceNamed(&'static str),
    /// The kernel has no output.
    NoOutput,
    /// The run in double-double did not end as it must.
    Reference(Ended),
    /// A format that is not known.
    Format(String),
    /// What is wrong with an earlier comparison.
    Baseline(String),
    /// The kernel cannot be run in the format.
    Run(String, Ended),
}

/// Most steps of a run.
pub(crate) const MOST_STEPS: usize = 1 << 24;

impl fmt::Display for Refusal {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Input(error) => error.fmt(f),
            Self::Length { what, found, steps } => {
                write!(f, "{what} has {found} values: expected {steps}, one for each step")
            }
            Self::Steps(steps) => write!(f, "{steps} steps: expected from 1 to {MOST_STEPS}"),
            Self::Requirement(output) => write!(
                f,
                "output {output}: expected at least one requirement, and limits that are finite and not below 0"
            ),
            Self::TwiceNamed(name) => write!(f, "{name} is named twice: expected a name of its own for each"),
            Self::NoOutput => f.write_str("no output: expected at least one"),
            Self::Reference(ended) => write!(f, "in double-double, which is the reference, {ended}"),
            Self::Format(name) => write!(
                f,
                "unknown format {name:?}: expected f32, f64, or fixed point of 3 to 64 bits as I5F13, with at least 2 before the point"
            ),
            Self::Baseline(what) => write!(f, "the baseline: {what}"),
            Self::Run(format, ended) => write!(f, "in {format} {ended}"),
        }
    }
}

impl std::error::Error for Refusal {}

impl From<InputError> for Refusal {
    fn from(error: InputError) -> Self {
        Self::Input(error)
    }
}
