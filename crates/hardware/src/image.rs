//! The table memory of a part: loaded registers first, then the rows of each group.

use crate::graph::Item;
use crate::microcode::Microcode;
use crate::program::Program;

/// The words of the table memory.
#[derive(Clone, Debug)]
pub(crate) struct Image {
    pub(crate) words: Vec<i64>,
}

impl Image {
    /// The memory of a program's tables as microcode reads it.
    pub(crate) fn of(program: &Program, microcode: &Microcode) -> Self {
        let row = 1 << microcode.column_bits;
        let mut words = vec![0; microcode.header.len().next_multiple_of(row)];
        let mut addresses = Vec::new();
        for (group, layout) in microcode.layouts.iter().enumerate() {
            let base = words.len().next_multiple_of(1 << layout.bits);
            words.resize(base, 0);
            addresses.push(i64::try_from(base).unwrap_or(i64::MAX));
            for row in (0..).take(program.tables.rows(group)) {
                words.extend(layout.columns.iter().map(|column| program.tables.word(*column, row)));
                words.resize(words.len().next_multiple_of(1 << layout.bits), 0);
            }
        }
        addresses.extend(microcode.layouts.iter().map(|layout| 1 << layout.bits));
        for (to, item) in words.iter_mut().zip(&microcode.header) {
            *to = match item {
                Item::Constant(value) => *value,
                Item::Parameter(number) => {
                    let number = usize::from(*number);
                    addresses
                        .get(number)
                        .copied()
                        .unwrap_or_else(|| program.parameters.get(number).map_or(0, |(_, value)| *value))
                }
                _ => 0,
            };
        }
        Self { words }
    }
}
