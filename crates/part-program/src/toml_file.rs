//! Curve files and machine files: TOML, with every fault named by line and column.
//!
//! The document is walked as values with their places instead of being deserialised, so that all its faults are
//! found and not the first alone.

use toml::Spanned;
use toml::de::{DeTable, DeValue};

use crate::curve::{Curve, Element};
use crate::diagnostic::Report;
use crate::machine::Machine;
use crate::source::Span;

type Value<'t> = Spanned<DeValue<'t>>;

/// What a file may hold.
pub(crate) struct Content {
    pub(crate) curve: Option<Curve>,
    pub(crate) machine: Option<Machine>,
}

/// Reads the tables `[curve]` and `[machine]`. Tables whose names begin with `table_` hold figures that a paper
/// publishes beside the curve; they are not read. `None` when a fault was said.
pub(crate) fn read(report: &mut Report<'_>) -> Option<Content> {
    let text = report.source.text;
    let (document, syntax) = DeTable::parse_recoverable(text);
    for error in &syntax {
        let span = error.span().unwrap_or(0..0);
        report.error(span, format!("not TOML: {}", error.message()));
    }
    let mut content = Content { curve: None, machine: None };
    for (key, value) in document.get_ref() {
        match key.get_ref().as_ref() {
            "curve" => {
                content.curve = Fields::of(report, value, "curve", CURVE_KEYS).and_then(|f| f.curve(report))
            }
            "machine" => {
                content.machine =
                    Fields::of(report, value, "machine", MACHINE_KEYS).and_then(|f| f.machine(report));
            }
            name if name.starts_with("table_") => {}
            name => unknown(report, key.span(), name, &["curve", "machine"]),
        }
    }
    (!report.has_errors()).then_some(content)
}

const CURVE_KEYS: &[&str] = &["degree", "control_points_mm", "weights", "knots"];
const MACHINE_KEYS: &[&str] = &[
    "interpolation_period_ms",
    "feedrate_mm_per_s",
    "acceleration_mm_per_s2",
    "jerk_mm_per_s3",
    "chord_error_mm",
    "fluctuation_limit",
    "parameter_tolerance",
    "max_iterations",
    "centripetal_acceleration_mm_per_s2",
];

fn unknown(report: &mut Report<'_>, span: impl Into<Span>, name: &str, known: &[&str]) {
    let nearest = known.iter().map(|k| (strsim::damerau_levenshtein(k, name), k)).min();
    let diagnostic = report.error(span, format!("unknown key `{name}`"));
    diagnostic.expected(known.join(", "));
    if let Some((_, near)) = nearest.filter(|(distance, near)| *distance * 3 <= near.len()) {
        diagnostic.hint(format!("did you mean `{near}`?"));
    }
}

/// The values of one table.
struct Fields<'v, 't> {
    table: &'v DeTable<'t>,
    span: Span,
    name: &'static str,
}

impl<'v, 't> Fields<'v, 't> {
    /// The table, if it is one; keys that it should not have are said.
    fn of(report: &mut Report<'_>, value: &'v Value<'t>, name: &'static str, known: &[&str]) -> Option<Self> {
        let Some(table) = value.get_ref().as_table() else {
            report
                .error(value.span(), format!("`{name}` is {}", value.get_ref().type_str()))
                .expected("a table");
            return None;
        };
        for key in table.keys().filter(|key| !known.contains(&key.get_ref().as_ref())) {
            unknown(report, key.span(), key.get_ref(), known);
        }
        Some(Self { table, span: value.span().into(), name })
    }

    fn get(&self, report: &mut Report<'_>, key: &str) -> Option<&'v Value<'t>> {
        let value = self.table.get(key);
        if value.is_none() {
            report
                .error(self.span, format!("table `{}` has no key `{key}`", self.name))
                .expected(format!("`{key} = …`"));
        }
        value
    }

    /// A positive number below `below`.
    fn positive(&self, report: &mut Report<'_>, key: &str, below: f64) -> Option<f64> {
        let value = self.get(report, key)?;
        let number = number(report, value)?;
        if number > 0.0 && number < below {
            return Some(number);
        }
        let expected = if below < LARGEST {
            format!("a number between 0 and {below}")
        } else {
            "a positive number".into()
        };
        report.error(value.span(), format!("`{key}` is {number}")).expected(expected);
        None
    }

    fn machine(&self, report: &mut Report<'_>) -> Option<Machine> {
        let mut positive = |key: &str, below: f64| self.positive(report, key, below);
        let period = positive("interpolation_period_ms", LARGEST);
        let feedrate = positive("feedrate_mm_per_s", LARGEST);
        let acceleration = positive("acceleration_mm_per_s2", LARGEST);
        let jerk = positive("jerk_mm_per_s3", LARGEST);
        let chord_error = positive("chord_error_mm", LARGEST);
        let fluctuation = positive("fluctuation_limit", 1.0);
        let parameter = positive("parameter_tolerance", 1.0);
        let centripetal = self.table.contains_key("centripetal_acceleration_mm_per_s2");
        let centripetal = centripetal.then(|| positive("centripetal_acceleration_mm_per_s2", LARGEST));
        let iterations = self.whole(report, "max_iterations", 1, 100);
        Some(Machine {
            interpolation_period_ms: period?,
            feedrate_mm_per_s: feedrate?,
            acceleration_mm_per_s2: acceleration?,
            jerk_mm_per_s3: jerk?,
            chord_error_mm: chord_error?,
            fluctuation_limit: fluctuation?,
            parameter_tolerance: parameter?,
            max_iterations: u32::try_from(iterations?).ok()?,
            centripetal_acceleration_mm_per_s2: match centripetal {
                Some(value) => Some(value?),
                None => None,
            },
        })
    }

    fn whole(&self, report: &mut Report<'_>, key: &str, least: usize, most: usize) -> Option<usize> {
        let value = self.get(report, key)?;
        let whole =
            value.get_ref().as_integer().and_then(|i| usize::from_str_radix(i.as_str(), i.radix()).ok());
        let found = whole.filter(|i| (least..=most).contains(i));
        if found.is_none() {
            let shown = report.source.slice(value.span().into()).to_string();
            report
                .error(value.span(), format!("`{key}` is {shown}"))
                .expected(format!("a whole number from {least} to {most}"));
        }
        found
    }

    fn curve(&self, report: &mut Report<'_>) -> Option<Curve> {
        let degree = self.whole(report, "degree", 1, crate::curve::MAX_DEGREE);
        let points = self.get(report, "control_points_mm").and_then(|value| points(report, value));
        let weights = match self.table.get("weights") {
            Some(value) => numbers(report, value, "weights"),
            None => points.as_ref().map(|p| vec![(1.0, p.span); p.rows.len()]),
        };
        let knots = self.get(report, "knots").and_then(|value| numbers(report, value, "knots"));
        let (degree, points, weights, knots) = (degree?, points?, weights?, knots?);
        let curve = Curve {
            degree,
            dimension: points.dimension,
            control_points_mm: points.rows.iter().map(|(point, _)| *point).collect(),
            weights: weights.iter().map(|(w, _)| *w).collect(),
            knots: knots.iter().map(|(u, _)| *u).collect(),
        };
        let faults = curve.faults();
        for fault in &faults {
            let span = match fault.element() {
                Element::ControlPoint(i) => points.rows.get(i).map(|(_, span)| *span),
                Element::Weight(i) => weights.get(i).map(|(_, span)| *span),
                Element::Knot(i) => knots.get(i).map(|(_, span)| *span),
                Element::ControlPoints => Some(points.span),
                Element::Degree => self.table.get("degree").map(|v| v.span().into()),
                Element::Weights => self.table.get("weights").map(|v| v.span().into()),
                Element::Knots => self.table.get("knots").map(|v| v.span().into()),
            };
            report.error(span.unwrap_or(self.span), fault.to_string()).expected(fault.expected());
        }
        faults.is_empty().then_some(curve)
    }
}

/// Numbers of a machine file lie below this.
const LARGEST: f64 = 1e12;

/// A finite number, integer or float.
fn number(report: &mut Report<'_>, value: &Value<'_>) -> Option<f64> {
    let parsed = match value.get_ref() {
        DeValue::Integer(i) => i64::from_str_radix(i.as_str(), i.radix()).ok().map(|i| i as f64),
        DeValue::Float(x) => x.as_str().parse().ok(),
        _ => None,
    };
    let finite = parsed.filter(|x: &f64| x.is_finite());
    if finite.is_none() {
        let shown = report.source.slice(value.span().into()).to_string();
        report
            .error(value.span(), format!("`{shown}` is not a finite number"))
            .expected("a number such as 12.5");
    }
    finite
}

/// A list of numbers with their places.
fn numbers(report: &mut Report<'_>, value: &Value<'_>, what: &str) -> Option<Vec<(f64, Span)>> {
    let Some(array) = value.get_ref().as_array() else {
        report
            .error(value.span(), format!("`{what}` is {}", value.get_ref().type_str()))
            .expected("a list of numbers");
        return None;
    };
    let read: Vec<_> = array.iter().map(|v| number(report, v).map(|x| (x, v.span().into()))).collect();
    read.into_iter().collect()
}

/// Control points with their places.
struct Points {
    rows: Vec<([f64; 3], Span)>,
    dimension: usize,
    span: Span,
}

fn points(report: &mut Report<'_>, value: &Value<'_>) -> Option<Points> {
    let Some(array) = value.get_ref().as_array() else {
        report
            .error(value.span(), "`control_points_mm` is not a list")
            .expected("a list of points, [[x, y], …]");
        return None;
    };
    let mut dimension = None;
    let mut rows = Vec::with_capacity(array.len());
    for row in array.iter() {
        let coordinates = numbers(report, row, "a control point");
        let Some(coordinates) = coordinates else { continue };
        let expected = *dimension.get_or_insert(if coordinates.len() == 3 { 3 } else { 2 });
        if coordinates.len() != expected {
            report
                .error(
                    row.span(),
                    format!("control point {} has {} coordinates", rows.len(), coordinates.len()),
                )
                .expected(format!("{expected} coordinates"));
            continue;
        }
        let mut point = [0.0; 3];
        for (slot, (x, _)) in point.iter_mut().zip(&coordinates) {
            *slot = *x;
        }
        rows.push((point, row.span().into()));
    }
    (rows.len() == array.len()).then(|| Points {
        rows,
        dimension: dimension.unwrap_or(2),
        span: value.span().into(),
    })
}
