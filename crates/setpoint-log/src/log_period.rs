//! The time between two setpoints, from the first rows of a log.
//!
//! With times tᵢ in units u, a period T is that of the log if tᵢ - t₀ is a whole number of periods within u, at each row, and most rows are
//! one period behind the row before; or if tᵢ - t₀ = i T within u, where u is too coarse to tell single periods. The machine's period is
//! taken where it is that of the log, else the mean of the log's times, else their median step.

use std::collections::VecDeque;

use crate::log_error::LogError;
use crate::row::Row;

/// Periods that a log's times may tell, in s.
const PERIODS_S: std::ops::RangeInclusive<f64> = 1e-6..=1.0;
/// A longer step, in periods, is a pause, behind which times may begin anew.
pub(crate) const PAUSE: f64 = 2.5;
/// The share of a period by which times may be uneven, beside their rounding.
pub(crate) const UNEVEN: f64 = 0.05;
/// Times whose period is off that of the machine by a ratio of units, and by this much at most, are taken for those of the other unit.
const NEAR: f64 = 4.0;
/// How well the times must tell the period, as a share of it.
const TOLD: f64 = 0.01;

/// The period of rows whose times are rounded by `r_s`, half a unit; `stated_s` is that of the machine. `None` if the rows have no times.
///
/// # Errors
/// Times that do not rise while the axes move, that are uneven, or that tell no period.
pub(crate) fn period_of_times(
    rows: &VecDeque<Row>,
    r_s: f64,
    stated_s: Option<f64>,
) -> Result<Option<f64>, LogError> {
    const RISING: &str = "rising times, or --period with the time between two rows in ms";
    let times: Vec<f64> = rows.iter().map_while(|row| row.time_s).collect();
    let (Some(first), Some(last)) = (times.first(), times.last()) else { return Ok(None) };
    let at = |row: &Row, message: String| LogError::at(row.text_line, row.time_column, message, RISING);
    if times.len() < rows.len() || last < first {
        return Ok(None);
    }
    let span_s = last - first;
    if span_s <= 0.0 {
        let begin = rows[0].point_mm;
        let Some(moved) = rows.iter().find(|row| row.point_mm != begin) else { return Ok(None) };
        return Err(at(moved, format!("the time stays at {first} s while the axes move")));
    }
    let mut steps: Vec<f64> = times.windows(2).map(|pair| pair[1] - pair[0]).collect();
    steps.sort_by(f64::total_cmp);
    let median = steps[steps.len() / 2];
    let mean = span_s / steps.len() as f64;
    let alike: Vec<f64> = steps.iter().copied().filter(|step| (step - median).abs() < 0.5 * median).collect();
    let of_alike = alike.iter().sum::<f64>() / alike.len().max(1) as f64;
    let unit_s = 2.1 * r_s;
    let with = |within_s: f64| {
        let told = [stated_s, Some(mean), Some(median), Some(of_alike)];
        told.into_iter().flatten().find(|period| fits(&times, *period, within_s.max(1e-9 * period)))
    };
    let period_s = with(unit_s).or_else(|| with(2.0 * unit_s)).or_else(|| with(unit_s + UNEVEN * mean));
    let Some(period_s) = period_s else {
        let of_step = |index: &usize| (times[*index] - times[index - 1] - median).abs();
        let worst = (1..times.len()).max_by(|one, other| of_step(one).total_cmp(&of_step(other)));
        let (index, count) = (worst.unwrap_or(1), times.len());
        let [least, most] = [steps[0], steps[steps.len() - 1]].map(|step| 1e3 * step);
        let mean = 1e3 * mean;
        let said = format!(
            "the times of the first {count} rows are uneven: steps of {least:.6} to {most:.6} ms, {mean:.6} ms on average"
        );
        let expected = "even times, or --period with the time between two rows in ms";
        return Err(LogError { expected: expected.into(), ..at(&rows[index], said) });
    };
    if Some(period_s) != stated_s && unit_s > TOLD * period_s * steps.len() as f64 && median <= 0.0 {
        return Err(at(&rows[1], "the times are written too coarsely to tell the period".into()));
    }
    if !PERIODS_S.contains(&period_s) {
        let said = format!("by its times the log has a setpoint every {} ms", 1e3 * period_s);
        let expected = "0.001 to 1000 ms, as times in s (`time`) or in ms (`time_ms`); or --period";
        return Err(LogError { expected: expected.into(), ..at(&rows[1], said) });
    }
    Ok(Some(period_s))
}

/// The error of times that seem to be in another unit: by them the period is about a thousand times that of the machine, or a thousandth.
pub(crate) fn in_another_unit(rows: &VecDeque<Row>, period_s: f64, of_machine_s: f64) -> Option<LogError> {
    let ratio = period_s / of_machine_s;
    let is_near = |unit: f64| (1.0 / NEAR..=NEAR).contains(&(ratio / unit));
    let (unit, name) = match () {
        () if is_near(1e3) => ("ms", "time_ms"),
        () if is_near(1e-3) => ("s", "time"),
        () => return None,
    };
    let [own, of_machine] = [period_s, of_machine_s].map(|period| (1e9 * period).round() / 1e6);
    let said = format!(
        "by its times the log has a setpoint every {own} ms, and the machine one every {of_machine} ms: the times seem to be in {unit}"
    );
    let expected =
        format!("the name `{name}` for their column, or --period with the time between two rows in ms");
    let row = rows.get(1)?;
    Some(LogError::at(row.text_line, row.time_column, said, expected))
}

/// Whether times are whole numbers of a period apart within `within_s`, most of them one.
fn fits(times: &[f64], period_s: f64, within_s: f64) -> bool {
    let is_even =
        |(index, time): (usize, &f64)| (time - times[0] - index as f64 * period_s).abs() <= within_s;
    if times.iter().enumerate().all(is_even) {
        return true;
    }
    let (mut anchor_s, mut passed, mut single) = (times[0], 0.0, 0_usize);
    for pair in times.windows(2) {
        if pair[1] - pair[0] > PAUSE * period_s {
            (anchor_s, passed) = (pair[1], 0.0);
            continue;
        }
        let periods = ((pair[1] - anchor_s) / period_s).round();
        single += usize::from((periods - passed - 1.0).abs() < 0.5);
        passed = periods;
        if (pair[1] - anchor_s - periods * period_s).abs() > within_s {
            return false;
        }
    }
    2 * single >= times.len() - 1
}
