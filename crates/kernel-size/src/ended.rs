//! How a run ended.

use std::fmt;

use serde::Serialize;

/// How a run ended. Steps are numbered from 0.
#[derive(Clone, Debug, PartialEq, Serialize)]
#[serde(rename_all = "snake_case", tag = "how")]
#[non_exhaustive]
pub enum Ended {
    /// After its last step.
    Finished,
    /// Ended from outside, since nothing more was to be learnt from it.
    Enough,
    /// An input or a constant does not fit the format.
    DoesNotFit {
        /// Its name.
        signal: &'static str,
        /// The step.
        step: usize,
        /// Its value.
        value: f64,
    },
    /// An output is infinite, or no number.
    NotFinite {
        /// Its name.
        output: &'static str,
        /// The step.
        step: usize,
    },
    /// The kernel panicked.
    Panicked {
        /// The step.
        step: usize,
        /// What it said.
        message: String,
    },
    /// The kernel returned while there were steps left.
    Early {
        /// The first step that was not run.
        step: usize,
    },
    /// The kernel did not keep to its inputs and outputs.
    Misused {
        /// The step.
        step: usize,
        /// What was found, and what was expected.
        what: String,
    },
}

impl Ended {
    /// The step in which a run ended that is not finished.
    #[must_use]
    pub fn step(&self) -> Option<usize> {
        match self {
            Self::Finished | Self::Enough => None,
            Self::DoesNotFit { step, .. }
            | Self::NotFinite { step, .. }
            | Self::Panicked { step, .. }
            | Self::Early { step }
            | Self::Misused { step, .. } => Some(*step),
        }
    }
}

impl fmt::Display for Ended {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Finished => f.write_str("the run is finished"),
            Self::Enough => f.write_str("the run was ended early"),
            Self::DoesNotFit { signal, step, value } => {
                write!(f, "{signal} = {value} in step {step} does not fit the format")
            }
            Self::NotFinite { output, step } => {
                write!(f, "output {output} is no finite number in step {step}")
            }
            Self::Panicked { step, message } => write!(f, "the kernel panics in step {step}: {message}"),
            Self::Early { step } => {
                write!(f, "the kernel returns before step {step}: expected it to run all steps")
            }
            Self::Misused { step, what } => write!(f, "in step {step} {what}"),
        }
    }
}
