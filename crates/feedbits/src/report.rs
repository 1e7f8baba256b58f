//! The report of a comparison, as a folder.

use std::fs;
use std::path::{Path, PathBuf};

use anyhow::{Context, Result};
use format_compare::{
    Compared, Comparison, Dimension, Engine, ExactPlan, Options, Problem, Space, Verdict, Watch,
};
use format_report::{Material, Report, Schedule, Solver};
use target_cost::{StepCost, Target, built_in};

use crate::formats::by_name;
use crate::{output, progress};

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
    match fs::create_dir_all(FOLDER) {
        Ok(()) => vec!["feedbits", "compare", "--report", FOLDER],
        Err(error) => {
            output::note(&format!("no report: cannot make the folder {FOLDER}: {error}"));
            vec!["feedbits", "compare"]
        }
    }
}

/// Writes the report and returns the page's path. The page is written last, so it never names a file that does not
/// exist.
pub(crate) fn write<const D: usize>(
    folder: &Path,
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

/// The command as it was given, in words that a shell reads as the same arguments: a name in it may hold `;` or `$(`.
pub(crate) fn command() -> String {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    // No argument has a zero byte, the one that cannot be quoted.
    let words = shlex::try_join(arguments.iter().map(String::as_str)).unwrap_or_default();
    format!("feedbits {words}").trim_end().to_string()
}

/// Writes a report into a folder, which is made if it does not exist. The page is written last. Returns the page's
/// path.
///
/// Before, the unfinished files of an interrupted run are removed. Afterwards, files are removed that the page of an
/// earlier report listed and the new page does not. All other files in the folder stay.
pub(crate) fn into(folder: &Path, report: &Report) -> Result<PathBuf> {
    make_folder(Some(folder))?;
    output::clear_unfinished(folder);
    let page = folder.join(Report::PAGE);
    let before = fs::read_to_string(&page).map(|page| format_report::listed(&page)).unwrap_or_default();
    for (name, content) in report.files.iter().rev() {
        output::write(Some(&folder.join(name)), content)?;
    }
    for name in before.iter().filter(|name| report.files.iter().all(|(kept, _)| kept != *name)) {
        // If somebody else has removed the file already, that is no error.
        let _ = fs::remove_file(folder.join(name));
    }
    Ok(page)
}

/// Makes the folder of a report, if one is named and it does not exist. This is done before long work, whose result
/// would otherwise be lost.
pub(crate) fn make_folder(folder: Option<&Path>) -> Result<()> {
    let Some(folder) = folder else { return Ok(()) };
    fs::create_dir_all(folder).with_context(|| format!("cannot make the folder {}", folder.display()))
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
