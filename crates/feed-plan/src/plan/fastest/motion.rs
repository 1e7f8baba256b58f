//! Motion at constant jerk.
//!
//! From distance s, feed v and acceleration a, after the time t: `a + j t`, `v + a t + j t²/2`, `s + v t + a t²/2 + j t³/6`.
//! Between two states the mean feed of such a motion is `(v₀ + v₁)/2 - (a₁ - a₀) h/12`, h the time between them.

use real::Real;

/// Newton's steps for a time, at most: from above each leaves two thirds of the error at worst, and soon its square.
const STEPS: usize = 40;
/// Rounds of `y ← ⁴√(x y)` for a cube root: each leaves a quarter of the error of its logarithm.
const ROOT_ROUNDS: usize = 16;

/// Distance, feed and acceleration at an instant.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct State<R> {
    pub(crate) s: R,
    pub(crate) v: R,
    pub(crate) a: R,
}

impl<R: Real> State<R> {
    /// After a time, which may be negative, at a jerk.
    pub(crate) fn after(self, time: R, jerk: R) -> Self {
        let change = jerk * time;
        let s = self.s + time * (self.v + time * (self.a.half() + change * R::from_ratio(1, 6)));
        Self { s, v: self.v + time * (self.a + change.half()), a: self.a + change }
    }
}

/// The number whose cube is `x`, to about 2⁻²⁰ of itself: a first guess of a time.
fn cube_root<R: Real>(x: R) -> R {
    (0..ROOT_ROUNDS).fold(R::one(), |y, _| (x * y).sqrt().sqrt())
}

/// The time h in which `Δs = h (v + h (a/2 + j h/6))`, for `j ≥ 0` and a motion that does not come to rest before.
pub(crate) fn time_over<R: Real>(length: R, v: R, a: R, jerk: R) -> R {
    let sixth = jerk * R::from_ratio(1, 6);
    // Each term alone takes longer than all together.
    let mut time = R::max_value();
    if v > R::zero() && v > length.ldexp(-20) {
        time = length / v;
        if a < R::zero() {
            time = time + time.half();
        }
    }
    if a > R::zero() {
        time = time.min((length.ldexp(1) / a).sqrt());
    }
    if !(time < R::max_value()) || time * time * sixth > v {
        time = time.min(cube_root(length / sixth));
    }
    for _ in 0..STEPS {
        let off = time * (v + time * (a.half() + time * sixth)) - length;
        let slope = v + time * (a + time * (sixth + sixth + sixth));
        if !(slope > R::zero()) {
            break;
        }
        let step = off / slope;
        time = time - step;
        if !(step.abs() > time.abs() * R::resolution().ldexp(3)) {
            break;
        }
    }
    time
}

/// The time h of an arc of jerk -J between two feeds over a length: `J h³/12 + h (v₀ + v₁)/2 = Δs`.
pub(crate) fn time_of_cap<R: Real>(length: R, feeds: [R; 2], jerk: R) -> R {
    time_over(length, (feeds[0] + feeds[1]).half(), R::zero(), jerk.half())
}
