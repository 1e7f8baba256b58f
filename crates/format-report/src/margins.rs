//! How much of each limit the recommended run uses.

use format_compare::{Machine, Row};

/// A requirement, what was found, and the limit.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Margin {
    /// What is required.
    pub(crate) requirement: &'static str,
    /// What was found.
    pub(crate) found: f64,
    /// The most that is allowed.
    pub(crate) limit: f64,
    /// The unit of both.
    pub(crate) unit: &'static str,
}

impl Margin {
    /// The part of the limit that is used; none where the limit is zero.
    pub(crate) fn used(&self) -> Option<f64> {
        (self.limit > 0.0).then(|| self.found / self.limit)
    }
}

/// The requirements that a verdict is made of, with a run's figures; empty if the format was refused.
pub(crate) fn margins(row: &Row, machine: &Machine) -> Vec<Margin> {
    let chord = machine.chord_error_mm;
    let one = |requirement, found: Option<f64>, limit, unit| {
        found.map(|found| Margin { requirement, found, limit, unit })
    };
    let figures = [
        one(
            "feedrate fluctuation at cruise",
            row.fluctuation.map(|f| f.cruise_max_abs),
            machine.fluctuation_limit,
            "ratio",
        ),
        one("chord error", row.chord_error_mm_max, chord, "mm"),
        one("position error", row.position_error_mm_max, chord, "mm"),
        one("distance from the end of the path", row.end_error_mm, chord, "mm"),
        one("overflows", row.saturations.map(|count| count as f64), 0.0, "count"),
    ];
    figures.into_iter().flatten().collect()
}
