//! Points and derivatives: beside the peers', in every format, on long curves.

use std::hash::{BuildHasher, BuildHasherDefault, DefaultHasher};
use std::hint::black_box;

use feedbits_benches::{Path, helix};
use nurbs_core::{Derivatives, Differentiate, Evaluate};
use real::{Backend, DoubleDouble, I16F16, I16F48, I32F32};
use serde_json::json;

use crate::contestants::{
    Asked, BSPLINE, CURVO, Contestant, LOOKED_UP, REMEMBERED, contestants, many_at_once,
};
use crate::race::{Runner, race, report};

/// Parameters of a pass over a curve.
const PARAMETERS: u32 = 20_000;

/// Parameters in order, from all over the curve.
pub(crate) fn ascending<const D: usize>(path: &Path<D>) -> Vec<f64> {
    let (first, last) = path.curve.as_curve().domain();
    let at = |i: u32| first + (last - first) * (f64::from(i) + 0.5) / f64::from(PARAMETERS);
    (0..PARAMETERS).map(at).collect()
}

/// The same parameters in an order that no processor learns.
fn scattered(path: &Path<3>) -> Vec<f64> {
    let mut numbered: Vec<_> = (0_u64..).zip(ascending(path)).collect();
    numbered.sort_by_cached_key(|(i, _)| BuildHasherDefault::<DefaultHasher>::default().hash_one(i));
    numbered.into_iter().map(|(_, u)| u).collect()
}

/// What was asked for, number by number.
fn numbers<R: Copy, const D: usize>(at: &Derivatives<R, D>, asked: Asked) -> impl Iterator<Item = R> {
    let rows = if asked == Asked::Point { 1 } else { 3 };
    [at.point, at.first, at.second].into_iter().take(rows).flatten()
}

/// The sum over all parameters, and over the magnitudes that went into it, by the textbook in double-double's precision.
fn expected<const D: usize>(path: &Path<D>, asked: Asked, parameters: &[f64]) -> (f64, f64) {
    let exact = path.curve.convert::<DoubleDouble>().expect("every f64 is a double-double");
    let mut total = (DoubleDouble::from(0.0), 0.0);
    for u in parameters {
        for x in numbers(&exact.as_curve().derivatives((*u).into()), asked) {
            total = (total.0 + x, total.1 + x.value().abs());
        }
    }
    (total.0.value(), total.1)
}

/// A runner for each of the field.
///
/// # Panics
/// If a contestant's sum is another one: then it does other work, and its time means nothing.
pub(crate) fn runners<'a, const D: usize>(
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
    field.insert(2, many_at_once(&path.curve));
    for (order, parameters) in [("ascending", ascending(&path)), ("scattered", scattered(&path))] {
        let times = race(&mut runners(&path, Asked::Point, &parameters, &field));
        report("growth", &json!({ "points": count, "order": order }), &times);
    }
}

/// Basis functions, the form that every format has.
pub(crate) fn in_formats<const D: usize>(path: &Path<D>, asked: Asked) {
    let mut runners = [
        in_format::<f64, D>(path, asked),
        in_format::<f32, D>(path, asked),
        in_format::<I16F16, D>(path, asked),
        in_format::<I32F32, D>(path, asked),
        in_format::<I16F48, D>(path, asked),
    ];
    let about = json!({ "curve": path.name, "asked": format!("{asked:?}") });
    report("evaluation-formats", &about, &race(&mut runners));
}

/// One format's runner.
///
/// # Panics
/// If its numbers are off by more than a thousandth of their magnitude.
fn in_format<R: Backend + 'static, const D: usize>(path: &Path<D>, asked: Asked) -> Runner<'static> {
    let name = R::name();
    let curve = path.curve.convert::<R>().unwrap_or_else(|error| panic!("{name} on {}: {error}", path.name));
    let number = |u: &f64| R::from_f64(*u).expect("a parameter that the format holds");
    let parameters: Vec<R> = ascending(path).iter().map(number).collect();
    let (mut difference, mut magnitude) = (0.0, 0.0);
    for u in &parameters {
        let exact = path.curve.as_curve().derivatives(u.to_f64());
        let found = curve.as_curve().derivatives(*u);
        for (x, exact) in numbers(&found, asked).zip(numbers(&exact, asked)) {
            difference += (x.to_f64() - exact).abs();
            magnitude += exact.abs();
        }
    }
    assert!(difference <= 1e-3 * magnitude, "{name} on {}: {difference} of {magnitude} off", path.name);
    let pass = move || {
        let curve = curve.as_curve();
        for u in &parameters {
            match asked {
                Asked::Point => _ = black_box(curve.point(*u)),
                Asked::Derivatives => _ = black_box(curve.derivatives(*u)),
            }
        }
        0.0
    };
    Runner { name: name.to_string(), units: u64::from(PARAMETERS), run: Box::new(pass) }
}
