//! The names of number formats.

use core::fmt;

/// The name of a number format: `f64`, or `I16F16` for 16 integer bits with the sign and 16 fraction bits.
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
    },
    /// Two's complement with the binary point left of all digits: the value is below one half. Written with a negative
    /// number of integer bits, as in `I-4F12` for 8 bits, 2⁻⁵ down to 2⁻¹² with the sign.
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
    /// Width in bits; the greatest `u32` where a name that no format has would give more.
    #[must_use]
    pub const fn bits(self) -> u32 {
        match self {
            Self::Float { bits } | Self::Fraction { bits, .. } => bits,
            Self::Fixed { integer_bits, fraction_bits } => integer_bits.saturating_add(fraction_bits),
            Self::DoubleDouble => 128,
        }
    }
}

impl fmt::Display for FormatName {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Float { bits } => write!(f, "f{bits}"),
            Self::Fixed { integer_bits, fraction_bits } => write!(f, "I{integer_bits}F{fraction_bits}"),
            Self::Fraction { bits, fraction_bits } => {
                write!(f, "I-{}F{fraction_bits}", fraction_bits.saturating_sub(*bits))
            }
            Self::DoubleDouble => f.write_str("double-double"),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Names are made of numbers that anybody gives: those of no format must not overflow either.
    #[test]
    fn names_of_no_format_have_a_width_and_a_text() {
        let fixed = FormatName::Fixed { integer_bits: u32::MAX, fraction_bits: 1 };
        assert_eq!((fixed.bits(), fixed.to_string().as_str()), (u32::MAX, "I4294967295F1"));
        assert_eq!(FormatName::Fraction { bits: 8, fraction_bits: 12 }.to_string(), "I-4F12");
        assert_eq!(FormatName::Fraction { bits: 9, fraction_bits: 8 }.to_string(), "I-0F8");
    }
}
