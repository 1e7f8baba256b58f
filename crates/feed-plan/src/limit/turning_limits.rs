//! The accelerations that turning needs over breaks of the tangent.
//!
//! Let a chord go from p before a place c of the path to q behind it, with `A = C(c) - C(c-p)` and
//! `B = C(c+q) - C(c)`. With p = q = V T, two steps over the place change the step by A - B in a period. So the part of
//! A - B across the path stays within a_n T², and each of its components stays within the axis's limit less the path's
//! reserve, for V T on both sides. If a corner that is cut alone needs more, its own rule has allowed that, and it is passed.

use real::Real;

use crate::KinematicLimits;
use crate::limit::axis_budget::{AxisBudget, Turning};
use crate::limit::broken_chord::Chord;
use crate::limit::vector::{across, difference, sum, unit};

/// The limits for turning.
#[derive(Clone, Copy, Debug)]
pub(super) struct TurningLimits<R> {
    /// `a_n T²` across the path.
    across: Option<R>,
    /// The budget of the axes.
    pub(super) budget: Option<AxisBudget<R>>,
    period: R,
}

impl<R: Real> TurningLimits<R> {
    /// `None` if turning is not limited.
    pub(super) fn new(limits: &KinematicLimits<R>) -> Option<Self> {
        let period = limits.interpolation_period;
        let across = limits.centripetal_acceleration.map(|acceleration| acceleration * period * period);
        let budget = AxisBudget::new(limits).filter(AxisBudget::limits_acceleration);
        (across.is_some() || budget.is_some()).then_some(Self { across, budget, period })
    }

    /// The share of the accelerations for turning that the path uses if half of the chord is travelled in a period.
    pub(super) fn strain_over<const D: usize>(&self, chord: &Chord<'_, R, D>) -> R {
        let (along, change) = turn_over(chord);
        self.strain(&along, &change)
    }

    /// The share of the accelerations for turning that a path in the direction `along` uses if its step changes by
    /// `change` in a period.
    pub(super) fn strain<const D: usize>(&self, along: &[R; D], change: &[R; D]) -> R {
        let of_axes = self.budget.map_or_else(R::zero, |budget| {
            let square = self.period * self.period;
            budget.strain(&unit(along), &change.map(|x| x / square))
        });
        self.across.map_or(of_axes, |most| of_axes.max(R::norm(change) / most))
    }
}

/// The acceleration that the path keeps as its reserve where it turns as over this chord.
pub(super) fn reserve_over<R: Real, const D: usize>(budget: &AxisBudget<R>, chord: &Chord<'_, R, D>) -> R {
    let (along, change) = turn_over(chord);
    budget.reserve(&Turning::at(&unit(&along), &change).share).acceleration
}

/// The vector of the whole chord, and the difference of its two halves across that vector.
fn turn_over<R: Real, const D: usize>(chord: &Chord<'_, R, D>) -> ([R; D], [R; D]) {
    let [before, behind] = chord.sides(R::one().half());
    let along = sum(&before, &behind);
    (along, across(&difference(&behind, &before), &along))
}

#[cfg(test)]
mod tests {
    use crate::limit::track::{Track, arc, limit_along, places, range};
    use crate::test_paths::{self, circle, paper_limits};
    use crate::{AxisLimits, FeedLimit, KinematicLimits, ProfileKind};

    /// The largest change of the step in a period, for each axis and across the path, at eight phases of the plan.
    fn most_change(track: &Track, limit: &FeedLimit<f64>, limits: &KinematicLimits<f64>) -> ([f64; 2], f64) {
        let places = places(limit, limits, ProfileKind::SCurve);
        let (mut of_axes, mut across) = ([0.0_f64; 2], 0.0_f64);
        for place in places.windows(17) {
            let [before, here, behind] = [0, 8, 16].map(|i| track.at(place[i]));
            let change = [0, 1].map(|d| behind[d] - here[d] - (here[d] - before[d]));
            let along = [behind[0] - before[0], behind[1] - before[1]];
            let length = along[0].hypot(along[1]);
            across = across.max((change[0] * along[1] - change[1] * along[0]).abs() / length);
            of_axes = [0, 1].map(|d| of_axes[d].max(change[d].abs()));
        }
        (of_axes, across)
    }

    #[test]
    fn turning_takes_no_more_than_it_may_of_accelerations() {
        let points = arc(5.0, 5e-3, 6.0);
        let track = Track::of(&points);
        // By the centripetal acceleration the feed is √(a_n ρ) = 0.1; by the chord error it would be 0.141.
        let limits = KinematicLimits { centripetal_acceleration: Some(2e-3), ..paper_limits() };
        let limit = limit_along(&points, &limits);
        let (least, most) = range(&limit);
        assert!(least > 0.98 * 0.1 && most < 1.005 * 0.1, "{least} to {most}");
        let (_, across) = most_change(&track, &limit, &limits);
        assert!(across <= 2e-3 * 1.01, "{across}");

        // With limits of the axes the feed is the same as along the circle itself.
        let axis = AxisLimits { acceleration: Some(2e-3), ..AxisLimits::default() };
        let limits = KinematicLimits { axes: [axis; 3], ..paper_limits() };
        let limit = limit_along(&points, &limits);
        let (of_axes, _) = most_change(&track, &limit, &limits);
        assert!(of_axes.iter().all(|change| *change <= 2e-3 * 1.02), "{of_axes:?}");
        let circle = circle(5.0);
        let of_circle = test_paths::limit_along(&[circle], &limits);
        let mean = |limit: &FeedLimit<f64>| {
            (100..900).map(|i| limit.at(limit.length() * f64::from(i) / 1000.0)).sum::<f64>() / 800.0
        };
        let (found, expected) = (mean(&limit), mean(&of_circle));
        assert!(found > 0.95 * expected, "{found} for {expected}");
    }
}
