//! What a path and a plan must be to be compiled together.

use feed_plan::{EndFeeds, FeedLimit, KinematicLimits, Schedule, ScheduleBuf, Stage, plan};
use nurbs_core::{NurbsBuf, PieceLimits, PiecesBuf, compile};
use real::{Backend, DoubleDouble, I2F30, I4F28};
use secant_interp::{ChordTolerance, CompiledPath, CompiledPathError};

/// A bend of 50 mm.
fn bend() -> NurbsBuf<f64, 2> {
    let points = vec![[0.0, 0.0], [50.0, 0.0], [50.0, 50.0]];
    NurbsBuf::try_new_nonrational(2, points, vec![0.0, 0.0, 0.0, 1.0, 1.0, 1.0]).unwrap()
}

/// 200 mm/s, 5 m/s², 400 m/s³ and 0.5 µm at a period of 1 ms, in a unit of time of which `period` is the period.
fn limits(period: f64) -> KinematicLimits<f64> {
    KinematicLimits {
        interpolation_period: period,
        feedrate: 0.2 / period,
        acceleration: 0.005 / (period * period),
        jerk: 0.0004 / (period * period * period),
        chord_error: 0.0005,
        centripetal_acceleration: None,
        axes: Default::default(),
        junction: Default::default(),
    }
}

fn planned(limits: &KinematicLimits<f64>) -> ScheduleBuf<f64> {
    let curve = bend();
    let limit = FeedLimit::along(&[curve.as_curve()], limits).unwrap();
    plan(&limit, limits, EndFeeds::default()).unwrap()
}

fn pieces<R: Backend>(step_mm: f64) -> PiecesBuf<R, 2> {
    compile::<DoubleDouble, R, 2>(&[bend().as_curve()], &PieceLimits { length_mm: 32.0, step_mm }).unwrap()
}

fn joined<R: Backend>(
    plan: &ScheduleBuf<f64>,
    step_mm: f64,
    landing_step_mm: f64,
) -> Result<CompiledPath<R, 2>, CompiledPathError> {
    let tolerance = ChordTolerance::for_fluctuation(Some(1e-6), 5);
    CompiledPath::new(pieces(step_mm), &plan.as_schedule(), tolerance, landing_step_mm)
}

#[test]
fn a_plan_in_seconds_is_refused() {
    let (periods, seconds) = (planned(&limits(1.0)), planned(&limits(1e-3)));
    assert!(joined::<f64>(&periods, 0.205, 0.005).is_ok());
    for error in [
        joined::<f64>(&seconds, 0.205, 0.005).unwrap_err(),
        joined::<I4F28>(&seconds, 0.205, 0.005).unwrap_err(),
    ] {
        assert_eq!(error, CompiledPathError::PeriodNotOne { period: 1e-3 });
        assert!(error.to_string().contains("0.001, not 1"), "{error}");
    }
}

#[test]
fn a_landing_step_of_nothing_is_refused() {
    let plan = planned(&limits(1.0));
    for step in [0.0, -0.0, -1.0, f64::NEG_INFINITY, f64::NAN] {
        let error = joined::<f64>(&plan, 0.205, step).unwrap_err();
        let CompiledPathError::LandingStepNotPositive { step: named } = error else { panic!("{error:?}") };
        assert!(
            named.to_bits() == step.to_bits() && error.to_string().contains(&format!("{step} mm")),
            "{error}"
        );
    }
    let error = joined::<I4F28>(&plan, 0.205, f64::INFINITY).unwrap_err();
    assert_eq!(error, CompiledPathError::LandingStepTooLong { step: f64::INFINITY });
    // What only a coarse format rounds to nothing is travelled in steps of its resolution.
    assert!(joined::<I4F28>(&plan, 0.205, 1e-12).is_ok());
}

/// Ranges are proven for steps of up to `step_mm`: beyond, I2F30 was off by up to 8.7 %.
#[test]
fn a_plan_that_is_faster_than_the_pieces_is_refused() {
    let plan = planned(&limits(1.0));
    let greatest = plan.stages().iter().map(|stage| stage.end_feed).fold(0.0, f64::max);
    assert!(joined::<I2F30>(&plan, greatest + 0.005, 0.005).is_ok());
    for (step_mm, landing) in [(0.12, 0.005), (greatest, 0.005), (0.205, 0.01)] {
        let error = joined::<I2F30>(&plan, step_mm, landing).unwrap_err();
        let CompiledPathError::StepTooLong { stage, step, longest } = error else { panic!("{error:?}") };
        let fastest = &plan.stages()[stage];
        assert!(fastest.start_feed.max(fastest.end_feed) == greatest && longest == step_mm);
        assert!((step - (greatest + landing)).abs() < 1e-12, "{error}");
    }
    // A feed that is no number is refused too.
    let nothing = Stage { end_feed: f64::NAN, ..plan.stages()[0] };
    let schedule = Schedule::new(core::slice::from_ref(&nothing), 1.0, 1);
    let tolerance = ChordTolerance::for_fluctuation(None, 5);
    let error = CompiledPath::new(pieces::<f64>(0.205), &schedule, tolerance, 0.005).unwrap_err();
    assert!(matches!(error, CompiledPathError::FeedTooHigh { stage: 0, feed } if feed.is_nan()), "{error}");
}
