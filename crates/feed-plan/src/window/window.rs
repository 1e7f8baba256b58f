//! Streaming: a path of any length, planned through a window.
//!
//! The planner looks at a *window* of so many millimetres of path at a time. It plans the window as if the path ended
//! in rest at the window's end, which is always possible. Of that plan, the stages up to the middle of the window are
//! final. The next window begins at a place where the acceleration is zero, at constant feed or at a joint of stages,
//! with the feed that the plan has there; along the fastest profile at any joint, with its acceleration too. The path
//! behind a window can only let the plan go faster, so every limit holds. But where half the window is shorter than the
//! distance that the machine needs to stop, the plan is slower than with the whole path in view.
//!
//! The planner may find no plan from that joint, where its search is coarser than in the window before. It then follows
//! the rest of the window's plan before, to rest: so there is always a plan.
//!
//! Final stages are given out in arcs and in chords, and neither depends on the path behind the window. Plans use
//! 2⁻¹² less than the acceleration and the jerk of the limits: what is left lets the corrections for chords change.
//!
//! Spans are sampled once, as the window reaches them, and their samples are forgotten behind it. So memory holds the
//! samples and curves of one window and one span, whatever the length of the path. Stages are not stretched to whole
//! periods; at a stop, a pause lasts until the period is over.

use alloc::vec::Vec;

use nurbs_core::Differentiate;
use real::Real;

use crate::plan::look_ahead::{self, InWindow};
use crate::plan::whole_periods::MOST_PERIODS;
use crate::window::chord_run::{ChordRun, FinalStages};
use crate::window::view::{CommandedCurve, View};
use crate::{EndFeeds, FeedLimit, KinematicLimits, PlanError, ProfileKind, Stage, StageKind};

/// A window's plan is followed over at least 2⁻⁶ of the window.
const LEAST_ADVANCE: i32 = -6;
/// Plans use this share less of acceleration and jerk.
const ROOM: i32 = -12;

/// The result of planning through a window.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct WindowedPlan<R> {
    /// Arc length of the path, mm.
    pub length: R,
    /// Duration without the pauses at stops, in the unit of the limits.
    pub duration: R,
    /// Duration in interpolation periods, pauses and all.
    pub periods: u64,
    /// Most limit points held at a time.
    pub most_points: usize,
    /// Windows planned.
    pub windows: usize,
}

/// Plans curves that follow each other, from rest to rest, with `window` mm in view. `emit` is given the stages in
/// order; they are final.
///
/// Distances count from the path's start and curves from the first one. The feed is continuous over windows, and all
/// limits of [`plan`](crate::plan()) hold. The plan in chords is that of [`FeedLimit::in_chords`], found window by window:
/// a run by its chords keeps to the plan in arcs, and lands on each stop. What is emitted depends on no path behind the
/// window. The cost of planning is proportional to the path: each span is sampled once, and the plan covers each sample
/// about twice.
///
/// # Errors
/// As [`plan`](crate::plan()) and [`FeedLimit::capped`]; [`PlanError::NotPositive`] for a window that is not a positive
/// number. Stages that were emitted before an error stay valid.
pub fn plan_through_window<R: Real, const D: usize, C: Differentiate<R, D>>(
    curves: impl IntoIterator<Item = CommandedCurve<C, R>>,
    limits: &KinematicLimits<R>,
    window: R,
    kind: ProfileKind,
    mut emit: impl FnMut(&FinalStages<R>),
) -> Result<WindowedPlan<R>, PlanError> {
    limits.validate()?;
    if !(window > R::zero()) {
        return Err(PlanError::NotPositive { what: "window" });
    }
    let less = R::one() - R::one().ldexp(ROOM);
    let within =
        KinematicLimits { acceleration: limits.acceleration * less, jerk: limits.jerk * less, ..*limits };
    let mut view = View::new(curves, limits, window);
    let mut run = ChordRun::new(limits.interpolation_period);
    let (zero, periods) = (R::zero(), 0);
    let mut done = WindowedPlan { length: zero, duration: zero, periods, most_points: 0, windows: 0 };
    let (mut feed, mut acceleration) = (R::zero(), R::zero());
    let any_joint = matches!(kind, ProfileKind::Fastest | ProfileKind::WithoutLookAhead);
    let mut rest: Vec<Stage<R>> = Vec::new();
    while view.advance(done.length)? {
        let whole = view.limit(done.length)?;
        let limit = whole.clone().beginning_at(done.length);
        done.most_points = done.most_points.max(view.points());
        done.windows += 1;
        let ends = EndFeeds { start: feed, end: R::zero() };
        let is_last = view.ends_with(&limit);
        let middle = done.length + (limit.length() - done.length).half();
        let kept_to = if is_last { limit.length() } else { middle };
        let in_window = InWindow { start: acceleration, kept_to };
        let (mut stages, is_new) = match look_ahead::stages(&limit, &within, ends, Some(in_window), kind) {
            Ok(stages) => (stages, true),
            // The rest of the plan before leads to rest at the end of the window before.
            Err(_) if !rest.is_empty() => (rest, false),
            Err(error) => return Err(error),
        };
        let ends_here = is_new && is_last;
        rest = if ends_here {
            Vec::new()
        } else {
            // Where nothing goes on from a joint, something may from the next.
            let share = if any_joint && !is_new { LEAST_ADVANCE } else { -1 };
            split_rest(&mut stages, &limit, done.length, share, any_joint)
        };
        for stage in &stages {
            done.duration = done.duration + stage.duration;
            (done.length, feed) = (stage.start + stage.length, stage.end_feed);
            acceleration = if any_joint { stage.acceleration_at(stage.duration) } else { R::zero() };
        }
        let count = stages.len();
        stages.extend_from_slice(&rest);
        emit(&run.take(&view.path(&whole), &stages, count)?);
        done.periods = run.periods;
        if done.duration.ldexp(-30) > limits.interpolation_period {
            return Err(PlanError::TooManyPeriods { most: MOST_PERIODS });
        }
        if ends_here {
            return Ok(done);
        }
    }
    if done.length > R::zero() { Ok(done) } else { Err(PlanError::PathEmpty) }
}

/// Splits off the stages of a window's plan that are not final. The final stages end at the middle of the window, which `share` says, if
/// the feed is constant there. Otherwise they end at the last joint in the window's first half from which the next
/// window can go on, or at the first such joint behind it.
///
/// At such a joint the acceleration is zero and the next stage does not fall. Where braking begins, the next plan would
/// have to brake at that very point, and rounding may have moved the point too far along the path.
/// The fastest profile goes on from any joint.
fn split_rest<R: Real>(
    stages: &mut Vec<Stage<R>>,
    limit: &FeedLimit<R>,
    begin: R,
    share: i32,
    any_joint: bool,
) -> Vec<Stage<R>> {
    let window = limit.length() - begin;
    let (least, middle) = (begin + window.ldexp(LEAST_ADVANCE), begin + window.ldexp(share));
    let at_middle = stages.partition_point(|stage| stage.start + stage.length <= middle);
    if let Some(stage) = stages.get_mut(at_middle).filter(|stage| stage.kind() == StageKind::Constant) {
        let (before, after) = cut(stage, middle, limit);
        *stage = after;
        let rest = stages.split_off(at_middle);
        stages.push(before);
        return rest;
    }
    let joints = stages.windows(2).enumerate().filter_map(|(i, pair)| {
        let [stage, next] = pair else { return None };
        let is_level = stage.acceleration_at(stage.duration).abs() <= R::resolution();
        let place = stage.start + stage.length;
        let goes_on = any_joint || (is_level && next.end_feed >= next.start_feed);
        (goes_on && place >= least).then_some((i + 1, place))
    });
    let in_half = joints.clone().take_while(|(_, place)| *place <= middle).last();
    let count = in_half.or_else(|| joints.clone().next()).map_or(stages.len(), |(count, _)| count);
    stages.split_off(count)
}

/// Cuts a stage of constant feed in two at a distance within it.
fn cut<R: Real>(stage: &Stage<R>, distance: R, limit: &FeedLimit<R>) -> (Stage<R>, Stage<R>) {
    let length = distance - stage.start;
    let duration = stage.duration * (length / stage.length);
    let (curve, u) = limit.parameter_at(distance);
    let before = Stage { length, duration, curve_end: curve, u_end: u, ..*stage };
    let after = Stage {
        start: distance,
        length: stage.length - length,
        duration: stage.duration - duration,
        curve_start: curve,
        u_start: u,
        ..*stage
    };
    (before, after)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::plan_with;
    use crate::test_paths::{
        arcs, hashed, in_periods, limit_along, paper_limits, polyline, seed_000, seed_003,
    };
    use nurbs_core::{NurbsBuf, NurbsCurve};

    /// A path of staircases of short lines, with the papers' curves between them, moved to the path's end.
    fn long_path(repeats: usize) -> Vec<NurbsBuf<f64, 2>> {
        let mut path = Vec::new();
        for i in 0..repeats {
            let x = 10.0 * i as f64;
            path.extend(polyline(&[[x, 0.0], [x + 4.0, 0.01], [x + 9.0, 0.015], [x + 10.0, 0.0]]));
        }
        path
    }

    fn freely(
        curves: &[NurbsBuf<f64, 2>],
    ) -> impl Iterator<Item = CommandedCurve<NurbsCurve<'_, f64, 2>, f64>> {
        curves.iter().map(|curve| CommandedCurve {
            curve: curve.as_curve(),
            feed: f64::MAX,
            from_rest: false,
        })
    }

    fn streamed(
        curves: &[NurbsBuf<f64, 2>],
        window: f64,
        kind: ProfileKind,
    ) -> (Vec<Stage<f64>>, WindowedPlan<f64>) {
        let limits = paper_limits();
        let mut stages = Vec::new();
        let done = plan_through_window(freely(curves), &limits, window, kind, |some| {
            stages.extend_from_slice(&some.arcs)
        })
        .unwrap();
        (stages, done)
    }

    fn assert_kept(curves: &[NurbsBuf<f64, 2>], stages: &[Stage<f64>]) -> FeedLimit<f64> {
        let limits = paper_limits();
        let limit = limit_along(curves, &limits);
        let mut end = (0.0, 0.0);
        for stage in stages {
            assert!(
                (stage.start - end.0).abs() < 1e-9 && (stage.start_feed - end.1).abs() < 1e-12,
                "{end:?} {stage:?}"
            );
            end = (stage.start + stage.length, stage.end_feed);
            for i in 0..=50 {
                let time = stage.duration * f64::from(i) / 50.0;
                let (feed, at) = (stage.feed_at(time), stage.start + stage.distance_at(time));
                let allowed = limit.minimum_over((at - 1e-9).max(0.0), (at + 1e-9).min(limit.length()));
                assert!(feed <= limit.at(at).max(allowed) * (1.0 + 1e-9) + 1e-7, "{feed} {allowed} at {at}");
                assert!(stage.acceleration_at(time).abs() <= limits.acceleration * (1.0 + 1e-9));
                assert!(stage.jerk_at(time).abs() <= limits.jerk * (1.0 + 1e-9));
            }
        }
        assert!((end.0 - limit.length()).abs() < 1e-9 * limit.length() && end.1 == 0.0, "{end:?}");
        limit
    }

    #[test]
    fn a_feed_that_is_not_positive_is_refused_by_its_curve() {
        let (path, limits) = (seed_000(), paper_limits());
        let limit = FeedLimit::along(&[path.as_curve()], &limits).unwrap();
        for bad in [f64::NAN, 0.0, -1.0, f64::NEG_INFINITY] {
            let error = PlanError::CurveFeedNotPositive { curve: 0 };
            assert_eq!(limit.clone().capped(|_| bad), Err(error), "{bad}");
            let curves =
                [path.as_curve(); 1].map(|curve| CommandedCurve { curve, feed: bad, from_rest: false });
            let found = plan_through_window(curves, &limits, 50.0, ProfileKind::Cubic, |_| ());
            assert_eq!(found, Err(error), "{bad}");
        }
        assert_eq!(limit.clone().capped(|_| f64::INFINITY).as_ref(), Ok(&limit));
        assert_eq!(limit.at(f64::NAN), 0.0);
        assert!(
            limit.at(f64::INFINITY) == limit.at(limit.length())
                && limit.at(f64::NEG_INFINITY) == limit.at(0.0)
        );
    }

    #[test]
    fn through_a_window_every_limit_holds() {
        let lines = long_path(12);
        for kind in ProfileKind::ALL {
            for (curves, windows) in [
                (&lines[..], [5.0, 30.0, 1e4]),
                (&[seed_000()][..], [50.0, 200.0, 1e4]),
                (&[seed_003()], [5.0, 40.0, 1e4]),
            ] {
                for window in windows {
                    let (stages, done) = streamed(curves, window, kind);
                    let limit = assert_kept(curves, &stages);
                    assert!((done.length - limit.length()).abs() < 1e-9 * limit.length());
                    let moves = stages.iter().filter(|stage| !stage.is_pause());
                    let sum: f64 = moves.map(|stage| stage.duration).sum();
                    assert!((done.duration - sum).abs() < 1e-9 * sum);
                }
            }
        }
    }

    /// A break lowers samples before it. Such samples are not final at the end of a window, however short the window.
    #[test]
    fn moves_finer_than_a_step_have_the_same_limit_through_a_window() {
        // A straight line, and then ever tighter bends in moves of 2 µm: the radius falls from 20 mm to 1 mm and rises
        // again.
        let (mut angle, mut points) = (0.0_f64, vec![[-3.0, 0.0], [0.0, 0.0]]);
        for i in 0..=4000 {
            let last = points[points.len() - 1];
            points.push([last[0] + 2e-3 * angle.cos(), last[1] + 2e-3 * angle.sin()]);
            angle += 2e-3 / (1.0 + 4.75 * (f64::from(i) * 2e-3 - 4.0).abs());
        }
        let curves = polyline(&points);
        let whole = streamed(&curves, 1e4, ProfileKind::SCurve).1;
        for window in [0.05, 0.5, 2.0, 8.0] {
            let (stages, done) = streamed(&curves, window, ProfileKind::SCurve);
            let limit = assert_kept(&curves, &stages);
            assert!(limit.at(7.0) < 0.08 && limit.at(1.0) == 0.6, "{}", limit.at(7.0));
            assert!(done.duration >= whole.duration * (1.0 - 1e-3), "{window}: {}", done.duration);
            // The samples of a window, of the two periods before it, of the stretch that a chord reaches beyond it, and of
            // a span.
            let most = 17.0 * (1600.0 + 500.0 * window);
            assert!((done.most_points as f64) < most, "{} of {most}", done.most_points);
        }
    }

    #[test]
    fn a_window_of_twice_the_stopping_distance_loses_little() {
        let curves = long_path(60);
        let limit = limit_along(&curves, &paper_limits());
        let whole = plan_with(&limit, &paper_limits(), EndFeeds::default(), ProfileKind::SCurve).unwrap();
        let whole = whole.as_schedule().duration();
        let (_, done) = streamed(&curves, 60.0, ProfileKind::SCurve);
        assert!(done.duration < 1.03 * whole, "{} {whole}", done.duration);
        assert!(done.windows > 10);

        // On paper A's curve, whose stopping distance is 6 mm.
        let whole = streamed(&[seed_000()], 1e4, ProfileKind::SCurve).1;
        for (window, slower) in [(20.0, 1.05), (100.0, 1.01), (400.0, 1.01)] {
            let (_, done) = streamed(&[seed_000()], window, ProfileKind::SCurve);
            let ratio = done.duration / whole.duration;
            assert!((1.0 - 1e-4..slower).contains(&ratio), "{window}: {ratio}");
        }
    }

    /// At 50 mm it took 7 % longer while a window could go on without acceleration alone.
    #[test]
    fn the_fastest_profile_goes_on_from_any_joint_and_loses_nothing() {
        for curve in [seed_000(), seed_003()] {
            let curve = [curve];
            let whole = streamed(&curve, 1e4, ProfileKind::Fastest).1;
            for window in [20.0, 50.0, 100.0, 400.0] {
                let (_, done) = streamed(&curve, window, ProfileKind::Fastest);
                let ratio = done.duration / whole.duration;
                assert!((1.0 - 1e-4..1.001).contains(&ratio), "{window}: {ratio}");
            }
        }
    }

    /// With a limit of the centripetal acceleration each arc has a feed of its own, so the limit is a staircase; a
    /// longer window sees longer staircases. With 16 levels for a staircase of any length, a window of 80 mm took 6 %
    /// longer than one of 20 mm here, and up to 14 % longer on other paths.
    #[test]
    fn the_more_is_in_view_the_less_time_a_path_of_arcs_takes() {
        let shape = |i: u64| {
            let share = |bits: u32| f64::from(hashed(i) >> bits & 0xff) / 256.0;
            (40.0_f64.powf(share(0)), 0.2 + 1.4 * share(8))
        };
        let growing = (0..150).map(|i| (1.0 + 0.1 * f64::from(i), 0.4));
        for (name, curves) in [("mixed", arcs((0..150).map(shape))), ("growing", arcs(growing))] {
            for (limits, least) in [(paper_limits(), 20.0), (in_periods(3e-3, 200.0, 500.0, 2e4, 5e-4), 80.0)]
            {
                let limits = KinematicLimits { centripetal_acceleration: Some(300.0 * 9e-6), ..limits };
                let limit = FeedLimit::along(&curves, &limits).unwrap();
                for kind in ProfileKind::ALL {
                    let whole = look_ahead::stages(&limit, &limits, EndFeeds::default(), None, kind).unwrap();
                    let whole: f64 = whole.iter().map(|stage| stage.duration).sum();
                    let durations =
                        [least, 1.5 * least, 2.0 * least, 4.0 * least, 15.0 * least, 1e4].map(|window| {
                            let commanded = curves.iter().map(|curve| CommandedCurve {
                                curve: *curve,
                                feed: f64::MAX,
                                from_rest: false,
                            });
                            plan_through_window(commanded, &limits, window, kind, |_| ()).unwrap().duration
                        });
                    let mut best = f64::MAX;
                    // The fastest profile finds more or less of the last three per mille, whatever is in view.
                    let most = if kind == ProfileKind::Fastest { 1.003 } else { 1.001 };
                    for duration in durations.into_iter().chain([whole]) {
                        assert!(
                            duration < most * best,
                            "{name} {kind:?}: whole {whole}, windows {durations:?}"
                        );
                        best = best.min(duration);
                    }
                }
            }
        }
    }

    #[test]
    fn memory_does_not_grow_with_the_path() {
        let points = |repeats| streamed(&long_path(repeats), 40.0, ProfileKind::SCurve).1.most_points;
        let (short, long) = (points(20), points(200));
        assert!(long <= short + 40, "{short} {long}");
    }

    #[test]
    fn a_window_that_is_none_is_refused() {
        let curves = long_path(1);
        for window in [0.0, -1.0, f64::NAN] {
            let refused =
                plan_through_window(freely(&curves), &paper_limits(), window, ProfileKind::Cubic, |_| ());
            assert_eq!(refused, Err(PlanError::NotPositive { what: "window" }));
        }
    }

    /// Slow, fast and unbounded moves in a row, planned with the whole path in view and through windows.
    #[test]
    fn every_curve_is_travelled_at_its_own_feed_at_most() {
        let curves: Vec<_> = (0..12_i32)
            .flat_map(|i| polyline(&[[50.0 * f64::from(i), 0.0], [50.0 * f64::from(i + 1), 0.0]]))
            .collect();
        let feed_of = |curve: usize| [0.6, 0.1, 0.3, f64::MAX, 0.05][curve % 5];
        let limits = paper_limits();
        let limit = limit_along(&curves, &limits).capped(feed_of).unwrap();
        let keeps = |stages: &[Stage<f64>]| {
            for stage in stages {
                for i in 0..=50 {
                    let time = stage.duration * f64::from(i) / 50.0;
                    let (feed, at) = (stage.feed_at(time), stage.start + stage.distance_at(time));
                    let [before, after] = [at - 1e-6, at + 1e-6].map(|s| limit.parameter_at(s).0);
                    let most = feed_of(before).max(feed_of(after)).min(limits.feedrate);
                    assert!(feed <= most * (1.0 + 1e-9), "{feed} for {most} at {at}");
                }
            }
        };
        for kind in ProfileKind::ALL {
            let whole = plan_with(&limit, &limits, EndFeeds::default(), kind).unwrap();
            keeps(whole.stages());
            let bound = crate::jerk_free_duration(&limit, &limits, EndFeeds::default());
            assert!(whole.as_schedule().duration() < 1.02 * bound, "{kind:?}");
            let mut stages = Vec::new();
            let capped =
                freely(&curves).enumerate().map(|(i, one)| CommandedCurve { feed: feed_of(i), ..one });
            let done = plan_through_window(capped, &limits, 120.0, kind, |some| {
                stages.extend_from_slice(&some.arcs)
            })
            .unwrap();
            keeps(&stages);
            assert!(done.duration < 1.02 * bound, "{kind:?}: {} for {bound}", done.duration);
        }
    }

    #[test]
    fn an_exact_stop_is_rested_at_in_every_window() {
        let curves = long_path(40);
        let views: Vec<_> = curves.iter().map(NurbsBuf::as_curve).collect();
        // Joints that the tool passes if no stop is asked for there.
        let stops = [4, 49, 103];
        let limit = FeedLimit::along_with_stops(&views, &paper_limits(), &stops).unwrap();
        let free = FeedLimit::along(&views, &paper_limits()).unwrap();
        let begins = stops.map(|curve| {
            let point = limit.points().find(|point| point.curve == curve).unwrap();
            assert_eq!(point.feedrate, 0.0);
            assert!(free.at(point.distance) > 0.0, "curve {curve} begins at rest without an exact stop");
            point.distance
        });
        for kind in ProfileKind::ALL {
            let mut rests = Vec::new();
            let commanded = freely(&curves).enumerate();
            let commanded = commanded.map(|(i, one)| CommandedCurve { from_rest: stops.contains(&i), ..one });
            plan_through_window(commanded, &paper_limits(), 60.0, kind, |some| {
                let stops = some.arcs.iter().filter(|stage| stage.end_feed == 0.0);
                rests.extend(stops.map(|stage| stage.start + stage.length));
            })
            .unwrap();
            for begin in begins {
                let is_there = rests.iter().any(|rest| (rest - begin).abs() < 1e-9);
                assert!(is_there, "{kind:?}: no rest at {begin}, but at {rests:?}");
            }
        }
    }
}
