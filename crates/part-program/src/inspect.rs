//! What stands out in a part: counts, extent, joints, and what is odd.

use std::fmt;

use crate::curve::Curve;
use crate::part::{MoveKind, Part, Shape};

/// A gap between curves from which on a joint is listed, in mm.
pub const GAP_MM: f64 = 1e-6;
/// A change of direction from which on a joint is listed, in rad: a twentieth of a degree.
pub const TANGENT_BREAK_RAD: f64 = 1e-3;
/// A curve shorter than this, in mm, is shorter than the resolution of a machine's axes.
const TINY_MM: f64 = 1e-3;
/// A ratio of weights beyond which a rational curve is hard on number formats.
const WEIGHT_RATIO: f64 = 100.0;
/// A knot span below this share of the whole is likely a slip of rounding.
const SHORT_SPAN: f64 = 1e-6;

/// What stands out in a part.
#[derive(Clone, Debug, PartialEq)]
pub struct Inspection {
    /// Rapid moves.
    pub rapids: usize,
    /// Straight moves at feed.
    pub lines: usize,
    /// Arcs and helices.
    pub arcs: usize,
    /// Splines.
    pub splines: usize,
    /// Control points of all curves.
    pub control_points: usize,
    /// The lowest and the highest degree.
    pub degrees: Option<(usize, usize)>,
    /// Least and greatest coordinates of the control points, in mm; every curve lies between them.
    pub bounding_box_mm: Option<([f64; 3], [f64; 3])>,
    /// The least and the greatest feedrate of a move at feed, in mm/s.
    pub feedrates_mm_per_s: Option<(f64, f64)>,
    /// Joints with a gap or a change of direction.
    pub joints: Vec<Joint>,
    /// What is odd.
    pub remarks: Vec<Remark>,
}

/// Where a curve begins otherwise than the one before it ends.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Joint {
    /// Index of the later curve.
    pub curve: usize,
    /// Line of its block.
    pub line: usize,
    /// Distance from the end of the one to the start of the other, in mm.
    pub gap_mm: f64,
    /// Change of direction, in rad, 0 to π.
    pub tangent_break_rad: f64,
}

/// Something odd about one curve.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Remark {
    /// Index of the curve.
    pub curve: usize,
    /// Line of its block.
    pub line: usize,
    /// What it is.
    pub oddity: Oddity,
}

/// What is odd about a curve.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub enum Oddity {
    /// A move at feed for which the program gives none.
    NoFeedrate,
    /// The control polygon is hardly longer than a machine resolves, in mm.
    Tiny(f64),
    /// The same control point twice in a row, from this one: the direction may vanish there.
    RepeatedControlPoint(usize),
    /// Greatest over least weight.
    WeightRatio(f64),
    /// A span of this share of the domain, after this knot.
    ShortKnotSpan(usize, f64),
}

impl fmt::Display for Oddity {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::NoFeedrate => f.write_str("no feedrate is commanded: the machine's own holds"),
            Self::Tiny(length) => write!(f, "the control polygon is {length:.1e} mm long"),
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

/// Looks a part over.
#[must_use]
pub fn inspect(part: &Part) -> Inspection {
    let count = |wanted: Shape| {
        part.moves.iter().filter(|one| one.kind == MoveKind::Feed && one.shape == wanted).count()
    };
    let range = |values: &mut dyn Iterator<Item = f64>| {
        values.fold(None, |range: Option<(f64, f64)>, x| {
            Some(range.map_or((x, x), |(least, most)| (least.min(x), most.max(x))))
        })
    };
    let degrees = part.curves.iter().map(|curve| curve.degree);
    Inspection {
        rapids: part.moves.iter().filter(|one| one.kind == MoveKind::Rapid).count(),
        lines: count(Shape::Line),
        arcs: count(Shape::Arc),
        splines: count(Shape::Nurbs),
        control_points: part.curves.iter().map(|curve| curve.control_points_mm.len()).sum(),
        degrees: degrees.clone().min().zip(degrees.max()),
        bounding_box_mm: bounding_box(&part.curves),
        feedrates_mm_per_s: range(&mut part.moves.iter().filter_map(|one| one.feedrate_mm_per_s)),
        joints: joints(part),
        remarks: remarks(part),
    }
}

fn bounding_box(curves: &[Curve]) -> Option<([f64; 3], [f64; 3])> {
    let points = curves.iter().flat_map(|curve| &curve.control_points_mm);
    points.fold(None, |bounds, point| {
        let (least, most) = bounds.unwrap_or((*point, *point));
        Some((
            std::array::from_fn(|axis| f64::min(least[axis], point[axis])),
            std::array::from_fn(|axis| f64::max(most[axis], point[axis])),
        ))
    })
}

fn joints(part: &Part) -> Vec<Joint> {
    let pairs = part.curves.windows(2).zip(part.moves.iter().skip(1)).enumerate();
    let joint = |(index, (pair, one)): (usize, (&[Curve], &crate::part::Move))| {
        let (end, start) = (pair[0].control_points_mm.last()?, pair[1].control_points_mm.first()?);
        let gap_mm = length(difference(start, end));
        let tangent_break_rad = angle(
            direction(pair[0].control_points_mm.iter().rev())?.map(|x| -x),
            direction(pair[1].control_points_mm.iter())?,
        );
        let listed = gap_mm > GAP_MM || tangent_break_rad > TANGENT_BREAK_RAD;
        listed.then_some(Joint { curve: index + 1, line: one.line, gap_mm, tangent_break_rad })
    };
    pairs.filter_map(joint).collect()
}

fn remarks(part: &Part) -> Vec<Remark> {
    let mut remarks = Vec::new();
    for (index, (curve, one)) in part.curves.iter().zip(&part.moves).enumerate() {
        let mut odd = |oddity| remarks.push(Remark { curve: index, line: one.line, oddity });
        if one.kind == MoveKind::Feed && one.feedrate_mm_per_s.is_none() {
            odd(Oddity::NoFeedrate);
        }
        let polygon: f64 = curve.control_points_mm.windows(2).map(|p| length(difference(&p[1], &p[0]))).sum();
        if polygon < TINY_MM {
            odd(Oddity::Tiny(polygon));
        }
        if let Some(twice) = curve.control_points_mm.windows(2).position(|p| p[0] == p[1]) {
            odd(Oddity::RepeatedControlPoint(twice));
        }
        let (least, most) =
            curve.weights.iter().fold((f64::MAX, 0.0_f64), |(a, b), w| (a.min(*w), b.max(*w)));
        if most / least > WEIGHT_RATIO {
            odd(Oddity::WeightRatio(most / least));
        }
        let domain = curve.knots.last().unwrap_or(&0.0) - curve.knots.first().unwrap_or(&0.0);
        let share = |pair: &[f64]| (pair[1] - pair[0]) / domain;
        let short = curve.knots.windows(2).position(|pair| share(pair) > 0.0 && share(pair) < SHORT_SPAN);
        if let Some(knot) = short {
            odd(Oddity::ShortKnotSpan(knot, share(&curve.knots[knot..knot + 2])));
        }
    }
    remarks
}

/// From the first point to the first that differs: the direction in which a clamped curve leaves its end.
fn direction<'p>(mut points: impl Iterator<Item = &'p [f64; 3]>) -> Option<[f64; 3]> {
    let first = points.next()?;
    points.find(|point| *point != first).map(|next| difference(next, first))
}

fn difference(to: &[f64; 3], from: &[f64; 3]) -> [f64; 3] {
    std::array::from_fn(|axis| to[axis] - from[axis])
}

fn length(v: [f64; 3]) -> f64 {
    v[0].hypot(v[1]).hypot(v[2])
}

/// The angle between two directions, from sine and cosine, so that small ones keep their digits.
fn angle(a: [f64; 3], b: [f64; 3]) -> f64 {
    let cross = [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]];
    length(cross).atan2(a[0] * b[0] + a[1] * b[1] + a[2] * b[2])
}
