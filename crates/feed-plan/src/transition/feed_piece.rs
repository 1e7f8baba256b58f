//! The feed over one stretch of time: a part of a transition, or a constant.

use real::Real;

use crate::StageShape;

/// A part of a transition, or a constant feed: `V(t) = V_s + (V_e - V_s) g(t/t₂)`, g the shape.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct FeedPiece<R> {
    /// The shape g.
    pub shape: StageShape<R>,
    /// V_s.
    pub start_feed: R,
    /// V_e.
    pub end_feed: R,
    /// t₂.
    pub duration: R,
}

impl<R: Real> FeedPiece<R> {
    /// V(t).
    #[must_use]
    pub fn feed(&self, time: R) -> R {
        self.feed_at(self.share(time))
    }

    /// a(t).
    #[must_use]
    pub fn acceleration(&self, time: R) -> R {
        self.mean_acceleration() * self.shape.slope(self.share(time))
    }

    /// j(t).
    #[must_use]
    pub fn jerk(&self, time: R) -> R {
        if self.duration > R::zero() {
            self.mean_acceleration() * self.shape.bend(self.share(time)) / self.duration
        } else {
            R::zero()
        }
    }

    /// S(t).
    #[must_use]
    pub fn distance(&self, time: R) -> R {
        self.distance_at(self.share(time))
    }

    /// S and V at a share t/t₂ of the time, for who asks at many times and would divide by the same t₂.
    #[must_use]
    pub fn distance_and_feed_at(&self, share: R) -> (R, R) {
        (self.distance_at(share), self.feed_at(share))
    }

    /// `S(from + width) - S(from)` without cancellation.
    #[must_use]
    pub fn distance_over(&self, from: R, width: R) -> R {
        if self.change().is_zero() {
            return width * self.start_feed;
        }
        let mean = self.shape.mean(self.share(from + width.half()), self.share(width));
        width * (self.start_feed + self.change() * mean)
    }

    /// S(t₂).
    #[must_use]
    pub fn length(&self) -> R {
        self.distance(self.duration)
    }

    /// Largest |a|.
    #[must_use]
    pub fn peak_acceleration(&self) -> R {
        self.mean_acceleration().abs() * self.shape.peak_slope()
    }

    /// Largest |j|.
    #[must_use]
    pub fn peak_jerk(&self) -> R {
        if self.duration > R::zero() {
            self.mean_acceleration().abs() * self.shape.peak_bend() / self.duration
        } else {
            R::zero()
        }
    }

    /// The coefficients `a₀..a₃` of the feed as a polynomial of the time since the start, as in the acceleration table
    /// of paper A; `None` for a cosine. They are for display only: a₃ is below the resolution of most fixed-point
    /// formats.
    #[must_use]
    pub fn coefficients(&self) -> Option<[R; 4]> {
        let [_, c1, c2, c3] = self.shape.coefficients()?;
        if !(self.duration > R::zero()) {
            return Some([self.start_feed, R::zero(), R::zero(), R::zero()]);
        }
        let slope = self.mean_acceleration();
        Some([
            self.start_feed,
            c1 * slope,
            c2 * slope / self.duration,
            c3 * slope / self.duration / self.duration,
        ])
    }

    /// S at a share of the time.
    fn distance_at(&self, x: R) -> R {
        self.duration * (self.start_feed * x + self.change() * self.shape.travelled(x))
    }

    /// V at a share of the time.
    fn feed_at(&self, x: R) -> R {
        self.start_feed + self.change() * self.shape.reached(x)
    }

    fn change(&self) -> R {
        self.end_feed - self.start_feed
    }

    /// `x = t/t₂`; 0 when the piece has no duration.
    fn share(&self, time: R) -> R {
        if self.duration > R::zero() { time / self.duration } else { R::zero() }
    }

    fn mean_acceleration(&self) -> R {
        if self.duration > R::zero() { self.change() / self.duration } else { R::zero() }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    #[test]
    fn a_constant_feed_covers_its_share_of_the_time() {
        let constant = FeedPiece { start_feed: 5.0, end_feed: 5.0, duration: 2.0, ..FeedPiece::default() };
        assert_eq!(constant.distance_over(0.5, 0.5), 2.5);
    }

    proptest! {
        #[test]
        fn acceleration_and_jerk_are_derivatives(
            start in 0.0..1.0_f64, end in 0.0..1.0_f64, duration in 0.1..100.0_f64, x in 0.01..0.99_f64,
        ) {
            for shape in StageShape::all() {
                let piece = FeedPiece { shape, start_feed: start, end_feed: end, duration };
                let (time, h) = (x * duration, 1e-4 * duration);
                let derivative = |of: fn(&FeedPiece<f64>, f64) -> f64| {
                    (of(&piece, time + h) - of(&piece, time - h)) / (h + h)
                };
                let (feed, acceleration) = (derivative(FeedPiece::distance), derivative(FeedPiece::feed));
                prop_assert!((feed - piece.feed(time)).abs() < 1e-7);
                prop_assert!((acceleration - piece.acceleration(time)).abs() < 1e-6 / duration);
                let jerk = derivative(FeedPiece::acceleration);
                prop_assert!((jerk - piece.jerk(time)).abs() < 1e-6 / duration.powi(2));
            }
        }

        #[test]
        fn distance_is_the_integral_of_the_feed(
            start in 0.0..1.0_f64, end in 0.0..1.0_f64, duration in 0.1..100.0_f64, from in 0.0..1.0_f64, to in 0.0..1.0_f64,
        ) {
            let piece = FeedPiece { shape: StageShape::Cubic, start_feed: start, end_feed: end, duration };
            let (from, to) = (from * duration, to * duration);
            // Simpson's rule is exact for a cubic. For a cosine, a hundred panels show that the closed form has the
            // same value.
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
    }
}
