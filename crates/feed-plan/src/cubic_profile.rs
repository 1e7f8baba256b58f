//! The cubic-polynomial transition between two feeds.
//!
//! With `D = |V_e - V_s|`, limits A and J, and `x = t/t₂`:
//!
//! ```text
//! t₂   = max(3D/(2A), √(6D/J))
//! V(t) = V_s + (V_e - V_s)(3x² - 2x³)
//! a(t) = (V_e - V_s)/t₂ · 6x(1 - x)            peak 3D/(2t₂) in the middle
//! j(t) = (V_e - V_s)/t₂² · 6(1 - 2x)           peak 6D/t₂² at both ends
//! S(t) = t₂ (V_s x + (V_e - V_s)(x³ - x⁴/2))   S(t₂) = t₂ (V_s + V_e)/2
//! ```
//!
//! The acceleration is continuous and zero at both ends; the jerk steps there. The three cases of the source
//! are in the one line for t₂: `D = 8A²/(3J)` makes both terms equal and reaches both limits, a smaller D
//! reaches J only, a larger one A only. Everything is computed from x in [0, 1]: the printed coefficients of
//! powers of t span many orders of magnitude.
//!
//! Source: Paper A (Wang Yunsen et al.), section 2.1.1, with the sign of J(0) corrected.

use real::Real;

use crate::{FeedPiece, Profile, StageShape};

/// A speed profile `V(t)` on `[0, duration]`, a cubic in t with zero acceleration at both ends.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct CubicProfile<R> {
    start_feed: R,
    end_feed: R,
    duration: R,
}

impl<R: Real> Profile<R> for CubicProfile<R> {
    fn fastest(start_feed: R, end_feed: R, acceleration: R, jerk: R) -> Self {
        let difference = (end_feed - start_feed).abs();
        let by_acceleration = (difference + difference.half()) / acceleration;
        let by_jerk = (difference * R::from_ratio(6, 1) / jerk).sqrt();
        Self { start_feed, end_feed, duration: by_acceleration.max(by_jerk) }
    }

    fn pieces(&self) -> [FeedPiece<R>; 3] {
        let Self { start_feed, end_feed, duration } = *self;
        let none = FeedPiece { start_feed: end_feed, end_feed, ..FeedPiece::default() };
        [FeedPiece { shape: StageShape::Cubic, start_feed, end_feed, duration }, none, none]
    }

    fn duration(&self) -> R {
        self.duration
    }

    fn length(&self) -> R {
        self.duration * (self.start_feed + (self.end_feed - self.start_feed).half())
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::profile::promises;
    use proptest::prelude::*;

    const A: f64 = 5000.0;
    const J: f64 = 4e5;

    /// Largest |a| and |j| on a fine grid.
    fn peaks(profile: &CubicProfile<f64>) -> (f64, f64) {
        let times = (0..=1000).map(|i| profile.duration() * f64::from(i) / 1000.0);
        times.fold((0.0, 0.0), |(a, j), t| {
            (profile.acceleration(t).abs().max(a), profile.jerk(t).abs().max(j))
        })
    }

    #[test]
    fn below_the_threshold_only_the_jerk_is_reached() {
        // D = 100 < 8A²/(3J) = 166.67: A₁ = √(3JD/8) = 3873 replaces A, and t₂ = 4A₁/J = 38.73 ms.
        let profile = CubicProfile::fastest(200.0, 100.0, A, J);
        let reached = (3.0 * J * 100.0 / 8.0_f64).sqrt();
        assert!((profile.duration() - 4.0 * reached / J).abs() < 1e-15);
        let (a, j) = peaks(&profile);
        assert!((a / reached - 1.0).abs() < 1e-12 && (j / J - 1.0).abs() < 1e-12, "{a} {j}");
        // The paper's deceleration distance for this transition: 5.81 mm.
        assert!((profile.length() - 5.809).abs() < 1e-3, "{}", profile.length());
    }

    #[test]
    fn at_the_threshold_both_limits_are_reached() {
        let profile = CubicProfile::fastest(0.0, 8.0 * A * A / (3.0 * J), A, J);
        let (a, j) = peaks(&profile);
        assert!((a / A - 1.0).abs() < 1e-12 && (j / J - 1.0).abs() < 1e-12, "{a} {j}");
        assert!((profile.duration() - 4.0 * A / J).abs() < 1e-15);
    }

    #[test]
    fn above_the_threshold_only_the_acceleration_is_reached() {
        let profile = CubicProfile::fastest(10.0, 210.0, A, J);
        let (a, j) = peaks(&profile);
        let reached = 8.0 * A * A / (3.0 * 200.0); // J₁ replaces J
        assert!((a / A - 1.0).abs() < 1e-12 && (j / reached - 1.0).abs() < 1e-12, "{a} {j}");
    }

    #[test]
    fn the_table_entry_is_the_source_s_polynomial() {
        // Falling, D < 8A²/(3J): V = V_s - (J/2 t² - J²/(12 A₁) t³).
        let reached = (3.0 * J * 100.0 / 8.0_f64).sqrt();
        let [a0, a1, a2, a3] = CubicProfile::fastest(200.0, 100.0, A, J).pieces()[0].coefficients().unwrap();
        assert_eq!((a0, a1), (200.0, 0.0));
        assert!((a2 / (-J / 2.0) - 1.0).abs() < 1e-12, "{a2}");
        assert!((a3 / (J * J / (12.0 * reached)) - 1.0).abs() < 1e-12, "{a3}");
    }

    #[test]
    fn without_a_change_of_feed_everything_is_finite() {
        let profile = CubicProfile::fastest(5.0, 5.0, A, J);
        assert_eq!((profile.duration(), profile.length()), (0.0, 0.0));
        assert_eq!((profile.acceleration(0.0), profile.jerk(0.0)), (0.0, 0.0));
        let constant = FeedPiece { start_feed: 5.0, end_feed: 5.0, duration: 2.0, ..FeedPiece::default() };
        assert_eq!(constant.distance_over(0.5, 0.5), 2.5);
    }

    proptest! {
        #[test]
        fn distance_is_the_integral_of_the_feed(
            start in 0.0..1.0_f64, end in 0.0..1.0_f64, duration in 0.1..100.0_f64, from in 0.0..1.0_f64, to in 0.0..1.0_f64,
        ) {
            let piece = FeedPiece { shape: StageShape::Cubic, start_feed: start, end_feed: end, duration };
            let (from, to) = (from * duration, to * duration);
            // Simpson's rule is exact for a cubic; a hundred panels show that the closed form is the same.
            let h = (to - from) / 100.0;
            let panel = |i: i32| {
                let t = from + h * f64::from(i);
                h / 6.0 * (piece.feed(t) + 4.0 * piece.feed(t + h / 2.0) + piece.feed(t + h))
            };
            let integral: f64 = (0..100).map(panel).sum();
            let tolerance = 1e-13 * duration;
            prop_assert!((piece.distance_over(from, to - from) - integral).abs() < tolerance);
            prop_assert!((piece.distance(to) - piece.distance(from) - integral).abs() < tolerance);
        }

        #[test]
        fn promises_hold(
            start in 0.0..500.0_f64, end in 0.0..500.0_f64, acceleration in 10.0..1e4_f64, jerk in 100.0..1e6_f64,
            length in 0.0..1000.0_f64,
        ) {
            prop_assume!((start - end).abs() > 1e-3);
            promises::assert_kept::<CubicProfile<f64>>([start, end], acceleration, jerk);
            promises::assert_peak::<CubicProfile<f64>>([start, end], length, acceleration, jerk);
        }
    }
}
