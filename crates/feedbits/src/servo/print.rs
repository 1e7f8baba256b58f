//! The result of a simulation for the terminal.

use format_compare::Engine;
use servo_sim::{ErrorSize, TuningRow};

use super::report::{CircleReport, CircleResult, FormatRow, LeftOut, Outcome, Report};
use crate::screen::{self, short};

/// The rows of the first screen: those on pieces, or those that the options name. If pieces were refused, the other run
/// of the format is shown.
pub(super) fn first_rows(report: &Report, names_engine: bool) -> Vec<&FormatRow> {
    let ran = |row: &&FormatRow| matches!(row.outcome, Outcome::Ran { .. });
    let pieces = || report.formats.iter().filter(|row| row.engine == Engine::Pieces);
    let has_run = |format: &str| pieces().filter(ran).any(|row| row.format == format);
    let is_shown = |row: &&FormatRow| {
        names_engine || row.engine == Engine::Pieces || (ran(row) && !has_run(&row.format))
    };
    report.formats.iter().filter(is_shown).collect()
}

/// The answer, the formats, and the behaviour of the drive alone.
pub(super) fn shown(report: &Report, rows: &[&FormatRow], table: fn(&[&FormatRow]) -> String) -> String {
    let servo = &report.servo;
    let setting = format!(
        "{}: a setpoint every {} ms; position gain {} 1/s, lag {} ms, feed-forward {} %, velocity gain {} %",
        screen::file_name(&report.part),
        short(report.interpolation_period_ms),
        short(servo.position_gain_per_s),
        short(servo.velocity_lag_ms),
        short(servo.feed_forward * 100.0),
        short(servo.velocity_gain_percent),
    );
    let blocks = [
        screen::answer(&answer(rows)) + &screen::paragraph(&setting),
        table(rows) + &notes(report, rows),
        screen::paragraph(&circle_line(&report.circle))
            + &tuning(report)
            + &left_out(&report.tuning_left_out),
    ];
    blocks.join("\n")
}

/// How far the table is off the path, and whether the formats are the cause.
fn answer(rows: &[&FormatRow]) -> String {
    let mut found: Vec<(&str, f64)> = Vec::new();
    for row in rows {
        match &row.outcome {
            Outcome::Ran { does_not_follow: Some(reason), .. } => {
                let mut reason = reason.chars();
                let first = reason.next().map(|first| first.to_uppercase().to_string()).unwrap_or_default();
                return format!("{first}{}.", reason.as_str());
            }
            Outcome::Ran { contour_error_mm, reached_the_end: true, .. } => {
                found.push((&row.format, contour_error_mm.max));
            }
            _ => {}
        }
    }
    let by_error = |a: &&(&str, f64), b: &&(&str, f64)| a.1.total_cmp(&b.1);
    let (Some((best, least)), Some((worst, most))) =
        (found.iter().min_by(by_error), found.iter().max_by(by_error))
    else {
        return "No format makes setpoints to the end of the path.".to_string();
    };
    let as_far: Vec<f64> =
        found.iter().map(|(_, error)| *error).filter(|error| *error <= least * AS_FAR).collect();
    let usual = micrometres(as_far.iter().copied().fold(*least, f64::max));
    match as_far.len() {
        count if count == found.len() => {
            let with = if count == 1 { format!(" with {best}") } else { ", whatever the format".to_string() };
            format!("The table is at most {usual} µm off the path{with}.")
        }
        count => {
            let with =
                if count == 1 { (*best).to_string() } else { format!("{count} of {} formats", found.len()) };
            format!(
                "The table is at most {usual} µm off the path with {with}, and up to {} µm with {worst}.",
                micrometres(*most)
            )
        }
    }
}

/// Contour errors within this ratio count as equal: the drive causes them, whatever the setpoints.
const AS_FAR: f64 = 1.01;

/// Remarks about formats in addition to their figures, and about formats that are not shown but decide the exit status.
fn notes(report: &Report, rows: &[&FormatRow]) -> String {
    let is_shown = |row: &FormatRow| rows.iter().any(|shown| std::ptr::eq(*shown, row));
    let name = |row: &FormatRow| match row.engine {
        Engine::Pieces => row.format.clone(),
        engine => format!("{} ({engine})", row.format),
    };
    let mut said = Vec::new();
    for row in &report.formats {
        match &row.outcome {
            Outcome::Refused { refused } if is_shown(row) => {
                said.push((name(row), format!("cannot run it: {refused}")));
            }
            Outcome::Ran { reached_the_end, does_not_follow, .. } => {
                if let Some(reason) = does_not_follow {
                    said.push((name(row), reason.clone()));
                } else if !reached_the_end && is_shown(row) {
                    said.push((name(row), "stops before the end".to_string()));
                }
            }
            Outcome::Refused { .. } => {}
        }
    }
    let line = |(names, words): (String, String)| screen::labelled("- ", &format!("{names}: {words}"));
    screen::by_what_is_said(said).into_iter().map(line).collect()
}

fn circle_line(circle: &CircleReport) -> String {
    let CircleReport { radius_mm, feedrate_mm_per_min, result } = circle;
    let said = match result {
        CircleResult::Round(round) => format!(
            "mean radial error {} µm (linear loop in closed form: {} µm), roundness {} µm",
            micrometres(round.radial_error_mean_mm),
            micrometres(round.sampled_closed_form_mm),
            micrometres(round.roundness_mm),
        ),
        CircleResult::DoesNotFollow { does_not_follow } => does_not_follow.clone(),
    };
    format!("Circle R{radius_mm} F{feedrate_mm_per_min}: {said}")
}

/// A line for each reason why the tuning table leaves settings out.
fn left_out(settings: &[LeftOut]) -> String {
    settings
        .iter()
        .map(|LeftOut { velocity_gain_percent, feed_forwards, reason }| {
            let percents: Vec<String> = feed_forwards.iter().map(|f| short(f * 100.0)).collect();
            let percents = percents.join(", ");
            screen::paragraph(&format!(
                "Left out: velocity gain {velocity_gain_percent} %, feed-forward {percents} %: {reason}"
            ))
        })
        .collect()
}

/// Names of the path's axes.
fn axes(rows: &[&FormatRow]) -> impl Iterator<Item = &'static str> {
    let count = rows.iter().find_map(|row| match &row.outcome {
        Outcome::Ran { following_error_mm, .. } => Some(following_error_mm.len()),
        Outcome::Refused { .. } => None,
    });
    ["X", "Y", "Z"].into_iter().take(count.unwrap_or(0))
}

/// The largest errors of the formats that were run.
pub(super) fn narrow_table(rows: &[&FormatRow]) -> String {
    let names_path = rows.iter().any(|row| row.engine != Engine::Pieces);
    let following: Vec<String> = axes(rows).map(|axis| format!("following\n{axis} max µm")).collect();
    let path = names_path.then_some("path");
    let header: Vec<&str> = ["format"]
        .into_iter()
        .chain(path)
        .chain(["setpoints\noff µm"])
        .chain(following.iter().map(String::as_str))
        .chain(["contour\nmax µm", "\nrms µm"])
        .collect();
    let row = |row: &&FormatRow| {
        let Outcome::Ran { setpoint_error_mm, following_error_mm, contour_error_mm, .. } = &row.outcome
        else {
            return None;
        };
        let mut cells = vec![row.format.clone()];
        cells.extend(names_path.then(|| row.engine.to_string()));
        cells.push(micrometres(setpoint_error_mm.max));
        cells.extend(following_error_mm.iter().map(|size| micrometres(size.max)));
        cells.extend([micrometres(contour_error_mm.max), micrometres(contour_error_mm.rms)]);
        Some(cells)
    };
    screen::table(&header, rows.iter().filter_map(row).collect())
}

/// All figures of each format.
pub(super) fn wide_table(rows: &[&FormatRow]) -> String {
    let size = |size: &ErrorSize| format!("{} / {}", micrometres(size.max), micrometres(size.rms));
    let following: Vec<String> =
        axes(rows).map(|axis| format!("following error {axis}\nmax / rms µm")).collect();
    let header: Vec<&str> = ["format", "path", "setpoints off the\ncurve, max / rms µm"]
        .into_iter()
        .chain(following.iter().map(String::as_str))
        .chain(["contour error\nmax / rms µm", "note"])
        .collect();
    let note = header.len() - 1;
    let row = |row: &&FormatRow| {
        let mut cells = vec![row.format.clone(), row.engine.to_string()];
        match &row.outcome {
            Outcome::Ran {
                setpoint_error_mm,
                following_error_mm,
                contour_error_mm,
                reached_the_end,
                does_not_follow,
                arrival: _,
            } => {
                cells.push(size(setpoint_error_mm));
                cells.extend(following_error_mm.iter().map(size));
                cells.push(size(contour_error_mm));
                let stops = (!reached_the_end).then(|| "stops before the end".to_string());
                cells.push(stops.into_iter().chain(does_not_follow.clone()).collect::<Vec<_>>().join("; "));
            }
            Outcome::Refused { refused } => {
                cells.resize(note, String::new());
                cells.push(format!("refused: {refused}"));
            }
        }
        cells
    };
    screen::wide_table(&header, rows.iter().map(row).collect(), &[0, 1, note])
}

fn tuning(report: &Report) -> String {
    let row = |row: &TuningRow| {
        vec![
            short(row.feed_forward * 100.0),
            short(row.velocity_gain_percent),
            micrometres(row.radial_error_mean_mm),
            micrometres(row.roundness_mm),
        ]
    };
    screen::table(
        &["feed-forward\n%", "velocity gain\n%", "radial error\nmean µm", "roundness\nµm"],
        report.tuning.iter().map(row).collect(),
    )
}

/// A length in mm as text in µm, with three decimals, that is nanometres.
pub(super) fn micrometres(mm: f64) -> String {
    format!("{:.3}", mm * 1000.0)
}
