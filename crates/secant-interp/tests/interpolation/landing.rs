//! What is left after the schedule's end, and periods in which the schedule stands still.

use crate::steps::step;
use feed_plan::{Schedule, Stage, StageShape};
use nurbs_core::{NurbsBuf, PieceLimits, compile};
use real::{Backend, DoubleDouble, I2F30, I4F28, I8F24, Real};
use secant_interp::{
    ChordTolerance, CompiledPath, Interpolator, LengthStage, Method, PieceInterpolator, StepLengths,
    Tolerance,
};

fn line(length_mm: f64) -> NurbsBuf<f64, 2> {
    NurbsBuf::try_new_nonrational(1, vec![[0.0; 2], [length_mm, 0.0]], vec![0.0, 0.0, 1.0, 1.0]).unwrap()
}

/// At an even feed, in mm per period.
fn steady(start: f64, feed: f64, duration: f64) -> Stage<f64> {
    Stage {
        start,
        length: feed * duration,
        start_feed: feed,
        end_feed: feed,
        duration,
        shape: StageShape::Steady,
        curve_start: 0,
        u_start: 0.0,
        curve_end: 0,
        u_end: 0.0,
    }
}

/// The steps on pieces of a line of 10 mm, at an even feed, that stops so much before its end.
fn steps_on_pieces<R: Backend>(feed: f64, missing_mm: f64, landing_mm: f64) -> Vec<[f64; 2]> {
    let (curve, limits) = (line(10.0), PieceLimits { length_mm: 32.0, step_mm: feed + landing_mm });
    let table = compile::<DoubleDouble, R, 2>(&[curve.as_curve()], &limits).unwrap();
    let unit = 1.0_f64.ldexp(table.as_pieces().chord_exponent);
    let stages = [steady(0.0, feed, (10.0 - missing_mm) / feed)];
    let tolerance = ChordTolerance::for_fluctuation(None, 5);
    let path = CompiledPath::new(table, &Schedule::new(&stages, 1.0, 0), tolerance, landing_mm).unwrap();
    let run = path.runs().next().unwrap();
    let (mut state, mut x, mut steps) = (run.start(), 0.0, Vec::new());
    while let Some(setpoint) = step(&run, &mut state) {
        let next = setpoint.offset[0].to_f64().ldexp(run.pieces.coordinate_exponent);
        steps.push([setpoint.length.to_f64() / unit, next - x]);
        x = next;
        assert!(steps.len() < 10_000, "{} does not end", R::name());
    }
    assert!((x - 10.0).abs() < 1e-6, "{}: {x}", R::name());
    steps
}

/// From rest to a landing step and back is an acceleration of A each: twice that step would be twice A.
#[test]
fn what_is_left_is_travelled_in_landing_steps() {
    let steps = steps_on_pieces::<f64>(0.5, 1.0, 0.1);
    // The schedule's last step may be longer by the landing step; then 0.9 mm are left.
    for [wanted, moved] in &steps[18..steps.len() - 1] {
        assert!((wanted - 0.1).abs() < 1e-12 && (moved - 0.1).abs() < 1e-9, "{wanted} {moved}");
    }
    assert!((26..=28).contains(&steps.len()), "{}", steps.len());
}

/// Landing steps far longer than the planned ones come near the format's range: their sum with a step stays within it.
#[test]
fn a_landing_step_near_the_range_of_the_format_lands() {
    let float = steps_on_pieces::<f64>(0.02, 0.3, 0.04).len();
    for count in [
        steps_on_pieces::<I2F30>(0.02, 0.3, 0.04).len(),
        steps_on_pieces::<I4F28>(0.02, 0.3, 0.04).len(),
        steps_on_pieces::<I8F24>(0.02, 0.3, 0.04).len(),
    ] {
        assert!(count.abs_diff(float) <= 1, "{count} for {float}");
    }
}

/// Pieces cut for steps that are too short for the landing step: out of what was promised, and still it ends.
#[test]
fn a_landing_step_that_the_pieces_were_not_cut_for_ends() {
    let curve = line(10.0);
    let table = compile::<DoubleDouble, I4F28, 2>(
        &[curve.as_curve()],
        &PieceLimits { length_mm: 32.0, step_mm: 0.021 },
    )
    .unwrap();
    let unit = 1.0_f64.ldexp(table.as_pieces().chord_exponent);
    let number = |mm: f64| I4F28::from_f64(mm * unit).unwrap();
    let stages = [LengthStage::new(485 << 32, number(0.02), number(0.0)).unwrap()];
    let run = PieceInterpolator {
        pieces: table.as_pieces(),
        lengths: StepLengths { stages: &stages, crossings: &[] },
        tolerance: ChordTolerance::for_fluctuation(None, 5),
        landing_step: number(0.04),
    };
    let mut state = run.start();
    let count = (0..10_000).take_while(|_| step(&run, &mut state).is_some()).count();
    assert!(count < 600, "{count}");
}

/// The parameters of a run with one global parameter.
fn parameters((stages, periods): (&[Stage<f64>], u64), end: f64, landing_step: f64) -> Vec<f64> {
    let curve =
        NurbsBuf::try_new_nonrational(1, vec![[0.0; 2], [10.0, 0.0]], vec![0.0, 0.0, end, end]).unwrap();
    let run = Interpolator {
        curve: curve.as_curve(),
        schedule: Schedule::new(stages, 1.0, periods),
        method: Method::Secant,
        tolerance: Tolerance { parameter: 1e-12, fluctuation: 1e-9, max_iterations: 20 },
        landing_step,
    };
    let mut state = run.start();
    let mut all = Vec::new();
    while let Some(setpoint) = run.step(&mut state) {
        all.push(setpoint.u);
        assert!(all.windows(2).all(|pair| pair[0] <= pair[1]), "{:?}", &all[all.len().saturating_sub(2)..]);
        assert!(all.len() < 1_000, "at {} of {end}", setpoint.u);
        if landing_step == 1e-20 && all.len() > 900 {
            return all;
        }
    }
    assert_eq!(all.last(), Some(&end));
    all
}

#[test]
fn a_dwell_holds_the_parameter_and_the_run_goes_on() {
    let stages = [steady(0.0, 0.5, 10.0), steady(5.0, 0.0, 3.0), steady(5.0, 0.5, 10.0)];
    let all = parameters((&stages, 23), 1.0, 0.01);
    assert_eq!(all[9..13], [all[9]; 4], "{all:?}");
    assert!((23..=24).contains(&all.len()), "{all:?}");
}

#[test]
fn a_landing_step_of_nothing_moves_on_all_the_same() {
    let stages = [steady(0.0, 0.5, 19.0)];
    // 0.5 of 10 mm are left, and the parameter's last place would take ages: it moves, and never back.
    let all = parameters((&stages, 19), 1000.0, 1e-20);
    let stays = all.windows(2).find(|pair| pair[0] >= pair[1]);
    assert_eq!(stays, None);
}

/// Numbers that are none end a run where it stands; they once made setpoints that are none, without end.
#[test]
fn a_schedule_that_holds_no_numbers_ends_the_run() {
    let curve = line(10.0);
    for bad in [f64::NAN, f64::INFINITY, f64::NEG_INFINITY] {
        let good = steady(0.0, 0.5, 4.0);
        for (stage, landing_step) in [
            (Stage { end_feed: bad, shape: StageShape::Cubic, ..good }, 0.01),
            (Stage { start_feed: bad, end_feed: bad, ..good }, 0.01),
            (Stage { duration: bad, ..good }, 0.01),
            (good, bad),
        ] {
            for method in [Method::Secant, Method::Taylor1, Method::Taylor2] {
                let stages = [good, stage, good];
                let run = Interpolator {
                    curve: curve.as_curve(),
                    schedule: Schedule::new(&stages, 1.0, 12),
                    method,
                    tolerance: Tolerance { parameter: 1e-12, fluctuation: 1e-9, max_iterations: 20 },
                    landing_step,
                };
                let (mut state, mut count) = (run.start(), 0);
                while let Some(setpoint) = run.step(&mut state) {
                    count += 1;
                    assert!(
                        setpoint.u.is_finite() && setpoint.point[0].is_finite(),
                        "{stage:?}: {setpoint:?}"
                    );
                    assert!(count < 2000, "{method:?} {landing_step} {stage:?}: at {}", setpoint.u);
                }
                assert!(count >= 3 && state.is_finished(), "{method:?} {stage:?}: {count}");
            }
        }
    }
}
