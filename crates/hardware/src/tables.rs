//! The tables of a part: rows of columns. Tables whose rows belong together are a group with one row number.

use std::collections::HashMap;

use crate::error::CoreError;
use crate::operation::{Numbers, Op, Operand};
use crate::parser::{Unit, constant};
use crate::syntax::{Expression, Type, What};

/// The tables of each group, by their names in C.
const GROUPS: [&[&str]; 3] = [&["pieces", "numerators", "weights"], &["stages", "crossings"], &["sections"]];

/// A column: words of the table as they stand, or what an operation makes of other columns of the same row.
#[derive(Clone, Debug, PartialEq, Eq, Hash)]
pub(crate) enum Column {
    Given { group: usize, place: usize },
    Made { group: usize, op: Op, operands: [ColumnOperand; 3] },
}

/// What an operation on columns reads.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub(crate) enum ColumnOperand {
    Column(u16),
    Constant(i64),
    /// A constant of the part, by its number.
    Parameter(u16),
}

/// Where a table stands: its group, the first of its columns, and the type of a row.
#[derive(Clone, Debug)]
pub(crate) struct Place {
    pub(crate) group: usize,
    pub(crate) first: usize,
    pub(crate) row: Type,
}

/// All tables.
#[derive(Clone, Debug)]
pub(crate) struct Tables {
    numbers: Numbers,
    places: HashMap<String, Place>,
    /// For each group and row the words as given.
    given: Vec<Vec<Vec<i64>>>,
    /// The constants of the part.
    pub(crate) parameters: Vec<i64>,
    columns: Vec<Column>,
    known: HashMap<Column, u16>,
}

impl Tables {
    /// The tables among the constants of the text.
    pub(crate) fn of(unit: &Unit, numbers: Numbers) -> Result<Self, CoreError> {
        let mut tables = Self {
            numbers,
            places: HashMap::new(),
            given: vec![Vec::new(); GROUPS.len()],
            parameters: Vec::new(),
            columns: Vec::new(),
            known: HashMap::new(),
        };
        for (group, names) in GROUPS.iter().enumerate() {
            for name in *names {
                let Some(table) = unit.constants.get(*name) else { continue };
                let Type::Array(row, None) = &table.of else { continue };
                let What::List(rows) = &table.values.what else { continue };
                let first = tables.given.get(group).and_then(|rows| rows.first()).map_or(0, Vec::len);
                tables.add(group, rows, unit)?;
                tables.places.insert((*name).to_owned(), Place { group, first, row: (**row).clone() });
            }
        }
        Ok(tables)
    }

    fn add(&mut self, group: usize, rows: &[Expression], unit: &Unit) -> Result<(), CoreError> {
        let Some(given) = self.given.get_mut(group) else { return Ok(()) };
        if given.is_empty() {
            given.resize(rows.len(), Vec::new());
        }
        for (words, row) in given.iter_mut().zip(rows) {
            flatten(row, unit, words)?;
        }
        Ok(())
    }

    /// The place of a table.
    pub(crate) fn place(&self, name: &str) -> Option<&Place> {
        self.places.get(name)
    }

    /// The place of the table whose rows are of this struct.
    pub(crate) fn place_of_rows(&self, row: &str) -> Option<&Place> {
        self.places.values().find(|place| place.row == Type::Struct(row.to_owned()))
    }

    /// The number of a column, which is new or known.
    pub(crate) fn column(&mut self, column: Column) -> u16 {
        if let Some(number) = self.known.get(&column) {
            return *number;
        }
        let number = u16::try_from(self.columns.len()).unwrap_or(u16::MAX);
        self.columns.push(column.clone());
        self.known.insert(column, number);
        number
    }

    /// The column that an operation makes of columns of one row, if all operands are such or constants.
    pub(crate) fn made(&mut self, op: Op, operands: &[Operand; 3]) -> Option<Operand> {
        let mut row = None;
        let mut taken = [ColumnOperand::Constant(0); 3];
        for (operand, taken) in operands.iter().zip(&mut taken) {
            *taken = match *operand {
                Operand::Constant(value) => ColumnOperand::Constant(value),
                Operand::Parameter(number) => ColumnOperand::Parameter(number),
                Operand::Column(register, column) if row.is_none_or(|row| row == register) => {
                    row = Some(register);
                    ColumnOperand::Column(column)
                }
                _ => return None,
            };
        }
        let row = row?;
        let group = taken.iter().find_map(|operand| match operand {
            ColumnOperand::Column(column) => Some(self.group_of(*column)),
            ColumnOperand::Constant(_) | ColumnOperand::Parameter(_) => None,
        })?;
        Some(Operand::Column(row, self.column(Column::Made { group, op, operands: taken })))
    }

    /// The group of a column.
    pub(crate) fn group_of(&self, column: u16) -> usize {
        match self.columns.get(usize::from(column)) {
            Some(Column::Given { group, .. } | Column::Made { group, .. }) => *group,
            None => 0,
        }
    }

    /// Rows of a group.
    pub(crate) fn rows(&self, group: usize) -> usize {
        self.given.get(group).map_or(0, Vec::len)
    }

    /// The groups.
    pub(crate) fn groups() -> usize {
        GROUPS.len()
    }

    /// A word: a column of a row. Beyond the last row it is 0, as the hardware may read any row before a branch says that it is none.
    pub(crate) fn word(&self, column: u16, row: i64) -> i64 {
        match self.columns.get(usize::from(column)) {
            Some(Column::Given { group, place }) => {
                let words = usize::try_from(row).ok().and_then(|row| self.given.get(*group)?.get(row));
                words.and_then(|words| words.get(*place)).copied().unwrap_or(0)
            }
            Some(Column::Made { op, operands, .. }) => {
                let values = operands.map(|operand| match operand {
                    ColumnOperand::Column(column) => self.word(column, row),
                    ColumnOperand::Constant(value) => value,
                    ColumnOperand::Parameter(number) => {
                        self.parameters.get(usize::from(number)).copied().unwrap_or(0)
                    }
                });
                self.numbers.value(*op, values)
            }
            None => 0,
        }
    }
}

/// The words of a row, one after the other.
fn flatten(row: &Expression, unit: &Unit, words: &mut Vec<i64>) -> Result<(), CoreError> {
    match &row.what {
        What::List(parts) => parts.iter().try_for_each(|part| flatten(part, unit, words)),
        What::Name(name) if unit.numbers.contains_key(name) => {
            words.extend(unit.numbers.get(name));
            Ok(())
        }
        _ => match constant(row) {
            Some(value) => {
                words.push(value);
                Ok(())
            }
            None => Err(CoreError::subset(row.line, "tables of anything but whole numbers")),
        },
    }
}
