//! The 16-, 32- and 64-bit formats on random operands, against exact integers.
//!
//! A rounded result r of an exact value x is checked by what "nearest" means, `-½ < r - x ≤ ½` for ties up, and not by
//! computing it again. In units of the square of the resolution every exact value below is an integer of i128.

#![allow(
    clippy::cast_possible_truncation,
    clippy::cast_possible_wrap,
    clippy::cast_sign_loss,
    reason = "exact integers are cut to words to see what wraps"
)]

use num_traits::{Bounded, One, Zero};
use proptest::prelude::*;
use real::{Backend, I2F30, I4F28, I4F60, I8F24, I12F20, I16F16, I16F48, I32F32, Real};

/// Words of every size, the extremes among them.
fn word() -> impl Strategy<Value = i64> {
    let edge = prop::sample::select(vec![0, 1, -1, 2, i64::MAX, i64::MAX - 1, i64::MIN, i64::MIN + 1]);
    prop_oneof![
        8 => (any::<i64>(), 0_u32..64).prop_map(|(x, size)| x >> size),
        1 => edge,
        1 => (0_u32..63).prop_map(|size| 1 << size),
    ]
}

/// `rounded` is what is nearest to `exact / unit`, a tie going up.
fn is_nearest_ties_up(rounded: i128, exact: i128, unit: i128) -> bool {
    let twice = 2 * (rounded * unit - exact);
    -unit < twice && twice <= unit
}

/// `rounded` is what is nearest to `√square`.
fn is_nearest_root(rounded: u128, square: u128) -> bool {
    square <= rounded * rounded + rounded && (rounded == 0 || square > rounded * rounded - rounded)
}

macro_rules! exact {
    ($module:ident, $format:ident, $word:ident, $fraction_bits:literal) => {
        mod $module {
            use super::*;

            const UNIT: i128 = 1 << $fraction_bits;
            const LEAST: i128 = $word::MIN as i128;
            const GREATEST: i128 = $word::MAX as i128;

            /// The leading bits of a random word, which keeps its extremes, or the trailing ones.
            fn number() -> impl Strategy<Value = $format> {
                let shift = prop::sample::select(vec![64 - $word::BITS, 0]);
                (word(), shift).prop_map(|(x, shift)| $format::from_bits((x >> shift) as $word))
            }

            fn exact(x: $format) -> i128 {
                x.to_bits().into()
            }

            /// `found` is the number whose word is nearest to `value / 2^f`, wrapped.
            fn is_nearest_wrapped(found: $format, value: i128) -> bool {
                // The bits that were lost are those of the floor, give or take the carry of the rounding.
                let floor = value.div_euclid(UNIT);
                [floor, floor + 1].iter().any(|&r| r as $word == found.to_bits() && is_nearest_ties_up(r, value, UNIT))
            }

            proptest! {
                #![proptest_config(ProptestConfig::with_cases(2_000))]

                #[test]
                fn sums_wrap(a in number(), b in number()) {
                    prop_assert_eq!((a + b).to_bits(), (exact(a) + exact(b)) as $word);
                    prop_assert_eq!((a - b).to_bits(), (exact(a) - exact(b)) as $word);
                    prop_assert_eq!((-a).to_bits(), (-exact(a)) as $word);
                }

                #[test]
                fn products_are_nearest_and_wrap(a in number(), b in number(), c in number(), d in number()) {
                    prop_assert!(is_nearest_wrapped(a * b, exact(a) * exact(b)));
                    prop_assert!(is_nearest_wrapped(a.mul_add(b, c), exact(a) * exact(b) + exact(c) * UNIT));
                    let c = $format::from_bits(c.to_bits() / 2); // four extremes would make 2^127
                    let sum = exact(a) * exact(b) + exact(c) * exact(d);
                    prop_assert!(is_nearest_wrapped($format::sum_of_products([(a, b), (c, d)]), sum));
                }

                #[test]
                fn quotients_are_nearest_and_saturate(a in number(), b in number()) {
                    let quotient = exact(a / b);
                    if b.is_zero() {
                        prop_assert_eq!(quotient, [LEAST, 0, GREATEST][(exact(a).signum() + 1) as usize]);
                        return Ok(());
                    }
                    // In magnitudes: away from zero is up.
                    let (n, d) = (exact(a).abs() * UNIT, exact(b).abs());
                    let sign = exact(a).signum() * exact(b).signum();
                    let magnitude = quotient * sign;
                    match quotient {
                        GREATEST if sign > 0 => prop_assert!(2 * n >= (2 * GREATEST - 1) * d),
                        LEAST if sign < 0 => prop_assert!(2 * n >= (2 * -LEAST - 1) * d),
                        _ => prop_assert!(is_nearest_ties_up(magnitude, n, d), "{} / {}: {}", n, d, magnitude),
                    }
                }

                #[test]
                fn roots_and_norms_are_nearest(a in number(), b in number(), c in number()) {
                    let root = a.sqrt().to_bits().unsigned_abs().into();
                    prop_assert!(is_nearest_root(root, (exact(a).max(0) * UNIT).unsigned_abs()));
                    let squares = [a, b, c].iter().map(|x| exact(*x).pow(2).unsigned_abs()).sum();
                    let norm = u128::from($format::norm(&[a, b, c]).to_bits().unsigned_abs());
                    if norm == GREATEST.unsigned_abs() {
                        prop_assert!(squares > norm * norm - norm);
                    } else {
                        prop_assert!(is_nearest_root(norm, squares));
                    }
                }

                #[test]
                fn scaling_is_nearest_and_wraps(a in number(), exponent in -126..=126) {
                    let scaled = a.ldexp(exponent);
                    if exponent >= 0 {
                        let wrapped = if exponent < 64 { exact(a) << exponent } else { 0 };
                        prop_assert_eq!(scaled.to_bits(), wrapped as $word);
                    } else {
                        let unit = 1 << (-exponent).min(100); // beyond 2^65 all is below half a unit
                        prop_assert!(is_nearest_ties_up(exact(scaled), exact(a), unit));
                    }
                }

                #[test]
                fn ratios_are_nearest_and_saturate(n: i32, d: i32, size in 0_u32..32) {
                    let d = d >> size;
                    prop_assume!(d != 0);
                    let ratio = exact($format::from_ratio(n, d));
                    let (n, d, sign) = (i128::from(n).abs() * UNIT, i128::from(d).abs(), i128::from(n.signum() * d.signum()));
                    match ratio {
                        GREATEST if sign > 0 => prop_assert!(2 * n >= (2 * GREATEST - 1) * d),
                        LEAST if sign < 0 => prop_assert!(2 * n >= (2 * -LEAST - 1) * d),
                        _ => prop_assert!(is_nearest_ties_up(ratio * sign, n, d)),
                    }
                }

                #[test]
                fn floats_give_the_number_back(a in number()) {
                    let (high, low) = a.to_f64_pair();
                    prop_assert_eq!($format::from_f64_pair(high, low), Some(a));
                    prop_assert_eq!(high + low, high, "the pair is not normalised");
                    prop_assert_eq!(a.to_f64(), exact(a) as f64 / UNIT as f64);
                    let units = |part: f64| (part * UNIT as f64) as i128; // a power of two: exact
                    prop_assert_eq!(units(high) + units(low), exact(a));
                }

                /// A number, a quarter, a half and three quarters of a unit: to nearest, ties to even.
                #[test]
                fn floats_go_to_nearest_ties_to_even(a in number(), quarters in 0..4_i32) {
                    let (high, low) = a.to_f64_pair();
                    let unit = 2.0_f64.powi(-$fraction_bits);
                    let rest = low + f64::from(quarters) * unit / 4.0;
                    let sum = high + rest;
                    let (high, low) = (sum, if high.abs() > rest.abs() { rest - (sum - high) } else { high - (sum - rest) });
                    let up = quarters == 3 || (quarters == 2 && exact(a) & 1 == 1);
                    let expected = $word::try_from(exact(a) + i128::from(up)).ok();
                    prop_assert_eq!($format::from_f64_pair(high, low).map(|x| x.to_bits()), expected);
                }
            }

            #[test]
            fn constants() {
                assert_eq!(exact($format::one()), UNIT);
                assert_eq!(exact($format::resolution()), 1);
                assert_eq!((exact($format::min_value()), exact($format::max_value())), (LEAST, GREATEST));
                assert_eq!($format::name().bits(), $word::BITS);
                assert_eq!($format::name().to_string(), stringify!($format));
            }
        }
    };
}

type I8F8 = real::FixedPoint<fixed::types::I8F8>;
type I2F62 = real::FixedPoint<fixed::types::I2F62>;
type I64F0 = real::FixedPoint<fixed::types::I64F0>;

exact!(i8f8, I8F8, i16, 8);
exact!(i16f16, I16F16, i32, 16);
exact!(i12f20, I12F20, i32, 20);
exact!(i8f24, I8F24, i32, 24);
exact!(i4f28, I4F28, i32, 28);
exact!(i2f30, I2F30, i32, 30);
exact!(i32f32, I32F32, i64, 32);
exact!(i16f48, I16F48, i64, 48);
exact!(i4f60, I4F60, i64, 60);
exact!(i2f62, I2F62, i64, 62);
exact!(i64f0, I64F0, i64, 0);
