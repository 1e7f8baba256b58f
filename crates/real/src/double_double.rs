//! The reference: numbers of about 106 bits, each the sum of two `f64`.

use core::ops::{Add, Div, Mul, Neg, Sub};

use num_traits::{Bounded, One, Zero};

use crate::{Backend, FormatName, Real};

/// A double-double number: the sum of two floats, of which `low` is at most half a unit of `high`'s last place. It is the
/// reference that every format is compared with.
///
/// The relative error of each operation is below 1e-31, also where a sum cancels. Sums, products and quotients have the
/// bits of those of the `qd` crate; here the compiler inlines them.
///
/// # Source
/// Joldes, Muller and Popescu, "Tight and rigorous error bounds for basic building blocks of double-word arithmetic", ACM
/// Transactions on Mathematical Software 44 (2017); the sum is their algorithm 6.
#[derive(Clone, Copy, Debug, Default, PartialEq, PartialOrd)]
pub struct DoubleDouble {
    high: f64,
    low: f64,
}

/// A larger exponent of a phase counts as this one, so that powers of two stay normal numbers. This is far beyond the
/// domain.
const FARTHEST: i32 = 900;

/// `a + b`, exactly.
#[inline]
fn sum(a: f64, b: f64) -> DoubleDouble {
    let high = a + b;
    let of_b = high - a;
    DoubleDouble { high, low: (a - (high - of_b)) + (b - of_b) }
}

/// `a + b`, exactly, for `|a| ≥ |b|`.
#[inline]
fn ordered_sum(a: f64, b: f64) -> DoubleDouble {
    let high = a + b;
    DoubleDouble { high, low: b - (high - a) }
}

/// `a b`, exactly.
#[inline]
fn product(a: f64, b: f64) -> DoubleDouble {
    let high = a * b;
    DoubleDouble { high, low: a.mul_add(b, -high) }
}

impl DoubleDouble {
    /// The number `high + low`.
    #[must_use]
    #[inline]
    pub fn new(high: f64, low: f64) -> Self {
        sum(high, low)
    }

    /// The nearest `f64`.
    #[must_use]
    #[inline]
    pub fn value(self) -> f64 {
        self.high
    }
}

impl From<f64> for DoubleDouble {
    #[inline]
    fn from(value: f64) -> Self {
        Self { high: value, low: 0.0 }
    }
}

impl Add for DoubleDouble {
    type Output = Self;
    #[inline]
    fn add(self, other: Self) -> Self {
        let (high, low) = (sum(self.high, other.high), sum(self.low, other.low));
        let once = ordered_sum(high.high, high.low + low.high);
        ordered_sum(once.high, once.low + low.low)
    }
}

impl Sub for DoubleDouble {
    type Output = Self;
    #[inline]
    fn sub(self, other: Self) -> Self {
        self + -other
    }
}

impl Mul for DoubleDouble {
    type Output = Self;
    #[inline]
    fn mul(self, other: Self) -> Self {
        let exact = product(self.high, other.high);
        let low = self.high.mul_add(other.low, exact.low);
        ordered_sum(exact.high, self.low.mul_add(other.high, low))
    }
}

impl Div for DoubleDouble {
    type Output = Self;
    /// Long division with three digits, each a float.
    #[inline]
    fn div(self, other: Self) -> Self {
        let first = self.high / other.high;
        let rest = self - other * Self::from(first);
        let second = rest.high / other.high;
        let rest = rest - other * Self::from(second);
        ordered_sum(first, second) + Self::from(rest.high / other.high)
    }
}

impl Neg for DoubleDouble {
    type Output = Self;
    #[inline]
    fn neg(self) -> Self {
        Self { high: -self.high, low: -self.low }
    }
}

impl Zero for DoubleDouble {
    #[inline]
    fn zero() -> Self {
        Self::from(0.0)
    }
    #[inline]
    fn is_zero(&self) -> bool {
        self.high == 0.0
    }
}

impl One for DoubleDouble {
    #[inline]
    fn one() -> Self {
        Self::from(1.0)
    }
}

impl Bounded for DoubleDouble {
    fn min_value() -> Self {
        Self::from(f64::MIN)
    }
    fn max_value() -> Self {
        Self::from(f64::MAX)
    }
}

impl Real for DoubleDouble {
    const IS_FLOATING: bool = true;

    fn resolution() -> Self {
        Self::from(f64::EPSILON * f64::EPSILON)
    }

    #[inline]
    fn from_ratio(numerator: i32, denominator: i32) -> Self {
        let numerator = Self::from(f64::from(numerator));
        // Most ratios in the formulas of a plan are whole numbers, and a quotient is the dearest operation.
        if denominator == 1 { numerator } else { numerator / Self::from(f64::from(denominator)) }
    }

    #[inline]
    fn mul_add(self, factor: Self, addend: Self) -> Self {
        self * factor + addend
    }

    #[inline]
    fn sum_of_products(pairs: impl IntoIterator<Item = (Self, Self)>) -> Self {
        let products = pairs.into_iter().map(|(a, b)| a * b);
        products.reduce(|sum, product| sum + product).unwrap_or_default()
    }

    #[inline]
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

    /// The root of the high float, and one step of Newton's from it: `r + (x - r²)/(2r)`.
    #[inline]
    fn sqrt(self) -> Self {
        if self.high <= 0.0 {
            return Self::zero();
        }
        let root = self.high.sqrt();
        let rest = self - product(root, root);
        ordered_sum(root, rest.high / (2.0 * root))
    }

    #[inline]
    fn ldexp(self, exponent: i32) -> Self {
        Self { high: self.high.ldexp(exponent), low: self.low.ldexp(exponent) }
    }

    #[inline]
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
        let whole = scaled.high.clamp(0.0, 2.0_f64.powi(64)).trunc() as u128;
        let rest = (scaled
            - Self::new((whole >> 32) as f64 * 2.0_f64.powi(32), (whole & 0xffff_ffff) as f64))
        .value();
        let floor = whole.saturating_add_signed(rest.floor() as i128);
        u64::try_from(floor).unwrap_or(u64::MAX)
    }

    #[inline]
    fn is_finite(self) -> bool {
        self.high.is_finite() && self.low.is_finite()
    }
}

impl Backend for DoubleDouble {
    fn name() -> FormatName {
        FormatName::DoubleDouble
    }

    fn from_f64_pair(high: f64, low: f64) -> Option<Self> {
        Some(Self::new(high, low)).filter(|x| x.is_finite())
    }

    #[inline]
    fn to_f64_pair(self) -> (f64, f64) {
        (self.high, self.low)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;
    use qd::Quad;

    /// A number of either sign, and any low part that it may have.
    fn number() -> impl Strategy<Value = DoubleDouble> {
        let high = (-60..60_i32, 1.0_f64..2.0, any::<bool>());
        (high, -0.5_f64..=0.5).prop_map(|((exponent, size, negative), low)| {
            let high = size.ldexp(exponent) * if negative { -1.0 } else { 1.0 };
            DoubleDouble::new(high, low * f64::EPSILON * high)
        })
    }

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
        /// The bits are those of the crate, whose functions a compiler does not inline.
        #[test]
        fn sums_products_and_quotients_are_those_of_qd(a in number(), b in number(), near in -4..=4_i32) {
            let quad = |x: DoubleDouble| Quad(x.high, x.low);
            // A difference that cancels, too.
            let close = DoubleDouble { high: a.high, low: a.low + f64::from(near) * 1e-17 * a.high };
            for b in [b, DoubleDouble::new(close.high, close.low)] {
                prop_assert_eq!(quad(a + b), quad(a).add_accurate(quad(b)));
                prop_assert_eq!(quad(a - b), quad(a).sub_accurate(quad(b)));
                prop_assert_eq!(quad(a * b), quad(a).mul(quad(b)));
                prop_assert_eq!(quad(a / b), quad(a).div(quad(b)));
            }
        }

        /// The relative error is below 1e-31: 2⁻¹⁰³.
        #[test]
        fn the_root_is_within_the_bound_of_operations(x in number()) {
            let x = if x < DoubleDouble::zero() { -x } else { x };
            let root = x.sqrt();
            // r² - x, exact to 2⁻¹⁵⁶ of x: the square of the low part, and what its product with the high part drops.
            let (square, cross) = (product(root.high, root.high), product(2.0 * root.high, root.low));
            let rest = [square.high - x.high, cross.high, square.low - x.low, cross.low, root.low * root.low];
            let off = rest.into_iter().map(DoubleDouble::from).fold(DoubleDouble::zero(), Add::add);
            let relative = (off / x).value().abs() / 2.0;
            prop_assert!(relative < 1e-31, "{x:?}: {relative}");
        }

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
