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
