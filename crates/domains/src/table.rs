//! The tables of all keys, for the book.

use std::fmt::Write;

use crate::key::{Key, LeftOut};
use crate::{curve, machine, options, servo, target, words};

/// Keys that stand together.
#[derive(Clone, Copy, Debug)]
pub struct Table {
    /// Where they stand.
    pub title: &'static str,
    /// The keys, in the order in which they are explained.
    pub keys: &'static [Key],
}

/// Every number, word and truth that a person can write.
pub const TABLES: [Table; 8] = [
    Table { title: "`[machine]`", keys: &machine::KEYS },
    Table { title: "`[machine.axes.x]`", keys: &machine::AXIS_KEYS },
    Table { title: "`[machine.axes.a]`", keys: &machine::ROTARY_KEYS },
    Table { title: "`[curve]`", keys: &curve::KEYS },
    Table { title: "`[servo]`", keys: &servo::KEYS },
    Table { title: "a target file", keys: &target::KEYS },
    Table { title: "words of a part program", keys: &words::KEYS },
    Table { title: "options", keys: &options::KEYS },
];

/// A table in Markdown.
#[must_use]
pub fn markdown(table: &Table) -> String {
    let mut text = String::from("| key | unit | what it is | allowed | default |\n|---|---|---|---|---|\n");
    for key in table.keys {
        let default = match key.left_out {
            LeftOut::Required => String::new(),
            LeftOut::Number(number) => crate::domain::end(number),
            LeftOut::Words(words) => words.to_string(),
        };
        let _ = writeln!(
            text,
            "| `{}` | {} | {} | {} | {default} |",
            key.name,
            key.unit(),
            key.meaning,
            key.range()
        );
    }
    text
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Value;

    #[test]
    fn every_default_is_within_its_domain_and_every_name_is_there_once() {
        for table in TABLES {
            for (index, key) in table.keys.iter().enumerate() {
                if let Some(number) = key.default_number() {
                    assert!(key.holds(number), "{}: {number}", key.name);
                }
                assert!(table.keys[..index].iter().all(|other| other.name != key.name), "{}", key.name);
                assert!(!key.meaning.is_empty() && !key.meaning.contains('\n'), "{}", key.name);
            }
        }
    }

    /// No end is nothing, or everything.
    #[test]
    fn every_number_has_two_ends() {
        for key in TABLES.iter().flat_map(|table| table.keys) {
            match key.value {
                Value::Number(domain) => {
                    let (least, most) = (domain.least(), domain.most());
                    assert!(least.is_finite() && most.is_finite() && least < most, "{}", key.name);
                    assert!(least == 0.0 || least.abs() >= 1e-16, "{}: {least}", key.name);
                    assert!(!domain.holds(5e-324) && !domain.holds(f64::MAX) || least <= 0.0, "{}", key.name);
                }
                Value::Whole(least, most, _) => assert!(least < most, "{}", key.name),
                Value::Word(words) => assert!(words.len() > 1, "{}", key.name),
                Value::Truth | Value::Text | Value::Keys => {}
            }
        }
    }

    #[test]
    fn a_table_is_markdown() {
        let table = markdown(&TABLES[0]);
        assert!(
            table.contains(
                "| `interpolation_period_ms` | ms | T, the time between two setpoints | 0.001 to 1000 |  |"
            ),
            "{table}"
        );
        assert!(
            table.contains("| `max_iterations` |  | K, ") && table.contains("| whole, 1 to 1000 | 8 |"),
            "{table}"
        );
    }
}
