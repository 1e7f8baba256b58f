//! What a log says of one setpoint.

use crate::log_error::LogError;

/// A setpoint as the log has it, in mm and s.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(crate) struct Row {
    /// Number of the row, from 1.
    pub(crate) number: u64,
    /// Its line in the log's text, from 1; 0 where a setpoint is made of what the text says of a move.
    pub(crate) text_line: u64,
    /// The column of its time or number in that line, from 1.
    pub(crate) time_column: usize,
    /// Its time, in s, if the log has times.
    pub(crate) time_s: Option<f64>,
    /// Its number as the controller counts, if the log has one.
    pub(crate) sample: Option<f64>,
    /// Where it is, in mm.
    pub(crate) point_mm: [f64; 3],
    /// The program's line that the log names, 0 if it names none.
    pub(crate) program_line: usize,
    /// The length of the step to it, in mm, if the log has it.
    pub(crate) chord_mm: Option<f64>,
    /// Whether the log says that setpoints before it were lost.
    pub(crate) is_behind_loss: bool,
    /// Whether the velocity may jump in the step to it.
    pub(crate) passes_corner: bool,
}

/// Where rows come from.
pub(crate) trait Rows {
    /// The next row; `None` at the end.
    fn next_row(&mut self) -> Result<Option<Row>, LogError>;

    /// Half of a unit of the last decimal that any position so far was written with, in mm.
    fn resolution_mm(&self) -> f64;

    /// Half of a unit of the last decimal that any time so far was written with, in s.
    fn time_resolution_s(&self) -> f64;
}
