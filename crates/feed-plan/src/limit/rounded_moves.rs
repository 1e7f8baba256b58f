//! The feed along moves whose corners are passed, as far as the axes can follow.
//!
//! With [`Junction::Deviation`](crate::Junction::Deviation) the tool may leave the path by δ at corners. So the moves stand for any motion
//! within δ of them, as a lone corner does for its rounding, or a string of short moves for the bend that it approximates. With other
//! junctions breaks too small for a corner are passed, and δ is what a [setpoint may be off](KinematicLimits::resolution). At the feed V,
//! the k-th difference of such a motion over ways h is at most `M (h/V)ᵏ`, with M the limit of an axis for the k-th derivative, and that
//! of the moves may be more by `2ᵏ δ`. Whatever the motion is, then,
//!
//! `V ≤ h (M/(|Δᵏ| - 2ᵏ δ))^(1/k)`
//!
//! for every h of a period or more. Ways are tried from the longest that can matter down to that of one period at the feed found so far, and
//! then that one anew and those beside the worst; three quarters of a jerk are taken for M. Second differences are largest with the corner
//! in the middle, third ones with it at one of the two inner places.

use alloc::vec::Vec;
use core::iter::successors;

use real::Real;

use crate::cube_root::cube_root;
use crate::limit::broken_chord::PathPoint;
use crate::limits::AXES;
use crate::{AxisLimits, Junction, KinematicLimits};

/// Ways h are this many 32nds apart: about the root of 2, so that V² is found to some hundredths.
const APART: i32 = 45;
/// How often ways beside the worst, and of one period, are tried, each time half as far apart: V² of a lone corner is then right to some
/// thousandths.
const CLOSER: i32 = 5;
/// The share of an axis' jerk, in quarters, that turning may use; what is left is for the feed, which changes on both sides of a corner.
const OF_JERK: i32 = 3;
/// Most ways that are looked at, but for those beside the worst.
const MOST_WAYS: usize = 48;

/// What axes can follow along moves whose corners are rounded.
#[derive(Clone, Debug)]
pub(crate) struct RoundedMoves<R> {
    axes: [AxisLimits<R>; AXES],
    deviation: R,
    period: R,
    /// The longest way at a feed of 1.
    longest: R,
    /// The ways that are tried, up to the first that is too long at the feed of the machine.
    ways: Vec<R>,
}

impl<R: Real> RoundedMoves<R> {
    /// `None` if the acceleration and jerk of no axis are limited.
    pub(crate) fn new(limits: &KinematicLimits<R>) -> Option<Self> {
        let deviation = match limits.junction {
            Junction::Deviation(deviation) => deviation,
            _ => limits.resolution(),
        };
        // A bend of radius R shows in ways of √(4 δ R) and ∛(8 δ R²), and at the feed V it may be as wide as V²/A and √(V³/J): three times
        // as long a way finds its limit to a tenth.
        let of_axis = |axis: &AxisLimits<R>| {
            let by_acceleration =
                axis.acceleration.map(|most| (deviation / most).sqrt() * R::from_ratio(6, 1));
            let by_jerk = axis.jerk.map(|most| cube_root(deviation / most) * R::from_ratio(6, 1));
            by_acceleration.into_iter().chain(by_jerk).reduce(R::max)
        };
        let longest = limits.axes.iter().filter_map(of_axis).reduce(R::max)?.max(limits.interpolation_period);
        let further = |way: &R| (*way < longest * limits.feedrate).then(|| *way * R::from_ratio(APART, 32));
        let ways = successors(Some(deviation.ldexp(2)), further).take(MOST_WAYS).collect();
        Some(Self { axes: limits.axes, deviation, period: limits.interpolation_period, longest, ways })
    }

    /// How far the path matters on both sides of a corner that is passed at a feed.
    pub(crate) fn reach(&self, feed: R) -> R {
        (self.longest * feed).ldexp(1)
    }

    /// The feed at which the axes can follow the moves around a corner at a distance, and the way h on both sides that tells it; `None` if
    /// they can at `feed`.
    pub(crate) fn feed<const D: usize>(&self, places: &[PathPoint<R, D>], at: R, feed: R) -> Option<(R, R)> {
        let around = Around { places, at };
        let longer = self.ways.partition_point(|way| *way < self.longest * feed);
        let mut worst = None;
        for &way in self.ways.iter().take(longer + 1).rev() {
            self.try_way(&around, way, feed, &mut worst);
        }
        for finer in 3..3 + CLOSER {
            let Some((least, way)) = worst else { break };
            for other in [way - way.ldexp(-finer), way + way.ldexp(-finer), least * self.period] {
                self.try_way(&around, other, feed, &mut worst);
            }
        }
        worst
    }

    /// Takes a way for the worst if it allows less feed than the worst so far, or than `feed` if there is none. A way that takes less than a
    /// period at that feed is seen by no setpoints.
    fn try_way<const D: usize>(
        &self,
        around: &Around<'_, R, D>,
        way: R,
        feed: R,
        worst: &mut Option<(R, R)>,
    ) {
        let most = worst.map_or(feed, |(least, _)| least);
        if way < most * self.period {
            return;
        }
        let least = self.feed_over(around, way, most);
        if least < most {
            *worst = Some((least, way));
        }
    }

    /// The feed that the ways of one length allow, at most `most`.
    fn feed_over<const D: usize>(&self, around: &Around<'_, R, D>, way: R, most: R) -> R {
        let points = [-2, -1, 0, 1, 2].map(|times| around.point(way * R::from_ratio(times, 1)));
        let [a, b, c, d, e] = points;
        let (second, hidden) = (differences([b, c, d, None], [1, -2, 1, 0]), self.deviation.ldexp(2));
        let thirds = [[a, b, c, d], [b, c, d, e]].map(|points| differences(points, [1, -3, 3, -1]));
        let of_jerk = R::from_ratio(OF_JERK, 4);
        let mut feed = most;
        for (axis, limits) in self.axes.iter().enumerate().take(D) {
            let by_acceleration = limits.acceleration.zip(second.map(|of| of[axis] - hidden));
            if let Some((acceleration, over)) = by_acceleration.filter(|(_, over)| *over > R::zero()) {
                feed = feed.min(way * (acceleration / over).sqrt());
            }
            let third = thirds.iter().flatten().map(|of| of[axis] - hidden.ldexp(1)).reduce(R::max);
            if let Some((jerk, over)) = limits.jerk.zip(third).filter(|(_, over)| *over > R::zero()) {
                feed = feed.min(way * cube_root(of_jerk * (jerk / over)));
            }
        }
        feed
    }
}

/// The magnitudes of a difference of points with these weights, one for each axis; `None` if a point is unknown whose weight is not 0.
fn differences<R: Real, const D: usize>(points: [Option<[R; D]>; 4], weights: [i32; 4]) -> Option<[R; D]> {
    let mut found = [R::zero(); D];
    for (point, weight) in points.iter().zip(weights).filter(|(_, weight)| *weight != 0) {
        let (point, weight) = (point.as_ref()?, R::from_ratio(weight, 1));
        found = core::array::from_fn(|d| found[d] + point[d] * weight);
    }
    Some(found.map(R::abs))
}

/// The path around a place.
struct Around<'a, R, const D: usize> {
    places: &'a [PathPoint<R, D>],
    at: R,
}

impl<R: Real, const D: usize> Around<'_, R, D> {
    /// The point at a distance from the place, on the straight line between two that are known; `None` beyond these, as behind a stop.
    fn point(&self, from_here: R) -> Option<[R; D]> {
        let distance = self.at + from_here;
        let next = self.places.partition_point(|place| place.distance < distance);
        let to = self.places.get(next)?;
        if to.distance == distance {
            return Some(to.point);
        }
        let from = self.places.get(next.checked_sub(1)?)?;
        let share = (distance - from.distance) / (to.distance - from.distance);
        Some(core::array::from_fn(|d| from.point[d] + (to.point[d] - from.point[d]) * share))
    }
}

#[cfg(test)]
mod tests {
    use crate::limit::track::{arc, limit_along};
    use crate::test_paths::paper_limits;
    use crate::{AxisLimits, FeedLimit, Junction, KinematicLimits};

    const DEVIATION: f64 = 0.01;

    /// The paper's limits with corners that are rounded, and axes of this acceleration and jerk.
    fn limits(acceleration: Option<f64>, jerk: Option<f64>) -> KinematicLimits<f64> {
        let axis = AxisLimits { velocity: None, acceleration, jerk };
        KinematicLimits { junction: Junction::Deviation(DEVIATION), axes: [axis; 3], ..paper_limits() }
    }

    fn least(limit: &FeedLimit<f64>) -> f64 {
        limit.samples().iter().fold(f64::MAX, |least, sample| least.min(sample.lower))
    }

    /// By how much setpoints along moves at a constant feed exceed limits of acceleration and jerk, seen within the deviation, at all
    /// windows; the first setpoint is at a share of a step.
    fn excess(points: &[[f64; 2]], feed: f64, [acceleration, jerk]: [f64; 2], phase: f64) -> f64 {
        let mut distances = vec![0.0];
        for pair in points.windows(2) {
            let step = (pair[1][0] - pair[0][0]).hypot(pair[1][1] - pair[0][1]);
            distances.push(distances[distances.len() - 1] + step);
        }
        let at = |distance: f64| {
            let next = distances.partition_point(|to| *to < distance).clamp(1, points.len() - 1);
            let share = (distance - distances[next - 1]) / (distances[next] - distances[next - 1]);
            let [from, to] = [points[next - 1], points[next]];
            [from[0] + share * (to[0] - from[0]), from[1] + share * (to[1] - from[1])]
        };
        let steps = (0..).map(|i| feed * (f64::from(i) + phase));
        let places: Vec<_> = steps.take_while(|way| *way < distances[distances.len() - 1]).map(at).collect();
        let mut most = 0.0_f64;
        for width in (0..9).map(|power| 1 << power) {
            let h = width as f64;
            for i in 3 * width..places.len() {
                let four = [0, 1, 2, 3].map(|back| places[i - back * width]);
                for [x, y, z, u] in [four.map(|place| place[0]), four.map(|place| place[1])] {
                    let second = (x - 2.0 * y + z).abs() - 4.0 * DEVIATION;
                    let third = (x - 3.0 * y + 3.0 * z - u).abs() - 8.0 * DEVIATION;
                    most = most.max(second / (acceleration * h * h)).max(third / (jerk * h * h * h));
                }
            }
        }
        most
    }

    /// A lone corner by the closed forms Δv = √(16 A δ) and ∛(432 · ¾ J δ²), for one axis in the direction of the turn.
    #[test]
    fn a_lone_corner_has_the_feed_of_the_closed_form() {
        let jerk = 1e-6;
        for degrees in [20.0_f64, 45.0, 90.0] {
            let half = degrees.to_radians() / 2.0;
            let points =
                [[-20.0 * half.cos(), 20.0 * half.sin()], [0.0, 0.0], [20.0 * half.cos(), 20.0 * half.sin()]];
            let found = least(&limit_along(&points, &limits(None, Some(jerk))));
            let closed = (432.0 * 0.75 * jerk * DEVIATION * DEVIATION).cbrt() / (2.0 * half.sin());
            assert!((1.0 - 1e-9..1.0005).contains(&(found / closed)), "{degrees}: {found} {closed}");
            for phase in [0.0, 0.3, 0.5, 0.9] {
                let excess = excess(&points, found, [1.0, jerk], phase);
                assert!((0.5..0.85).contains(&excess), "{degrees}: {excess}");
            }
        }
        // The junction's own formula asks for less than half of such an acceleration.
        let corner = [[-20.0, 0.0], [0.0, 0.0], [0.0, 20.0]];
        let [free, slow] =
            [None, Some(1e-4)].map(|acceleration| least(&limit_along(&corner, &limits(acceleration, None))));
        let closed = (16.0 * 1e-4 * DEVIATION).sqrt();
        assert!(slow < free && (1.0 - 1e-9..1.0005).contains(&(slow / closed)), "{free} {slow} {closed}");
    }

    /// A break too small for a stop was passed at full feed however little an axis across it accelerates: setpoints took up to ten times its
    /// acceleration, in the period over the break.
    #[test]
    fn a_break_without_a_corner_keeps_the_limits_of_the_axes_across_it() {
        let full = paper_limits();
        // Half of what the chord error allows.
        let slope = 2.0 * full.chord_error / (full.feedrate * full.interpolation_period);
        let path = [[-20.0, 0.0], [0.0, 0.0], [20.0, 20.0 * slope]];
        // The acceleration that it takes of an axis across it in a period.
        let taken = full.feedrate * slope / full.interpolation_period;
        for (acceleration, jerk) in
            [(Some(taken / 10.0), None), (None, Some(taken / 3.0)), (Some(taken / 3.0), Some(taken / 9.0))]
        {
            let across = AxisLimits { velocity: None, acceleration, jerk };
            let none = AxisLimits::default();
            let limits = KinematicLimits { axes: [none, across, none], junction: Junction::Stop, ..full };
            let found = least(&limit_along(&path, &limits));
            assert!(found > 0.0 && found < full.feedrate, "{found}");
            let jump = found * slope;
            let off = full.feedrate * 2.0_f64.powi(-15);
            // Seen over a period, and over some.
            for window in 1..9_i32 {
                let h = f64::from(window);
                let excess =
                    |order: i32, most: f64| (jump * h - 2.0_f64.powi(order) * off) / (most * h.powi(order));
                let by_acceleration = acceleration.map_or(0.0, |most| excess(2, most));
                let by_jerk = jerk.map_or(0.0, |most| excess(3, most));
                assert!(
                    by_acceleration.max(by_jerk) <= 1.005,
                    "{acceleration:?} {jerk:?}: {by_acceleration} {by_jerk}"
                );
            }
        }
    }

    /// A corner that an axis rounds in seconds has the same feed whether setpoints come once or a thousand times in them.
    #[test]
    fn the_period_changes_no_feed_of_a_lone_corner() {
        let corner = [[-20.0, 0.0], [0.0, 0.0], [0.0, 20.0]];
        let slow = limits(Some(1e-4), Some(1e-6));
        let often = KinematicLimits { interpolation_period: slow.interpolation_period / 1024.0, ..slow };
        let [seldom, often] = [slow, often].map(|limits| least(&limit_along(&corner, &limits)));
        assert!((seldom / often - 1.0).abs() < 1e-9, "{seldom} {often}");
    }

    /// A circle in moves that each turn little is a bend: √(A R) and ∛(¾ J R²), for a motion within δ of it is hardly wider.
    #[test]
    fn a_circle_of_short_moves_is_the_bend_that_it_stands_for() {
        for radius in [2.0, 5.0, 20.0] {
            let points = arc(radius, 0.1, 3.0);
            let (acceleration, jerk) = (2e-3, 1e-5);
            let by_acceleration = least(&limit_along(&points, &limits(Some(acceleration), None)));
            let by_jerk = least(&limit_along(&points, &limits(None, Some(jerk))));
            let bends = [(acceleration * radius).sqrt(), (0.75 * jerk * radius * radius).cbrt()];
            for (found, bend) in [by_acceleration, by_jerk].into_iter().zip(bends) {
                let expected = bend.min(0.6);
                // Bends of fine moves leave a part of the acceleration to the feed.
                assert!((0.8..1.2).contains(&(found / expected)), "{radius}: {found} of {expected}");
            }
            let both = least(&limit_along(&points, &limits(Some(acceleration), Some(jerk))));
            for phase in [0.0, 0.5] {
                let excess = excess(&points, both, [acceleration, jerk], phase);
                assert!(excess <= 1.0, "{radius}: {excess}");
            }
        }
    }

    /// Moves that stay within the deviation of a straight line stand for it.
    #[test]
    fn moves_along_a_line_are_a_line() {
        let points: Vec<_> = (0..200_u32)
            .map(|i| [0.2 * f64::from(i), if i.is_multiple_of(2) { 0.0 } else { 1e-4 }])
            .collect();
        let free = limit_along(&points, &limits(None, None));
        let limited = limit_along(&points, &limits(None, Some(1e-7)));
        assert_eq!(least(&free), least(&limited));
    }
}
