//! Numbers written for people.

/// A number on a linear axis whose numbers are `step` apart: it has no more decimals than the step, and thousands are
/// separated.
pub(crate) fn tick(value: f64, step: f64) -> String {
    let decimals = (0..12).find(|d| {
        let scaled = step * 10.0_f64.powi(*d);
        (scaled - scaled.round()).abs() < 1e-6 * scaled
    });
    let text = format!("{value:.*}", decimals.unwrap_or(12).unsigned_abs() as usize);
    let text = if text.trim_start_matches('-').chars().all(|c| c == '0' || c == '.') {
        text.replace('-', "")
    } else {
        text
    };
    grouped(&text)
}

/// Separates thousands by narrow spaces, from ten thousand on.
fn grouped(text: &str) -> String {
    let (number, fraction) = text.split_once('.').map_or((text, None), |(n, f)| (n, Some(f)));
    let (sign, digits) = number.strip_prefix('-').map_or(("", number), |digits| ("−", digits));
    let mut whole = String::new();
    for (index, digit) in digits.chars().enumerate() {
        let left = digits.len() - index;
        if digits.len() > 4 && index > 0 && left % 3 == 0 {
            whole.push('\u{202f}');
        }
        whole.push(digit);
    }
    fraction.map_or_else(|| format!("{sign}{whole}"), |fraction| format!("{sign}{whole}.{fraction}"))
}

/// `10⁻⁶` for -6.
pub(crate) fn power_of_ten(exponent: f64) -> String {
    let superscript = |digit: char| match digit {
        '-' => '⁻',
        '1' => '¹',
        '2' => '²',
        '3' => '³',
        digit => digit.to_digit(10).and_then(|d| char::from_u32(0x2070 + d)).unwrap_or(digit),
    };
    let digits: String = format!("{exponent:.0}").chars().map(superscript).collect();
    match digits.as_str() {
        "⁰" | "⁻⁰" => "1".to_string(),
        _ => format!("10{digits}"),
    }
}

/// A number with two or three digits, as a power of ten if it is very large or very small.
pub(crate) fn short(value: f64) -> String {
    let size = value.abs();
    if value == 0.0 {
        "0".to_string()
    } else if !(1e-3..1e5).contains(&size) {
        let (digits, exponent) = format!("{value:.1e}").split_once('e').map_or_else(
            || (value.to_string(), 0.0),
            |(digits, exponent)| (digits.replace('-', "−"), exponent.parse().unwrap_or(0.0)),
        );
        format!("{digits}·{}", power_of_ten(exponent))
    } else if size >= 100.0 {
        grouped(&format!("{value:.0}"))
    } else {
        let decimals = match size {
            10.0.. => 1,
            1.0.. => 2,
            0.1.. => 3,
            0.01.. => 4,
            _ => 5,
        };
        let text = format!("{value:.decimals$}");
        grouped(text.trim_end_matches('0').trim_end_matches('.'))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn ticks_have_the_decimals_of_their_step() {
        assert_eq!([tick(0.5, 0.5), tick(2.0, 0.25), tick(-0.0, 0.1)], ["0.5", "2.00", "0.0"]);
        assert_eq!(
            [tick(400_000.0, 1e5), tick(-20_000.0, 1e4), tick(5000.0, 1e3)],
            ["400\u{202f}000", "−20\u{202f}000", "5000"]
        );
        assert_eq!(tick(0.0005, 0.0001), "0.0005");
    }

    #[test]
    fn powers_and_short_numbers() {
        assert_eq!([power_of_ten(-12.0), power_of_ten(0.0), power_of_ten(3.0)], ["10⁻¹²", "1", "10³"]);
        assert_eq!(
            [short(2.53e-7), short(-1e-9), short(4.0), short(0.0)],
            ["2.5·10⁻⁷", "−1.0·10⁻⁹", "4", "0"]
        );
        assert_eq!(
            [short(834.7), short(1.96), short(0.5), short(123_456.0)],
            ["835", "1.96", "0.5", "1.2·10⁵"]
        );
    }
}
