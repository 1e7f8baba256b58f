//! Cycles from the classes of instructions, by a processor manual's table.
//!
//! A table has a row a class: cycles of one execution, more for each word moved, more when the branch is taken, each as
//! low, typical and high. What a manual leaves to an implementation or to the neighbours of an instruction is what lies
//! between low and high. Memory without wait states; flash that is slower comes on top.

use std::collections::BTreeMap;

use serde::{Deserialize, Serialize};

use crate::Failure;
use crate::calls::Counts;

/// Low, typical and high.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub(crate) struct Cycles {
    pub(crate) low: f64,
    pub(crate) typical: f64,
    pub(crate) high: f64,
}

#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
struct Row {
    cycles: [f64; 3],
    /// For each word.
    #[serde(default)]
    per_word: f64,
    /// When taken.
    #[serde(default)]
    taken: [f64; 3],
    /// The place in the manual, and whether the row was compared with it.
    #[allow(dead_code, reason = "for the reader of the file")]
    source: String,
    #[allow(dead_code, reason = "for the reader of the file")]
    checked: bool,
}

/// The table of a core.
#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct Table {
    #[allow(dead_code, reason = "for the reader of the file")]
    core: String,
    #[allow(dead_code, reason = "for the reader of the file")]
    manual: String,
    class: BTreeMap<String, Row>,
}

impl Table {
    pub(crate) fn parse(text: &str) -> Result<Self, Failure> {
        Ok(toml::from_str(text)?)
    }

    /// Cycles of one call on average; `None` if a class has no row.
    pub(crate) fn price(&self, counts: &Counts) -> Option<Cycles> {
        let mut sum = [0.0; 3];
        for (class, tally) in &counts.classes {
            let row = self.class.get(&class.to_string())?;
            for (sum, (once, taken)) in sum.iter_mut().zip(row.cycles.into_iter().zip(row.taken)) {
                *sum += once * tally.count as f64
                    + taken * tally.taken as f64
                    + row.per_word * tally.words as f64;
            }
        }
        let [low, typical, high] = sum.map(|s| (s / counts.calls.len() as f64).round());
        Some(Cycles { low, typical, high })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::calls::Tally;
    use crate::instruction::Class;

    #[test]
    fn every_table_is_complete_enough_and_ordered() {
        for text in [
            include_str!("../cycles/cortex-m0plus.toml"),
            include_str!("../cycles/cortex-m3.toml"),
            include_str!("../cycles/cortex-m4.toml"),
            include_str!("../cycles/ibex.toml"),
        ] {
            let table = Table::parse(text).unwrap();
            for (name, row) in &table.class {
                assert!(Class::ALL.iter().any(|c| c.to_string() == *name), "no class {name}");
                for [low, typical, high] in [row.cycles, row.taken] {
                    assert!(low <= typical && typical <= high, "{} {name}", table.core);
                }
            }
        }
    }

    #[test]
    fn a_loop_is_priced_by_hand() {
        // Ten additions, ten branches of which nine are taken, one push of three registers: on the M4 10·1, 10·1 + 9·P
        // with P from 1 to 3, and 1 + 3.
        let classes = [
            (Class::Alu, Tally { count: 10, taken: 0, words: 10 }),
            (Class::BranchConditional, Tally { count: 10, taken: 9, words: 10 }),
            (Class::StoreMultiple, Tally { count: 1, taken: 0, words: 3 }),
        ];
        let counts = Counts { calls: vec![21], classes: classes.into_iter().collect() };
        let table = Table::parse(include_str!("../cycles/cortex-m4.toml")).unwrap();
        assert_eq!(table.price(&counts), Some(Cycles { low: 33.0, typical: 42.0, high: 51.0 }));
    }
}
