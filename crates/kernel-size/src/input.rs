//! Inputs: recorded, drawn from a seed, or generated.

use std::fmt;

/// An input: a name, the range that its values keep, and a value for each step.
#[derive(Clone, Debug, PartialEq)]
pub struct Input {
    pub(crate) name: &'static str,
    pub(crate) range: (f64, f64),
    pub(crate) values: Vec<f64>,
}

/// What is wrong with an input.
#[derive(Clone, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub enum InputError {
    /// A range without a number in it.
    Range {
        /// The input.
        input: String,
        /// The range.
        range: String,
    },
    /// A value outside of the range, or no number.
    Value {
        /// The input.
        input: String,
        /// The step, from 0.
        step: usize,
        /// The value.
        value: String,
        /// The range.
        range: String,
    },
    /// A text that is no table of numbers.
    Csv {
        /// The line, from 1.
        line: u64,
        /// What was read, and what was expected.
        what: String,
    },
}

impl Input {
    /// The values, one for each step.
    #[must_use]
    pub fn values(&self) -> &[f64] {
        &self.values
    }

    /// A recording.
    ///
    /// # Errors
    /// [`InputError`] if a value is outside of the range, or no number.
    pub fn recorded(name: &'static str, range: (f64, f64), values: Vec<f64>) -> Result<Self, InputError> {
        let shown = || format!("{:e} to {:e}", range.0, range.1);
        let is_range = range.0 <= range.1 && range.0.is_finite() && range.1.is_finite();
        if !is_range {
            return Err(InputError::Range { input: name.to_string(), range: shown() });
        }
        match values.iter().enumerate().find(|(_, value)| !(range.0..=range.1).contains(*value)) {
            None => Ok(Self { name, range, values }),
            Some((step, value)) => Err(InputError::Value {
                input: name.to_string(),
                step,
                value: value.to_string(),
                range: shown(),
            }),
        }
    }

    /// Numbers drawn evenly from the range: the same for the same seed, on every machine.
    ///
    /// # Errors
    /// [`InputError::Range`] for a range without a number in it.
    pub fn drawn(name: &'static str, seed: u64, range: (f64, f64), steps: usize) -> Result<Self, InputError> {
        let mut state = seed;
        let draw = |_| {
            let part = split_mix(&mut state);
            (range.0 + part * (range.1 - range.0)).clamp(range.0.min(range.1), range.0.max(range.1))
        };
        Self::recorded(name, range, (0..steps).map(draw).collect())
    }

    /// Numbers of a formula, by the number of the step from 0.
    ///
    /// # Errors
    /// [`InputError`] if a value is outside of the range, or no number.
    pub fn generated(
        name: &'static str,
        range: (f64, f64),
        steps: usize,
        of: impl FnMut(usize) -> f64,
    ) -> Result<Self, InputError> {
        Self::recorded(name, range, (0..steps).map(of).collect())
    }

    /// The column of this name in a text of comma-separated values with a line of names at its top.
    ///
    /// # Errors
    /// [`InputError`] if there is no such column, a cell is no number, or a value is outside of the range.
    pub fn in_csv(name: &'static str, range: (f64, f64), text: &str) -> Result<Self, InputError> {
        let wrong = |line: u64, what: String| InputError::Csv { line, what };
        let mut reader = csv::ReaderBuilder::new().trim(csv::Trim::All).from_reader(text.as_bytes());
        let header = reader.headers().map_err(|error| wrong(1, error.to_string()))?.clone();
        let column = header.iter().position(|one| one == name);
        let column = column.ok_or_else(|| {
            let names: Vec<&str> = header.iter().collect();
            wrong(1, format!("columns {}: expected {name} among them", names.join(", ")))
        })?;
        let mut values = Vec::new();
        for row in reader.records() {
            let row = row
                .map_err(|error| wrong(error.position().map_or(0, csv::Position::line), error.to_string()))?;
            let cell = row.get(column).unwrap_or_default();
            let line = row.position().map_or(0, csv::Position::line);
            values.push(
                cell.parse().map_err(|_| wrong(line, format!("{name} = {cell:?}: expected a number")))?,
            );
        }
        Self::recorded(name, range, values)
    }
}

/// The next number in [0, 1).
///
/// # Source
/// Steele, Lea and Flood, "Fast splittable pseudorandom number generators", OOPSLA 2014: SplitMix64.
#[allow(clippy::cast_precision_loss, reason = "53 bits")]
fn split_mix(state: &mut u64) -> f64 {
    *state = state.wrapping_add(0x9e37_79b9_7f4a_7c15);
    let mut mixed = *state;
    mixed = (mixed ^ (mixed >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
    mixed = (mixed ^ (mixed >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
    ((mixed ^ (mixed >> 31)) >> 11) as f64 * 2.0_f64.powi(-53)
}

impl fmt::Display for InputError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Range { input, range } => {
                write!(f, "input {input}: range {range}: expected the least number first, and finite ones")
            }
            Self::Value { input, step, value, range } => {
                write!(f, "input {input}, step {step}: {value}: expected a number from {range}")
            }
            Self::Csv { line, what } => write!(f, "line {line}: {what}"),
        }
    }
}

impl std::error::Error for InputError {}
