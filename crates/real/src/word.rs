//! The machine words behind fixed-point numbers, and the integer operations that the `fixed` crate does not offer.

use num_traits::{AsPrimitive, FromPrimitive, PrimInt, WrappingAdd};

use crate::division::{divide_u64, divide_u128};
use crate::square_root;

/// The machine word behind a fixed-point number. Sealed: `i8`, `i16`, `i32` and `i64`.
pub trait Word:
    PrimInt + FromPrimitive + AsPrimitive<Self::Wide> + AsPrimitive<u64> + sealed::Sealed + 'static
{
    /// A word of twice the width; holds every product of two words.
    type Wide: PrimInt + WrappingAdd + AsPrimitive<Self> + AsPrimitive<f64> + 'static;

    /// The exact product.
    fn product(self, factor: Self) -> Self::Wide;

    /// `self · 2^fraction_bits / divisor`, rounded to nearest and ties away from zero; saturates. Over zero, the
    /// extreme with the sign of the numerator; `0/0` is 0.
    fn quotient(self, divisor: Self, fraction_bits: u32) -> Self;

    /// `√(self · 2^fraction_bits)`, rounded to nearest; 0 for a negative number.
    fn square_root(self, fraction_bits: u32) -> Self;

    /// `√(Σ vᵢ²)`, rounded to nearest; saturates.
    fn length(words: impl Iterator<Item = Self>) -> Self;

    /// The low bits of `⌊sum · 2^-fraction_bits + ½⌋`, for fewer fraction bits than the word has; the sum may wrap.
    fn rounded(sum: Self::Wide, fraction_bits: u32) -> Self;

    /// The word nearest to `high + low`, ties to even, for a sum of two floats; `None` when out of range.
    fn nearest(high: f64, low: f64) -> Option<Self>;

    /// The exact value as a sum of two floats.
    fn split(self) -> (f64, f64);

    /// The word as a wider integer.
    fn widened(self) -> i64;

    /// The last bits of a wider word.
    fn of_last_bits(bits: u64) -> Self;

    /// The word nearest to `numerator · 2^fraction_bits / denominator`, ties away from zero; saturates. Over
    /// zero, the extreme with the sign of the numerator; `0/0` is 0.
    fn ratio(numerator: i32, denominator: i32, fraction_bits: u32) -> Self;
}

mod sealed {
    pub trait Sealed {}
}

macro_rules! word {
    (
        $word:ident, $wide:ty, $unsigned_wide:ty,
        multiply: $multiply:expr, divide: $divide:expr, root: $root:expr, round: $round:expr,
        ratio: $ratio:ty, divide_ratio: $divide_ratio:expr
    ) => {
        impl sealed::Sealed for $word {}

        #[allow(
            clippy::cast_possible_truncation,
            clippy::cast_possible_wrap,
            clippy::cast_sign_loss,
            clippy::cast_lossless,
            clippy::cast_precision_loss,
            reason = "the one place where words change width; each cast is bounded in the line before it"
        )]
        impl Word for $word {
            type Wide = $wide;

            #[inline]
            fn widened(self) -> i64 {
                self as i64
            }

            #[inline]
            fn of_last_bits(bits: u64) -> $word {
                bits as $word
            }

            #[inline]
            fn product(self, factor: $word) -> $wide {
                $multiply(self, factor)
            }

            #[inline]
            fn quotient(self, divisor: $word, fraction_bits: u32) -> $word {
                let n = (self.unsigned_abs() as $unsigned_wide) << fraction_bits;
                let d = divisor.unsigned_abs() as $unsigned_wide;
                let negative = (self < 0) != (divisor < 0);
                let magnitude = if (n >> <$word>::BITS) < d {
                    let (q, r) = $divide(n, d);
                    q + (r >= d - r) as $unsigned_wide
                } else if n == 0 {
                    0 // 0/0
                } else {
                    <$unsigned_wide>::MAX // does not fit, or is over zero
                };
                signed::$word(magnitude.min(<$word>::MIN.unsigned_abs() as $unsigned_wide) as _, negative)
            }

            #[inline]
            fn square_root(self, fraction_bits: u32) -> $word {
                let root: $unsigned_wide = $root((self.max(0) as $unsigned_wide) << fraction_bits);
                root.min(<$word>::MAX as $unsigned_wide) as $word
            }

            #[inline]
            fn length(words: impl Iterator<Item = $word>) -> $word {
                let sum = words
                    .map(|w| (w as $wide * w as $wide).unsigned_abs())
                    .fold(0, |sum: $unsigned_wide, square| sum.saturating_add(square));
                let root: $unsigned_wide = $root(sum);
                root.min(<$word>::MAX as $unsigned_wide) as $word
            }

            #[inline]
            fn rounded(sum: $wide, fraction_bits: u32) -> $word {
                $round(sum, fraction_bits)
            }

            fn nearest(high: f64, low: f64) -> Option<$word> {
                nearest(high, low).and_then(|word| <$word>::try_from(word).ok())
            }

            #[inline]
            fn split(self) -> (f64, f64) {
                let high = self as f64;
                // The greatest words round up to 2^63, where the cast back saturates one below.
                let rest = self as i64 - high as i64 - (high >= 9_223_372_036_854_775_808.0) as i64;
                (high, rest as f64)
            }

            #[inline]
            fn ratio(numerator: i32, denominator: i32, fraction_bits: u32) -> $word {
                let n = (numerator.unsigned_abs() as $ratio) << fraction_bits;
                let d = denominator.unsigned_abs() as $ratio;
                let negative = (numerator < 0) != (denominator < 0);
                let magnitude = if (n >> (<$ratio>::BITS / 2)) < d {
                    let (q, r) = $divide_ratio(n, d);
                    q + (r >= d - r) as $ratio
                } else if n == 0 {
                    0
                } else {
                    <$ratio>::MAX
                };
                signed::$word(magnitude.min(<$word>::MIN.unsigned_abs() as $ratio) as _, negative)
            }
        }
    };
}

fn root_u16(square: u16) -> u16 {
    let root = square.isqrt();
    // (k + ½)² = k² + k + ¼: the upper neighbour is nearer from k² + k + 1 on.
    root + u16::from(square - root * root > root)
}

fn root_u32(square: u32) -> u32 {
    let root = square.isqrt();
    root + u32::from(square - root * root > root)
}

/// [`Word::rounded`] by a sum in the wide word.
macro_rules! rounded_wide {
    ($word:ident, $wide:ident) => {
        |sum: $wide, fraction_bits: u32| match fraction_bits {
            0 => sum as $word,
            bits => (sum.wrapping_add(1 << (bits - 1)) >> bits) as $word,
        }
    };
}

/// [`Word::rounded`] of 32 bits, on a machine whose registers have 32 as well: each half of the sum gives its part of the word,
/// and the first bit behind the last place says whether to round up. Compilers form a shift of 64 bits in other ways, which
/// take more instructions and hide from the next product that the word is one of 32 bits.
#[inline]
#[allow(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "the halves of a word of 64 bits")]
pub(crate) fn rounded_by_halves(sum: i64, fraction_bits: u32) -> i32 {
    let (high, low) = ((sum >> 32) as u32, sum as u32);
    if fraction_bits == 0 {
        return low.cast_signed();
    }
    let up = (low >> (fraction_bits - 1)) & 1;
    (high << (32 - fraction_bits)).wrapping_add(up).wrapping_add(low >> fraction_bits).cast_signed()
}

#[inline]
#[allow(clippy::cast_possible_truncation, reason = "the low bits are meant")]
fn round_i64(sum: i64, fraction_bits: u32) -> i32 {
    if usize::BITS == 32 {
        rounded_by_halves(sum, fraction_bits)
    } else {
        rounded_wide!(i32, i64)(sum, fraction_bits)
    }
}

/// [`Word::product`] in the wide word.
macro_rules! multiplied_wide {
    ($word:ident, $wide:ident) => {
        |a: $word, b: $word| $wide::from(a) * $wide::from(b)
    };
}

/// [`Word::product`] of 32 bits, from halves of 16 bits.
#[inline]
#[allow(clippy::cast_possible_truncation, reason = "a word of 64 bits from two of 32")]
pub(crate) fn product_of_halves(a: i32, b: i32) -> i64 {
    let ([a_high, b_high], [a_low, b_low]) = ([a >> 16, b >> 16], [a & 0xffff, b & 0xffff]);
    let low = a_low.wrapping_mul(b_low).cast_unsigned();
    let middle = a_high.wrapping_mul(b_low).wrapping_add((low >> 16).cast_signed());
    let other = a_low.wrapping_mul(b_high).wrapping_add(middle & 0xffff);
    let high = a_high.wrapping_mul(b_high).wrapping_add(middle >> 16).wrapping_add(other >> 16);
    (i64::from(high) << 32) | i64::from((other.cast_unsigned() << 16) | (low & 0xffff))
}

/// A product of two words of 32 bits, on a core that forms none of 64 bits from halves: its library would form all of 128 bits.
#[inline]
fn multiply_i32(a: i32, b: i32) -> i64 {
    if cfg!(short_products) { product_of_halves(a, b) } else { i64::from(a) * i64::from(b) }
}

/// The exact product of two words of 64 bits, from four products of 32 where the core forms none.
#[inline]
#[must_use]
pub fn product_of_words(a: u64, b: u64) -> u128 {
    if cfg!(short_products) { product_of_four(a, b) } else { u128::from(a) * u128::from(b) }
}

#[inline]
#[allow(clippy::cast_possible_truncation, reason = "halves of words")]
fn product_of_four(a: u64, b: u64) -> u128 {
    let ([a_high, b_high], [a_low, b_low]) = ([(a >> 32) as u32, (b >> 32) as u32], [a as u32, b as u32]);
    let low = unsigned_product_of_halves(a_low, b_low);
    let middle = unsigned_product_of_halves(a_high, b_low) + (low >> 32);
    let other = unsigned_product_of_halves(a_low, b_high) + u64::from(middle as u32);
    let high = unsigned_product_of_halves(a_high, b_high) + (middle >> 32) + (other >> 32);
    (u128::from(high) << 64) | u128::from((other << 32) | u64::from(low as u32))
}

/// [`product_of_halves`] of words without a sign.
#[inline]
fn unsigned_product_of_halves(a: u32, b: u32) -> u64 {
    let ([a_high, b_high], [a_low, b_low]) = ([a >> 16, b >> 16], [a & 0xffff, b & 0xffff]);
    let low = a_low * b_low;
    let middle = a_high * b_low + (low >> 16);
    let other = a_low * b_high + (middle & 0xffff);
    let high = a_high * b_high + (middle >> 16) + (other >> 16);
    (u64::from(high) << 32) | u64::from((other << 16) | (low & 0xffff))
}

word!(i8, i16, u16, multiply: multiplied_wide!(i8, i16), divide: |n, d| (n / d, n % d), root: root_u16, round: rounded_wide!(i8, i16),
    ratio: u64, divide_ratio: divide_u64);
word!(i16, i32, u32, multiply: multiplied_wide!(i16, i32), divide: |n, d| (n / d, n % d), root: root_u32, round: rounded_wide!(i16, i32),
    ratio: u64, divide_ratio: divide_u64);
word!(i32, i64, u64, multiply: multiply_i32, divide: divide_u64, root: square_root::u64::nearest, round: round_i64,
    ratio: u64, divide_ratio: divide_u64);
word!(i64, i128, u128, multiply: multiplied_wide!(i64, i128), divide: divide_u128, root: square_root::u128::nearest,
    round: rounded_wide!(i64, i128), ratio: u128, divide_ratio: divide_u128);

/// Words from magnitude and sign: the magnitude is at most that of the least word, and the greatest word is one less.
mod signed {
    macro_rules! signed {
        ($word:ident, $unsigned:ty) => {
            #[inline]
            pub(super) fn $word(magnitude: $unsigned, negative: bool) -> $word {
                if negative {
                    magnitude.wrapping_neg().cast_signed()
                } else {
                    magnitude.min($word::MAX.unsigned_abs()).cast_signed()
                }
            }
        };
    }
    signed!(i8, u8);
    signed!(i16, u16);
    signed!(i32, u32);
    signed!(i64, u64);
}

/// The integer nearest to `high + low`, ties to even; `None` unless both are within ±2⁶³.
///
/// Each float is cut to 62 fraction bits; the code remembers whether digits were lost. Only a float below 2⁻⁹ can lose
/// digits. Both floats lose some only where `high` is that small, and then the sum is not near a tie.
#[allow(clippy::cast_possible_truncation, clippy::cast_precision_loss, reason = "bounded by the first check")]
pub(crate) fn nearest(high: f64, low: f64) -> Option<i128> {
    const UNIT: i128 = 1 << 62;
    let bound = (1_u64 << 63) as f64;
    if !(-bound..=bound).contains(&high) || !(-bound..=bound).contains(&low) {
        return None;
    }
    let cut = |x: f64| {
        let units = x * UNIT as f64; // a power of two: exact
        let truncated = units as i128;
        let lost = truncated as f64 != units;
        (truncated - i128::from(lost && units < 0.0), lost)
    };
    let ((high, high_lost), (low, low_lost)) = (cut(high), cut(low));
    let (sum, lost) = (high + low, high_lost || low_lost);
    let (whole, rest) = (sum >> 62, sum & (UNIT - 1));
    let up = rest > UNIT / 2 || (rest == UNIT / 2 && (lost || whole & 1 == 1));
    Some(whole + i128::from(up))
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    proptest! {
        #[test]
        fn a_product_of_halves_is_the_product(a: i32, b: i32) {
            for a in [a, i32::MIN, i32::MAX, -1, 0, 0xffff, -0x10000] {
                for b in [b, i32::MIN, i32::MAX, -1, 0, 0xffff, -0x10000] {
                    prop_assert_eq!(product_of_halves(a, b), i64::from(a) * i64::from(b), "{} {}", a, b);
                }
            }
        }

        #[test]
        fn a_product_of_four_is_the_product(a: u64, b: u64) {
            for a in [a, 0, u64::MAX, 1 << 63, 0xffff_ffff] {
                prop_assert_eq!(product_of_four(a, b), u128::from(a) * u128::from(b), "{} {}", a, b);
            }
        }

        #[test]
        fn halves_round_as_the_whole_does(sum: i64, fraction_bits in 0..32_u32) {
            for sum in [sum, sum | 0xffff_ffff, sum >> 20, i64::MAX, i64::MIN, -1, 1 << 27] {
                let whole = i32::rounded(sum, fraction_bits);
                prop_assert_eq!(rounded_by_halves(sum, fraction_bits), whole, "{} {}", sum, fraction_bits);
            }
        }
    }
}
