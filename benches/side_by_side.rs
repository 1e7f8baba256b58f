//! The project beside what a user would pick instead: times from one run, as lines of JSON. `scripts/benchmarks` runs it and
//! renders BENCHMARKS.md.
//!
//! Every race begins with a check that all contestants give the same values.

mod contestants;
mod race;
mod textbook;

use std::hint::black_box;

use contestants::{Asked, BSPLINE, CURVO, LOOKED_UP, REMEMBERED, contestants};
use feed_plan::{EndFeeds, FeedLimit};
use feedbits_benches::{Path, helix, paper_a, ten_points, thousand_points, winding};
use nurbs_core::{Differentiate, Evaluate, FastCurve, Pieces, PiecesBuf, PowerCurve};
use race::{Runner, Time, race};
use real::{Backend, DoubleDouble, I2F30, I4F28, I4F60, I16F48, Real};
use secant_interp::{ChordTolerance, LengthStage, PieceInterpolator, StepLengths};
use serde_json::{Value, json};
use textbook::Textbook;

/// Parameters of a pass over a curve.
const PARAMETERS: u32 = 20_000;

/// Steps of a run at most: the stages last no longer on the longest curve.
const MOST_STEPS: u64 = 400_000;

/// Prints the rows of one table.
fn report(table: &str, about: &Value, times: &[Time]) {
    for time in times {
        println!("{}", json!({ "table": table, "about": about, "time": time }));
    }
}

fn ascending(path: &Path<3>) -> Vec<f64> {
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
fn expected(path: &Path<3>, asked: Asked, parameters: &[f64]) -> (f64, f64) {
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

/// # Panics
/// If a contestant's sum is another one: then it does other work, and its time means nothing.
fn evaluation(path: &Path<3>, asked: Asked) {
    let parameters = ascending(path);
    let (sum, magnitude) = expected(path, asked, &parameters);
    let field = contestants(path, asked);
    for contestant in &field {
        let found = (contestant.run)(&parameters);
        let bound = 1e-11 * magnitude;
        assert!((found - sum).abs() <= bound, "{}: {found}, not {sum}, on {}", contestant.name, path.name);
    }
    let mut runners: Vec<_> = field
        .iter()
        .map(|contestant| Runner {
            name: contestant.name.to_string(),
            units: u64::from(PARAMETERS),
            run: Box::new(|| (contestant.run)(&parameters)),
        })
        .collect();
    report("evaluation", &json!({ "curve": path.name, "asked": format!("{asked:?}") }), &race(&mut runners));
}

/// Points in scattered order, by the number of control points.
fn growth_of_evaluation(count: u32) {
    let path = helix("helix", count);
    for (order, parameters) in [("ascending", ascending(&path)), ("scattered", scattered(&path))] {
        let (sum, magnitude) = expected(&path, Asked::Point, &parameters);
        let field = contestants(&path, Asked::Point);
        let kept = |name| name == REMEMBERED || name == LOOKED_UP || name == CURVO || name == BSPLINE;
        let mut runners = Vec::new();
        for contestant in field.iter().filter(|c| kept(c.name)) {
            let found = (contestant.run)(&parameters);
            assert!((found - sum).abs() <= 1e-11 * magnitude, "{}: {found}, not {sum}", contestant.name);
            runners.push(Runner {
                name: contestant.name.to_string(),
                units: u64::from(PARAMETERS),
                run: Box::new(|| (contestant.run)(&parameters)),
            });
        }
        report("growth", &json!({ "points": count, "order": order }), &race(&mut runners));
    }
}

/// A path compiled for a format, with its feeds.
struct Compiled<R, const D: usize> {
    table: PiecesBuf<R, D>,
    stages: Vec<LengthStage<R>>,
}

impl<R: Backend, const D: usize> Compiled<R, D> {
    fn new(path: &Path<D>) -> Self {
        let table = path.pieces::<R>();
        let stages = path.stages::<R>(table.as_pieces().chord_exponent);
        Self { table, stages }
    }

    fn interpolator(&self) -> PieceInterpolator<'_, R, D> {
        PieceInterpolator {
            pieces: self.table.as_pieces(),
            lengths: StepLengths { stages: &self.stages },
            tolerance: ChordTolerance {
                residual: R::from_f64(1e-3).unwrap_or_else(R::resolution),
                max_evaluations: 5,
            },
            landing_step: R::zero(),
        }
    }

    /// Follows the path; steps, and the mean of the coordinates in mm.
    fn follow(&self) -> (u64, f64) {
        let interpolator = self.interpolator();
        let pieces = interpolator.pieces;
        let mut state = interpolator.start();
        let (mut steps, mut sum) = (0_u64, 0.0);
        while steps < MOST_STEPS
            && let Some(setpoint) = interpolator.step(&mut state)
        {
            let row = setpoint.piece.min(pieces.pieces.len() - 1);
            let point = millimetres(&pieces, row, &setpoint.offset);
            sum += point.iter().sum::<f64>();
            steps += 1;
        }
        (steps, sum / steps as f64)
    }

    /// The same without a look at the points: what is timed.
    fn run(&self) -> f64 {
        let interpolator = self.interpolator();
        let mut state = interpolator.start();
        let mut steps = 0;
        while steps < MOST_STEPS
            && let Some(setpoint) = interpolator.step(&mut state)
        {
            black_box(setpoint);
            steps += 1;
        }
        steps as f64
    }
}

fn millimetres<R: Backend, const D: usize>(
    pieces: &Pieces<'_, R, D>,
    piece: usize,
    offset: &[R; D],
) -> [f64; D] {
    let origin = pieces.pieces[piece].origin;
    let at = |d: usize| {
        (origin[d] as f64).scale(nurbs_core::ORIGIN_EXPONENT)
            + offset[d].to_f64().scale(pieces.coordinate_exponent)
    };
    std::array::from_fn(at)
}

/// The step in f64 beside the textbook way, on the same feeds.
fn step_beside_textbook<const D: usize>(path: &Path<D>) {
    let ours = Compiled::<f64, D>::new(path);
    let unit_mm = 1.0_f64.scale(-ours.table.as_pieces().chord_exponent);
    let textbook = Textbook::new(&path.curve, StepLengths { stages: &ours.stages }, unit_mm);
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

/// One format's runner, after a check that it goes where f64 goes.
fn in_format<R: Backend + 'static, const D: usize>(path: &Path<D>, mean_mm: f64) -> Runner<'static> {
    let compiled = Compiled::<R, D>::new(path);
    let (steps, mean) = compiled.follow();
    assert!((mean - mean_mm).abs() <= 1e-2, "{} on {}: mean {mean}, not {mean_mm}", R::name(), path.name);
    Runner { name: R::name().to_string(), units: steps, run: Box::new(move || compiled.run()) }
}

fn formats<const D: usize>(path: &Path<D>, rational: bool) {
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
fn growth_of_steps(counts: &[u32]) {
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

/// Limit and plan, for each point at which the limit is known.
fn planning(name: &str, path: &Path<2>) {
    let limits = path.limits();
    let curves = [FastCurve::of(path.curve.as_curve())];
    let limit = FeedLimit::along(&curves, &limits).expect("a limit");
    let points = limit.points().len() as u64;
    let mut runners = [
        Runner {
            name: "limit".into(),
            units: points,
            run: Box::new(|| {
                FeedLimit::along(&curves, &limits).map_or(0.0, |limit| limit.points().len() as f64)
            }),
        },
        Runner {
            name: "plan".into(),
            units: points,
            run: Box::new(|| {
                feed_plan::plan(&limit, &limits, EndFeeds::default())
                    .map_or(0.0, |plan| plan.as_schedule().stages().len() as f64)
            }),
        },
    ];
    report("planning", &json!({ "curve": name, "points": points }), &race(&mut runners));
}

/// Runs the tables that the command line names, or all of them.
fn main() {
    let named: Vec<String> = std::env::args().skip(1).filter(|argument| !argument.starts_with('-')).collect();
    let wanted = |table: &str| named.is_empty() || named.iter().any(|name| name == table);
    let (a, b, c) = (paper_a(), ten_points(), thousand_points());
    if wanted("evaluation") {
        for path in [&a.in_space(), &b.in_space(), &c] {
            evaluation(path, Asked::Point);
            evaluation(path, Asked::Derivatives);
        }
    }
    if wanted("growth") {
        for count in [10, 100, 1000, 10_000, 100_000] {
            growth_of_evaluation(count);
        }
    }
    if wanted("step") {
        step_beside_textbook(&a);
        step_beside_textbook(&b);
        step_beside_textbook(&c);
    }
    if wanted("formats") {
        formats(&a, false);
        formats(&b, true);
        formats(&c, false);
    }
    if wanted("step-growth") {
        growth_of_steps(&[100, 1000, 10_000, 100_000]);
    }
    if wanted("planning") {
        planning("A", &a);
        for spans in [100, 1000, 10_000] {
            planning(&format!("{spans} spans"), &winding(spans));
        }
    }
}
