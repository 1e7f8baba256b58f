//! The report of a comparison, as a folder.

use std::fs::{self, File};
use std::path::{Path, PathBuf};

use anyhow::Result;
use format_compare::{
    Compared, Comparison, Dimension, Engine, ExactPlan, Options, Problem, Space, Verdict, Watch,
};
use format_report::{Material, Report, Schedule, Solver};
use target_cost::{StepCost, Target, built_in};

use crate::formats::by_name;
use crate::places::Folder;
use crate::{files, output, progress};

/// The option that names the folder of a report.
const REPORT: &str = "--report";

/// The folder of the report if no command is given.
pub(crate) const FOLDER: &str = "feedbits-report";

/// Targets whose schedule is shown if none is named: one that runs one operation at a time, and one that runs many.
const SHOWN_TARGETS: [&str; 2] = ["cortex-m4f", "dsp48"];

/// Number of periods of which the most common one is scheduled.
const RECORDED_PERIODS: usize = 200;

/// The command that runs if none is given: it compares the built-in example, and writes a report if it can make a
/// folder. What is begun is said at once, for a log shows nothing else until the answer is there.
pub(crate) fn default_command() -> Vec<&'static str> {
    progress::announce("comparing formats on the built-in example, which takes a few seconds");
    match Folder::named(REPORT, Path::new(FOLDER)) {
        Ok(_) => vec!["feedbits", "compare", REPORT, FOLDER],
        Err(error) => {
            output::note(&format!("no report: {error:#}"));
            vec!["feedbits", "compare"]
        }
    }
}

/// Writes the report of a comparison, as [`into()`] does.
pub(crate) fn write<const D: usize>(
    folder: &Folder,
    problem: &Problem<D>,
    compared: &Compared,
    targets: &[Target],
    options: &Options,
) -> Result<PathBuf>
where
    Space: Dimension<D>,
{
    let Compared { comparison, traces, plan } = compared;
    let samples =
        plan.as_ref().map_or(Ok(Vec::new()), |plan| plan.sampled_for_a_picture(problem, PICTURED))?;
    let solvers = solvers(problem, options)?;
    let known: Vec<Target> = if targets.is_empty() {
        built_in()?.into_iter().filter(|target| SHOWN_TARGETS.contains(&target.name.as_str())).collect()
    } else {
        targets.to_vec()
    };
    let schedules = schedules(problem, (comparison, plan.as_ref()), &known, options)?;
    let command = command();
    let report = Report::of(&Material {
        comparison,
        traces,
        plan: &samples,
        solvers: &solvers,
        targets,
        schedules: &schedules,
        command: &command,
    })?;
    into(folder, &report)
}

/// Samples of the plan in a picture, at most, beside those at the ends of stages.
const PICTURED: u64 = 1 << 17;

/// The command as it was given, in words that a shell reads as the same arguments: a name in it may hold `;` or `$(`. A substitute stands
/// for each byte of a name that is no text.
pub(crate) fn command() -> String {
    let arguments = std::env::args_os().skip(1).map(|word| word.to_string_lossy().into_owned());
    let arguments: Vec<String> = arguments.collect();
    // No argument has a zero byte, the one that cannot be quoted.
    let words = shlex::try_join(arguments.iter().map(String::as_str)).unwrap_or_default();
    format!("feedbits {words}").trim_end().to_string()
}

/// Writes a report into its folder. Returns the page's path.
///
/// All files are written whole, under other names, before the first of them takes its place: where the disk is full, or
/// the run is killed until then, the report that was there before is unchanged. Then files take their places in this order:
/// those that the earlier page does not list, those that it lists, and the page. At last, files are removed that only the
/// earlier page listed. All other files in the folder stay.
///
/// So a page is the old one or the new one, whole, at any time, with all its pictures, which are in it, and it lists no
/// file that does not exist. A run that is killed while files take their places leaves the old page, and beside it
/// tables and pictures of which the first are new; each is whole, and the next report replaces all of them. What an
/// interrupted run has left of unfinished files is removed first.
pub(crate) fn into(folder: &Folder, report: &Report) -> Result<PathBuf> {
    let before = listed(folder);
    let mut files: Vec<(&str, &str)> =
        report.files.iter().map(|(name, content)| (name.as_str(), content.as_str())).collect();
    let is_listed = |name: &str| before.iter().any(|listed| listed == name);
    files.sort_by_key(|(name, _)| (*name == Report::PAGE, is_listed(name)));
    folder.write(&files)?;
    let page = folder.path().join(Report::PAGE);
    for name in before.iter().filter(|name| files.iter().all(|(kept, _)| kept != *name)) {
        // If somebody else has removed the file already, that is no error.
        let _ = fs::remove_file(folder.path().join(name));
    }
    Ok(page)
}

/// The folder of a report that an option names, made before long work, whose result would otherwise be lost. Files of a
/// report that is there now are replaced or removed, so none of them may be an input.
pub(crate) fn folder(path: Option<&Path>) -> Result<Option<Folder>> {
    let Some(path) = path else { return Ok(None) };
    let folder = Folder::named(REPORT, path)?;
    folder.place(Report::PAGE)?;
    listed(&folder).iter().try_for_each(|name| folder.place(name).map(|_| ()))?;
    Ok(Some(folder))
}

/// The files that the page in a folder lists, if it is a report's.
fn listed(folder: &Folder) -> Vec<String> {
    let page = File::open(folder.path().join(Report::PAGE))
        .map(|page| files::taken(Report::PAGE, page, files::MOST_OF_MACHINE));
    let text = page.ok().and_then(Result::ok).and_then(|bytes| String::from_utf8(bytes).ok());
    text.map(|page| format_report::listed(&page)).unwrap_or_default()
}

/// Runs by the papers' solvers in f64 that follow the same plan; they run on a single curve only.
fn solvers<const D: usize>(problem: &Problem<D>, options: &Options) -> Result<Vec<Solver>>
where
    Space: Dimension<D>,
{
    let Some(format) = by_name("f64").filter(|_| problem.curves.len() == 1) else { return Ok(Vec::new()) };
    let engines = [Engine::DeBoorSecant, Engine::DeBoorTaylor1, Engine::DeBoorTaylor2];
    let watch = Watch { traces: true, ..Watch::default() };
    let traces = format_compare::compare_with(problem, &[format], &engines, options, &watch)?.traces;
    let named = ["secant", "Taylor, first order", "Taylor, second order"].into_iter().zip(traces);
    Ok(named.filter_map(|(name, trace)| Some(Solver { name: name.to_string(), trace: trace? })).collect())
}

/// The most common period of the recommended run, or of the last run that was not refused, on each target that can
/// price it.
fn schedules<'a, const D: usize>(
    problem: &Problem<D>,
    (comparison, plan): (&Comparison, Option<&ExactPlan>),
    targets: &'a [Target],
    options: &Options,
) -> Result<Vec<Schedule<'a>>>
where
    Space: Dimension<D>,
{
    let recommended = |row: &&format_compare::JudgedRun| {
        Some(&row.format) == comparison.recommended.as_ref()
            && Some(row.engine) == comparison.recommended_engine
    };
    let mut ran = comparison.formats.iter().filter(|row| !matches!(row.verdict, Verdict::Refused(_)));
    let Some(row) = comparison.formats.iter().find(recommended).or_else(|| ran.next_back()) else {
        return Ok(Vec::new());
    };
    let Some(format) = by_name::<D>(&row.format) else { return Ok(Vec::new()) };
    let options = Options { engine: row.engine, ..options.clone() };
    let plan = format_compare::common_or_plan_for(plan, problem, format.as_ref(), &options)?;
    let recorded = format.record(problem, &plan, &options, RECORDED_PERIODS)?;
    let Some((step, _)) = recorded.steps.iter().max_by_key(|(_, count)| *count) else {
        return Ok(Vec::new());
    };
    let schedule = |target: &'a Target| {
        let cost = StepCost::of(step, target, format.name()).ok()?;
        Some(Schedule { target, run: format!("{} {}", row.format, row.engine), cost })
    };
    Ok(targets.iter().filter_map(schedule).collect())
}
