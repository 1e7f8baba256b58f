//! Steps by Taylor expansion: the baselines of paper A. The secant iteration also starts from them until it has four
//! parameters to extrapolate. (In the paper the second-order expansion makes these first steps itself.)
//!
//! With the arc length s, du/ds = 1/|C'| and d²u/ds² = -(C'·C'')/|C'|⁴, so a step of length L goes from u to
//! `u + L/|C'| - L² (C'·C'')/(2|C'|⁴)`. The powers of |C'| overflow fixed point at once (|C'|⁴ is 4e13 on the
//! example curve); in terms of the unit tangent τ = C'/|C'| and the first-order step h = L/|C'| the same is
//! `u + h - h·(h·(τ·C'')/|C'|)/2`, whose intermediates are no larger than C'' itself.
//!
//! Source: papers A, section 2.2, and C (Wang Haitao et al.), equation (2). Paper C prints the second-order term with
//! the wrong sign; see `docs/papers.md`.

use nurbs_core::Derivatives;
use real::Real;

/// Order of the expansion.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Order {
    /// `u + L/|C'|`.
    First,
    /// With the term in L².
    Second,
}

/// The parameter increment of a step of length `length` from the point of `at`.
///
/// Where C' = 0 the expansion does not exist, and the increment is infinite or saturates: the caller bounds it. The
/// result is never negative: if the second-order term would reverse the step, the result is the first-order increment.
#[must_use]
pub fn increment<R: Real, const D: usize>(at: &Derivatives<R, D>, length: R, order: Order) -> R {
    let speed = R::norm(&at.first).signal("parametric_speed");
    let first = (length / speed).signal("taylor_increment");
    if order == Order::First || speed <= R::zero() {
        return first;
    }
    let along = R::sum_of_products((0..D).map(|d| (at.first[d] / speed, at.second[d])));
    let second = first - first * (first * (along / speed)).half();
    if second > R::zero() { second } else { first }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// C(u) = (u², 0) at u = 1: a step of length L ends at √(1+L), whose series is 1 + L/2 - L²/8.
    #[test]
    fn the_second_order_term_is_subtracted() {
        let at = Derivatives { point: [1.0, 0.0], first: [2.0, 0.0], second: [2.0, 0.0] };
        let length = 0.01_f64;
        assert_eq!(increment(&at, length, Order::First), length / 2.0);
        let second = increment(&at, length, Order::Second);
        assert!((second - (length / 2.0 - length * length / 8.0)).abs() < 1e-18);
        assert!((1.0 + second - (1.0 + length).sqrt()).abs() < length.powi(3) / 15.0);
    }
}
