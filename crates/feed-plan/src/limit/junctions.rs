//! Junctions between one span and the next, and the feed at which a plan passes a break of the tangent there.

use real::Real;

use crate::limit::axis_budget::{AxisBudget, components};
use crate::limit::span_walk::{Sample, tangent_rounding};
use crate::limit::vector::difference;
use crate::{Junction, KinematicLimits};

/// The change of direction and curvature where a span begins.
pub(crate) struct Turn<R, const D: usize> {
    /// The difference e₂ - e₁ of the unit tangents, and its length.
    difference: [R; D],
    pub(crate) size: R,
    /// The difference of the curvature vectors.
    bend_step: [R; D],
}

impl<R: Real, const D: usize> Turn<R, D> {
    /// The change from the end of a span, with this tangent and curvature vector, to the begin of the next.
    pub(crate) fn between((end_tangent, end_bend): ([R; D], [R; D]), first: &Sample<R, D>) -> Self {
        let turn = difference(&first.tangent, &end_tangent);
        Self { difference: turn, size: R::norm(&turn), bend_step: difference(&first.bend, &end_bend) }
    }
}

/// The feeds at which junctions are passed.
pub(crate) struct Junctions<'l, R> {
    limits: &'l KinematicLimits<R>,
    budget: Option<AxisBudget<R>>,
    /// Largest difference of unit tangents that is no corner.
    break_tolerance: R,
    /// Largest difference of unit tangents that rounding may make.
    rounding: R,
}

impl<'l, R: Real> Junctions<'l, R> {
    pub(crate) fn new(limits: &'l KinematicLimits<R>) -> Self {
        let by_chord_error = limits.chord_error.ldexp(2) / (limits.feedrate * limits.interpolation_period);
        let by_acceleration = limits.acceleration * limits.interpolation_period / limits.feedrate;
        let rounding = tangent_rounding();
        let break_tolerance = by_chord_error.min(by_acceleration).max(rounding);
        Self { limits, budget: AxisBudget::new(limits), break_tolerance, rounding }
    }

    /// Whether the tangent turns by more than rounding may make.
    pub(crate) fn turns<const D: usize>(&self, turn: &Turn<R, D>) -> bool {
        turn.size > self.rounding
    }

    /// Whether the velocity jumps there, as [`Junction::VelocityJump`] allows. If so, no chord passes the break.
    pub(crate) fn is_jump<const D: usize>(&self, turn: &Turn<R, D>) -> bool {
        matches!(self.limits.junction, Junction::VelocityJump(_)) && turn.size > self.break_tolerance
    }

    /// The feed at the point where a span begins, if the tangent breaks there or if the curvature steps by more than
    /// the axes can follow.
    pub(crate) fn feed<const D: usize>(&self, turn: &Turn<R, D>) -> Option<R> {
        let &Turn { difference, size: turn, bend_step } = turn;
        let feedrate = self.limits.feedrate;
        let is_break = turn > self.break_tolerance;
        let by_turn = match self.limits.junction {
            Junction::Stop => {
                if is_break {
                    R::zero()
                } else {
                    feedrate
                }
            }
            // If rounding of the tangents may account for all of the turn, no junction takes it for a break.
            _ if !(turn > self.rounding) => feedrate,
            Junction::Deviation(deviation) if is_break || self.deviates(turn, deviation) => {
                self.feed_by_deviation(turn, deviation)
            }
            Junction::Deviation(_) => feedrate,
            Junction::VelocityJump(jumps) => {
                let pairs = difference.iter().zip(jumps);
                pairs.fold(
                    feedrate,
                    |feed, (turn, jump)| {
                        if turn.abs() * feed > jump { jump / turn.abs() } else { feed }
                    },
                )
            }
        };
        let feed = if is_break {
            by_turn
        } else {
            let step = components(&bend_step);
            self.budget.as_ref().map_or(by_turn, |budget| budget.feed_over(&step, by_turn))
        };
        (feed < feedrate).then_some(feed)
    }

    /// Whether full feed is above [`feed_by_deviation`](Self::feed_by_deviation), found without a quotient, which would
    /// be large for a small turn.
    fn deviates(&self, turn: R, deviation: R) -> bool {
        let sine = turn.half();
        let cosine = (R::one() - sine * sine).sqrt();
        let across = self.limits.feedrate * sine;
        across * across > self.limits.acceleration_across() * deviation * (cosine * (R::one() + cosine))
    }

    /// The feed of [`Junction::Deviation`], with `turn` = |e₂ - e₁| = 2 sin(φ/2).
    fn feed_by_deviation(&self, turn: R, deviation: R) -> R {
        let sine = turn.half();
        let cosine = (R::one() - sine * sine).sqrt();
        // cos / (1 - cos) = cos (1 + cos) / sin², without cancellation.
        let ratio = (deviation / sine) * (cosine * (R::one() + cosine) / sine);
        (self.limits.acceleration_across() * ratio).sqrt().min(self.limits.feedrate)
    }
}

#[cfg(test)]
mod tests {
    use crate::test_paths::{limit_along, paper_limit_along, paper_limits, polyline, triple_knot};
    use crate::{FeedLimit, Junction, KinematicLimits};

    fn least_lower(limit: &FeedLimit<f64>) -> f64 {
        limit.samples().iter().fold(f64::MAX, |least, sample| least.min(sample.lower))
    }

    #[test]
    fn a_corner_is_a_stop_between_two_full_feeds() {
        let limit = paper_limit_along(&triple_knot());
        let points: Vec<_> = limit.points().collect();
        let stop = points.iter().position(|p| p.feedrate == 0.0).unwrap();
        let around = &points[stop - 1..=stop + 1];
        assert!(around.iter().all(|p| p.distance == around[0].distance), "{around:?}");
        assert!((around[0].feedrate, around[2].feedrate) == (0.6, 0.6), "{around:?}");
        assert_eq!(limit.at(around[1].distance), 0.0);
        assert_eq!(limit.at(around[1].distance + 1e-9), 0.6);
    }

    #[test]
    fn a_break_too_small_to_matter_is_no_stop() {
        // θ may be 4E/(F T) = 1/300, so that the chord over it leaves the corner by no more than E.
        let stops = |angle: f64| {
            let path = polyline(&[[0.0, 0.0], [10.0, 0.0], [20.0, 10.0 * angle]]);
            let limit = limit_along(&path, &paper_limits());
            limit.points().filter(|p| p.feedrate == 0.0).count()
        };
        assert_eq!((stops(0.0033), stops(0.0034)), (0, 1));
    }

    /// A break too small for a stop was once passed at full feed whatever the junction allowed.
    #[test]
    fn a_small_break_keeps_the_limit_of_its_junction() {
        let angle = 0.0033;
        let path = polyline(&[[0.0, 0.0], [20.0, 0.0], [40.0, 20.0 * angle]]);
        let at_break = |junction| {
            let limits = KinematicLimits { junction, ..paper_limits() };
            let limit = limit_along(&path, &limits);
            assert!(crate::plan(&limit, &limits, crate::EndFeeds::default()).is_ok());
            least_lower(&limit)
        };
        assert_eq!(at_break(Junction::Stop), 0.6);
        // 1e-4 over the greater component of e₂ - e₁, which is sin θ.
        let expected = 1e-4 / angle.atan().sin();
        let found = at_break(Junction::VelocityJump([1e-4; 3]));
        assert!((found / expected - 1.0).abs() < 1e-9, "{found} for {expected}");
        assert_eq!(at_break(Junction::VelocityJump([2e-3; 3])), 0.6); // 0.6 · 0.0033 = 1.98e-3
        // By the chord 2δ/tan(θ/2) = 0.0303; by the acceleration √(0.045 · 2.5e-5 · 7.3e5) = 0.91.
        let expected = 2.0 * 2.5e-5 / (angle.atan() / 2.0).tan();
        let found = at_break(Junction::Deviation(2.5e-5));
        assert!((found / expected - 1.0).abs() < 1e-9, "{found} for {expected}");
        assert_eq!(at_break(Junction::Deviation(1e-3)), 0.6);
    }

    /// A right angle within 0.1 mm: `V² = a δ/(√2 - 1)`.
    #[test]
    fn a_corner_is_rounded_with_no_more_than_the_centripetal_acceleration() {
        let path = polyline(&[[0.0, 0.0], [20.0, 0.0], [20.0, 20.0]]);
        for (centripetal, acceleration) in [(None, 0.045), (Some(0.01), 0.01), (Some(0.1), 0.045)] {
            let limits = KinematicLimits {
                junction: Junction::Deviation(0.1),
                centripetal_acceleration: centripetal,
                ..paper_limits()
            };
            let limit = limit_along(&path, &limits);
            let found = least_lower(&limit);
            let expected = (acceleration * 0.1 / (2.0_f64.sqrt() - 1.0)).sqrt();
            assert!((found / expected - 1.0).abs() < 1e-9, "{centripetal:?}: {found} for {expected}");
        }
    }
}
