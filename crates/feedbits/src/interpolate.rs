//! `feedbits interpolate`: the setpoints of one format.

mod rows;

use std::path::{Path, PathBuf};

use anyhow::{Context, Result, bail};
use clap::Args;
use clap_complete::ArgValueCandidates;
use domains::options::{OVERRIDE, OVERRIDE_TIME, RESERVE};
use format_compare::{
    AboutRun, ChordTally, Dimension, Engine, JudgedRun, Observer, Options, OverrideTarget, Overrides,
    Problem, Reference, Refusal, Space, Vectors, VectorsAbout,
};
use real::FormatName;

use rows::Rows;

use crate::bounds::{expect_an_end, expect_few_vectors};
use crate::ending::Ending;
use crate::formats::selected;
use crate::input::{AnyProblem, Input, expect_path_alone, in_part};
use crate::numbers::{number, refusal};
use crate::places::{Folder, Place};
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
        value_name = "PERCENT",
        default_value_t = 20.0,
        requires = "overrides",
        value_parser = number(&RESERVE)
    )]
    reserve: f64,
    /// Write test vectors into this folder: what the step holds in each period, bit by bit, as CSV and as memory images. The setpoints are
    /// written beside them with --out or --json.
    #[arg(long, value_name = "FOLDER", conflicts_with = "overrides")]
    vectors: Option<PathBuf>,
    #[command(flatten)]
    output: output::Output,
}

/// Interpolates and writes a line for each period.
pub(crate) fn run(arguments: &Arguments) -> Result<Ending> {
    let folder = arguments.vectors.as_deref().map(vectors_folder).transpose()?;
    let is_wanted = folder.is_none() || arguments.output.json || arguments.output.out.is_some();
    let out = is_wanted.then(|| arguments.output.place()).transpose()?;
    let places = (folder.as_ref(), out.as_ref());
    let broken = match arguments.run.problem(&arguments.input)? {
        AnyProblem::Planar(problem) => in_part(&problem, results(&problem, arguments, places))?,
        AnyProblem::Spatial(problem) => in_part(&problem, results(&problem, arguments, places))?,
    };
    let Some(broken) = broken else { return Ok(Ending::Good) };
    output::say(&format!("feedbits: {broken}"));
    Ok(Ending::RequirementNotMet)
}

/// Writes the test vectors and the setpoints, of which each has a place if it is wanted. Returns which limits of the motion the run breaks, if
/// setpoints are wanted and it breaks any.
fn results<const D: usize>(
    problem: &Problem<D>,
    arguments: &Arguments,
    (folder, out): (Option<&Folder>, Option<&Place>),
) -> Result<Option<String>>
where
    Space: Dimension<D>,
{
    if folder.is_some() {
        expect_path_alone(problem, "--vectors")?;
    }
    if !arguments.overrides.is_empty() {
        expect_path_alone(problem, "--override")?;
    }
    if let Some(folder) = folder {
        write_vectors(folder, &vectors(problem, arguments)?)?;
    }
    out.map_or(Ok(None), |out| setpoints(problem, arguments, out))
}

/// Writes the setpoints while they are made. Returns which limits of the motion the run breaks, if any.
fn setpoints<const D: usize>(
    problem: &Problem<D>,
    arguments: &Arguments,
    out: &Place,
) -> Result<Option<String>>
where
    Space: Dimension<D>,
{
    let options = arguments.run.options_for(problem)?;
    let formats = selected::<D>(std::slice::from_ref(&arguments.format))?;
    let Some(format) = formats.first() else { bail!("no format") };
    let to = (out, arguments.output.json);
    if arguments.overrides.is_empty() {
        let progress = Progress::planning();
        let plan = format_compare::plan_for(problem, format.as_ref(), &options)?;
        let run = |observer: &dyn Observer| format.run_before(problem, &plan, &options, observer);
        let (judged, _) = written(problem, (format.name(), &options), run, plan.periods(), to, &progress)?;
        return Ok(broken(&judged));
    }
    if options.engine != Engine::Pieces {
        bail!("--override goes with pieces: give --evaluate pieces");
    }
    let overrides =
        Overrides::try_new(arguments.overrides.clone(), arguments.reserve / 100.0).context("--override")?;
    let progress = Progress::planning();
    let to_plan = overrides.to_plan(problem);
    expect_an_end(&to_plan, &options)?;
    let plan = format_compare::plan_for(&to_plan, format.as_ref(), &options)?;
    let commands = overrides.commands(problem, &plan)?;
    let periods = commands.periods();
    let options = Options { overrides: Some(commands), ..options };
    let run = |observer: &dyn Observer| format.run_before(&to_plan, &plan, &options, observer);
    let (judged, summary) = written(problem, (format.name(), &options), run, periods, to, &progress)?;
    drop(progress);
    output::note(&kept(&summary, problem));
    let end = summary.end_s;
    for target in arguments.overrides.iter().filter(|target| target.time_s > end) {
        output::say(&format!(
            "feedbits: the override at {} s is never in force: the run ends at {end:.3} s",
            target.time_s
        ));
    }
    Ok(broken(&judged))
}

/// The limits of the motion that a run breaks; `None` if it keeps them.
fn broken(run: &JudgedRun) -> Option<String> {
    let broken = run.requirements.iter().filter(|one| one.is_of_motion && !one.holds());
    let reasons: Vec<_> = broken.map(|one| one.broken.as_str()).collect();
    (!reasons.is_empty()).then(|| format!("the run in {}: {}", run.format, reasons.join("; ")))
}

/// What is said of a run with overrides.
#[derive(Default)]
struct Summary {
    periods: u64,
    end_s: f64,
    chords: ChordTally,
}

/// These chords and two periods of rest, as before the first setpoint and behind the last.
fn at_rest(mut chords: ChordTally) -> ChordTally {
    chords.add(0.0);
    chords.add(0.0);
    chords
}

/// Makes the run of `periods` periods and writes its setpoints to a place, as JSON or CSV.
fn written<const D: usize>(
    problem: &Problem<D>,
    about: (FormatName, &Options),
    run: impl FnOnce(&dyn Observer) -> Result<AboutRun, Refusal>,
    periods: u64,
    (out, as_json): (&Place, bool),
    progress: &Progress,
) -> Result<(JudgedRun, Summary)> {
    let reference = Reference::new(problem)?;
    output::write_by(out, |file| {
        let mut rows = Rows::new(file, as_json);
        let (mut summary, mut failure) = (Summary::default(), None);
        summary.chords = at_rest(summary.chords);
        let judged = reference.show_setpoints(problem, about, run, |row| {
            summary.periods += 1;
            summary.end_s = row.time_s;
            summary.chords.add(row.chord_mm);
            if summary.periods % 4096 == 0 {
                progress.periods(summary.periods, periods);
            }
            if failure.is_none() {
                failure = rows.write(row).err();
            }
        })?;
        summary.chords = at_rest(summary.chords);
        failure.map_or(Ok(()), Err)?;
        rows.finish()?;
        Ok((judged, summary))
    })
}

/// The test vectors of the run.
fn vectors<const D: usize>(problem: &Problem<D>, arguments: &Arguments) -> Result<Vectors>
where
    Space: Dimension<D>,
{
    let options = arguments.run.options_for(problem)?;
    expect_few_vectors(problem, &options)?;
    if options.engine != Engine::Pieces {
        bail!("--vectors goes with pieces: give --evaluate pieces");
    }
    let formats = selected::<D>(std::slice::from_ref(&arguments.format))?;
    let Some(format) = formats.first() else { bail!("no format") };
    let plan = format_compare::plan_for(problem, format.as_ref(), &options)?;
    Ok(format.vectors(problem, &plan, &options)?)
}

/// The files of test vectors.
const VECTOR_FILES: [&str; 5] = ["about.json", "periods.csv", "periods.hex", "signals.csv", "signals.hex"];

/// The folder for test vectors, in which each of their files can be written.
pub(crate) fn vectors_folder(path: &Path) -> Result<Folder> {
    let folder = Folder::named("--vectors", path)?;
    VECTOR_FILES.iter().try_for_each(|name| folder.place(name).map(|_| ()))?;
    Ok(folder)
}

/// Writes the files of test vectors, all of them or none.
pub(crate) fn write_vectors(folder: &Folder, vectors: &Vectors) -> Result<()> {
    let Vectors { about, periods, signals } = vectors;
    let about = serde_json::to_string_pretty(about)? + "\n";
    let texts = [&about, &periods.csv, &periods.image, &signals.csv, &signals.image];
    let files: Vec<(&str, &str)> = VECTOR_FILES.into_iter().zip(texts.map(String::as_str)).collect();
    folder.write(&files)?;
    let VectorsAbout { periods, format, .. } = &vectors.about;
    output::note(&format!("{periods} periods in {format} are in {}", folder.path().display()));
    Ok(())
}

/// A time and an override, as in `0.5:150`.
fn override_target(text: &str) -> Result<OverrideTarget, String> {
    let number = |text: &str| text.trim().parse::<f64>().ok();
    let parsed = text.split_once(':').and_then(|(time, percent)| Some((number(time)?, number(percent)?)));
    let (time_s, percent) = parsed.ok_or("expected S:PERCENT, as in 0.5:150")?;
    if !OVERRIDE_TIME.holds(time_s) {
        return Err(format!("the time {}", refusal(&OVERRIDE_TIME, time_s)));
    }
    if !OVERRIDE.holds(percent) {
        return Err(format!("the override {}", refusal(&OVERRIDE, percent)));
    }
    Ok(OverrideTarget { time_s, share: percent / 100.0 })
}

/// The largest acceleration and jerk of the setpoints, from rest to rest, from the chords of neighbouring periods.
fn kept<const D: usize>(summary: &Summary, problem: &Problem<D>) -> String {
    let (chords, t) = (&summary.chords, problem.period_s());
    let (acceleration, jerk) = (chords.acceleration_max_mm_per_s2(t), chords.jerk_max_mm_per_s3(t));
    let machine = &problem.machine;
    format!(
        "{} periods: acceleration {acceleration:.1} of {} mm/s², jerk {jerk:.0} of {} mm/s³ at most",
        summary.periods, machine.acceleration_mm_per_s2, machine.jerk_mm_per_s3,
    )
}
