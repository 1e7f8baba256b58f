//! The reasons why no plan could be made.

use core::fmt;

/// Why limits, a limit curve or a plan were refused.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub enum PlanError {
    /// An argument must be a positive number and is not.
    NotPositive {
        /// The argument's name.
        what: &'static str,
    },
    /// An argument must not be negative and is.
    Negative {
        /// The argument's name.
        what: &'static str,
    },
    /// The feed commanded for a curve is zero, negative or not a number.
    CurveFeedNotPositive {
        /// Index of the curve.
        curve: usize,
    },
    /// The path has no length: it has no curve or no span, or it is a single point.
    PathEmpty,
    /// The arc length does not increase up to this curve's end: either the length or a derivative of the curve
    /// overflows the format.
    LengthOverflows {
        /// Index of the curve.
        curve: usize,
    },
    /// A part of this span takes so little of the span's parameters that the planner's finest steps do not see how it runs:
    /// they take the path for shorter or longer than it is.
    SpanTooUneven {
        /// Index of the curve.
        curve: usize,
        /// Index of the span.
        span: usize,
    },
    /// Points of a limit curve are not in order of distance, or not numbers.
    PointsOutOfOrder {
        /// Index of the first point that is not after its predecessor.
        index: usize,
    },
    /// No feed leads from one key point of the limit to the next. A key point is an end, a stop or a minimum. Either
    /// the limit is zero over a whole stretch between the two, or the limit is so low, or the distance so short, that
    /// the format resolves no transition.
    CannotMove {
        /// Index of the curve on which the first of the two key points lies.
        curve: usize,
    },
    /// The feed asked for at the start is above the limit there, or the path is too short to brake from it.
    StartFeedTooHigh,
    /// The feed asked for at the end is above the limit there, or the path is too short to reach it.
    EndFeedTooHigh,
    /// The duration, in periods, is more than the format or a `u32` holds.
    DurationOverflows,
    /// The plan takes more periods than are followed by chords, or, without look-ahead, than become stages.
    TooManyPeriods {
        /// The most that are taken.
        most: u64,
    },
}

impl PlanError {
    /// Index of the curve at which no plan could be made, where there is one.
    #[must_use]
    pub const fn curve(&self) -> Option<usize> {
        match self {
            Self::CurveFeedNotPositive { curve }
            | Self::LengthOverflows { curve }
            | Self::SpanTooUneven { curve, .. }
            | Self::CannotMove { curve } => Some(*curve),
            _ => None,
        }
    }
}

impl fmt::Display for PlanError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::NotPositive { what } => write!(f, "{what} is not a positive number"),
            Self::Negative { what } => write!(f, "{what} is negative or not a number"),
            Self::CurveFeedNotPositive { curve } => {
                write!(f, "the feed of curve {curve} is not a positive number")
            }
            Self::PathEmpty => write!(f, "the path has no length"),
            Self::LengthOverflows { curve } => {
                write!(f, "arc length does not increase along curve {curve}: the number format overflows")
            }
            Self::SpanTooUneven { curve, span } => write!(
                f,
                "span {span} of curve {curve} runs much faster over its parameter in one part than in another, so that its length \
                 is not seen in steps of a millionth of the span: expected weights and points of closer magnitudes"
            ),
            Self::PointsOutOfOrder { index } => {
                write!(f, "limit point {index} is not a number or lies before its predecessor")
            }
            Self::CannotMove { curve } => {
                write!(
                    f,
                    "no feed leads on along curve {curve}: the feed limit is zero on the way to the next minimum or \
                     stop, or too low for the number format"
                )
            }
            Self::StartFeedTooHigh => write!(f, "start feed is above the limit, or too high to brake from"),
            Self::EndFeedTooHigh => write!(f, "end feed is above the limit, or too high to be reached"),
            Self::DurationOverflows => write!(f, "duration exceeds the number format or 2^32 - 1 periods"),
            Self::TooManyPeriods { most } => {
                write!(
                    f,
                    "the plan takes more than {most} periods: expected a longer period, a higher feed, or more acceleration and \
                     jerk"
                )
            }
        }
    }
}

impl core::error::Error for PlanError {}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn messages_name_argument_and_relation() {
        let not_positive = PlanError::NotPositive { what: "jerk" };
        assert_eq!(not_positive.to_string(), "jerk is not a positive number");
        let out_of_order = PlanError::PointsOutOfOrder { index: 7 };
        assert_eq!(out_of_order.to_string(), "limit point 7 is not a number or lies before its predecessor");
    }
}
