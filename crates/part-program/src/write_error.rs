//! Reasons why a part cannot be written as a program.

use std::fmt;

use crate::text_length::MAX_TEXT;

/// Most chords of one program.
pub(crate) const MAX_CHORDS: usize = 5_000_000;
/// Halvings of a span at most: 2²⁰ chords.
pub(crate) const MAX_HALVINGS: u32 = 20;

/// The reason why a part cannot be written.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub enum WriteError {
    /// G5.2 is planar, and the curve leaves its plane.
    NotPlanar {
        /// Index of the curve.
        curve: usize,
        /// Line of the move that it belongs to.
        line: usize,
    },
    /// A rapid move that is not straight.
    CurvedRapid {
        /// Index of the curve.
        curve: usize,
        /// Line of the move that it belongs to.
        line: usize,
    },
    /// The tolerance asks for more than 2²⁰ chords in one span.
    SpanTooFine {
        /// Index of the curve.
        curve: usize,
        /// Line of the move that it belongs to.
        line: usize,
    },
    /// The tolerance asks for more than five million chords.
    TooManyChords {
        /// A lower bound of the number of chords: counting ends beyond twenty million.
        needed: usize,
    },
    /// The program is longer than [`MAX_TEXT`], so that no reader of this crate takes it.
    TooLong {
        /// Its length.
        bytes: usize,
    },
}

impl fmt::Display for WriteError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::NotPlanar { line, .. } => {
                write!(f, "the curve of line {line} leaves its plane: G5.2 takes X and Y only")
            }
            Self::CurvedRapid { line, .. } => {
                write!(f, "the rapid move of line {line} is not straight: G0 is")
            }
            Self::SpanTooFine { line, .. } => {
                write!(
                    f,
                    "the tolerance takes more than 2^{MAX_HALVINGS} chords in a span of the curve of line {line}: "
                )?;
                f.write_str("give a larger one")
            }
            Self::TooManyChords { needed } => {
                write!(
                    f,
                    "the tolerance takes at least {needed} chords, and a program has at most {MAX_CHORDS}: "
                )?;
                f.write_str("give a larger one")
            }
            Self::TooLong { bytes } => {
                write!(f, "the program takes {bytes} bytes, and at most {MAX_TEXT} (64 MiB) are written")
            }
        }
    }
}

impl std::error::Error for WriteError {}
