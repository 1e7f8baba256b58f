//! The S-curve: constant jerk, constant acceleration, constant jerk.
//!
//! With `D = |V_e - V_s|` and limits A and J. The acceleration rises with the jerk J for a time t_j, stays at its peak for
//! t_h, and falls back for t_j; the area under this trapezoid is the change of feed, `a (t_j + t_h) = D`.
//!
//! ```text
//! D ≤ A²/J:  the peak a = √(DJ) does not reach A:  t_j = √(D/J), t_h = 0            t₂ = 2 √(D/J)
//! D > A²/J:  the peak is A:                        t_j = A/J,    t_h = D/A - A/J    t₂ = D/A + A/J
//! ```
//!
//! Both meet at `D = A²/J`. Nothing that starts and ends without acceleration is faster. The three pieces change the feed
//! by `a t_j/2`, `a t_h` and `a t_j/2`.
//!
//! The feeds at the joints are rounded, by up to half a unit ε of their last place. Where a piece changes the feed by a few
//! units only, that would raise the jerk: `D + 4ε` in place of D, and `A/J + 8ε/A` in place of A/J, leave room for it.
//!
//! As a function of `x = t/t₂`, with `h = t_j/t₂` in (0, 1/2] and the steepest slope `p = 1/(1 - h)`:
//! `g = p x²/(2h)` up to h, `p (x - h/2)` up to 1 - h, then by symmetry `1 - g(1 - x)`; its integral is
//! `G = p x³/(6h)`, `p (h²/6 + (x² - hx)/2)`, and `x - 1/2 + G(1 - x)`.
//!
//! Source: paper C (Wang Haitao et al.), section 2, which takes the profile as known.

use real::Real;

use crate::{FeedPiece, Profile, StageShape};

/// A hold shorter than 2⁻²⁰ of the build-up is left out, at hardly less jerk: its feeds would be the same but for rounding.
const SHORTEST_HOLD: i32 = -20;

/// A speed profile of constant jerk, constant acceleration and constant jerk again.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SCurveProfile<R> {
    start_feed: R,
    end_feed: R,
    /// t_j.
    jerk_time: R,
    /// t_h.
    hold_time: R,
}

impl<R: Real> Profile<R> for SCurveProfile<R> {
    fn fastest(start_feed: R, end_feed: R, acceleration: R, jerk: R) -> Self {
        let exact = (end_feed - start_feed).abs();
        if !(exact > R::zero()) {
            return Self { start_feed, end_feed, jerk_time: R::zero(), hold_time: R::zero() };
        }
        let rounding = start_feed.max(end_feed).max(R::one()) * R::resolution().scale(2);
        let difference = exact + rounding;
        let by_acceleration = difference / acceleration;
        let build_up = acceleration / jerk + (rounding + rounding) / acceleration;
        let hold = by_acceleration - build_up;
        let (jerk_time, hold_time) = if hold > build_up.scale(SHORTEST_HOLD) {
            (build_up, hold)
        } else if hold > R::zero() {
            (by_acceleration, R::zero())
        } else {
            ((difference / jerk).sqrt(), R::zero())
        };
        Self { start_feed, end_feed, jerk_time, hold_time }
    }

    fn pieces(&self) -> [FeedPiece<R>; 3] {
        let change = self.end_feed - self.start_feed;
        let area = self.jerk_time + self.hold_time;
        let onset = if area > R::zero() { change * (self.jerk_time.half() / area) } else { R::zero() };
        let (first, second) = (self.start_feed + onset, self.end_feed - onset);
        let piece =
            |shape, start_feed, end_feed, duration| FeedPiece { shape, start_feed, end_feed, duration };
        // Without a hold the two feeds in the middle are one number in every format.
        let second = if self.hold_time > R::zero() { second } else { first };
        [
            piece(StageShape::Onset, self.start_feed, first, self.jerk_time),
            piece(StageShape::Steady, first, second, self.hold_time),
            piece(StageShape::Easing, second, self.end_feed, self.jerk_time),
        ]
    }

    fn duration(&self) -> R {
        self.jerk_time + self.jerk_time + self.hold_time
    }

    fn length(&self) -> R {
        self.duration() * (self.start_feed + (self.end_feed - self.start_feed).half())
    }
}

impl<R: Real> SCurveProfile<R> {
    /// g and G at the share `x` of the time.
    pub(crate) fn shares(&self, x: R) -> (R, R) {
        let duration = self.duration();
        if !(duration > R::zero()) {
            return (x, (x * x).half());
        }
        let onset = self.jerk_time / duration;
        let rest = R::one() - x;
        if x > rest {
            let (reached, travelled) = Self::first_half(onset, rest);
            (R::one() - reached, x - R::one().half() + travelled)
        } else {
            Self::first_half(onset, x)
        }
    }

    /// g and G for x up to 1/2.
    fn first_half(onset: R, x: R) -> (R, R) {
        let slope = R::one() / (R::one() - onset);
        let third = R::from_ratio(1, 3);
        if x < onset {
            let reached = (slope * x * (x / onset)).half();
            (reached, reached * x * third)
        } else {
            let reached = slope * (x - onset.half());
            (reached, slope * (onset * onset * third + x * (x - onset)).half())
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::profile::promises;
    use proptest::prelude::*;

    const A: f64 = 5000.0;
    const J: f64 = 4e5;

    #[test]
    fn the_two_cases_meet_at_the_threshold() {
        let threshold = A * A / J; // 62.5 mm/s
        let duration = |change: f64| SCurveProfile::fastest(0.0, change, A, J).duration();
        assert!((duration(threshold) - 2.0 * A / J).abs() < 1e-14);
        assert!((duration(threshold * (1.0 + 1e-9)) - 2.0 * A / J).abs() < 1e-9);
        // 25 mm/s: 2 √(25/4e5) = 15.81 ms; 200 mm/s: 40 + 12.5 ms.
        assert!((duration(25.0) - 2.0 * (25.0 / J).sqrt()).abs() < 1e-15);
        assert!((duration(200.0) - 0.0525).abs() < 1e-15);
    }

    #[test]
    fn no_change_takes_no_time() {
        let still = SCurveProfile::fastest(5.0, 5.0, A, J);
        assert_eq!((still.duration(), still.length(), still.feed(0.0)), (0.0, 0.0, 5.0));
    }

    #[test]
    fn a_peak_in_closed_form() {
        // From rest to rest over L, below the threshold: L = 2 · V √(V/J), so V = (L² J/4)^(1/3).
        let peak = SCurveProfile::peak_feed(0.0, 0.0, 0.5, A, J).unwrap();
        assert!((peak - (0.25 * J / 4.0_f64).cbrt()).abs() < 1e-9, "{peak}");
    }

    proptest! {
        #[test]
        fn promises_hold(
            start in 0.0..500.0_f64, end in 0.0..500.0_f64, acceleration in 10.0..1e4_f64, jerk in 100.0..1e6_f64,
            length in 0.0..1000.0_f64,
        ) {
            prop_assume!((start - end).abs() > 1e-3);
            promises::assert_kept::<SCurveProfile<f64>>([start, end], acceleration, jerk);
            promises::assert_peak::<SCurveProfile<f64>>([start, end], length, acceleration, jerk);
        }

        #[test]
        fn shares_are_those_of_the_pieces(
            start in 0.0..500.0_f64, change in 0.1..500.0_f64, acceleration in 10.0..1e4_f64, jerk in 100.0..1e6_f64,
            x in 0.0..1.0_f64,
        ) {
            let profile = SCurveProfile::fastest(start, start + change, acceleration, jerk);
            let (reached, travelled) = profile.shares(x);
            let time = x * profile.duration();
            prop_assert!((start + change * reached - profile.feed(time)).abs() < 1e-10);
            let distance = profile.duration() * (start * x + change * travelled);
            prop_assert!((distance - profile.distance(time)).abs() < 1e-11 * (1.0 + profile.length()));
        }
    }
}
