//! Points and derivatives: beside the peers', and on long curves.

use feedbits_benches::{Path, helix};
use nurbs_core::{Differentiate, Evaluate};
use real::DoubleDouble;
use serde_json::json;

use crate::contestants::{Asked, BSPLINE, CURVO, Contestant, LOOKED_UP, REMEMBERED, contestants};
use crate::race::{Runner, race, report};

/// Parameters of a pass over a curve.
const PARAMETERS: u32 = 20_000;

/// Parameters in order, from all over the curve.
fn ascending<const D: usize>(path: &Path<D>) -> Vec<f64> {
    let (first, last) = path.curve.as_curve().domain();
    let at = |i: u32| first + (last - first) * (f64::from(i) + 0.5) / f64::from(PARAMETERS);
    (0..PARAMETERS).map(at).collect()
}

/// The same parameters, each time a large prime further on.
fn scattered(path: &Path<3>) -> Vec<f64> {
    let parameters = ascending(path);
    let count = parameters.len();
    (0..count).map(|i| parameters[i * 7919 % count]).collect()
}

/// The sum over all parameters, and over the magnitudes that went into it, by the textbook in double-double's precision.
fn expected<const D: usize>(path: &Path<D>, asked: Asked, parameters: &[f64]) -> (f64, f64) {
    let exact = path.curve.convert::<DoubleDouble>().expect("every f64 is a double-double");
    let mut total = (DoubleDouble::from(0.0), 0.0);
    for u in parameters {
        let at = exact.as_curve().derivatives((*u).into());
        let rows = if asked == Asked::Point { vec![at.point] } else { vec![at.point, at.first, at.second] };
        for x in rows.iter().flatten() {
            total = (total.0 + *x, total.1 + x.value().abs());
        }
    }
    (total.0.value(), total.1)
}

/// A runner for each of the field.
///
/// # Panics
/// If a contestant's sum is another one: then it does other work, and its time means nothing.
fn runners<'a, const D: usize>(
    path: &Path<D>,
    asked: Asked,
    parameters: &'a [f64],
    field: &'a [Contestant],
) -> Vec<Runner<'a>> {
    let (sum, magnitude) = expected(path, asked, parameters);
    let runner = |contestant: &'a Contestant| {
        let found = (contestant.run)(parameters);
        let bound = 1e-11 * magnitude;
        assert!((found - sum).abs() <= bound, "{}: {found}, not {sum}, on {}", contestant.name, path.name);
        Runner {
            name: contestant.name.to_string(),
            units: u64::from(PARAMETERS),
            run: Box::new(|| (contestant.run)(parameters)),
        }
    };
    field.iter().map(runner).collect()
}

/// All that can do what is asked.
pub(crate) fn beside_peers(path: &Path<3>, asked: Asked) {
    let (parameters, field) = (ascending(path), contestants(path, asked));
    let times = race(&mut runners(path, asked, &parameters, &field));
    report("evaluation", &json!({ "curve": path.name, "asked": format!("{asked:?}") }), &times);
}

/// Points in order and scattered, by the number of control points.
pub(crate) fn growth(count: u32) {
    let path = helix("helix", count);
    let mut field = contestants(&path, Asked::Point);
    field.retain(|contestant| [REMEMBERED, LOOKED_UP, CURVO, BSPLINE].contains(&contestant.name));
    for (order, parameters) in [("ascending", ascending(&path)), ("scattered", scattered(&path))] {
        let times = race(&mut runners(&path, Asked::Point, &parameters, &field));
        report("growth", &json!({ "points": count, "order": order }), &times);
    }
}
