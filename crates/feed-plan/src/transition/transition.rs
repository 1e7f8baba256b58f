//! Transitions between two feeds, with no acceleration at both ends.
//!
//! Every kind is symmetric in time: the feed changes as much in the second half as in the first. So a transition from
//! V_s to V_e in the time t₂ covers `t₂ (V_s + V_e)/2`. Each is made of one to three [`FeedPiece`]s. With `D = |V_e -
//! V_s|` and the limits A and J, the fastest transitions are these.
//!
//! # Cubic
//! With `x = t/t₂`:
//!
//! ```text
//! t₂   = max(3D/(2A), √(6D/J))
//! V(t) = V_s + (V_e - V_s)(3x² - 2x³)
//! a(t) = (V_e - V_s)/t₂ · 6x(1 - x)            peak 3D/(2t₂) in the middle
//! j(t) = (V_e - V_s)/t₂² · 6(1 - 2x)           peak 6D/t₂² at both ends
//! S(t) = t₂ (V_s x + (V_e - V_s)(x³ - x⁴/2))   S(t₂) = t₂ (V_s + V_e)/2
//! ```
//!
//! The acceleration is continuous and zero at both ends; the jerk steps there. The source distinguishes three cases,
//! which the one line for t₂ covers: `D = 8A²/(3J)` makes both terms equal and reaches both limits, a smaller D reaches
//! J only, a larger one A only. Everything is computed from x in [0, 1], since the printed coefficients of powers of t
//! span many orders of magnitude.
//!
//! Source: Paper A (Wang Yunsen et al.), section 2.1.1, with the sign of J(0) corrected.
//!
//! # S-curve
//! The acceleration rises with the jerk J for a time t_j, stays at its peak a for t_h, and falls back for t_j. The area
//! under this trapezoid is the change of feed, `a (t_j + t_h) = D`.
//!
//! ```text
//! D ≤ A²/J:  the peak a = √(DJ) does not reach A:  t_j = √(D/J), t_h = 0            t₂ = 2 √(D/J)
//! D > A²/J:  the peak is A:                        t_j = A/J,    t_h = D/A - A/J    t₂ = D/A + A/J
//! ```
//!
//! Both cases meet at `D = A²/J`. No transition that starts and ends without acceleration is faster. The three pieces
//! change the feed by `a t_j/2`, `a t_h` and `a t_j/2`.
//!
//! The feeds at the joints are rounded by up to half a unit ε of their last place. If a piece changes the feed by only
//! a few units, that rounding would raise the jerk. `D + 4ε` in place of D, and `A/J + 8ε/A` in place of A/J, leave
//! room for it.
//!
//! As a function of `x = t/t₂`, with `h = t_j/t₂` in (0, 1/2] and the steepest slope `p = 1/(1 - h)`:
//! `g = p x²/(2h)` up to h, `p (x - h/2)` up to 1 - h, then by symmetry `1 - g(1 - x)`; its integral is
//! `G = p x³/(6h)`, `p (h²/6 + (x² - hx)/2)`, and `x - 1/2 + G(1 - x)`.
//!
//! Source: paper C (Wang Haitao et al.), section 2, which assumes that the reader knows the S-curve.
//!
//! # Half-cosine
//!
//! ```text
//! V(t) = V_s + (V_e - V_s) (1 - cos(πt/t₂))/2
//! a(t) = (V_e - V_s) π/(2t₂) sin(πt/t₂)          peak Dπ/(2t₂) in the middle
//! j(t) = (V_e - V_s) π²/(2t₂²) cos(πt/t₂)        peak Dπ²/(2t₂²) at both ends
//! S(t) = V_s t + (V_e - V_s) (t/2 - t₂/(2π) sin(πt/t₂))       S(t₂) = t₂ (V_s + V_e)/2
//! ```
//!
//! Within the limits, `t₂ = max(Dπ/(2A), π √(D/(2J)))`. It takes longer than the S-curve: half again where only A binds and the
//! jerk is free, 1.11 times where only J binds.
//!
//! Source: paper C (Wang Haitao et al.), section 2.1.

use real::{Real, Trigonometric};

use crate::{FeedPiece, StageShape};

/// An S-curve holds its acceleration for at least 2⁻²⁰ of the time in which it builds the acceleration up. Over a
/// shorter hold, the feeds at both of its ends would be equal or differ by rounding only. A transition without the hold
/// has only slightly less jerk.
const SHORTEST_HOLD: i32 = -20;

/// The law by which a plan changes from one feed to another.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum ProfileKind {
    /// Cubic polynomials of time, as in paper A.
    Cubic,
    /// Pieces of constant jerk: the fastest transition that acceleration and jerk allow.
    SCurve,
    /// Half-cosines.
    Trigonometric,
    /// The S-curve, and half-cosines over stretches whose limit changes again before a transition has ended, as in
    /// paper C.
    Flexible,
    /// Pieces of constant jerk that carry acceleration through the minima of the limit and along it: within half a percent of the
    /// fastest plan.
    #[default]
    Fastest,
    /// None: the feed that the path allows at each period's begin, without look-ahead. It breaks acceleration and jerk in bends,
    /// and is the baseline that look-ahead is held against.
    WithoutLookAhead,
}

impl ProfileKind {
    /// Every kind that keeps acceleration and jerk.
    pub const ALL: [Self; 5] =
        [Self::Cubic, Self::SCurve, Self::Trigonometric, Self::Flexible, Self::Fastest];
}

/// A transition between two feeds, with no acceleration at both ends.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Transition<R> {
    start_feed: R,
    end_feed: R,
    duration: R,
    course: Course<R>,
}

/// How the feed changes over a transition.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Course<R> {
    /// Along one shape.
    Shape(StageShape<R>),
    /// The acceleration changes with constant jerk for t_j, stays at its peak for t_h, and falls back for t_j.
    SCurve { jerk_time: R, hold_time: R },
}

impl<R: Real> Transition<R> {
    /// The fastest transition of a kind between `feeds`, from the first to the second, within `acceleration` A and
    /// `jerk` J.
    #[must_use]
    pub fn fastest(kind: ProfileKind, feeds: [R; 2], acceleration: R, jerk: R) -> Self {
        let [start_feed, end_feed] = feeds;
        let (course, duration) = match kind {
            ProfileKind::Cubic => cubic(feeds, acceleration, jerk),
            ProfileKind::Trigonometric => half_cosine(feeds, acceleration, jerk),
            ProfileKind::SCurve
            | ProfileKind::Flexible
            | ProfileKind::Fastest
            | ProfileKind::WithoutLookAhead => s_curve(feeds, acceleration, jerk),
        };
        Self { start_feed, end_feed, duration, course }
    }

    /// The pieces in order. A piece without duration has no meaning.
    #[must_use]
    pub fn pieces(&self) -> [FeedPiece<R>; 3] {
        let Self { start_feed: from, end_feed: to, duration, course } = *self;
        let piece =
            |shape, start_feed, end_feed, duration| FeedPiece { shape, start_feed, end_feed, duration };
        match course {
            Course::Shape(shape) => {
                let none = piece(shape, to, to, R::zero());
                [piece(shape, from, to, duration), none, none]
            }
            Course::SCurve { jerk_time, hold_time } => {
                let area = jerk_time + hold_time;
                let onset =
                    if area > R::zero() { (to - from) * (jerk_time.half() / area) } else { R::zero() };
                let first = from + onset;
                // Without a hold, the two feeds in the middle must be the same number in every format.
                let second = if hold_time > R::zero() { to - onset } else { first };
                [
                    piece(StageShape::Onset, from, first, jerk_time),
                    piece(StageShape::Steady, first, second, hold_time),
                    piece(StageShape::Easing, second, to, jerk_time),
                ]
            }
        }
    }

    /// t₂.
    #[must_use]
    pub fn duration(&self) -> R {
        self.duration
    }

    /// Distance over the whole transition, `t₂ (V_s + V_e)/2`.
    #[must_use]
    pub fn length(&self) -> R {
        self.duration * (self.start_feed + (self.end_feed - self.start_feed).half())
    }

    /// For an S-curve, g and G at the share `x` of the time; they depend on the share of the time in which the jerk
    /// builds the acceleration up. `None` for the other kinds, which have one shape for all feeds.
    pub(crate) fn s_curve_shares(&self, x: R) -> Option<(R, R)> {
        let Course::SCurve { jerk_time, .. } = self.course else { return None };
        if !(self.duration > R::zero()) {
            return Some((x, (x * x).half()));
        }
        let onset = jerk_time / self.duration;
        let left = R::one() - x;
        Some(if x > left {
            let (reached, travelled) = first_half_of_s_curve(onset, left);
            (R::one() - reached, x - R::one().half() + travelled)
        } else {
            first_half_of_s_curve(onset, x)
        })
    }
}

fn cubic<R: Real>([from, to]: [R; 2], acceleration: R, jerk: R) -> (Course<R>, R) {
    let difference = (to - from).abs();
    let by_acceleration = (difference + difference.half()) / acceleration;
    let by_jerk = (difference * R::from_ratio(6, 1) / jerk).sqrt();
    (Course::Shape(StageShape::Cubic), by_acceleration.max(by_jerk))
}

fn half_cosine<R: Real>([from, to]: [R; 2], acceleration: R, jerk: R) -> (Course<R>, R) {
    let difference = (to - from).abs();
    let by_acceleration = R::half_pi() * (difference / acceleration);
    let by_jerk = R::half_pi() * ((difference + difference) / jerk).sqrt();
    (Course::Shape(StageShape::Cosine), by_acceleration.max(by_jerk))
}

fn s_curve<R: Real>([from, to]: [R; 2], acceleration: R, jerk: R) -> (Course<R>, R) {
    let exact = (to - from).abs();
    if !(exact > R::zero()) {
        return (Course::SCurve { jerk_time: R::zero(), hold_time: R::zero() }, R::zero());
    }
    let rounding = from.max(to).max(R::one()) * R::resolution().ldexp(2);
    let difference = exact + rounding;
    let by_acceleration = difference / acceleration;
    let build_up = acceleration / jerk + (rounding + rounding) / acceleration;
    let hold = by_acceleration - build_up;
    let (jerk_time, hold_time) = if hold > build_up.ldexp(SHORTEST_HOLD) {
        (build_up, hold)
    } else if hold > R::zero() {
        (by_acceleration, R::zero())
    } else {
        ((difference / jerk).sqrt(), R::zero())
    };
    (Course::SCurve { jerk_time, hold_time }, jerk_time + jerk_time + hold_time)
}

/// g and G of an S-curve for x up to 1/2; `onset` is h.
fn first_half_of_s_curve<R: Real>(onset: R, x: R) -> (R, R) {
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

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;
    use std::f64::consts::PI;

    const A: f64 = 5000.0;
    const J: f64 = 4e5;

    fn cubic(from: f64, to: f64) -> Transition<f64> {
        Transition::fastest(ProfileKind::Cubic, [from, to], A, J)
    }

    fn s_curve(from: f64, to: f64) -> Transition<f64> {
        Transition::fastest(ProfileKind::SCurve, [from, to], A, J)
    }

    /// Largest acceleration and jerk.
    fn peaks(transition: &Transition<f64>) -> (f64, f64) {
        let most = |of: fn(&FeedPiece<f64>) -> f64| transition.pieces().iter().map(of).fold(0.0, f64::max);
        (most(FeedPiece::peak_acceleration), most(FeedPiece::peak_jerk))
    }

    #[test]
    fn below_the_threshold_a_cubic_reaches_the_jerk_only() {
        // D = 100 < 8A²/(3J) = 166.67: A₁ = √(3JD/8) = 3873 replaces A, and t₂ = 4A₁/J = 38.73 ms.
        let transition = cubic(200.0, 100.0);
        let reached = (3.0 * J * 100.0 / 8.0_f64).sqrt();
        assert!((transition.duration() - 4.0 * reached / J).abs() < 1e-15);
        let (a, j) = peaks(&transition);
        assert!((a / reached - 1.0).abs() < 1e-12 && (j / J - 1.0).abs() < 1e-12, "{a} {j}");
        // The paper's deceleration distance for this transition: 5.81 mm.
        assert!((transition.length() - 5.809).abs() < 1e-3, "{}", transition.length());
    }

    #[test]
    fn at_the_threshold_a_cubic_reaches_both_limits() {
        let transition = cubic(0.0, 8.0 * A * A / (3.0 * J));
        let (a, j) = peaks(&transition);
        assert!((a / A - 1.0).abs() < 1e-12 && (j / J - 1.0).abs() < 1e-12, "{a} {j}");
        assert!((transition.duration() - 4.0 * A / J).abs() < 1e-15);
    }

    #[test]
    fn above_the_threshold_a_cubic_reaches_the_acceleration_only() {
        let (a, j) = peaks(&cubic(10.0, 210.0));
        let reached = 8.0 * A * A / (3.0 * 200.0); // J₁ replaces J
        assert!((a / A - 1.0).abs() < 1e-12 && (j / reached - 1.0).abs() < 1e-12, "{a} {j}");
    }

    #[test]
    fn the_table_entry_is_the_source_s_polynomial() {
        // Falling, D < 8A²/(3J): V = V_s - (J/2 t² - J²/(12 A₁) t³).
        let reached = (3.0 * J * 100.0 / 8.0_f64).sqrt();
        let [a0, a1, a2, a3] = cubic(200.0, 100.0).pieces()[0].coefficients().unwrap();
        assert_eq!((a0, a1), (200.0, 0.0));
        assert!((a2 / (-J / 2.0) - 1.0).abs() < 1e-12, "{a2}");
        assert!((a3 / (J * J / (12.0 * reached)) - 1.0).abs() < 1e-12, "{a3}");
    }

    #[test]
    fn the_two_cases_of_an_s_curve_meet_at_the_threshold() {
        let threshold = A * A / J; // 62.5 mm/s
        let duration = |change: f64| s_curve(0.0, change).duration();
        assert!((duration(threshold) - 2.0 * A / J).abs() < 1e-14);
        assert!((duration(threshold * (1.0 + 1e-9)) - 2.0 * A / J).abs() < 1e-9);
        // 25 mm/s: 2 √(25/4e5) = 15.81 ms; 200 mm/s: 40 + 12.5 ms.
        assert!((duration(25.0) - 2.0 * (25.0 / J).sqrt()).abs() < 1e-15);
        assert!((duration(200.0) - 0.0525).abs() < 1e-15);
    }

    #[test]
    fn the_larger_of_the_two_times_of_a_half_cosine_holds() {
        // π √(25/8e5) = 17.56 ms by jerk against 7.85 by acceleration; 200π/1e4 = 62.8 ms against 49.7.
        let duration =
            |change: f64| Transition::fastest(ProfileKind::Trigonometric, [0.0, change], A, J).duration();
        assert!((duration(25.0) - PI * (25.0 / 8e5_f64).sqrt()).abs() < 1e-15);
        assert!((duration(200.0) - 200.0 * PI / 1e4).abs() < 1e-15);
    }

    #[test]
    fn without_a_change_of_feed_everything_is_finite() {
        for kind in ProfileKind::ALL {
            let still = Transition::fastest(kind, [5.0, 5.0], A, J);
            assert_eq!((still.duration(), still.length(), peaks(&still)), (0.0, 0.0, (0.0, 0.0)));
            assert!(still.pieces().iter().all(|piece| (piece.start_feed, piece.end_feed) == (5.0, 5.0)));
        }
    }

    /// Checks that feed and acceleration do not step from piece to piece, that A and J are kept, and that one of them
    /// is reached.
    fn assert_promises(kind: ProfileKind, feeds: [f64; 2], most_acceleration: f64, most_jerk: f64) {
        let transition = Transition::fastest(kind, feeds, most_acceleration, most_jerk);
        let (mut feed, mut acceleration, mut duration, mut length) = (feeds[0], 0.0, 0.0, 0.0);
        let no_step = |a: f64, b: f64| assert!((a - b).abs() < 0.01 * most_acceleration, "{a} {b}");
        for piece in transition.pieces().iter().filter(|piece| piece.duration > 0.0) {
            assert_eq!(piece.start_feed, feed);
            no_step(piece.acceleration(0.0), acceleration);
            (feed, acceleration) = (piece.end_feed, piece.acceleration(piece.duration));
            (duration, length) = (duration + piece.duration, length + piece.length());
        }
        assert_eq!(feed, feeds[1]);
        no_step(acceleration, 0.0);
        let (a, j) = peaks(&transition);
        let (a, j) = (a / most_acceleration, j / most_jerk);
        assert!(a <= 1.0 + 1e-9 && j <= 1.0 + 1e-9 && a.max(j) > 1.0 - 1e-5, "a {a} j {j}");
        assert!((duration - transition.duration()).abs() < 1e-13 * duration);
        assert!((length - transition.length()).abs() < 1e-12 * length);
    }

    proptest! {
        #[test]
        fn promises_hold(
            start in 0.0..500.0_f64, end in 0.0..500.0_f64, acceleration in 10.0..1e4_f64, jerk in 100.0..1e6_f64,
        ) {
            prop_assume!((start - end).abs() > 1e-3);
            for kind in [ProfileKind::Cubic, ProfileKind::SCurve, ProfileKind::Trigonometric] {
                assert_promises(kind, [start, end], acceleration, jerk);
            }
        }

        /// The look-ahead depends on this when it refuses a ramp as too long.
        #[test]
        fn no_chain_of_transitions_is_shorter_than_one(
            feeds in prop::array::uniform3(0.0..1.0_f64), acceleration in 1e-4..0.5_f64, jerk in 1e-6..0.5_f64,
        ) {
            let mut feeds = feeds;
            feeds.sort_by(f64::total_cmp);
            let [low, middle, high] = feeds;
            for kind in ProfileKind::ALL {
                let length = |from, to| Transition::fastest(kind, [from, to], acceleration, jerk).length();
                let chain = length(low, middle) + length(middle, high);
                prop_assert!(length(low, high) <= chain * (1.0 + 1e-12), "{kind:?}");
            }
        }

        #[test]
        fn shares_of_an_s_curve_are_those_of_its_pieces(
            start in 0.0..500.0_f64, change in 0.1..500.0_f64, acceleration in 10.0..1e4_f64, jerk in 100.0..1e6_f64,
            x in 0.0..1.0_f64,
        ) {
            let transition =
                Transition::fastest(ProfileKind::SCurve, [start, start + change], acceleration, jerk);
            let (reached, travelled) = transition.s_curve_shares(x).unwrap();
            // The piece in which the time lies, and the distance of the pieces before it.
            let (mut time, mut before) = (x * transition.duration(), 0.0);
            let under_way = transition.pieces().into_iter().find(|piece| {
                let is_over = time > piece.duration;
                (time, before) = if is_over { (time - piece.duration, before + piece.length()) } else { (time, before) };
                !is_over
            });
            let piece = under_way.unwrap();
            prop_assert!((start + change * reached - piece.feed(time)).abs() < 1e-10);
            let expected = transition.duration() * (start * x + change * travelled);
            prop_assert!((expected - before - piece.distance(time)).abs() < 1e-11 * (1.0 + transition.length()));
        }
    }
}
