//! `feedbits compare`: formats side by side.

use std::path::PathBuf;

use anyhow::{Result, bail};
use clap::Args;
use clap_complete::ArgValueCandidates;
use comfy_table::{CellAlignment, ContentArrangement, Table, presets};
use foreign_text::in_a_line;
use format_compare::{
    Compared, Comparison, Dimension, Engine, ExactPlan, JudgedRun, Machine, Options, Problem, Space, Watch,
};
use real::{Datapath, FormatName};
use serde_json::Value;
use target_cost::Target;

use crate::baseline::{self, Baseline, BaselineArguments};
use crate::ending::Ending;
use crate::formats::selected;
use crate::input::{AnyProblem, Input, in_part};
use crate::places::{Folder, Place};
use crate::progress::Progress;
use crate::run_arguments::RunArguments;
use crate::set::baseline::SetBaseline;
use crate::set::parts::{Given, Parts};
use crate::set::work::{OfEachPart, OwnAnswer, Worked};
use crate::set::{self, Outputs};
use crate::targets::TargetArguments;
use crate::{answer, candidates, interrupt, output, period_costs, report};

/// Options of `compare`.
#[derive(Args)]
pub(crate) struct Arguments {
    #[command(flatten)]
    parts: Parts,
    #[command(flatten)]
    run: RunArguments,
    /// The formats to compare, comma-separated. Default: all; see `feedbits formats`. Names in Q notation are
    /// read by the register that they fill: Q8.24 (Arm) and Q7.24 (TI) are I8F24.
    #[arg(long, visible_alias = "format", value_delimiter = ',', value_parser = crate::formats::name, value_name = "F,F", add = ArgValueCandidates::new(candidates::formats))]
    formats: Vec<String>,
    /// Print all figures of each format, also of the textbook way *raw*: about 250 columns.
    #[arg(long)]
    wide: bool,
    #[command(flatten)]
    targets: TargetArguments,
    /// Write a report into this folder: index.html, each picture as SVG, each table as CSV and JSON.
    #[arg(long, value_name = "DIR")]
    report: Option<PathBuf>,
    #[command(flatten)]
    baseline: BaselineArguments,
    #[command(flatten)]
    output: output::Output,
}

impl Arguments {
    /// The forms of the path on the first screen: pieces, or those that the options name.
    fn shown(&self) -> Result<Vec<Engine>> {
        let asked = self.run.engines()?;
        Ok(if self.run.names_engine() { asked } else { vec![Engine::Pieces] })
    }

    /// The forms of the path that are run: all that the options name where each figure is shown.
    fn engines(&self) -> Result<Vec<Engine>> {
        let shows_all = self.wide || self.output.json || self.report.is_some() || self.baseline.is_given();
        if shows_all { self.run.engines() } else { self.shown() }
    }
}

/// What a comparison has beside its problem.
struct Beside {
    part_checksum: u32,
    folder: Option<Folder>,
    out: Place,
    baseline: Option<Baseline>,
    targets: Vec<Target>,
}

/// Compares and prints. Writes the report if the options name a folder for it.
pub(crate) fn run(arguments: &Arguments) -> Result<Ending> {
    match arguments.parts.given() {
        Given::One(input) => run_one(&input, arguments),
        Given::Set(parts) => run_set(parts, arguments),
    }
}

/// Compares on each part of a set, and prints what is good for all of them.
fn run_set(parts: &Parts, arguments: &Arguments) -> Result<Ending> {
    if arguments.wide {
        bail!("--wide: the figures of each format are those of one part: expected one part, or --json");
    }
    let (folder, targets) = (report::folder(arguments.report.as_deref())?, arguments.targets.read()?);
    let work = CompareEach {
        arguments,
        formats: selected::<3>(&arguments.formats)?.iter().map(|format| format.name().to_string()).collect(),
        engines: arguments.engines()?,
        wants_fewest_bits: arguments.shown()?.contains(&Engine::Pieces),
        targets: &targets,
    };
    let outputs = Outputs {
        out: arguments.output.place()?,
        folder,
        json: arguments.output.json,
        targets: &targets,
        baseline: SetBaseline::read(&arguments.baseline, CompareEach::COMMAND)?,
    };
    set::run(&work, parts, &arguments.run, &outputs)
}

/// The comparison on each part of a set.
struct CompareEach<'a> {
    arguments: &'a Arguments,
    /// The names of the formats.
    formats: Vec<String>,
    engines: Vec<Engine>,
    wants_fewest_bits: bool,
    targets: &'a [Target],
}

impl OfEachPart for CompareEach<'_> {
    const COMMAND: &'static str = "compare";

    fn options(&self) -> Result<String> {
        let (options, engines) = (self.arguments.run.options()?, &self.engines);
        Ok(format!("{options:?} {:?} {engines:?} {:?}", self.formats, self.arguments.run.fluctuation()))
    }

    fn datapath(&self) -> Datapath {
        Datapath::default()
    }

    fn options_for<const D: usize>(&self, problem: &Problem<D>) -> Result<Options> {
        Ok(Options { interrupt: Some(interrupt::flag()), ..self.arguments.run.options_for(problem)? })
    }

    fn work<const D: usize>(&self, problem: &Problem<D>, part_checksum: u32) -> Result<Worked>
    where
        Space: Dimension<D>,
    {
        let (formats, options) = (selected::<D>(&self.formats)?, self.options_for(problem)?);
        let mut compared =
            format_compare::compare_with(problem, &formats, &self.engines, &options, &Watch::default())?;
        if !interrupt::is_set() {
            add_answers(problem, &mut compared, self.targets, self.wants_fewest_bits, &options)?;
        }
        let json = baseline::json(Self::COMMAND, part_checksum, &compared.comparison)?;
        Ok(Worked { json, plan: compared.plan })
    }

    fn plan<const D: usize>(&self, problem: &Problem<D>) -> Result<Option<ExactPlan>>
    where
        Space: Dimension<D>,
    {
        let formats = selected::<D>(&self.formats)?;
        Ok(format_compare::common_plan(problem, &formats, &self.options_for(problem)?)?)
    }

    fn own_answer(&self, result: &Value) -> OwnAnswer {
        let found = &result["fewest_bits"];
        let up_to = || format!("{} bits are not enough", found["up_to_bits"]);
        match found["result"].as_str() {
            Some("found") => {
                let format = found["format"].as_str().and_then(FormatName::named);
                let margin = found["margin"].as_f64();
                format.map_or(OwnAnswer::NotSearched, |format| OwnAnswer::Found { format, margin })
            }
            Some("broken_by_plan") => {
                let broken = found["broken"].as_array().into_iter().flatten().filter_map(Value::as_str);
                OwnAnswer::None(format!("f64 has {}, too", broken.collect::<Vec<_>>().join("; ")))
            }
            Some(_) => OwnAnswer::None(up_to()),
            None => OwnAnswer::NotSearched,
        }
    }
}

/// Compares on one part and prints.
fn run_one(input: &Input, arguments: &Arguments) -> Result<Ending> {
    let (folder, out) = (report::folder(arguments.report.as_deref())?, arguments.output.place()?);
    let text = input.text()?;
    let beside = Beside {
        part_checksum: text.checksum(),
        folder,
        out,
        baseline: arguments.baseline.read("compare", &text)?,
        targets: arguments.targets.read()?,
    };
    match arguments.run.problem_of(input, &text)? {
        AnyProblem::Planar(problem) => in_part(&problem, compare(&problem, &beside, arguments)),
        AnyProblem::Spatial(problem) => in_part(&problem, compare(&problem, &beside, arguments)),
    }
}

fn compare<const D: usize>(problem: &Problem<D>, beside: &Beside, arguments: &Arguments) -> Result<Ending>
where
    Space: Dimension<D>,
{
    let Beside { part_checksum, folder, out, baseline, targets } = beside;
    let formats = selected(&arguments.formats)?;
    let (shown, options) = (arguments.shown()?, arguments.run.options_for(problem)?);
    let interruptible = Options { interrupt: Some(interrupt::flag()), ..options.clone() };
    let engines = arguments.engines()?;
    if let Some(baseline) = baseline {
        let feedrate_mm_per_s = problem.feedrate_mm_per_s();
        baseline.expect_machine(&Machine { feedrate_mm_per_s, ..problem.machine.clone() })?;
        let runs = formats
            .iter()
            .flat_map(|format| engines.iter().map(|engine| (format.name().to_string(), *engine)));
        baseline.expect_runs(&runs.collect::<Vec<_>>(), targets)?;
    }
    let progress = Progress::planning();
    let watched = |done: u64, all: u64| {
        interrupt::runs_begin();
        progress.periods(done, all);
    };
    let watch = Watch { traces: folder.is_some(), progress: &watched };
    let runs = || format_compare::compare_with(problem, &formats, &engines, &interruptible, &watch);
    let mut compared = interrupt::unless_interrupted(runs, || {
        output::say("feedbits: interrupted while a plan was made: no run is printed");
    })?;
    progress.finish();
    let end = |finished: Comparison| interrupted(finished, arguments.output.json, beside);
    if !interrupt::is_set() {
        let finished = compared.comparison.clone();
        let wants_fewest_bits = shown.contains(&Engine::Pieces);
        let answers = || add_answers(problem, &mut compared, targets, wants_fewest_bits, &interruptible);
        interrupt::unless_interrupted(answers, || {
            output::status_of(end(finished).map(|_| ()));
        })?;
    }
    if interrupt::is_set() {
        return end(compared.comparison);
    }
    let comparison = &compared.comparison;
    let text = if arguments.output.json {
        baseline::json("compare", *part_checksum, comparison)?
    } else if arguments.wide {
        table(comparison) + &period_costs::tables(comparison, targets, None)
    } else {
        first_screen(comparison, &shown, targets)
    };
    // The report comes first: if it cannot be written, nothing is printed beside the error.
    let page = folder.as_ref().map(|folder| report::write(folder, problem, &compared, targets, &options));
    let page = page.transpose()?;
    output::write(out, &text)?;
    if let Some(page) = page {
        output::note(&format!("report in {}", page.display()));
    }
    let ending = if comparison.recommended.is_some() { Ending::Good } else { Ending::RequirementNotMet };
    baseline.as_ref().map_or(Ok(ending), |baseline| baseline.judge(comparison, ending))
}

/// The answer, the formats that ran by one of `engines`, and what their periods cost on the targets.
pub(crate) fn first_screen(comparison: &Comparison, engines: &[Engine], targets: &[Target]) -> String {
    let first = targets.first().map(|target| target.name.as_str());
    answer::screen(comparison, engines, first) + &period_costs::tables(comparison, targets, Some(engines))
}

/// Adds to the runs why no format is good, what a period costs on the targets, and, if it is asked for, the fewest bits.
fn add_answers<const D: usize>(
    problem: &Problem<D>,
    compared: &mut Compared,
    targets: &[Target],
    wants_fewest_bits: bool,
    options: &Options,
) -> Result<()>
where
    Space: Dimension<D>,
{
    let comparison = &mut compared.comparison;
    if comparison.recommended.is_none() {
        let progress = Progress::spinning("looking for why no format is good");
        comparison.not_a_question_of_format =
            format_compare::not_of_format(problem, &comparison.formats, options);
        progress.finish();
    }
    // Before time on a target counts, which the search does not know. Where each format plans for itself, no plan is common to the rows and
    // the search.
    if let Some(plan) = compared.plan.as_ref().filter(|_| wants_fewest_bits) {
        let progress = Progress::spinning("looking for the fewest bits");
        let found = format_compare::fewest_bits(problem, plan, &compared.comparison.formats, options)?;
        compared.comparison.fewest_bits = Some(found);
        progress.finish();
    }
    if !targets.is_empty() {
        let progress = Progress::of("runs recorded for the targets", compared.comparison.formats.len());
        format_compare::price(compared, problem, targets, options, || progress.step())?;
        progress.finish();
    }
    Ok(())
}

/// Prints the runs that were finished. Answers that were sought meanwhile come from runs that were cut short: they are
/// left out.
fn interrupted(comparison: Comparison, as_json: bool, beside: &Beside) -> Result<Ending> {
    let comparison = Comparison { fewest_bits: None, not_a_question_of_format: None, ..comparison };
    let text = match as_json {
        true => baseline::json("compare", beside.part_checksum, &comparison)?,
        false if comparison.formats.is_empty() => String::new(),
        false => rows(&comparison),
    };
    output::write(&beside.out, &text)?;
    let finished = comparison.formats.len();
    let all = output::counted(finished + comparison.interrupted_runs, "run", "runs");
    output::say(&format!("feedbits: interrupted: {finished} of {all} finished, and nothing behind them"));
    Ok(Ending::Interrupted)
}

/// Heading of the column for runs that pass a corner.
const CORNER_ERROR: &str = "corner error\nmm";

fn table(comparison: &Comparison) -> String {
    format!("{}{}{}\n", rows(comparison), used_up(comparison), answer(comparison))
}

/// The runs on pieces that took all evaluations which a period may take, and how often.
fn used_up(comparison: &Comparison) -> String {
    let most = comparison.machine.max_iterations;
    let of = |row: &JudgedRun| {
        let found = row.evaluations.filter(|found| row.engine == Engine::Pieces && found.max >= most)?;
        Some(format!(
            "{} in {}",
            row.format,
            output::counted(found.periods_at_max.try_into().ok()?, "period", "periods")
        ))
    };
    let runs: Vec<_> = comparison.formats.iter().filter_map(of).collect();
    if runs.is_empty() {
        return String::new();
    }
    format!(
        "All evaluations of a period were used (`max_iterations`, {most}): {}. There a chord is as long as the last left it.\n",
        runs.join(", ")
    )
}

/// The part, and a row for each run.
fn rows(comparison: &Comparison) -> String {
    let part = &comparison.part;
    let machine = &comparison.machine;
    let mut text = format!(
        "{}: {:.3} mm at {}{} mm/s, period {} ms, chord error {} mm, fluctuation {:.0e}",
        in_a_line(&part.name),
        part.length_mm,
        part.lowest_feedrate_mm_per_s.map_or_else(String::new, |lowest| format!("{lowest} to ")),
        machine.feedrate_mm_per_s,
        machine.interpolation_period_ms,
        machine.chord_error_mm,
        machine.fluctuation_limit,
    );
    if let Some(time) = part.planned_time_s {
        text += &format!("; planned in {time:.3} s");
    }
    if let Some(lowered) = part.lowered_for_chords {
        text += &format!(
            ". Fluctuation is against the plan as lowered for chords, by {lowered:.1e} of the feed at most"
        );
    }
    let passes_corners = comparison.formats.iter().any(|row| row.corner_error_mm_max > Some(0.0));
    let mut table = Table::new();
    table.load_preset(presets::UTF8_FULL_CONDENSED).set_content_arrangement(ContentArrangement::Dynamic);
    let mut header = vec![
        "format",
        "bits",
        "path",
        "fluctuation\nmax",
        "\nmin",
        "\nmean",
        "\nat cruise\n(commanded)",
        "length\nerror mm",
        "evaluations\nmean / max",
        "over-\nflows",
        "chord error\nmm",
        CORNER_ERROR,
        "position error\n(resolution) mm",
        "end error\nmm",
        "verdict",
    ];
    if !passes_corners {
        header.retain(|heading| *heading != CORNER_ERROR);
    }
    let figures = header.len() - 4;
    table.set_header(header);
    for row in &comparison.formats {
        table.add_row(cells(row, passes_corners));
    }
    for column in table.column_iter_mut().skip(3).take(figures) {
        column.set_cell_alignment(CellAlignment::Right);
    }
    format!("{text}\n{table}\n")
}

/// The recommendation, and the measure by which the format is the cheapest.
fn answer(comparison: &Comparison) -> String {
    let Some((format, engine)) = comparison.recommended.as_ref().zip(comparison.recommended_engine) else {
        let why = comparison.not_a_question_of_format.as_ref();
        let why = why.map_or_else(String::new, |why| format!(" {why}"));
        return format!("No format meets the requirements.{why}");
    };
    let by = if comparison.formats.iter().any(|row| !row.cycles.is_empty()) {
        "by what a period costs on the first target"
    } else {
        "by its bits; --targets goes by what a period costs"
    };
    format!("Cheapest format that is good enough: {format} ({engine}), {by}")
}

fn cells(row: &JudgedRun, passes_corners: bool) -> Vec<String> {
    let figure = |value: Option<f64>| value.map_or_else(String::new, |x| format!("{x:.1e}"));
    let fluctuation = |of: fn(&format_compare::Fluctuation) -> f64| figure(row.fluctuation.as_ref().map(of));
    let mut cells = vec![
        row.format.clone(),
        row.bits.to_string(),
        row.engine.to_string(),
        fluctuation(|f| f.max),
        fluctuation(|f| f.min),
        fluctuation(|f| f.mean_abs),
        match row.fluctuation {
            Some(found) => format!("{:.1e} ({:.1e})", found.cruise_max_abs, found.commanded_cruise_max_abs),
            None => String::new(),
        },
        fluctuation(|f| f.length_error_mm_max),
        row.evaluations.map_or_else(String::new, |e| format!("{:.2} / {}", e.mean, e.max)),
        row.saturations.map_or_else(String::new, |s| s.to_string()),
        figure(row.chord_error_mm_max),
        match (row.position_error_mm_max, row.position_resolution_mm) {
            (Some(error), Some(resolution)) => format!("{error:.1e} ({resolution:.0e})"),
            _ => String::new(),
        },
        figure(row.end_error_mm),
        row.verdict.to_string(),
    ];
    if passes_corners {
        cells.insert(11, figure(row.corner_error_mm_max));
    }
    cells
}
