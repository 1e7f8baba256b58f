//! The landing of an overridden run: it travels the rest of the path behind the schedule's end, from standstill to
//! standstill.
//!
//! Chords are shorter than arcs, and a plan counts on the length that its own chords gain. At the rate r a chord gains
//! only r² of that, so an overridden run comes to rest before the end of the path, short by the part `1 - r²` of the
//! gain. The remaining length δ is travelled with the jerks c, -c, -c, c, for m periods each:
//!
//! ```text
//! L_k = c g_k     g = 1, 3, 6, … m², m², … 6, 3, 1     Σ g_k = 2m³     c = δ/(2m³)
//! ```
//!
//! with the smallest m at which c is at most J T³ and the longest step c m² = δ/(2m) is at most A T². Each period takes
//! its share of the length that remains at that time, so that roundings do not add up and the last period takes all
//! that remains.

use real::Real;

/// Periods without a step before and after the landing: the jerk of the run before it and the jerk of the landing then
/// do not add up.
const PAUSE: i32 = 2;

/// The longest quarter of a landing is 2 to this power: the landing is then a thousand landing steps long. 2m³ fits 32
/// bits.
const QUARTER_BITS: i32 = 9;

/// The state of a landing.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(crate) struct Landing {
    /// Periods since the end of the schedule, and the periods of a quarter, m.
    period: i32,
    quarter: i32,
    /// Σ g_k over the periods to come.
    weight: i32,
    /// Periods without motion that still follow the landing.
    pause_left: i32,
}

/// One period of a landing.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum LandingStep<R> {
    /// This part of the remaining length.
    Part(R),
    /// All that is left.
    Last,
    /// The landing is over.
    Over,
}

impl Landing {
    /// The part of the remaining length for the next period. No step is longer than `longest`, A T², and the second
    /// difference of steps is at most `jerk`, J T³.
    pub(crate) fn advance<R: Real>(&mut self, remaining: R, longest: R, jerk: R) -> LandingStep<R> {
        self.period = self.period.saturating_add(1);
        let k = self.period.saturating_sub(PAUSE);
        if k <= 0 {
            return LandingStep::Part(R::zero());
        }
        if k == 1 {
            self.quarter = quarter(remaining, longest, jerk);
            self.weight = 2 * self.quarter.pow(3);
        }
        let share = weight(self.quarter, k);
        if share == 0 || self.weight <= share {
            let is_last = share > 0;
            self.weight = 0;
            self.pause_left = PAUSE;
            return if is_last { LandingStep::Last } else { LandingStep::Over };
        }
        let part = (remaining * R::from_ratio(share, self.weight)).min(longest);
        self.weight -= share;
        LandingStep::Part(part)
    }

    /// Whether the next period, at the end of the path, is a period without motion.
    pub(crate) fn pauses(&mut self) -> bool {
        let is_owed = self.pause_left > 0;
        self.pause_left -= i32::from(is_owed);
        is_owed
    }
}

/// g_k for k from 1 to 4m - 2, 0 beyond. It is symmetric.
fn weight(quarter: i32, k: i32) -> i32 {
    let k = k.min(quarter.saturating_mul(4).saturating_sub(k.saturating_add(1)));
    if k <= 0 {
        0
    } else if k <= quarter {
        k * (k + 1) / 2
    } else {
        let beyond = 2 * quarter - k;
        quarter * quarter - beyond * (beyond - 1) / 2
    }
}

/// The smallest m, at most 2⁹, with `δ/(2m³) ≤ J T³` and `δ/(2m) ≤ A T²`.
fn quarter<R: Real>(remaining: R, longest: R, jerk: R) -> i32 {
    let is_short = |m: i32| {
        remaining * R::from_ratio(1, 2 * m.pow(3)) > jerk || remaining * R::from_ratio(1, 2 * m) > longest
    };
    let grown = |m: i32, bit: i32| if is_short(m + (1 << bit)) { m + (1 << bit) } else { m };
    (0..QUARTER_BITS).rev().fold(0, grown) + 1
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;
    use real::{Backend, I4F28, I4F60, I8F24, I16F48};

    #[test]
    fn the_weights_are_those_of_a_jerk_of_one() {
        for m in 1..=1 << QUARTER_BITS {
            let all: Vec<_> = (-1..=4 * m + 1).map(|k| weight(m, k)).collect();
            assert_eq!(all.iter().sum::<i32>(), 2 * m.pow(3), "{m}");
            assert_eq!(all.iter().max(), Some(&(m * m)), "{m}");
            let jerk = all.windows(3).map(|w| (w[2] - 2 * w[1] + w[0]).abs()).max();
            assert_eq!(jerk, Some(1), "{m}: {all:?}");
        }
    }

    /// A landing in `R` keeps A and J to a few units, ends on the rest, and takes the periods that it must.
    fn lands<R: Backend>(remaining: f64, longest: f64, jerk: f64) {
        let number = |x: f64| R::from_f64(x).unwrap();
        let (mut landing, mut left, mut steps) = (Landing::default(), number(remaining), vec![0.0; 2]);
        loop {
            let part = match landing.advance(left, number(longest), number(jerk)) {
                LandingStep::Part(part) => part,
                LandingStep::Last => left,
                LandingStep::Over => break,
            };
            assert!(part >= R::zero() && part <= left, "{} of {}", part.to_f64(), left.to_f64());
            steps.push(part.to_f64());
            left = left - part;
        }
        steps.extend([0.0; 2]);
        assert!(left.is_zero(), "{}: {} left", R::name(), left.to_f64());
        let unit = R::resolution().to_f64();
        let found = steps.windows(3).map(|w| (w[2] - 2.0 * w[1] + w[0]).abs()).fold(0.0, f64::max);
        assert!(found <= jerk * (1.0 + 1e-5) + 8.0 * unit, "{}: {found} > {jerk} for {remaining}", R::name());
        let found = steps.iter().copied().fold(0.0, f64::max);
        assert!(found <= longest * (1.0 + 1e-5) + 2.0 * unit, "{}: {found} > {longest}", R::name());
        let quarter = (remaining / (2.0 * jerk)).cbrt().max(remaining / (2.0 * longest)).max(0.9);
        assert!(steps.len() as f64 <= 4.0 * (1.01 * quarter + 1.0) + 6.0, "{} periods", steps.len());
    }

    proptest! {
        #[test]
        fn a_landing_keeps_acceleration_and_jerk(
            longest in 0.01_f64..0.5, jerks in 1e-3_f64..1.0, remains in -3_f64..2.0,
        ) {
            let (jerk, remaining) = (longest * jerks, (longest * remains.exp2()).min(3.9));
            lands::<f64>(remaining, longest, jerk);
            lands::<f32>(remaining, longest, jerk);
            lands::<I4F28>(remaining, longest, jerk);
            lands::<I8F24>(remaining, longest, jerk);
            lands::<I4F60>(remaining, longest, jerk);
            lands::<I16F48>(remaining, longest, jerk);
        }
    }

    #[test]
    fn what_is_left_far_behind_is_landed_on_for_as_long_as_it_takes() {
        lands::<f64>(500.0, 0.5, 0.1);
        // A jerk of less than the format holds.
        let mut landing = Landing::default();
        let periods =
            (0..10_000).take_while(|_| landing.advance(1.0, 0.01, 0.0) != LandingStep::Over).count();
        assert!((2000..2100).contains(&periods), "{periods}");
    }
}
