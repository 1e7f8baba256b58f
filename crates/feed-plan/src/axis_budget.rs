//! What limits of single axes leave for the path.
//!
//! With the unit tangent e, the curvature vector `k = de/ds`, and `c = dk/ds`, the motion of the axes at the feed V is
//!
//! ```text
//! velocity      e V
//! acceleration  e a + k V²
//! jerk          e j + 3 k V a + c V³
//! ```
//!
//! Part of what an axis can do goes into turning the path, the rest into changing the feed. How it is shared out is
//! decided before the plan is made. An acceleration `a₀ = min(A₀, √(j₀ V))`, with `A₀ = min(A, 0.7 min Aᵢ)`, and a jerk
//! `j₀ = min(J, ½ min Jᵢ)` are kept for the path everywhere, and the feed is limited so that the axes can turn with what is left:
//!
//! ```text
//! V |eᵢ| ≤ Vᵢ        V² |kᵢ| ≤ Aᵢ - |eᵢ| A₀        3 |kᵢ| V a₀ + |cᵢ| V³ ≤ Jᵢ - |eᵢ| j₀
//! ```
//!
//! A ramp from rest to V with jerk j₀ never exceeds √(j₀ V): reserving more would waste the axes' jerk in bends. V counts as at least
//! F/16 in that root, for the reserve of a slow point holds up to the next key point: with F/4 plans took up to two fifths longer,
//! with F/64 up to a sixth.
//!
//! With 0.7 the second one leaves at least 0.7 Aᵢ for turning, whatever the direction: `(1 - 0.7 cos θ)/sin θ` is least at
//! `cos θ = 0.7`. With all of Aᵢ in reserve, the feed would have to vanish where a bend begins along the axis. Where the path is
//! straighter or slower than that, more than the reserve is left: the path's acceleration and jerk on a stretch between
//! two key points are the least allowance found on it, by 2⁻⁶ of the surplus less since it is found at samples.
//!
//! Beside a stop a₀ is `min(A₀, √(2 j₀ V))`, however slow: `d(a²) = 2 j dV`, so that no more than that is reached between rest and V
//! with the jerk j₀, and the path has no more than j₀ there. So the feed may fall as ρ^(2/3) where a bend of radius ρ is all
//! but a cusp, and the bend takes a time of `(ρ/Jᵢ)^(1/3)`: with F/16 it was crept along for up to half a second.
//!
//! Where the curvature steps, as from a line to an arc, the jerk of an axis is infinite at any feed. The step of its
//! acceleration is then limited to what its jerk allows in one period: `V² |k₂ - k₁|ᵢ ≤ Jᵢ T`.

use real::Real;

use crate::feed_limit::Measured;
use crate::limits::AXES;
use crate::{AxisLimits, KinematicLimits};

/// Halvings in the search for a feed: what is left of it then is no number any more.
const HALVINGS: usize = 64;
/// The share of F that √(j₀ V) is reckoned with at least, as a power of two.
const LEAST_FEED: i32 = -4;
/// Taken off what samples leave beyond the reserve.
const SURPLUS_MARGIN: i32 = -6;

/// Direction and curvature of the path at one point, or the largest of each component on a stretch.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Turning<R> {
    /// |eᵢ|.
    pub(crate) tangent: [R; AXES],
    /// |kᵢ|.
    pub(crate) curvature: [R; AXES],
    /// |cᵢ|.
    pub(crate) change: [R; AXES],
}

/// The path's acceleration and jerk on a stretch.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Allowance<R> {
    pub(crate) acceleration: R,
    pub(crate) jerk: R,
}

impl<R: Real> Allowance<R> {
    pub(crate) fn unlimited() -> Self {
        Self { acceleration: R::max_value(), jerk: R::max_value() }
    }

    pub(crate) fn min(self, other: Self) -> Self {
        Self { acceleration: self.acceleration.min(other.acceleration), jerk: self.jerk.min(other.jerk) }
    }
}

/// Limits of the axes, with the path's reserve.
#[derive(Clone, Copy, Debug)]
pub(crate) struct AxisBudget<R> {
    axes: [AxisLimits<R>; AXES],
    path: Allowance<R>,
    /// A₀ and j₀.
    reserve: Allowance<R>,
    /// √j₀, if an axis has a limit of jerk.
    root_jerk: Option<R>,
    least_feed: R,
    period: R,
}

impl<R: Real> AxisBudget<R> {
    /// `None` when no axis has a limit.
    pub(crate) fn new(limits: &KinematicLimits<R>) -> Option<Self> {
        let least =
            |of: fn(&AxisLimits<R>) -> Option<R>| limits.axes.iter().filter_map(of).reduce(|a, b| a.min(b));
        let (acceleration, jerk) = (least(|axis| axis.acceleration), least(|axis| axis.jerk));
        acceleration.or(jerk).or(least(|axis| axis.velocity))?;
        let path = Allowance { acceleration: limits.acceleration, jerk: limits.jerk };
        let share = R::from_ratio(7, 10);
        let reserve = Allowance {
            acceleration: acceleration.map_or(path.acceleration, |a| path.acceleration.min(a * share)),
            jerk: jerk.map_or(path.jerk, |j| path.jerk.min(j.half())),
        };
        Some(Self {
            axes: limits.axes,
            path,
            reserve,
            root_jerk: jerk.map(|_| reserve.jerk.sqrt()),
            least_feed: limits.feedrate.scale(LEAST_FEED),
            period: limits.interpolation_period,
        })
    }

    /// a₀ where the path is passed at up to `feed`.
    fn acceleration_at(&self, feed: R) -> R {
        let reached = self.root_jerk.map(|root| root * feed.max(self.least_feed).sqrt());
        reached.map_or(self.reserve.acceleration, |reached| reached.min(self.reserve.acceleration))
    }

    /// The largest feed up to `feed` at which velocities and accelerations leave the reserve, at a point.
    pub(crate) fn feed_at(&self, turning: &Turning<R>, feed: R) -> R {
        let mut feed = feed;
        for (i, axis) in self.axes.iter().enumerate() {
            let (tangent, curvature) = (turning.tangent[i], turning.curvature[i]);
            if let Some(most) = axis.velocity.filter(|most| tangent * feed > *most) {
                feed = most / tangent;
            }
            if let Some(most) = axis.acceleration {
                let left = most - tangent * self.reserve.acceleration;
                if curvature * feed * feed > left {
                    feed = feed.min((left / curvature).sqrt());
                }
            }
        }
        feed
    }

    /// Whether an axis has a limit of acceleration.
    pub(crate) fn limits_acceleration(&self) -> bool {
        self.axes.iter().any(|axis| axis.acceleration.is_some())
    }

    /// The largest share that these accelerations across a path in this direction take of what the reserve leaves.
    pub(crate) fn strain(&self, tangent: &[R; AXES], across: &[R; AXES]) -> R {
        let shares = self.axes.iter().zip(tangent).zip(across).filter_map(|((axis, tangent), across)| {
            Some(*across / (axis.acceleration? - *tangent * self.reserve.acceleration))
        });
        shares.fold(R::zero(), R::max)
    }

    /// Leaves the path no more than the reserve of acceleration within `reach` of a place.
    pub(crate) fn keep_reserve(&self, samples: &mut [Measured<R>], at: R, reach: R) {
        let first = samples.partition_point(|sample| sample.point.distance < at - reach);
        let within = samples.iter_mut().skip(first);
        for sample in within.take_while(|sample| sample.point.distance <= at + reach) {
            let least = &mut sample.allowance.acceleration;
            *least = least.min(self.reserve.acceleration);
        }
    }

    /// The largest feed up to `feed` at which jerks leave the reserve, on a stretch.
    pub(crate) fn feed_on(&self, turning: &Turning<R>, feed: R) -> R {
        self.feed_by_jerk(turning, feed, |feed| self.acceleration_at(feed))
    }

    /// The same beside a stop, where the path's acceleration is no more than the feed has come to since rest.
    pub(crate) fn feed_beside_stop(&self, turning: &Turning<R>, feed: R) -> R {
        let from_rest = |feed: R| self.root_jerk.map(|root| root * (feed + feed).sqrt());
        let most = self.reserve.acceleration;
        self.feed_by_jerk(turning, feed, |feed| from_rest(feed).map_or(most, |reached| reached.min(most)))
    }

    /// What is left for the path at [`feed_beside_stop`](Self::feed_beside_stop).
    pub(crate) fn reserve(&self) -> Allowance<R> {
        self.reserve
    }

    fn feed_by_jerk(&self, turning: &Turning<R>, feed: R, acceleration_at: impl Fn(R) -> R) -> R {
        self.axes.iter().enumerate().fold(feed, |feed, (i, axis)| {
            let Some(most) = axis.jerk else { return feed };
            let left = most - turning.tangent[i] * self.reserve.jerk;
            let bend = turning.curvature[i] * R::from_ratio(3, 1);
            // It rises with the feed.
            largest(feed, |feed| {
                bend * acceleration_at(feed) * feed + turning.change[i] * feed * feed * feed <= left
            })
        })
    }

    /// The largest feed up to `feed` for a step of the curvature.
    pub(crate) fn feed_over(&self, step: &[R; AXES], feed: R) -> R {
        let pairs = self.axes.iter().zip(step);
        pairs.fold(feed, |feed, (axis, step)| match axis.jerk {
            Some(most) if *step * feed * feed > most * self.period => {
                feed.min((most * self.period / *step).sqrt())
            }
            _ => feed,
        })
    }

    /// What is left for the path on a stretch that is passed at up to `feed`.
    pub(crate) fn allowance(&self, turning: &Turning<R>, feed: R) -> Allowance<R> {
        let mut acceleration = self.path.acceleration;
        for (i, axis) in self.axes.iter().enumerate() {
            let (tangent, curvature) = (turning.tangent[i], turning.curvature[i]);
            if let Some(most) = axis.acceleration {
                acceleration = acceleration.min(quotient(most - curvature * feed * feed, tangent));
            }
            if let Some(most) = axis.jerk {
                let left = most - tangent * self.reserve.jerk - turning.change[i] * feed * feed * feed;
                acceleration = acceleration.min(quotient(left, curvature * feed * R::from_ratio(3, 1)));
            }
        }
        let acceleration = above(self.acceleration_at(feed), acceleration);
        let mut jerk = self.path.jerk;
        for (i, axis) in self.axes.iter().enumerate() {
            let Some(most) = axis.jerk else { continue };
            let by_acceleration = turning.curvature[i] * feed * acceleration * R::from_ratio(3, 1);
            let left = most - by_acceleration - turning.change[i] * feed * feed * feed;
            jerk = jerk.min(quotient(left, turning.tangent[i]));
        }
        Allowance { acceleration, jerk: above(self.reserve.jerk, jerk) }
    }
}

/// Magnitudes of the components, axis by axis.
pub(crate) fn components<R: Real, const D: usize>(vector: &[R; D]) -> [R; AXES] {
    core::array::from_fn(|i| vector.get(i).map_or_else(R::zero, |component| component.abs()))
}

/// The largest value up to `most` that holds, where all below one do, and 0 does.
fn largest<R: Real>(most: R, holds: impl Fn(R) -> bool) -> R {
    if holds(most) {
        return most;
    }
    let (mut low, mut high) = (R::zero(), most);
    for _ in 0..HALVINGS {
        let middle = low + (high - low).half();
        if holds(middle) { low = middle } else { high = middle }
    }
    low
}

/// `value / divisor`; the largest number where that would be no limit.
fn quotient<R: Real>(value: R, divisor: R) -> R {
    if divisor > R::zero() { value / divisor } else { R::max_value() }
}

/// The reserve, and most of what is left beyond it.
fn above<R: Real>(reserve: R, found: R) -> R {
    let surplus = found - reserve;
    if surplus > R::zero() { reserve + (surplus - surplus.scale(SURPLUS_MARGIN)) } else { reserve }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::test_paths::paper_limits;
    use proptest::prelude::*;

    fn budget(velocity: f64, acceleration: f64, jerk: f64) -> AxisBudget<f64> {
        let axis =
            AxisLimits { velocity: Some(velocity), acceleration: Some(acceleration), jerk: Some(jerk) };
        AxisBudget::new(&KinematicLimits { axes: [axis; AXES], ..paper_limits() }).unwrap()
    }

    #[test]
    fn without_a_limit_there_is_no_budget() {
        assert!(AxisBudget::new(&paper_limits()).is_none());
    }

    #[test]
    fn a_straight_line_along_an_axis_leaves_nearly_all_of_it() {
        let turning = Turning { tangent: [1.0, 0.0, 0.0], curvature: [0.0; 3], change: [0.0; 3] };
        let budget = budget(0.3, 0.01, 0.001);
        assert!((budget.feed_at(&turning, 0.6) - 0.3).abs() < 1e-15);
        let left = budget.allowance(&turning, 0.3);
        assert!((0.009_9..=0.01).contains(&left.acceleration), "{left:?}");
        assert!((0.000_98..=0.001).contains(&left.jerk), "{left:?}");
    }

    proptest! {
        /// Whatever feed up to the limit, acceleration and jerk up to the allowance a plan takes, each axis keeps its own.
        #[test]
        fn the_axes_keep_their_limits(
            angle in 0.0..1.6_f64, curvature in 0.0..2.0_f64, change in 0.0..2.0_f64, velocity in 0.01..1.0_f64,
            acceleration in 1e-4..0.1_f64, jerk in 1e-5..0.02_f64, shares in prop::array::uniform3(0.0..=1.0_f64),
        ) {
            let budget = budget(velocity, acceleration, jerk);
            let (sine, cosine) = angle.sin_cos();
            let turning = Turning {
                tangent: [cosine.abs(), sine.abs(), 0.0],
                curvature: [sine.abs() * curvature, cosine.abs() * curvature, 0.0],
                change: [change, change / 2.0, 0.0],
            };
            let feed = budget.feed_on(&turning, budget.feed_at(&turning, 0.6));
            let left = budget.allowance(&turning, feed);
            prop_assert!(left.acceleration >= budget.acceleration_at(feed) && left.jerk >= budget.reserve.jerk);
            prop_assert!(left.acceleration <= 0.045 && left.jerk <= 0.0108);
            let (v, a, j) = (feed * shares[0], left.acceleration * shares[1], left.jerk * shares[2]);
            for i in 0..2 {
                let (e, k, c) = (turning.tangent[i], turning.curvature[i], turning.change[i]);
                prop_assert!(e * v <= velocity * (1.0 + 1e-12));
                prop_assert!(e * a + k * v * v <= acceleration * (1.0 + 1e-12));
                prop_assert!(e * j + 3.0 * k * v * a + c * v * v * v <= jerk * (1.0 + 1e-12));
            }

            // Beside a stop, on a ramp from rest with no more than the reserve.
            let feed = budget.feed_beside_stop(&turning, budget.feed_at(&turning, 0.6));
            let reserve = budget.reserve();
            let (v, j) = (feed * shares[0], reserve.jerk * shares[2]);
            let a = shares[1] * Real::sqrt(2.0 * reserve.jerk * v).min(reserve.acceleration);
            for i in 0..2 {
                let (e, k, c) = (turning.tangent[i], turning.curvature[i], turning.change[i]);
                prop_assert!(e * a + k * v * v <= acceleration * (1.0 + 1e-12));
                prop_assert!(e * j + 3.0 * k * v * a + c * v * v * v <= jerk * (1.0 + 1e-12));
            }
        }
    }
}
