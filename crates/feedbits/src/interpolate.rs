//! `feedbits interpolate`: the setpoints of one format.

use std::fmt::Write;
use std::path::{Path, PathBuf};

use anyhow::{Context, Result, bail};
use clap::Args;
use clap_complete::ArgValueCandidates;
use format_compare::{
    Dimension, Engine, Options, OverrideTarget, Overrides, Problem, Reference, Run, SetpointTable, Space,
    Vectors, VectorsAbout, jerk_of_chords,
};
use real::FormatName;

use crate::ending::Ending;
use crate::formats::selected;
use crate::input::{AnyProblem, Input};
use crate::progress::Progress;
use crate::run_arguments::RunArguments;
use crate::{candidates, output};

/// Options of `interpolate`.
#[derive(Args)]
pub(crate) struct Arguments {
    #[command(flatten)]
    input: Input,
    #[command(flatten)]
    run: RunArguments,
    /// The number format.
    #[arg(long, value_name = "F", default_value = "f64", add = ArgValueCandidates::new(candidates::formats))]
    format: String,
    /// Feed overrides on the way: from this time on, in s, this share of the commanded feed, 0 to 200 %. 0 is feed hold. Such a run
    /// goes from rest to rest.
    #[arg(
        long = "override",
        allow_hyphen_values = true,
        conflicts_with_all = ["start_feed", "end_feed"],
        value_name = "S:PERCENT,...",
        value_delimiter = ',',
        value_parser = override_target
    )]
    overrides: Vec<OverrideTarget>,
    /// Share of acceleration and jerk that the plan leaves for changes of the override, in per cent.
    #[arg(
        long,
        allow_negative_numbers = true,
        value_name = "PERCENT",
        default_value_t = 20.0,
        requires = "overrides"
    )]
    reserve: f64,
    /// Write test vectors into this folder: what the step holds in each period, bit by bit, as CSV and as memory images.
    #[arg(long, value_name = "FOLDER", conflicts_with_all = ["overrides", "out", "json"])]
    vectors: Option<PathBuf>,
    #[command(flatten)]
    output: output::Output,
}

/// Interpolates and writes a line for each period.
pub(crate) fn run(arguments: &Arguments) -> Result<Ending> {
    if let Some(folder) = &arguments.vectors {
        let vectors = match arguments.run.problem(&arguments.input)? {
            AnyProblem::Planar(problem) => vectors(&problem, arguments)?,
            AnyProblem::Spatial(problem) => vectors(&problem, arguments)?,
        };
        return write_vectors(folder, &vectors);
    }
    output::expect_place(arguments.output.out.as_deref())?;
    let progress = Progress::spinning("interpolating");
    let (table, stopped) = match arguments.run.problem(&arguments.input)? {
        AnyProblem::Planar(problem) => setpoints(&problem, arguments)?,
        AnyProblem::Spatial(problem) => setpoints(&problem, arguments)?,
    };
    progress.finish();
    let text =
        if arguments.output.json { serde_json::to_string_pretty(&table)? + "\n" } else { csv(&table)? };
    output::write(arguments.output.out.as_deref(), &text)?;
    let Some(format) = stopped else { return Ok(Ending::Good) };
    output::say(&format!("feedbits: the run in {format} stops before the end of the path"));
    Ok(Ending::RequirementNotMet)
}

/// The setpoints, and the format's name if its run stops before the end of the path.
fn setpoints<const D: usize>(
    problem: &Problem<D>,
    arguments: &Arguments,
) -> Result<(SetpointTable, Option<FormatName>)>
where
    Space: Dimension<D>,
{
    let options = arguments.run.options_for(problem)?;
    let formats = selected::<D>(std::slice::from_ref(&arguments.format))?;
    let Some(format) = formats.first() else { bail!("no format") };
    let stopped = |run: &Run| (!run.finished).then(|| format.name());
    if arguments.overrides.is_empty() {
        let plan = format_compare::plan_for(problem, format.as_ref(), &options)?;
        let run = format.run(problem, &plan, &options)?;
        return Ok((Reference::new(problem)?.setpoints(problem, &run), stopped(&run)));
    }
    if options.engine != Engine::Pieces {
        bail!("--override goes with pieces: give --evaluate pieces");
    }
    let overrides = Overrides::try_new(arguments.overrides.clone(), arguments.reserve / 100.0)?;
    let to_plan = overrides.to_plan(problem);
    let plan = format_compare::plan_for(&to_plan, format.as_ref(), &options)?;
    let options = Options { overrides: Some(overrides.commands(problem, &plan)?), ..options };
    let run = format.run(&to_plan, &plan, &options)?;
    let table = Reference::new(problem)?.setpoints(problem, &run);
    output::note(&kept(&table, problem));
    let end = table.last().map_or(0.0, |row| row.time_s);
    for target in arguments.overrides.iter().filter(|target| target.time_s > end) {
        output::say(&format!(
            "feedbits: the override at {} s is never in force: the run ends at {end:.3} s",
            target.time_s
        ));
    }
    Ok((table, stopped(&run)))
}

/// The test vectors of the run.
fn vectors<const D: usize>(problem: &Problem<D>, arguments: &Arguments) -> Result<Vectors>
where
    Space: Dimension<D>,
{
    let options = arguments.run.options_for(problem)?;
    if options.engine != Engine::Pieces {
        bail!("--vectors goes with pieces: give --evaluate pieces");
    }
    let formats = selected::<D>(std::slice::from_ref(&arguments.format))?;
    let Some(format) = formats.first() else { bail!("no format") };
    let plan = format_compare::plan_for(problem, format.as_ref(), &options)?;
    Ok(format.vectors(problem, &plan, &options)?)
}

/// Writes the files of test vectors, all of them or none.
fn write_vectors(folder: &Path, vectors: &Vectors) -> Result<Ending> {
    std::fs::create_dir_all(folder)
        .with_context(|| format!("cannot make the folder {}", folder.display()))?;
    let about = serde_json::to_string_pretty(&vectors.about)? + "\n";
    let files = [
        ("about.json", about.as_str()),
        ("periods.csv", &vectors.periods.csv),
        ("periods.hex", &vectors.periods.image),
        ("signals.csv", &vectors.signals.csv),
        ("signals.hex", &vectors.signals.image),
    ];
    let paths = files.map(|(name, text)| (folder.join(name), text));
    let files: Vec<_> = paths.iter().map(|(path, text)| (path.as_path(), *text)).collect();
    output::write_together(&files)?;
    let VectorsAbout { periods, format, .. } = &vectors.about;
    output::note(&format!("{periods} periods in {format} are in {}", folder.display()));
    Ok(Ending::Good)
}

/// A time and an override, as in `0.5:150`.
fn override_target(text: &str) -> Result<OverrideTarget, String> {
    let number = |text: &str| text.trim().parse::<f64>().ok();
    let parsed = text.split_once(':').and_then(|(time, percent)| Some((number(time)?, number(percent)?)));
    let (time_s, percent) = parsed.ok_or("expected S:PERCENT, as in 0.5:150")?;
    Ok(OverrideTarget { time_s, share: percent / 100.0 })
}

/// The largest acceleration and jerk of the setpoints, from rest to rest, from the chords of neighbouring periods.
fn kept<const D: usize>(table: &SetpointTable, problem: &Problem<D>) -> String {
    let t = problem.period_s();
    let rest = || [0.0, 0.0].into_iter();
    let chords: Vec<f64> = rest().chain(table.iter().map(|row| row.chord_mm)).chain(rest()).collect();
    let changes = chords.windows(2).map(|pair| (pair[1] - pair[0]).abs());
    let acceleration = changes.fold(0.0, f64::max) / t.powi(2);
    let jerk = jerk_of_chords(&chords, t);
    let machine = &problem.machine;
    format!(
        "{} periods: acceleration {acceleration:.1} of {} mm/s², jerk {jerk:.0} of {} mm/s³ at most",
        table.len(),
        machine.acceleration_mm_per_s2,
        machine.jerk_mm_per_s3,
    )
}

/// The table as CSV. Each number is the shortest text that reads back as the same number.
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
