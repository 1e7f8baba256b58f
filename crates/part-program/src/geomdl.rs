//! Curves in JSON, in the layout that the Python library geomdl exports: `shape.data[i]` with `degree`, `knotvector` and
//! `control_points` of `points` and, where the curve is rational, `weights`. Points are not multiplied by weights.
//!
//! `rational`, `dimension`, `count` and `size` repeat information of the numbers and are checked against them; `delta`,
//! `name` and similar keys are for drawing a curve; any other key is skipped with a warning.

use std::collections::BTreeMap;

use serde::Deserialize;
use serde::de::IgnoredAny;

use crate::curve::{Curve, Nurbs};
use crate::diagnostic::Report;
use crate::moves::{Move, MoveKind, Shape as PartShape};
use crate::part::Part;
use crate::source::Span;

#[derive(Deserialize)]
struct File {
    shape: Shape,
    #[serde(flatten)]
    other: Other,
}

#[derive(Deserialize)]
struct Shape {
    #[serde(rename = "type")]
    kind: String,
    count: Option<usize>,
    data: Vec<Data>,
    #[serde(flatten)]
    other: Other,
}

#[derive(Deserialize)]
struct Data {
    rational: Option<bool>,
    dimension: Option<usize>,
    degree: usize,
    knotvector: Vec<f64>,
    control_points: ControlPoints,
    #[serde(flatten)]
    other: Other,
}

#[derive(Deserialize)]
struct ControlPoints {
    points: Vec<Vec<f64>>,
    weights: Option<Vec<f64>>,
    #[serde(flatten)]
    other: Other,
}

/// Keys that are not read.
type Other = BTreeMap<String, IgnoredAny>;

/// Keys that do not change a curve.
const DRAWING: [&str; 8] =
    ["type", "delta", "name", "id", "sample_size", "evaluator", "precision", "reversed"];

/// Reads the curves of a file into `part`.
pub(crate) fn read(report: &mut Report<'_>, part: &mut Part) {
    let file: File = match serde_json::from_str(report.source.text) {
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
    read_over(report, Span::default(), &file.other);
    read_over(report, Span::default(), &file.shape.other);
    let mut places = key_places(report, "\"knotvector\"");
    for (index, data) in file.shape.data.into_iter().enumerate() {
        let span = places.next().unwrap_or_default();
        read_over(report, span, &data.other);
        read_over(report, span, &data.control_points.other);
        if let Some(curve) = curve_of(report, (index, span), data) {
            let (kind, shape, line) =
                (MoveKind::Feed, PartShape::Nurbs, report.source.line_number(span.start));
            part.moves.push(Move { kind, shape, feedrate_mm_per_s: None, exact_stop: false, line, block: 0 });
            part.curves.push(curve);
        }
    }
    if part.curves.is_empty() && !report.has_errors() {
        report.error(Span::default(), "`shape.data` holds no curve").expected("at least one curve");
    }
}

/// The places at which a key occurs, one after the other: the parser keeps no places.
fn key_places<'t>(report: &Report<'t>, key: &'static str) -> impl Iterator<Item = Span> + use<'t> {
    let found = report.source.text.match_indices(key);
    found.map(move |(at, _)| Span::new(at, at + key.len()))
}

fn read_over(report: &mut Report<'_>, span: Span, other: &Other) {
    for key in other.keys().filter(|key| !DRAWING.contains(&key.as_str())) {
        report.warning(span, format!("the key `{}` is not read", key.chars().take(40).collect::<String>()));
    }
}

fn curve_of(report: &mut Report<'_>, (index, span): (usize, Span), data: Data) -> Option<Curve> {
    let dimension = data.control_points.points.first().map_or(0, Vec::len);
    let mut points = Vec::with_capacity(data.control_points.points.len());
    for (n, point) in data.control_points.points.iter().enumerate() {
        match point.as_slice() {
            [x, y] if dimension == 2 => points.push([*x, *y, 0.0]),
            [x, y, z] if dimension == 3 => points.push([*x, *y, *z]),
            other => {
                let message = format!("curve {index}: control point {n} has {} coordinates", other.len());
                report.error(span, message).expected("2 or 3, the same number in every point");
                return None;
            }
        }
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
    let curve = Nurbs { degree, control_points_mm: points, dimension, weights, knots: data.knotvector };
    for fault in curve.faults() {
        report.error(span, format!("curve {index}: {fault}")).expected(fault.expected());
    }
    Some(curve.into())
}
