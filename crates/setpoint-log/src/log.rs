//! A log that is read and judged: rows in, findings out, in memory that does not grow with the log.

use std::collections::VecDeque;
use std::io::Read;

use domains::machine::PERIOD;
use part_program::StatedLimits;

use crate::csv_log::CsvLog;
use crate::findings::Judgement;
use crate::judge::{Corners, Judge};
use crate::log_error::LogError;
use crate::log_period::{in_another_unit, period_of_times};
use crate::machine_limits::clock_limits;
use crate::motan_log::MotanLog;
use crate::options::{Followed, LogOptions};
use crate::part_follower::PartFollower;
use crate::part_path::PartPath;
use crate::period::Clock;
use crate::row::{Row, Rows};
use crate::text::begun;
use crate::tolerances::Tolerances;

/// Rows by which the time between two is told.
const FIRST_ROWS: usize = 256;

/// A log that is being read, with its first rows.
pub struct Log<'a> {
    rows: Box<dyn Rows + 'a>,
    first: VecDeque<Row>,
    period_s: f64,
    marks_corners: bool,
    /// Whether the log leaves rapid moves out: one that has the length of each step tells them by it.
    leaves_rapids_out: bool,
    /// Whether it has positions of each axis, and how many more joints it has.
    has_axes: [bool; 3],
    other_axes: usize,
    machine: StatedLimits,
    options: LogOptions,
}

impl<'a> Log<'a> {
    /// Begins to read a log, which is to be judged by the limits of a machine.
    ///
    /// # Errors
    /// [`LogError`] with the place of the first fault in the begin of the log's text.
    pub fn begin(
        source: impl Read + 'a,
        machine: &StatedLimits,
        options: &LogOptions,
    ) -> Result<Self, LogError> {
        let text = begun(source)?;
        // A log of moves can be sampled at any period, so an assumed one will do.
        let stated_ms = machine.interpolation_period_ms.or(machine.assumed_value(None, PERIOD.name));
        let sampled_s = options.period_s.or(stated_ms.map(|period| 1e-3 * period));
        let marks_corners = MotanLog::begins(&text.head);
        let mut has_axes = [true; 3];
        let (mut rows, other_axes, leaves_rapids_out): (Box<dyn Rows + 'a>, usize, bool) = if marks_corners {
            let period_s = sampled_s.ok_or_else(|| {
                let expected = "--period with the time between two";
                LogError::whole("a log of moves has no setpoints of its own", expected)
            })?;
            (Box::new(MotanLog::new(text, period_s)), 0, false)
        } else {
            let log = CsvLog::new(text, options.columns.as_ref(), options.unit)?;
            has_axes = log.columns.axes.map(|column| column.is_some());
            let (other_axes, has_chords) = (log.columns.other_axes, log.columns.chord.is_some());
            (Box::new(log), other_axes, has_chords)
        };
        let mut first = VecDeque::new();
        while first.len() < FIRST_ROWS {
            let Some(row) = rows.next_row()? else { break };
            first.push_back(row);
        }
        if first.len() < 2 {
            let message = format!("setpoints in the log: {}", first.len());
            return Err(LogError::whole(message, "a row for each of two or more"));
        }
        let period_s = period_of(&first, rows.time_resolution_s(), machine, options)?;
        let (machine, options) = (machine.clone(), options.clone());
        Ok(Self {
            rows,
            first,
            period_s,
            marks_corners,
            leaves_rapids_out,
            has_axes,
            other_axes,
            machine,
            options,
        })
    }

    /// Where the axes are in the first row, in mm.
    #[must_use]
    pub fn first_point_mm(&self) -> [f64; 3] {
        self.first.front().map_or([0.0; 3], |row| row.point_mm)
    }

    /// Judges the log by the limits of its machine, and by how it follows a part.
    ///
    /// # Errors
    /// [`LogError`] with the place of the first fault in the log's text; or a curve of the part that is not valid.
    pub fn judge(self, followed: Option<Followed<'_>>) -> Result<Judgement, LogError> {
        let Some(Followed { part, tolerance_mm }) = followed else { return self.judge_with(None, None) };
        let invalid = |error| LogError::whole(format!("a curve of the part: {error}"), "valid curves");
        let mut path = PartPath::new(part, self.machine.feedrate_mm_per_s).map_err(invalid)?;
        if tolerance_mm.is_some() {
            path.tolerances = Tolerances::new(&[]);
        }
        if path.segments.is_empty() {
            return Err(LogError::whole("the part has no moves", "a part with a path"));
        }
        let (first, with) = (self.first_point_mm(), (self.period_s, tolerance_mm));
        let follower = PartFollower::new(&path, &self.machine, (&first, self.leaves_rapids_out), with);
        let highest = path.moves.iter().filter(|one| !one.is_rapid).filter_map(|one| one.feed_mm_per_s);
        let highest = highest.reduce(f64::max);
        self.judge_with(Some(follower), highest)
    }

    fn judge_with(
        mut self,
        follower: Option<PartFollower<'_>>,
        highest: Option<f64>,
    ) -> Result<Judgement, LogError> {
        let feed = if follower.is_some() { highest } else { self.machine.feedrate_mm_per_s };
        let corners = match &follower {
            Some(_) => Corners::OfPart,
            None if self.marks_corners => Corners::Marked,
            None => Corners::Unknown,
        };
        let mut judge =
            Judge::new((&self.machine, feed), self.has_axes, &self.options, self.period_s, corners);
        if follower.is_none() && judge.limits.is_empty() && judge.along.limits.is_empty() {
            let said = format!("nothing can be judged: {}", judge.not_judged.join("; "));
            return Err(LogError::whole(said, "one of these limits in the machine's file, or --part"));
        }
        judge.follower = follower;
        let mut clock =
            Clock::new(clock_limits(&self.machine, self.period_s), self.options.period_s.is_some());
        loop {
            let next = match self.first.pop_front() {
                Some(row) => Some(row),
                None => self.rows.next_row()?,
            };
            let r_mm = judge.resolution_mm(self.rows.resolution_mm());
            let Some(row) = next else {
                clock.finish(r_mm, &mut |event| judge.take(event, r_mm));
                let mut judgement = judge.finished(r_mm);
                judgement.uneven_s = clock.uneven_s;
                if self.other_axes > 0 {
                    let said = format!("{} more joints: three at a time, by --columns", self.other_axes);
                    judgement.not_judged.push(said);
                }
                return Ok(judgement);
            };
            judge.look_at(&row);
            clock.take(row, (r_mm, self.rows.time_resolution_s()), &mut |event| judge.take(event, r_mm))?;
        }
    }
}

/// Judges a log by the limits of a machine.
///
/// # Errors
/// [`LogError`] with the place of the first fault in the log's text.
pub fn judge(source: impl Read, machine: &StatedLimits, options: &LogOptions) -> Result<Judgement, LogError> {
    Log::begin(source, machine, options)?.judge(None)
}

/// The time between two setpoints: what was asked for; that of the log's times; the machine's.
fn period_of(
    rows: &VecDeque<Row>,
    time_resolution_s: f64,
    machine: &StatedLimits,
    options: &LogOptions,
) -> Result<f64, LogError> {
    if let Some(period_s) = options.period_s {
        return Ok(period_s);
    }
    let stated = machine.interpolation_period_ms.map(|period| 1e-3 * period);
    let assumed = machine.assumed_value(None, PERIOD.name);
    if let Some(period_s) = period_of_times(rows, time_resolution_s, stated)? {
        let of_machine = stated.or(assumed.map(|period| 1e-3 * period));
        return match of_machine.and_then(|of_machine| in_another_unit(rows, period_s, of_machine)) {
            Some(error) => Err(error),
            None => Ok(period_s),
        };
    }
    stated.ok_or_else(|| {
        let more = assumed.map_or(String::new(), |ms| format!("; {ms} ms is assumed"));
        LogError::whole(
            format!("neither the log nor the machine says how long a period is{more}"),
            "--period with it in ms, or interpolation_period_ms in the machine's file",
        )
    })
}
