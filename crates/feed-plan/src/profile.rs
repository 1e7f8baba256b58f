//! Transitions between two feeds, whatever their family.
//!
//! Every family is symmetric in time: what is gained in the first half is gained in the second, so a transition from
//! V_s to V_e in the time t₂ covers `t₂ (V_s + V_e)/2`. Each is made of one to three [`FeedPiece`]s, by which feed,
//! acceleration, jerk and distance are evaluated.
//!
//! The inverse problem: over a distance L, from V_s up to a peak and down to V_e, how high can the peak be? The distance
//! that both transitions need grows with the peak from that of the direct one on, so the peak is found by halving an
//! interval. The cubic's closed form would be a cubic equation below the threshold and a quadratic one above it, for
//! V_s = V_e only; halving serves every family and every format.

use real::Real;

use crate::FeedPiece;

/// Halvings until a feed is known to the last place of 64 bits.
const HALVINGS: usize = 64;

/// A transition between two feeds, with no acceleration at both ends.
pub trait Profile<R: Real>: Copy {
    /// The fastest transition of the family within `acceleration` A and `jerk` J.
    #[must_use]
    fn fastest(start_feed: R, end_feed: R, acceleration: R, jerk: R) -> Self;

    /// The pieces in order; those without duration say nothing.
    #[must_use]
    fn pieces(&self) -> [FeedPiece<R>; 3];

    /// t₂.
    #[must_use]
    fn duration(&self) -> R;

    /// Distance over the whole transition, `t₂ (V_s + V_e)/2`.
    #[must_use]
    fn length(&self) -> R;

    /// V(t). Beyond the ends the feed there, as for acceleration, jerk and distance the values there.
    #[must_use]
    fn feed(&self, time: R) -> R {
        self.at(time, |_, piece, time| piece.feed(time))
    }

    /// a(t).
    #[must_use]
    fn acceleration(&self, time: R) -> R {
        self.at(time, |_, piece, time| piece.acceleration(time))
    }

    /// j(t); at a step of the jerk, the value after it.
    #[must_use]
    fn jerk(&self, time: R) -> R {
        self.at(time, |_, piece, time| piece.jerk(time))
    }

    /// S(t).
    #[must_use]
    fn distance(&self, time: R) -> R {
        self.at(time, |before, piece, time| before + piece.distance(time))
    }

    /// A quantity of the piece that is under way at `time`, with the distance before it.
    #[must_use]
    fn at(&self, time: R, quantity: impl Fn(R, &FeedPiece<R>, R) -> R) -> R {
        let (mut time, mut before) = (time.max(R::zero()), R::zero());
        let pieces = self.pieces();
        let [_, _, mut last] = pieces;
        for piece in pieces.into_iter().filter(|piece| piece.duration > R::zero()) {
            if time < piece.duration {
                return quantity(before, &piece, time);
            }
            time = time - piece.duration;
            before = before + piece.length();
            last = piece;
        }
        quantity(before - last.length(), &last, last.duration)
    }

    /// Highest feed in a way of `length` that starts at `start_feed`, rises and falls to `end_feed`, within A and J.
    ///
    /// `None` when the way is too short even for the direct transition. The value is below the exact one by at most a
    /// few units of the last place.
    #[must_use]
    fn peak_feed(start_feed: R, end_feed: R, length: R, acceleration: R, jerk: R) -> Option<R> {
        let needed = |peak: R| {
            Self::fastest(start_feed, peak, acceleration, jerk).length()
                + Self::fastest(peak, end_feed, acceleration, jerk).length()
        };
        let mut low = start_feed.max(end_feed);
        if !(needed(low) <= length) {
            return None;
        }
        // Twice as much each time, until it is too much.
        let mut step = low.max(R::resolution());
        let mut high = low + step;
        for _ in 0..HALVINGS {
            if !(needed(high) <= length) || high >= R::max_value().half() {
                break;
            }
            (low, step) = (high, step + step);
            high = low + step;
        }
        for _ in 0..HALVINGS {
            let middle = low + (high - low).half();
            if needed(middle) <= length { low = middle } else { high = middle }
        }
        Some(low)
    }
}

/// How a plan gets from one feed to another.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum ProfileKind {
    /// Cubic polynomials of time, as in paper A.
    #[default]
    Cubic,
    /// Pieces of constant jerk: the fastest that acceleration and jerk allow.
    SCurve,
    /// Half-cosines.
    Trigonometric,
    /// The S-curve, and half-cosines over stretches whose limit changes again before a transition has ended, as in
    /// paper C.
    Flexible,
}

impl ProfileKind {
    /// Every kind.
    pub const ALL: [Self; 4] = [Self::Cubic, Self::SCurve, Self::Trigonometric, Self::Flexible];
}

/// The promises of every family, for the tests of each.
#[cfg(test)]
pub(crate) mod promises {
    use super::*;

    /// Feed, acceleration and jerk are derivatives of each other by finite differences, distance the integral of the
    /// feed by Simpson's rule, A and J are kept and one of them is reached.
    pub(crate) fn assert_kept<P: Profile<f64>>(feeds: [f64; 2], acceleration: f64, jerk: f64) {
        let profile = P::fastest(feeds[0], feeds[1], acceleration, jerk);
        let duration = profile.duration();
        let change = (feeds[1] - feeds[0]).abs();
        let times = || (0..=500).map(|i| duration * f64::from(i) / 500.0);
        let a = times().map(|t| profile.acceleration(t).abs()).fold(0.0, f64::max) / acceleration;
        let j = times().map(|t| profile.jerk(t).abs()).fold(0.0, f64::max) / jerk;
        assert!(a <= 1.0 + 1e-9 && j <= 1.0 + 1e-9 && a.max(j) > 1.0 - 1e-5, "a {a} j {j}");
        assert!((profile.feed(0.0) - feeds[0]).abs() < 1e-12 * (feeds[0] + change));
        assert!((profile.feed(duration) - feeds[1]).abs() < 1e-12 * (feeds[0] + change));
        assert!(profile.acceleration(0.0).abs() + profile.acceleration(duration).abs() < 1e-6 * acceleration);

        let h = duration / 500.0;
        let mut travelled = 0.0;
        for t in times().take(500) {
            let (middle, end) = (t + h / 2.0, t + h);
            travelled += h / 6.0 * (profile.feed(t) + 4.0 * profile.feed(middle) + profile.feed(end));
            // Simpson's rule sees a step of the jerk inside a panel as an error of about a h²/10, four times at most.
            let tolerance = 0.4 * acceleration * h * h + 1e-9 * profile.length();
            assert!((profile.distance(end) - travelled).abs() < tolerance);
            let slope = (profile.feed(end) - profile.feed(t)) / h;
            let (low, high) = (profile.acceleration(t), profile.acceleration(end));
            let (low, high) = (low.min(high), low.max(high).max(profile.acceleration(middle)));
            let low = low.min(profile.acceleration(middle));
            assert!(
                slope > low - 0.01 * acceleration && slope < high + 0.01 * acceleration,
                "{low} {slope} {high}"
            );
            let bend = (profile.acceleration(end) - profile.acceleration(t)) / h;
            // Over a step of the jerk the difference is between the values on both sides.
            let (low, high) = (profile.jerk(t + 1e-9 * h), profile.jerk(end - 1e-9 * h));
            assert!(
                bend > low.min(high) - 0.01 * jerk && bend < low.max(high) + 0.01 * jerk,
                "{bend} {low} {high}"
            );
        }
        assert!((profile.distance(duration) - profile.length()).abs() < 1e-12 * profile.length());
        let pieces: f64 = profile.pieces().iter().map(|piece| piece.duration).sum();
        assert!((pieces - duration).abs() < 1e-13 * duration);
    }

    /// The peak found is reached within the length, and nothing higher is.
    pub(crate) fn assert_peak<P: Profile<f64>>(feeds: [f64; 2], length: f64, acceleration: f64, jerk: f64) {
        let [start, end] = feeds;
        let needed = |peak: f64| {
            P::fastest(start, peak, acceleration, jerk).length()
                + P::fastest(peak, end, acceleration, jerk).length()
        };
        match P::peak_feed(start, end, length, acceleration, jerk) {
            Some(peak) => {
                assert!(needed(peak) <= length && peak >= start.max(end));
                assert!(
                    needed(peak + 1e-9 * (1.0 + peak)) > length,
                    "{peak} needs {} of {length}",
                    needed(peak)
                );
            }
            None => assert!(needed(start.max(end)) > length),
        }
    }
}
