//! Numbers as C constants, every bit kept.

use real::{Backend, FormatName};
use secant_interp::fixed_point_word;

use crate::name::CError;

/// The type that holds numbers of a format; `None` if C has none.
pub(crate) fn number_type(format: FormatName) -> Option<&'static str> {
    match format {
        FormatName::Float { bits: 32 } => Some("float"),
        FormatName::Float { bits: 64 } => Some("double"),
        FormatName::Fixed { integer_bits: integer_bits @ 2.., fraction_bits, .. }
            if format == FormatName::fixed(integer_bits, fraction_bits) =>
        {
            match format.bits() {
                8 => Some("int8_t"),
                16 => Some("int16_t"),
                32 => Some("int32_t"),
                64 => Some("int64_t"),
                _ => None,
            }
        }
        _ => None,
    }
}

/// The type that stands for numbers of a format where C is read and not compiled: any width from 16 to 32 bits has one.
pub(crate) fn described_type(format: FormatName) -> Option<&'static str> {
    match format {
        FormatName::Fixed { integer_bits: integer_bits @ 2.., fraction_bits, .. }
            if format == FormatName::fixed(integer_bits, fraction_bits)
                && (16..=32).contains(&format.bits()) =>
        {
            Some("int32_t")
        }
        _ => None,
    }
}

/// Refuses a format that C has no type for.
///
/// # Errors
/// [`CError::NoType`].
pub fn expect_type(format: FormatName) -> Result<(), CError> {
    number_type(format).map(|_| ()).ok_or(CError::NoType(format))
}

/// Refuses a format that a description has no numbers for.
///
/// # Errors
/// [`CError::NoWidth`].
pub fn expect_described(format: FormatName) -> Result<(), CError> {
    described_type(format).map(|_| ()).ok_or(CError::NoWidth(format))
}

/// A number as a constant of its format's type.
pub(crate) fn number<R: Backend>(x: R) -> String {
    match R::name() {
        FormatName::Float { bits: 32 } => hexadecimal(x.to_f64()) + "f",
        FormatName::Float { .. } => hexadecimal(x.to_f64()),
        name => word(fixed_point_word(x), name.bits()),
    }
}

/// A signed word. The least word has no constant of its own in C: its magnitude does not fit the type.
pub(crate) fn word(word: i64, bits: u32) -> String {
    if bits == 64 {
        return if word == i64::MIN { "(-INT64_MAX - 1)".to_owned() } else { format!("INT64_C({word})") };
    }
    if word == i64::from(i32::MIN) { "(-INT32_MAX - 1)".to_owned() } else { word.to_string() }
}

/// A float in hexadecimal, which every compiler reads exactly: `0x1.8p+1` is 3. A subnormal number of 32 bits is a normal
/// one of 64, and just as exact.
fn hexadecimal(x: f64) -> String {
    let sign = if x.is_sign_negative() { "-" } else { "" };
    let bits = x.abs().to_bits();
    let (exponent, digits) = ((bits >> 52).cast_signed() - 1023, bits & ((1 << 52) - 1));
    if bits == 0 {
        format!("{sign}0.0")
    } else if x.abs() < f64::MIN_POSITIVE {
        format!("{sign}{}p-1022", trimmed("0x0.", digits))
    } else {
        format!("{sign}{}p{exponent:+}", trimmed("0x1.", digits))
    }
}

/// The digits behind the point without the zeros at their end.
fn trimmed(whole: &str, digits: u64) -> String {
    let text = format!("{whole}{digits:013x}");
    let kept = text.trim_end_matches('0');
    if kept.ends_with('.') { format!("{kept}0") } else { kept.to_owned() }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;
    use real::{I4F28, I4F60};

    #[test]
    fn constants_are_c() {
        assert_eq!(number(3.0_f64), "0x1.8p+1");
        assert_eq!(number(-0.5_f32), "-0x1.0p-1f");
        assert_eq!(number(0.0_f32), "0.0f");
        assert_eq!(number(5e-324_f64), "0x0.0000000000001p-1022");
        assert_eq!(number(I4F28::from_bits(i32::MIN)), "(-INT32_MAX - 1)");
        assert_eq!(number(I4F28::from_bits(-7)), "-7");
        assert_eq!(number(I4F60::from_bits(i64::MAX)), format!("INT64_C({})", i64::MAX));
        assert_eq!(number(I4F60::from_bits(i64::MIN)), "(-INT64_MAX - 1)");
    }

    #[test]
    fn types_are_those_of_machine_words() {
        assert_eq!(number_type(FormatName::fixed(5, 11)), Some("int16_t"));
        assert_eq!(number_type(FormatName::fixed(5, 13)), None);
        assert_eq!(number_type(FormatName::fixed(1, 31)), None, "it does not hold 1");
        assert_eq!(number_type(FormatName::DoubleDouble), None);
    }

    /// Reads a constant back: sign, digits and exponent.
    fn value(text: &str) -> f64 {
        let (sign, rest) = text.strip_prefix('-').map_or((1.0, text), |rest| (-1.0, rest));
        let Some(rest) = rest.strip_prefix("0x") else { return sign * 0.0 };
        let (digits, exponent) = rest.trim_end_matches('f').split_once('p').expect("an exponent");
        let (whole, behind) = digits.split_once('.').expect("a point");
        let scale = 2.0_f64.powi(exponent.parse::<i32>().expect("a number"));
        let unit = behind.bytes().fold(1.0, |unit, _| unit / 16.0);
        let behind = u64::from_str_radix(behind, 16).expect("digits") as f64 * unit;
        sign * (whole.parse::<f64>().expect("a digit") * scale + behind * scale)
    }

    proptest! {
        #[test]
        fn floats_come_back(x in prop::num::f64::NORMAL | prop::num::f64::ZERO, y in prop::num::f32::NORMAL) {
            prop_assert_eq!(value(&number(x)), x);
            prop_assert_eq!(value(&number(y)), f64::from(y));
        }
    }
}
