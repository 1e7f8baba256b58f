//! Why a path cannot be compiled.

use real::FormatName;

/// A path cannot be compiled for a format.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub enum CompileError {
    /// The limits are not positive and finite.
    LimitNotPositive {
        /// The limit.
        what: &'static str,
        /// Its value.
        value: f64,
    },
    /// A stop is NaN, or comes before the stop ahead of it in the list.
    StopOutOfOrder {
        /// Its index among the stops.
        index: usize,
    },
    /// All of the path stands still; or C' almost vanishes on the piece that begins at `parameter`, and the piece is
    /// too long to be left out. No step per chord exists there.
    Cusp {
        /// Index of the curve in the path.
        curve: usize,
        /// Where the piece begins.
        parameter: f64,
    },
    /// The speed |C'| or a coefficient is infinite or NaN in the computing type, or the format cannot hold the inverse
    /// of the speed. On the piece that begins at `parameter` weights are too far apart or too small, or the curve is
    /// too small or too large.
    SpeedOutOfRange {
        /// Index of the curve in the path.
        curve: usize,
        /// Where the piece begins.
        parameter: f64,
    },
    /// A number of the real-time step does not fit the format.
    DoesNotFit {
        /// The signal, by the name that an audit gives it.
        signal: &'static str,
        /// Its proven bound.
        bound: f64,
        /// Integer bits, the sign included, that it needs.
        integer_bits: u32,
        /// The format.
        format: FormatName,
    },
    /// A coordinate lies beyond the ±2²⁴ mm of a piece's origin.
    OriginOutOfRange {
        /// Index of the curve in the path.
        curve: usize,
    },
}

impl CompileError {
    /// Index of the curve at fault, if the error names one.
    #[must_use]
    pub fn curve(&self) -> Option<usize> {
        match *self {
            Self::Cusp { curve, .. }
            | Self::SpeedOutOfRange { curve, .. }
            | Self::OriginOutOfRange { curve } => Some(curve),
            Self::LimitNotPositive { .. } | Self::StopOutOfOrder { .. } | Self::DoesNotFit { .. } => None,
        }
    }
}

impl core::fmt::Display for CompileError {
    fn fmt(&self, f: &mut core::fmt::Formatter<'_>) -> core::fmt::Result {
        match self {
            Self::LimitNotPositive { what, value } => {
                write!(f, "{what} must be positive and finite, not {value}")
            }
            Self::StopOutOfOrder { index } => {
                write!(f, "stop {index} is not a number, or lies before the stop ahead of it in the list")
            }
            Self::Cusp { curve, parameter } => {
                write!(f, "curve {curve} does not move near u = {parameter}: its derivative vanishes there")
            }
            Self::SpeedOutOfRange { curve, parameter } => {
                write!(
                    f,
                    "the speed of curve {curve} near u = {parameter}, or its inverse, does not fit the format: weights are too \
                     far apart, or the curve is too small or too large"
                )
            }
            Self::DoesNotFit { signal, bound, integer_bits, format } => {
                write!(
                    f,
                    "the signal `{signal}` reaches {bound:.4} and needs {integer_bits} integer bits; {format} has fewer"
                )
            }
            Self::OriginOutOfRange { curve } => write!(f, "curve {curve} lies beyond ±2^24 mm"),
        }
    }
}

impl core::error::Error for CompileError {}
