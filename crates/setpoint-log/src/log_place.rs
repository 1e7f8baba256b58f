//! A place in a log.

use limit_judge::StepPlace;
use serde::Serialize;

/// A place in a log.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct LogPlace {
    /// The row, from 1, without a head.
    pub row: u64,
    /// The time, in s: that of the log if it has times, else since its first row.
    pub time_s: f64,
    /// The line of the program that the log names, if it names one.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub line: Option<usize>,
    /// Where the axes are, in mm.
    pub point_mm: [f64; 3],
}

impl LogPlace {
    /// Of a setpoint, in a log whose first has this time.
    pub(crate) fn of(at: &StepPlace, begin_s: f64, period_s: f64) -> Self {
        Self {
            row: at.row,
            time_s: begin_s + at.index as f64 * period_s,
            line: (at.curve > 0).then_some(at.curve),
            point_mm: at.point_mm,
        }
    }
}
