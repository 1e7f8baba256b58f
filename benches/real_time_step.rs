//! The real-time step: beside the textbook's, in every format, on long paths.

use std::hint::black_box;

use feedbits_benches::{Path, helix};
use nurbs_core::{Pieces, PowerCurve};
use real::{Backend, I2F30, I4F28, I4F60, I16F48, Real};
use secant_interp::StepLengths;
use serde_json::json;

use crate::chords::{Chords, STEPS, look};
use crate::compiled::Compiled;
use crate::race::{Runner, race, report};
use crate::textbook::Textbook;

/// The step in f64 beside the textbook way, on the same feeds.
pub(crate) fn beside_textbook<const D: usize>(path: &Path<D>) {
    let ours = Compiled::<f64, D>::new(path);
    let unit_mm = 1.0_f64.ldexp(-ours.table.as_pieces().chord_exponent);
    let textbook = Textbook::new(&path.curve, StepLengths { stages: &ours.stages, crossings: &[] }, unit_mm);
    let (steps, mean) = ours.follow();
    let mut state = textbook.start();
    let (mut theirs, mut sum) = (0_u64, 0.0);
    while let Some((_, point)) = textbook.step(&mut state) {
        sum += point.iter().sum::<f64>();
        theirs += 1;
    }
    // It leaves the last point out, which is no whole step.
    assert!(theirs.abs_diff(steps) <= 2, "{}: {theirs} steps, not {steps}", path.name);
    let difference = (sum / theirs as f64 - mean).abs();
    assert!(difference <= 1e-3 + 300.0 / steps as f64, "{}: mean off by {difference} mm", path.name);
    let evaluations = state.evaluations as f64 / theirs as f64;
    let mut runners = [
        Runner { name: "pieces, f64".into(), units: steps, run: Box::new(|| ours.run()) },
        Runner {
            name: "textbook, f64".into(),
            units: theirs,
            run: Box::new(|| {
                let mut state = textbook.start();
                while let Some(setpoint) = textbook.step(&mut state) {
                    black_box(setpoint);
                }
                0.0
            }),
        },
    ];
    let about = json!({ "curve": path.name, "steps": steps, "textbook_evaluations": evaluations });
    report("step", &about, &race(&mut runners));
}

/// The step in f64 by a given chord beside plain Newton iterations.
///
/// # Panics
/// If a way makes other steps than the others, or a chord that is off by more than the fluctuation asked for.
pub(crate) fn beside_newton<const D: usize>(path: &Path<D>) {
    let chords = Chords::of(path);
    let ways = [
        ("pieces", chords.judged(|see| chords.on_pieces(|at| see(chords.in_mm(at), at.evaluations)))),
        ("newton", chords.judged(|see| chords.by_newton::<false>(|at| see(at.point, at.evaluations)))),
        ("trend", chords.judged(|see| chords.by_newton::<true>(|at| see(at.point, at.evaluations)))),
    ];
    let mut about = json!({ "curve": path.name });
    for (name, (steps, evaluations, worst)) in ways {
        assert!(steps == STEPS && worst <= 1e-6, "{name} on {}: {steps} steps, {worst}", path.name);
        about[name] = json!({ "evaluations": f64::from(evaluations) / f64::from(steps), "worst": worst });
    }
    let units = u64::from(STEPS);
    let mut runners = [
        Runner { name: "pieces".into(), units, run: Box::new(|| chords.on_pieces(look)) },
        Runner { name: "newton".into(), units, run: Box::new(|| chords.by_newton::<false>(look)) },
        Runner { name: "trend".into(), units, run: Box::new(|| chords.by_newton::<true>(look)) },
    ];
    report("newton", &about, &race(&mut runners));
}

/// One format's runner, after a check that it goes where f64 goes.
pub(crate) fn in_format<R: Backend + 'static, const D: usize>(
    path: &Path<D>,
    mean_mm: f64,
) -> Runner<'static> {
    let compiled = Compiled::<R, D>::new(path);
    let (steps, mean) = compiled.follow();
    assert!((mean - mean_mm).abs() <= 1e-2, "{} on {}: mean {mean}, not {mean_mm}", R::name(), path.name);
    Runner { name: R::name().to_string(), units: steps, run: Box::new(move || compiled.run()) }
}

pub(crate) fn formats<const D: usize>(path: &Path<D>, rational: bool) {
    let (_, mean) = Compiled::<f64, D>::new(path).follow();
    let mut runners = vec![in_format::<f64, D>(path, mean), in_format::<f32, D>(path, mean)];
    if !rational {
        runners.push(in_format::<I2F30, D>(path, mean));
        runners.push(in_format::<I4F28, D>(path, mean));
        runners.push(in_format::<I4F60, D>(path, mean));
    }
    runners.push(in_format::<I16F48, D>(path, mean));
    report("formats", &json!({ "curve": path.name }), &race(&mut runners));
}

/// Time of a step and bytes of what is compiled, by the number of control points.
pub(crate) fn growth(counts: &[u32]) {
    let mut runners: Vec<_> = counts
        .iter()
        .map(|count| {
            let path = helix("helix", *count);
            let compiled = Compiled::<f64, 3>::new(&path);
            memory(*count, &path, &compiled.table.as_pieces());
            let (steps, _) = compiled.follow();
            Runner { name: count.to_string(), units: steps, run: Box::new(move || compiled.run()) }
        })
        .collect();
    report("step-growth", &json!({}), &race(&mut runners));
}

/// Bytes of what is compiled, beside those of control points, weights and knots.
fn memory(count: u32, path: &Path<3>, pieces: &Pieces<'_, f64, 3>) {
    let curve = &path.curve;
    let input =
        size_of_val(curve.control_points()) + size_of_val(curve.weights()) + size_of_val(curve.knots());
    let compiled = size_of_val(pieces.pieces) + size_of_val(pieces.numerators) + size_of_val(pieces.weights);
    let row = json!({
        "table": "memory", "points": count, "input": input, "pieces": compiled, "rows": pieces.pieces.len(),
        "power": PowerCurve::new::<f64>(&curve.as_curve()).bytes(),
    });
    println!("{row}");
}
