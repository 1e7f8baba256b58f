//! A key of a file, a word of a program or an option: what may be written there.

use crate::domain::{Domain, shown};

/// A place where a person writes a value.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Key {
    /// The name, as it is written.
    pub name: &'static str,
    /// What may be written.
    pub value: Value,
    /// What holds where nothing is written.
    pub left_out: LeftOut,
    /// What it is.
    pub meaning: &'static str,
}

/// What may be written at a key.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Value {
    /// A number.
    Number(Domain),
    /// A whole number, with its least, its greatest, and its unit or an empty text.
    Whole(u32, u32, &'static str),
    /// One of some words.
    Word(&'static [&'static str]),
    /// `true` or `false`.
    Truth,
    /// A text.
    Text,
    /// A list of other keys of the same table.
    Keys,
}

/// What holds where a key is left out.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum LeftOut {
    /// It must be there.
    Required,
    /// This number.
    Number(f64),
    /// What these words say; nothing if there are none.
    Words(&'static str),
}

impl Key {
    /// A key with a number, which must be there.
    #[must_use]
    pub const fn number(name: &'static str, domain: Domain, meaning: &'static str) -> Self {
        Self { name, value: Value::Number(domain), left_out: LeftOut::Required, meaning }
    }

    /// A key with a whole number, which must be there.
    #[must_use]
    pub const fn whole(
        name: &'static str,
        [least, most]: [u32; 2],
        unit: &'static str,
        meaning: &'static str,
    ) -> Self {
        Self { name, value: Value::Whole(least, most, unit), left_out: LeftOut::Required, meaning }
    }

    /// The same key, for which this number holds where it is left out.
    #[must_use]
    pub const fn or(self, default: f64) -> Self {
        Self { left_out: LeftOut::Number(default), ..self }
    }

    /// The same key, which may be left out; these words say what then holds.
    #[must_use]
    pub const fn optional(self, default: &'static str) -> Self {
        Self { left_out: LeftOut::Words(default), ..self }
    }

    /// The domain, if a number with a fraction may be written.
    #[must_use]
    pub const fn domain(&self) -> Option<Domain> {
        match self.value {
            Value::Number(domain) => Some(domain),
            _ => None,
        }
    }

    /// Whether a number may be written there.
    #[must_use]
    pub fn holds(&self, x: f64) -> bool {
        match self.value {
            Value::Number(domain) => domain.holds(x),
            Value::Whole(least, most, _) => {
                x.fract() == 0.0 && (f64::from(least)..=f64::from(most)).contains(&x)
            }
            Value::Word(_) | Value::Truth | Value::Text | Value::Keys => false,
        }
    }

    /// The unit of the number; empty if there is none.
    #[must_use]
    pub const fn unit(&self) -> &'static str {
        match self.value {
            Value::Number(domain) => domain.unit(),
            Value::Whole(_, _, unit) => unit,
            Value::Word(_) | Value::Truth | Value::Text | Value::Keys => "",
        }
    }

    /// The number that holds where the key is left out, if there is one.
    #[must_use]
    pub const fn default_number(&self) -> Option<f64> {
        match self.left_out {
            LeftOut::Number(number) => Some(number),
            _ => None,
        }
    }

    /// What is expected there.
    #[must_use]
    pub fn expected(&self) -> String {
        match self.value {
            Value::Number(domain) => domain.to_string(),
            Value::Whole(least, most, "") => format!("a whole number of {least} to {most}"),
            Value::Whole(least, most, unit) => format!("a whole number of {least} to {most} {unit}"),
            Value::Word(words) => {
                let quoted: Vec<String> = words.iter().map(|word| format!("\"{word}\"")).collect();
                match quoted.as_slice() {
                    [words @ .., last] if !words.is_empty() => format!("{} or {last}", words.join(", ")),
                    words => words.concat(),
                }
            }
            Value::Truth => "true or false".into(),
            Value::Text => "a text".into(),
            Value::Keys => "a list of numbers' keys in this table, as [\"jerk_mm_per_s3\"]".into(),
        }
    }

    /// What may be written, as a table has it.
    #[must_use]
    pub fn range(&self) -> String {
        match self.value {
            Value::Number(domain) => domain.range(),
            Value::Whole(least, most, _) => format!("whole, {least} to {most}"),
            Value::Word(words) => {
                words.iter().map(|word| format!("`\"{word}\"`")).collect::<Vec<_>>().join(", ")
            }
            Value::Truth => "true, false".into(),
            Value::Text => "text".into(),
            Value::Keys => "a list of keys".into(),
        }
    }

    /// Why a number may not be written there; `None` if it may.
    #[must_use]
    pub fn refusal(&self, x: f64) -> Option<String> {
        (!self.holds(x)).then(|| format!("`{}` is {}: expected {}", self.name, shown(x), self.expected()))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_key_says_what_is_expected() {
        let key = Key::whole("sub_steps", [1, 100], "", "steps");
        assert!(key.holds(100.0) && !key.holds(0.0) && !key.holds(1.5) && !key.holds(f64::NAN));
        assert_eq!(key.refusal(101.0).unwrap(), "`sub_steps` is 101: expected a whole number of 1 to 100");
        let words = Key { value: Value::Word(&["stop", "deviation"]), ..key };
        assert_eq!(words.expected(), "\"stop\" or \"deviation\"");
        assert_eq!(key.or(8.0).default_number(), Some(8.0));
    }
}
