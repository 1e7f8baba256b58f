//! The distance of each period, from a compiled schedule.
//!
//! A schedule is a list of stages. In each the feed goes from v to v + Δv as `v + Δv g(x)`, x = t/t₂, and g is one of a
//! few shapes. A period needs the distance travelled in it, not the feed at an instant: `L = τ (v + Δv ḡ)`, ḡ being the
//! mean of g over the interval of length τ. [`StageShape::mean`] computes ḡ without a difference of two large
//! distances, and with no intermediate larger than 2. For a cubic speed ḡ is `x² + 2x²(1 - x) + ¼ (1 - 2x) (τ/t₂)²`, x
//! at the interval's middle. A period that straddles joints of stages adds up its parts.
//!
//! Time is counted in integers of 2⁻³² periods. So every format takes the same stages at the same times, and a run of
//! any length loses nothing. Sums of times and exponents wrap: a stage with invalid numbers gives a meaningless
//! distance, but no panic, in any build.

#[cfg(feature = "alloc")]
use alloc::vec::Vec;
use core::ops::Range;

use feed_plan::StageShape;
use real::{Real, product_of_words};

/// One period, in units of time.
pub(crate) const PERIOD: u64 = 1 << 32;

/// A stage with time in periods and distance in the unit of the chords.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LengthStage<R> {
    /// t₂ in 2⁻³² periods; not 0, and below 2⁶², a thousand million periods.
    pub duration: u64,
    /// `2^(64 + reciprocal_exponent) / duration`, rounded down: it turns times into fractions of the stage.
    pub reciprocal: u64,
    /// See `reciprocal`; chosen so that `reciprocal` has its top bit set.
    pub reciprocal_exponent: u32,
    /// One period over t₂: the width of all intervals except those that end in the middle of a period.
    pub period_share: R,
    /// v: the feed at the start, in chord units per period.
    pub feed: R,
    /// Δv.
    pub change: R,
    /// g. A stage may begin and end with an acceleration: with [`StageShape::Bent`] by b it goes at constant jerk from `1 + b` to
    /// `1 - b` times the mean acceleration Δv/t₂, b from -1 to 1. Constant jerk through an acceleration of 0 takes two stages.
    pub shape: StageShape<R>,
}

/// The longest stage of a compiled path, in 2⁻³² periods: 2²⁹ periods.
pub(crate) const LONGEST_STAGE: u64 = 1 << 61;

impl<R: Real> LengthStage<R> {
    /// The durations of the stages that one of this duration becomes in a compiled path: of constant feed, one of more
    /// than 2²⁹ periods becomes several.
    pub fn parts(duration: u64, is_constant: bool) -> impl Iterator<Item = u64> {
        let whole = if is_constant { duration.saturating_sub(1) / LONGEST_STAGE } else { 0 };
        (0..whole).map(|_| LONGEST_STAGE).chain([duration - whole * LONGEST_STAGE])
    }

    /// A stage of this duration whose feed is a cubic; `None` if the duration is zero, or 2⁶² or more.
    #[must_use]
    pub fn new(duration: u64, feed: R, change: R) -> Option<Self> {
        let numerator = 1_u128 << 127;
        let exponent = 63_u32.checked_sub(duration.leading_zeros()).filter(|e| *e < 62)?;
        // 2^exponent <= duration < 2^(exponent+1): the quotient of 2^(64+exponent) lies in (2^63, 2^64].
        let quotient = (numerator >> (63 - exponent)) / u128::from(duration);
        let reciprocal = u64::try_from(quotient).unwrap_or(u64::MAX);
        let stage = Self {
            duration,
            reciprocal,
            reciprocal_exponent: exponent,
            period_share: R::zero(),
            feed,
            change,
            shape: StageShape::Cubic,
        };
        Some(Self { period_share: R::from_phase(stage.fraction(2 * PERIOD.min(duration)), 0), ..stage })
    }

    /// This stage with its feed along another shape.
    #[must_use]
    pub fn shaped(self, shape: StageShape<R>) -> Self {
        Self { shape, ..self }
    }

    /// `half_units / (2 · duration)` as a phase, for `half_units ≤ 2 · duration`. The time is doubled, so that the
    /// middle of an odd interval is a whole number too.
    #[inline]
    #[allow(
        clippy::cast_possible_truncation,
        reason = "the quotient is below 2⁶⁴, for the reciprocal is rounded down"
    )]
    fn fraction(&self, half_units: u64) -> u64 {
        (self.product(half_units) >> self.shift()) as u64
    }

    /// time · 2^64 / duration = time · reciprocal / 2^exponent: this is the product, in two words.
    #[inline]
    pub(crate) fn product(&self, half_units: u64) -> u128 {
        product_of_words(half_units, self.reciprocal)
    }

    /// The shift that turns the product into a phase. The compiler knows that it is below 64, which saves half of the
    /// work.
    #[inline]
    pub(crate) fn shift(&self) -> u32 {
        self.reciprocal_exponent.wrapping_add(1) & 63
    }

    /// An interval over t₂; for a longer interval, 1 up to the last place.
    #[inline]
    fn share(&self, interval: u64) -> R {
        if interval == PERIOD { self.period_share } else { R::from_phase(self.fraction(2 * interval), 0) }
    }

    /// The mean feed over an interval of this share: the distance travelled over the interval's length. `middle` is the
    /// middle of the interval, in half units.
    #[inline(always)]
    fn mean_feed(&self, middle: u64, share: R) -> R {
        if self.change.is_zero() {
            return self.feed;
        }
        let x = R::fraction_of(self.product(middle), self.shift());
        self.change.mul_add(self.shape.mean(x, share), self.feed)
    }
}

/// The place of a run in its stages.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct LengthCursor {
    pub(crate) stage: usize,
    pub(crate) time: u64,
}

impl LengthCursor {
    /// The number of the stage in which the next period begins; the number of all stages once the schedule is over.
    #[must_use]
    pub fn stage(&self) -> usize {
        self.stage
    }
}

/// The period in which a stage ends, of a run at the plan's own speed. Such a run comes to the end of each stage at a time that is
/// known when the plan is compiled, and so is what the period takes of this stage and of all that it ends in or passes.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Crossing<R> {
    /// What is left of the stage where the period begins, less one unit of 2⁻³² periods.
    pub rest: u32,
    /// The time of the stage behind the period, in 2⁻³² periods.
    pub time: u32,
    /// By how many stages that lies further; 0 if no period at the plan's own speed begins in this stage.
    pub stages: u32,
    /// The distance of the period, in chord units.
    pub distance: R,
}

/// A compiled schedule.
#[derive(Clone, Copy, Debug)]
pub struct StepLengths<'a, R> {
    /// The stages, in order.
    pub stages: &'a [LengthStage<R>],
    /// For each stage the period in which it ends, or none at all: without them a run has the same distances, and takes several
    /// times as long for such a period.
    pub crossings: &'a [Crossing<R>],
}

impl<R: Real> StepLengths<'_, R> {
    /// The distance of the next period, or `None` when the schedule is over. A schedule whose duration is not a whole
    /// number of periods ends with a shorter step. The loop takes at most one turn for each stage. If the cursor stands
    /// behind its stage's end, as a cursor of another schedule may, it goes on with the next stage.
    #[inline(always)] // Into the step, as that is into its caller: see there.
    pub fn advance(&self, cursor: &mut LengthCursor) -> Option<R> {
        self.advance_or_end(cursor).map(|(length, _)| length)
    }

    /// [`advance`](Self::advance), and whether the schedule ends in the period. Most periods need not ask.
    #[inline(always)] // As `advance` is.
    pub(crate) fn advance_or_end(&self, cursor: &mut LengthCursor) -> Option<(R, bool)> {
        let stage = self.stages.get(cursor.stage)?;
        let end = cursor.time.wrapping_add(PERIOD);
        if end < stage.duration {
            // Wholly inside one stage, as most periods are.
            let middle = cursor.time.wrapping_add(end);
            cursor.time = end;
            return Some((stage.mean_feed(middle, stage.period_share), false));
        }
        self.cross(cursor, stage).map(|length| (length, self.is_over(cursor)))
    }

    /// The distance of the period in which a stage ends.
    #[inline(never)] // Within the above it would make every period save its registers.
    fn cross(&self, cursor: &mut LengthCursor, stage: &LengthStage<R>) -> Option<R> {
        let rest = stage.duration.wrapping_sub(cursor.time);
        match self.crossings.get(cursor.stage) {
            Some(crossing) if crossing.stages > 0 && rest == u64::from(crossing.rest) + 1 => {
                cursor.stage = cursor.stage.wrapping_add(crossing.stages as usize);
                cursor.time = u64::from(crossing.time);
                Some(crossing.distance)
            }
            _ => self.advance_by(cursor, PERIOD),
        }
    }

    /// The distance over `units` of 2⁻³² periods of the schedule's time, at most one period: the distance of a period at a
    /// lower feed. `None` if no time passes, because `units` is 0 or the schedule is over.
    #[inline(never)] // As `cross` is.
    pub fn advance_by(&self, cursor: &mut LengthCursor, units: u64) -> Option<R> {
        let units = units.min(PERIOD);
        let mut left = units;
        let mut length = R::zero();
        while let Some(stage) = self.stages.get(cursor.stage) {
            let interval = left.min(stage.duration.saturating_sub(cursor.time));
            let middle = cursor.time.wrapping_mul(2).wrapping_add(interval);
            let mean = stage.mean_feed(middle, stage.share(interval));
            length =
                if interval == PERIOD { mean } else { mean.mul_add(R::from_phase(interval, 32), length) };
            left -= interval;
            cursor.time += interval;
            if cursor.time < stage.duration {
                break;
            }
            *cursor = LengthCursor { stage: cursor.stage + 1, time: 0 };
            if left == 0 {
                break;
            }
        }
        (left < units).then_some(length)
    }

    /// The stages `range` alone, as a schedule of their own.
    #[must_use]
    pub fn part(&self, range: &Range<usize>) -> Self {
        Self {
            stages: self.stages.get(range.clone()).unwrap_or_default(),
            crossings: self.crossings.get(range.clone()).unwrap_or_default(),
        }
    }

    /// Number of periods that the schedule takes, including a last one that may be shorter.
    #[must_use]
    pub fn periods(&self) -> usize {
        let units: u128 = self.stages.iter().map(|stage| u128::from(stage.duration)).sum();
        usize::try_from(units.div_ceil(u128::from(PERIOD))).unwrap_or(usize::MAX)
    }

    /// Whether the schedule is over.
    #[must_use]
    pub fn is_over(&self, cursor: &LengthCursor) -> bool {
        cursor.stage >= self.stages.len()
    }
}

/// The crossings of a schedule from rest to rest, one for each of its stages. The period in which it ends has none: where another
/// schedule follows, that may begin within this period.
#[cfg(feature = "alloc")]
#[must_use]
pub fn crossings<R: Real>(stages: &[LengthStage<R>]) -> Vec<Crossing<R>> {
    let lengths = StepLengths { stages, crossings: &[] };
    let mut found: Vec<_> =
        stages.iter().map(|_| Crossing { rest: 0, time: 0, stages: 0, distance: R::zero() }).collect();
    let mut cursor = LengthCursor::default();
    while let Some(stage) = stages.get(cursor.stage) {
        let begin = cursor.stage;
        // Whole periods within the stage go by.
        let left = stage.duration.saturating_sub(cursor.time);
        cursor.time += left.saturating_sub(1) / PERIOD * PERIOD;
        let rest = stage.duration.saturating_sub(cursor.time).saturating_sub(1);
        let Some(distance) = lengths.advance_by(&mut cursor, PERIOD).filter(|_| !lengths.is_over(&cursor))
        else {
            break;
        };
        let passed = u32::try_from(cursor.stage - begin);
        if let (Some(slot), Ok(rest), Ok(time), Ok(stages)) =
            (found.get_mut(begin), u32::try_from(rest), u32::try_from(cursor.time), passed)
        {
            *slot = Crossing { rest, time, stages, distance };
        }
    }
    found
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;
    use real::{Backend, I4F28};
    use std::f64::consts::PI;

    const SHAPES: [StageShape<f64>; 7] = [
        StageShape::Cubic,
        StageShape::Onset,
        StageShape::Steady,
        StageShape::Easing,
        StageShape::Cosine,
        StageShape::Bent(-0.75),
        StageShape::Bent(0.125),
    ];

    /// Distance travelled up to t in a stage: v t + Δv t₂ G(x), G the integral of the shape.
    fn distance(shape: StageShape<f64>, feed: f64, change: f64, duration: f64, t: f64) -> f64 {
        let x = t / duration;
        let integral = match shape {
            StageShape::Cubic => x.powi(3) - x.powi(4) / 2.0,
            StageShape::Onset => x.powi(3) / 3.0,
            StageShape::Steady => x * x / 2.0,
            StageShape::Easing => x * x - x.powi(3) / 3.0,
            StageShape::Bent(by) => x * x / 2.0 + by * (x * x / 2.0 - x.powi(3) / 3.0),
            StageShape::Cosine => x / 2.0 - (PI * x).sin() / (2.0 * PI),
        };
        feed * t + change * duration * integral
    }

    #[allow(
        clippy::cast_possible_truncation,
        clippy::cast_sign_loss,
        reason = "a few periods, none negative"
    )]
    fn in_units(periods: f64) -> u64 {
        (periods * PERIOD as f64).round() as u64
    }

    /// A move that takes days is one stage of a plan, and more than a stage can count.
    #[test]
    fn a_long_stage_of_constant_feed_is_divided() {
        let parts =
            |duration, is_constant| LengthStage::<f64>::parts(duration, is_constant).collect::<Vec<_>>();
        assert_eq!([parts(0, true), parts(LONGEST_STAGE, true)], [vec![0], vec![LONGEST_STAGE]]);
        assert_eq!(parts(u64::MAX, true).len(), 8);
        for duration in [1, LONGEST_STAGE + 1, 5 * LONGEST_STAGE, u64::MAX] {
            assert_eq!(parts(duration, true).iter().sum::<u64>(), duration);
            assert!(parts(duration, true).iter().all(|part| LengthStage::new(*part, 0.5, 0.0).is_some()));
            assert_eq!(parts(duration, false), [duration]);
        }
    }

    /// Constant jerk from any feed and acceleration to any acceleration: `v + a t + ½ j t²`, cut where the acceleration is 0.
    fn constant_jerk(feed: f64, from: f64, to: f64, periods: f64) -> Vec<(f64, f64, f64, StageShape<f64>)> {
        let at = |t: f64| feed + t * from + t * t * (to - from) / (2.0 * periods);
        let turn = if from * to < 0.0 { periods * from / (from - to) } else { periods };
        let parts = [(0.0, turn, from, if turn < periods { 0.0 } else { to }), (turn, periods, 0.0, to)];
        let parts = parts.into_iter().filter(|(begin, end, ..)| begin < end);
        parts
            .map(|(begin, end, a, b)| {
                let bent =
                    if a + b == 0.0 { StageShape::Steady } else { StageShape::Bent((a - b) / (a + b)) };
                (end - begin, at(begin), at(end) - at(begin), bent)
            })
            .collect()
    }

    #[test]
    fn a_cursor_of_another_schedule_goes_on_with_the_next_stage() {
        let stages =
            [(10, 0.5), (4, 0.25)].map(|(periods, feed)| LengthStage::new(periods << 32, feed, 0.0).unwrap());
        let schedule = StepLengths { stages: &stages, crossings: &[] };
        let mut cursor = LengthCursor { stage: 0, time: 50 * PERIOD };
        assert_eq!(schedule.advance(&mut cursor), Some(0.25));
        assert_eq!(cursor, LengthCursor { stage: 1, time: PERIOD });
    }

    /// Every second period is made in two halves: no period then begins where the plan's own do, or each where it would.
    #[test]
    fn a_run_beside_the_plans_periods_takes_no_crossing() {
        let stages: Vec<_> = [(2.5, 0.25, 0.5), (0.25, 0.75, -0.25), (3.0, 0.5, 0.125)]
            .map(|(periods, feed, change)| LengthStage::new(in_units(periods), feed, change).unwrap())
            .to_vec();
        let crossed = crossings(&stages);
        let plain = StepLengths { stages: &stages, crossings: &[] };
        let known = StepLengths { stages: &stages, crossings: &crossed };
        assert_eq!(crossed.iter().map(|c| c.stages).collect::<Vec<_>>(), [2, 0, 0]);
        for late in [0, 1, PERIOD / 3, PERIOD / 2, PERIOD - 1] {
            let (mut first, mut second) = (LengthCursor::default(), LengthCursor::default());
            assert_eq!(plain.advance_by(&mut first, late), known.advance_by(&mut second, late));
            while let Some(length) = plain.advance(&mut first) {
                assert_eq!((known.advance(&mut second), second), (Some(length), first), "{late}");
            }
            assert_eq!(known.advance(&mut second), None);
        }
    }

    proptest! {
        /// A stage holds what a plan at constant jerk has, whatever its acceleration at both ends: two at most.
        #[test]
        fn a_stage_begins_and_ends_with_any_acceleration(
            feed in 1.0_f64..2.0, from in -0.02_f64..0.02, to in -0.02_f64..0.02, periods in 20.0_f64..40.0,
        ) {
            let cut = constant_jerk(feed, from, to, periods);
            prop_assert!(cut.len() <= 2);
            let stages: Vec<_> = cut.iter().map(|(time, v, by, shape)| {
                LengthStage::new(in_units(*time), *v, *by).unwrap().shaped(*shape)
            }).collect();
            let fixed: Vec<_> = cut.iter().map(|(time, v, by, shape)| {
                let of = |x: f64| I4F28::from_f64(x).unwrap();
                LengthStage::new(in_units(*time), of(*v), of(*by)).unwrap().shaped(shape.map(of))
            }).collect();
            let travelled = |t: f64| t * (feed + t * (from / 2.0 + t * (to - from) / (6.0 * periods)));
            let (mut cursor, mut coarse) = (LengthCursor::default(), LengthCursor::default());
            for period in 0..20_u8 {
                let expected = travelled(f64::from(period) + 1.0) - travelled(f64::from(period));
                let length = (StepLengths { stages: &stages, crossings: &[] }).advance(&mut cursor).unwrap();
                prop_assert!((length - expected).abs() < 1e-8, "{length} for {expected}");
                let rounded = (StepLengths { stages: &fixed, crossings: &[] }).advance(&mut coarse).unwrap();
                prop_assert!((rounded.to_f64() - expected).abs() < 1e-7, "{rounded:?} for {expected}");
            }
        }

        /// Period by period, over stages that start and end inside periods.
        #[test]
        fn lengths_are_the_integrals_of_the_feed(
            durations in proptest::collection::vec(0.05_f64..9.0, 1..6),
            feeds in proptest::collection::vec(0.0_f64..1.0, 7),
            shape in (0..7_usize).prop_map(|i| SHAPES[i]),
        ) {
            let durations: Vec<u64> = durations.into_iter().map(in_units).collect();
            let periods = |units: u64| units as f64 / PERIOD as f64;
            let stages: Vec<_> = durations.iter().zip(feeds.windows(2))
                .filter_map(|(&d, v)| LengthStage::new(d, v[0], v[1] - v[0])).map(|stage| stage.shaped(shape)).collect();
            let fixed: Vec<_> = durations.iter().zip(feeds.windows(2)).filter_map(|(&d, v)| {
                let of = |x: f64| I4F28::from_f64(x).unwrap();
                let shape = shape.map(of);
                LengthStage::new(d, of(v[0]), of(v[1]) - of(v[0])).map(|stage| stage.shaped(shape))
            }).collect();
            let up_to = |time: u64| {
                let mut rest = time;
                durations.iter().zip(feeds.windows(2)).map(|(&d, v)| {
                    let part = rest.min(d);
                    rest -= part;
                    distance(shape, v[0], v[1] - v[0], periods(d), periods(part))
                }).sum::<f64>()
            };
            let total: u64 = durations.iter().sum();
            let (mut cursor, mut coarse) = (LengthCursor::default(), LengthCursor::default());
            let (mut known, mut coarse_known) = (cursor, coarse);
            let (crossed, fixed_crossed) = (crossings(&stages), crossings(&fixed));
            let schedule = StepLengths { stages: &stages, crossings: &crossed };
            let fixed_schedule = StepLengths { stages: &fixed, crossings: &fixed_crossed };
            let mut time = 0;
            while let Some(length) = (StepLengths { stages: &stages, crossings: &[] }).advance(&mut cursor) {
                prop_assert_eq!(schedule.advance(&mut known), Some(length));
                prop_assert_eq!(known, cursor);
                let next = (time + PERIOD).min(total);
                let expected = up_to(next) - up_to(time);
                prop_assert!((length - expected).abs() < 1e-12, "{length} for {expected}");
                let rounded = (StepLengths { stages: &fixed, crossings: &[] }).advance(&mut coarse).unwrap();
                prop_assert_eq!(fixed_schedule.advance(&mut coarse_known), Some(rounded));
                let rounded = rounded.to_f64();
                // Eight roundings of half a unit, and the phases' one unit, at most twice a joint.
                prop_assert!((rounded - expected).abs() < 48.0 * I4F28::resolution().to_f64(), "{rounded} {expected}");
                time = next;
            }
            prop_assert_eq!(time, total);
            prop_assert!(schedule.is_over(&cursor), "stage {} of {}", cursor.stage, stages.len());
        }
    }
}
