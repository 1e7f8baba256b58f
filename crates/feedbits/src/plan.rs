//! `feedbits plan`: the stages of the feed, or the plan sampled.

use std::fmt::Write;

use anyhow::{Result, bail};
use clap::Args;
use comfy_table::{CellAlignment, Table, presets};
use format_compare::{AxisPeak, Dimension, ExactPlan, FeedSample, PlanSummary, Problem, Space, StageRow};

use crate::formats::selected;
use crate::input::{AnyProblem, Input};
use crate::progress::Progress;
use crate::run_arguments::{PlanArguments, expect_an_end};
use crate::{Ending, output};

/// Options of `plan`.
#[derive(Args)]
pub(crate) struct Arguments {
    #[command(flatten)]
    input: Input,
    #[command(flatten)]
    plan: PlanArguments,
    /// Samples per interpolation period in the file that --out names.
    #[arg(
        long,
        allow_negative_numbers = true,
        default_value_t = 1,
        requires = "out",
        conflicts_with = "json",
        value_parser = clap::value_parser!(u32).range(1..=1000)
    )]
    oversample: u32,
    /// Look ahead no further than this, in mm, as a controller does that streams a long program. Plans in f64, from rest
    /// to rest.
    #[arg(
        long,
        allow_negative_numbers = true,
        value_name = "MM",
        conflicts_with_all = ["plan_in", "start_feed", "end_feed"]
    )]
    window: Option<f64>,
    #[command(flatten)]
    output: output::Output,
}

/// Plans; prints the stage table, and with --out writes the sampled plan.
pub(crate) fn run(arguments: &Arguments) -> Result<Ending> {
    output::expect_place(arguments.output.out.as_deref())?;
    match arguments.input.read()? {
        AnyProblem::Planar(problem) => plan(&problem, arguments),
        AnyProblem::Spatial(problem) => plan(&problem, arguments),
    }
}

fn plan<const D: usize>(problem: &Problem<D>, arguments: &Arguments) -> Result<Ending>
where
    Space: Dimension<D>,
{
    let formats = selected::<D>(&["f64".to_string()])?;
    let planned = |&profile| -> Result<(ExactPlan, PlanSummary)> {
        let options = arguments.plan.options(profile)?;
        expect_an_end(problem, &options)?;
        let plan = match arguments.window {
            Some(window) if window > 0.0 && window.is_finite() => {
                ExactPlan::through_window(problem, window, profile)?
            }
            Some(window) => bail!("--window {window}: expected a positive length in mm"),
            None => format_compare::plan_for(problem, formats[0].as_ref(), &options)?,
        };
        let summary = PlanSummary::of(&plan, problem)?;
        Ok((plan, summary))
    };
    let progress = Progress::spinning("planning");
    let plans = arguments.plan.profiles().iter().map(planned).collect::<Result<Vec<_>>>()?;
    progress.finish();
    let out = arguments.output.out.as_deref();
    let [(plan, summary)] = plans.as_slice() else {
        let summaries: Vec<_> = plans.into_iter().map(|(_, summary)| summary).collect();
        let text = if arguments.output.json { json(&summaries)? } else { side_by_side(&summaries) };
        output::write(out, &text)?;
        return Ok(Ending::Good);
    };
    let text = if arguments.output.json { json(summary)? } else { table(summary) };
    match out {
        None => output::write(None, &text)?,
        path if arguments.output.json => output::write(path, &text)?,
        path => {
            output::write(path, &csv(&plan.sampled(problem, arguments.oversample)?, summary.curves > 1)?)?;
            output::write(None, &text)?;
        }
    }
    Ok(Ending::Good)
}

fn json(value: &impl serde::Serialize) -> Result<String> {
    Ok(serde_json::to_string_pretty(value)? + "\n")
}

/// One row a kind of transitions.
fn side_by_side(summaries: &[PlanSummary]) -> String {
    let mut table = Table::new();
    table.load_preset(presets::UTF8_FULL_CONDENSED).set_header([
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
    ]);
    for summary in summaries {
        table.add_row([
            summary.profile.to_string(),
            format!("{:.4}", summary.time_s),
            summary.periods.to_string(),
            format!("{:.2} %", 100.0 * summary.over_jerk_free),
            format!("{:.1} %", 100.0 * summary.share_at_commanded_feed),
            summary.feed_over_commanded.map_or_else(String::new, |run| format!("{:.3} %", 100.0 * run)),
            format!("{:.0}", summary.acceleration_max_mm_per_s2),
            format!("{:.0}", summary.total_acceleration_max_mm_per_s2),
            format!("{:.3e}", summary.jerk_max_mm_per_s3),
            summary.stage_count.to_string(),
        ]);
    }
    for column in table.column_iter_mut().skip(1) {
        column.set_cell_alignment(CellAlignment::Right);
    }
    let bound = summaries.first().map_or_else(String::new, |summary| {
        format!(
            "{:.3} mm; without a jerk limit {:.4} s at least. Limits {:.0} mm/s² and {:.3e} mm/s³.\n",
            summary.length_mm,
            summary.jerk_free_time_s,
            summary.acceleration_limit_mm_per_s2,
            summary.jerk_limit_mm_per_s3,
        )
    });
    let most = |a: &&PlanSummary, b: &&PlanSummary| {
        a.total_acceleration_max_mm_per_s2.total_cmp(&b.total_acceleration_max_mm_per_s2)
    };
    let turning = summaries.iter().max_by(most).map_or_else(String::new, turning);
    format!("{table}\n{bound}{turning}")
}

/// The stages; of a path of several curves with the numbers of the curves that `u start` and `u end` belong to.
fn table(summary: &PlanSummary) -> String {
    let has_curves = summary.curves > 1;
    let mut table = Table::new();
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
    table.load_preset(presets::UTF8_FULL_CONDENSED).set_header(header);
    for stage in &summary.stages {
        let mut cells = cells(stage);
        if has_curves {
            cells.insert(2, curves(stage));
        }
        table.add_row(cells);
    }
    for column in table.column_iter_mut().skip(2) {
        column.set_cell_alignment(CellAlignment::Right);
    }
    format!(
        "{table}\n{} stages, {:.3} mm in {:.4} s ({} periods); without a jerk limit {:.4} s at least, {:.2} % less.\n\
         Along the path: peak acceleration {:.0} of {:.0} mm/s², peak jerk {:.3e} of {:.3e} mm/s³.\n\
         {:.0} % of the path at {}the commanded feed.\n",
        summary.stages.len(),
        summary.length_mm,
        summary.time_s,
        summary.periods,
        summary.jerk_free_time_s,
        100.0 * (1.0 - summary.jerk_free_time_s / summary.time_s),
        summary.acceleration_max_mm_per_s2,
        summary.acceleration_limit_mm_per_s2,
        summary.jerk_max_mm_per_s3,
        summary.jerk_limit_mm_per_s3,
        100.0 * summary.share_at_commanded_feed,
        summary.feed_over_commanded.map_or_else(String::new, |run| format!("{:.3} % of ", 100.0 * run)),
    ) + &turning(summary)
        + &axes(summary)
}

/// What the setpoints take in bends and at corners too, and whether that is more than one would think: than `limit` along the path,
/// where none across it is set.
pub(crate) fn in_all_directions(found: f64, limit: f64, is_free_across: bool) -> String {
    let said = format!("In all directions: peak acceleration {found:.0} mm/s².\n");
    // A setpoint is off its place by some roundings of the path's length.
    if !is_free_across || found <= limit * 1.001 {
        return said;
    }
    said + &format!(
        "Warning: `acceleration_mm_per_s2`, {limit:.0}, holds along the path; bends and corners take more. \
         `centripetal_acceleration_mm_per_s2` limits it in bends, and `junction = \"stop\"` at corners.\n"
    )
}

/// The same of a plan.
fn turning(summary: &PlanSummary) -> String {
    let &PlanSummary {
        total_acceleration_max_mm_per_s2, acceleration_limit_mm_per_s2, is_free_across, ..
    } = summary;
    in_all_directions(total_acceleration_max_mm_per_s2, acceleration_limit_mm_per_s2, is_free_across)
}

/// A line for each axis that has a limit of its own.
fn axes(summary: &PlanSummary) -> String {
    let of = |limit: Option<f64>| limit.map_or_else(String::new, |limit| format!(" of {limit}"));
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

/// The curves that a stage begins and ends on, numbered from 0.
fn curves(stage: &StageRow) -> String {
    let (first, last) = (stage.curve_start, stage.curve_end);
    if first == last { first.to_string() } else { format!("{first} to {last}") }
}

fn cells(stage: &StageRow) -> Vec<String> {
    let mut cells = vec![
        stage.kind.to_string(),
        stage.shape.to_string(),
        format!("{:.6}", stage.u_start),
        format!("{:.6}", stage.u_end),
        format!("{:.3}", stage.start_feed_mm_per_s),
        format!("{:.3}", stage.end_feed_mm_per_s),
        format!("{:.3}", stage.length_mm),
        format!("{:.4}", stage.time_s),
    ];
    if let Some([a0, a1, a2, a3]) = stage.coefficients {
        cells.extend([format!("{a0:.3}"), format!("{a1:.0}"), format!("{a2:.3e}"), format!("{a3:.3e}")]);
    }
    cells
}

/// The samples, with the number of the curve that u belongs to if there are several.
fn csv(samples: &[FeedSample], has_curves: bool) -> Result<String> {
    let curve_column = if has_curves { "curve," } else { "" };
    let mut text = format!(
        "time_s,distance_mm,{curve_column}u,feed_mm_per_s,acceleration_mm_per_s2,jerk_mm_per_s3,limit_mm_per_s\n"
    );
    for s in samples {
        let curve = if has_curves { format!("{},", s.curve) } else { String::new() };
        writeln!(
            text,
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
    Ok(text)
}
