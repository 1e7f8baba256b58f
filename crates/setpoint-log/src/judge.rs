//! The judge of setpoints as they come: findings in memory that does not grow with the log.

use domains::machine::DEVIATION;
use limit_judge::{Differences, LimitFinding, Of, Setpoint, StepPlace, Way};
use part_program::{Junction, StatedLimits, coarse_increment_mm};

use crate::along_path::AlongPath;
use crate::findings::{Faults, JudgedLimit, Judgement, Standstills};
use crate::log_place::LogPlace;
use crate::machine_limits::{LogLimit, limits_of, most_turns, not_in_log, not_stated};
use crate::options::LogOptions;
use crate::part_follower::PartFollower;
use crate::part_path::distance;
use crate::period::{Event, Setpoint as Timed};
use crate::row::Row;
use crate::trace::{Trace, TracePoint};
use crate::verdict::Verdicts;

/// Differences of numbers that a computer took are off by some units of their last place.
const ROUNDED: f64 = 4.0 * f64::EPSILON;
/// A standstill of fewer periods is none that a person would see.
const LEAST_STAND: u64 = 10;

/// What is known of the corners of a path, at which a machine may cut some of it or jump in velocity.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Corners {
    /// Any step may pass one: short moves to and fro within a period leave no turn in the log.
    Unknown,
    /// The log marks them.
    Marked,
    /// The part has them.
    OfPart,
}

/// Setpoints as they come, and what was found so far.
pub(crate) struct Judge<'p> {
    pub(crate) follower: Option<PartFollower<'p>>,
    /// How much of a part's path may have been passed in rows that are missing before the next setpoint, in mm.
    unseen_mm: f64,
    /// The last step, in mm.
    step_mm: f64,
    last_point: Option<[f64; 3]>,
    pub(crate) limits: Vec<LogLimit>,
    differences: Differences,
    pub(crate) along: AlongPath,
    trace: Option<Trace>,
    pub(crate) not_judged: Vec<String>,
    period_s: f64,
    feed_mm: f64,
    given_r_mm: Option<f64>,
    /// If the log is judged as a run of ours: the fluctuation of a full step, and the increment of the drives, both in mm.
    of_run_mm: Option<(f64, Option<f64>)>,
    from_rest_to_rest: bool,
    corners: Corners,
    junction: Junction,
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
    missing_at_rest: Faults,
    /// Rows since the last gap, and the most without one.
    stretch_rows: u64,
    longest_rows: u64,
    standstills: Standstills,
    left_out: u64,
}

impl Judge<'_> {
    pub(crate) fn new(
        (machine, feed_mm_per_s): (&StatedLimits, Option<f64>),
        has_axes: [bool; 3],
        options: &LogOptions,
        period_s: f64,
        corners: Corners,
    ) -> Self {
        let junction = junction_of(machine, corners);
        let jumps = junction == Junction::VelocityJump;
        let mut limits = limits_of(machine, period_s, feed_mm_per_s, corners == Corners::OfPart);
        let mut not_judged = not_stated(machine, feed_mm_per_s);
        not_judged.extend(not_in_log(&mut limits, has_axes));
        if jumps && corners == Corners::Unknown {
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
            trace: options.traces.then(|| Trace::new(&stated, period_s)),
            along: AlongPath::new(
                machine.acceleration_mm_per_s2.filter(|_| judges_path).map(|most| most * period_s.powi(2)),
                machine.jerk_mm_per_s3.filter(|_| judges_path).map(|most| most * period_s.powi(3)),
                most_turns(machine, junction, period_s),
            ),
            limits,
            not_judged,
            period_s,
            feed_mm: feed_mm_per_s.map_or(f64::INFINITY, |feed| feed * period_s),
            given_r_mm: options.resolution_mm,
            of_run_mm: options.as_run.then(|| {
                let full_step_mm = feed_mm_per_s.unwrap_or(0.0) * period_s;
                (machine.fluctuation_limit * full_step_mm, coarse_increment_mm(machine.position_increment_mm))
            }),
            from_rest_to_rest: options.from_rest_to_rest,
            corners,
            junction,
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
            missing_at_rest: Faults::default(),
            stretch_rows: 0,
            longest_rows: 0,
            standstills: Standstills::default(),
            left_out: 0,
        }
    }

    /// How far the motion may be from the log's positions, of which this is half of a unit of the last decimal.
    pub(crate) fn resolution_mm(&self, of_log_mm: f64) -> f64 {
        self.given_r_mm.unwrap_or(of_log_mm).max(ROUNDED * self.largest_mm)
    }

    /// How far the motion may be from the log's positions where limits are judged.
    fn seen_within_mm(&self, r_mm: f64) -> f64 {
        self.of_run_mm.map_or(r_mm, |(fluctuation_mm, increment_mm)| {
            limit_judge::seen_within_mm(r_mm, fluctuation_mm, increment_mm)
        })
    }

    pub(crate) fn look_at(&mut self, row: &Row) {
        self.rows += 1;
        self.largest_mm = row.point_mm.iter().fold(self.largest_mm, |most, x| most.max(x.abs()));
    }

    pub(crate) fn take(&mut self, event: Event, r_mm: f64) {
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
                self.end_section(true, r_mm);
                let way_mm = self.last_point.map_or(0.0, |from| distance(&from, &row.point_mm));
                self.unseen_mm = 10.0 + 3.0 * way_mm;
            }
            Event::Stood { row, count } => {
                let at = self.place_of(&row);
                self.missing_at_rest.add(at, count);
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
        // Nothing says where the next one begins, unless the axes are known to stand there.
        self.differences.break_off();
        if !at_rest {
            self.along.end_section(false, self.seen_within_mm(r_mm) * 3.0_f64.sqrt());
        }
        self.standing = None;
        if let Some(trace) = &mut self.trace {
            trace.end_section();
        }
        self.longest_rows = self.longest_rows.max(std::mem::take(&mut self.stretch_rows));
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
        self.stretch_rows += 1;
        let (rho_mm, seen_mm) = (r_mm * 3.0_f64.sqrt(), self.seen_within_mm(r_mm));
        let from = self.last_point.replace(point);
        self.step_mm = from.map_or(self.step_mm, |from| distance(&from, &point));
        let mut next = Setpoint {
            at: place(&at),
            way: Way::default(),
            feed_mm: self.feed_mm,
            passes_corner: self.corners == Corners::Unknown && self.junction != Junction::Stop
                || at.row.passes_corner,
            corner: None,
            ends_at_rest,
        };
        // A log that has the length of each step says how much shorter the straight way is.
        let mut detour_mm = at
            .row
            .chord_mm
            .map(|length_mm| (length_mm - from.map_or(0.0, |from| distance(&from, &point))).max(0.0));
        if let Some(follower) = &mut self.follower {
            let followed =
                follower.follow(&LogPlace::of(&next.at, begin_s, period_s), unseen_mm, 2.0 * rho_mm);
            (next.feed_mm, next.passes_corner) = (followed.feed_mm, followed.corner.is_some());
            detour_mm = Some(followed.detour_mm.max(detour_mm.unwrap_or(0.0)));
            next.corner = followed.corner.filter(|_| self.junction == Junction::VelocityJump);
        }
        let standing = self.standing.take();
        if let Some(trace) = &mut self.trace {
            let LogPlace { time_s, point_mm, .. } = LogPlace::of(&next.at, begin_s, period_s);
            let (feed_mm, stands_before) = (next.feed_mm, standing.is_some());
            let hides = || self.junction.hidden_at_corners_mm().unwrap_or(f64::INFINITY);
            // Where nobody knows the corners, each step would pass one.
            let is_known = self.corners != Corners::Unknown;
            let at_corner_mm = if is_known && next.passes_corner { hides() } else { 0.0 };
            let period = next.at.index;
            trace.add(TracePoint {
                period,
                time_s,
                point_mm,
                feed_mm,
                stands_before,
                r_mm: seen_mm,
                at_corner_mm,
            });
        }
        let along_mm = seen_mm * 3.0_f64.sqrt();
        self.along.add(next.at, standing.is_some(), along_mm, detour_mm);
        if ends_at_rest {
            self.along.end_section(true, along_mm);
        }
        self.differences.add(standing, Way::default(), next);
    }

    /// What is found of the axes and of all together, seen within `r_mm` and so much more at corners.
    fn findings(&self, r_mm: f64, at_corners_mm: Option<f64>) -> Vec<LimitFinding> {
        let by_axis = self.differences.findings(r_mm, at_corners_mm);
        // A point that is off by r in each axis is off by √3 r.
        let by_vector = self.differences.findings(r_mm * 3.0_f64.sqrt(), at_corners_mm);
        let one = |(axis, vector): (LimitFinding, LimitFinding)| match axis.limit.of {
            Of::Vector => vector,
            _ => axis,
        };
        by_axis.into_iter().zip(by_vector).map(one).collect()
    }

    /// The verdicts on limits.
    fn verdicts(&self, r_mm: f64) -> Vec<JudgedLimit> {
        let verdicts = Verdicts { begin_s: self.begin_s(), period_s: self.period_s, r_mm };
        let at_corners_mm = self.junction.hidden_at_corners_mm();
        let (found, at_corners) = match (self.corners, at_corners_mm) {
            (Corners::Unknown, Some(hidden)) if hidden > 0.0 => {
                (self.findings(r_mm, Some(0.0)), Some(self.findings(r_mm, at_corners_mm)))
            }
            (Corners::Unknown, _) => (self.findings(r_mm, Some(0.0)), None),
            _ => (self.findings(r_mm, at_corners_mm), None),
        };
        let of = |(index, limit): (usize, &LogLimit)| {
            verdicts.of(limit, &found[index], at_corners.as_ref().map(|all| &all[index]))
        };
        // Where no corner is passed, no velocity jumps.
        let is_met = |(index, limit): &(usize, &LogLimit)| {
            !matches!(limit.stated.of, Of::Jump(_)) || found[*index].raw.at.is_some()
        };
        let mut limits: Vec<JudgedLimit> = self.limits.iter().enumerate().filter(is_met).map(of).collect();
        let behind_feed = limits.iter().take_while(|limit| limit.axis.is_none()).count();
        limits.splice(behind_feed..behind_feed, self.along.limits.iter().map(|found| verdicts.along(found)));
        limits
    }

    /// What was found, at the end of the log.
    pub(crate) fn finished(mut self, r_mm: f64) -> Judgement {
        let ends_at_rest = self.from_rest_to_rest || self.stand.is_some();
        self.end_section(ends_at_rest, r_mm);
        let seen_mm = self.seen_within_mm(r_mm);
        let limits = self.verdicts(seen_mm);
        Judgement {
            limits,
            rows: self.rows,
            time_s: self.last_period as f64 * self.period_s,
            period_s: self.period_s,
            resolution_mm: seen_mm,
            at_rest: [self.begins_at_rest, ends_at_rest],
            not_judged: self.not_judged,
            doubled: self.doubled,
            missing: self.missing,
            missing_at_rest: self.missing_at_rest,
            longest_rows: self.longest_rows,
            standstills: self.standstills,
            left_out: self.left_out,
            uneven_s: 0.0,
            trace: self.trace.map_or_else(Vec::new, |trace| trace.columns),
            part: self.follower.map(|follower| follower.finished(2.0 * r_mm)),
        }
    }
}

/// How the machine passes corners. Where nobody knows where they are, a deviation that its file only assumes excuses nothing: any step could
/// be one.
fn junction_of(machine: &StatedLimits, corners: Corners) -> Junction {
    let is_assumed = machine.assumed_value(None, DEVIATION.name).is_some();
    if is_assumed && corners == Corners::Unknown { Junction::Stop } else { machine.junction }
}

fn place(at: &Timed) -> StepPlace {
    let Timed { row, period } = at;
    StepPlace { index: *period, row: row.number, curve: row.program_line, point_mm: row.point_mm }
}

/// Whether two rows are at the same place, as far as is seen.
fn stands(one: &Row, other: &Row, r_mm: f64) -> bool {
    one.point_mm.iter().zip(&other.point_mm).all(|(from, to)| (from - to).abs() <= 2.0 * r_mm)
}
