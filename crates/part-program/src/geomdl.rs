//! Curves in JSON, in the layout that the Python library geomdl exports: `shape.data[i]` with `degree`, `knotvector` and
//! `control_points` of `points` and, where the curve is rational, `weights`. Points are not multiplied by weights.
//!
//! A curve is drawn from `u_p` to `u_{n+1}`, as geomdl does: knots that are not clamped, and periodic ones, are converted.
//! `rational`, `dimension`, `count` and `size` repeat information of the numbers and are checked against them; `delta`,
//! `name` and similar keys are for drawing a curve; any other key is skipped with a warning.

use std::fmt;

use serde::de::{IgnoredAny, SeqAccess, Visitor};
use serde::{Deserialize, Deserializer};
use serde_ignored::Path;

use crate::clamp::{clamped, is_of_clamping, merge_knots};
use crate::curve::{Curve, Nurbs};
use crate::diagnostic::{MAX_DIAGNOSTICS, Report};
use crate::moves::{Move, MoveKind, Shape as PartShape};
use crate::part::Part;
use crate::source::Span;

#[derive(Deserialize)]
struct File {
    shape: Shape,
}

#[derive(Deserialize)]
struct Shape {
    #[serde(rename = "type")]
    kind: String,
    count: Option<usize>,
    data: Vec<Data>,
}

#[derive(Deserialize)]
struct Data {
    rational: Option<bool>,
    dimension: Option<usize>,
    degree: usize,
    knotvector: Vec<f64>,
    control_points: ControlPoints,
}

#[derive(Deserialize)]
struct ControlPoints {
    points: Vec<Point>,
    weights: Option<Vec<f64>>,
}

/// A point, and the number of its coordinates; of more than three the others are only counted.
struct Point {
    coordinates: [f64; 3],
    count: usize,
}

impl<'de> Deserialize<'de> for Point {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        struct Coordinates;
        impl<'de> Visitor<'de> for Coordinates {
            type Value = Point;

            fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
                f.write_str("the coordinates of a point")
            }

            fn visit_seq<A: SeqAccess<'de>>(self, mut items: A) -> Result<Point, A::Error> {
                let mut point = Point { coordinates: [0.0; 3], count: 0 };
                for coordinate in &mut point.coordinates {
                    let Some(next) = items.next_element()? else { return Ok(point) };
                    *coordinate = next;
                    point.count += 1;
                }
                while items.next_element::<IgnoredAny>()?.is_some() {
                    point.count += 1;
                }
                Ok(point)
            }
        }
        deserializer.deserialize_seq(Coordinates)
    }
}

/// Keys that are not read, each with the index of its curve if it is one of a curve.
#[derive(Default)]
struct Unread {
    keys: Vec<(Option<usize>, String)>,
}

impl Unread {
    /// Notes a key, unless it is for drawing. As many are kept as are said.
    fn note(&mut self, path: &Path<'_>) {
        let Path::Map { parent, key } = path else { return };
        if self.keys.len() < MAX_DIAGNOSTICS && !DRAWING.contains(&key.as_str()) {
            self.keys.push((index_of(parent), key.chars().take(40).collect()));
        }
    }
}

/// The index of the list that a path goes through.
fn index_of(path: &Path<'_>) -> Option<usize> {
    match path {
        Path::Root => None,
        Path::Seq { index, .. } => Some(*index),
        Path::Map { parent, .. }
        | Path::Some { parent }
        | Path::NewtypeStruct { parent }
        | Path::NewtypeVariant { parent } => index_of(parent),
    }
}

/// Keys that do not change a curve.
const DRAWING: [&str; 8] =
    ["type", "delta", "name", "id", "sample_size", "evaluator", "precision", "reversed"];

/// Reads the curves of a file into `part`.
pub(crate) fn read(report: &mut Report<'_>, part: &mut Part) {
    let mut unread = Unread::default();
    let mut json = serde_json::Deserializer::from_str(report.source.text);
    let file: Result<File, _> = serde_ignored::deserialize(&mut json, |path| unread.note(&path));
    let file = match file.and_then(|file| json.end().map(|()| file)) {
        Ok(file) => file,
        Err(error) => {
            let span = report.source.span_at(error.line(), error.column());
            let message = error.to_string();
            let message = message.rsplit_once(" at line ").map_or(message.as_str(), |(message, _)| message);
            report
                .error(span, format!("not a curve in JSON: {message}"))
                .expected("geomdl's layout: shape.data with degree, knotvector and control_points.points");
            return;
        }
    };
    if file.shape.kind != "curve" {
        let span = key_places(report, "\"type\"").next().unwrap_or_default();
        report.error(span, format!("`shape.type` is `{}`", file.shape.kind)).expected("`curve`");
        return;
    }
    let (count, found) = (file.shape.count, file.shape.data.len());
    if count.is_some_and(|count| count != found) {
        let span = key_places(report, "\"count\"").next().unwrap_or_default();
        report
            .error(span, format!("`shape.count` is not the number of curves, {found}"))
            .expected("the same");
    }
    let mut unread = unread.keys.into_iter().peekable();
    let mut places = key_places(report, "\"knotvector\"");
    for (index, data) in file.shape.data.into_iter().enumerate() {
        let span = places.next().unwrap_or_default();
        while let Some((curve, key)) = unread.next_if(|(curve, _)| curve.is_none_or(|curve| curve <= index)) {
            read_over(report, if curve.is_some() { span } else { Span::default() }, &key);
        }
        for curve in curves_of(report, (index, span), data) {
            let (kind, shape, line) =
                (MoveKind::Feed, PartShape::Nurbs, report.source.line_number(span.start));
            part.moves.push(Move { kind, shape, feedrate_mm_per_s: None, exact_stop: false, line, block: 0 });
            part.curves.push(curve);
        }
    }
    unread.for_each(|(_, key)| read_over(report, Span::default(), &key));
    if part.curves.is_empty() && !report.has_errors() {
        report.error(Span::default(), "`shape.data` holds no curve").expected("at least one curve");
    }
}

/// The places at which a key occurs, one after the other: the parser keeps no places.
fn key_places<'t>(report: &Report<'t>, key: &'static str) -> impl Iterator<Item = Span> + use<'t> {
    let found = report.source.text.match_indices(key);
    found.map(move |(at, _)| Span::new(at, at + key.len()))
}

fn read_over(report: &mut Report<'_>, span: Span, key: &str) {
    report.warning(span, format!("the key `{key}` is not read"));
}

/// The curves of an entry: several if it breaks at a knot, and none after an error.
fn curves_of(report: &mut Report<'_>, (index, span): (usize, Span), data: Data) -> Vec<Curve> {
    let Some(mut curve) = curve_of(report, (index, span), data) else { return Vec::new() };
    let faults = curve.faults();
    for fault in faults.iter().filter(|fault| !is_of_clamping(fault)) {
        report.error(span, format!("curve {index}: {fault}")).expected(fault.expected());
    }
    if faults.is_empty() || !faults.iter().all(is_of_clamping) {
        return vec![curve.into()];
    }
    merge_knots(&mut curve.knots, None);
    let Some(curves) = clamped(curve) else {
        report
            .error(span, format!("curve {index}: its parameter has no range"))
            .expected("the knot behind the last point to be greater than the one before the first span");
        return Vec::new();
    };
    curves.into_iter().map(Curve::from).collect()
}

fn curve_of(report: &mut Report<'_>, (index, span): (usize, Span), data: Data) -> Option<Nurbs> {
    let dimension = data.control_points.points.first().map_or(0, |point| point.count);
    let mut points = Vec::with_capacity(data.control_points.points.len());
    for (n, point) in data.control_points.points.iter().enumerate() {
        if point.count != dimension || !(2..=3).contains(&dimension) {
            let message = format!("curve {index}: control point {n} has {} coordinates", point.count);
            report.error(span, message).expected("2 or 3, the same number in every point");
            return None;
        }
        points.push(point.coordinates);
    }
    if data.dimension.is_some_and(|stated| stated != dimension) {
        let message = format!("curve {index}: `dimension` is not that of its points, {dimension}");
        report.error(span, message).expected("the same");
    }
    if data.rational == Some(true) && data.control_points.weights.is_none() {
        report.error(span, format!("curve {index}: `rational` without weights")).expected("`weights`");
    }
    let weights = data.control_points.weights.unwrap_or_else(|| vec![1.0; points.len()]);
    let degree = data.degree;
    Some(Nurbs { degree, control_points_mm: points, dimension, weights, knots: data.knotvector })
}
