//! Why a curve is refused.

use core::fmt;

/// The kind of number that an error names.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub enum Quantity {
    /// The knots `u_i`.
    Knot,
    /// The control points `P_i`.
    ControlPoint,
    /// The weights `w_i`.
    Weight,
}

/// One of the two ends of a curve.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum End {
    /// Where the parameter begins.
    First,
    /// Where the parameter ends.
    Last,
}

/// Why numbers do not make a curve. Every index counts from 0 in the slice that the caller gave.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub enum CurveError {
    /// The degree is outside `1 ..= MAX_DEGREE`.
    DegreeOutOfRange {
        /// The degree given.
        degree: usize,
    },
    /// There are fewer than degree + 1 control points.
    TooFewControlPoints {
        /// The smallest number that makes a curve of this degree.
        least: usize,
        /// The number given.
        found: usize,
    },
    /// There is not one weight per control point.
    WrongWeightCount {
        /// The number of control points.
        expected: usize,
        /// The number of weights given.
        found: usize,
    },
    /// The number of knots is not points + degree + 1.
    WrongKnotCount {
        /// Points + degree + 1.
        expected: usize,
        /// The number of knots given.
        found: usize,
    },
    /// A value is infinite or NaN.
    NotFinite {
        /// The kind of number.
        what: Quantity,
        /// Its index.
        index: usize,
    },
    /// A knot is less than the one before it.
    KnotsDecrease {
        /// Index of the smaller, later knot.
        index: usize,
    },
    /// The first knot equals the last: the curve has no length in the parameter.
    EmptyDomain,
    /// The last knot less the first does not fit the number format.
    DomainTooWide,
    /// An end knot is not repeated exactly degree + 1 times.
    NotClamped {
        /// Which end.
        end: End,
        /// Degree + 1.
        expected: usize,
        /// How often the knot occurs.
        multiplicity: usize,
    },
    /// An inner knot occurs more than `degree` times: the curve would jump.
    MultiplicityTooHigh {
        /// Index of the first of the equal knots.
        index: usize,
        /// How often the knot occurs.
        multiplicity: usize,
        /// The degree, which is the highest multiplicity.
        degree: usize,
    },
    /// A weight is zero or negative.
    WeightNotPositive {
        /// Its index.
        index: usize,
    },
    /// The extent of the control points along one axis, times the largest weight if that is above 1, does not
    /// fit the number format: differences of points would overflow.
    ExtentTooWide {
        /// The axis, 0 for x.
        axis: usize,
    },
    /// A value does not fit the format it is converted to. A weight that would become 0 does not fit either.
    OutOfRange {
        /// The kind of number.
        what: Quantity,
        /// Its index.
        index: usize,
    },
    /// Knots that differ become equal in the format they are converted to, and their multiplicity exceeds the degree.
    KnotsMerge {
        /// Index of the first of the equal knots.
        index: usize,
        /// How many are equal after rounding.
        multiplicity: usize,
    },
    /// A knot was to be inserted at an end of the domain or outside it.
    OutsideDomain,
}

impl fmt::Display for Quantity {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::Knot => "knot",
            Self::ControlPoint => "control point",
            Self::Weight => "weight",
        })
    }
}

impl fmt::Display for CurveError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match *self {
            Self::DegreeOutOfRange { degree } => {
                write!(f, "degree {degree} is outside 1..={}", crate::MAX_DEGREE)
            }
            Self::TooFewControlPoints { least, found } => {
                write!(f, "{found} control points are fewer than degree + 1 = {least}")
            }
            Self::WrongWeightCount { expected, found } => {
                write!(f, "{found} weights for {expected} control points; one each is needed")
            }
            Self::WrongKnotCount { expected, found } => {
                write!(f, "{found} knots, but control points + degree + 1 = {expected}")
            }
            Self::NotFinite { what, index } => write!(f, "{what} {index} is not a finite number"),
            Self::KnotsDecrease { index } => {
                write!(
                    f,
                    "knot {index} is less than knot {}; knots must not decrease",
                    index.saturating_sub(1)
                )
            }
            Self::EmptyDomain => f.write_str("the first knot equals the last; the domain is empty"),
            Self::DomainTooWide => f.write_str("last knot - first knot does not fit the number format"),
            Self::NotClamped { end, expected, multiplicity } => {
                let end = if end == End::First { "first" } else { "last" };
                write!(f, "the {end} knot is there {multiplicity} times, not degree + 1 = {expected}")
            }
            Self::MultiplicityTooHigh { index, multiplicity, degree } => {
                write!(
                    f,
                    "the inner knot {index} is there {multiplicity} times, more than the degree {degree}"
                )
            }
            Self::WeightNotPositive { index } => write!(f, "weight {index} is not above 0"),
            Self::ExtentTooWide { axis } => write!(
                f,
                "the extent of the control points along axis {axis}, times the largest weight, does not fit the \
                 number format"
            ),
            Self::OutOfRange { what, index } => write!(f, "{what} {index} does not fit the number format"),
            Self::KnotsMerge { index, multiplicity } => write!(
                f,
                "{multiplicity} knots from knot {index} on become equal in the number format, more than the degree \
                 allows"
            ),
            Self::OutsideDomain => f.write_str("the knot to insert is not inside the domain"),
        }
    }
}

impl core::error::Error for CurveError {}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn messages_name_argument_value_and_relation() {
        for (error, message) in [
            (CurveError::DegreeOutOfRange { degree: 10 }, "degree 10 is outside 1..=9"),
            (CurveError::KnotsDecrease { index: 5 }, "knot 5 is less than knot 4; knots must not decrease"),
            (
                CurveError::OutOfRange { what: Quantity::Weight, index: 2 },
                "weight 2 does not fit the number format",
            ),
            (
                CurveError::NotClamped { end: End::Last, expected: 4, multiplicity: 3 },
                "the last knot is there 3 times, not degree + 1 = 4",
            ),
        ] {
            assert_eq!(error.to_string(), message);
        }
    }
}
