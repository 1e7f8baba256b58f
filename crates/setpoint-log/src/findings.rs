//! The findings of a log.

use serde::Serialize;

use crate::log_place::LogPlace;
use crate::part_findings::PartFindings;
use crate::trace::TraceColumn;

/// A log as it was judged.
#[derive(Clone, Debug, Serialize)]
pub struct Judgement {
    /// Setpoints in the log.
    pub rows: u64,
    /// The time from its first setpoint to its last, in s.
    pub time_s: f64,
    /// The time between two setpoints, in s.
    pub period_s: f64,
    /// How far the motion may be from the positions in the log, in each axis, in mm: half a unit of their last decimal, or what was given.
    pub resolution_mm: f64,
    /// Whether the log shows the axes at rest at its begin and at its end.
    pub at_rest: [bool; 2],
    /// A row for each limit that the machine states.
    pub limits: Vec<JudgedLimit>,
    /// What was not judged, and why, a sentence for each.
    pub not_judged: Vec<String>,
    /// Rows that are there twice: the axes cannot stand there.
    pub doubled: Faults,
    /// Rows that are missing.
    pub missing: Faults,
    /// Rows that are missing while the axes stand at the same place before and behind: by times a pause of the log, by
    /// numbers a loss.
    pub missing_at_rest: Faults,
    /// The most rows that follow each other without a gap.
    pub longest_rows: u64,
    /// Standstills between motions.
    pub standstills: Standstills,
    /// Places at which the log leaves rapid moves out.
    pub left_out: u64,
    /// By how much the time between two rows is off the period, beyond how the times are rounded, in s.
    pub uneven_s: f64,
    /// The columns that pictures are drawn from, if [`LogOptions::traces`](crate::LogOptions::traces) asks for them.
    #[serde(skip)]
    pub trace: Vec<TraceColumn>,
    /// How the log follows a part, where one was given.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub part: Option<PartFindings>,
}

impl Judgement {
    /// The faults, in short.
    #[must_use]
    pub fn faults(&self) -> Vec<String> {
        let broken = self.limits.iter().filter(|limit| limit.verdict == LimitVerdict::Broken);
        let mut faults: Vec<String> = broken.map(|limit| format!("{} is broken", limit.what)).collect();
        for (rows, of) in [("twice", &self.doubled), ("missing", &self.missing)] {
            if of.places > 0 {
                faults.push(match of.rows {
                    0 => format!("rows are {rows}"),
                    1 => format!("1 row is {rows}"),
                    count => format!("{count} rows are {rows}"),
                });
            }
        }
        faults.extend(self.part.iter().flat_map(PartFindings::faults));
        faults
    }
}

/// Whether a limit is kept.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum LimitVerdict {
    /// The setpoints themselves keep it.
    Kept,
    /// A motion within the resolution keeps it, and one that breaks it by little is possible too.
    KeptWithin,
    /// No motion within the resolution keeps it.
    Broken,
    /// No motion within the resolution keeps it, unless the path has a corner there, of which the machine may cut some, or
    /// turns to and fro between two setpoints: the log does not say how it runs, and a part does.
    BrokenUnlessCorner,
    /// The log has no window without a gap over which it could be seen.
    NotJudged,
}

/// What is taken of a limit.
#[derive(Clone, Debug, Serialize)]
pub struct JudgedLimit {
    /// Of what it is a limit.
    pub what: &'static str,
    /// The axis, if it is a limit of one.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub axis: Option<&'static str>,
    /// The limit; that of the feed is the highest commanded.
    pub limit: f64,
    /// The unit of the limit.
    pub unit: &'static str,
    /// Whether it is kept.
    pub verdict: LimitVerdict,
    /// The largest share of the limit that setpoints take over single periods, as they are.
    pub raw: f64,
    /// The share of the limit that every motion within the resolution takes.
    pub taken: f64,
    /// The periods of the window in which that shows.
    pub periods: usize,
    /// Where it is.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub at: Option<LogPlace>,
    /// Where the log does not decide: how far a motion that keeps the limit may be from the positions, in each axis, in
    /// mm. It is more than the resolution where a window holds a corner that the machine may cut.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub seen_within_mm: Option<f64>,
    /// A log of positions within this, in mm, would decide whether the limit is kept, where this one does not.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub decided_below_mm: Option<f64>,
    /// Where the log does not decide: the least window over which it would show twice the limit, in periods.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub twice_shows_over_periods: Option<usize>,
    /// How many rows without a gap it takes to judge this limit at all.
    #[serde(skip)]
    pub rows_of_a_period: usize,
}

/// Rows that are there twice, or missing.
#[derive(Clone, Debug, Default, Serialize)]
pub struct Faults {
    /// Places at which that is so.
    pub places: u64,
    /// Rows in all of them.
    pub rows: u64,
    /// The first places, with the rows at each.
    pub first: Vec<(LogPlace, u64)>,
}

impl Faults {
    /// Places that are kept.
    const MOST: usize = 20;

    pub(crate) fn add(&mut self, at: LogPlace, rows: u64) {
        self.places += 1;
        self.rows += rows;
        if self.first.len() < Self::MOST {
            self.first.push((at, rows));
        }
    }
}

/// Standstills between motions.
#[derive(Clone, Debug, Default, Serialize)]
pub struct Standstills {
    /// How often the axes stand between two motions, for ten periods at least.
    pub count: u64,
    /// The longest, in s.
    pub longest_s: f64,
    /// Where that begins.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub at: Option<LogPlace>,
}
