//! The rules that a curve may break, with the number at fault and what was expected.

use std::fmt;

use domains::curve::{COORDINATE, KNOT, KNOT_RANGE, WEIGHT};
use domains::shown;
use nurbs_core::{End, MAX_DEGREE};

/// One of a curve's numbers, or a list of them; indices count from 0.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Element {
    /// The degree.
    Degree,
    /// The list of control points.
    ControlPoints,
    /// One control point.
    ControlPoint(usize),
    /// The list of weights.
    Weights,
    /// One weight.
    Weight(usize),
    /// The list of knots.
    Knots,
    /// One knot.
    Knot(usize),
}

/// A rule that a curve breaks; indices count from 0.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub enum CurveFault {
    /// The degree is not in 1 ..= [`MAX_DEGREE`].
    DegreeOutOfRange {
        /// The degree given.
        degree: usize,
    },
    /// There are fewer than degree + 1 control points.
    TooFewControlPoints {
        /// Degree + 1.
        least: usize,
        /// The number given.
        found: usize,
    },
    /// The number of weights is not the number of control points.
    WrongWeightCount {
        /// The number of control points.
        expected: usize,
        /// The number given.
        found: usize,
    },
    /// The number of knots is not points + degree + 1.
    WrongKnotCount {
        /// Points + degree + 1.
        expected: usize,
        /// The number given.
        found: usize,
    },
    /// A coordinate is not a number, infinite, or beyond [`MAX_COORDINATE_MM`](crate::MAX_COORDINATE_MM).
    CoordinateOutOfRange {
        /// The control point.
        index: usize,
        /// Its coordinate.
        value: f64,
    },
    /// A weight is not positive, not a number, or beyond [`MAX_WEIGHT`](crate::MAX_WEIGHT).
    WeightOutOfRange {
        /// The weight.
        index: usize,
        /// Its value.
        value: f64,
    },
    /// A knot is not a number, infinite, or beyond [`MAX_KNOT`](crate::MAX_KNOT).
    KnotOutOfRange {
        /// The knot.
        index: usize,
        /// Its value.
        value: f64,
    },
    /// A knot is less than the one before it.
    KnotsDecrease {
        /// The smaller, later knot.
        index: usize,
        /// Its value.
        knot: f64,
        /// The value before it.
        previous: f64,
    },
    /// The first knot equals the last.
    EmptyDomain {
        /// The value of them all.
        knot: f64,
    },
    /// The last knot is greater than the first by less than a double can divide.
    RangeTooSmall {
        /// By how much.
        range: f64,
    },
    /// A knot is greater than the one before it, but by less than derivatives can be computed over.
    KnotsTooClose {
        /// The greater, later knot.
        index: usize,
        /// Its value.
        knot: f64,
        /// The value before it.
        previous: f64,
        /// The least difference.
        least: f64,
    },
    /// An end knot does not occur degree + 1 times.
    NotClamped {
        /// Which end.
        end: End,
        /// Degree + 1.
        expected: usize,
        /// The number of times that it occurs.
        multiplicity: usize,
        /// The first knot, counted from that end, that must be equal and differs, or must differ and is equal.
        index: usize,
    },
    /// An inner knot occurs more than degree times: the curve would break.
    KnotRepeatsTooOften {
        /// The first knot too many.
        index: usize,
        /// The number of times that it occurs.
        multiplicity: usize,
        /// The degree.
        degree: usize,
    },
    /// So many knots are so close that the curve jumps from one double to the next.
    JumpsBetweenDoubles {
        /// The last of those degree + 1 knots.
        index: usize,
        /// The first of them.
        first: f64,
        /// The last.
        last: f64,
        /// How far apart two places at neighbouring parameters can be, in mm.
        jump_mm: f64,
        /// How far they may be, in mm.
        most_mm: f64,
    },
    /// All control points are the same: the curve has no length.
    NoLength,
}

impl CurveFault {
    /// The number that is at fault.
    #[must_use]
    pub fn element(&self) -> Element {
        match *self {
            Self::DegreeOutOfRange { .. } => Element::Degree,
            Self::TooFewControlPoints { .. } | Self::NoLength => Element::ControlPoints,
            Self::WrongWeightCount { .. } => Element::Weights,
            Self::WrongKnotCount { .. } | Self::EmptyDomain { .. } | Self::RangeTooSmall { .. } => {
                Element::Knots
            }
            Self::CoordinateOutOfRange { index, .. } => Element::ControlPoint(index),
            Self::WeightOutOfRange { index, .. } => Element::Weight(index),
            Self::KnotOutOfRange { index, .. }
            | Self::KnotsDecrease { index, .. }
            | Self::KnotsTooClose { index, .. }
            | Self::NotClamped { index, .. }
            | Self::JumpsBetweenDoubles { index, .. }
            | Self::KnotRepeatsTooOften { index, .. } => Element::Knot(index),
        }
    }

    /// The correct form.
    #[must_use]
    pub fn expected(&self) -> String {
        match *self {
            Self::DegreeOutOfRange { .. } => format!("a degree of 1 to {MAX_DEGREE}"),
            Self::TooFewControlPoints { least, .. } => {
                format!("at least degree + 1 = {least} control points")
            }
            Self::WrongWeightCount { expected, .. } => format!("one weight a control point: {expected}"),
            Self::WrongKnotCount { expected, .. } => format!("points + degree + 1 = {expected} knots"),
            Self::CoordinateOutOfRange { .. } => format!("coordinates within ±{:e} mm", COORDINATE.most()),
            Self::WeightOutOfRange { .. } => {
                format!("a weight of {:e} to {:e}", 1.0 / WEIGHT.most(), WEIGHT.most())
            }
            Self::KnotOutOfRange { .. } => format!("a knot within ±{:e}", KNOT.most()),
            Self::KnotsDecrease { previous, .. } => format!("a knot of at least {}", shown(previous)),
            Self::RangeTooSmall { .. } => {
                format!("a last knot that is greater than the first by at least {:e}", KNOT_RANGE.least())
            }
            Self::KnotsTooClose { least, .. } => {
                format!("the same knot, or one that is greater by at least {least:e}")
            }
            Self::EmptyDomain { .. } => "a last knot greater than the first".into(),
            Self::NotClamped { expected, .. } => format!("end knots repeated degree + 1 = {expected} times"),
            Self::KnotRepeatsTooOften { degree, .. } => {
                format!("an inner knot at most degree = {degree} times")
            }
            Self::JumpsBetweenDoubles { most_mm, .. } => {
                format!(
                    "equal knots, or knots so far apart that the curve goes at most {most_mm:.1e} mm from one double to the next"
                )
            }
            Self::NoLength => "at least two different control points".into(),
        }
    }
}

impl fmt::Display for CurveFault {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match *self {
            Self::DegreeOutOfRange { degree } => write!(f, "degree {degree} is not supported"),
            Self::TooFewControlPoints { found, .. } => write!(f, "too few control points: {found}"),
            Self::WrongWeightCount { found, .. } => write!(f, "wrong number of weights: {found}"),
            Self::WrongKnotCount { found, .. } => write!(f, "wrong number of knots: {found}"),
            Self::CoordinateOutOfRange { index, value } => {
                write!(f, "control point {index} has the coordinate {}", shown(value))
            }
            Self::WeightOutOfRange { index, value } => write!(f, "weight {index} is {}", shown(value)),
            Self::KnotOutOfRange { index, value } => write!(f, "knot {index} is {}", shown(value)),
            Self::KnotsDecrease { index, knot, previous } => {
                write!(f, "knots decrease: knot {index} is {}, after {}", shown(knot), shown(previous))
            }
            Self::EmptyDomain { knot } => {
                write!(f, "all knots are {}: the parameter has no range", shown(knot))
            }
            Self::RangeTooSmall { range } => write!(f, "the knots have a range of {}", shown(range)),
            Self::KnotsTooClose { index, knot, previous, .. } => {
                write!(f, "knots too close: knot {index} is {}, after {}", shown(knot), shown(previous))
            }
            Self::NotClamped { end, multiplicity, .. } => {
                let end = if end == End::First { "first" } else { "last" };
                write!(f, "the curve is not clamped: its {end} knot is there {multiplicity} times")
            }
            Self::KnotRepeatsTooOften { index, multiplicity, .. } => {
                write!(f, "knot {index} is there {multiplicity} times: the curve would break")
            }
            Self::JumpsBetweenDoubles { index, first, last, jump_mm, .. } => write!(
                f,
                "knots too close: up to knot {index}, from {} to {}, the curve jumps {jump_mm:.1e} mm between doubles",
                shown(first),
                shown(last)
            ),
            Self::NoLength => f.write_str("all control points are the same: the curve has no length"),
        }
    }
}

impl std::error::Error for CurveFault {}
