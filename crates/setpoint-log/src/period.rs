//! Which period of the controller each row of a log belongs to: rows that are there twice, and rows that are missing.
//!
//! A log's times or numbers say it. Where they do not, or do not tell, the motion does: no axis stops or doubles its velocity within a
//! period. So a row at the place of the row before, or a step of several periods' way, with the same velocity before and behind, is a row
//! that is there twice, or several that are missing. Rows are handed on one or two late, once what follows them is known.
//!
//! Let s₀ be the step before, s₁ the one in question and s₂ the one behind, A T² the most by which a step may change. s₁ is n steps where
//! n = 2|s₁| / |s₀ + s₂|, rounded, is 2 or more, the change to it and from it is more than A T² allows, neither s₀ nor s₂ could end at rest
//! within a period, |s₂ - s₀| ≤ (n + 1) A T², and |s₁ - n (s₀ + s₂)/2| ≤ n² A T² / 4 in each axis; each within what the log's resolution
//! hides. Where the velocity changes in a gap, n is that of its mean before and behind.

use crate::log_error::LogError;
use crate::log_period::{PAUSE, UNEVEN};
use crate::row::Row;

/// What is known of the next row.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum Event {
    /// A setpoint, a period behind the one before.
    Setpoint(Setpoint),
    /// So many rows are at the place of the one before, although the axes cannot stand there. They are left out.
    Doubled { row: Row, count: u64 },
    /// So many are missing before the next, 0 where the log does not say how many.
    Lost { row: Row, count: u64 },
    /// Moves between the rows are left out, as rapid moves are: the step to the next is shorter than the way between both.
    LeftOut { row: Row },
    /// The axes have stood for so many periods, of which the log has no rows.
    Stood { row: Row, count: u64 },
}

/// A row, with the number of the period in which it is reached.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Setpoint {
    pub(crate) row: Row,
    pub(crate) period: u64,
}

/// What the clock has to know.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct ClockLimits {
    pub(crate) period_s: f64,
    /// The most by which a step may change from one period to the next, in mm, by axis, where the machine states it.
    pub(crate) change_mm: [Option<f64>; 3],
}

/// The clock of a log.
pub(crate) struct Clock {
    limits: ClockLimits,
    /// Whether the period was asked for, so that uneven times tell gaps alone.
    is_given: bool,
    /// By how much the time between two rows is off the period, beyond how times are rounded, in s.
    pub(crate) uneven_s: f64,
    /// The row before, which was handed on.
    before: Option<Setpoint>,
    /// The step to it, where no row is missing before it.
    step: Option<[f64; 3]>,
    /// Rows at the same place as `before`, the number of them and the last.
    held: Option<(u64, Row)>,
    /// A row whose step is too long, until the one behind it is known.
    jumped: Option<Row>,
}

/// A share of a step by which velocities may differ that count as even, where the machine states no acceleration.
const EVEN: f64 = 0.2;

impl Clock {
    pub(crate) fn new(limits: ClockLimits, is_given: bool) -> Self {
        Self { limits, is_given, uneven_s: 0.0, before: None, step: None, held: None, jumped: None }
    }

    /// Takes the next row, and hands on what is known now. `r_mm` is what the log's resolution hides, and `r_s` that of its times.
    pub(crate) fn take(
        &mut self,
        row: Row,
        (r_mm, r_s): (f64, f64),
        hand_on: &mut impl FnMut(Event),
    ) -> Result<(), LogError> {
        let Some(last) = self.last_row() else {
            self.pass(row, 1, hand_on);
            return Ok(());
        };
        let periods = self.periods_between(&last, &row, r_s)?;
        let way = difference(&row.point_mm, &last.point_mm);
        // A chord is that of exact points, and the positions are rounded.
        if row.chord_mm.is_some_and(|chord| length(&way) > 1.5 * chord + 4.0 * r_mm + 1e-3) {
            self.settle(r_mm, None, hand_on);
            hand_on(Event::LeftOut { row });
            self.pass(row, periods.max(1), hand_on);
            self.step = None;
            return Ok(());
        }
        if row.is_behind_loss || periods > 1 {
            self.settle(r_mm, None, hand_on);
            self.pass_gap(row, periods, r_mm, hand_on);
            return Ok(());
        }
        let step = way;
        let is_same = step.iter().all(|way| way.abs() <= 2.0 * r_mm);
        if periods == 0 && is_same {
            self.settle(r_mm, None, hand_on);
            hand_on(Event::Doubled { row, count: 1 });
            return Ok(());
        }
        if let Some((count, _)) = self.held
            && is_same
        {
            self.held = Some((count + 1, row));
            return Ok(());
        }
        self.settle(r_mm, Some(&step), hand_on);
        match self.step {
            Some(before) if is_same && self.cannot_stop(&before, r_mm) => self.held = Some((1, row)),
            Some(before) if self.is_jump(&before, &step, r_mm) => self.jumped = Some(row),
            _ => self.pass(row, 1, hand_on),
        }
        Ok(())
    }

    /// Hands on what is left at the end of the log.
    pub(crate) fn finish(&mut self, r_mm: f64, hand_on: &mut impl FnMut(Event)) {
        self.settle(r_mm, None, hand_on);
    }

    /// The row before the next.
    fn last_row(&self) -> Option<Row> {
        self.jumped.or(self.held.map(|(_, row)| row)).or(self.before.map(|before| before.row))
    }

    /// How many periods a row is behind another.
    fn periods_between(&mut self, last: &Row, row: &Row, r_s: f64) -> Result<u64, LogError> {
        const EXPECTED: &str = "rows in the order of their times";
        const EVEN_TIMES: &str = "even times, or --period with the time between two rows in ms";
        let place = |message: String| LogError::at(row.text_line, row.time_column, message, EXPECTED);
        let period_s = self.limits.period_s;
        let count = match (last.time_s.zip(row.time_s), last.sample.zip(row.sample)) {
            (Some((from, to)), _) if to < from => {
                return Err(place(format!("the time goes back from {from} s to {to} s")));
            }
            (None, Some((from, to))) if to < from => {
                return Err(place(format!("the number goes back from {from} to {to}")));
            }
            // A time that is written too coarsely for the period tells less.
            (Some((from, to)), _)
                if is_coarse(2.0 * r_s, period_s) && (to - from - period_s).abs() < 2.1 * r_s =>
            {
                1.0
            }
            (Some((from, to)), _) => {
                let step_s = to - from;
                let periods = (step_s / period_s).round();
                let off_s = (step_s - periods * period_s).abs();
                let stays = step_s == 0.0 && row.point_mm == last.point_mm;
                // Behind a pause times may begin anew.
                let is_telling = stays || row.text_line == 0 || step_s > PAUSE * period_s;
                let single_s = (step_s - period_s).abs();
                if is_telling || off_s <= 2.1 * r_s + 1e-6 * period_s && single_s > self.uneven_s {
                    periods
                } else if self.is_given || single_s <= 2.1 * r_s + 2.0 * UNEVEN * period_s {
                    // The motion tells whether a row is missing.
                    self.uneven_s = self.uneven_s.max(single_s);
                    1.0
                } else {
                    let (step_ms, period_ms) = (1e3 * step_s, 1e3 * period_s);
                    let said =
                        format!("{step_ms:.6} ms behind the row before, of a period of {period_ms:.6} ms");
                    return Err(LogError { expected: EVEN_TIMES.into(), ..place(said) });
                }
            }
            (None, Some((from, to))) => to - from,
            (None, None) => 1.0,
        };
        #[allow(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "it is clamped before")]
        Ok(count.round().clamp(0.0, 1e15) as u64)
    }

    /// The most by which a step may change in an axis, and what may be hidden of it.
    fn change_mm(&self, axis: usize, around_mm: f64, r_mm: f64) -> f64 {
        self.limits.change_mm[axis].unwrap_or(EVEN * around_mm) + 4.0 * r_mm
    }

    /// Whether an axis would have to change its velocity too much to stand a period later.
    fn cannot_stop(&self, step: &[f64; 3], r_mm: f64) -> bool {
        (0..3).any(|axis| step[axis].abs() > self.change_mm(axis, step[axis].abs(), r_mm))
    }

    /// Whether a step differs from the one before by more than an axis may change its velocity, and is longer.
    fn is_jump(&self, before: &[f64; 3], step: &[f64; 3], r_mm: f64) -> bool {
        let jumps =
            |axis: usize| (step[axis] - before[axis]).abs() > self.change_mm(axis, before[axis].abs(), r_mm);
        length(step) > length(before) && (0..3).any(jumps)
    }

    /// Decides about rows that were held back, by the step behind them; without one they are what they seem to be.
    fn settle(&mut self, r_mm: f64, behind: Option<&[f64; 3]>, hand_on: &mut impl FnMut(Event)) {
        if let Some((count, row)) = self.held.take() {
            let is_even = self.step.zip(behind).is_some_and(|(before, behind)| {
                (0..3).all(|axis| {
                    let around = before[axis].abs().max(behind[axis].abs());
                    let change = count as f64 + 1.0;
                    (behind[axis] - before[axis]).abs() <= change * self.change_mm(axis, around, r_mm)
                })
            });
            let Some(before) = self.before.filter(|_| is_even) else {
                (0..count).for_each(|_| self.pass(row, 1, hand_on));
                return;
            };
            hand_on(Event::Doubled { row, count });
            self.before = Some(Setpoint { row, period: before.period + count });
        }
        if let Some(row) = self.jumped.take() {
            let periods = self.step.zip(self.before).and_then(|(step, before)| {
                let jump = difference(&row.point_mm, &before.row.point_mm);
                self.periods_of(&step, &jump, behind?, r_mm)
            });
            match periods {
                Some(periods) => self.pass_gap(row, periods, r_mm, hand_on),
                None => self.pass(row, 1, hand_on),
            }
        }
    }

    /// How many periods' way a step is between two steps of even velocity; `None` if it is no such step.
    fn periods_of(&self, before: &[f64; 3], jump: &[f64; 3], behind: &[f64; 3], r_mm: f64) -> Option<u64> {
        let both: [f64; 3] = std::array::from_fn(|axis| before[axis] + behind[axis]);
        let periods = (2.0 * length(jump) / length(&both)).round();
        if !(2.0..1e9).contains(&periods) {
            return None;
        }
        let is_even = (0..3).all(|axis| {
            let around = before[axis].abs().max(behind[axis].abs());
            let change = self.change_mm(axis, around, r_mm);
            let off = (jump[axis] - 0.5 * periods * both[axis]).abs();
            (behind[axis] - before[axis]).abs() <= (periods + 1.0) * change
                && off <= 0.25 * periods * periods * change
        });
        let comes_back =
            |axis: usize| (behind[axis] - jump[axis]).abs() > self.change_mm(axis, behind[axis].abs(), r_mm);
        let is_fast = self.cannot_stop(before, r_mm) && self.cannot_stop(behind, r_mm);
        #[allow(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "it is within a range")]
        (is_even && is_fast && (0..3).any(comes_back)).then_some(periods as u64)
    }

    /// Hands on a row that is so many periods behind the one before.
    fn pass(&mut self, row: Row, periods: u64, hand_on: &mut impl FnMut(Event)) {
        let period = self.before.map_or(0, |before| before.period + periods);
        self.step = self.before.map(|before| difference(&row.point_mm, &before.row.point_mm));
        let setpoint = Setpoint { row, period };
        self.before = Some(setpoint);
        hand_on(Event::Setpoint(setpoint));
    }

    /// Hands on a row before which rows are missing.
    fn pass_gap(&mut self, row: Row, periods: u64, r_mm: f64, hand_on: &mut impl FnMut(Event)) {
        let count = periods.saturating_sub(1);
        let stands = self.before.is_some_and(|before| {
            let way = difference(&row.point_mm, &before.row.point_mm);
            way.iter().all(|way| way.abs() <= 2.0 * r_mm)
        });
        let stood = self.step.is_none_or(|step| step.iter().all(|way| way.abs() <= 2.0 * r_mm));
        hand_on(if stands && stood { Event::Stood { row, count } } else { Event::Lost { row, count } });
        self.pass(row, periods.max(1), hand_on);
        self.step = if stands && stood { Some([0.0; 3]) } else { None };
    }
}

/// Whether times in whole units do not tell how many periods are between them.
fn is_coarse(unit_s: f64, period_s: f64) -> bool {
    let units = period_s / unit_s;
    unit_s > 0.0 && units < 2.1 && (units - units.round()).abs() > 1e-6
}

fn difference(to: &[f64; 3], from: &[f64; 3]) -> [f64; 3] {
    std::array::from_fn(|axis| to[axis] - from[axis])
}

pub(crate) fn length([x, y, z]: &[f64; 3]) -> f64 {
    (x * x + y * y + z * z).sqrt()
}

#[cfg(test)]
mod tests {
    use super::*;

    /// X at a velocity of 0.1 mm a period, from rest to rest at 0.01 mm a period².
    fn motion() -> Vec<f64> {
        let steps = (1..=10).chain([10; 30]).chain((1..10).rev()).map(f64::from);
        let mut x = 0.0;
        let mut places = vec![0.0; 3];
        places.extend(steps.map(|step| {
            x += 0.01 * step;
            x
        }));
        places.extend([x; 3]);
        places
    }

    fn events(places: &[f64], times: Option<&[f64]>) -> Vec<Event> {
        let limits = ClockLimits { period_s: 1e-3, change_mm: [Some(0.01 + 1e-9), None, None] };
        let mut clock = Clock::new(limits, false);
        let mut events = Vec::new();
        for (index, x) in places.iter().enumerate() {
            let time_s = times.map(|times| times[index]);
            let row = Row { number: index as u64 + 1, point_mm: [*x, 0.0, 0.0], time_s, ..Row::default() };
            clock.take(row, (5e-7, 5e-7), &mut |event| events.push(event)).unwrap();
        }
        clock.finish(5e-7, &mut |event| events.push(event));
        events
    }

    fn faults(events: &[Event]) -> Vec<(&'static str, u64, u64)> {
        let fault = |event: &Event| match event {
            Event::Setpoint(_) | Event::LeftOut { .. } => None,
            Event::Doubled { row, count } => Some(("doubled", row.number, *count)),
            Event::Lost { row, count } => Some(("lost", row.number, *count)),
            Event::Stood { row, count } => Some(("stood", row.number, *count)),
        };
        events.iter().filter_map(fault).collect()
    }

    #[test]
    fn a_sound_motion_has_a_row_for_each_period() {
        let places = motion();
        let found = events(&places, None);
        assert!(faults(&found).is_empty() && found.len() == places.len(), "{:?}", faults(&found));
    }

    #[test]
    fn rows_that_are_there_twice_or_missing_are_found_by_the_motion_alone() {
        let places = motion();
        for at in [6, 9, 20, 30, 46] {
            for count in [1, 2, 5] {
                let mut doubled = places.clone();
                doubled.splice(at..at, vec![places[at - 1]; count]);
                let found = events(&doubled, None);
                assert_eq!(faults(&found), [("doubled", (at + count) as u64, count as u64)], "{at}");
                assert_eq!(found.len(), places.len() + 1);
                if at + count < 44 {
                    let mut lost = places.clone();
                    lost.drain(at..at + count);
                    let found = faults(&events(&lost, None));
                    let [("lost", row, found)] = found[..] else { panic!("{at}: {found:?}") };
                    // Where the velocity changes in the gap, the number is that of its mean before and behind.
                    let off = u64::from(count == 5 && at < 20);
                    assert!(
                        row == at as u64 + 1 && found.abs_diff(count as u64) <= off,
                        "{at} {count}: {found}"
                    );
                }
            }
        }
    }

    #[test]
    fn rows_that_are_there_twice_or_missing_are_found_by_their_times() {
        let places = motion();
        let times: Vec<f64> = (0..places.len()).map(|index| 1e-3 * index as f64).collect();
        assert!(faults(&events(&places, Some(&times))).is_empty());
        let (mut twice, mut twice_at) = (places.clone(), times.clone());
        twice.insert(20, places[19]);
        twice_at.insert(20, times[19]);
        assert_eq!(faults(&events(&twice, Some(&twice_at))), [("doubled", 21, 1)]);
        let (mut less, mut less_at) = (places.clone(), times.clone());
        less.drain(10..13);
        less_at.drain(10..13);
        let found = events(&less, Some(&less_at));
        assert_eq!(faults(&found), [("lost", 11, 3)]);
        let last = found.iter().rev().find_map(|event| match event {
            Event::Setpoint(setpoint) => Some(setpoint.period),
            _ => None,
        });
        assert_eq!(last, Some(places.len() as u64 - 1));
    }
}
