//! A plan over plane curves as real time has it, and the exact points of its setpoints.

use feed_plan::{FeedPiece, KinematicLimits, ScheduleBuf, Stage};
use nurbs_core::{Evaluate, NurbsCurve, PieceLimits, Place, compile_with_stops};
use real::{Backend, DoubleDouble, Real};
use secant_interp::{ChordTolerance, CompiledPath, FeedOverride, OverrideLimits};

/// Path and plan in `R`, to land on each of its stops.
pub(crate) fn compiled<R: Backend>(
    curves: &[NurbsCurve<'_, f64, 2>],
    plan: &ScheduleBuf<f64>,
    limits: &KinematicLimits<f64>,
) -> CompiledPath<R, 2> {
    let stops: Vec<_> = plan.stages().iter().filter_map(Stage::rest).collect();
    let cut = PieceLimits { length_mm: 32.0, step_mm: limits.feedrate + limits.acceleration };
    let table = compile_with_stops::<DoubleDouble, R, 2>(curves, &cut, &stops).unwrap();
    let tolerance = ChordTolerance::for_fluctuation(None, 5);
    CompiledPath::new(table, &plan.as_schedule(), tolerance, limits.acceleration).unwrap()
}

/// What an override may do with a plan on this machine: the plan is made for less than its limits.
pub(crate) fn overrides(plan: &ScheduleBuf<f64>, machine: &KinematicLimits<f64>) -> FeedOverride {
    let most = |of: fn(&FeedPiece<f64>) -> f64| {
        plan.stages().iter().map(|stage| of(&stage.piece())).fold(0.0, f64::max)
    };
    let limits = OverrideLimits {
        acceleration: machine.acceleration,
        jerk: machine.jerk,
        planned_acceleration: most(FeedPiece::peak_acceleration),
        planned_jerk: most(FeedPiece::peak_jerk),
        planned_feed: most(|piece| piece.start_feed.max(piece.end_feed)),
    };
    FeedOverride::new(&limits).unwrap()
}

/// Where a phase of one of these pieces is; past the last one, their end.
pub(crate) fn point(
    curves: &[NurbsCurve<'_, f64, 2>],
    places: &[Place],
    (piece, phase): (usize, u64),
) -> [f64; 2] {
    let place = places[piece.min(places.len() - 1)];
    let t = if piece < places.len() { f64::from_phase(phase, 0) } else { 1.0 };
    curves[place.curve].point(place.begin.0 + (place.end.0 - place.begin.0) * t)
}
