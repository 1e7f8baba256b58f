//! `feedbits plan`: the stages of the feed, or the plan sampled.

use std::fmt::Write;

use anyhow::Result;
use clap::Args;
use comfy_table::{CellAlignment, Table, presets};
use format_compare::{Dimension, ExactPlan, FeedSample, PlanSummary, Problem, Space, StageRow};

use crate::compare::{RunArguments, selected};
use crate::input::{AnyProblem, Input};
use crate::{Ending, output};

/// Options of `plan`.
#[derive(Args)]
pub(crate) struct Arguments {
    #[command(flatten)]
    input: Input,
    #[command(flatten)]
    run: RunArguments,
    /// Samples per interpolation period in the file that --out names.
    #[arg(long, default_value_t = 1, value_parser = clap::value_parser!(u32).range(1..=1000))]
    oversample: u32,
    #[command(flatten)]
    output: output::Output,
}

/// Plans; prints the stage table, and with --out writes the sampled plan.
pub(crate) fn run(arguments: &Arguments) -> Result<Ending> {
    match arguments.input.read()? {
        AnyProblem::Planar(problem) => plan(&problem, arguments),
        AnyProblem::Spatial(problem) => plan(&problem, arguments),
    }
}

fn plan<const D: usize>(problem: &Problem<D>, arguments: &Arguments) -> Result<Ending>
where
    Space: Dimension<D>,
{
    let options = arguments.run.options()?;
    let formats = selected::<D>(&["f64".to_string()])?;
    let plan: ExactPlan = format_compare::plan_for(problem, formats[0].as_ref(), &options)?;
    let summary = PlanSummary::of(&plan, problem)?;
    let text =
        if arguments.output.json { serde_json::to_string_pretty(&summary)? + "\n" } else { table(&summary) };
    match arguments.output.out.as_deref() {
        None => output::write(None, &text)?,
        path if arguments.output.json => output::write(path, &text)?,
        path => {
            output::write(path, &csv(&plan.sampled(problem, arguments.oversample)?)?)?;
            output::write(None, &text)?;
        }
    }
    Ok(Ending::Good)
}

fn table(summary: &PlanSummary) -> String {
    let mut table = Table::new();
    table.load_preset(presets::UTF8_FULL_CONDENSED).set_header([
        "stage",
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
    ]);
    for stage in &summary.stages {
        table.add_row(cells(stage));
    }
    for column in table.column_iter_mut().skip(1) {
        column.set_cell_alignment(CellAlignment::Right);
    }
    format!(
        "{table}\n{} stages, {:.3} mm in {:.4} s ({} periods); without a jerk limit {:.4} s at least.\n\
         Peak acceleration {:.0} of {:.0} mm/s², peak jerk {:.3e} of {:.3e} mm/s³, {:.0} % of the path at the commanded feed.\n",
        summary.stages.len(),
        summary.length_mm,
        summary.time_s,
        summary.periods,
        summary.jerk_free_time_s,
        summary.acceleration_max_mm_per_s2,
        summary.acceleration_limit_mm_per_s2,
        summary.jerk_max_mm_per_s3,
        summary.jerk_limit_mm_per_s3,
        100.0 * summary.share_at_commanded_feed,
    )
}

fn cells(stage: &StageRow) -> Vec<String> {
    let [a0, a1, a2, a3] = stage.coefficients;
    vec![
        stage.kind.to_string(),
        format!("{:.6}", stage.u_start),
        format!("{:.6}", stage.u_end),
        format!("{:.3}", stage.start_feed_mm_per_s),
        format!("{:.3}", stage.end_feed_mm_per_s),
        format!("{:.3}", stage.length_mm),
        format!("{:.4}", stage.time_s),
        format!("{a0:.3}"),
        format!("{a1:.0}"),
        format!("{a2:.3e}"),
        format!("{a3:.3e}"),
    ]
}

fn csv(samples: &[FeedSample]) -> Result<String> {
    let mut text = String::from(
        "time_s,distance_mm,u,feed_mm_per_s,acceleration_mm_per_s2,jerk_mm_per_s3,limit_mm_per_s\n",
    );
    for s in samples {
        writeln!(
            text,
            "{},{},{},{},{},{},{}",
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
