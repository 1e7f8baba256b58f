//! Reasons why a part is not smoothed, or not written.

use std::error::Error;
use std::fmt;

use format_compare::Refusal;
use nurbs_core::{CompileError, CurveError, ShapeError};
use part_program::{Diagnostics, WriteError};

/// Why a part is not smoothed.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub enum SmoothError {
    /// The tolerance, in mm, is not a positive length.
    Tolerance(f64),
    /// The shape factor λ of corners is not from -2 to 2.
    Lambda(f64),
    /// Moves from rest to rest cannot be smoothed, planned or run.
    Moves {
        /// Name of the part.
        part: String,
        /// Line of the first move.
        line: usize,
        /// The reason.
        error: Box<SmoothError>,
    },
    /// A curve of the part is not valid.
    Curve(CurveError),
    /// The shape of a move or a corner cannot be computed.
    Shape(ShapeError),
    /// The path cannot be planned or run in f64.
    Refused(Refusal),
    /// A corner cannot be compiled to pieces.
    Compile(CompileError),
}

impl SmoothError {
    /// This error, for the moves of a part from a line on.
    pub(crate) fn of_moves(self, part: &str, line: usize) -> Self {
        Self::Moves { part: part.to_owned(), line, error: Box::new(self) }
    }
}

impl fmt::Display for SmoothError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Tolerance(tolerance_mm) => {
                write!(f, "the tolerance is {tolerance_mm}: expected a positive length in mm")
            }
            Self::Lambda(lambda) => {
                write!(f, "the shape factor is {lambda}: expected a number from -2 to 2")
            }
            Self::Moves { part, line, .. } => write!(f, "{part}: the moves from line {line} on"),
            Self::Curve(error) => error.fmt(f),
            Self::Shape(error) => error.fmt(f),
            Self::Refused(error) => error.fmt(f),
            Self::Compile(error) => error.fmt(f),
        }
    }
}

impl Error for SmoothError {
    fn source(&self) -> Option<&(dyn Error + 'static)> {
        match self {
            Self::Tolerance(_) | Self::Lambda(_) => None,
            Self::Moves { error, .. } => Some(error.as_ref()),
            Self::Curve(error) => error.source(),
            Self::Shape(error) => error.source(),
            Self::Refused(error) => error.source(),
            Self::Compile(error) => error.source(),
        }
    }
}

impl From<CurveError> for SmoothError {
    fn from(error: CurveError) -> Self {
        Self::Curve(error)
    }
}

impl From<ShapeError> for SmoothError {
    fn from(error: ShapeError) -> Self {
        Self::Shape(error)
    }
}

impl From<Refusal> for SmoothError {
    fn from(error: Refusal) -> Self {
        Self::Refused(error)
    }
}

impl From<CompileError> for SmoothError {
    fn from(error: CompileError) -> Self {
        Self::Compile(error)
    }
}

/// Why a smoothed path is not written as a program.
#[derive(Debug)]
#[non_exhaustive]
pub enum ProgramError {
    /// The program cannot be written: it has too many chords, or it is too long.
    Write(WriteError),
    /// The program has faults when it is read back.
    ReadBack(Diagnostics),
    /// The program is another path when it is read back.
    AnotherPath {
        /// Line of the part's first move that differs.
        line: usize,
    },
    /// A curve is not valid when it is read back.
    Curve(CurveError),
}

impl fmt::Display for ProgramError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Write(error) => error.fmt(f),
            Self::ReadBack(_) => f.write_str("what was written does not read back: nothing is kept"),
            Self::AnotherPath { line } => {
                write!(f, "line {line}: the path that reads back is another one: nothing is kept")
            }
            Self::Curve(error) => error.fmt(f),
        }
    }
}

impl Error for ProgramError {
    fn source(&self) -> Option<&(dyn Error + 'static)> {
        match self {
            Self::Write(error) => error.source(),
            Self::ReadBack(faults) => Some(faults),
            Self::AnotherPath { .. } => None,
            Self::Curve(error) => error.source(),
        }
    }
}

impl From<WriteError> for ProgramError {
    fn from(error: WriteError) -> Self {
        Self::Write(error)
    }
}

impl From<CurveError> for ProgramError {
    fn from(error: CurveError) -> Self {
        Self::Curve(error)
    }
}
