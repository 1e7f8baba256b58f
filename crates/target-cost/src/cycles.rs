//! A number of cycles, or another cost, as an interval with a middle.

use std::iter::Sum;
use std::ops::{Add, Mul};

use domains::shown;
use serde::{Deserialize, Serialize};

/// Low, typical and high. A cost may depend on neighbouring instructions, on operands or on an implementation, and a
/// manual may leave it open: it then lies between low and high.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Cycles {
    /// The fewest.
    pub low: f64,
    /// The number to expect.
    pub typical: f64,
    /// The most.
    pub high: f64,
}

/// Which of the three.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Level {
    /// [`Cycles::low`].
    Low,
    /// [`Cycles::typical`].
    Typical,
    /// [`Cycles::high`].
    High,
}

impl Cycles {
    /// A cost that is known exactly: low, typical and high are equal.
    #[must_use]
    pub const fn exactly(cycles: f64) -> Self {
        Self { low: cycles, typical: cycles, high: cycles }
    }

    /// Each of the three, made by `of`.
    pub fn each(mut of: impl FnMut(Level) -> f64) -> Self {
        Self { low: of(Level::Low), typical: of(Level::Typical), high: of(Level::High) }
    }

    /// Whether low is at most typical, and typical at most high.
    pub(crate) fn rises(&self) -> bool {
        self.low <= self.typical && self.typical <= self.high
    }

    /// The three as a target file has them.
    pub(crate) fn in_a_file(&self) -> String {
        let [low, typical, high] = [self.low, self.typical, self.high].map(shown);
        format!("{{ low = {low}, typical = {typical}, high = {high} }}")
    }

    /// One of the three.
    #[must_use]
    pub const fn at(&self, level: Level) -> f64 {
        match level {
            Level::Low => self.low,
            Level::Typical => self.typical,
            Level::High => self.high,
        }
    }

    /// The larger of two, level by level.
    #[must_use]
    pub fn max(self, other: Self) -> Self {
        Self::each(|level| self.at(level).max(other.at(level)))
    }
}

impl Add for Cycles {
    type Output = Self;

    fn add(self, other: Self) -> Self {
        Self::each(|level| self.at(level) + other.at(level))
    }
}

impl Mul<f64> for Cycles {
    type Output = Self;

    fn mul(self, factor: f64) -> Self {
        Self::each(|level| self.at(level) * factor)
    }
}

impl Sum for Cycles {
    fn sum<I: Iterator<Item = Self>>(cycles: I) -> Self {
        cycles.fold(Self::default(), Add::add)
    }
}
