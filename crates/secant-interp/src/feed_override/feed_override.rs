//! Feed override and feed hold while a plan runs: they stretch the plan's time.
//!
//! With the plan's own time τ running at the rate `r = dτ/dt`, the feed is `r V(τ)`, and
//!
//! ```text
//! acceleration  r² a + r' V
//! jerk          r³ j + 3 r r' a + r'' V
//! ```
//!
//! A plan that uses up its limits has no acceleration and jerk left for r' and r''. So it is made with less than the
//! machine can do: within A_p < A and J_p < J, at feeds up to V_p. The rate r is at most 1. The following bounds, ρ₁ of
//! |r'| and ρ₂ of |r''|, then keep A and J everywhere:
//!
//! ```text
//! ρ₁ = min((A - A_p)/V_p, (J - J_p)/(6 A_p))        ρ₂ = (J - J_p - 3 ρ₁ A_p)/V_p
//! ```
//!
//! An override above 100 % needs a plan for the highest override. Plan with that multiple of the commanded feed as the
//! feedrate, under the same limits, and take r = 1 as that override. The commanded feed, 100 %, is then the rate
//! 1/multiple. Chord error, centripetal acceleration and the axes' feeds hold at every rate up to 1, since each falls
//! with the rate. The same bounds hold for each axis, with its own A, J, A_p, J_p and V_p. Where axes have limits, the
//! least bounds of all are taken ([`FeedOverride::and`]).
//!
//! Hold is the rate 0. The rate is constant over a period. From period to period it changes by at most ρ₁, and this
//! change changes by at most ρ₂, braked in time so that it is 0 when the rate reaches its target. A and J are kept in
//! the same sense: the change of a period's distance from one period to the next, and the change of that change, stay
//! within them. Rate and time are counted in whole units, so that both are exact in every format and the plan ends exactly
//! where its schedule ends.

use core::num::NonZeroU64;

use real::Real;

use crate::feed_override::landing::Landing;
use crate::step_lengths::{LengthCursor, StepLengths};

/// The rate 1, in units of 2⁻³².
pub(crate) const ONE: u64 = 1 << 32;

/// A share of the plan's own speed, from 0 to 1, in units of 2⁻³²: the same in every format.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub struct Rate(pub(crate) u64);

impl Rate {
    /// Feed hold.
    pub const HOLD: Self = Self(0);
    /// The plan as it is.
    pub const FULL: Self = Self(ONE);

    /// A share as a rate, rounded down. A share above 1 gives 1; a share below 0 or NaN gives 0.
    #[must_use]
    pub fn of<R: Real>(share: R) -> Self {
        Self(units(share))
    }

    /// The rate as a share.
    #[must_use]
    pub fn share<R: Real>(self) -> R {
        if self.0 >= ONE { R::one() } else { R::from_phase(self.0 << 32, 0) }
    }
}

/// The limits of the machine and the largest values in the plan, with the period as the unit of time.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct OverrideLimits<R> {
    /// A: the plan's acceleration and the override together keep it.
    pub acceleration: R,
    /// J.
    pub jerk: R,
    /// A_p, the largest acceleration in the plan; less than A.
    pub planned_acceleration: R,
    /// J_p, less than J.
    pub planned_jerk: R,
    /// V_p, the largest feed in the plan.
    pub planned_feed: R,
}

/// How fast the rate may change: ρ₁ and ρ₂ in units of 2⁻³² per period and per period².
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct FeedOverride {
    pub(crate) slope: u64,
    pub(crate) bend: NonZeroU64,
    /// A and J in units of 2⁻⁴⁸, and J over A, at most 1, in units of 2⁻³². The landing behind the schedule's end needs
    /// them.
    pub(crate) acceleration: u64,
    pub(crate) jerk: u64,
    pub(crate) jerk_per_acceleration: u64,
}

/// The present rate: all values that change from period to period.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct OverrideState {
    /// r, in units of 2⁻³².
    rate: u64,
    /// r' in units per period.
    slope: i64,
    target: u64,
    /// The landing behind the schedule's end.
    pub(crate) landing: Landing,
}

impl OverrideState {
    /// The state at this rate, with this rate as the target.
    #[must_use]
    pub fn at(rate: Rate) -> Self {
        Self { rate: rate.0, slope: 0, target: rate.0, landing: Landing::default() }
    }

    /// Asks for another rate.
    pub fn set(&mut self, target: Rate) {
        self.target = target.0;
    }

    /// The rate of the period that [`FeedOverride::advance`] gave last.
    #[must_use]
    pub fn rate(&self) -> Rate {
        Rate(self.rate)
    }

    /// Whether the rate has reached its target and stays there.
    #[must_use]
    pub fn is_settled(&self) -> bool {
        self.rate == self.target && self.slope == 0
    }
}

/// A share in units of the rate.
fn units<R: Real>(share: R) -> u64 {
    if share >= R::one() { ONE } else { share.to_phase(0) >> 32 }
}

impl FeedOverride {
    /// The bounds ρ₁ and ρ₂. `None` if a number is not positive, if the plan leaves no reserve, or if a bound would be
    /// less than the unit, 2⁻³².
    #[must_use]
    pub fn new<R: Real>(limits: &OverrideLimits<R>) -> Option<Self> {
        let spare_acceleration = limits.acceleration - limits.planned_acceleration;
        let spare_jerk = limits.jerk - limits.planned_jerk;
        let planned = [limits.planned_acceleration, limits.planned_jerk, limits.planned_feed];
        let all_positive = planned.iter().chain([&spare_acceleration, &spare_jerk]).all(|x| *x > R::zero());
        if !all_positive {
            return None;
        }
        let slope = (spare_acceleration / limits.planned_feed)
            .min(spare_jerk / limits.planned_acceleration / R::from_ratio(6, 1));
        let by_slope = R::from_ratio(3, 1) * slope * limits.planned_acceleration;
        let bend = (spare_jerk - by_slope) / limits.planned_feed;
        let (slope, bend) = (units(slope), NonZeroU64::new(units(bend))?);
        let [acceleration, jerk] = [limits.acceleration, limits.jerk].map(|limit| limit.to_phase(-16));
        let jerk_per_acceleration = quotient(jerk, acceleration);
        (slope > 0).then_some(Self { slope, bend, acceleration, jerk, jerk_per_acceleration })
    }

    /// Keeps the limits of both: the rate changes as fast as both allow, and the landing takes the lesser J. The path's
    /// override is `self`, an axis' is `other`. Both are in the same unit of distance, and the landing step is the
    /// path's A T².
    #[must_use]
    pub fn and(self, other: Self) -> Self {
        let jerk = self.jerk.min(other.jerk);
        Self {
            slope: self.slope.min(other.slope),
            bend: self.bend.min(other.bend),
            jerk,
            jerk_per_acceleration: quotient(jerk, self.acceleration),
            ..self
        }
    }

    /// ρ₁, by which the rate changes in a period at most, in units of 2⁻³².
    #[must_use]
    pub fn slope(&self) -> u64 {
        self.slope
    }

    /// ρ₂, by which that change changes at most, in units of 2⁻³².
    #[must_use]
    pub fn bend(&self) -> u64 {
        self.bend.get()
    }

    /// J T³ in the unit of `landing_step`, which is A T². It is at most `landing_step` and at least the resolution.
    #[must_use]
    pub fn landing_jerk<R: Real>(&self, landing_step: R) -> R {
        (Rate(self.jerk_per_acceleration).share::<R>() * landing_step).max(R::resolution())
    }

    /// The distance of the next period, or `None` when the plan is over. At hold the distance is 0.
    ///
    /// It takes no heap. Its only loop is over the stages that the period touches.
    pub fn advance<R: Real>(
        &self,
        lengths: &StepLengths<'_, R>,
        cursor: &mut LengthCursor,
        state: &mut OverrideState,
    ) -> Option<R> {
        if lengths.is_over(cursor) {
            return None;
        }
        self.approach(state);
        if state.rate == 0 { Some(R::zero()) } else { lengths.advance_by(cursor, state.rate) }
    }

    /// One period toward the target.
    ///
    /// At the slope s, braking by ρ₂ each period adds `(s - ρ₂) + (s - 2ρ₂) + …` to the rate until s is 0. The new
    /// slope is the largest whose sum does not pass the target, and is at most ρ₂ above the last slope.
    pub(crate) fn approach(&self, state: &mut OverrideState) {
        let rises = state.target > state.rate || (state.target == state.rate && state.slope < 0);
        let distance = state.target.abs_diff(state.rate);
        let toward = if rises { state.slope } else { -state.slope };
        let bend = self.bend.get().cast_signed();
        let fastest = (toward + bend).min(self.slope.cast_signed());
        let slowest = toward - bend;
        let slope = largest_that_stops(distance, self.bend).min(fastest).max(slowest);
        state.slope = if rises { slope } else { -slope };
        state.rate = state.rate.saturating_add_signed(state.slope).min(ONE);
    }
}

/// J over A in units of 2⁻³², at most 1.
pub(crate) fn quotient(jerk: u64, acceleration: u64) -> u64 {
    let quotient = (u128::from(jerk) << 32).checked_div(u128::from(acceleration));
    quotient.and_then(|quotient| u64::try_from(quotient).ok()).map_or(ONE, |quotient| quotient.min(ONE))
}

/// The largest s with `s + (s - ρ) + (s - 2ρ) + … ≤ distance`, the terms positive.
///
/// For s from kρ on the sum has k + 1 terms, `(k + 1) s - ρ k (k + 1)/2`. At s = kρ it is `ρ k (k + 1)/2`, which bounds
/// k.
fn largest_that_stops(distance: u64, bend: NonZeroU64) -> i64 {
    let terms = NonZeroU64::MIN.saturating_add(((8 * (distance / bend) + 1).isqrt() - 1) / 2);
    let shortfall = bend.get() * ((terms.get() - 1) * terms.get() / 2);
    ((distance + shortfall) / terms).cast_signed()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::LengthStage;
    use feed_plan::{EndFeeds, FeedLimit, KinematicLimits, LimitPoint, ProfileKind, plan_with};
    use proptest::prelude::*;
    use real::{Backend, I4F28};

    const A: f64 = 0.045;
    const J: f64 = 0.0108;

    /// A plan within `share` of A and J, and what an override may do with it.
    fn planned(share: f64, kind: ProfileKind) -> (Vec<LengthStage<f64>>, FeedOverride, f64) {
        let limits = KinematicLimits {
            interpolation_period: 1.0,
            feedrate: 0.6,
            acceleration: share * A,
            jerk: share * J,
            chord_error: 5e-4,
            centripetal_acceleration: None,
            axes: Default::default(),
            junction: Default::default(),
        };
        let point = |distance, feedrate| LimitPoint { distance, curve: 0, u: distance, feedrate };
        let points =
            [(0.0, 0.6), (20.0, 0.6), (22.0, 0.2), (24.0, 0.5), (26.0, 0.0), (40.0, 0.6), (60.0, 0.6)];
        let limit = FeedLimit::from_points(&points.map(|(s, v)| point(s, v))).unwrap();
        let plan = plan_with(&limit, &limits, EndFeeds::default(), kind).unwrap();
        let stages = plan.stages().iter().filter_map(|stage| {
            let duration = stage.duration.to_phase(-32);
            Some(
                LengthStage::new(duration, stage.start_feed, stage.end_feed - stage.start_feed)?
                    .shaped(stage.shape),
            )
        });
        let most = |of: fn(&feed_plan::FeedPiece<f64>) -> f64| {
            plan.stages().iter().map(|stage| of(&stage.piece())).fold(0.0, f64::max)
        };
        let feeds = FeedOverride::new(&OverrideLimits {
            acceleration: A,
            jerk: J,
            planned_acceleration: most(feed_plan::FeedPiece::peak_acceleration),
            planned_jerk: most(feed_plan::FeedPiece::peak_jerk),
            planned_feed: most(|piece| piece.start_feed.max(piece.end_feed)),
        });
        (stages.collect(), feeds.unwrap(), limit.length())
    }

    /// Runs with a target for some periods each, and then at the plan's own speed, to the end.
    fn run(stages: &[LengthStage<f64>], feeds: &FeedOverride, targets: &[(u32, f64)]) -> Vec<f64> {
        let lengths = StepLengths { stages, crossings: &[] };
        let (mut cursor, mut state) = (LengthCursor::default(), OverrideState::at(Rate::FULL));
        let mut steps = vec![0.0];
        let mut targets = targets.iter();
        let mut left = 0;
        for _ in 0..200_000 {
            if left == 0 {
                let (periods, target) = targets.next().copied().unwrap_or((u32::MAX, 1.0));
                left = periods;
                state.set(Rate::of(target));
            }
            left -= 1;
            let Some(step) = feeds.advance(&lengths, &mut cursor, &mut state) else { return steps };
            steps.push(step);
        }
        panic!("the plan does not end");
    }

    fn assert_kept(steps: &[f64]) {
        let acceleration = steps.windows(2).map(|w| (w[1] - w[0]).abs()).fold(0.0, f64::max);
        let jerk = steps.windows(3).map(|w| (w[2] - 2.0 * w[1] + w[0]).abs()).fold(0.0, f64::max);
        assert!(
            acceleration <= A * (1.0 + 1e-9) && jerk <= J * (1.0 + 1e-9),
            "{} {}",
            acceleration / A,
            jerk / J
        );
    }

    /// The sum, term by term.
    fn sum(slope: u64, bend: u64) -> u64 {
        (0..).map_while(|k| slope.checked_sub(k * bend)).sum()
    }

    #[test]
    fn the_largest_slope_that_stops_is_found_for_all_small_distances() {
        for bend in 1..=40 {
            let mut largest = 0;
            for distance in 0..400 {
                while sum(largest + 1, bend) <= distance {
                    largest += 1;
                }
                let found = largest_that_stops(distance, NonZeroU64::new(bend).unwrap());
                assert_eq!(found, largest.cast_signed(), "{distance} {bend}");
            }
        }
    }

    proptest! {
        /// On any distance, up to that from hold to the programmed feed.
        #[test]
        fn the_largest_slope_stops_and_the_next_does_not(distance in 0..=ONE, bits in 0..33_u32, part in 0..=u32::MAX) {
            let power = 1_u64 << bits;
            let bend = (power + (u64::from(part) & (power - 1))).max(distance >> 20);
            let found = largest_that_stops(distance, NonZeroU64::new(bend).unwrap()).cast_unsigned();
            prop_assert!(sum(found, bend) <= distance && distance < sum(found + 1, bend), "{found}");
        }

        #[test]
        fn a_slope_of_the_least_bend_stops_too(distance in 0..=ONE) {
            let found = largest_that_stops(distance, NonZeroU64::MIN).cast_unsigned();
            prop_assert!(found * (found + 1) / 2 <= distance && distance < (found + 1) * (found + 2) / 2);
        }
    }

    proptest! {
        #![proptest_config(ProptestConfig::with_cases(300))]

        #[test]
        fn whatever_is_asked_for_acceleration_and_jerk_are_kept(
            targets in prop::collection::vec((1_u32..120, prop_oneof![Just(0.0), Just(1.0), 0.0..1.0_f64]), 0..20),
            share in 0.3..0.9_f64, kind in prop_oneof![Just(ProfileKind::Cubic), Just(ProfileKind::SCurve), Just(ProfileKind::Trigonometric)],
        ) {
            let (stages, feeds, length) = planned(share, kind);
            let steps = run(&stages, &feeds, &targets);
            // The last step is what is left of the plan, and the plan ends at rest. Stages are rounded to 2⁻³² periods.
            assert_kept(&steps[..steps.len() - 1]);
            prop_assert!(steps.iter().all(|step| *step >= 0.0));
            prop_assert!((steps.iter().sum::<f64>() - length).abs() < 1e-7);
        }

        #[test]
        fn the_rate_changes_no_faster_than_allowed_and_settles(
            slope in 1_u64..1 << 31, bend in 1_u64..1 << 30, targets in prop::collection::vec((1_u32..200, 0.0..=1.0_f64), 1..10),
        ) {
            let bend_of = NonZeroU64::new(bend).unwrap();
            let feeds = FeedOverride { slope, bend: bend_of, acceleration: 1, jerk: 1, jerk_per_acceleration: ONE };
            let mut state = OverrideState::at(Rate::FULL);
            let mut rates = vec![ONE.cast_signed(); 2];
            for (periods, target) in targets {
                state.set(Rate::of(target));
                for _ in 0..periods {
                    feeds.approach(&mut state);
                    rates.push(state.rate.cast_signed());
                }
            }
            for w in rates.windows(3) {
                prop_assert!((w[2] - w[1]).unsigned_abs() <= slope);
                prop_assert!((w[2] - 2 * w[1] + w[0]).unsigned_abs() <= bend);
            }
        }
    }

    #[test]
    fn hold_stops_and_release_goes_on() {
        let (stages, feeds, length) = planned(0.7, ProfileKind::SCurve);
        let steps = run(&stages, &feeds, &[(40, 1.0), (200, 0.0), (100, 0.5)]);
        let still = steps[40..240].iter().filter(|step| **step == 0.0).count();
        assert!(still > 100, "{still} periods at rest");
        assert!((steps.iter().sum::<f64>() - length).abs() < 1e-7);
        assert_kept(&steps[..steps.len() - 1]);
        // Without an override the plan itself.
        let (plain, own) = (run(&stages, &feeds, &[]), StepLengths { stages: &stages, crossings: &[] });
        let mut cursor = LengthCursor::default();
        assert!(plain[1..].iter().all(|step| own.advance(&mut cursor) == Some(*step)));
        assert_eq!(own.advance(&mut cursor), None);
    }

    #[test]
    fn a_rate_of_two_hundred_per_cent_is_a_plan_for_twice_the_feed_at_half_rate() {
        let (stages, feeds, length) = planned(0.7, ProfileKind::SCurve);
        let lengths = StepLengths { stages: &stages, crossings: &[] };
        let (mut cursor, mut state) = (LengthCursor::default(), OverrideState::at(Rate::of(0.5)));
        let mut steps = vec![0.0];
        while let Some(step) = feeds.advance(&lengths, &mut cursor, &mut state) {
            if steps.len() == 60 {
                state.set(Rate::FULL); // 200 %
            }
            steps.push(step);
        }
        let (slow, fast) = (steps[50], steps.iter().fold(0.0_f64, |most, step| most.max(*step)));
        assert!(slow < 0.31 && fast > 0.59, "{slow} {fast}");
        assert_kept(&steps[..steps.len() - 1]);
        assert!((steps.iter().sum::<f64>() - length).abs() < 1e-7);
    }

    #[test]
    fn shares_beyond_the_ends_are_the_ends() {
        assert_eq!(
            [2.0, 1.0, -1.0, f64::NAN].map(Rate::of),
            [Rate::FULL, Rate::FULL, Rate::HOLD, Rate::HOLD]
        );
        assert_eq!((Rate::of(0.5).share::<f64>(), Rate::FULL.share::<f64>()), (0.5, 1.0));
        // A resolution of 2⁻¹⁶ does not hold 0.3, but the rate is the same when it comes from elsewhere.
        assert_eq!(Rate::of(0.3).share::<real::I16F16>().to_f64(), (0.3 * 65536.0_f64).floor() / 65536.0);
    }

    #[test]
    fn a_plan_that_leaves_nothing_cannot_be_overridden() {
        let limits = OverrideLimits {
            acceleration: A,
            jerk: J,
            planned_acceleration: A,
            planned_jerk: 0.5 * J,
            planned_feed: 0.6,
        };
        assert_eq!(FeedOverride::new(&limits), None);
        assert_eq!(FeedOverride::new(&OverrideLimits { planned_acceleration: f64::NAN, ..limits }), None);
        assert!(FeedOverride::new(&OverrideLimits { planned_acceleration: 0.9 * A, ..limits }).is_some());
    }

    #[test]
    fn narrow_formats_take_the_same_time() {
        let (stages, feeds, length) = planned(0.7, ProfileKind::Trigonometric);
        let steps = run(&stages, &feeds, &[(40, 0.3), (60, 0.0)]);
        let of = |x: f64| I4F28::from_f64(x).unwrap();
        let coarse: Vec<_> = stages
            .iter()
            .filter_map(|s| {
                Some(LengthStage::new(s.duration, of(s.feed), of(s.change))?.shaped(s.shape.map(of)))
            })
            .collect();
        let lengths = StepLengths { stages: &coarse, crossings: &[] };
        let (mut cursor, mut state) = (LengthCursor::default(), OverrideState::at(Rate::FULL));
        let mut travelled = 0.0;
        for period in 0..steps.len() - 1 {
            match period {
                0 => state.set(Rate::of(0.3)),
                40 => state.set(Rate::HOLD),
                100 => state.set(Rate::FULL),
                _ => {}
            }
            travelled += feeds.advance(&lengths, &mut cursor, &mut state).unwrap().to_f64();
        }
        assert!(lengths.is_over(&cursor));
        assert!((travelled - length).abs() < 1e-5, "{travelled}");
    }
}
