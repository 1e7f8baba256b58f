//! Fixed-point backends: the `fixed` crate's signed types with an explicit operation family.
//!
//! The operators of `fixed` itself panic on overflow in a debug build and wrap in release, round products
//! toward −∞ and quotients toward 0. [`FixedPoint`] decides once for all builds: products, sums of products,
//! quotients, roots and norms are formed in twice the width and rounded to nearest; what then does not fit
//! wraps in `+`, `-`, `*` and saturates in `/`, `sqrt` and `norm`, as the table at [`Real`] says.

use core::ops::{Add, Div, Mul, Neg, Sub};

use fixed::traits::{Fixed, FixedSigned};
use num_traits::{AsPrimitive, Bounded, FromPrimitive, One, PrimInt, ToPrimitive, WrappingAdd, Zero};

use crate::{Backend, FormatName, Real};

/// A signed fixed-point number of the `fixed` crate, as a [`Real`].
///
/// The number is `bits · 2⁻ᶠ`. It must be able to hold 1: at least two integer bits, the sign among them.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, PartialOrd, Ord, Hash)]
#[repr(transparent)]
pub struct FixedPoint<F>(pub F);

/// The machine word behind a fixed-point number. Sealed: `i8`, `i16`, `i32` and `i64`.
pub trait Word: PrimInt + FromPrimitive + AsPrimitive<Self::Wide> + sealed::Sealed + 'static {
    /// A word of twice the width; holds every product of two words.
    type Wide: PrimInt + WrappingAdd + AsPrimitive<Self> + AsPrimitive<f64> + 'static;

    /// `√square`, rounded to nearest, of a number that is not negative.
    fn square_root(square: Self::Wide) -> Self::Wide;

    /// `√(Σ vᵢ²)`, rounded to nearest; saturates.
    fn length(words: impl Iterator<Item = Self>) -> Self;

    /// The word nearest to `high + low`, ties to even, for a sum of two floats; `None` when out of range.
    fn nearest(high: f64, low: f64) -> Option<Self>;

    /// The exact value as a sum of two floats.
    fn split(self) -> (f64, f64);

    /// The word nearest to `numerator · 2^fraction_bits / denominator`, ties away from zero; saturates.
    fn ratio(numerator: i32, denominator: i32, fraction_bits: usize) -> Self;
}

mod sealed {
    pub trait Sealed {}
}

macro_rules! word {
    ($word:ty, $wide:ty, $unsigned_wide:ty, $ratio:ty) => {
        impl sealed::Sealed for $word {}

        #[allow(
            clippy::cast_possible_truncation,
            clippy::cast_possible_wrap,
            clippy::cast_sign_loss,
            clippy::cast_lossless,
            reason = "the one place where words change width; each cast is bounded in the line before it"
        )]
        impl Word for $word {
            type Wide = $wide;

            #[inline]
            fn square_root(square: $wide) -> $wide {
                let square = square.unsigned_abs();
                let root = square.isqrt();
                // (root + ½)² = root² + root + ¼: the upper neighbour is nearer from root² + root + 1 on.
                (root + <$unsigned_wide>::from(square - root * root > root)) as $wide
            }

            #[inline]
            fn length(words: impl Iterator<Item = $word>) -> $word {
                let sum = words
                    .map(|w| (w as $wide * w as $wide).unsigned_abs())
                    .fold(0, |sum: $unsigned_wide, square| sum.saturating_add(square));
                let root = sum.isqrt();
                let nearest = root + <$unsigned_wide>::from(sum - root * root > root);
                nearest.min(<$word>::MAX as $unsigned_wide) as $word
            }

            fn nearest(high: f64, low: f64) -> Option<$word> {
                // Rounding `high` first would round twice, so its fraction joins `low`.
                let bound = -(<$word>::MIN as f64);
                if !(-bound..=bound).contains(&high) {
                    return None;
                }
                let whole = floor(high);
                let rest = (high - whole) + low;
                let lost = low - (rest - (high - whole)); // what that addition rounded away decides a tie
                let floor_word = whole as i128 + floor(rest) as i128;
                let above_half = (rest - floor(rest)) - 0.5;
                let up = if above_half == 0.0 && lost == 0.0 {
                    floor_word & 1 == 1
                } else {
                    above_half > 0.0 || (above_half == 0.0 && lost > 0.0)
                };
                <$word>::try_from(floor_word + i128::from(up)).ok()
            }

            fn split(self) -> (f64, f64) {
                let high = self as f64;
                (high, (self as i128 - high as i128) as f64)
            }

            fn ratio(numerator: i32, denominator: i32, fraction_bits: usize) -> $word {
                let (numerator, denominator) = ((numerator as $ratio) << fraction_bits, denominator as $ratio);
                if denominator == 0 {
                    return 0;
                }
                let (quotient, remainder) = (numerator / denominator, numerator % denominator);
                let away = <$ratio>::from(2 * remainder.abs() >= denominator.abs());
                let sign = numerator.signum() * denominator.signum();
                (quotient + sign * away).clamp(<$word>::MIN as $ratio, <$word>::MAX as $ratio) as $word
            }
        }
    };
}

word!(i8, i16, u16, i64);
word!(i16, i32, u32, i64);
word!(i32, i64, u64, i64);
word!(i64, i128, u128, i128);

/// The largest integer not above `x`, for `|x| ≤ 2⁶³`; core has no `floor`.
#[allow(clippy::cast_possible_truncation, clippy::cast_precision_loss, reason = "bounded by the domain")]
fn floor(x: f64) -> f64 {
    let truncated = x as i128 as f64;
    if truncated > x { truncated - 1.0 } else { truncated }
}

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

    #[inline]
    fn wide(self) -> WideBits<F> {
        self.0.to_bits().as_()
    }

    /// Keeps the low bits: what does not fit wraps.
    #[inline]
    fn wrap(wide: WideBits<F>) -> Self {
        Self(F::from_bits(wide.as_()))
    }

    /// Goes to the nearest extreme when the number does not fit.
    #[inline]
    fn saturate(wide: WideBits<F>) -> Self {
        let (least, greatest) = (F::MIN.to_bits().as_(), F::MAX.to_bits().as_());
        Self::wrap(if wide < least {
            least
        } else if wide > greatest {
            greatest
        } else {
            wide
        })
    }

    /// Drops `shift` bits, rounding to nearest and ties up. Adding half a unit may wrap; the sum is in wide
    /// bits, of which the caller keeps the low half at most.
    #[inline]
    fn round(wide: WideBits<F>, shift: usize) -> WideBits<F> {
        if shift == 0 {
            return wide;
        }
        wide.wrapping_add(&(WideBits::<F>::one() << (shift - 1))) >> shift
    }

    /// `numerator / denominator`, rounded to nearest and ties away from zero; the denominator is not 0.
    #[inline]
    fn quotient(numerator: WideBits<F>, denominator: WideBits<F>) -> WideBits<F> {
        let zero = WideBits::<F>::zero();
        let (quotient, remainder) = (numerator / denominator, numerator % denominator);
        let away_from_zero = |x: WideBits<F>| if x < zero { x } else { zero - x };
        // Compared as negative numbers, whose range is the larger one: 2|r| >= |d|.
        if away_from_zero(remainder) > away_from_zero(denominator) - away_from_zero(remainder) {
            return quotient;
        }
        if (numerator < zero) == (denominator < zero) {
            quotient + WideBits::<F>::one()
        } else {
            quotient - WideBits::<F>::one()
        }
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
        Self::wrap(Self::round(self.wide() * other.wide(), Self::FRACTION_BITS))
    }
}

impl<F: FixedSigned> Div for FixedPoint<F>
where
    F::Bits: Word,
{
    type Output = Self;
    #[inline]
    fn div(self, other: Self) -> Self {
        let zero = WideBits::<F>::zero();
        if other.is_zero() {
            return match self.wide() {
                n if n > zero => Self(F::MAX),
                n if n < zero => Self(F::MIN),
                _ => Self(F::ZERO),
            };
        }
        Self::saturate(Self::quotient(self.wide() << Self::FRACTION_BITS, other.wide()))
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
    #[inline]
    fn resolution() -> Self {
        Self(F::DELTA)
    }

    #[inline]
    fn from_ratio(numerator: i32, denominator: i32) -> Self {
        Self(F::from_bits(Bits::<F>::ratio(numerator, denominator, Self::FRACTION_BITS)))
    }

    #[inline]
    fn mul_add(self, factor: Self, addend: Self) -> Self {
        let product = self.wide() * factor.wide();
        let sum = product.wrapping_add(&(addend.wide() << Self::FRACTION_BITS));
        Self::wrap(Self::round(sum, Self::FRACTION_BITS))
    }

    #[inline]
    fn sum_of_products(pairs: impl IntoIterator<Item = (Self, Self)>) -> Self {
        let sum = pairs
            .into_iter()
            .fold(WideBits::<F>::zero(), |sum, (a, b)| sum.wrapping_add(&(a.wide() * b.wide())));
        Self::wrap(Self::round(sum, Self::FRACTION_BITS))
    }

    #[inline]
    fn norm<const N: usize>(vector: &[Self; N]) -> Self {
        // √(Σ (bᵢ·2⁻ᶠ)²) = √(Σ bᵢ²)·2⁻ᶠ: the root of the integer sum is the result, with no shift at all.
        Self(F::from_bits(Bits::<F>::length(vector.iter().map(|v| v.0.to_bits()))))
    }

    #[inline]
    fn sqrt(self) -> Self {
        if self.0 <= F::ZERO {
            return Self(F::ZERO);
        }
        Self::wrap(Bits::<F>::square_root(self.wide() << Self::FRACTION_BITS))
    }

    #[inline]
    fn scale(self, exponent: i32) -> Self {
        let shift = exponent.unsigned_abs() as usize;
        let width = (F::INT_NBITS + F::FRAC_NBITS) as usize;
        if exponent >= 0 {
            return if shift < width { Self::wrap(self.wide() << shift) } else { Self(F::ZERO) };
        }
        if shift <= width { Self::wrap(Self::round(self.wide(), shift)) } else { Self(F::ZERO) }
    }

    #[inline]
    fn from_phase(phase: u64, exponent: i32) -> Self {
        let shift = 64 - exponent.clamp(-64, 64) - F::FRAC_NBITS.cast_signed();
        let distance = shift.unsigned_abs();
        let bits = match shift {
            s if s >= 0 => phase.checked_shr(distance).unwrap_or(0),
            _ if distance > phase.leading_zeros() => u64::MAX,
            _ => phase.checked_shl(distance).unwrap_or(0),
        };
        Bits::<F>::from_u64(bits).map_or(Self(F::MAX), |bits| Self(F::from_bits(bits)))
    }

    #[inline]
    fn to_phase(self, exponent: i32) -> u64 {
        let bits = self.0.to_bits().to_u64().unwrap_or(0); // a negative number is no u64
        let shift = 64 + exponent.clamp(-64, 64) - (F::FRAC_NBITS.cast_signed());
        let left = shift.unsigned_abs();
        match shift {
            s if s < 0 => bits.checked_shr(left).unwrap_or(0),
            _ if left > bits.leading_zeros() => u64::MAX,
            _ => bits.checked_shl(left).unwrap_or(0),
        }
    }

    #[inline]
    fn is_finite(self) -> bool {
        true
    }
}

impl<F: FixedSigned> Backend for FixedPoint<F>
where
    F::Bits: Word,
{
    fn name() -> FormatName {
        FormatName::Fixed { integer_bits: F::INT_NBITS, fraction_bits: F::FRAC_NBITS }
    }

    fn from_f64_pair(high: f64, low: f64) -> Option<Self> {
        let exponent = i32::try_from(Self::FRACTION_BITS).ok()?;
        let word = Bits::<F>::nearest(high.scale(exponent), low.scale(exponent))?;
        Some(Self(F::from_bits(word)))
    }

    fn to_f64_pair(self) -> (f64, f64) {
        let (high, low) = self.0.to_bits().split();
        let exponent = -i32::try_from(Self::FRACTION_BITS).unwrap_or(0);
        (high.scale(exponent), low.scale(exponent))
    }
}

#[cfg(test)]
mod tests {
    use crate::{Backend, I4F28, I4F60, I16F16, Real};
    use num_traits::Bounded;

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
        assert_eq!(I4F28::from_f64(1.0).unwrap().to_phase(0), u64::MAX);
        assert_eq!(I4F28::from_f64(5.0).unwrap().to_phase(-3), 5 << 61);
    }
}
