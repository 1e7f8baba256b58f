//! The trigonometric transition: half a cosine.
//!
//! With `D = |V_e - V_s|`, limits A and J:
//!
//! ```text
//! V(t) = V_s + (V_e - V_s) (1 - cos(πt/t_a))/2
//! a(t) = (V_e - V_s) π/(2t_a) sin(πt/t_a)        peak Dπ/(2t_a) in the middle
//! j(t) = (V_e - V_s) π²/(2t_a²) cos(πt/t_a)      peak Dπ²/(2t_a²) at both ends
//! S(t) = V_s t + (V_e - V_s) (t/2 - t_a/(2π) sin(πt/t_a))     S(t_a) = t_a (V_s + V_e)/2
//! ```
//!
//! Within the limits, `t_a = max(Dπ/(2A), π √(D/(2J)))`. Over a given distance L, `t_a = 2L/(V_s + V_e)`. It takes longer than
//! the S-curve: half again where only A binds and the jerk is free, 1.11 times where only J binds.
//!
//! Source: paper C (Wang Haitao et al.), section 2.1.

use real::{Real, Trigonometric};

use crate::{FeedPiece, Profile, StageShape};

/// A speed profile of half a cosine.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct TrigonometricProfile<R> {
    start_feed: R,
    end_feed: R,
    duration: R,
}

impl<R: Real> TrigonometricProfile<R> {
    /// The transition that covers `length`; `None` between two feeds of 0, which cover nothing.
    #[must_use]
    pub fn over(start_feed: R, end_feed: R, length: R) -> Option<Self> {
        let sum = start_feed + end_feed;
        (sum > R::zero()).then(|| Self { start_feed, end_feed, duration: (length + length) / sum })
    }
}

impl<R: Real> Profile<R> for TrigonometricProfile<R> {
    fn fastest(start_feed: R, end_feed: R, acceleration: R, jerk: R) -> Self {
        let difference = (end_feed - start_feed).abs();
        let by_acceleration = R::half_pi() * (difference / acceleration);
        let by_jerk = R::half_pi() * ((difference + difference) / jerk).sqrt();
        Self { start_feed, end_feed, duration: by_acceleration.max(by_jerk) }
    }

    fn pieces(&self) -> [FeedPiece<R>; 3] {
        let Self { start_feed, end_feed, duration } = *self;
        let none = FeedPiece { start_feed: end_feed, end_feed, ..FeedPiece::default() };
        [FeedPiece { shape: StageShape::Cosine, start_feed, end_feed, duration }, none, none]
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
    use std::f64::consts::PI;

    #[test]
    fn the_larger_of_the_two_times_holds() {
        // π √(25/8e5) = 17.56 ms by jerk against 7.85 by acceleration; 200π/1e4 = 62.8 ms against 49.7.
        let duration = |change: f64| TrigonometricProfile::fastest(0.0, change, 5000.0, 4e5).duration();
        assert!((duration(25.0) - PI * (25.0 / 8e5_f64).sqrt()).abs() < 1e-15);
        assert!((duration(200.0) - 200.0 * PI / 1e4).abs() < 1e-15);
    }

    #[test]
    fn over_a_distance_the_duration_follows() {
        let profile = TrigonometricProfile::over(50.0, 100.0, 3.0).unwrap();
        assert!((profile.duration() - 0.04).abs() < 1e-16 && (profile.length() - 3.0).abs() < 1e-15);
        assert_eq!(TrigonometricProfile::over(0.0, 0.0, 3.0), None);
    }

    /// What paper C passes over: an S-curve replaced by one half-cosine of the same length and so of the same time
    /// breaks the jerk by π²/8 where only the jerk binds.
    #[test]
    fn in_the_time_of_an_s_curve_it_breaks_the_jerk() {
        let s_curve = crate::SCurveProfile::fastest(50.0, 52.0, 1000.0, 5e4);
        let merged = TrigonometricProfile::over(50.0, 52.0, s_curve.length()).unwrap();
        let [piece, ..] = merged.pieces();
        assert!((piece.peak_jerk() / 5e4 - PI * PI / 8.0).abs() < 1e-12, "{}", piece.peak_jerk());
    }

    proptest! {
        #[test]
        fn promises_hold(
            start in 0.0..500.0_f64, end in 0.0..500.0_f64, acceleration in 10.0..1e4_f64, jerk in 100.0..1e6_f64,
            length in 0.0..1000.0_f64,
        ) {
            prop_assume!((start - end).abs() > 1e-3);
            promises::assert_kept::<TrigonometricProfile<f64>>([start, end], acceleration, jerk);
            promises::assert_peak::<TrigonometricProfile<f64>>([start, end], length, acceleration, jerk);
        }
    }
}
