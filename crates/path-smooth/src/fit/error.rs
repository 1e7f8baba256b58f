//! Reasons why no curves are fitted.

use std::error::Error;
use std::fmt;

use nurbs_core::InterpolationError;

use crate::fit::options::FitOptions;
use crate::fit::run::LEAST_MOVES;

/// Why no curves are fitted.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub enum FitError {
    /// The tolerance, in mm, is not a positive length.
    Tolerance(f64),
    /// The least corner, in degrees, is not above 0 and at most 90.
    Corner(f64),
    /// No run of moves becomes a curve.
    NothingToFit {
        /// The straight moves at feed.
        straight_moves: usize,
        /// The most moves of a run.
        longest_run: usize,
        /// What was asked.
        options: FitOptions,
    },
    /// The points of a run make no curve.
    Run {
        /// Name of the part.
        part: String,
        /// Line of the run's first move.
        line: usize,
        /// The reason.
        error: InterpolationError,
    },
}

impl fmt::Display for FitError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Tolerance(tolerance_mm) => {
                write!(f, "the tolerance is {tolerance_mm}: expected a positive length in mm")
            }
            Self::Corner(degrees) => {
                write!(f, "the least corner is {degrees}: expected degrees above 0, at most 90")
            }
            Self::NothingToFit { straight_moves: 0, .. } => {
                f.write_str("no curve is made: there are no straight moves at feed")
            }
            Self::NothingToFit { straight_moves, longest_run, .. } if *longest_run < LEAST_MOVES => write!(
                f,
                "no curve is made of {straight_moves} straight moves: from one corner, rest or change of feed to the next \
                 there are {longest_run} at most, and a curve takes {LEAST_MOVES}"
            ),
            Self::NothingToFit { straight_moves, options, .. } => write!(
                f,
                "no curve is made of {straight_moves} straight moves: those without a corner above {}° are straight on, or \
                 no curve through their ends keeps within {} mm of them",
                options.corner_deg, options.tolerance_mm
            ),
            Self::Run { part, line, .. } => write!(f, "{part}: the moves from line {line} on"),
        }
    }
}

impl Error for FitError {
    fn source(&self) -> Option<&(dyn Error + 'static)> {
        match self {
            Self::Run { error, .. } => Some(error),
            Self::Tolerance(_) | Self::Corner(_) | Self::NothingToFit { .. } => None,
        }
    }
}
