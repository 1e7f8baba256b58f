//! `feedbits plan`: the stages of the feed, or the plan sampled.

mod print;

use anyhow::{Result, bail};
use clap::Args;
use domains::options::OVERSAMPLE;
use format_compare::{Dimension, ExactPlan, MergeRow, Options, PlanSummary, Problem, ProfileKind, Space};

use crate::bounds::expect_an_end;
use crate::ending::Ending;
use crate::formats::selected;
use crate::input::{AnyProblem, Input, in_part};
use crate::numbers::whole;
use crate::output;
use crate::places::Place;
pub(crate) use crate::plan::print::in_all_directions;
use crate::plan::print::{answer, csv, explained, side_by_side, stages};
use crate::progress::Progress;
use crate::run_arguments::PlanArguments;

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
        default_value_t = 1,
        requires = "out",
        conflicts_with = "json",
        value_parser = whole::<u32>(&OVERSAMPLE)
    )]
    oversample: u32,
    /// Print every stage, with the parameters at its ends and the coefficients of its feed: about 130 columns.
    #[arg(long)]
    wide: bool,
    /// Print what the profile flexible decides where accelerations and decelerations follow each other: merged into one
    /// half-cosine, or kept apart, and why.
    #[arg(long, conflicts_with_all = ["window", "plan_in"])]
    explain: bool,
    #[command(flatten)]
    output: output::Output,
}

/// Plans and prints the table of stages; with --out, writes the sampled plan.
pub(crate) fn run(arguments: &Arguments) -> Result<Ending> {
    let out = arguments.output.place()?;
    match arguments.input.read()? {
        AnyProblem::Planar(problem) => in_part(&problem, plan(&problem, arguments, &out)),
        AnyProblem::Spatial(problem) => in_part(&problem, plan(&problem, arguments, &out)),
    }
}

fn plan<const D: usize>(problem: &Problem<D>, arguments: &Arguments, out: &Place) -> Result<Ending>
where
    Space: Dimension<D>,
{
    if arguments.explain {
        return explain(problem, arguments, out);
    }
    let formats = selected::<D>(&["f64".to_string()])?;
    let options = |&profile| -> Result<Options> {
        let options = arguments.plan.options(profile)?;
        expect_an_end(problem, &options)?;
        Ok(options)
    };
    let options = arguments.plan.profiles().iter().map(options).collect::<Result<Vec<_>>>()?;
    // With --out, the plan goes to the file and the stages to the terminal.
    let writes_samples = out.path().is_some() && !arguments.output.json;
    let terminal = writes_samples.then(Place::terminal).transpose()?;
    let planned = |options| -> Result<(ExactPlan, PlanSummary)> {
        let plan = format_compare::plan_for(problem, formats[0].as_ref(), options)?;
        let summary = PlanSummary::of(&plan, problem)?;
        Ok((plan, summary))
    };
    arguments.plan.note_window();
    let progress = Progress::spinning("planning");
    let plans = options.iter().map(planned).collect::<Result<Vec<_>>>()?;
    progress.finish();
    let [(plan, summary)] = plans.as_slice() else {
        let summaries: Vec<_> = plans.into_iter().map(|(_, summary)| summary).collect();
        let text = if arguments.output.json {
            json(&summaries)?
        } else {
            side_by_side(&summaries, problem.period_s(), arguments.wide)
        };
        output::write(out, &text)?;
        return Ok(Ending::Good);
    };
    let text = if arguments.output.json {
        json(summary)?
    } else {
        answer(summary, &problem.name, problem.period_s()) + "\n" + &stages(summary, arguments.wide)
    };
    if terminal.is_some() {
        let rows = plan.samples(problem, arguments.oversample)?;
        let all = plan.periods() * u64::from(arguments.oversample);
        let progress = Progress::planning();
        output::write_by(out, |file| csv(file, rows, summary.curves > 1, |row| progress.periods(row, all)))?;
        progress.finish();
    }
    output::write(terminal.as_ref().unwrap_or(out), &text)?;
    let broken = summary.broken(&problem.machine);
    if broken.is_empty() {
        return Ok(Ending::Good);
    }
    output::say(&format!("feedbits: the plan: {}", broken.join("; ")));
    Ok(Ending::RequirementNotMet)
}

/// Prints the decisions of the profile flexible.
fn explain<const D: usize>(problem: &Problem<D>, arguments: &Arguments, out: &Place) -> Result<Ending> {
    if !arguments.plan.allows_flexible() {
        bail!(
            "--explain is about the profile flexible, which merges transitions: expected --profile flexible, or none at all"
        );
    }
    let options = arguments.plan.options(ProfileKind::Flexible)?;
    expect_an_end(problem, &options)?;
    let progress = Progress::spinning("planning");
    let rows = MergeRow::all(problem, options.end_feeds_mm_per_s)?;
    progress.finish();
    let text = if arguments.output.json { json(&rows)? } else { explained(&rows, problem, arguments.wide) };
    output::write(out, &text)?;
    Ok(Ending::Good)
}

fn json(value: &impl serde::Serialize) -> Result<String> {
    Ok(serde_json::to_string_pretty(value)? + "\n")
}
