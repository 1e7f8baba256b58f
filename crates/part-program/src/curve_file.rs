//! A curve file: TOML with the table `[curve]`, or several tables `[[curve]]` that are followed in this order. It may
//! also have a table `[machine]` and figures that a paper printed. A curve is a NURBS, or with `shape =
//! "trigonometric"` a spline of paper B.

use domains::curve::{DEGREE, EXACT_STOP, FEEDRATE, KNOTS, MOVE, POINTS, SHAPE, WEIGHTS};
use toml::de::{DeTable, DeValue};

use crate::curve::{Curve, Nurbs};
use crate::curve_numbers::{Places, control_points, numbers, say};
use crate::diagnostic::Report;
use crate::lean_toml::LeanToml;
use crate::machine::{self, Machine};
use crate::moves::{Move, MoveKind, Shape};
use crate::source::Span;
use crate::toml_table::{self, TableReader, wrong_kind};
use crate::trig_curve;

/// The contents of a curve file.
pub(crate) struct CurveFile {
    pub(crate) curves: Vec<(Curve, Move)>,
    pub(crate) machine: Option<Machine>,
    pub(crate) published: Option<toml::Table>,
}

/// Reads a curve file; `None` after an error was reported.
pub(crate) fn read(report: &mut Report<'_>, text: &str) -> Option<CurveFile> {
    let lean = LeanToml::of(text);
    let mut curves = Vec::new();
    for block in &lean.curves {
        report.offset = block.start;
        if let Some(document) = toml_table::parse(report, lean.slice(*block)) {
            let mut keys = TableReader::new(report, "the block", Span::default(), document.get_ref());
            let tables = keys.tables("curve");
            curves.extend(tables.into_iter().filter_map(|(header, table)| curve_from(report, header, table)));
        }
        report.offset = 0;
    }
    let (first, rest) = (lean.curves.first().copied(), lean.into_rest());
    let document = toml_table::parse(report, &rest)?;
    let root = document.get_ref();
    let mut keys = TableReader::new(report, "the file", Span::default(), root);
    let tables = keys.tables("curve");
    let machine = keys.table("machine");
    if let Some(first) = first.filter(|_| !tables.is_empty()) {
        let line = keys.report.line_number(first.start);
        let message =
            format!("the curves of line {line} and on are in tables of their own, and these are not");
        keys.report.error(tables[0].0, message).expected("[[curve]] before each curve");
    }
    if tables.is_empty() && first.is_none() && !keys.report.has_errors() {
        let expected = "[curve] with degree, control_points_mm and knots";
        keys.report.error(Span::default(), "the file has no table [curve]").expected(expected);
    }
    toml_table::refuse_unknown_tables(keys.report, root);
    let published = published(root);
    curves.extend(tables.into_iter().filter_map(|(header, table)| curve_from(report, header, table)));
    let machine = machine.map(|(header, table)| machine::from_table(report, header, table));
    let file = CurveFile { curves, machine: machine.flatten(), published };
    (!report.has_errors()).then_some(file)
}

/// The tables `table_…`: what a paper published about the curve.
fn published(root: &DeTable<'_>) -> Option<toml::Table> {
    let tables = root.iter().filter(|(key, _)| toml_table::is_published(key.get_ref()));
    let published = tables.map(|(key, value)| Some((key.get_ref().to_string(), owned(value.get_ref(), 0)?)));
    published.collect::<Option<toml::Table>>().filter(|published| !published.is_empty())
}

/// A value without the places of its parts. Numbers too large for TOML's types are kept as text.
fn owned(value: &DeValue<'_>, depth: usize) -> Option<toml::Value> {
    const MAX_DEPTH: usize = 16;
    if depth > MAX_DEPTH {
        return None;
    }
    Some(match value {
        DeValue::String(text) => toml::Value::String(text.to_string()),
        DeValue::Integer(integer) => i64::from_str_radix(integer.as_str(), integer.radix())
            .map_or_else(|_| toml::Value::String(integer.to_string()), toml::Value::Integer),
        DeValue::Float(float) => toml::Value::Float(float.as_str().parse().ok()?),
        DeValue::Boolean(truth) => toml::Value::Boolean(*truth),
        DeValue::Datetime(datetime) => toml::Value::Datetime(*datetime),
        DeValue::Array(array) => toml::Value::Array(
            array.iter().map(|item| owned(item.get_ref(), depth + 1)).collect::<Option<_>>()?,
        ),
        DeValue::Table(table) => toml::Value::Table(
            table
                .iter()
                .map(|(key, item)| Some((key.get_ref().to_string(), owned(item.get_ref(), depth + 1)?)))
                .collect::<Option<_>>()?,
        ),
    })
}

fn curve_from(report: &mut Report<'_>, header: Span, table: &DeTable<'_>) -> Option<(Curve, Move)> {
    let mut keys = TableReader::new(report, "[curve]", header, table);
    let shape = keys.word(&SHAPE)?;
    let feedrate_mm_per_s = keys.optional_number(&FEEDRATE);
    let kind = kind_from(&mut keys);
    let exact_stop = exact_stop_from(&mut keys, kind);
    let curve = if shape == TRIGONOMETRIC {
        trig_curve::from_keys(keys, header)
    } else {
        nurbs_from_keys(keys, header)
    }?;
    let shape =
        if curve.degree() == 1 && curve.control_points_mm().len() == 2 { Shape::Line } else { Shape::Nurbs };
    let line = report.line_number(header.start);
    Some((curve, Move { kind, shape, feedrate_mm_per_s, exact_stop, line, block: 0 }))
}

/// The value of `shape` for paper B's splines.
const TRIGONOMETRIC: &str = "trigonometric";

/// A NURBS curve by its numbers.
fn nurbs_from_keys(mut keys: TableReader<'_, '_, '_>, header: Span) -> Option<Curve> {
    let mut places = Places::default();
    let degree = keys.any_whole_number(&DEGREE);
    places.degree = keys.optional(DEGREE.name).map_or(header, |value| value.span().into());
    let points = keys.array(POINTS.name);
    let weights = keys.optional(WEIGHTS.name);
    let knots = keys.array(KNOTS.name);
    let report = keys.finish();

    let weights = weights.map(|value| toml_table::array(report, WEIGHTS.name, value));
    let points = points.and_then(|array| {
        places.points = array;
        control_points(report, array, &mut places.point)
    });
    let weights = match weights {
        None => Some(vec![1.0; points.as_ref().map_or(0, |(points, _)| points.len())]),
        Some(array) => array.and_then(|array| {
            places.weights = array;
            numbers(report, WEIGHTS.name, array, &mut places.weight)
        }),
    };
    let knots = knots.and_then(|array| {
        places.knots = array;
        numbers(report, KNOTS.name, array, &mut places.knot)
    });
    let (control_points_mm, dimension) = points?;
    let degree = usize::try_from(degree?).ok()?;
    let curve = Nurbs { degree, control_points_mm, dimension, weights: weights?, knots: knots? };
    say(report, &places, &curve.faults());
    Some(curve.into())
}

/// `move = "feed"`, which is the default, or `"rapid"`.
fn kind_from(keys: &mut TableReader<'_, '_, '_>) -> MoveKind {
    match keys.word(&MOVE) {
        Some("rapid") => MoveKind::Rapid,
        _ => MoveKind::Feed,
    }
}

/// `exact_stop = true`, of a move at feed, or `false`, which is the default.
fn exact_stop_from(keys: &mut TableReader<'_, '_, '_>, kind: MoveKind) -> bool {
    const KEY: &str = EXACT_STOP.name;
    let Some(value) = keys.optional(KEY) else { return false };
    let Some(exact_stop) = value.get_ref().as_bool() else {
        wrong_kind(keys.report, KEY, value, "true or false");
        return false;
    };
    if exact_stop && kind == MoveKind::Rapid {
        keys.report.error(value.span(), format!("`{KEY}` of a rapid move")).expected("a move at feed");
    }
    exact_stop
}
