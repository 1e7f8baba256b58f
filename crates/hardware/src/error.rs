//! Why a part does not become a core.

use std::fmt;

/// Why a part does not become a core.
#[derive(Clone, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub enum CoreError {
    /// The text is not what the front end reads.
    Syntax {
        /// The line of the C file, from 1.
        line: u32,
        /// What stands there.
        found: String,
        /// What is expected.
        expected: &'static str,
    },
    /// The construct is outside the subset of C.
    NotInSubset {
        /// The line of the C file, from 1.
        line: u32,
        /// The construct.
        what: String,
    },
    /// The core has no room.
    TooMany {
        /// Of what.
        what: &'static str,
        /// How many are needed.
        needed: usize,
        /// How many there are.
        most: usize,
    },
    /// The core has no such width.
    Width {
        /// Bits of a number.
        bits: u32,
    },
    /// The part asks for a step that the core has not.
    NoStep {
        /// Its name.
        what: &'static str,
    },
    /// The run is not that of the kernels: a fault of this crate.
    Differs {
        /// Its setpoints.
        periods: usize,
        /// The checksum of their positions.
        checksum: u64,
    },
    /// A run of the program comes to no end.
    Endless {
        /// Steps after which it was given up.
        steps: u64,
    },
}

impl CoreError {
    /// A construct outside the subset.
    pub(crate) fn subset(line: u32, what: impl Into<String>) -> Self {
        Self::NotInSubset { line, what: what.into() }
    }
}

impl fmt::Display for CoreError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Syntax { line, found, expected } => {
                write!(f, "line {line} of the C: found {found}, expected {expected}")
            }
            Self::NotInSubset { line, what } => write!(f, "line {line} of the C: the core has no {what}"),
            Self::TooMany { what, needed, most } => {
                write!(f, "the part takes {needed} {what}, and the core has {most}")
            }
            Self::Width { bits } => {
                write!(f, "numbers of {bits} bits: the core has 16 to 32 bits, fixed point")
            }
            Self::NoStep { what } => write!(f, "the core has no {what}"),
            Self::Differs { periods, checksum } => {
                write!(
                    f,
                    "the core's run of {periods} periods, checksum {checksum:#018x}, is not the part's: please report it"
                )
            }
            Self::Endless { steps } => write!(f, "the run is not over after {steps} operations"),
        }
    }
}

impl std::error::Error for CoreError {}
