//! `feedbits interpolate`: the setpoints of one format.

use std::fmt::Write;

use anyhow::{Result, bail};
use clap::Args;
use format_compare::{Dimension, Problem, Reference, SetpointTable, Space};

use crate::compare::{RunArguments, selected};
use crate::input::{AnyProblem, Input};
use crate::progress::Progress;
use crate::{Ending, output};

/// Options of `interpolate`.
#[derive(Args)]
pub(crate) struct Arguments {
    #[command(flatten)]
    input: Input,
    #[command(flatten)]
    run: RunArguments,
    /// The number format.
    #[arg(long, value_name = "F", default_value = "f64")]
    format: String,
    #[command(flatten)]
    output: output::Output,
}

/// Interpolates and writes a line a period.
pub(crate) fn run(arguments: &Arguments) -> Result<Ending> {
    let progress = Progress::spinning("interpolating");
    let (table, finished) = match arguments.input.read()? {
        AnyProblem::Planar(problem) => setpoints(&problem, arguments)?,
        AnyProblem::Spatial(problem) => setpoints(&problem, arguments)?,
    };
    progress.finish();
    let text =
        if arguments.output.json { serde_json::to_string_pretty(&table)? + "\n" } else { csv(&table)? };
    output::write(arguments.output.out.as_deref(), &text)?;
    if !finished {
        eprintln!("feedbits: the run in {} stops before the end of the path", arguments.format);
    }
    Ok(if finished { Ending::Good } else { Ending::RequirementNotMet })
}

fn setpoints<const D: usize>(problem: &Problem<D>, arguments: &Arguments) -> Result<(SetpointTable, bool)>
where
    Space: Dimension<D>,
{
    let options = arguments.run.options()?;
    let formats = selected::<D>(std::slice::from_ref(&arguments.format))?;
    let Some(format) = formats.first() else { bail!("no format") };
    let plan = format_compare::plan_for(problem, format.as_ref(), &options)?;
    let run = format.run(problem, &plan, &options)?;
    Ok((Reference::new(problem)?.setpoints(problem, &run), run.finished))
}

/// The table as CSV; numbers as short as they can be and still be read back as the same.
fn csv(table: &SetpointTable) -> Result<String> {
    let mut text =
        String::from("step,time_s,span,t,u,x_mm,y_mm,z_mm,feed_mm_per_s,chord_mm,fluctuation,evaluations\n");
    for row in table {
        let [x, y, z] = row.point_mm;
        writeln!(
            text,
            "{},{},{},{},{},{x},{y},{z},{},{},{},{}",
            row.step,
            row.time_s,
            row.span,
            row.t,
            row.u,
            row.feed_mm_per_s,
            row.chord_mm,
            row.fluctuation,
            row.evaluations
        )?;
    }
    Ok(text)
}
