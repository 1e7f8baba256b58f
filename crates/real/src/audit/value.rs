//! A value of a signal as its format has it, and its float.

use crate::Real;
use crate::word::Word;

/// A value as its format has it: a word and the bits after its point, or a sum of two floats.
#[derive(Clone, Copy, Debug)]
pub(super) enum Value {
    Word(i64, u32),
    Floats(f64, f64),
}

/// The float of a word with so many bits after its point, cut toward zero.
pub(super) fn of_word(word: i64, fraction_bits: u32) -> f64 {
    let ((high, low), exponent) = (word.split(), -fraction_bits.cast_signed());
    cut((high.ldexp(exponent), low.ldexp(exponent)))
}

/// The float of a pair, cut toward zero: rounding to the high float went away from zero if the low one points back.
pub(super) fn cut((high, low): (f64, f64)) -> f64 {
    if low != 0.0 && (low < 0.0) != (high < 0.0) { toward_zero(high) } else { high }
}

/// The neighbour of a number that is not zero.
fn toward_zero(x: f64) -> f64 {
    f64::from_bits(x.to_bits() - 1)
}

#[cfg(test)]
mod tests {
    use crate::{Audit, Audited, I4F60, Real};

    /// 8 - 2⁻⁶⁰ is 8 as a float, which would need one bit more.
    #[test]
    fn the_extremes_of_64_bits_are_cut_and_not_rounded() {
        let ((), audit) = Audit::of(|| {
            for bits in [i64::MAX, i64::MIN] {
                let _ = Audited(I4F60::from_bits(bits)).signal("x");
            }
        });
        assert_eq!((audit.signals["x"].min, audit.signals["x"].max), (-8.0, 8.0_f64.next_down()));
        assert_eq!(audit.integer_bits_needed(), 4);
    }
}
