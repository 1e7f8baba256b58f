//! A register: a signal and the widths that it has.

use real::FormatName;

/// A register.
#[derive(Clone, Debug, PartialEq)]
pub struct Register<'a> {
    /// The signal's name, which every language takes: see [`identifier`].
    pub signal: &'a str,
    /// What the signal is, in words of ASCII; may be empty.
    pub meaning: &'a str,
    /// Bits before the point, the sign among them.
    pub integer_bits: u32,
    /// Bits after the point.
    pub fraction_bits: u32,
    /// The largest magnitude that it must hold.
    pub bound: f64,
}

impl<'a> Register<'a> {
    /// The register of a signal that has the fixed-point format of this name; `None` for any other format.
    #[must_use]
    pub fn named(signal: &'a str, format: &str, bound: f64) -> Option<Self> {
        match FormatName::named(format)? {
            FormatName::Fixed { integer_bits, fraction_bits, .. } => {
                Some(Self { signal, meaning: "", integer_bits, fraction_bits, bound })
            }
            _ => None,
        }
    }

    /// Its width.
    #[must_use]
    pub fn bits(&self) -> u32 {
        self.integer_bits + self.fraction_bits
    }

    /// The width of the machine word that holds it: 8, 16, 32, 64 or 128 bits.
    pub(crate) fn word_bits(&self) -> u32 {
        self.bits().next_power_of_two().max(8)
    }

    /// What it is and its bound in decimals, rounded up.
    pub(crate) fn remark(&self) -> String {
        let meaning = if self.meaning.is_empty() { self.signal } else { self.meaning };
        format!("{meaning}; at most {:.4}", (self.bound * 1e4).ceil() / 1e4)
    }

    /// The signal's name in capitals at the beginning of each word and without underscores.
    pub(crate) fn in_camel_case(&self) -> String {
        let capital = |word: &str| word[..1].to_uppercase() + &word[1..];
        self.signal.split('_').filter(|word| !word.is_empty()).map(capital).collect()
    }
}

/// A name that every language takes, made of any: small letters of ASCII, digits and single underscores, a letter first.
///
/// ```
/// assert_eq!(register_types::identifier("Δx² (old)"), "x_old");
/// assert_eq!(register_types::identifier("2nd"), "s_2nd");
/// ```
#[must_use]
pub fn identifier(name: &str) -> String {
    let lower = name.to_ascii_lowercase();
    let words = lower.split(|c: char| !c.is_ascii_alphanumeric()).filter(|word| !word.is_empty());
    let joined = words.collect::<Vec<_>>().join("_");
    if joined.starts_with(|c: char| c.is_ascii_lowercase()) {
        joined
    } else {
        format!("s_{joined}").trim_end_matches('_').to_string()
    }
}
