//! Why numbers do not make a line, arc or trigonometric spline, or why one cannot be converted.

use core::fmt;

use crate::CurveError;

/// Why a shape is refused.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub enum ShapeError {
    /// A number is infinite or NaN.
    NotFinite {
        /// The object to which the number belongs.
        what: &'static str,
    },
    /// A number does not fit the format it is converted to.
    OutOfRange {
        /// The object to which the number belongs.
        what: &'static str,
    },
    /// The extent along one axis does not fit the number format: differences of points, or an arc's derivatives, would overflow.
    ExtentTooWide {
        /// The axis, 0 for x.
        axis: usize,
    },
    /// There are too few points.
    TooFewPoints {
        /// The least number.
        least: usize,
        /// The number given.
        found: usize,
    },
    /// The number of segments does not fit the number format.
    TooManySegments {
        /// The number given.
        found: usize,
    },
    /// A part of a segment does not lie within [0, 1], or is empty.
    PartOutsideSegment,
    /// The end points of an arc are not equally far from its centre.
    RadiiDiffer,
    /// An arc of no radius, or of an angle outside (0, 2π].
    NoArc,
    /// A tolerance is not positive and finite.
    ToleranceNotPositive,
    /// The shape factor λ of corners is not within -2 ..= 2.
    LambdaOutOfRange,
    /// The degree asked for is not odd or not within 3 ..= 9.
    DegreeNotOdd {
        /// The degree given.
        degree: usize,
    },
    /// The tolerance would take more pieces than are allowed for a segment.
    TooManyPieces {
        /// The most a segment may have.
        most: u32,
    },
    /// The numbers do not make a NURBS curve.
    Curve(CurveError),
}

impl From<CurveError> for ShapeError {
    fn from(error: CurveError) -> Self {
        Self::Curve(error)
    }
}

impl fmt::Display for ShapeError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::NotFinite { what } => write!(f, "{what} is not a finite number"),
            Self::OutOfRange { what } => write!(f, "{what} does not fit the number format"),
            Self::ExtentTooWide { axis } => {
                write!(f, "the extent along axis {axis} does not fit the number format")
            }
            Self::TooFewPoints { least, found } => write!(f, "{found} points are fewer than {least}"),
            Self::TooManySegments { found } => write!(f, "the number format cannot count {found} segments"),
            Self::PartOutsideSegment => f.write_str("a part of a segment must satisfy 0 <= begin < end <= 1"),
            Self::RadiiDiffer => f.write_str("start and end of the arc are not equally far from its centre"),
            Self::NoArc => f.write_str("an arc needs a radius above 0 and an angle in (0, 2π]"),
            Self::ToleranceNotPositive => f.write_str("the tolerance is not a positive number"),
            Self::LambdaOutOfRange => f.write_str("the shape factor of corners is not within -2 and 2"),
            Self::DegreeNotOdd { degree } => write!(f, "degree {degree} is not one of 3, 5, 7 and 9"),
            Self::TooManyPieces { most } => {
                write!(
                    f,
                    "the tolerance takes more than {most} pieces a segment; it is too small for the curve"
                )
            }
            Self::Curve(error) => error.fmt(f),
        }
    }
}

impl core::error::Error for ShapeError {}
