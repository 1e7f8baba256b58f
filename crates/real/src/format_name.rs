//! The names of number formats.

use core::fmt;

use crate::{Datapath, Overflow, Rounding};

/// The name of a number format: `f64`, or `I16F16` for 16 integer bits with the sign and 16 fraction bits. The default
/// datapath rounds to nearest with ties up, and wraps. Suffixes name any other, as in `I16F16-floor` or
/// `I16F16-even-sat`.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum FormatName {
    /// A binary float of this many bits, by the name Rust gives it.
    Float {
        /// Width in bits.
        bits: u32,
    },
    /// Two's complement with a binary point, named as the `fixed` crate does.
    Fixed {
        /// Bits before the binary point, the sign included.
        integer_bits: u32,
        /// Bits after the binary point.
        fraction_bits: u32,
        /// How the datapath rounds, and what it does on overflow.
        datapath: Datapath,
    },
    /// Two's complement with the binary point left of all digits: the value is below one half. The name has a negative
    /// number of integer bits: `I-4F12` has 8 bits, which stand for 2⁻⁵ (the sign) down to 2⁻¹².
    Fraction {
        /// Width in bits, the sign included.
        bits: u32,
        /// Bits after the binary point, more than `bits`.
        fraction_bits: u32,
    },
    /// The sum of two `f64`, about 106 bits of precision: the reference.
    DoubleDouble,
}

impl FormatName {
    /// The name of a format that rounds to nearest and wraps.
    #[must_use]
    pub const fn fixed(integer_bits: u32, fraction_bits: u32) -> Self {
        let datapath = Datapath { rounding: Rounding::Nearest, overflow: Overflow::Wrap };
        Self::Fixed { integer_bits, fraction_bits, datapath }
    }

    /// The format with this name: `f32`, `f64`, or `I5F13` with at most 64 bits on either side of the point. `-even`,
    /// `-floor` or `-zero` may follow for products that are not rounded to nearest with ties up, then `-sat` for sums
    /// and products that saturate.
    #[must_use]
    pub fn named(name: &str) -> Option<Self> {
        match name {
            "f32" => return Some(Self::Float { bits: 32 }),
            "f64" => return Some(Self::Float { bits: 64 }),
            _ => {}
        }
        let mut words = name.split('-');
        let (integer_bits, fraction_bits) = words.next()?.strip_prefix('I')?.split_once('F')?;
        let bits = |digits: &str| digits.parse().ok().filter(|bits| *bits <= 64);
        let (integer_bits, fraction_bits) = (bits(integer_bits)?, bits(fraction_bits)?);
        Some(Self::Fixed { integer_bits, fraction_bits, datapath: datapath_of(words)? })
    }

    /// Width in bits; `u32::MAX` where a name that no format has would give more.
    #[must_use]
    pub const fn bits(self) -> u32 {
        match self {
            Self::Float { bits } | Self::Fraction { bits, .. } => bits,
            Self::Fixed { integer_bits, fraction_bits, .. } => integer_bits.saturating_add(fraction_bits),
            Self::DoubleDouble => 128,
        }
    }
}

impl fmt::Display for FormatName {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Float { bits } => write!(f, "f{bits}"),
            Self::Fixed { integer_bits, fraction_bits, datapath } => {
                write!(f, "I{integer_bits}F{fraction_bits}")?;
                let words = [datapath.rounding.word(), datapath.overflow.word()];
                words.into_iter().flatten().try_for_each(|word| write!(f, "-{word}"))
            }
            Self::Fraction { bits, fraction_bits } => {
                write!(f, "I-{}F{fraction_bits}", fraction_bits.saturating_sub(*bits))
            }
            Self::DoubleDouble => f.write_str("double-double"),
        }
    }
}

/// The datapath that the suffixes of a name say; `None` if one is unknown or in the wrong place.
pub(crate) fn datapath_of<'n>(words: impl Iterator<Item = &'n str>) -> Option<Datapath> {
    let mut words = words.peekable();
    let mut next = |word: Option<&str>| word.is_some() && words.next_if(|next| Some(*next) == word).is_some();
    let rounding = Rounding::ALL.into_iter().find(|rounding| next(rounding.word())).unwrap_or_default();
    let overflow = Overflow::ALL.into_iter().find(|overflow| next(overflow.word())).unwrap_or_default();
    words.next().is_none().then_some(Datapath { rounding, overflow })
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Names are made of numbers that anybody gives: those of no format must not overflow either.
    #[test]
    fn names_of_no_format_have_a_width_and_a_text() {
        let fixed = FormatName::fixed(u32::MAX, 1);
        assert_eq!((fixed.bits(), fixed.to_string().as_str()), (u32::MAX, "I4294967295F1"));
        assert_eq!(FormatName::Fraction { bits: 8, fraction_bits: 12 }.to_string(), "I-4F12");
        assert_eq!(FormatName::Fraction { bits: 9, fraction_bits: 8 }.to_string(), "I-0F8");
    }
    #[test]
    fn a_name_gives_the_format_that_has_it() {
        for (rounding, overflow) in Rounding::ALL.into_iter().flat_map(|r| Overflow::ALL.map(|o| (r, o))) {
            let datapath = Datapath { rounding, overflow };
            let format = FormatName::Fixed { integer_bits: 5, fraction_bits: 13, datapath };
            assert_eq!(FormatName::named(&format.to_string()), Some(format));
        }
        assert_eq!(FormatName::named("I5F13"), Some(FormatName::fixed(5, 13)));
        assert_eq!(FormatName::named("f32").map(FormatName::bits), Some(32));
        let floor = FormatName::named("I5F13-floor-sat").expect("a format");
        assert_eq!((floor.bits(), floor.to_string().as_str()), (18, "I5F13-floor-sat"));
        for wrong in
            ["", "F13", "I5", "I5F13-", "I5F13-sat-floor", "I5F13-floor-zero", "I5F13-up", "I65F0", "I-4F12"]
        {
            assert_eq!(FormatName::named(wrong), None, "{wrong}");
        }
    }
}
