//! Oddities of a curve: rarely intended, and difficult for a machine or a number format.

use std::fmt;

use serde::Serialize;

use crate::bend::Measure;
use crate::curve::Curve;
use crate::moves::{Move, MoveKind};

/// A curve shorter than this, in mm, is shorter than the resolution of a machine's axes.
pub const TINY_MM: f64 = 1e-3;
/// A ratio of weights beyond which a rational curve is hard on number formats.
pub const WEIGHT_RATIO: f64 = 100.0;
/// A knot span below this share of the whole is likely a slip of rounding.
pub const SHORT_SPAN: f64 = 1e-6;

/// Something odd about one curve.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Remark {
    /// Index of the curve.
    pub curve: usize,
    /// Line of its block.
    pub line: usize,
    /// The oddity.
    pub oddity: Oddity,
}

/// An oddity of a curve.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
#[serde(rename_all = "snake_case")]
#[non_exhaustive]
pub enum Oddity {
    /// A move at feed for which the program gives none.
    NoFeedrate,
    /// The curve is shorter than [`TINY_MM`]: its length, in mm.
    Tiny(f64),
    /// A curve, not a tiny one, bends with a radius below [`TINY_MM`], in mm: a cusp.
    Cusp(f64),
    /// A control point that equals the next one, by its index: the direction may vanish there.
    RepeatedControlPoint(usize),
    /// Greatest over least weight, where it is above [`WEIGHT_RATIO`].
    WeightRatio(f64),
    /// After this knot, a span of this share of the domain, below [`SHORT_SPAN`].
    ShortKnotSpan(usize, f64),
}

impl fmt::Display for Oddity {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::NoFeedrate => f.write_str("no feedrate is commanded: the machine's own holds"),
            Self::Tiny(length) => write!(f, "the move is {length:.1e} mm long"),
            Self::Cusp(0.0) => f.write_str("the curve comes to a cusp, where it stands still"),
            Self::Cusp(radius) => write!(f, "the curve bends with a radius of {radius:.1e} mm"),
            Self::RepeatedControlPoint(index) => {
                write!(f, "control points {index} and {} are the same", index + 1)
            }
            Self::WeightRatio(ratio) => write!(f, "the greatest weight is {ratio:.0} times the least"),
            Self::ShortKnotSpan(index, share) => {
                write!(f, "the span after knot {index} is {share:.1e} of the domain")
            }
        }
    }
}

/// The oddities of a curve that was measured.
pub(crate) fn oddities(curve: &Curve, one: &Move, measure: &Measure) -> Vec<Oddity> {
    let mut odd = Vec::new();
    if one.kind == MoveKind::Feed && one.feedrate_mm_per_s.is_none() {
        odd.push(Oddity::NoFeedrate);
    }
    if measure.length_mm < TINY_MM {
        odd.push(Oddity::Tiny(measure.length_mm));
    } else if let Some(place) = measure.sharpest.filter(|place| place.radius_mm < TINY_MM) {
        odd.push(Oddity::Cusp(place.radius_mm));
    }
    odd.extend(
        curve
            .control_points_mm()
            .windows(2)
            .position(|pair| pair[0] == pair[1])
            .map(Oddity::RepeatedControlPoint),
    );
    let (least, most) = curve.weights().iter().fold((f64::MAX, 0.0_f64), |(a, b), w| (a.min(*w), b.max(*w)));
    if most / least > WEIGHT_RATIO {
        odd.push(Oddity::WeightRatio(most / least));
    }
    let domain = curve.knots().last().unwrap_or(&0.0) - curve.knots().first().unwrap_or(&0.0);
    let share = |pair: &[f64]| (pair[1] - pair[0]) / domain;
    let short = curve.knots().windows(2).position(|pair| share(pair) > 0.0 && share(pair) < SHORT_SPAN);
    odd.extend(short.map(|knot| Oddity::ShortKnotSpan(knot, share(&curve.knots()[knot..knot + 2]))));
    odd
}
