//! Runs side by side make the setpoints that they make one by one.

use nurbs_core::{MAX_DEGREE, NurbsBuf, PieceLimits, PiecesBuf, compile, generate};
use proptest::prelude::*;
use real::{Backend, DoubleDouble, Lane, Real};
use secant_interp::{
    ChordTolerance, LaneInterpolator, LengthStage, PieceInterpolator, StageShape, StepLengths,
};

/// Runs that are followed at once; with more lanes than these each run is in several.
const RUNS: usize = 8;
const MOST_STEPS: usize = 4_000;

/// One lane's path, and what it is followed by.
#[derive(Clone, Debug)]
struct Run<const D: usize> {
    curve: NurbsBuf<f64, D>,
    feed_mm: f64,
    /// Of each stage its periods, the feed at its end, and which shape it has.
    stages: Vec<(f64, f64, usize)>,
    /// How many stages there are, those in turn: with few of them the schedule ends before the path.
    length: usize,
    fluctuation: f64,
    max_evaluations: u32,
}

/// Runs of every degree, most of them cubics, with and without weights, in cubic stages.
fn run<const D: usize>() -> impl Strategy<Value = Run<D>> {
    let degree = prop_oneof![4 => Just(3_usize), 2 => 1..=5_usize, 1 => 1..=MAX_DEGREE];
    let curve = (generate::curve::<D>(), any::<bool>(), degree, any::<bool>());
    let curve = curve.prop_map(|(curve, is_other, degree, has_weights)| {
        let points = curve.control_points().to_vec();
        if is_other || points.len() <= degree {
            return curve;
        }
        let spans = points.len() - degree;
        let weights = (0..points.len()).map(|i| 1.0 + f64::from(has_weights) * 0.4 * (1.3 * i as f64).sin());
        let inner = (1..spans).map(|i| (i as f64 + 0.3 * (i as f64).sin()) / spans as f64);
        let ends = |u: f64| std::iter::repeat_n(u, degree + 1);
        let knots = ends(0.0).chain(inner).chain(ends(1.0)).collect();
        NurbsBuf::try_new(degree, points, weights.collect(), knots).unwrap_or(curve)
    });
    let stage = (0.3..60.0_f64, 0.0..1.0_f64, prop_oneof![4 => Just(0_usize), 1 => 0..6_usize]);
    let tolerance = (prop_oneof![Just(1e-6), Just(1e-18), Just(0.16)], 1..5_u32);
    let stages = proptest::collection::vec(stage, 1..20);
    let length = prop_oneof![Just(400_usize), 1..40_usize];
    (curve, 0.05..8.0_f64, stages, length, tolerance).prop_map(
        |(curve, feed_mm, stages, length, (fluctuation, max_evaluations))| Run {
            curve,
            feed_mm,
            stages,
            length,
            fluctuation,
            max_evaluations,
        },
    )
}

type Compiled<R, const D: usize> = (PiecesBuf<R, D>, Vec<LengthStage<R>>, ChordTolerance<R>);

fn compiled<R: Backend, const D: usize>(run: &Run<D>) -> Option<Compiled<R, D>> {
    let limits = PieceLimits { length_mm: 32.0, step_mm: 1.05 * run.feed_mm };
    let table = compile::<DoubleDouble, R, D>(&[run.curve.as_curve()], &limits).ok()?;
    let full = run.feed_mm.ldexp(table.as_pieces().chord_exponent);
    let number = |x: f64| R::from_f64(x).unwrap();
    let shapes = [
        StageShape::Cubic,
        StageShape::Onset,
        StageShape::Steady,
        StageShape::Easing,
        StageShape::Cosine,
        StageShape::Bent(number(0.625)),
    ];
    let mut feed = 0.0;
    let mut stages = Vec::new();
    for (periods, part, shape) in run.stages.iter().cycle().take(run.length) {
        // Feeds below a half stay what they are, so that there is a constant feed too.
        let next = if *part < 0.2 { feed } else { part * full };
        let duration = periods.to_phase(-32);
        stages.extend(
            LengthStage::new(duration, number(feed), number(next) - number(feed))
                .map(|s| s.shaped(shapes[*shape])),
        );
        feed = next;
    }
    let tolerance = ChordTolerance::for_fluctuation(Some(run.fluctuation), run.max_evaluations);
    Some((table, stages, tolerance))
}

/// Follows the runs side by side and one by one; how many of the setpoints were found in one evaluation. Lanes begin with the first
/// `begin` runs, and take up others when they are restarted.
fn same_setpoints<R: Lane + Backend, const D: usize, const LANES: usize>(
    runs: &[Run<D>],
    begin: usize,
) -> Result<usize, TestCaseError> {
    let compiled: Vec<Compiled<R, D>> = runs.iter().filter_map(compiled).collect();
    if compiled.is_empty() {
        return Ok(0);
    }
    let run = |number: usize| {
        let (table, stages, tolerance) = &compiled[number % compiled.len()];
        let landing_step = stages.first().map_or_else(R::resolution, |stage| stage.change.half().half());
        let lengths = StepLengths { stages, crossings: &[] };
        PieceInterpolator { pieces: table.as_pieces(), lengths, tolerance: *tolerance, landing_step }
    };
    let mut runs: [PieceInterpolator<'_, R, D>; LANES] = std::array::from_fn(|lane| run(lane % begin));
    let mut states = runs.each_ref().map(PieceInterpolator::start);
    let mut lanes = LaneInterpolator::new(runs);
    prop_assert_eq!(lanes.setpoint(0), None);
    let mut found = 0;
    for step in 0..MOST_STEPS {
        let running = lanes.step();
        let mut expected_running = 0;
        for (lane, (run, state)) in runs.iter().zip(&mut states).enumerate() {
            let expected = crate::steps::step(run, state);
            prop_assert_eq!(lanes.setpoint(lane), expected, "step {} of lane {}", step, lane);
            expected_running += usize::from(expected.is_some());
            found += usize::from(expected.is_some_and(|setpoint| setpoint.evaluations == 1));
        }
        prop_assert_eq!(running, expected_running);
        if running == 0 {
            break;
        }
        // Now and then a lane takes up the next of all runs.
        if step % 97 == 96 {
            let (lane, other) = (step % LANES, run(step / 97));
            lanes.restart(lane, other);
            (runs[lane], states[lane]) = (other, other.start());
            prop_assert_eq!(lanes.setpoint(lane), None);
        }
    }
    prop_assert_eq!(lanes.setpoint(LANES), None);
    lanes.restart(LANES, runs[0]);
    Ok(found)
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 24, ..ProptestConfig::default() })]

    #[test]
    fn plane_runs_are_the_same_side_by_side(runs in proptest::collection::vec(run::<2>(), RUNS)) {
        same_setpoints::<f64, 2, RUNS>(&runs, RUNS)?;
        same_setpoints::<f32, 2, RUNS>(&runs, RUNS)?;
    }

    #[test]
    fn space_runs_are_the_same_side_by_side(runs in proptest::collection::vec(run::<3>(), RUNS)) {
        same_setpoints::<f64, 3, RUNS>(&runs, RUNS)?;
    }
}

/// Lanes that have had cubics without weights alone take up weights and higher degrees, and then a cubic again.
#[test]
fn lanes_take_up_what_they_have_not_had() {
    let run = |degree: usize, has_weights: bool| {
        let points: Vec<_> =
            (0..14).map(|i| [10.0 * f64::from(i), 20.0 * (0.7 * f64::from(i)).sin()]).collect();
        let weights = (0..14).map(|i| 1.0 + f64::from(has_weights) * 0.3 * (1.3 * f64::from(i)).sin());
        let spans = 14 - degree;
        let inner = (1..spans).map(|i| i as f64 / spans as f64);
        let ends = |u: f64| std::iter::repeat_n(u, degree + 1);
        let knots = ends(0.0).chain(inner).chain(ends(1.0)).collect();
        Run {
            curve: NurbsBuf::try_new(degree, points, weights.collect(), knots).unwrap(),
            feed_mm: 0.02,
            stages: vec![(50.0, 0.9, 0), (30.5, 0.4, 0), (40.0, 0.1, 0)],
            length: 400,
            fluctuation: 1e-6,
            max_evaluations: 5,
        }
    };
    let runs = [(3, false), (5, false), (3, true), (MAX_DEGREE, true), (3, false), (4, true)]
        .map(|(degree, has)| run(degree, has));
    for found in [same_setpoints::<f64, 2, RUNS>(&runs, 1), same_setpoints::<f32, 2, 5>(&runs, 1)] {
        assert!(found.unwrap() > 10_000);
    }
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 3, ..ProptestConfig::default() })]

    #[test]
    fn as_many_runs_as_there_may_be_are_the_same(runs in proptest::collection::vec(run::<2>(), RUNS)) {
        same_setpoints::<f64, 2, 64>(&runs, RUNS)?;
    }
}
