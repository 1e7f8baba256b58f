//! `feedbits servo`: how the machine follows each format's setpoints.

mod arguments;
mod bounds;
mod circle;
mod paper;
mod print;
mod ramp;
mod report;
mod simulate;

use std::path::PathBuf;

use anyhow::{Context, Result};
use servo_sim::{ServoParameters, Tuning, tuning_table};

use crate::ending::Ending;
use crate::input::{AnyProblem, in_part};
use crate::places::Place;
use crate::progress::Progress;
use crate::{files, output};
pub(crate) use arguments::Arguments;
use circle::{by_reason, circle, circle_test, plot};
use print::{first_rows, narrow_table, shown, wide_table};
use report::{CircleReport, CircleResult, FormatRow, Outcome, Report};
use simulate::rows;

/// The drive that is simulated if no servo file is given: fitted to paper D's circle test.
const EXAMPLE: &str = include_str!("../../../data/servo.toml");

/// Simulates and prints.
pub(crate) fn run(arguments: &Arguments) -> Result<Ending> {
    let servo = parameters(arguments.servo.as_ref())?;
    let out = arguments.output.place()?;
    let plotted = arguments.plot.as_deref().map(|path| Place::named("--plot", Some(path))).transpose()?;
    if arguments.paper_table {
        return paper::print(&servo, arguments.output.json, &out);
    }
    let (part, period, formats) = match arguments.run.problem(&arguments.input)? {
        AnyProblem::Planar(problem) => {
            (problem.name.clone(), problem.period_s(), in_part(&problem, rows(&problem, &servo, arguments))?)
        }
        AnyProblem::Spatial(problem) => {
            (problem.name.clone(), problem.period_s(), in_part(&problem, rows(&problem, &servo, arguments))?)
        }
    };
    let progress = Progress::spinning("simulating the circle test");
    let test = circle_test(arguments, &servo, period)?;
    let circle = circle(&servo, &test)?;
    let Tuning { rows: tuning, left_out } = tuning_table(&[servo; 2], &test).context("tuning table")?;
    progress.finish();
    if let Some(place) = &plotted {
        plot(place, &servo, &test, &circle)?;
    }
    let report = Report {
        part,
        interpolation_period_ms: period * 1000.0,
        servo,
        formats,
        circle: CircleReport { radius_mm: test.radius, feedrate_mm_per_min: arguments.feed, result: circle },
        tuning,
        tuning_left_out: by_reason(&left_out),
    };
    let text = if arguments.output.json {
        serde_json::to_string_pretty(&report)? + "\n"
    } else if arguments.wide {
        shown(&report, &report.formats.iter().collect::<Vec<_>>(), wide_table)
    } else {
        shown(&report, &first_rows(&report, arguments.run.names_engine()), narrow_table)
    };
    output::write(&out, &text)?;
    Ok(ending(&report))
}

/// If a format cannot run the raw problem, that is a result, not a failure. A format that can run neither form is a
/// failure, and so is a machine that does not follow.
fn ending(report: &Report) -> Ending {
    let ran = |row: &&FormatRow| matches!(row.outcome, Outcome::Ran { reached_the_end: true, .. });
    let any_ran = |format: &str| report.formats.iter().filter(ran).any(|row| row.format == format);
    let all_ran = report.formats.iter().all(|row| any_ran(&row.format));
    let follows = |row: &FormatRow| !matches!(row.outcome, Outcome::Ran { does_not_follow: Some(_), .. });
    let round = matches!(report.circle.result, CircleResult::Round(_));
    if all_ran && round && report.formats.iter().all(follows) {
        Ending::Good
    } else {
        Ending::RequirementNotMet
    }
}

fn parameters(path: Option<&PathBuf>) -> Result<ServoParameters> {
    match path {
        Some(path) => ServoParameters::from_toml(&files::text("--servo", path, files::MOST_OF_SMALL)?)
            .with_context(|| path.display().to_string()),
        None => ServoParameters::from_toml(EXAMPLE).context("built-in servo example"),
    }
}
