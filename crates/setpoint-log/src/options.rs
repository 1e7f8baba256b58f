//! How a log is to be read and judged.

use part_program::Part;

use crate::columns::ColumnMap;
use crate::unit::LengthUnit;

/// How a log is to be read.
#[derive(Clone, Debug, Default)]
pub struct LogOptions {
    /// Which column is what, in place of the log's head.
    pub columns: Option<ColumnMap>,
    /// The unit of positions; `None` for that which such logs have, and mm where they have none.
    pub unit: Option<LengthUnit>,
    /// The time between two setpoints, in s; `None` for that of the log's times, or the machine's where it has none.
    pub period_s: Option<f64>,
    /// How far the motion may be from the positions in each axis, in mm; `None` for half of a unit of their last decimal.
    pub resolution_mm: Option<f64>,
    /// Whether the motion may also be off the positions by what `compare` lets a run be: half of the fluctuation that the machine allows in
    /// a full step, or half of what its drives resolve.
    pub as_run: bool,
    /// Whether the axes stand before the first row and behind the last. Else they do where the log shows it.
    pub from_rest_to_rest: bool,
    /// Whether to keep the columns that pictures are drawn from: [`Judgement::trace`](crate::Judgement::trace).
    pub traces: bool,
}

/// A part that a log is to follow.
#[derive(Clone, Copy, Debug)]
pub struct Followed<'a> {
    /// The part.
    pub part: &'a Part,
    /// The largest distance between the log and its path that is allowed, in mm, if one is. It stands for all that the part states.
    pub tolerance_mm: Option<f64>,
}
