//! Numbers as logs write them, with the decimals that say how finely.

/// A number, and the place of its last digit: -6 where it is written with six decimals.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Decimal {
    pub(crate) value: f64,
    pub(crate) last_place: i32,
}

/// Powers of ten that a double holds exactly.
const EXACT_POWERS: [f64; 23] = [
    1e0, 1e1, 1e2, 1e3, 1e4, 1e5, 1e6, 1e7, 1e8, 1e9, 1e10, 1e11, 1e12, 1e13, 1e14, 1e15, 1e16, 1e17, 1e18,
    1e19, 1e20, 1e21, 1e22,
];

/// Whole numbers up to this are doubles.
const EXACT_WHOLE: u64 = 1 << 53;

/// Reads a number; `None` if the text is none, or one that is not finite.
///
/// The value is the double nearest to the text. Of up to 15 digits and 22 decimals it is the quotient of two doubles that are exact, which
/// rounds once; any other text goes to the standard library.
pub(crate) fn decimal(text: &[u8]) -> Option<Decimal> {
    plain(text).or_else(|| any(text))
}

/// A number of digits and a point alone, short enough that both parts of the quotient are exact.
fn plain(text: &[u8]) -> Option<Decimal> {
    let (is_negative, digits) = match text {
        [b'-', rest @ ..] => (true, rest),
        _ => (false, text),
    };
    let (mut whole, mut decimals, mut count, mut has_point) = (0_u64, 0_usize, 0, false);
    for byte in digits {
        match byte {
            b'0'..=b'9' => {
                whole = whole.checked_mul(10)?.checked_add(u64::from(byte - b'0'))?;
                decimals += usize::from(has_point);
                count += 1;
            }
            b'.' if !has_point => has_point = true,
            _ => return None,
        }
    }
    if count == 0 || whole >= EXACT_WHOLE {
        return None;
    }
    let value = whole as f64 / EXACT_POWERS.get(decimals)?;
    let last_place = -i32::try_from(decimals).ok()?;
    Some(Decimal { value: if is_negative { -value } else { value }, last_place })
}

/// A number in any form that the standard library reads.
fn any(text: &[u8]) -> Option<Decimal> {
    let text = str::from_utf8(text).ok()?;
    let value = text.parse::<f64>().ok().filter(|value| value.is_finite())?;
    let (digits, exponent) = match text.split_once(['e', 'E']) {
        Some((digits, exponent)) => (digits, exponent.parse::<i32>().ok()?),
        None => (text, 0),
    };
    let decimals = digits.split_once('.').map_or(0, |(_, decimals)| decimals.len());
    let last_place = exponent.saturating_sub(i32::try_from(decimals).unwrap_or(i32::MAX));
    Some(Decimal { value, last_place })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_form_of_a_number_is_read_with_its_last_place() {
        let of = |text: &str| decimal(text.as_bytes()).map(|read| (read.value, read.last_place));
        for (text, value, last_place) in [
            ("0.112428", 0.112_428, -6),
            ("-3", -3.0, 0),
            ("12.", 12.0, 0),
            (".5", 0.5, -1),
            ("1.250000000000", 1.25, -12),
            ("1.5e-7", 1.5e-7, -8),
            ("+2.50", 2.5, -2),
            ("0.1234567890123456789", 0.123_456_789_012_345_68, -19),
            ("123456789012345678", 1.234_567_890_123_456_8e17, 0),
        ] {
            assert_eq!(of(text), Some((value, last_place)), "{text}");
        }
        for text in ["", "-", ".", "nan", "inf", "1e999", "1.2.3", "0x10", "1,5", "ab"] {
            assert_eq!(of(text), None, "{text}");
        }
    }

    /// The quotient is the double that the standard library reads.
    #[test]
    fn short_numbers_are_read_as_by_the_standard_library() {
        let mut state = 0x9e37_79b9_7f4a_7c15_u64;
        for _ in 0..100_000 {
            state ^= state << 13;
            state ^= state >> 7;
            state ^= state << 17;
            let (whole, decimals) = (state % 1000, (state >> 10) % 1_000_000_000_000);
            let text = format!("-{whole}.{decimals:012}");
            assert_eq!(decimal(text.as_bytes()).map(|read| read.value), text.parse().ok(), "{text}");
        }
    }
}
