//! The look-ahead: from a feed limit to a schedule.
//!
//! 1. *Key points*: the two ends, and every local minimum of the limit, stops among them.
//! 2. *Between the rests*, by the profile: transitions from key to key (`ramps`, which the profile flexible merges), the fastest
//!    profile (`fastest`), or the feed that the path allows here and now (`without_look_ahead`).
//! 3. *Whole periods*: from stop to stop the plan is stretched in time to a whole number of periods: by less than one, and where the
//!    path bends by 2⁻¹³ of the time before.

use alloc::vec::Vec;

use real::Real;

use crate::plan::fastest::parts::{SectionKeys, SlowWay, in_parts};
use crate::plan::fastest::sections::in_window;
use crate::plan::key_points::{Key, key_points};
use crate::plan::ramp_shape::RampShape;
use crate::plan::ramps::{chain, ramps, reachable};
use crate::plan::stages::Stages;
use crate::plan::whole_periods::stretch;
use crate::plan::without_look_ahead::without_look_ahead;
use crate::schedule::stage::duration;
use crate::{EndFeeds, FeedLimit, KinematicLimits, PlanError, ProfileKind, ScheduleBuf, Stage};

/// A schedule along the path by the profile for whoever names none: [`plan_with`] [`ProfileKind::default`].
///
/// # Errors
/// As [`plan_with`].
pub fn plan<R: Real>(
    limit: &FeedLimit<R>,
    limits: &KinematicLimits<R>,
    ends: EndFeeds<R>,
) -> Result<ScheduleBuf<R>, PlanError> {
    plan_with(limit, limits, ends, ProfileKind::default())
}

/// A schedule along the path: under the limit everywhere, within acceleration and jerk. [`ProfileKind::Fastest`] is as fast as any
/// motion within these limits may be, nearly; the other profiles as a chain of transitions between a few levels of feed.
/// [`ProfileKind::WithoutLookAhead`] keeps neither acceleration nor jerk where the path bends.
///
/// The feed is continuous and so is the acceleration. At both ends of a stage that is a whole transition or a cruise it is
/// zero; between stages of constant jerk it is not. Each
/// part between two stops is slowed down evenly to a whole number of interpolation periods, and where it bends by 2⁻¹³ at least: that
/// is left to [`FeedLimit::in_chords`]. So no feed is quite the commanded one, and end feeds other than 0 come out slightly lower than
/// asked for.
///
/// Units: those of `limits`, which must be those that `limit` was made with. Of the limits, only
/// acceleration, jerk and interpolation period are used here; the others are in the limit curve. Accuracy: in
/// f64 the plan keeps its limits to rounding, 10⁻¹² relative; in other formats to a few units of their
/// resolution in each quantity.
///
/// # Errors
/// [`PlanError::NotPositive`] and [`PlanError::Negative`] for limits and end feeds that are none;
/// [`PlanError::StartFeedTooHigh`] and [`PlanError::EndFeedTooHigh`] for end feeds that the limit or the
/// acceleration do not allow; [`PlanError::CannotMove`] where the limit is zero over a stretch, or too low
/// for the format; [`PlanError::DurationOverflows`] when the periods cannot be counted, and
/// [`PlanError::TooManyPeriods`] when there are more than [`MOST_PERIODS`](crate::MOST_PERIODS).
pub fn plan_with<R: Real>(
    limit: &FeedLimit<R>,
    limits: &KinematicLimits<R>,
    ends: EndFeeds<R>,
    kind: ProfileKind,
) -> Result<ScheduleBuf<R>, PlanError> {
    let mut stages = stages(limit, limits, ends, None, kind)?;
    let periods = stretch(&mut stages, limit, limits.interpolation_period)?;
    Ok(ScheduleBuf { stages, interpolation_period: limits.interpolation_period, periods })
}

/// How the plan of a window along the fastest profile begins and goes on; the other profiles know nothing of it.
#[derive(Clone, Copy)]
pub(crate) struct InWindow<R> {
    /// The acceleration at the begin.
    pub(crate) start: R,
    /// Sections from rest to rest up to this distance are final. Other stages can go on from any joint behind it.
    pub(crate) kept_to: R,
}

/// The stages before they are stretched to whole periods.
pub(crate) fn stages<R: Real>(
    limit: &FeedLimit<R>,
    limits: &KinematicLimits<R>,
    ends: EndFeeds<R>,
    window: Option<InWindow<R>>,
    kind: ProfileKind,
) -> Result<Vec<Stage<R>>, PlanError> {
    limits.validate()?;
    let shape = RampShape::new(kind, limits);
    let keys = key_points(limit, ends)?;
    let mut stages = Stages::new(limit);
    match kind {
        ProfileKind::Fastest => quick_sections(limit, limits, &shape, &keys, window, &mut stages)?,
        ProfileKind::WithoutLookAhead => {
            for section in from_rest_to_rest(&keys) {
                if let [from, .., to] = section {
                    without_look_ahead(limit, limits, [from, to], &mut stages)?;
                }
            }
        }
        ProfileKind::Cubic | ProfileKind::SCurve | ProfileKind::Trigonometric => {
            ramps(limit, &shape, &keys, &mut stages)?;
        }
        ProfileKind::Flexible => {
            ramps(limit, &shape, &keys, &mut stages)?;
            stages.merge(limits);
        }
    }
    Ok(stages.with_parameters())
}

/// From rest to rest the fastest profile. A section of a window's plan that begins in motion, or that is not kept whole, can be left at
/// any joint.
fn quick_sections<R: Real>(
    limit: &FeedLimit<R>,
    limits: &KinematicLimits<R>,
    shape: &RampShape<R>,
    keys: &[Key<R>],
    window: Option<InWindow<R>>,
    stages: &mut Stages<'_, R>,
) -> Result<(), PlanError> {
    let mut acceleration = window.map_or_else(R::zero, |window| window.start);
    for section in from_rest_to_rest(keys) {
        let [from, .., to] = section else { break };
        let is_kept = |window: InWindow<R>| from.feed.is_zero() && to.distance <= window.kept_to;
        if window.is_none_or(is_kept) {
            stages.extend(&quicker(limit, limits, shape, section)?);
            continue;
        }
        let quick = in_window(limit, limits, [from.point, to.point], [from.feed, to.feed], acceleration);
        match quick {
            Some(quick) => stages.extend(&quick),
            // S-curves have no acceleration at their begin, as a window's plan may have.
            None if from.feed > R::zero() => return Err(PlanError::StartFeedTooHigh),
            None => stages.extend(&quicker(limit, limits, shape, section)?),
        }
        acceleration = R::zero();
    }
    Ok(())
}

/// The stages of a section along the fastest profile, or S-curves where these are no slower.
fn quicker<R: Real>(
    limit: &FeedLimit<R>,
    limits: &KinematicLimits<R>,
    shape: &RampShape<R>,
    keys: &[Key<R>],
) -> Result<Vec<Stage<R>>, PlanError> {
    // There may be none to or from a feed at an end of the path that the fastest profile has.
    let slow = reachable(limit, shape, keys).and_then(|reached| {
        let mut curves = Stages::new(limit);
        chain(limit, shape, &reached, &mut curves)?;
        Ok((reached, curves.bare()))
    });
    let of_slow = slow.as_ref().map(|(reached, curves)| SlowWay { reached, curves });
    let quick =
        in_parts(limit, limits, shape, &SectionKeys { all: keys, slow: of_slow.map_err(|error| *error) })?;
    Ok(match slow {
        Ok((_, curves)) if !(duration(&quick) < duration(&curves)) => curves,
        _ => quick,
    })
}

/// The keys of each section, with the rests or ends of the path on both sides.
fn from_rest_to_rest<R: Real>(keys: &[Key<R>]) -> impl Iterator<Item = &[Key<R>]> {
    let mut rest = keys;
    core::iter::from_fn(move || {
        let behind = rest.get(1..).filter(|behind| !behind.is_empty())?;
        let last = behind.iter().position(|key| key.feed.is_zero()).unwrap_or(behind.len() - 1) + 1;
        let section = rest.get(..=last)?;
        rest = rest.get(last..)?;
        Some(section)
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::plan::promises::{Worst, kept, planned, worst};
    use crate::test_paths::{
        Fixed, circle, in_fixed, in_periods, in_range, limit_along, limit_through, paper_limits, polyline,
        seed_000, seed_003, triple_knot,
    };
    use crate::{AxisLimits, LimitPoint, jerk_free_duration};
    use nurbs_core::{Differentiate, NurbsBuf, radius};
    use proptest::prelude::*;
    use real::{Backend, DoubleDouble};

    #[test]
    fn the_papers_curves_take_hardly_longer_than_without_a_jerk_limit() {
        let fast = |t: f64| in_periods(t, 200.0, 5000.0, 4e5, 5e-4);
        let slow = in_periods(3e-3, 200.0, 1000.0, 2e4, 5e-4);
        // Curve, limits, periods (what is reached, with 0.2 % to spare), bound in periods.
        for (name, curve, limits, periods, bound) in [
            ("seed 000", seed_000(), fast(3e-3), 1632, 1615.9),
            ("seed 000, 1 ms", seed_000(), fast(1e-3), 4242, 4213.5),
            // Here the paper's own rows overlap.
            ("seed 000, short flanks", seed_000(), slow, 1725, 1669.2),
            ("seed 003", seed_003(), fast(3e-3), 566, 534.9),
            ("seed 003, short flanks", seed_003(), slow, 739, 638.6),
            ("circle", circle(10.0), fast(3e-3), 325, 318.7),
        ] {
            let (limit, plan) = planned(&curve, &limits);
            assert!(plan.as_schedule().periods() <= periods, "{name}: {}", plan.as_schedule().periods());
            let jerk_free = jerk_free_duration(&limit, &limits, EndFeeds::default());
            assert!((jerk_free - bound).abs() < 0.5, "{name}: {jerk_free}");
        }
    }

    /// S-curves have no acceleration at a feed with which a path begins, so they cannot follow a limit that falls there at once. The fastest
    /// profile can, nearly.
    #[test]
    fn a_path_that_begins_at_its_limit_needs_no_s_curves() {
        let limits = paper_limits();
        let mut alone = 0;
        for k in 1..=200 {
            let fall = 1e-4 * f64::from(k);
            let limit = limit_through(&[(0.0, 0.5), (2.0, 0.5 - fall), (30.0, 0.3), (60.0, 0.5)]);
            let ends = EndFeeds { start: 0.5, end: 0.0 };
            let [fast, slow] = [ProfileKind::Fastest, ProfileKind::SCurve]
                .map(|kind| plan_with(&limit, &limits, ends, kind).is_ok());
            assert!(fast || !slow, "{fall}");
            alone += u32::from(fast && !slow);
        }
        assert!(alone > 0);
    }

    #[test]
    fn the_curve_s_own_limit_holds_between_the_points_too() {
        for (curve, limits) in [
            (seed_000(), paper_limits()),
            (seed_003(), paper_limits()),
            (seed_003(), in_periods(3e-3, 200.0, 1000.0, 2e4, 5e-4)),
        ] {
            let (limit, plan) = planned(&curve, &limits);
            let mut excess = f64::NEG_INFINITY;
            for stage in plan.stages() {
                // Ten times a period; the last place is the stage's end.
                let times = (0..).map(|i| f64::from(i) / 10.0).take_while(|time| *time < stage.duration);
                for time in times.chain([stage.duration]) {
                    let (_, u) = limit.parameter_at(stage.start + stage.distance_at(time));
                    let allowed = limits.feedrate_at_radius(radius(&curve.as_curve().derivatives(u)));
                    excess = excess.max(stage.feed_at(time) / allowed - 1.0);
                }
            }
            assert!(excess <= 0.0, "{excess}");
        }
    }

    #[test]
    fn a_constant_limit_is_reached_and_held() {
        let (limit, plan) = planned(&circle(10.0), &paper_limits());
        let top = plan.stages().iter().map(|stage| stage.start_feed).fold(0.0, f64::max);
        // 2 sqrt(0.0005 (20 - 0.0005)) = 0.199 9975; the stretch to whole periods takes up to 1/325 of it.
        assert!((0.1993..=limit.at(30.0)).contains(&top), "{top}");
    }

    #[test]
    fn the_plan_stops_at_a_corner() {
        let curve = triple_knot();
        let (limit, plan) = planned(&curve, &in_periods(3e-3, 190.0, 5000.0, 4e5, 5e-4));
        let corner = limit.points().find(|point| point.feedrate == 0.0).unwrap();
        assert!((corner.u - 0.5).abs() < 1e-12 && (corner.distance - 30.0).abs() < 1e-9, "{corner:?}");
        let joint = plan.stages().iter().find(|stage| stage.start_feed == 0.0 && stage.start > 0.0).unwrap();
        assert!((joint.start - corner.distance).abs() < 1e-9);
        assert!((joint.u_start - 0.5).abs() < 1e-9);
        // The stop is at the end of a period: a chord over it would cut the corner.
        let before: f64 = plan
            .stages()
            .iter()
            .take_while(|stage| stage.start < joint.start)
            .map(|stage| stage.duration)
            .sum();
        assert!((before - before.round()).abs() < 1e-9 && before > 10.0, "{before}");
    }

    #[test]
    fn curves_in_sequence_are_one_path() {
        let limits = paper_limits();
        let path = polyline(&[[0.0, 0.0], [10.0, 0.0], [30.0, 0.0], [30.0, 5.0]]);
        let limit = limit_along(&path, &limits);
        let plan = kept(&limit, &limits, ProfileKind::Cubic);
        // No stop at 10 mm, where the lines have the same direction; one at 30 mm.
        let stops: Vec<_> = limit.points().filter(|p| p.feedrate == 0.0).map(|p| p.distance).collect();
        assert_eq!(stops.len(), 1);
        assert!((stops[0] - 30.0).abs() < 1e-12);
        let last = plan.stages().last().unwrap();
        assert_eq!((last.curve_end, last.u_end), (2, 1.0));
    }

    #[test]
    fn ends_may_have_a_feed() {
        let limits = paper_limits();
        let limit = FeedLimit::along(&[seed_000().as_curve()], &limits).unwrap();
        let plan_with = |start, end| plan(&limit, &limits, EndFeeds { start, end });
        let running = plan_with(0.6, 0.6).unwrap();
        let (first, last) = (running.stages().first().unwrap(), running.stages().last().unwrap());
        // The stretch to whole periods, of less than 1 in 1600, lowers them.
        assert!(first.start_feed > 0.6 * (1.0 - 1e-3) && first.start_feed <= 0.6, "{}", first.start_feed);
        assert!(last.end_feed > 0.6 * (1.0 - 1e-3) && last.end_feed <= 0.6, "{}", last.end_feed);
        assert!(running.as_schedule().periods() < plan_with(0.0, 0.0).unwrap().as_schedule().periods());

        assert_eq!(plan_with(0.7, 0.0), Err(PlanError::StartFeedTooHigh));
        assert_eq!(plan_with(0.0, 0.7), Err(PlanError::EndFeedTooHigh));
        assert_eq!(plan_with(-0.1, 0.0), Err(PlanError::Negative { what: "start feed" }));
        assert_eq!(plan_with(0.0, f64::NAN), Err(PlanError::Negative { what: "end feed" }));
    }

    #[test]
    fn a_feed_that_cannot_be_changed_in_time_is_an_error() {
        let limits = paper_limits();
        // From 0.6 to rest takes 33 periods and 10 mm, here are 2 mm.
        let short = limit_through(&[(0.0, 0.6), (2.0, 0.6)]);
        let plan_with = |start, end| plan(&short, &limits, EndFeeds { start, end });
        assert_eq!(plan_with(0.6, 0.0), Err(PlanError::StartFeedTooHigh));
        assert_eq!(plan_with(0.0, 0.6), Err(PlanError::EndFeedTooHigh));
        assert!(plan_with(0.6, 0.6).is_ok() && plan_with(0.0, 0.0).is_ok());
    }

    #[test]
    fn a_limit_of_zero_over_a_stretch_is_an_error() {
        let limit = limit_through(&[(0.0, 0.6), (5.0, 0.0), (6.0, 0.0), (9.0, 0.6)]);
        assert_eq!(
            plan(&limit, &paper_limits(), EndFeeds::default()),
            Err(PlanError::CannotMove { curve: 0 })
        );
        assert_eq!(jerk_free_duration(&limit, &paper_limits(), EndFeeds::default()), f64::MAX);
    }

    #[test]
    fn any_length_can_be_travelled() {
        let limits = paper_limits();
        for exponent in -9..=5 {
            let path = polyline(&[[0.0, 0.0], [10.0_f64.powi(exponent), 0.0]]);
            planned(&path[0], &limits);
        }
    }

    /// The same curve planned in another format: periods, and the worst of each promise.
    fn in_format<Q: Backend>(
        curve: &NurbsBuf<f64, 2>,
        limits: &KinematicLimits<f64>,
        kind: ProfileKind,
    ) -> (u64, f64, Worst) {
        let curve = curve.convert::<Q>().unwrap();
        let limits = in_range::<Q>(limits);
        let limit = FeedLimit::along(&[curve.as_curve()], &limits).unwrap();
        let plan = plan_with(&limit, &limits, EndFeeds::default(), kind).unwrap();
        let worst = worst(&limit, &limits, &plan);
        (plan.as_schedule().periods(), plan.as_schedule().length().to_f64(), worst)
    }

    #[test]
    fn narrow_formats_plan_almost_the_same() {
        // By how much periods as a ratio, length in mm, and the limits as ratios may differ from f64's.
        fn assert_close<Q: Backend>(limits: &KinematicLimits<f64>, periods: f64, length: f64, excess: f64) {
            for kind in ProfileKind::ALL {
                let (reference, _, _) = in_format::<f64>(&seed_003(), limits, kind);
                let (found, found_length, worst) = in_format::<Q>(&seed_003(), limits, kind);
                let name = Q::name();
                let difference = found as f64 / reference as f64 - 1.0;
                assert!(difference.abs() <= periods, "{name}, {kind:?}: {found} for {reference}");
                assert!((found_length - 134.006_017).abs() <= length, "{name}, {kind:?}: {found_length}");
                assert!(worst.feed <= 1.0 + excess, "{name}, {kind:?}: {worst:?}");
                assert!(worst.acceleration.max(worst.jerk) <= 1.0 + excess, "{name}, {kind:?}: {worst:?}");
            }
        }
        let path_only = paper_limits();
        let axis = AxisLimits { velocity: Some(0.3), acceleration: Some(0.02), jerk: Some(0.006) };
        let with_axes = KinematicLimits { axes: [axis; 3], ..path_only };
        for limits in [path_only, with_axes] {
            assert_close::<DoubleDouble>(&limits, 0.005, 1e-6, 1e-12);
            assert_close::<f32>(&limits, 0.01, 1e-3, 1e-3);
            in_fixed("I32F32", || assert_close::<Fixed>(&limits, 0.01, 1e-3, 1e-3));
        }
    }

    #[test]
    fn formats_too_coarse_return() {
        in_fixed("I16F16", too_coarse_returns);
    }

    fn too_coarse_returns() {
        // A circle just fits 16 fraction bits, with E as 33 units: the plan is as long as it should be to 1.5
        // %, and its arc length to 1e-4.
        let limits = in_range::<Fixed>(&paper_limits());
        let plan_of = |curve: &NurbsBuf<Fixed, 2>| {
            let limit = FeedLimit::along(&[curve.as_curve()], &limits)?;
            plan(&limit, &limits, EndFeeds::default())
        };
        let circle = plan_of(&circle(10.0).convert().unwrap()).unwrap();
        assert!(circle.as_schedule().periods().abs_diff(325) <= 5, "{}", circle.as_schedule().periods());
        assert!(
            (circle.as_schedule().length().to_f64() - 62.832).abs() < 6e-3,
            "{:?}",
            circle.as_schedule().length()
        );
        // The papers' curves have second derivatives beyond it. What comes out has no meaning, but it does come out.
        for curve in [seed_000(), seed_003()] {
            let _ = plan_of(&curve.convert().unwrap());
        }
    }

    /// Limit curves of any shape: rises, falls, jumps, plateaus, stops.
    fn limit_points() -> impl Strategy<Value = Vec<(f64, f64)>> {
        let step = prop_oneof![1 => Just(0.0), 8 => 0.01..3.0_f64, 1 => 3.0..100.0_f64];
        let feed = prop_oneof![6 => 0.02..1.0_f64, 2 => Just(0.6), 1 => 1e-4..0.02_f64];
        let is_stop = prop::bool::weighted(0.08);
        prop::collection::vec((step, feed, is_stop), 2..60).prop_map(|rows| {
            let mut distance = 0.0;
            let mut points: Vec<(f64, f64)> = Vec::new();
            for (i, (step, feedrate, is_stop)) in rows.into_iter().enumerate() {
                let previous_stops = points.last().is_some_and(|(_, feed)| *feed == 0.0);
                // Between two stops there must be a limit above zero.
                let is_stop = is_stop && !previous_stops;
                distance += match i {
                    0 => 0.0,
                    1 => step.max(0.01),
                    _ => step,
                };
                points.push((distance, if is_stop { 0.0 } else { feedrate }));
            }
            points
        })
    }

    proptest! {
        #![proptest_config(ProptestConfig::with_cases(400))]

        #[test]
        fn whatever_the_limit_the_plan_keeps_every_promise(
            points in limit_points(), acceleration in 1e-4..0.2_f64, jerk in 1e-5..0.1_f64,
        ) {
            let limits = KinematicLimits { acceleration, jerk, ..paper_limits() };
            let limit = limit_through(&points);
            for kind in ProfileKind::ALL {
                kept(&limit, &limits, kind);
            }
        }

        #[test]
        fn whatever_the_numbers_the_planner_returns(
            points in prop::collection::vec((any::<f32>(), any::<f32>()), 0..20), acceleration in any::<f32>(), jerk in any::<f32>(),
        ) {
            let mut points: Vec<_> = points
                .into_iter()
                .map(|(distance, feedrate)| LimitPoint { distance, curve: 0, u: 0.0, feedrate })
                .collect();
            points.sort_by(|a, b| a.distance.total_cmp(&b.distance));
            let limits = KinematicLimits { acceleration, jerk, ..in_range::<f32>(&paper_limits()) };
            if let Ok(limit) = FeedLimit::from_points(&points) {
                let _ = plan(&limit, &limits, EndFeeds::default());
            }
        }
    }
}
