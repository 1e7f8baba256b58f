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

/// n over k.
pub(crate) fn binomial(n: usize, k: usize) -> f64 {
    (0..k.min(n)).fold(1.0, |product, i| product * (n - i) as f64 / (i + 1) as f64)
}

/// An upper bound of |p(t)| for t in [0, 1], of `p(t) = Σ_k a_k t^k`.
pub(crate) fn bound_on_unit_interval(power: &[f64]) -> f64 {
    let (least, greatest) = hull(power);
    greatest.max(-least)
}

/// [0, 1] is cut into this many parts where one hull for all of it would be too wide. With eight, the hull of a quarter
/// circle's speed is a tenth wider than its range.
pub(crate) const PARTS: u32 = 8;

/// `p` on one of the [`PARTS`] of [0, 1], as a polynomial on [0, 1].
pub(crate) fn on_part(power: &[f64], part: u32) -> Vec<f64> {
    let width = 1.0 / f64::from(PARTS);
    let begin = f64::from(part) * width;
    let mut shifted = power.to_vec();
    for lowest in 0..shifted.len() {
        for k in (lowest..shifted.len() - 1).rev() {
            shifted[k] += shifted[k + 1] * begin;
        }
    }
    let mut unit = 1.0;
    for a in &mut shifted {
        *a *= unit;
        unit *= width;
    }
    shifted
}

/// The least and the greatest Bernstein coefficient of `p(t) = Σ_k a_k t^k`: p lies between them on [0, 1]. Both are
/// moved outward by the rounding of this computation and of [`on_part`] before it.
pub(crate) fn hull(power: &[f64]) -> (f64, f64) {
    let degree = power.len().saturating_sub(1);
    // b_i = Σ_{k≤i} binomial(i, k)/binomial(p, k) a_k
    let (mut least, mut greatest) = (f64::INFINITY, f64::NEG_INFINITY);
    for i in 0..=degree {
        let (mut sum, mut ratio) = (0.0, 1.0);
        for (k, a) in power.iter().enumerate().take(i + 1) {
            sum += ratio * a;
            ratio *= (i - k) as f64 / (degree - k).max(1) as f64;
        }
        (least, greatest) = (least.min(sum), greatest.max(sum));
    }
    let slack = SLACK * power.iter().map(|a| a.abs()).sum::<f64>();
    (least - slack, greatest + slack)
}

/// Rounding relative to `Σ |a_k|`. The degree is at most 14: 15 sums of products of 15 factors, and as many for a
/// shift.
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
        fn the_parts_make_up_the_whole(power in proptest::collection::vec(-10.0..10.0_f64, 1..12), part in 0..PARTS, t in 0.0..=1.0_f64) {
            let at = |power: &[f64], t: f64| power.iter().rev().fold(0.0, |sum, a| sum * t + a);
            let (value, own) = (at(&power, (f64::from(part) + t) / f64::from(PARTS)), on_part(&power, part));
            prop_assert!((at(&own, t) - value).abs() < 1e-11, "{value}");
            let (least, greatest) = hull(&own);
            prop_assert!(least <= value && value <= greatest, "{value} not in {least}..{greatest}");
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
