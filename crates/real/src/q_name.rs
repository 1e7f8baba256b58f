//! Names of fixed-point formats in Q notation, which Arm and TI write alike and mean differently.

use crate::FormatName;
use crate::format_name::datapath_of;

/// A name in Q notation, as it was read.
///
/// `Qm.n` has n bits after the point. Arm counts the sign among the m bits before it; TI does not. The width tells the
/// two apart, because registers have 8, 16, 32 or 64 bits: `Q8.24` fills 32 bits as Arm counts, `Q7.24` as TI does. No
/// name fills a register both ways. `Qn` or `Q.n` is a fraction of one sign bit and n bits after the point: `Q15` is
/// I1F15.
///
/// ```
/// use real::{FormatName, QName};
///
/// assert_eq!(QName::read("Q8.24"), Some(QName::Arm(FormatName::fixed(8, 24))));
/// assert_eq!(QName::read("Q7.24"), Some(QName::Ti(FormatName::fixed(8, 24))));
/// assert_eq!(QName::read("q31"), Some(QName::Fraction(FormatName::fixed(1, 31))));
/// assert_eq!(QName::read("Q5.13"), Some(QName::Unclear { integer_bits: Some(5), fraction_bits: 13 }));
/// assert_eq!(QName::read("I8F24"), None);
/// ```
///
/// # Source
/// Arm, RealView Development Suite AXD and armsd Debuggers Guide, "Q-format": n is the number of bits before the point, and Q31 is
/// short for Q1.31. Texas Instruments SPRU565, TMS320C64x DSP Library Programmer's Reference, A.2 "Fractional Q Formats": m+n+1 bits
/// are needed to store a Qm.n number, and `Q.15` is Q0.15.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum QName {
    /// m + n is the width of a register: m counts the sign, as Arm writes.
    Arm(FormatName),
    /// m + n + 1 is the width of a register: m does not count the sign, as TI writes.
    Ti(FormatName),
    /// `Qn` or `Q.n`, where n + 1 is the width of a register.
    Fraction(FormatName),
    /// No register has this width, whichever way the sign is counted: the format cannot be told.
    Unclear {
        /// m, unless the name has none.
        integer_bits: Option<u32>,
        /// n.
        fraction_bits: u32,
    },
}

impl QName {
    /// Reads `Qm.n`, `Qn` or `Q.n`, with a capital or a small q. Suffixes for the datapath may follow, as in
    /// [`FormatName::named`]. `None` if the name is not in Q notation, or has more than 64 bits on a side of the point.
    #[must_use]
    pub fn read(name: &str) -> Option<Self> {
        let bits = |digits: &str| {
            let are_digits = digits.bytes().all(|byte| byte.is_ascii_digit());
            digits.parse().ok().filter(|bits| are_digits && *bits <= 64)
        };
        let is_register = |bits: u32| matches!(bits, 8 | 16 | 32 | 64);
        let mut words = name.split('-');
        let digits = words.next()?.strip_prefix(['Q', 'q'])?;
        let datapath = datapath_of(words)?;
        let format =
            |integer_bits, fraction_bits| FormatName::Fixed { integer_bits, fraction_bits, datapath };
        let Some((m, n)) = digits.split_once('.').filter(|(m, _)| !m.is_empty()) else {
            let n = bits(digits.strip_prefix('.').unwrap_or(digits))?;
            let unclear = Self::Unclear { integer_bits: None, fraction_bits: n };
            return Some(if is_register(n + 1) { Self::Fraction(format(1, n)) } else { unclear });
        };
        let (m, n) = (bits(m)?, bits(n)?);
        Some(if is_register(m + n) {
            Self::Arm(format(m, n))
        } else if is_register(m + n + 1) {
            Self::Ti(format(m + 1, n))
        } else {
            Self::Unclear { integer_bits: Some(m), fraction_bits: n }
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_name_is_read_as_the_one_that_fills_a_register() {
        let fixed = FormatName::fixed;
        for (name, read) in [
            ("Q16.16", QName::Arm(fixed(16, 16))),
            ("q4.28", QName::Arm(fixed(4, 28))),
            ("Q1.31", QName::Arm(fixed(1, 31))),
            ("Q15.16", QName::Ti(fixed(16, 16))),
            ("Q7.24", QName::Ti(fixed(8, 24))),
            ("Q1.14", QName::Ti(fixed(2, 14))),
            ("Q0.31", QName::Ti(fixed(1, 31))),
            ("Q31", QName::Fraction(fixed(1, 31))),
            ("q15", QName::Fraction(fixed(1, 15))),
            ("Q.15", QName::Fraction(fixed(1, 15))),
            ("Q63", QName::Fraction(fixed(1, 63))),
            ("Q24", QName::Unclear { integer_bits: None, fraction_bits: 24 }),
            ("Q5.13", QName::Unclear { integer_bits: Some(5), fraction_bits: 13 }),
        ] {
            assert_eq!(QName::read(name), Some(read), "{name}");
        }
        let floor = FormatName::named("I8F24-floor-sat").map(QName::Arm);
        assert_eq!(QName::read("Q8.24-floor-sat"), floor);
        for other in [
            "", "Q", "I8F24", "Q8F24", "Q8.", "Q.", "Q..15", "Q+8.24", "Q8.24.1", "Q65.1", "UQ8.24",
            "Q8.24-up",
        ] {
            assert_eq!(QName::read(other), None, "{other}");
        }
    }

    /// The rule would be none if a name could be read both ways.
    #[test]
    fn no_name_fills_a_register_both_ways() {
        for (m, n) in (0..=64_u32).flat_map(|m| (0..=64_u32).map(move |n| (m, n))) {
            match QName::read(&format!("Q{m}.{n}")) {
                Some(QName::Arm(format)) => assert!(format == FormatName::fixed(m, n) && (m + n) % 2 == 0),
                Some(QName::Ti(format)) => assert!(format == FormatName::fixed(m + 1, n) && (m + n) % 2 == 1),
                Some(QName::Unclear { .. }) => {}
                other => panic!("Q{m}.{n}: {other:?}"),
            }
        }
    }
}
