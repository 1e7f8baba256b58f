//! What `feedbits plan` prints: answer, tables, and samples as CSV.

use std::io;

use anyhow::Result;
use format_compare::{AxisPeak, FeedSample, MergeRow, OverLimits, PlanSummary, Problem, StageRow};

use crate::screen::{self, duration, short};

/// Most rows on the first screen.
const MOST_ROWS: usize = 20;

/// A table with a row for each decision, below a line that counts them.
pub(crate) fn explained<const D: usize>(rows: &[MergeRow], problem: &Problem<D>, wide: bool) -> String {
    let merged = rows.iter().filter(|row| row.merged).count();
    let answer = format!(
        "{}: at {} places accelerations and decelerations follow each other. At {merged} one half-cosine replaces them.",
        screen::file_name(&problem.name),
        rows.len(),
    );
    let several = problem.curves.len() > 1;
    let mut header =
        vec!["from\nmm", "length\nmm", "v start\nmm/s", "v end\nmm/s", "how\nmany", "as one", "verdict"];
    if several {
        header.insert(0, "curve");
    }
    let row = |row: &MergeRow| {
        let mut cells: Vec<_> = several.then(|| row.curve.to_string()).into_iter().collect();
        cells.extend([row.start_mm, row.length_mm].map(|length| format!("{length:.3}")));
        cells.extend([row.start_feed_mm_per_s, row.end_feed_mm_per_s].map(|feed| format!("{feed:.2}")));
        cells.extend([row.transitions.to_string(), row.becomes.to_string()]);
        cells.push(match (row.time_s, &row.why_not) {
            (Some(time), _) => format!("merged, {time:.4} s"),
            (None, why) => format!("kept: {}", why.as_deref().unwrap_or_default()),
        });
        cells
    };
    let most = if wide { rows.len() } else { MOST_ROWS };
    let shown = rows.iter().take(most).map(row).collect();
    screen::answer(&answer)
        + "\n"
        + &screen::table(&header, shown)
        + &left_out(rows.len().saturating_sub(most), "places")
}

/// A table with a row for each kind of transitions, below a line about the fastest.
pub(crate) fn side_by_side(summaries: &[PlanSummary], period_s: f64, wide: bool) -> String {
    let looking_ahead = || summaries.iter().filter(|summary| summary.without_look_ahead.is_none());
    let fastest = looking_ahead().min_by(|a, b| a.time_s.total_cmp(&b.time_s));
    let Some(fastest) = fastest else { return String::new() };
    let answer = format!(
        "`{}` takes the least time: {}, {} periods of {} ms.\n{} mm; no plan takes less than {}, nor without a jerk limit than {}. Limits {:.0} mm/s² and {} \
         mm/s³.",
        fastest.profile,
        duration(fastest.time_s),
        fastest.periods,
        short(1000.0 * period_s),
        short(fastest.length_mm),
        duration(fastest.least_time_s),
        duration(fastest.jerk_free_time_s),
        fastest.acceleration_limit_mm_per_s2,
        short(fastest.jerk_limit_mm_per_s3),
    );
    let most = |a: &&PlanSummary, b: &&PlanSummary| {
        a.total_acceleration_max_mm_per_s2.total_cmp(&b.total_acceleration_max_mm_per_s2)
    };
    let turning = looking_ahead().max_by(most).map_or_else(String::new, turning);
    let baseline: String = summaries.iter().filter_map(without_look_ahead).collect();
    screen::answer(&answer)
        + &turning
        + &baseline
        + "\n"
        + &if wide { wide_rows(summaries) } else { rows(summaries) }
}

/// What a plan without look-ahead breaks; `None` for all others.
fn without_look_ahead(summary: &PlanSummary) -> Option<String> {
    let OverLimits { acceleration, jerk } = summary.without_look_ahead?;
    let time = duration(summary.time_s);
    Some(screen::paragraph(&format!(
        "Without look-ahead, profile `none`: {time}, {acceleration:.1} times the acceleration and {jerk:.0} times the jerk along the \
         path.",
    )))
}

/// The first cells of a profile's row: its name, its time, and the share of the path at the commanded feed.
fn time_and_shares(summary: &PlanSummary) -> Vec<String> {
    vec![
        summary.profile.to_string(),
        format!("{:.4}", summary.time_s),
        summary.periods.to_string(),
        format!("{:.2} %", 100.0 * summary.over_least),
        format!("{:.1} %", 100.0 * summary.share_at_commanded_feed),
    ]
}

/// The cells for acceleration and jerk along the path and in all directions.
fn accelerations(summary: &PlanSummary) -> [String; 2] {
    [summary.acceleration_max_mm_per_s2, summary.total_acceleration_max_mm_per_s2]
        .map(|acceleration| format!("{acceleration:.0}"))
}

fn rows(summaries: &[PlanSummary]) -> String {
    let row = |summary: &PlanSummary| {
        let mut cells = time_and_shares(summary);
        cells.extend(accelerations(summary));
        cells.push(short(summary.jerk_max_mm_per_s3));
        cells
    };
    screen::table(
        &[
            "profile",
            "time\ns",
            "periods",
            "over the\nbound",
            "at the\nfeed",
            "along\nmm/s²",
            "total\nmm/s²",
            "jerk\nmm/s³",
        ],
        summaries.iter().map(row).collect(),
    )
}

fn wide_rows(summaries: &[PlanSummary]) -> String {
    let row = |summary: &PlanSummary| {
        let mut cells = time_and_shares(summary);
        let run_at = summary.feed_over_commanded;
        cells.push(run_at.map_or_else(String::new, |run| format!("{:.3} %", 100.0 * run)));
        cells.extend(accelerations(summary));
        cells.extend([format!("{:.3e}", summary.jerk_max_mm_per_s3), summary.stage_count.to_string()]);
        cells
    };
    screen::wide_table(
        &[
            "profile",
            "time\ns",
            "periods",
            "over the\nbound",
            "at commanded\nfeed",
            "that is\nrun at",
            "peak acceleration\nmm/s²",
            "in all directions\nmm/s²",
            "peak jerk\nmm/s³",
            "stages",
        ],
        summaries.iter().map(row).collect(),
        &[0],
    )
}

/// The time that the path takes, and the acceleration and jerk that the plan asks of the machine.
pub(crate) fn answer(summary: &PlanSummary, name: &str, period_s: f64) -> String {
    let time = format!(
        "{}: {} mm in {}, {} periods of {} ms.",
        screen::file_name(name),
        short(summary.length_mm),
        duration(summary.time_s),
        summary.periods,
        short(1000.0 * period_s),
    );
    let at_feed = format!(
        "{:.0} % of the path at {}the commanded feed.\n",
        100.0 * summary.share_at_commanded_feed,
        summary.feed_over_commanded.map_or_else(String::new, |run| format!("{:.3} % of ", 100.0 * run)),
    );
    let bounds = if summary.without_look_ahead.is_none() {
        format!(
            "No plan takes less than {}, {:.2} % less, nor without a jerk limit than {}, {:.2} % less.",
            duration(summary.least_time_s),
            100.0 * (1.0 - summary.least_time_s / summary.time_s),
            duration(summary.jerk_free_time_s),
            100.0 * (1.0 - summary.jerk_free_time_s / summary.time_s),
        )
    } else {
        "Without look-ahead: neither acceleration nor jerk is limited where the path bends.".to_string()
    };
    let along = format!(
        "Along the path: peak acceleration {:.0} of {:.0} mm/s², peak jerk {} of {} mm/s³.",
        summary.acceleration_max_mm_per_s2,
        summary.acceleration_limit_mm_per_s2,
        short(summary.jerk_max_mm_per_s3),
        short(summary.jerk_limit_mm_per_s3),
    );
    screen::answer(&time)
        + &screen::paragraph(&(at_feed + &bounds))
        + &screen::paragraph(&along)
        + &turning(summary)
        + &screen::paragraph(axes(summary).trim_end())
}

/// The stages. If the path has several curves, the numbers of the curves that `u start` and `u end` belong to are
/// added.
pub(crate) fn stages(summary: &PlanSummary, wide: bool) -> String {
    if wide {
        return wide_stages(summary);
    }
    let has_curves = summary.curves > 1;
    let mut header = vec!["stage", "shape", "v start\nmm/s", "v end\nmm/s", "length\nmm", "time\ns"];
    if has_curves {
        header.insert(2, "curve");
    }
    let row = |stage: &StageRow| {
        let mut cells = vec![stage.kind.to_string(), stage.shape.to_string()];
        cells.extend(has_curves.then(|| curves(stage)));
        cells.extend(feeds(stage));
        cells
    };
    let shown = summary.stages.iter().take(MOST_ROWS).map(row).collect();
    screen::table(&header, shown) + &left_out(summary.stages.len().saturating_sub(MOST_ROWS), "stages")
}

/// What the first screen leaves out.
fn left_out(count: usize, what: &str) -> String {
    match count {
        0 => String::new(),
        count => screen::paragraph(&format!("and {count} more {what}, which --wide prints too.")),
    }
}

fn wide_stages(summary: &PlanSummary) -> String {
    let has_curves = summary.curves > 1;
    let mut header = vec![
        "stage",
        "shape",
        "u start",
        "u end",
        "v start\nmm/s",
        "v end\nmm/s",
        "length\nmm",
        "time\ns",
        "a0\nmm/s",
        "a1\nmm/s²",
        "a2\nmm/s³",
        "a3\nmm/s⁴",
    ];
    if has_curves {
        header.insert(2, "curve");
    }
    let row = |stage: &StageRow| {
        let mut cells = vec![stage.kind.to_string(), stage.shape.to_string()];
        cells.extend(has_curves.then(|| curves(stage)));
        cells.extend([format!("{:.6}", stage.u_start), format!("{:.6}", stage.u_end)]);
        cells.extend(feeds(stage));
        if let Some([a0, a1, a2, a3]) = stage.coefficients {
            cells.extend([format!("{a0:.3}"), format!("{a1:.0}"), format!("{a2:.3e}"), format!("{a3:.3e}")]);
        }
        cells
    };
    screen::wide_table(&header, summary.stages.iter().map(row).collect(), &[0, 1])
}

fn feeds(stage: &StageRow) -> [String; 4] {
    [
        format!("{:.3}", stage.start_feed_mm_per_s),
        format!("{:.3}", stage.end_feed_mm_per_s),
        format!("{:.3}", stage.length_mm),
        format!("{:.4}", stage.time_s),
    ]
}

/// The acceleration of the setpoints, including bends and corners. If no acceleration across the path is limited and
/// the setpoints have more than `limit`, the limit along the path, a sentence says so.
pub(crate) fn in_all_directions(found: f64, limit: f64, is_free_across: bool) -> String {
    let said = screen::paragraph(&format!("In all directions: peak acceleration {found:.0} mm/s²."));
    // Rounding puts a setpoint off its place by some units of the path's length.
    if !is_free_across || found <= limit * 1.001 {
        return said;
    }
    said + &screen::paragraph(&format!(
        "Warning: `acceleration_mm_per_s2`, {limit:.0}, holds along the path; bends and corners take more. \
         `centripetal_acceleration_mm_per_s2` limits it in bends, and `junction = \"stop\"` at corners."
    ))
}

/// The largest acceleration of a plan's setpoints in all directions.
fn turning(summary: &PlanSummary) -> String {
    let &PlanSummary {
        total_acceleration_max_mm_per_s2, acceleration_limit_mm_per_s2, is_free_across, ..
    } = summary;
    in_all_directions(total_acceleration_max_mm_per_s2, acceleration_limit_mm_per_s2, is_free_across)
}

/// A line for each axis that has a limit of its own.
fn axes(summary: &PlanSummary) -> String {
    let of = |limit: Option<f64>| limit.map_or_else(String::new, |limit| format!(" of {}", short(limit)));
    let line = |peak: &AxisPeak| {
        format!(
            "{} axis: velocity {:.1}{} mm/s, acceleration {:.0}{} mm/s², jerk {:.0}{} mm/s³ at most.\n",
            peak.axis.to_ascii_uppercase(),
            peak.velocity_max_mm_per_s,
            of(peak.limits.velocity_mm_per_s),
            peak.acceleration_max_mm_per_s2,
            of(peak.limits.acceleration_mm_per_s2),
            peak.jerk_max_mm_per_s3,
            of(peak.limits.jerk_mm_per_s3),
        )
    };
    let is_limited = |peak: &&AxisPeak| {
        let limits = peak.limits;
        limits.velocity_mm_per_s.or(limits.acceleration_mm_per_s2).or(limits.jerk_mm_per_s3).is_some()
    };
    summary.axes.iter().filter(is_limited).map(line).collect()
}

/// The curves on which a stage begins and ends, numbered from 0.
fn curves(stage: &StageRow) -> String {
    let (first, last) = (stage.curve_start, stage.curve_end);
    if first == last { first.to_string() } else { format!("{first} to {last}") }
}

/// The samples. If there are several curves, the number of the curve that u belongs to is added.
pub(crate) fn csv(
    to: &mut dyn io::Write,
    samples: impl Iterator<Item = FeedSample>,
    has_curves: bool,
    written: impl Fn(u64),
) -> Result<()> {
    let curve_column = if has_curves { "curve," } else { "" };
    writeln!(
        to,
        "time_s,distance_mm,{curve_column}u,feed_mm_per_s,acceleration_mm_per_s2,jerk_mm_per_s3,limit_mm_per_s"
    )?;
    for (s, row) in samples.zip(1..) {
        if row % 4096 == 0 {
            written(row);
        }
        let curve = if has_curves { format!("{},", s.curve) } else { String::new() };
        writeln!(
            to,
            "{},{},{curve}{},{},{},{},{}",
            s.time_s,
            s.distance_mm,
            s.u,
            s.feed_mm_per_s,
            s.acceleration_mm_per_s2,
            s.jerk_mm_per_s3,
            s.limit_mm_per_s
        )?;
    }
    Ok(())
}
