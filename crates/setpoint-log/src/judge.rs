//! The judge of a log: rows in, findings out, in memory that does not grow with the log.

use std::collections::VecDeque;
use std::io::Read;

use limit_judge::{Differences, LimitFinding, Of, Setpoint, StatedLimit, StepPlace, Way};
use part_program::{Junction, Part, StatedLimits};

use crate::along_path::{AlongPath, OfPath};
use crate::columns::ColumnMap;
use crate::csv_log::CsvLog;
use crate::findings::{Faults, JudgedLimit, Judgement, LimitVerdict, Standstills};
use crate::log_error::LogError;
use crate::log_period::period_of_times;
use crate::log_place::LogPlace;
use crate::machine_limits::{LogLimit, clock_limits, limits_of};
use crate::motan_log::MotanLog;
use crate::part_follower::PartFollower;
use crate::part_path::{PartPath, distance};
use crate::period::{Clock, Event, Setpoint as Timed};
use crate::row::{Row, Rows};
use crate::text::begun;
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
    /// Whether the axes stand before the first row and behind the last. Else they do where the log shows it.
    pub from_rest_to_rest: bool,
}

/// Differences of numbers that a computer took are off by some units of their last place.
const ROUNDED: f64 = 4.0 * f64::EPSILON;
/// Motions keep the limits that a machine states up to their last digits.
const SLACK: f64 = 1e-6;
/// Rows by which the time between two is told.
const FIRST_ROWS: usize = 256;
/// A standstill of fewer periods is none that a person would see.
const LEAST_STAND: u64 = 10;

/// A part that a log is to follow.
#[derive(Clone, Copy, Debug)]
pub struct Followed<'a> {
    /// The part.
    pub part: &'a Part,
    /// The largest distance between the log and its path that is allowed, in mm, if one is.
    pub tolerance_mm: Option<f64>,
}

/// A log that is being read, with its first rows.
pub struct Log<'a> {
    rows: Box<dyn Rows + 'a>,
    first: VecDeque<Row>,
    period_s: f64,
    marks_corners: bool,
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
        let stated_s = options.period_s.or(machine.interpolation_period_ms.map(|period| 1e-3 * period));
        let marks_corners = MotanLog::begins(&text.head);
        let (mut rows, other_axes): (Box<dyn Rows + 'a>, usize) = if marks_corners {
            let period_s = stated_s.ok_or_else(|| {
                let expected = "--period with the time between two";
                LogError::whole("a log of moves has no setpoints of its own", expected)
            })?;
            (Box::new(MotanLog::new(text, period_s)), 0)
        } else {
            let log = CsvLog::new(text, options.columns.as_ref(), options.unit)?;
            let other_axes = log.columns.other_axes;
            (Box::new(log), other_axes)
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
        let (machine, options) = (*machine, options.clone());
        Ok(Self { rows, first, period_s, marks_corners, other_axes, machine, options })
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
        let path = PartPath::new(part, self.machine.feedrate_mm_per_s).map_err(invalid)?;
        if path.segments.is_empty() {
            return Err(LogError::whole("the part has no moves", "a part with a path"));
        }
        let (first, with) = (self.first_point_mm(), (self.period_s, tolerance_mm));
        let follower = PartFollower::new(&path, &self.machine, &first, with);
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
        let mut judge = Judge::new((&self.machine, feed), &self.options, self.period_s, self.marks_corners);
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
    if let Some(period_s) = period_of_times(rows, time_resolution_s, stated)? {
        return Ok(period_s);
    }
    stated.ok_or_else(|| {
        LogError::whole(
            "neither the log nor the machine says how long a period is",
            "--period with it in ms, or interpolation_period_ms in the machine's file",
        )
    })
}

/// Setpoints as they come, and what was found so far.
struct Judge<'p> {
    follower: Option<PartFollower<'p>>,
    /// How much of a part's path may have been passed in rows that are missing before the next setpoint, in mm.
    unseen_mm: f64,
    /// The last step, in mm.
    step_mm: f64,
    last_point: Option<[f64; 3]>,
    limits: Vec<LogLimit>,
    differences: Differences,
    along: AlongPath,
    not_judged: Vec<String>,
    period_s: f64,
    feed_mm: f64,
    given_r_mm: Option<f64>,
    from_rest_to_rest: bool,
    jumps_at_corners: bool,
    /// The largest coordinate, in mm.
    largest_mm: f64,
    /// A setpoint of which it is not known whether the axes rest there.
    waiting: Option<Timed>,
    /// Where the axes stand before `waiting`, if they do.
    standing: Option<[f64; 3]>,
    begin: Option<Row>,
    begins_at_rest: bool,
    has_moved: bool,
    /// Since when the axes stand, and for how many periods.
    stand: Option<(Timed, u64)>,
    rows: u64,
    last_period: u64,
    doubled: Faults,
    missing: Faults,
    standstills: Standstills,
    left_out: u64,
}

impl Judge<'_> {
    fn new(
        (machine, feed_mm_per_s): (&StatedLimits, Option<f64>),
        options: &LogOptions,
        period_s: f64,
        marks_corners: bool,
    ) -> Self {
        let jumps = machine.junction == Junction::VelocityJump;
        let mut limits = limits_of(machine, period_s, feed_mm_per_s);
        let mut not_judged = not_stated(machine, feed_mm_per_s);
        if jumps && !marks_corners {
            limits.retain(|limit| limit.stated.order == 0);
            not_judged.push(
                "acceleration and jerk: the velocity may jump at corners, and the log does not say where they are".into(),
            );
        }
        let judges_path = !jumps;
        let stated: Vec<_> = limits.iter().map(|limit| limit.stated).collect();
        Self {
            follower: None,
            unseen_mm: 0.0,
            step_mm: 0.0,
            last_point: None,
            differences: Differences::new(&stated),
            along: AlongPath::new(
                machine.acceleration_mm_per_s2.filter(|_| judges_path).map(|most| most * period_s.powi(2)),
                machine.jerk_mm_per_s3.filter(|_| judges_path).map(|most| most * period_s.powi(3)),
            ),
            limits,
            not_judged,
            period_s,
            feed_mm: feed_mm_per_s.map_or(f64::INFINITY, |feed| feed * period_s),
            given_r_mm: options.resolution_mm,
            from_rest_to_rest: options.from_rest_to_rest,
            jumps_at_corners: jumps && marks_corners,
            largest_mm: 0.0,
            waiting: None,
            standing: None,
            begin: None,
            begins_at_rest: false,
            has_moved: false,
            stand: None,
            rows: 0,
            last_period: 0,
            doubled: Faults::default(),
            missing: Faults::default(),
            standstills: Standstills::default(),
            left_out: 0,
        }
    }

    /// How far the motion may be from the log's positions, of which this is half of a unit of the last decimal.
    fn resolution_mm(&self, of_log_mm: f64) -> f64 {
        self.given_r_mm.unwrap_or(of_log_mm).max(ROUNDED * self.largest_mm)
    }

    fn look_at(&mut self, row: &Row) {
        self.rows += 1;
        self.largest_mm = row.point_mm.iter().fold(self.largest_mm, |most, x| most.max(x.abs()));
    }

    fn take(&mut self, event: Event, r_mm: f64) {
        match event {
            Event::Setpoint(next) => self.pass(next, r_mm),
            Event::Doubled { row, count } => {
                let at = self.place_of(&row);
                self.doubled.add(at, count);
            }
            Event::Lost { row, count } => {
                let at = self.place_of(&row);
                self.missing.add(at, count);
                self.end_section(false, r_mm);
                let way_mm = self.last_point.map_or(0.0, |from| distance(&from, &row.point_mm));
                self.unseen_mm = 10.0 + 1.5 * way_mm.max(count as f64 * self.step_mm);
            }
            Event::LeftOut { row } => {
                self.left_out += 1;
                let way_mm = self.last_point.map_or(0.0, |from| distance(&from, &row.point_mm));
                self.unseen_mm = 10.0 + 3.0 * way_mm;
                self.end_section(true, r_mm);
            }
            Event::Stood { count, .. } => {
                let from = self.waiting;
                self.end_section(true, r_mm);
                self.standing = from.map(|from| from.row.point_mm);
                if let Some(from) = from {
                    self.stand =
                        Some(self.stand.map_or((from, count), |(from, before)| (from, before + count)));
                }
            }
        }
    }

    /// The place of a row that is no setpoint of the motion: a period behind the last.
    fn place_of(&self, row: &Row) -> LogPlace {
        let at = StepPlace {
            index: self.last_period + 1,
            row: row.number,
            curve: row.program_line,
            point_mm: row.point_mm,
        };
        let place = LogPlace::of(&at, self.begin_s(), self.period_s);
        LogPlace { time_s: row.time_s.unwrap_or(place.time_s), ..place }
    }

    fn begin_s(&self) -> f64 {
        self.begin.and_then(|row| row.time_s).unwrap_or(0.0)
    }

    /// Ends a section at the setpoint that waits.
    fn end_section(&mut self, at_rest: bool, r_mm: f64) {
        if let Some(last) = self.waiting.take() {
            self.look(last, at_rest, r_mm);
        }
        if !at_rest {
            self.differences.break_off();
            self.along.end_section(false, r_mm * 3.0_f64.sqrt());
        }
        self.standing = None;
    }

    /// Takes a setpoint, and looks at the one before it.
    fn pass(&mut self, next: Timed, r_mm: f64) {
        self.last_period = next.period;
        if self.begin.is_none() {
            self.begin = Some(next.row);
            if self.from_rest_to_rest {
                self.begins_at_rest = true;
                self.standing = Some(next.row.point_mm);
            }
        }
        if let Some(before) = self.waiting.replace(next) {
            let is_same = stands(&before.row, &next.row, r_mm);
            if before.period == 0 && is_same && !self.begins_at_rest {
                self.begins_at_rest = true;
                self.standing = Some(before.row.point_mm);
            }
            self.count_stand(before, is_same);
            self.look(before, false, r_mm);
        }
    }

    /// Counts the periods for which the axes stand between two motions.
    fn count_stand(&mut self, before: Timed, is_same: bool) {
        if is_same {
            self.stand = Some(self.stand.map_or((before, 1), |(from, count)| (from, count + 1)));
            return;
        }
        if let Some((from, count)) = self.stand.take()
            && self.has_moved
            && count >= LEAST_STAND
        {
            let time_s = count as f64 * self.period_s;
            self.standstills.count += 1;
            if time_s > self.standstills.longest_s {
                let at = LogPlace::of(&place(&from), self.begin_s(), self.period_s);
                (self.standstills.longest_s, self.standstills.at) = (time_s, Some(at));
            }
        }
        self.has_moved = true;
    }

    /// Judges the windows that end with a setpoint.
    fn look(&mut self, at: Timed, ends_at_rest: bool, r_mm: f64) {
        let (begin_s, period_s) = (self.begin_s(), self.period_s);
        let point = at.row.point_mm;
        let unseen_mm = std::mem::take(&mut self.unseen_mm);
        if let Some(from) = self.last_point.replace(point) {
            self.step_mm = distance(&from, &point);
        }
        let feed_mm = match &mut self.follower {
            Some(follower) => follower.follow(
                &LogPlace::of(&place(&at), begin_s, period_s),
                unseen_mm,
                2.0 * r_mm * 3.0_f64.sqrt(),
            ),
            None => self.feed_mm,
        };
        let next = Setpoint {
            at: place(&at),
            way: Way::default(),
            feed_mm,
            passes_corner: self.jumps_at_corners && at.row.passes_corner,
            corner: None,
            ends_at_rest,
        };
        let standing = self.standing.take();
        let rho_mm = r_mm * 3.0_f64.sqrt();
        self.along.add(next.at, standing.is_some(), rho_mm);
        if ends_at_rest {
            self.along.end_section(true, rho_mm);
        }
        self.differences.add(standing, Way::default(), next);
    }

    /// What was found, at the end of the log.
    fn finished(mut self, r_mm: f64) -> Judgement {
        let ends_at_rest = self.from_rest_to_rest || self.stand.is_some();
        self.end_section(ends_at_rest, r_mm);
        let corners = if self.jumps_at_corners { None } else { Some(0.0) };
        let by_axis = self.differences.findings(r_mm, corners);
        // A point that is off by r in each axis is off by √3 r.
        let by_vector = self.differences.findings(r_mm * 3.0_f64.sqrt(), corners);
        let found = by_axis.iter().zip(&by_vector).zip(&self.limits);
        let limits = found.map(|((axis, vector), limit)| match limit.stated.of {
            Of::Vector => self.judged(limit, vector),
            _ => self.judged(limit, axis),
        });
        let mut limits: Vec<JudgedLimit> = limits.collect();
        let own = self.along.limits.iter().map(|found| self.judged_along(found));
        let behind_feed = limits.iter().take_while(|limit| limit.axis.is_none()).count();
        limits.splice(behind_feed..behind_feed, own.collect::<Vec<_>>());
        Judgement {
            limits,
            rows: self.rows,
            time_s: self.last_period as f64 * self.period_s,
            period_s: self.period_s,
            resolution_mm: r_mm,
            at_rest: [self.begins_at_rest, ends_at_rest],
            not_judged: self.not_judged,
            doubled: self.doubled,
            missing: self.missing,
            standstills: self.standstills,
            left_out: self.left_out,
            uneven_s: 0.0,
            part: self.follower.map(|follower| follower.finished(2.0 * r_mm)),
        }
    }

    fn judged_along(&self, found: &OfPath) -> JudgedLimit {
        let power = i32::try_from(found.order + 1).unwrap_or(0);
        let value = found.most * self.period_s.powi(-power);
        let stated = StatedLimit { of: Of::Path, order: found.order, most: found.most };
        let limit = LogLimit { stated, value };
        let is_kept = found.raw.figure <= 1.0;
        self.judged(
            &limit,
            &LimitFinding {
                limit: stated,
                raw: found.raw,
                taken: if is_kept { found.raw } else { found.excess },
                periods: if is_kept { 1 } else { found.periods },
                seen_within_mm: None,
                decided_below_mm: 0.0,
            },
        )
    }

    fn judged(&self, limit: &LogLimit, found: &LimitFinding) -> JudgedLimit {
        let verdict = match found.taken.figure <= 1.0 + SLACK {
            _ if found.raw.at.is_none() => LimitVerdict::NotJudged,
            true if found.raw.figure <= 1.0 + SLACK => LimitVerdict::Kept,
            true => LimitVerdict::KeptWithin,
            false => LimitVerdict::Broken,
        };
        let place = if verdict == LimitVerdict::Broken { found.taken.at } else { found.raw.at };
        // A point that is off by r in each axis is off by √3 r.
        let spread = if limit.stated.of == Of::Vector { 3.0_f64.sqrt() } else { 1.0 };
        let is_open = verdict == LimitVerdict::KeptWithin;
        JudgedLimit {
            what: limit.stated.what(),
            axis: limit.axis(),
            limit: limit.value,
            unit: limit.unit(),
            verdict,
            raw: found.raw.figure,
            // Below 0 the resolution hides more than there is.
            taken: if found.taken.figure < 0.0 { 0.0 } else { found.taken.figure },
            periods: found.periods,
            at: place.map(|at| LogPlace::of(&at, self.begin_s(), self.period_s)),
            decided_below_mm: (is_open && found.decided_below_mm > 0.0)
                .then_some(found.decided_below_mm / spread),
        }
    }
}

/// What the machine's file does not limit.
fn not_stated(machine: &StatedLimits, feed_mm_per_s: Option<f64>) -> Vec<String> {
    let axes = [machine.axes.x, machine.axes.y, machine.axes.z];
    let lacks = |name: &str, has: [bool; 3]| {
        let missing: Vec<&str> =
            ["X", "Y", "Z"].into_iter().zip(has).filter(|(_, has)| !has).map(|(axis, _)| axis).collect();
        (!missing.is_empty()).then(|| format!("{name} of {}: the machine states none", missing.join(", ")))
    };
    let along = |name: &str, has: bool, of: &str| (!has).then(|| format!("{name}: {of} states none"));
    [
        along("feed", feed_mm_per_s.is_some(), "neither the machine nor a part"),
        along("acceleration along the path", machine.acceleration_mm_per_s2.is_some(), "the machine"),
        along("jerk along the path", machine.jerk_mm_per_s3.is_some(), "the machine"),
        lacks("velocity", axes.map(|axis| axis.velocity_mm_per_s.is_some())),
        lacks("acceleration", axes.map(|axis| axis.acceleration_mm_per_s2.is_some())),
        lacks("jerk", axes.map(|axis| axis.jerk_mm_per_s3.is_some())),
    ]
    .into_iter()
    .flatten()
    .collect()
}

fn place(at: &Timed) -> StepPlace {
    let Timed { row, period } = at;
    StepPlace { index: *period, row: row.number, curve: row.program_line, point_mm: row.point_mm }
}

/// Whether two rows are at the same place, as far as is seen.
fn stands(one: &Row, other: &Row, r_mm: f64) -> bool {
    one.point_mm.iter().zip(&other.point_mm).all(|(from, to)| (from - to).abs() <= 2.0 * r_mm)
}
