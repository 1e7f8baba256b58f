//! Polynomials on [0, 1]: between Bernstein and power basis, and their bounds.

use alloc::vec::Vec;

use real::Real;

/// Bernstein → power basis: `a_k = binomial(p, k) Δᵏ b_0`, by forward differences.
pub(crate) fn power_basis<H: Real>(bernstein: &[H]) -> Vec<H> {
    let degree = bernstein.len() - 1;
    let mut differences = bernstein.to_vec();
    let mut result = Vec::with_capacity(degree + 1);
    let mut binomial = 1;
    for k in 0..=degree {
        result.push(differences[0] * H::from_ratio(binomial, 1));
        for j in 0..degree - k {
            differences[j] = differences[j + 1] - differences[j];
        }
        binomial = binomial * i32::try_from(degree - k).unwrap_or(0) / i32::try_from(k + 1).unwrap_or(1);
    }
    result
}

/// An upper bound of |p(t)| for t in [0, 1], of `p(t) = Σ_k a_k t^k`: the largest Bernstein coefficient, for a
/// polynomial lies in the hull of those. The rounding of this computation itself is covered by a slack.
pub(crate) fn bound_on_unit_interval(power: &[f64]) -> f64 {
    let degree = power.len().saturating_sub(1);
    // b_i = Σ_{k≤i} binomial(i, k)/binomial(p, k) a_k
    let mut largest = 0.0_f64;
    let mut magnitude = 0.0_f64;
    for i in 0..=degree {
        let (mut sum, mut ratio) = (0.0, 1.0);
        for (k, a) in power.iter().enumerate().take(i + 1) {
            sum += ratio * a;
            magnitude = magnitude.max(a.abs());
            ratio *= (i - k) as f64 / (degree - k).max(1) as f64;
        }
        largest = largest.max(sum.abs());
    }
    largest + SLACK * magnitude
}

/// Relative rounding of a Bernstein coefficient of degree 18 at most: 19 products of 19 factors.
const SLACK: f64 = 1e-12;

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    proptest! {
        #[test]
        fn no_value_exceeds_the_bound(power in proptest::collection::vec(-10.0..10.0_f64, 1..12), t in 0.0..=1.0_f64) {
            let value = power.iter().rev().fold(0.0, |sum, a| sum * t + a);
            prop_assert!(value.abs() <= bound_on_unit_interval(&power), "{value}");
        }

        #[test]
        fn the_two_bases_agree(bernstein in proptest::collection::vec(-10.0..10.0_f64, 2..10), t in 0.0..=1.0_f64) {
            let power = power_basis(&bernstein);
            let value = power.iter().rev().fold(0.0, |sum, a| sum * t + a);
            let mut row = bernstein.clone();
            while row.len() > 1 {
                row = row.windows(2).map(|w| w[0] + (w[1] - w[0]) * t).collect();
            }
            prop_assert!((value - row[0]).abs() < 1e-9, "{value} {}", row[0]);
        }
    }

    #[test]
    fn the_bound_of_a_monotone_polynomial_is_its_end() {
        assert!((bound_on_unit_interval(&[1.0, 1.0, 1.0]) - 3.0).abs() < 1e-11);
        assert!((bound_on_unit_interval(&[0.0, 2.0, -1.0]) - 1.0).abs() < 1e-11);
    }
}
