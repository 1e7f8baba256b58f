//! `feedbits servo`: what the machine makes of each format's setpoints.

use std::ops::Range;
use std::path::{Path, PathBuf};

use anyhow::{Context, Result, bail};
use clap::Args;
use clap_complete::ArgValueCandidates;
use format_compare::{Dimension, Engine, ExactPlan, Format, MOST_PERIODS, Options, Problem, RunStep, Space};
use nurbs_core::{Evaluate, NurbsBuf};
use serde::Serialize;
use servo_sim::{
    Arrival, CircleTest, ErrorSize, FEED_FORWARDS, Roundness, Servo, ServoError, ServoParameters, Tuning,
    TuningRow, VELOCITY_GAINS_PERCENT, contour_error, roundness_plot, tuning_table,
};

use crate::formats::selected;
use crate::input::{self, AnyProblem, Input};
use crate::progress::Progress;
use crate::run_arguments::RunArguments;
use crate::screen::{self, short};
use crate::{Ending, completions, output};

/// The drive that runs when no servo file is given: fitted to paper D's circle test.
const EXAMPLE: &str = include_str!("../../../data/servo.toml");

/// Options of `servo`.
#[derive(Args)]
pub(crate) struct Arguments {
    #[command(flatten)]
    input: Input,
    /// Servo file (TOML with a table `servo`). Default: the built-in example, data/servo.toml.
    #[arg(long, value_name = "FILE")]
    servo: Option<PathBuf>,
    #[command(flatten)]
    run: RunArguments,
    /// The formats to run, comma-separated. Default: all; see `feedbits formats`. Names in Q notation are
    /// read by the register that they fill: Q8.24 (Arm) and Q7.24 (TI) are I8F24.
    #[arg(long, visible_alias = "format", value_delimiter = ',', value_parser = crate::formats::name, value_name = "F,F", add = ArgValueCandidates::new(completions::formats))]
    formats: Vec<String>,
    /// Radius of the circle test, in mm.
    #[arg(long, allow_negative_numbers = true, value_name = "MM", default_value_t = 10.0)]
    circle: f64,
    /// Feedrate of the circle test, in mm/min, as an F word has it.
    #[arg(long, allow_negative_numbers = true, value_name = "MM_PER_MIN", default_value_t = 4000.0)]
    feed: f64,
    /// Write the magnified roundness plot of the circle test to this SVG file.
    #[arg(long, value_name = "FILE.svg")]
    plot: Option<PathBuf>,
    /// Print all figures of each format, also of the textbook way *raw*: about 170 columns.
    #[arg(long)]
    wide: bool,
    #[command(flatten)]
    output: output::Output,
}

/// What `--json` prints.
#[derive(Serialize)]
struct Report {
    part: String,
    interpolation_period_ms: f64,
    servo: ServoParameters,
    formats: Vec<FormatRow>,
    circle: CircleReport,
    tuning: Vec<TuningRow>,
    /// The settings of the table that make no circle.
    tuning_left_out: Vec<LeftOut>,
}

/// The part in one format, by one engine.
#[derive(Serialize)]
struct FormatRow {
    format: String,
    engine: Engine,
    #[serde(flatten)]
    outcome: Outcome,
}

#[derive(Serialize)]
#[serde(rename_all = "snake_case", untagged)]
enum Outcome {
    Ran {
        /// Distance of the setpoints from the curve.
        setpoint_error_mm: ErrorSize,
        /// Command minus table, an axis each.
        following_error_mm: Vec<ErrorSize>,
        /// Distance of the table from the curve.
        contour_error_mm: ErrorSize,
        reached_the_end: bool,
        arrival: Arrival,
        /// Why the contour error means nothing.
        #[serde(skip_serializing_if = "Option::is_none")]
        does_not_follow: Option<String>,
    },
    /// Why the format was not run.
    Refused { refused: String },
}

#[derive(Serialize)]
struct CircleReport {
    radius_mm: f64,
    feedrate_mm_per_min: f64,
    #[serde(flatten)]
    result: CircleResult,
}

#[derive(Serialize)]
#[serde(untagged)]
enum CircleResult {
    Round(Roundness),
    /// Why there is no circle to judge.
    DoesNotFollow {
        does_not_follow: String,
    },
}

/// Settings of one velocity gain that make no circle, for one reason.
#[derive(Serialize)]
struct LeftOut {
    velocity_gain_percent: f64,
    feed_forwards: Vec<f64>,
    reason: String,
}

/// Simulates and prints.
pub(crate) fn run(arguments: &Arguments) -> Result<Ending> {
    let servo = parameters(arguments.servo.as_ref())?;
    for path in [&arguments.output.out, &arguments.plot] {
        output::expect_place(path.as_deref())?;
    }
    let progress = Progress::spinning("simulating the axes");
    let (part, period, formats) = match arguments.run.problem(&arguments.input)? {
        AnyProblem::Planar(problem) => {
            (problem.name.clone(), problem.period_s(), rows(&problem, &servo, arguments)?)
        }
        AnyProblem::Spatial(problem) => {
            (problem.name.clone(), problem.period_s(), rows(&problem, &servo, arguments)?)
        }
    };
    let test = circle_test(arguments, period)?;
    let circle = circle(&servo, &test)?;
    let Tuning { rows: tuning, left_out } = tuning_table(&[servo; 2], &test).context("tuning table")?;
    progress.finish();
    if let Some(path) = &arguments.plot {
        plot(path, &servo, &test, &circle)?;
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
    output::write(arguments.output.out.as_deref(), &text)?;
    Ok(ending(&report))
}

/// A format that cannot run the raw problem is an answer, not a failure; one that runs neither way is. So is a machine
/// that does not follow.
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

/// Runs the circle test. A table that does not go round is a result; what else goes wrong is not.
fn circle(servo: &ServoParameters, test: &CircleTest) -> Result<CircleResult> {
    match test.run::<f64>(&[*servo; 2]) {
        Ok(circle) => Ok(CircleResult::Round(circle)),
        Err(reason @ ServoError::DoesNotTurn { .. }) => {
            Ok(CircleResult::DoesNotFollow { does_not_follow: reason.to_string() })
        }
        Err(error) => Err(error).context("circle test"),
    }
}

/// Writes the roundness plot, if there is a circle.
fn plot(path: &Path, servo: &ServoParameters, test: &CircleTest, circle: &CircleResult) -> Result<()> {
    let circle = match circle {
        CircleResult::Round(circle) => circle,
        CircleResult::DoesNotFollow { does_not_follow } => {
            output::say(&format!("feedbits: {} is not written: {does_not_follow}", path.display()));
            return Ok(());
        }
    };
    let title = format!(
        "Circle test: feed-forward {} %, velocity gain {} %",
        servo.feed_forward * 100.0,
        servo.velocity_gain_percent
    );
    output::write(Some(path), &(roundness_plot(test, circle, &title) + "\n"))
}

/// What the tuning table leaves out: settings of one velocity gain and one reason together.
fn by_reason(settings: &[servo_sim::LeftOut]) -> Vec<LeftOut> {
    let mut grouped: Vec<LeftOut> = Vec::new();
    for setting in settings {
        let (gain, reason) = (setting.velocity_gain_percent, setting.reason.to_string());
        match grouped.last_mut() {
            Some(last) if last.velocity_gain_percent == gain && last.reason == reason => {
                last.feed_forwards.push(setting.feed_forward);
            }
            _ => grouped.push(LeftOut {
                velocity_gain_percent: gain,
                feed_forwards: vec![setting.feed_forward],
                reason,
            }),
        }
    }
    grouped
}

/// The circle test that the options name; one that would run for hours is refused.
fn circle_test(arguments: &Arguments, period: f64) -> Result<CircleTest> {
    let test = CircleTest { radius: arguments.circle, feedrate: arguments.feed / 60.0, period };
    // A turn to settle and one to measure, in the servo's own setting and in each of the tuning table.
    let runs = 1 + FEED_FORWARDS.len() * VELOCITY_GAINS_PERCENT.len();
    let periods = 2.0 * test.setpoints_per_turn() * runs as f64;
    if test.feedrate > 0.0 && periods > MOST_PERIODS as f64 {
        bail!(
            "--circle {} at --feed {}: {periods:.3e} periods of {} ms in {runs} settings: expected at most {MOST_PERIODS}",
            arguments.circle,
            arguments.feed,
            period * 1000.0
        );
    }
    Ok(test)
}

fn parameters(path: Option<&PathBuf>) -> Result<ServoParameters> {
    match path {
        Some(path) => {
            ServoParameters::from_toml(&input::text(path)?).with_context(|| path.display().to_string())
        }
        None => ServoParameters::from_toml(EXAMPLE).context("built-in servo example"),
    }
}

fn rows<const D: usize>(
    problem: &Problem<D>,
    servo: &ServoParameters,
    arguments: &Arguments,
) -> Result<Vec<FormatRow>>
where
    Space: Dimension<D>,
{
    servo.validate(problem.period_s())?;
    circle_test(arguments, problem.period_s())?;
    let engines = arguments.run.engines()?;
    let options = arguments.run.options_for(problem)?;
    expect_rest_at_the_ends(&options)?;
    let mut rows = Vec::new();
    for format in selected::<D>(&arguments.formats)? {
        let plan = format_compare::plan_for(problem, format.as_ref(), &options);
        for &engine in &engines {
            let outcome = match &plan {
                Ok(plan) => {
                    simulate(problem, format.as_ref(), plan, &Options { engine, ..options.clone() }, servo)?
                }
                Err(reason) => Outcome::Refused { refused: reason.to_string() },
            };
            rows.push(FormatRow { format: format.name().to_string(), engine, outcome });
        }
    }
    Ok(rows)
}

/// Refuses a feed at either end: the axes are at rest before the first setpoint, and hold the last one.
fn expect_rest_at_the_ends(options: &Options) -> Result<()> {
    for (option, feed) in ["--start-feed", "--end-feed"].into_iter().zip(options.end_feeds_mm_per_s) {
        if feed > 0.0 {
            bail!(
                "{option} {feed}: expected 0, for the axes of `servo` are at rest before and after the path"
            );
        }
    }
    Ok(())
}

/// The part in one format, on a machine whose drives are exact: what differs between rows is the setpoints.
fn simulate<const D: usize>(
    problem: &Problem<D>,
    format: &dyn Format<D>,
    plan: &ExactPlan,
    options: &Options,
    servo: &ServoParameters,
) -> Result<Outcome> {
    let run = match format.run(problem, plan, options) {
        Ok(run) => run,
        Err(reason) => return Ok(Outcome::Refused { refused: reason.to_string() }),
    };
    let setpoints: Vec<[f64; D]> =
        run.steps.iter().map(|step| core::array::from_fn(|d| step.point_mm[d])).collect();
    let curves: Vec<_> = problem.curves.iter().map(NurbsBuf::as_curve).collect();
    let (mut following, mut contour, mut arrival) = (Vec::new(), Vec::new(), Arrival::default());
    for (stretch, first) in stretches(&problem.breaks, &run.steps) {
        let own = curves.get(first.clone()).context("the path has no curve")?;
        let begin = own.first().context("the path has no curve")?;
        let servo =
            Servo::<f64, D>::try_new(&[*servo; D], problem.period_s(), begin.point(begin.domain().0))?;
        let trace = servo.run(setpoints[stretch].iter().copied())?;
        following.push((trace.following_error(), trace.motion_samples));
        contour.push((trace.contour_error(own)?, trace.motion_samples));
        if trace.arrival().reach_mm >= arrival.reach_mm {
            arrival = trace.arrival();
        }
    }
    let of_axis =
        |axis: usize| ErrorSize::joined(following.iter().map(|(sizes, count)| (sizes[axis], *count)));
    Ok(Outcome::Ran {
        setpoint_error_mm: contour_error(&curves, setpoints)?,
        following_error_mm: (0..D).map(of_axis).collect(),
        contour_error_mm: ErrorSize::joined(contour),
        reached_the_end: run.finished,
        arrival,
        does_not_follow: arrival.validate().err().map(|reason| reason.to_string()),
    })
}

/// The parts of a run between which the machine makes another move, as ranges of its steps and of the path's curves: its axes are
/// at rest by the time that it comes back.
fn stretches(breaks: &[usize], steps: &[RunStep]) -> Vec<(Range<usize>, Range<usize>)> {
    let mut begin = (0, 0);
    let mut found = Vec::new();
    for next in breaks.iter().copied().chain([usize::MAX]) {
        let end = steps.partition_point(|step| step.curve < next);
        let curves = steps.get(begin.0..end).and_then(|own| own.last()).map(|last| begin.1..last.curve + 1);
        found.extend(curves.map(|curves| (begin.0..end, curves)));
        begin = (end, next);
    }
    found
}

/// The rows of the first screen: pieces or what was asked for, and in place of pieces that are refused what was run.
fn first_rows(report: &Report, names_engine: bool) -> Vec<&FormatRow> {
    let ran = |row: &&FormatRow| matches!(row.outcome, Outcome::Ran { .. });
    let pieces = || report.formats.iter().filter(|row| row.engine == Engine::Pieces);
    let has_run = |format: &str| pieces().filter(ran).any(|row| row.format == format);
    let is_shown = |row: &&FormatRow| {
        names_engine || row.engine == Engine::Pieces || (ran(row) && !has_run(&row.format))
    };
    report.formats.iter().filter(is_shown).collect()
}

/// The answer, the formats, and what the drive is by itself.
fn shown(report: &Report, rows: &[&FormatRow], table: fn(&[&FormatRow]) -> String) -> String {
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

/// How far the table is off the path, and whether that is for the formats.
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

/// Contour errors within this ratio are the same: what the drive makes of any setpoints.
const AS_FAR: f64 = 1.01;

/// What there is to say of formats beside their figures, and of those that are not shown but decide how the command ends.
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

/// A line for each reason why settings are not in the tuning table.
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

/// Names of the axes that the path has.
fn axes(rows: &[&FormatRow]) -> impl Iterator<Item = &'static str> {
    let count = rows.iter().find_map(|row| match &row.outcome {
        Outcome::Ran { following_error_mm, .. } => Some(following_error_mm.len()),
        Outcome::Refused { .. } => None,
    });
    ["X", "Y", "Z"].into_iter().take(count.unwrap_or(0))
}

/// The largest errors of the formats that were run.
fn narrow_table(rows: &[&FormatRow]) -> String {
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

fn wide_table(rows: &[&FormatRow]) -> String {
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

/// A length in mm as text in µm; three places are nanometres.
fn micrometres(mm: f64) -> String {
    format!("{:.3}", mm * 1000.0)
}
