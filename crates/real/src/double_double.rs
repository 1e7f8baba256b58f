//! The reference: numbers of about 106 bits, each the sum of two `f64`.

use core::ops::{Add, Div, Mul, Neg, Sub};

use num_traits::{Bounded, One, Zero};
use qd::Quad;

use crate::{Backend, FormatName, Real};

/// A double-double number of the `qd` crate, as a [`Real`]: the reference that every format is compared with.
///
/// The relative error of each operation is below 1e-31. The crate's quick addition would exceed that under
/// cancellation, and is not used.
#[derive(Clone, Copy, Debug, PartialEq, PartialOrd)]
pub struct DoubleDouble(Quad);

impl Default for DoubleDouble {
    fn default() -> Self {
        Self::zero()
    }
}

/// A larger exponent of a phase counts as this one, so that powers of two stay normal numbers. This is far beyond the
/// domain.
const FARTHEST: i32 = 900;

impl DoubleDouble {
    /// The number `high + low`.
    #[must_use]
    pub fn new(high: f64, low: f64) -> Self {
        Self(Quad::from_f64(high).add_accurate(Quad::from_f64(low)))
    }

    /// The nearest `f64`.
    #[must_use]
    pub fn value(self) -> f64 {
        self.0.0
    }
}

impl From<f64> for DoubleDouble {
    fn from(value: f64) -> Self {
        Self(Quad::from_f64(value))
    }
}

impl Add for DoubleDouble {
    type Output = Self;
    fn add(self, other: Self) -> Self {
        Self(self.0.add_accurate(other.0))
    }
}

impl Sub for DoubleDouble {
    type Output = Self;
    fn sub(self, other: Self) -> Self {
        Self(self.0.sub_accurate(other.0))
    }
}

impl Mul for DoubleDouble {
    type Output = Self;
    fn mul(self, other: Self) -> Self {
        Self(self.0.mul(other.0))
    }
}

impl Div for DoubleDouble {
    type Output = Self;
    fn div(self, other: Self) -> Self {
        Self(self.0.div(other.0))
    }
}

impl Neg for DoubleDouble {
    type Output = Self;
    fn neg(self) -> Self {
        Self(self.0.neg())
    }
}

impl Zero for DoubleDouble {
    fn zero() -> Self {
        Self(Quad::from_f64(0.0))
    }
    fn is_zero(&self) -> bool {
        self.0.0 == 0.0
    }
}

impl One for DoubleDouble {
    fn one() -> Self {
        Self(Quad::from_f64(1.0))
    }
}

impl Bounded for DoubleDouble {
    fn min_value() -> Self {
        Self(Quad::from_f64(f64::MIN))
    }
    fn max_value() -> Self {
        Self(Quad::from_f64(f64::MAX))
    }
}

impl Real for DoubleDouble {
    const IS_FLOATING: bool = true;

    fn resolution() -> Self {
        Self(Quad::from_f64(f64::EPSILON * f64::EPSILON))
    }

    fn from_ratio(numerator: i32, denominator: i32) -> Self {
        Self::from(f64::from(numerator)) / Self::from(f64::from(denominator))
    }

    fn mul_add(self, factor: Self, addend: Self) -> Self {
        self * factor + addend
    }

    fn sum_of_products(pairs: impl IntoIterator<Item = (Self, Self)>) -> Self {
        pairs.into_iter().fold(Self::zero(), |sum, (a, b)| sum + a * b)
    }

    fn norm<const N: usize>(vector: &[Self; N]) -> Self {
        // All components are scaled by one power of two, which the largest of them decides. Squares, and the digits
        // that multiplications drop, then stay far from both ends of the range.
        let largest = vector.iter().fold(0.0, |largest: f64, v| largest.max(v.value().abs()));
        let exponent = match largest {
            x if x > 1e100 => -600,
            x if x < 1e-100 => 600,
            _ => return Self::sqrt(Self::sum_of_products(vector.iter().map(|v| (*v, *v)))),
        };
        let scaled = vector.iter().map(|v| v.ldexp(exponent)).map(|v| (v, v));
        Self::sqrt(Self::sum_of_products(scaled)).ldexp(-exponent)
    }

    fn sqrt(self) -> Self {
        if self < Self::zero() { Self::zero() } else { Self(self.0.sqrt()) }
    }

    fn ldexp(self, exponent: i32) -> Self {
        Self(Quad(self.0.0.ldexp(exponent), self.0.1.ldexp(exponent)))
    }

    #[allow(clippy::cast_precision_loss, reason = "each half of the phase has 32 bits")]
    fn from_phase(phase: u64, exponent: i32) -> Self {
        let exponent = exponent.clamp(-FARTHEST, FARTHEST);
        let (high, low) = ((phase >> 32) as f64, (phase & 0xffff_ffff) as f64);
        Self::new(high.ldexp(exponent - 32), low.ldexp(exponent - 64))
    }

    #[allow(
        clippy::cast_possible_truncation,
        clippy::cast_sign_loss,
        reason = "saturates, as the contract says"
    )]
    fn to_phase(self, exponent: i32) -> u64 {
        let scaled = self.ldexp(64 + exponent.clamp(-FARTHEST, FARTHEST));
        let whole = scaled.0.0.clamp(0.0, 2.0_f64.powi(64)).trunc() as u128;
        let rest = (scaled
            - Self::new((whole >> 32) as f64 * 2.0_f64.powi(32), (whole & 0xffff_ffff) as f64))
        .value();
        let floor = whole.saturating_add_signed(rest.floor() as i128);
        u64::try_from(floor).unwrap_or(u64::MAX)
    }

    fn is_finite(self) -> bool {
        self.0.is_finite()
    }
}

impl Backend for DoubleDouble {
    fn name() -> FormatName {
        FormatName::DoubleDouble
    }

    fn from_f64_pair(high: f64, low: f64) -> Option<Self> {
        Some(Self::new(high, low)).filter(|x| x.is_finite())
    }

    fn to_f64_pair(self) -> (f64, f64) {
        (self.0.0, self.0.1)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    /// `a / b · b - a`, relative: the test that another double-double crate's division fails by 1e-16.
    fn division_residual(a: f64, b: f64) -> f64 {
        let (a, b) = (DoubleDouble::from(a), DoubleDouble::from(b));
        ((a / b * b - a) / a).value().abs()
    }

    #[test]
    fn norm_survives_components_whose_squares_do_not() {
        for size in [1e250, 1.0, 1e-250] {
            let (three, four) = (DoubleDouble::from(3.0 * size), DoubleDouble::from(4.0 * size));
            let error = (DoubleDouble::norm(&[three, four]) / DoubleDouble::from(size)).value() - 5.0;
            assert!(error.abs() <= 1e-15, "size={size}: {error}");
        }
        assert!(DoubleDouble::norm(&[DoubleDouble::from(f64::NAN), DoubleDouble::one()]).value().is_nan());
        assert!(DoubleDouble::from(-1.0).sqrt().is_zero());
    }

    #[test]
    fn phases_of_any_exponent_are_numbers() {
        for exponent in [i32::MIN, i32::MIN + 1, -2000, 2000, i32::MAX - 1, i32::MAX] {
            let part = DoubleDouble::one().to_phase(exponent);
            assert_eq!(part, if exponent < 0 { 0 } else { u64::MAX }, "{exponent}");
            for number in [DoubleDouble::from_phase(1, exponent), DoubleDouble::power_of_two(exponent)] {
                let far = if exponent < 0 { number.value() < 1e-250 } else { number.value() > 1e250 };
                assert!(far && number > DoubleDouble::zero(), "{exponent}: {number:?}");
            }
        }
        assert_eq!(DoubleDouble::power_of_two(-3).value(), 0.125);
    }

    proptest! {
        #[test]
        fn division_undoes_multiplication(a in 1e-3..1e3, b in 1e-3..1e3) {
            prop_assert!(division_residual(a, b) < 1e-30);
        }

        #[test]
        fn root_squares_to_its_argument(a in 1e-6..1e6) {
            let root = DoubleDouble::from(a).sqrt();
            let residual = (root * root - DoubleDouble::from(a)).value().abs() / a;
            prop_assert!(residual < 1e-30, "a={a}: {residual}");
        }

        #[test]
        fn addition_keeps_its_precision_under_cancellation(a in 0.5_f64..2.0, small in 1e-20_f64..1e-17) {
            let sum = DoubleDouble::from(a) + DoubleDouble::from(small);
            let rest: f64 = (sum - DoubleDouble::from(a)).value();
            prop_assert!((rest - small).abs() <= small * 1e-14);
        }
    }
}
