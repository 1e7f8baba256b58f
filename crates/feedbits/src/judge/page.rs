//! The findings of a log as a page: `judge --report`.

use format_report::{Figure, LineChart, LogLimitRow, LogPage, LogPathPoint, Report};
use part_program::{AxisLimits, StatedLimits};
use setpoint_log::{JudgedLimit, Judgement, LimitVerdict, TraceColumn};

use crate::judge::print;
use crate::report;

/// The page of a log, with its pictures and its table.
pub(crate) fn of(
    name: &str,
    machine: &StatedLimits,
    found: &Judgement,
    faults: &[String],
) -> anyhow::Result<Report> {
    let page = LogPage {
        about: name.to_string(),
        is_good: faults.is_empty(),
        answer: std::iter::once(print::said(name, found, faults)).chain(faults.iter().cloned()).collect(),
        facts: facts(found),
        limits: found.limits.iter().map(row).collect(),
        path: found.trace.iter().map(place).collect(),
        charts: charts(machine, found),
    };
    Ok(page.report(&report::command())?)
}

fn row(limit: &JudgedLimit) -> LogLimitRow {
    let is_judged = limit.verdict != LimitVerdict::NotJudged;
    #[allow(clippy::cast_precision_loss, reason = "a log has fewer rows than 2⁵³")]
    let (at_row, at_line) =
        (limit.at.map(|at| at.row as f64), limit.at.and_then(|at| at.line).map(|line| line as f64));
    LogLimitRow {
        what: limit.what.to_string(),
        limit: limit.limit,
        unit: limit.unit.to_string(),
        raw: is_judged.then_some(limit.raw),
        taken: is_judged.then_some(limit.taken),
        verdict: print::verdict(limit).to_string(),
        row: at_row,
        line: at_line,
    }
}

fn place(column: &TraceColumn) -> LogPathPoint {
    let TraceColumn { point_mm, time_s, follows, share, .. } = *column;
    LogPathPoint { point_mm, time_s, follows, share }
}

/// What is known of the log and of how it follows its part, as the text has it.
fn facts(found: &Judgement) -> Vec<(String, String)> {
    let mut facts = vec![
        ("setpoints".to_string(), found.rows.to_string()),
        ("takes".to_string(), format!("{:.3} s", found.time_s)),
        ("period".to_string(), format!("{:.4} ms", 1e3 * found.period_s)),
        ("resolution r".to_string(), format!("{:.1e} mm", found.resolution_mm)),
        ("rows twice".to_string(), found.doubled.rows.to_string()),
        ("rows missing".to_string(), found.missing.rows.to_string()),
    ];
    if let Some(part) = &found.part {
        for (what, mm) in [
            ("off path", part.nearest.mm),
            ("in order", part.order_mm),
            ("off log", part.path_to_log_mm),
            ("chord error", part.chord_error.mm),
            ("not visited", part.never_visited_mm),
        ] {
            facts.push((what.to_string(), format!("{} mm", print::small(mm))));
        }
        if let Some(found) = &part.fluctuation {
            facts.push(("fluctuation".to_string(), format!("{:.1e}", found.share)));
        }
    }
    facts
}

/// Feed, acceleration and jerk over time, with the limits of the machine across.
fn charts(machine: &StatedLimits, found: &Judgement) -> Vec<Figure> {
    if found.trace.is_empty() {
        return Vec::new();
    }
    let axes = [machine.axes.x, machine.axes.y, machine.axes.z];
    let of = |label: &str, places: [usize; 3], limit: fn(&AxisLimits) -> Option<f64>| {
        let mut chart = LineChart::new(["time [s]", label]);
        for ((axis, place), limits) in ["X", "Y", "Z"].into_iter().zip(places).zip(&axes) {
            chart = chart.stretches(axis, over_time(&found.trace, place));
            for value in limit(limits).into_iter().flat_map(|most| [most, -most]) {
                chart = chart.limit(value, axis);
            }
        }
        chart.drawn()
    };
    let mut feed = LineChart::new(["time [s]", "feed [mm/s]"]).stretches("feed", over_time(&found.trace, 0));
    let commanded = found.limits.iter().find(|limit| limit.what == "feed");
    if let Some(limit) = commanded {
        feed = feed.limit(limit.limit, "the highest commanded");
    }
    const CAPTION: &str = "As it is: with what rounding makes. Lines are the limits that the machine states. Each place keeps the least and the \
                           greatest value. Nothing is drawn where rows are missing.";
    vec![
        feed.drawn().named("feed", "The feed along the path", CAPTION),
        of("acceleration [mm/s²]", [1, 2, 3], |axis| axis.acceleration_mm_per_s2).named(
            "acceleration",
            "The acceleration of each axis",
            CAPTION,
        ),
        of("jerk [mm/s³]", [4, 5, 6], |axis| axis.jerk_mm_per_s3).named(
            "jerk",
            "The jerk of each axis",
            CAPTION,
        ),
    ]
}

/// The extremes of a quantity, column by column, in stretches: a line ends where the log has a gap, and where the quantity is not seen.
fn over_time(trace: &[TraceColumn], place: usize) -> Vec<Vec<(f64, f64)>> {
    let mut stretches: Vec<Vec<(f64, f64)>> = Vec::new();
    let mut goes_on = false;
    for column in trace {
        let Some(extremes) = column.extremes[place] else {
            goes_on = false;
            continue;
        };
        if !(goes_on && column.follows) {
            stretches.push(Vec::new());
        }
        goes_on = true;
        if let Some(last) = stretches.last_mut() {
            last.extend(extremes.map(|value| (column.time_s, value)));
        }
    }
    stretches
}
