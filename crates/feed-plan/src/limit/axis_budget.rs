//! How much of the axes' limits is left for the motion along the path.
//!
//! With the unit tangent e, the curvature vector `k = de/ds`, and `c = dk/ds`, the motion of the axes at the feed V is
//!
//! ```text
//! velocity      e V
//! acceleration  e a + k V²
//! jerk          e j + 3 k V a + c V³
//! ```
//!
//! A part of each axis's limit goes into turning the path, the rest into changing the feed. The shares are decided
//! before the plan is made. An acceleration `a₀ = min(A₀, √(j₀ V))`, with `A₀ = min(A, 0.7 min Aᵢ/σᵢ)`, and a jerk `j₀
//! = min(J, ½ min Jᵢ/σᵢ)` are reserved for the path. The feed is limited so that the axes can turn with the rest:
//!
//! ```text
//! V |eᵢ| ≤ Vᵢ        V² |kᵢ| ≤ Aᵢ - |eᵢ| A₀        3 |kᵢ| V a₀ + |cᵢ| V³ ≤ Jᵢ - |eᵢ| j₀
//! ```
//!
//! The share `σᵢ = √(eᵢ² + nᵢ²)`, `n = k/|k|`, is the largest component that the direction of axis i has in the plane
//! in which the path bends. It is 1 for both axes of a circle in their plane, all the way round, and `|eᵢ|` on a
//! straight line. It is 0 for an axis that stands still, so that such an axis limits nothing. It depends on the shape
//! alone, not on the spans that represent the shape. An axis outside of that plane keeps its limits like any other, but
//! no reserve is taken from it.
//!
//! A ramp from rest to V with jerk j₀ never exceeds √(j₀ V): a larger reserve would waste the axes' jerk in bends. In
//! that root V counts as at least F/16, since the reserve of a slow point holds up to the next key point. With F/4
//! plans took up to two fifths longer, with F/64 up to a sixth.
//!
//! With the factor 0.7 the second inequality leaves at least 0.7 Aᵢ/σᵢ for turning, whatever the direction: `(1 - 0.7
//! cos θ)/sin θ` is least at `cos θ = 0.7`. If all of Aᵢ were reserved, the feed would have to vanish where a bend
//! begins along the axis. Where the path is straighter or slower, more than the reserve is left for the path. The
//! path's acceleration and jerk on a stretch between two key points are the least allowance found on it. Since that is
//! found at samples, 2⁻⁶ of the surplus over the reserve is taken off.
//!
//! Beside a stop a₀ is `min(A₀, √(2 j₀ V))`, however low the feed. The path has no more jerk than j₀ there, and since
//! `d(a²) = 2 j dV`, it reaches no more acceleration than that between rest and V. So the feed may fall as ρ^(2/3)
//! where a bend of radius ρ is almost a cusp, and the bend takes a time of `(ρ/Jᵢ)^(1/3)`. With F/16 the plan crept
//! along such a bend for up to half a second.
//!
//! Where the curvature steps, as from a line to an arc, the jerk of an axis is infinite at any feed. The step of its
//! acceleration is then limited to what its jerk allows in one period: `V² |k₂ - k₁|ᵢ ≤ Jᵢ T`.

use real::Real;

use crate::limits::AXES;
use crate::{AxisLimits, KinematicLimits};

/// Halvings in the search for a feed: after so many, no format resolves the interval that is left.
const HALVINGS: usize = 64;
/// The root √(j₀ V) is taken of no less than this share of F, as a power of two.
const LEAST_FEED: i32 = -4;
/// The share of the surplus over the reserve that is taken off, since samples may miss the least surplus.
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
    /// σᵢ.
    pub(crate) share: [R; AXES],
}

impl<R: Real> Turning<R> {
    /// The turning of a straight line, or of no path.
    pub(crate) fn none() -> Self {
        let none = [R::zero(); AXES];
        Self { tangent: none, curvature: none, change: none, share: none }
    }

    /// The turning at one point, without its change, which is not known there.
    pub(crate) fn at<const D: usize>(tangent: &[R; D], bend: &[R; D]) -> Self {
        let (tangent, curvature) = (components(tangent), components(bend));
        let length = R::norm(&curvature);
        let share = core::array::from_fn(|i| {
            let normal = if length > R::zero() { curvature[i] / length } else { R::zero() };
            R::norm(&[tangent[i], normal]).min(R::one())
        });
        Self { tangent, curvature, share, ..Self::none() }
    }

    /// The larger of both, component by component.
    pub(crate) fn max(self, other: &Self) -> Self {
        let largest = |a: [R; AXES], b: [R; AXES]| core::array::from_fn(|i| a[i].max(b[i]));
        Self {
            tangent: largest(self.tangent, other.tangent),
            curvature: largest(self.curvature, other.curvature),
            change: largest(self.change, other.change),
            share: largest(self.share, other.share),
        }
    }
}

/// The acceleration and jerk that are allowed along the path on a stretch.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Allowance<R> {
    pub(crate) acceleration: R,
    pub(crate) jerk: R,
}

impl<R: Real> Allowance<R> {
    pub(crate) fn unlimited() -> Self {
        Self { acceleration: R::max_value(), jerk: R::max_value() }
    }

    /// All that the path has.
    pub(crate) fn of_path(limits: &KinematicLimits<R>) -> Self {
        Self { acceleration: limits.acceleration, jerk: limits.jerk }
    }

    pub(crate) fn min(self, other: Self) -> Self {
        Self { acceleration: self.acceleration.min(other.acceleration), jerk: self.jerk.min(other.jerk) }
    }

    pub(crate) fn times(self, shares: Self) -> Self {
        Self { acceleration: self.acceleration * shares.acceleration, jerk: self.jerk * shares.jerk }
    }
}

/// Limits of the axes and of the path.
#[derive(Clone, Copy, Debug)]
pub(crate) struct AxisBudget<R> {
    axes: [AxisLimits<R>; AXES],
    path: Allowance<R>,
    least_feed: R,
    period: R,
}

impl<R: Real> AxisBudget<R> {
    /// The budget; `None` when no axis has a limit.
    pub(crate) fn new(limits: &KinematicLimits<R>) -> Option<Self> {
        let is_limited = |axis: &AxisLimits<R>| axis.velocity.or(axis.acceleration).or(axis.jerk).is_some();
        limits.axes.iter().any(is_limited).then(|| Self {
            axes: limits.axes,
            path: Allowance::of_path(limits),
            least_feed: limits.feedrate.ldexp(LEAST_FEED),
            period: limits.interpolation_period,
        })
    }

    /// Of the velocities of the axes alone: nothing is kept for the path, nor asked for turning it.
    pub(crate) fn of_velocities(self) -> Self {
        let axes = self.axes.map(|axis| AxisLimits { velocity: axis.velocity, ..AxisLimits::default() });
        Self { axes, ..self }
    }

    /// A₀ and j₀ where the axes have these shares.
    pub(crate) fn reserve(&self, share: &[R; AXES]) -> Allowance<R> {
        let most = R::from_ratio(7, 10);
        self.axes.iter().zip(share).fold(self.path, |least, (axis, share)| {
            let of = |limit: Option<R>| limit.map_or_else(R::max_value, |limit| quotient(limit, *share));
            least.min(Allowance {
                acceleration: of(axis.acceleration.map(|a| a * most)),
                jerk: of(axis.jerk.map(R::half)),
            })
        })
    }

    /// The function `V ↦ min(A₀, √(j₀ V))`; A₀ where no axis that moves has a limit of jerk.
    fn reached(&self, share: &[R; AXES]) -> impl Fn(R) -> R {
        let reserve = self.reserve(share);
        let is_limited =
            self.axes.iter().zip(share).any(|(axis, share)| axis.jerk.is_some() && *share > R::zero());
        let root = is_limited.then(|| reserve.jerk.sqrt());
        move |feed| root.map_or(reserve.acceleration, |root| (root * feed.sqrt()).min(reserve.acceleration))
    }

    /// a₀ where the path is passed at no more than `feed`.
    fn acceleration_at(&self, share: &[R; AXES], feed: R) -> R {
        self.reached(share)(feed.max(self.least_feed))
    }

    /// The largest feed at a point, up to `feed`, at which velocities and accelerations leave the reserve to the path.
    pub(crate) fn feed_at(&self, turning: &Turning<R>, feed: R) -> R {
        let mut feed = feed;
        let reserve = self.reserve(&turning.share);
        for (i, axis) in self.axes.iter().enumerate() {
            let (tangent, curvature) = (turning.tangent[i], turning.curvature[i]);
            if let Some(most) = axis.velocity.filter(|most| tangent * feed > *most) {
                feed = most / tangent;
            }
            if let Some(most) = axis.acceleration {
                let left = most - tangent * reserve.acceleration;
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

    /// The share of the axes' accelerations, less the reserve, that these accelerations across a path in this direction
    /// use: the largest of all axes.
    pub(crate) fn strain<const D: usize>(&self, tangent: &[R; D], across: &[R; D]) -> R {
        let turning = Turning::at(tangent, across);
        let reserve = self.reserve(&turning.share).acceleration;
        let parts = self.axes.iter().enumerate().filter_map(|(i, axis)| {
            Some(turning.curvature[i] / (axis.acceleration? - turning.tangent[i] * reserve))
        });
        parts.fold(R::zero(), R::max)
    }

    /// The largest feed on a stretch, up to `feed`, at which jerks leave the reserve to the path.
    pub(crate) fn feed_on(&self, turning: &Turning<R>, feed: R) -> R {
        self.feed_by_jerk(turning, feed, |feed| feed.max(self.least_feed))
    }

    /// [`feed_on`](Self::feed_on) beside a stop, where the path's acceleration is at most what it can reach from rest.
    pub(crate) fn feed_beside_stop(&self, turning: &Turning<R>, feed: R) -> R {
        self.feed_by_jerk(turning, feed, |feed| feed + feed)
    }

    /// The largest feed by jerk; the root √(j₀ V) is taken of `reckoned(V)`.
    fn feed_by_jerk(&self, turning: &Turning<R>, feed: R, reckoned: impl Fn(R) -> R) -> R {
        let (reserve, reached) = (self.reserve(&turning.share), self.reached(&turning.share));
        self.axes.iter().enumerate().fold(feed, |feed, (i, axis)| {
            let Some(most) = axis.jerk else { return feed };
            let left = most - turning.tangent[i] * reserve.jerk;
            let bend = turning.curvature[i] * R::from_ratio(3, 1);
            // The jerk that the axis uses rises with the feed.
            largest(feed, |feed| {
                bend * reached(reckoned(feed)) * feed + turning.change[i] * feed * feed * feed <= left
            })
        })
    }

    /// The largest feed, up to `feed`, at which the axes' jerk can follow a step of the curvature.
    pub(crate) fn feed_over(&self, step: &[R; AXES], feed: R) -> R {
        let pairs = self.axes.iter().zip(step);
        pairs.fold(feed, |feed, (axis, step)| {
            let Some(most) = axis.jerk.map(|most| most * self.period * R::from_ratio(2, 3)) else {
                return feed;
            };
            if *step * feed * feed > most { feed.min((most / *step).sqrt()) } else { feed }
        })
    }

    /// The acceleration and jerk that are left for the path on a stretch that is passed at no more than `feed`.
    pub(crate) fn allowance(&self, turning: &Turning<R>, feed: R) -> Allowance<R> {
        let reserve = self.reserve(&turning.share);
        let mut acceleration = self.path.acceleration;
        for (i, axis) in self.axes.iter().enumerate() {
            let (tangent, curvature) = (turning.tangent[i], turning.curvature[i]);
            if let Some(most) = axis.acceleration {
                acceleration = acceleration.min(quotient(most - curvature * feed * feed, tangent));
            }
            if let Some(most) = axis.jerk {
                let left = most - tangent * reserve.jerk - turning.change[i] * feed * feed * feed;
                acceleration = acceleration.min(quotient(left, curvature * feed * R::from_ratio(3, 1)));
            }
        }
        let acceleration = above(self.acceleration_at(&turning.share, feed), acceleration);
        let mut jerk = self.path.jerk;
        for (i, axis) in self.axes.iter().enumerate() {
            let Some(most) = axis.jerk else { continue };
            let by_acceleration = turning.curvature[i] * feed * acceleration * R::from_ratio(3, 1);
            let left = most - by_acceleration - turning.change[i] * feed * feed * feed;
            jerk = jerk.min(quotient(left, turning.tangent[i]));
        }
        Allowance { acceleration, jerk: above(reserve.jerk, jerk) }
    }
}

/// Magnitudes of the components, axis by axis.
pub(crate) fn components<R: Real, const D: usize>(vector: &[R; D]) -> [R; AXES] {
    core::array::from_fn(|i| vector.get(i).map_or_else(R::zero, |component| component.abs()))
}

/// The largest value up to `most` for which `holds` is true. It must hold for 0 and for every value below one that
/// holds.
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

/// `value / divisor`; the largest number where the divisor is 0, since nothing is limited then.
fn quotient<R: Real>(value: R, divisor: R) -> R {
    if divisor > R::zero() { value / divisor } else { R::max_value() }
}

/// The reserve, and the surplus of `found` over it less a margin.
fn above<R: Real>(reserve: R, found: R) -> R {
    let surplus = found - reserve;
    if surplus > R::zero() { reserve + (surplus - surplus.ldexp(SURPLUS_MARGIN)) } else { reserve }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::plan::promises::kept;
    use crate::test_paths::{circle, in_periods, limit_along, paper_limits};
    use crate::{EndFeeds, FeedLimit, Junction, ProfileKind, plan_with};
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
        let turning = Turning::at(&[1.0, 0.0, 0.0], &[0.0; 3]);
        let budget = budget(0.3, 0.01, 0.001);
        assert!((budget.feed_at(&turning, 0.6) - 0.3).abs() < 1e-15);
        let left = budget.allowance(&turning, 0.3);
        assert!((0.009_9..=0.01).contains(&left.acceleration), "{left:?}");
        assert!((0.000_98..=0.001).contains(&left.jerk), "{left:?}");
    }

    /// With a weak Z that stands still, a circle in XY once took 10.4 s; without it, 1.76 s.
    #[test]
    fn a_helix_takes_of_an_axis_what_its_slope_asks_for() {
        let [slope, along] = [0.06, (1.0 - 0.06_f64 * 0.06).sqrt()];
        let weak = AxisLimits { velocity: None, acceleration: Some(1e-3), jerk: Some(1e-4) };
        let axes = [AxisLimits::default(), AxisLimits::default(), weak];
        let limits = KinematicLimits { axes, ..paper_limits() };
        let budget = AxisBudget::new(&limits).unwrap();
        let reserve = budget.reserve(&Turning::at(&[0.0, along, slope], &[-0.05, 0.0, 0.0]).share);
        assert!((reserve.acceleration - 0.7e-3 / slope).abs() < 1e-12, "{reserve:?}");
        assert!((reserve.jerk - 0.5e-4 / slope).abs() < 1e-12, "{reserve:?}");
        let circle = budget.reserve(&Turning::at(&[0.0, 1.0, 0.0], &[-0.05, 0.0, 0.0]).share);
        assert_eq!(circle, Allowance::of_path(&limits));
    }

    /// A circle of 10 mm radius, which an axis of 500 mm/s³ passes at 29 mm/s at most, in 2.2 s: without a limit of its acceleration
    /// all of the path's was kept in reserve, and took the jerk from what turns.
    #[test]
    fn an_axis_with_a_limit_of_jerk_alone_is_not_slowed_down_by_the_paths_acceleration() {
        let curve = circle(10.0);
        let duration = |acceleration: f64, own: Option<f64>| {
            let axis = AxisLimits { velocity: None, acceleration: own, jerk: Some(500e-9) };
            let limits = KinematicLimits {
                axes: [axis, AxisLimits::default(), AxisLimits::default()],
                ..in_periods(1e-3, 100.0, acceleration, 5e4, 5e-4)
            };
            let limit = limit_along(core::slice::from_ref(&curve), &limits);
            let plan = kept(&limit, &limits, ProfileKind::Cubic);
            plan.as_schedule().duration() * 1e-3
        };
        let alone = duration(2000.0, None);
        assert!((2.2..4.5).contains(&alone), "{alone} s");
        for (acceleration, own) in
            [(200.0, None), (20_000.0, None), (2000.0, Some(100.0)), (2000.0, Some(2000.0))]
        {
            let other = duration(acceleration, own);
            assert!((other / alone - 1.0).abs() < 0.05, "{acceleration} {own:?}: {other} s for {alone} s");
        }
    }

    proptest! {
        #![proptest_config(ProptestConfig { max_shrink_iters: 20, ..ProptestConfig::with_cases(64) })]

        /// Holds for any curves, with breaks of the tangent, bends and cusps, and for any limits of the other axes.
        #[test]
        fn an_axis_that_stands_still_changes_no_plan(
            curve in nurbs_core::generate::curve::<2>(),
            weak in prop::array::uniform3(prop::option::of((-9.0..-1.0_f64).prop_map(|e| 10.0_f64.powf(e)))),
            strong in prop::option::of((-4.0..-1.0_f64).prop_map(|e| 10.0_f64.powf(e))),
            deviation in prop::option::of(0.001..0.1_f64),
            kind in prop::sample::select(ProfileKind::ALL.to_vec()),
        ) {
            let [velocity, acceleration, jerk] = weak;
            let x = AxisLimits { velocity: None, acceleration: strong, jerk: strong.map(|a| a / 3.0) };
            let z = AxisLimits { velocity, acceleration, jerk };
            let none = AxisLimits::default();
            let plan = |axes| {
                let junction = deviation.map_or(Junction::Stop, Junction::Deviation);
                let limits = KinematicLimits { axes, junction, ..paper_limits() };
                let limit = FeedLimit::along(&[curve.as_curve()], &limits)?;
                plan_with(&limit, &limits, EndFeeds::default(), kind)
            };
            prop_assert_eq!(plan([x, none, z]), plan([x, none, none]));
        }
    }

    proptest! {
        /// A plan may take any feed up to the limit and any acceleration and jerk up to the allowance: each axis keeps
        /// its limits.
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
                share: [1.0, 1.0, 0.0],
            };
            let feed = budget.feed_on(&turning, budget.feed_at(&turning, 0.6));
            let left = budget.allowance(&turning, feed);
            let reserve = budget.reserve(&turning.share);
            prop_assert!(left.acceleration >= budget.acceleration_at(&turning.share, feed) && left.jerk >= reserve.jerk);
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
