//! A table: in the page, as CSV and as JSON.

use foreign_text::in_a_cell;
use serde_json::{Map, Value};

use crate::number;

/// A table with a name.
#[derive(Clone, Debug)]
pub struct Table {
    /// The name of its files, without ending.
    pub name: String,
    /// The title.
    pub title: String,
    /// Its columns.
    pub columns: Vec<Column>,
    /// Its rows, each with a cell for each column.
    pub rows: Vec<Vec<Cell>>,
}

/// A column.
#[derive(Clone, Copy, Debug)]
pub struct Column {
    /// Its name in files, with the unit.
    pub key: &'static str,
    /// Its heading in the page.
    pub heading: &'static str,
}

/// A cell of a table.
#[derive(Clone, Debug, PartialEq)]
pub enum Cell {
    /// Words.
    Text(String),
    /// A number.
    Number(f64),
    /// The value is unknown.
    Nothing,
}

impl Cell {
    /// A number that may be missing.
    pub(crate) fn maybe(value: Option<f64>) -> Self {
        value.map_or(Self::Nothing, Self::Number)
    }

    /// Words.
    pub(crate) fn text(text: impl Into<String>) -> Self {
        Self::Text(text.into())
    }

    /// The text in the page.
    #[must_use]
    pub fn shown(&self) -> String {
        match self {
            Self::Text(text) => text.clone(),
            Self::Number(number) => number::short(*number),
            Self::Nothing => "–".to_string(),
        }
    }

    /// Whether it is a number.
    #[must_use]
    pub fn is_number(&self) -> bool {
        !matches!(self, Self::Text(_))
    }

    /// The text in a file of CSV, with every digit.
    fn exact(&self) -> String {
        match self {
            Self::Text(text) => in_a_cell(text),
            Self::Number(number) => number.to_string(),
            Self::Nothing => String::new(),
        }
    }

    fn value(&self) -> Value {
        match self {
            Self::Text(text) => Value::from(text.as_str()),
            // JSON has neither infinity nor NaN.
            Self::Number(number) => Value::from(*number),
            Self::Nothing => Value::Null,
        }
    }
}

impl Table {
    /// As comma-separated values with a header.
    #[must_use]
    pub fn csv(&self) -> String {
        let mut writer = csv::Writer::from_writer(Vec::new());
        let header = self.columns.iter().map(|column| column.key.to_string()).collect();
        let rows = self.rows.iter().map(|row| row.iter().map(Cell::exact).collect::<Vec<_>>());
        for record in std::iter::once(header).chain(rows) {
            // A vector accepts everything that is written to it, and every row has a cell for each column.
            let _ = writer.write_record(record);
        }
        writer.into_inner().ok().and_then(|bytes| String::from_utf8(bytes).ok()).unwrap_or_default()
    }

    /// The table as a list of objects.
    #[must_use]
    pub fn json(&self) -> String {
        let object = |row: &Vec<Cell>| {
            let fields =
                self.columns.iter().zip(row).map(|(column, cell)| (column.key.to_string(), cell.value()));
            Value::Object(fields.collect::<Map<_, _>>())
        };
        let list = Value::Array(self.rows.iter().map(object).collect());
        format!("{list:#}\n")
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn files_keep_every_digit_and_quote_what_they_must() {
        let table = Table {
            name: "t".into(),
            title: "T".into(),
            columns: vec![
                Column { key: "format", heading: "format" },
                Column { key: "error_mm", heading: "error [mm]" },
            ],
            rows: vec![
                vec![Cell::text("say \"I8F24\", twice"), Cell::Number(0.1 + 0.2)],
                vec![Cell::text("f64"), Cell::Nothing],
                vec![Cell::text("-2+3"), Cell::Number(-2.5)],
            ],
        };
        let csv = table.csv();
        let lines: Vec<_> = csv.lines().collect();
        assert_eq!(lines[..2], ["format,error_mm", "\"say \"\"I8F24\"\", twice\",0.30000000000000004"]);
        assert_eq!(lines[2], "f64,");
        assert_eq!(lines[3], "'-2+3,-2.5", "words are no formula, and numbers stay numbers");
        let json: Value = serde_json::from_str(&table.json()).expect("JSON");
        assert_eq!(json[0]["error_mm"].as_f64(), Some(0.1 + 0.2));
        assert!(json[1]["error_mm"].is_null());
    }
}
