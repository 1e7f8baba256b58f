//! Numbers from the bits that hold them, as a file or a memory has them.

use fixed::traits::FixedSigned;
use num_traits::{FromPrimitive, Zero};

use crate::{Backend, FixedPoint, FormatName, Word};

/// A backend that a machine has a word for: 8, 16, 32 or 64 bits.
pub trait FromWord: Backend {
    /// The width of the word, in bytes.
    const BYTES: usize;

    /// The number that these bits hold: in fixed point a word in two's complement, in a float those of IEEE 754. The
    /// bits above the format's width do not count. It is the inverse of [`word_of`], and every word is a number, be it
    /// NaN.
    #[must_use]
    fn from_word(word: u64) -> Self;
}

/// The bits that hold a number: in fixed point its word in two's complement, in the format's width; of a float the
/// bits of IEEE 754. Above them, zeros.
#[must_use]
pub fn word_of<R: Backend>(number: R) -> u64 {
    match (number.word(), R::name()) {
        (Some(word), name) => word.cast_unsigned() & (u64::MAX >> (64 - name.bits().clamp(1, 64))),
        #[allow(clippy::cast_possible_truncation, reason = "the number is one of an f32")]
        (None, FormatName::Float { bits: 32 }) => u64::from((number.to_f64() as f32).to_bits()),
        (None, _) => number.to_f64().to_bits(),
    }
}

impl FromWord for f64 {
    const BYTES: usize = 8;

    fn from_word(word: u64) -> Self {
        Self::from_bits(word)
    }
}

impl FromWord for f32 {
    const BYTES: usize = 4;

    #[allow(clippy::cast_possible_truncation, reason = "the bits above the width do not count")]
    fn from_word(word: u64) -> Self {
        Self::from_bits(word as u32)
    }
}

impl<F: FixedSigned + Send + Sync> FromWord for FixedPoint<F>
where
    F::Bits: Word,
{
    const BYTES: usize = size_of::<F::Bits>();

    fn from_word(word: u64) -> Self {
        let unused = 64_usize.saturating_sub(8 * Self::BYTES);
        let widened = (word << unused).cast_signed() >> unused;
        Self::from_bits(F::Bits::from_i64(widened).unwrap_or_else(F::Bits::zero))
    }
}

#[cfg(all(test, feature = "std"))]
mod tests {
    use super::*;
    use crate::{I4F4, I4F28, I4F60, word_of};
    use proptest::prelude::*;

    /// There and back, bit for bit: also zeros with a sign, infinities and the quiet NaN.
    fn comes_back<R: FromWord>(word: u64) {
        let kept = word & (u64::MAX >> (64 - 8 * R::BYTES));
        assert_eq!(word_of(R::from_word(word)), kept, "{} {word:#x}", R::name());
    }

    proptest! {
        #[test]
        fn words_come_back(word: u64) {
            comes_back::<I4F4>(word);
            comes_back::<FixedPoint<fixed::types::I5F11>>(word);
            comes_back::<I4F28>(word);
            comes_back::<I4F60>(word);
            if !f64::from_bits(word).is_nan() {
                comes_back::<f64>(word);
            }
            if !f32::from_word(word).is_nan() {
                comes_back::<f32>(word);
            }
        }
    }

    #[test]
    fn extremes_come_back() {
        for word in [0, 1, 1 << 7, 1 << 31, 1 << 63, u64::MAX, 0x7f80_0000, 0xff80_0000] {
            comes_back::<I4F28>(word);
            comes_back::<I4F60>(word);
        }
        for x in [0.0_f32, -0.0, f32::INFINITY, f32::NEG_INFINITY, f32::MIN_POSITIVE, 1e-45] {
            comes_back::<f32>(x.to_bits().into());
            comes_back::<f64>(f64::from(x).to_bits());
        }
        assert_eq!(I4F28::from_word(0xf000_0000), -<I4F28 as num_traits::One>::one());
    }
}
