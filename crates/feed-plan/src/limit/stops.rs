//! The limit beside a stop.
//!
//! No chord that starts and ends within the chord error of a stop can leave the curve by more than the chord error,
//! however sharp the corner or tight the bend. So within the chord error of a stop, the limit at that distance from the
//! stop holds. The limits of the axes and of the centripetal acceleration do not depend on chords: they hold up to the
//! stop.

use alloc::collections::VecDeque;

use real::Real;

use crate::limit::sample::{ScannedSample, interpolate, lowered};

/// Lets the limit jump at stops: within `reach` of a stop, the limit at the distance `reach` from it holds. On the
/// stretch that leads on from there, at a distance x of the stop, V² is above the limit's square by no more than
/// `reach`/x of it.
///
/// The time is linear in the number of points, however many stops are within reach of each other. The search for points
/// within reach of a stop goes on where it ended for the stop before. A point is lifted once, when it is asked for, to
/// the highest of the limits from the stops on either side.
pub(crate) fn release_stops<R: Real>(samples: &mut [ScannedSample<R>], reach: R) {
    let (mut behind, mut next) = (0, 0); // Points before `behind` are beyond reach, and so are those from `next` on.
    let (mut ahead, mut back) = (Lifts::default(), Lifts::default());
    for i in 0..samples.len() {
        lift(samples, i, ahead.at(i));
        if samples[i].lower > R::zero() {
            continue;
        }
        let here = samples[i].point.distance;
        let is_beyond = |sample: &ScannedSample<R>| (sample.point.distance - here).abs() > reach;
        next = next.max(i);
        while samples.get(next).is_some_and(|sample| !is_beyond(sample)) {
            next += 1;
        }
        lift(samples, next - 1, ahead.last_at(next - 1));
        ahead.add(next, limit_between(samples, next, here + reach));
        while behind < i && is_beyond(&samples[behind]) {
            lift(samples, behind, back.at(behind));
            behind += 1;
        }
        lift(samples, behind, back.at(behind));
        back.add(i, limit_between(samples, behind, here - reach));
    }
    for i in behind..samples.len() {
        lift(samples, i, back.at(i));
    }
}

/// The limits that points are lifted to. Each holds for the points before a given point; an item added later reaches at
/// least as far as the earlier ones. Only items that are highest at some point are kept, so that their limits fall.
#[derive(Debug)]
struct Lifts<R>(VecDeque<(usize, R)>);

impl<R> Default for Lifts<R> {
    fn default() -> Self {
        Self(VecDeque::new())
    }
}

impl<R: Real> Lifts<R> {
    fn add(&mut self, before: usize, at_least: R) {
        if !(at_least > self.last_at(before.saturating_sub(1))) {
            return;
        }
        while self.0.back().is_some_and(|(_, lower)| *lower <= at_least) {
            self.0.pop_back();
        }
        self.0.push_back((before, at_least));
    }

    /// The highest limit at a point; 0 where there is none. Points must be asked for in order: items that end before
    /// the point are forgotten.
    fn at(&mut self, point: usize) -> R {
        while self.0.front().is_some_and(|(before, _)| *before <= point) {
            self.0.pop_front();
        }
        self.0.front().map_or_else(R::zero, |(_, at_least)| *at_least)
    }

    /// The limit at a point that only the last item may reach; 0 if it does not.
    fn last_at(&self, point: usize) -> R {
        self.0.back().filter(|(before, _)| *before > point).map_or_else(R::zero, |(_, at_least)| *at_least)
    }
}

/// The limit at a distance between point `next` and the one before it; 0 beyond the ends.
fn limit_between<R: Real>(samples: &[ScannedSample<R>], next: usize, distance: R) -> R {
    let at = |k: usize| samples.get(k).map(|sample| (sample.point.distance, sample.lower));
    match (next.checked_sub(1).and_then(at), at(next)) {
        (Some(before), Some(after)) => interpolate(before, after, distance),
        _ => R::zero(),
    }
}

/// Lifts the limit at a point to `at_least`, but no higher than the limit beside a stop. Where the tool rests in any case it stays.
fn lift<R: Real>(samples: &mut [ScannedSample<R>], i: usize, at_least: R) {
    let Some((sample, behind)) = samples.get_mut(i..).and_then(<[_]>::split_first_mut) else { return };
    if !(at_least > R::zero()) || sample.rests || (sample.is_single && sample.lower > R::zero()) {
        return;
    }
    let next = behind.first_mut();
    let margin_behind = next.as_ref().map_or_else(R::zero, |next| next.margin_beside_stop);
    let margin = sample.margin_beside_stop.max(margin_behind);
    let lifted = at_least.min(lowered(sample.feedrate_beside_stop, margin));
    if !(lifted > sample.lower) {
        return;
    }
    (sample.is_single, sample.lower) = (false, lifted);
    for beside in core::iter::once(sample).chain(next) {
        beside.allowance = beside.allowance.min(beside.allowance_beside_stop);
    }
}

#[cfg(test)]
mod tests {
    use core::ops::Range;

    use super::*;
    use crate::test_paths::{hairpin, in_periods, limit_along, limit_point, paper_limits};
    use crate::{AxisLimits, EndFeeds, FeedLimit, KinematicLimits, ProfileKind, plan_with};
    use nurbs_core::{Differentiate, NurbsCurve, curvature_vector, radius};
    use proptest::prelude::*;

    fn samples(steps: &[(f64, f64, f64)]) -> Vec<ScannedSample<f64>> {
        let mut distance = 0.0;
        let sample = |&(step, feedrate, beside): &(f64, f64, f64)| {
            distance += step;
            ScannedSample {
                feedrate_beside_stop: beside,
                ..ScannedSample::new(limit_point(distance, feedrate))
            }
        };
        steps.iter().map(sample).collect()
    }

    /// Limits with 18,000 mm/s³ and 1000 mm/s² for each axis, and 1000 mm/s² across the path.
    fn limits_with_axes(t: f64, feedrate: f64, chord_error: f64) -> KinematicLimits<f64> {
        let (acceleration, jerk) = (Some(1000.0 * t.powi(2)), Some(18_000.0 * t.powi(3)));
        let axis = AxisLimits { velocity: None, acceleration, jerk };
        let limits = in_periods(t, feedrate, 5000.0, 4e5, chord_error);
        KinematicLimits { axes: [axis; 3], centripetal_acceleration: acceleration, ..limits }
    }

    /// The largest acceleration and jerk of an axis, and the largest acceleration across the path, of a plan within the
    /// chord error of a stop, as ratios to their limits.
    fn used_beside(
        stop: f64,
        curve: &NurbsCurve<'_, f64, 2>,
        limits: &KinematicLimits<f64>,
        limit: &FeedLimit<f64>,
        stages: &[crate::Stage<f64>],
    ) -> [f64; 3] {
        let axis = limits.axes[0];
        let [most, most_jerk] = [axis.acceleration, axis.jerk].map(Option::unwrap);
        let mut used = [0.0_f64; 3];
        let shares = || (0..=400).map(|i| f64::from(i) / 400.0);
        for (stage, share) in stages.iter().flat_map(|stage| shares().map(move |share| (stage, share))) {
            let time = share * stage.duration;
            let distance = stage.start + stage.distance_at(time);
            let (v, a, j) = (stage.feed_at(time), stage.acceleration_at(time), stage.jerk_at(time));
            // At smaller distances, u is not known well enough for differences.
            if !(1e-9..=limits.chord_error).contains(&(distance - stop).abs()) {
                continue;
            }
            let (_, u) = limit.parameter_at(distance);
            let at = curve.derivatives(u);
            let speed = f64::norm(&at.first);
            let bend = |u: f64| curvature_vector(&curve.derivatives(u)).unwrap();
            let (k, before, after) = (bend(u), bend(u - 1e-8), bend(u + 1e-8));
            used[2] = used[2].max(v * v / radius(&at) / most);
            for d in 0..2 {
                let (e, c) = (at.first[d] / speed, (after[d] - before[d]) / (2e-8 * speed));
                used[0] = used[0].max((e * a + k[d] * v * v).abs() / most);
                used[1] = used[1].max((e * j + 3.0 * k[d] * v * a + c * v * v * v).abs() / most_jerk);
            }
        }
        used
    }

    /// A stop once lifted all of the limit: an axis reached 1.55 times its jerk, and 22,757 of 18,000 mm/s³ were
    /// printed. With the reserve of other slow points, the plan crept through the bends for up to half a second.
    #[test]
    fn beside_a_stop_the_limits_of_the_axes_hold_and_nothing_creeps() {
        for (t, feedrate) in [(3e-3, 200.0), (1e-3, 100.0), (1e-4, 100.0)] {
            for kind in ProfileKind::ALL {
                let duration = |width: f64, chord_error: f64| {
                    let limits = limits_with_axes(t, feedrate, chord_error);
                    let curve = hairpin(width);
                    let limit = limit_along(core::slice::from_ref(&curve), &limits);
                    let plan = plan_with(&limit, &limits, EndFeeds::default(), kind).unwrap();
                    let rests = plan.stages().iter().filter(|stage| stage.end_feed == 0.0);
                    let rests: Vec<_> = rests.map(|stage| stage.start + stage.length).collect();
                    let &[stop, _] = rests.as_slice() else { panic!("{width}: {rests:?}") };
                    let used = used_beside(stop, &curve.as_curve(), &limits, &limit, plan.stages());
                    let case = format!("{t} s, {feedrate} mm/s, {chord_error} mm, {kind:?}, {width} mm");
                    assert!(used.iter().all(|ratio| *ratio <= 1.0), "{case}: {used:?}");
                    plan.as_schedule().duration()
                };
                let cusp = duration(0.0, 0.01);
                for width in [0.001, 0.004, 0.02, 0.04, 0.1, 0.16] {
                    let found = duration(width, 0.01);
                    assert!(found <= 1.08 * cusp, "{t} s, {kind:?}, {width} mm: {found} for {cusp}");
                }
                for width in [0.0, 0.001, 0.04] {
                    duration(width, 5e-4);
                }
            }
        }
    }

    /// F/4096 is 0.05 mm a period, a hundred times the chord error. Each place with a limit below that was once a stop,
    /// and each stop released the places beside it. Of a bend of some tenths of a mm a single stop was left, and no
    /// limit.
    #[test]
    fn beside_the_stop_in_a_bend_its_limit_holds() {
        let limits = KinematicLimits { feedrate: 200.0, ..paper_limits() };
        let curve = hairpin(1.0);
        let limit = limit_along(core::slice::from_ref(&curve), &limits);
        let stops: Vec<_> = limit.points().filter(|point| point.feedrate == 0.0).collect();
        assert!(stops.len() == 1 && (stops[0].u - 0.5).abs() < 1e-3, "{stops:?}");
        let mut slow = 0;
        for point in limit.points() {
            let allowed = limits.feedrate_at_radius(radius(&curve.as_curve().derivatives(point.u)));
            let is_near_stop = (point.distance - stops[0].distance).abs() <= limits.chord_error;
            slow += u32::from(allowed < limits.feedrate / 4096.0);
            assert!(
                is_near_stop || limit.at(point.distance) <= allowed * (1.0 + 1e-9),
                "{point:?}: {allowed}"
            );
        }
        assert!(slow > 20, "{slow}");
    }

    /// Of corners within the chord error of each other every second one was passed, at any feed.
    #[test]
    fn the_tool_rests_at_each_corner_however_near_the_next_is() {
        let limits = paper_limits();
        let points: Vec<_> = (0..9_u32)
            .map(|i| [f64::from(i / 2), f64::from(i.div_ceil(2))].map(|x| 0.3 * limits.chord_error * x))
            .collect();
        let limit = crate::limit::track::limit_along(&points, &limits);
        let rests = limit.points().filter(|point| point.feedrate == 0.0).count();
        assert_eq!(rests, points.len() - 2);
    }

    /// From the stop on, the limit of the next point was once held: that point was 30 mm away.
    #[test]
    fn a_stop_releases_the_limit_within_the_chord_error_only() {
        let points =
            [(0.0, 0.0), (0.0, 0.2), (30.0, 0.8), (60.0, 0.2), (60.0, 0.0), (60.0, 0.6), (90.0, 0.6)];
        let samples = points.map(|(distance, feed)| ScannedSample::new(limit_point(distance, feed)));
        let limit = FeedLimit::assemble(samples.to_vec(), Vec::new(), 0.01).unwrap();
        // V² is linear: 0.04 to 0.64 over 30 mm.
        let wanted = |beyond: f64| Real::sqrt(0.04 + 0.6 * beyond / 30.0);
        for beyond in [0.005, 0.02, 0.1, 1.0, 7.0, 29.0] {
            let (above, least) = (wanted(beyond).powi(2) * (1.0 + 0.01 / beyond), wanted(beyond));
            for at in [beyond, 60.0 - beyond] {
                let found = limit.at(at);
                assert!(
                    found >= least * (1.0 - 1e-12) && found.powi(2) <= above * (1.0 + 1e-12),
                    "{at}: {found}"
                );
            }
        }
        assert_eq!(limit.at(61.0), 0.6);
    }

    /// A bend so tight that the limit is zero at each of its points, which are within reach of each other. Each point
    /// once looked for all others, and a fuzzer measured minutes.
    #[test]
    fn a_hundred_thousand_stops_within_reach_are_released_at_once() {
        let mut steps: Vec<_> =
            (0..200_000).map(|i| (1e-9, if i < 100_000 { 1.0 } else { 0.0 }, 2.0)).collect();
        steps[0].0 = 1.0;
        let limit = FeedLimit::assemble(samples(&steps), Vec::new(), 0.5).unwrap();
        assert_eq!(limit.samples().len(), 200_000);
    }

    /// Stops within reach of each other beside which the axes allow nothing; each might lift more than the one before.
    /// Each once looked at all others, which took 14 and 29 seconds.
    #[test]
    fn a_hundred_thousand_stops_that_stay_are_looked_at_once() {
        let stops = (0..100_000).map(|_| (1e-6, 0.0, 0.0));
        let [slow, fast] = [(0.35, 1.0, 2.0), (0.2, 3.0, 4.0)];
        for steps in [
            stops.clone().chain([slow, fast]).collect::<Vec<_>>(),
            [(0.0, 3.0, 4.0), (0.2, 1.0, 2.0)].into_iter().chain([(0.35, 0.0, 0.0)]).chain(stops).collect(),
        ] {
            let limit = FeedLimit::assemble(samples(&steps), Vec::new(), 0.5).unwrap();
            let stay = limit.samples().iter().filter(|sample| sample.lower == 0.0);
            assert_eq!(stay.count(), steps.iter().filter(|step| step.1 == 0.0).count());
        }
    }

    /// The result of `release_stops`, found by a new search at every stop.
    fn released_one_by_one(mut lowers: Vec<f64>, beside: &[f64], distances: &[f64], reach: f64) -> Vec<f64> {
        let lift = |lowers: &mut [f64], range: Range<usize>, release: f64| {
            range.for_each(|k| lowers[k] = lowers[k].max(release.min(beside[k])));
        };
        for i in 0..lowers.len() {
            if lowers[i] > 0.0 {
                continue;
            }
            let is_beyond = |k: &usize| (distances[*k] - distances[i]).abs() > reach;
            let at = |lowers: &[f64], k: usize, distance| {
                interpolate((distances[k], lowers[k]), (distances[k + 1], lowers[k + 1]), distance)
            };
            let next = (i..lowers.len()).find(is_beyond);
            let release = next.map_or(0.0, |next| at(&lowers, next - 1, distances[i] + reach));
            let end = next.unwrap_or(lowers.len());
            lift(&mut lowers, i + 1..end, release);
            let previous = (0..i).rev().find(is_beyond);
            let release = previous.map_or(0.0, |k| at(&lowers, k, distances[i] - reach));
            let from = previous.map_or(0, |k| k + 1);
            lift(&mut lowers, from..i, release);
        }
        lowers
    }

    proptest! {
        #![proptest_config(ProptestConfig::with_cases(64))]

        #[test]
        fn stops_are_released_as_one_by_one(
            steps in proptest::collection::vec(
                (0.0..1.0_f64, prop_oneof![Just(0.0), 0.1..3.0_f64], prop_oneof![Just(f64::MAX), 0.1..3.0_f64]), 2..60,
            ),
            reach in 0.0..3.0_f64,
        ) {
            let samples = samples(&steps);
            let limit = FeedLimit::assemble(samples.clone(), Vec::new(), reach).unwrap();
            let distances: Vec<_> = samples.iter().map(|sample| sample.point.distance).collect();
            let lowers = samples.iter().map(|sample| sample.point.feedrate).collect();
            let beside: Vec<_> = samples.iter().map(|sample| sample.feedrate_beside_stop).collect();
            let found: Vec<_> = limit.samples().iter().map(|sample| sample.lower).collect();
            prop_assert_eq!(found, released_one_by_one(lowers, &beside, &distances, reach));
        }
    }
}
