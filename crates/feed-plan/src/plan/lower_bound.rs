//! How fast the path could be passed if jerk were free.
//!
//! In the phase plane of distance and `V²`, a constant acceleration is a straight line. The time-optimal
//! motion under `|a| ≤ A` and a feed limit is found by two sweeps: forward, the feed rises from each point by
//! no more than A allows, `V² ≤ V₀² + 2 A s`; backward likewise. Below both lines and the limit, faster is
//! always better, so no plan that also limits the jerk takes less time.

use alloc::vec::Vec;

use real::Real;

use crate::limit::sample::LimitSample;
use crate::{EndFeeds, FeedLimit, KinematicLimits};

/// Duration of the fastest motion under the limit and `|a| ≤ A` that begins and ends at these feeds, or at the limit where that is
/// lower, jerk being free.
///
/// The limit points are taken as they are, without the margin that a plan keeps, and `V²` as linear between
/// them: the value is a lower bound to within the sampling of the limit, about 10⁻⁴ of the duration. A limit
/// that is zero over an interval gives the greatest number of the format.
#[must_use]
pub fn jerk_free_duration<R: Real>(
    limit: &FeedLimit<R>,
    limits: &KinematicLimits<R>,
    ends: EndFeeds<R>,
) -> R {
    let intervals = intervals(limit.samples());
    let at_end = |feed: R, most: Option<R>| (feed * feed).min(most.unwrap_or(R::zero()));
    // V² at the points.
    let mut squares = Vec::with_capacity(intervals.len() + 1);
    let mut square = at_end(ends.start, intervals.first().map(|first| first.inside[0]));
    squares.push(square);
    for interval in &intervals {
        square = interval.allowed_end.min(square + interval.rise(limits));
        squares.push(square);
    }
    square = at_end(ends.end, intervals.last().map(|last| last.inside[1])).min(square);
    let mut duration = R::zero();
    for (interval, begin) in intervals.iter().rev().zip(squares.iter().rev().skip(1)) {
        let begin = begin.min(square + interval.rise(limits));
        match interval.duration(begin, square, limits) {
            Some(time) => duration = duration + time,
            None => return R::max_value(),
        }
        square = begin;
    }
    duration
}

/// The path between two limit points, with V² limited in between and at its end.
pub(crate) struct LimitInterval<R> {
    pub(crate) length: R,
    /// The limit at its begin and end, seen from inside.
    pub(crate) inside: [R; 2],
    /// The limit at the end point, where there may be a stop.
    pub(crate) allowed_end: R,
}

/// The intervals between these limit points; a way with a level limit is one.
pub(crate) fn intervals<R: Real>(samples: &[LimitSample<R>]) -> Vec<LimitInterval<R>> {
    let square = |feed: R| feed * feed;
    // Without the margin; but next to a stop, where the limit is released, the lower value is the higher one.
    let feed = |i: usize, inside: R| {
        if samples[i].is_single { inside } else { samples[i].point.feedrate.max(inside) }
    };
    let mut intervals: Vec<LimitInterval<R>> = Vec::new();
    for i in 0..samples.len().saturating_sub(1) {
        let length = samples[i + 1].point.distance - samples[i].point.distance;
        let interval = LimitInterval {
            length,
            inside: [
                square(feed(i, samples[i].lower_after)),
                square(feed(i + 1, samples[i + 1].lower_before)),
            ],
            allowed_end: square(feed(i + 1, samples[i + 1].lower)),
        };
        match intervals.last_mut().filter(|last| last.goes_on_in(&interval)) {
            Some(last) => last.length = last.length + length,
            None => intervals.push(interval),
        }
    }
    intervals
}

impl<R: Real> LimitInterval<R> {
    /// Whether the next interval goes on at the same limit.
    fn goes_on_in(&self, next: &Self) -> bool {
        let level = self.inside[0];
        let is_level = |interval: &Self| interval.inside == [level; 2] && interval.allowed_end == level;
        is_level(self) && is_level(next)
    }

    /// The most that V² can change by, `2 A s`.
    pub(crate) fn rise(&self, limits: &KinematicLimits<R>) -> R {
        (limits.acceleration * self.length).ldexp(1)
    }

    /// Time between given V² at both ends: along the limit, or up to a peak below it and down again.
    fn duration(&self, begin: R, end: R, limits: &KinematicLimits<R>) -> Option<R> {
        if !(self.length > R::zero()) {
            return Some(R::zero());
        }
        let (slow, fast) = (begin.sqrt(), end.sqrt());
        if [begin, end] == self.inside {
            return (slow + fast > R::zero()).then(|| self.length.ldexp(1) / (slow + fast));
        }
        let reachable = (begin + end + self.rise(limits)).half();
        let peak = reachable.min(self.inside[0].max(self.inside[1])).max(begin).max(end);
        let ramps = (peak - begin + (peak - end)).half() / limits.acceleration;
        let cruise = (self.length - ramps).max(R::zero());
        let top = peak.sqrt();
        (top > R::zero()).then(|| (top - slow + (top - fast)) / limits.acceleration + cruise / top)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::test_paths::{limit_through as limit, paper_limits};

    fn from_rest(limit: &FeedLimit<f64>, limits: &crate::KinematicLimits<f64>) -> f64 {
        jerk_free_duration(limit, limits, EndFeeds::default())
    }

    /// Ways of 10 mm, along which the feed of 0.6 falls off at one end or none; above the limit nothing begins.
    #[test]
    fn ends_in_motion_spare_their_ramps() {
        let (limit, limits) = (limit(&[(0.0, 0.6), (5.0, 0.6), (10.0, 0.6)]), paper_limits());
        let between = |start, end| jerk_free_duration(&limit, &limits, EndFeeds { start, end });
        let ramp = 0.5 * 0.6 / 0.045;
        for (start, end, ramps) in
            [(0.0, 0.0, 2.0), (0.6, 0.0, 1.0), (0.0, 0.6, 1.0), (0.6, 0.6, 0.0), (9.0, 9.0, 0.0)]
        {
            let expected = 10.0 / 0.6 + ramps * ramp;
            assert!(
                (between(start, end) / expected - 1.0).abs() < 1e-12,
                "{start} {end}: {}",
                between(start, end)
            );
        }
    }

    #[test]
    fn a_constant_limit_gives_the_trapezoid() {
        let (f, a, length) = (0.6, 0.045, 100.0); // mm, periods: L/F + F/A
        let limits = paper_limits();
        for count in [2_i32, 3, 50, 1001] {
            let points: Vec<_> =
                (0..count).map(|i| (length * f64::from(i) / f64::from(count - 1), f)).collect();
            let duration = from_rest(&limit(&points), &limits);
            // A point inside a ramp or the joint of ramp and cruise changes nothing.
            assert!((duration - (length / f + f / a)).abs() < 1e-10, "{count}: {duration}");
        }
    }

    #[test]
    fn a_path_too_short_for_the_limit_gives_the_triangle() {
        let duration = from_rest(&limit(&[(0.0, 0.6), (1.0, 0.6)]), &paper_limits());
        assert!((duration - 2.0 * (1.0_f64 / 0.045).sqrt()).abs() < 1e-12, "{duration}"); // 2 √(L/A)
    }

    #[test]
    fn a_stop_halves_the_path() {
        let half = from_rest(&limit(&[(0.0, 0.6), (20.0, 0.6)]), &paper_limits());
        let both = from_rest(&limit(&[(0.0, 0.6), (20.0, 0.0), (40.0, 0.6)]), &paper_limits());
        assert!((both - 2.0 * half).abs() < 1e-12, "{both} {half}");
    }

    #[test]
    fn a_limit_that_allows_a_constant_acceleration_is_followed() {
        // V² from 0.01 to 0.25 over 100 mm: less than A. From rest 0.01/(2A) = 0.11 mm are needed to get
        // there.
        let points = (0..=10_000).map(|i| (f64::from(i) / 100.0, (0.01 + 0.24 * f64::from(i) / 1e4).sqrt()));
        let duration = from_rest(&limit(&points.collect::<Vec<_>>()), &paper_limits());
        let along_the_limit = 2.0 * 100.0 / (0.1 + 0.5);
        assert!((duration - along_the_limit).abs() < 10.0 && duration > along_the_limit, "{duration}");
    }
}
