//! Fixed-point backends: the `fixed` crate's signed types with an explicit operation family.
//!
//! The operators of the `fixed` crate panic on overflow in a debug build and wrap in release; they round products
//! toward −∞ and quotients toward 0. [`FixedPoint`] does the same in all builds. It forms products, sums of products,
//! quotients, roots and norms in twice the width and rounds them to nearest. A result that does not fit wraps in `+`,
//! `-`, `*` and saturates in `/`, `sqrt` and `norm`, as the table at [`Real`] says.

use core::ops::{Add, Div, Mul, Neg, Sub};

use fixed::traits::{Fixed, FixedSigned};
use num_traits::{AsPrimitive, Bounded, FromPrimitive, One, WrappingAdd, Zero};

use crate::real::{leading_bits, phase_of};
use crate::{Backend, FormatName, Real, Word};

/// A signed fixed-point number of the `fixed` crate, as a [`Real`].
///
/// The number is `bits · 2⁻ᶠ`. It must be able to hold 1: at least two integer bits, the sign among them.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, PartialOrd, Ord, Hash)]
#[repr(transparent)]
pub struct FixedPoint<F>(pub F);

type Bits<F> = <F as Fixed>::Bits;
type WideBits<F> = <Bits<F> as Word>::Wide;

impl<F: FixedSigned> FixedPoint<F>
where
    F::Bits: Word,
{
    const FRACTION_BITS: usize = {
        assert!(F::INT_NBITS >= 2, "the format cannot hold 1");
        F::FRAC_NBITS as usize
    };

    const BITS: usize = (F::INT_NBITS + F::FRAC_NBITS) as usize;

    /// Whether the machine has registers of twice the width.
    const WIDE_IS_A_REGISTER: bool = 2 * Self::BITS <= usize::BITS as usize;

    /// Whether a phase is best put together from words of the format's own width.
    const IN_HALVES: bool = Self::BITS == 32 && usize::BITS == 32;

    /// The number `bits · 2⁻ᶠ`.
    #[inline]
    #[must_use]
    pub fn from_bits(bits: F::Bits) -> Self {
        Self(F::from_bits(bits))
    }

    /// The word that holds the number.
    #[inline]
    #[must_use]
    pub fn to_bits(self) -> F::Bits {
        self.0.to_bits()
    }

    #[inline]
    fn wide(self) -> WideBits<F> {
        self.0.to_bits().as_()
    }

    /// The exact product, in units of 2⁻²ᶠ.
    #[inline]
    fn product(self, factor: Self) -> WideBits<F> {
        self.0.to_bits().product(factor.0.to_bits())
    }

    /// Keeps the low bits: a result that does not fit wraps.
    #[inline]
    fn wrap(wide: WideBits<F>) -> Self {
        Self(F::from_bits(wide.as_()))
    }

    /// A product or a sum of products as a number: to nearest, ties up.
    #[inline]
    fn rounded(sum: WideBits<F>) -> Self {
        Self(F::from_bits(Bits::<F>::rounded(sum, F::FRAC_NBITS)))
    }

    /// Drops one bit more than `less_one`, to nearest and ties up.
    #[inline(always)]
    fn lowered_by(bits: F::Bits, less_one: u32) -> Self {
        // The last bit dropped says whether to round up: half a unit added to the bits might not fit the word.
        let twice = bits >> less_one as usize;
        Self(F::from_bits((twice >> 1) + (twice & Bits::<F>::one())))
    }

    /// Drops `shift` bits, rounding to nearest and ties up. Adding half a unit may wrap the wide word; the caller keeps
    /// at most its low half.
    #[inline]
    fn round(wide: WideBits<F>, shift: usize) -> WideBits<F> {
        if shift == 0 {
            return wide;
        }
        wide.wrapping_add(&(WideBits::<F>::one() << (shift - 1))) >> shift
    }
}

impl<F: FixedSigned> Add for FixedPoint<F> {
    type Output = Self;
    #[inline]
    fn add(self, other: Self) -> Self {
        Self(self.0.wrapping_add(other.0))
    }
}

impl<F: FixedSigned> Sub for FixedPoint<F> {
    type Output = Self;
    #[inline]
    fn sub(self, other: Self) -> Self {
        Self(self.0.wrapping_sub(other.0))
    }
}

impl<F: FixedSigned> Neg for FixedPoint<F> {
    type Output = Self;
    #[inline]
    fn neg(self) -> Self {
        Self(self.0.wrapping_neg())
    }
}

impl<F: FixedSigned> Mul for FixedPoint<F>
where
    F::Bits: Word,
{
    type Output = Self;
    #[inline]
    fn mul(self, other: Self) -> Self {
        Self::rounded(self.product(other))
    }
}

impl<F: FixedSigned> Div for FixedPoint<F>
where
    F::Bits: Word,
{
    type Output = Self;
    #[inline]
    fn div(self, other: Self) -> Self {
        Self(F::from_bits(self.0.to_bits().quotient(other.0.to_bits(), F::FRAC_NBITS)))
    }
}

impl<F: FixedSigned> Zero for FixedPoint<F> {
    #[inline]
    fn zero() -> Self {
        Self(F::ZERO)
    }
    #[inline]
    fn is_zero(&self) -> bool {
        self.0 == F::ZERO
    }
}

impl<F: FixedSigned> One for FixedPoint<F>
where
    F::Bits: Word,
{
    #[inline]
    fn one() -> Self {
        Self::wrap(WideBits::<F>::one() << Self::FRACTION_BITS)
    }
}

impl<F: FixedSigned> Bounded for FixedPoint<F> {
    #[inline]
    fn min_value() -> Self {
        Self(F::MIN)
    }
    #[inline]
    fn max_value() -> Self {
        Self(F::MAX)
    }
}

impl<F: FixedSigned> Real for FixedPoint<F>
where
    F::Bits: Word,
{
    const IS_FOR_SPEED: bool = true;
    const MOST_LOWERED: u32 = F::INT_NBITS + F::FRAC_NBITS - 1;

    #[inline]
    fn resolution() -> Self {
        Self(F::DELTA)
    }

    #[inline]
    fn from_ratio(numerator: i32, denominator: i32) -> Self {
        Self(F::from_bits(Bits::<F>::ratio(numerator, denominator, F::FRAC_NBITS)))
    }

    #[inline]
    fn mul_add(self, factor: Self, addend: Self) -> Self {
        // The addend has no digits behind the last place, so that the sum is rounded where the product is.
        self * factor + addend
    }

    #[inline(always)] // Called, it would take the pairs through memory.
    fn sum_of_products(pairs: impl IntoIterator<Item = (Self, Self)>) -> Self {
        let sum =
            pairs.into_iter().fold(WideBits::<F>::zero(), |sum, (a, b)| sum.wrapping_add(&a.product(b)));
        Self::rounded(sum)
    }

    #[inline]
    fn norm<const N: usize>(vector: &[Self; N]) -> Self {
        // √(Σ (bᵢ·2⁻ᶠ)²) = √(Σ bᵢ²)·2⁻ᶠ: the root of the integer sum is the result, with no shift at all.
        Self(F::from_bits(Bits::<F>::length(vector.iter().map(|v| v.0.to_bits()))))
    }

    #[inline]
    fn sqrt(self) -> Self {
        Self(F::from_bits(self.0.to_bits().square_root(F::FRAC_NBITS)))
    }

    #[inline]
    fn ldexp(self, exponent: i32) -> Self {
        let width = F::INT_NBITS + F::FRAC_NBITS;
        if Self::WIDE_IS_A_REGISTER {
            // To the left within the wide word, and its width to the right: the same for both signs of the exponent.
            let left = exponent.cast_unsigned().wrapping_add(width);
            if left >= 2 * width {
                return Self(F::ZERO);
            }
            return Self::wrap(Self::round(self.wide() << left as usize, Self::BITS));
        }
        let bits = self.0.to_bits();
        let left = exponent.cast_unsigned();
        if left < width {
            return Self(F::from_bits(bits << left as usize));
        }
        let right = left.wrapping_neg();
        if right >= width {
            return Self(F::ZERO); // at most half a unit is left, ties up from -½
        }
        Self::lowered_by(bits, right - 1)
    }

    #[inline(always)] // A call would cost more than what it does.
    fn lowered(self, places: u8) -> Self {
        // The mask changes nothing in the domain, and spares a test for what a shift by more means.
        Self::lowered_by(self.0.to_bits(), u32::from(places).wrapping_sub(1) & Self::MOST_LOWERED)
    }

    #[inline]
    fn from_phase(phase: u64, exponent: i32) -> Self {
        let shift = 64 - exponent.clamp(-64, 64) - F::FRAC_NBITS.cast_signed();
        let distance = shift.unsigned_abs();
        let bits = match shift {
            s if s >= 0 => phase.checked_shr(distance).unwrap_or(0),
            _ if phase != 0 && distance > phase.leading_zeros() => u64::MAX,
            _ => phase.checked_shl(distance).unwrap_or(0),
        };
        Bits::<F>::from_u64(bits).map_or(Self(F::MAX), |bits| Self(F::from_bits(bits)))
    }

    #[inline]
    fn fraction_of(product: u128, shift: u32) -> Self {
        if Self::IN_HALVES && shift >= F::FRAC_NBITS {
            return Self(F::from_bits(Bits::<F>::of_last_bits(leading_bits(product, shift - F::FRAC_NBITS))));
        }
        Self::fraction(phase_of(product, shift))
    }

    #[inline]
    fn to_phase(self, exponent: i32) -> u64 {
        let bits: u64 = self.0.to_bits().as_(); // of a negative number the first bit is set
        let left = (64 - F::FRAC_NBITS.cast_signed()).wrapping_add(exponent);
        if Self::IN_HALVES && (1..32).contains(&left) && self.0 >= F::ZERO {
            return phase_by_halves(bits, left.cast_unsigned());
        }
        // A positive number of W bits has W - 1 digits: a shift to the left by up to 65 - W bits loses none. For W = 64
        // that is a single shift, which is not worth the question.
        let few = 65_i32.wrapping_sub_unsigned(F::INT_NBITS + F::FRAC_NBITS);
        if few > 1 && (1..=few).contains(&left) && self.0 >= F::ZERO {
            return bits << left;
        }
        if (1..64).contains(&left) && (bits << left) >> left == bits {
            return bits << left;
        }
        if (-63..1).contains(&left) && bits.leading_zeros() > 0 {
            return bits >> left.unsigned_abs();
        }
        if left > 0 && self.0 > F::ZERO { u64::MAX } else { 0 }
    }

    #[inline]
    fn is_finite(self) -> bool {
        true
    }
}

/// `bits << left` of a number that is not negative, for 1 to 31 places: a shift of 64 bits by any number of places takes three times as
/// many instructions on a machine of 32 bits.
#[inline]
#[allow(clippy::cast_possible_truncation, reason = "a word of 32 bits")]
fn phase_by_halves(bits: u64, left: u32) -> u64 {
    let low = bits as u32;
    let (left, right) = (left & 31, left.wrapping_neg() & 31);
    (u64::from(low >> right) << 32) | u64::from(low << left)
}

impl<F: FixedSigned + Send + Sync> Backend for FixedPoint<F>
where
    F::Bits: Word,
{
    fn name() -> FormatName {
        FormatName::fixed(F::INT_NBITS, F::FRAC_NBITS)
    }

    fn from_f64_pair(high: f64, low: f64) -> Option<Self> {
        let exponent = F::FRAC_NBITS.cast_signed();
        let word = Bits::<F>::nearest(high.ldexp(exponent), low.ldexp(exponent))?;
        Some(Self(F::from_bits(word)))
    }

    #[inline]
    fn to_f64_pair(self) -> (f64, f64) {
        let (high, low) = self.0.to_bits().split();
        let exponent = -F::FRAC_NBITS.cast_signed();
        (high.ldexp(exponent), low.ldexp(exponent))
    }

    #[inline]
    fn word(self) -> Option<i64> {
        Some(self.0.to_bits().widened())
    }
}

#[cfg(test)]
mod tests {
    use crate::{Backend, I2F30, I4F28, I4F60, I16F16, Real};
    use num_traits::Bounded;
    use proptest::prelude::*;

    #[test]
    fn phases_are_fractions() {
        assert_eq!(I16F16::from_phase(1 << 63, 0).to_f64(), 0.5);
        assert_eq!(I4F60::from_phase(u64::MAX, 0).to_f64_pair(), (1.0, -1.0 / 2.0_f64.powi(60)));
        assert_eq!(I4F28::from_phase(1 << 60, 6).to_f64(), 4.0);
        assert_eq!(I4F28::from_phase(1 << 60, 7), I4F28::max_value());
        assert_eq!(I4F28::from_phase(5, 36).0.to_bits(), 5);
        let x = I4F28::from_f64(0.75).unwrap();
        assert_eq!(x.to_phase(0), 3 << 62);
        assert_eq!(x.to_phase(-40), 3 << 22);
        assert_eq!(x.to_phase(-64), 0);
        assert_eq!((-x).to_phase(0), 0);
        assert_eq!(I4F28::default().to_phase(64), 0); // zero has no leading one to lose
        assert_eq!(I4F28::from_f64(1.0).unwrap().to_phase(0), u64::MAX);
        assert_eq!(I4F28::from_f64(5.0).unwrap().to_phase(-3), 5 << 61);
    }

    /// `bits · 2⁻ᶠ · 2^(64 + exponent)`, cut toward 0 and saturated.
    fn phase_of(bits: i64, fraction_bits: i32, exponent: i32) -> u64 {
        let left = 64 - fraction_bits + exponent;
        match u128::try_from(bits) {
            Err(_) | Ok(0) => 0,
            Ok(bits) if left <= 0 => {
                u64::try_from(bits.checked_shr(left.unsigned_abs()).unwrap_or(0)).unwrap()
            }
            Ok(bits) if left > 64 || bits.leading_zeros() < left.unsigned_abs() => u64::MAX,
            Ok(bits) => u64::try_from(bits << left).unwrap_or(u64::MAX),
        }
    }

    proptest! {
        #[test]
        fn numbers_become_phases_cut_and_saturated(bits: i64, dropped in 0..64_u32, exponent in -70..70_i32) {
            for bits in [bits >> dropped, i64::MIN, i64::MAX, 1, -1, 0] {
                #[allow(clippy::cast_possible_truncation, reason = "any bits will do")]
                let short = bits as i32;
                for exponent in [exponent, -4, -3, -2, -1, 0, 1] {
                    let of = |fraction_bits| phase_of(short.into(), fraction_bits, exponent);
                    prop_assert_eq!(I2F30::from_bits(short).to_phase(exponent), of(30), "{} {}", short, exponent);
                    prop_assert_eq!(I4F28::from_bits(short).to_phase(exponent), of(28), "{} {}", short, exponent);
                    prop_assert_eq!(I16F16::from_bits(short).to_phase(exponent), of(16), "{} {}", short, exponent);
                    let long = phase_of(bits, 60, exponent);
                    prop_assert_eq!(I4F60::from_bits(bits).to_phase(exponent), long, "{} {}", bits, exponent);
                }
            }
        }
    }
}
