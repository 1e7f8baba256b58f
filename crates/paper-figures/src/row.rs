//! One figure: printed, and as it comes out here.

use serde::Serialize;

/// What a paper prints of a quantity.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Printed {
    /// A number.
    Number(f64),
    /// A limit that is kept, with no number of how well.
    AtMost(f64),
    /// Words, with no number.
    Words(&'static str),
}

/// One figure of a paper beside ours.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Row {
    /// The paper, `A` to `D`.
    pub paper: char,
    /// The place in it: a table, a figure, an equation or a section.
    pub place: &'static str,
    /// The quantity.
    pub quantity: String,
    /// Its unit; empty for a ratio or a count.
    pub unit: &'static str,
    /// What is printed.
    pub printed: Printed,
    /// What comes out here.
    pub measured: f64,
    /// The setting behind our figure.
    pub setting: &'static str,
    /// Why the two differ; empty where they agree.
    pub reason: &'static str,
}

impl Row {
    /// Ours over the printed number, or over the printed limit; `None` without a number above or below 0.
    #[must_use]
    pub fn ratio(&self) -> Option<f64> {
        match self.printed {
            Printed::Number(printed) | Printed::AtMost(printed) if printed != 0.0 => {
                Some(self.measured / printed)
            }
            _ => None,
        }
    }

    /// Whether ours is within 2 % of the printed number, or keeps the printed limit; words agree with what they name.
    #[must_use]
    pub fn agrees(&self) -> bool {
        match self.printed {
            Printed::Number(printed) => (self.measured - printed).abs() <= 0.02 * printed.abs(),
            // Rounding may put what is at its limit above it.
            Printed::AtMost(most) => self.measured <= most * (1.0 + 1e-12),
            Printed::Words(_) => self.reason.is_empty(),
        }
    }
}
