//! The cubic trigonometric basis: four functions of `S = sin(πu/2)` and `C = cos(πu/2)` with two shape factors.
//!
//! A segment is a Hermite curve over u in [0, 1]. It goes from its first control point `q_0` to its second `q_1`; the
//! other two only determine the derivatives at both ends,
//!
//! `P = H_00 q_0 + H_01 q_1 + H_10 D_0 + H_11 D_1`,
//! `D_0 = (q_1 - q_0) - k (q_2 - q_1)`, `D_1 = (q_2 - q_1) - k (q_3 - q_2)`.
//!
//! The next segment begins with q_1, q_2, q_3, so its D_0 is this one's D_1: segments join with equal first derivative. With the
//! bump `b = S² - S³`, which vanishes with its derivative at both ends, the Hermite functions are
//!
//! `H_00 = C³ + λ b`, `H_01 = 1 - H_00`, `H_10 = (2/π)(S - 1 + H_00)`, `H_11 = (2/π)(H_00 - C)`.
//!
//! Collected by control points they become the basis `B_0 … B_3`, whose sum is 1. All derivatives follow from two
//! numbers: with `g = λ(2 - 3S) - 3C` and `m = (C² - S²) g + 3 C S (S - λC)`,
//!
//! `H_00' = (π/2) C S g`, `H_10' = C (1 + S g)`, `H_11' = S (1 + C g)`,
//! `H_00'' = (π/2)² m`, `H_10'' = (π/2)(m - S)`, `H_11'' = (π/2)(m + C)`.
//!
//! **Source**: paper B (Tao Jianming et al.; see `docs/papers.md`), formulas (1) to (7). The formulas follow here from
//! the paper's conditions at the ends, (3) to (5), because our text of the paper is garbled.

use real::{Real, Trigonometric};

/// The two shape factors of a segment.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ShapeFactors<R> {
    /// λ: the factor of the bump `S² - S³`. With 1 the basis is symmetric under `u → 1 - u`. With any other value a
    /// segment with symmetric control points is skewed.
    pub lambda: R,
    /// k: the part of the following chord that is subtracted from the end derivatives. With -1 they are `q_2 - q_0` and
    /// `q_3 - q_1`. Segments that join with equal derivative have the same k.
    pub k: R,
}

impl<R: Real> ShapeFactors<R> {
    /// λ = 1, k = -1: the factors of arcs and corners.
    #[must_use]
    pub fn symmetric() -> Self {
        Self { lambda: R::one(), k: -R::one() }
    }
}

/// `B_0(u) … B_3(u)`.
///
/// At u = 0 exactly (1, 0, 0, 0), at u = 1 exactly (0, 1, 0, 0), in every format. The sum is exactly 1 in fixed point.
/// Domain: as [`Trigonometric::sin_cos_quarter`]; the functions are made for u in [0, 1].
///
/// Range: for |λ| ≤ 2 and |k| ≤ 2 every intermediate stays below 4: three integer bits. Accuracy there: 12 units of the format's
/// resolution.
#[must_use]
pub fn trig_basis<R: Real>(u: R, shape: &ShapeFactors<R>) -> [R; 4] {
    let (s, c) = R::sin_cos_quarter(u);
    let h00 = c * c * c + shape.lambda * (s * s * (R::one() - s));
    let h10 = R::two_over_pi() * (s - R::one() + h00);
    let h11 = R::two_over_pi() * (h00 - c);
    let [b0, b1, b2, b3] = by_control_points(h00, h10, h11, shape);
    [b0, R::one() + b1, b2, b3]
}

/// `B_j(u)`, `B_j'(u)` and `B_j''(u)`, in this order, j = 0 … 3; derivatives by u.
///
/// Range: for |λ| ≤ 2 and |k| ≤ 2 every intermediate stays below 64: seven integer bits. Accuracy there: 12, 32 and 180 units of
/// the format's resolution.
#[must_use]
pub fn trig_basis_derivatives<R: Real>(u: R, shape: &ShapeFactors<R>) -> [[R; 4]; 3] {
    let (lambda, half_pi, three) = (shape.lambda, R::half_pi(), R::from_ratio(3, 1));
    let (s, c) = R::sin_cos_quarter(u);
    let g = lambda * (R::one() + R::one() - three * s) - three * c;
    let m = (c * c - s * s) * g + three * (c * s * (s - lambda * c));
    let first = (half_pi * (c * s * g), c * (R::one() + s * g), s * (R::one() + c * g));
    let second = (half_pi * (half_pi * m), half_pi * (m - s), half_pi * (m + c));
    [
        trig_basis(u, shape),
        by_control_points(first.0, first.1, first.2, shape),
        by_control_points(second.0, second.1, second.2, shape),
    ]
}

/// Collects a combination of H_00, H_10 and H_11 by control points. q_1 gets, besides the constant 1, the sum of the
/// others' factors with opposite sign, so that the sum of all is exact.
fn by_control_points<R: Real>(h00: R, h10: R, h11: R, shape: &ShapeFactors<R>) -> [R; 4] {
    let k = shape.k;
    let b0 = h00 - h10;
    let b2 = h11 + k * (h11 - h10);
    let b3 = -(k * h11);
    [b0, -(b0 + b2 + b3), b2, b3]
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;
    use real::{Backend, DoubleDouble, I8F24, I16F48, I32F32};

    fn shape<R: Backend>(lambda: f64, k: f64) -> ShapeFactors<R> {
        ShapeFactors { lambda: R::from_f64(lambda).unwrap(), k: R::from_f64(k).unwrap() }
    }

    /// Largest error of values, first and second derivatives against the double-double, and how far the values' sum is
    /// from 1, all in units of the resolution.
    fn errors<R: Backend>(u: f64, lambda: f64, k: f64) -> ([f64; 3], f64) {
        let exactly = |x: R| DoubleDouble::new(x.to_f64_pair().0, x.to_f64_pair().1);
        let (u, shape) = (R::from_f64(u).unwrap(), shape::<R>(lambda, k));
        let found = trig_basis_derivatives(u, &shape);
        let exact_shape = ShapeFactors { lambda: exactly(shape.lambda), k: exactly(shape.k) };
        let exact = trig_basis_derivatives(exactly(u), &exact_shape);
        let unit = R::resolution().to_f64();
        let error = |order: usize| {
            let pairs = found[order].iter().zip(exact[order]);
            pairs.map(|(f, e)| (exactly(*f) - e).value().abs() / unit).fold(0.0, f64::max)
        };
        let sum = found[0].iter().fold(R::zero(), |sum, b| sum + *b);
        ([error(0), error(1), error(2)], (sum - R::one()).to_f64().abs() / unit)
    }

    fn check<R: Backend>(u: f64, lambda: f64, k: f64) -> Result<(), TestCaseError> {
        let (errors, sum) = errors::<R>(u, lambda, k);
        let bounds = [12.0, 32.0, 180.0];
        prop_assert!(errors.iter().zip(bounds).all(|(e, bound)| *e <= bound), "{}: {errors:?}", R::name());
        let fixed = matches!(R::name(), real::FormatName::Fixed { .. });
        prop_assert!(sum <= if fixed { 0.0 } else { 4.0 }, "{}: sum off by {sum}", R::name());
        Ok(())
    }

    /// Where the second derivative is least accurate, in a corner of the shape factors' range.
    #[test]
    fn every_format_is_within_them_near_the_edge() {
        let worst = (0..20_000).map(|i| {
            let share = |n: i32| f64::from(i / n % 10) / 10.0;
            let (u, lambda, k) =
                (0.05 * share(1) + 1e-3 * share(1000), 2.0 - 0.2 * share(10), 2.0 - 0.2 * share(100));
            [(lambda, k), (-lambda, k), (lambda, -k), (-lambda, -k)]
                .map(|(l, k)| errors::<I32F32>(u, l, k).0[2])
        });
        let worst = worst.flatten().fold(0.0, f64::max);
        assert!((120.0..=180.0).contains(&worst), "{worst}");
    }

    proptest! {
        #![proptest_config(ProptestConfig::with_cases(1000))]

        #[test]
        fn every_format_is_within_the_documented_units(u in 0.0..=1.0, lambda in -2.0..=2.0, k in -2.0..=2.0) {
            check::<f64>(u, lambda, k)?;
            check::<f32>(u, lambda, k)?;
            check::<I8F24>(u, lambda, k)?;
            check::<I32F32>(u, lambda, k)?;
            check::<I16F48>(u, lambda, k)?;
        }

        #[test]
        fn derivatives_are_those_of_the_values(u in 0.01..0.99, lambda in -2.0..2.0, k in -2.0..2.0) {
            // Central differences in double-double: h² of 1e-16 leaves ten digits and more.
            let dd = DoubleDouble::from;
            let (h, shape) = (1e-8, ShapeFactors { lambda: dd(lambda), k: dd(k) });
            let at = |offset: f64| trig_basis_derivatives(dd(u) + dd(offset), &shape);
            let (before, here, after) = (at(-h), at(0.0), at(h));
            for order in 0..2 {
                for j in 0..4 {
                    let difference = (after[order][j] - before[order][j]) / dd(2.0 * h);
                    let error = (difference - here[order + 1][j]).value().abs();
                    prop_assert!(error < 1e-13, "order {order}, j={j}: {error}");
                }
            }
        }

        #[test]
        fn ends_are_exact_in_every_format(lambda in -2.0..2.0, k in -2.0..2.0) {
            fn ends<R: Backend>(lambda: f64, k: f64) -> bool {
                let (zero, one, shape) = (R::zero(), R::one(), shape(lambda, k));
                trig_basis(zero, &shape) == [one, zero, zero, zero] && trig_basis(one, &shape) == [zero, one, zero, zero]
            }
            let all = [
                ends::<f64>(lambda, k),
                ends::<f32>(lambda, k),
                ends::<I8F24>(lambda, k),
                ends::<I16F48>(lambda, k),
                ends::<DoubleDouble>(lambda, k),
            ];
            prop_assert_eq!(all, [true; 5]);
        }

        #[test]
        fn only_lambda_1_is_symmetric(u in 0.1..0.45_f64, lambda in -2.0..2.0_f64) {
            // Reversing u exchanges q_0 with q_1 and turns the derivatives round: H_00(1 - u) = 1 - H_00(u), H_10(1 - u) = -H_11(u).
            let with_k_0 = |u: f64, lambda: f64| trig_basis(u, &ShapeFactors { lambda, k: 0.0 });
            let skew = |lambda: f64| {
                let (here, there) = (with_k_0(u, lambda), with_k_0(1.0 - u, lambda));
                // With k = 0: B_0 = H_00 - H_10, B_2 = H_11.
                let h00 = |b: [f64; 4], mirrored: [f64; 4]| b[0] - mirrored[2];
                h00(here, there) + h00(there, here) - 1.0
            };
            prop_assert!(skew(1.0).abs() <= 4.0 * f64::EPSILON, "{}", skew(1.0));
            prop_assert!(skew(lambda).abs() >= 5e-3 * (lambda - 1.0).abs(), "{}", skew(lambda));
        }
    }

    #[test]
    fn the_documented_integer_bits_never_overflow() {
        use real::{Audit, Audited};
        type Narrow = real::FixedPoint<fixed::types::I3F29>;
        type Wide = real::FixedPoint<fixed::types::I7F25>;
        let ((), audit) = Audit::of(|| {
            for step in 0..=100 {
                for factors in [(2.0, 2.0), (2.0, -2.0), (-2.0, 2.0), (-2.0, -2.0), (0.5, -1.0)] {
                    let _ =
                        trig_basis(Audited::<Narrow>::from_ratio(step, 100), &shape(factors.0, factors.1));
                    let wide = Audited::<Wide>::from_ratio(step, 100);
                    let _ = trig_basis_derivatives(wide, &shape(factors.0, factors.1));
                }
            }
        });
        assert_eq!(audit.overflows, 0);
    }
}
