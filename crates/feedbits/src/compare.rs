//! `feedbits compare`: formats side by side.

use std::path::PathBuf;

use anyhow::{Result, bail};
use clap::{Args, ValueEnum};
use comfy_table::{CellAlignment, ContentArrangement, Table, presets};
use format_compare::{
    Comparison, Dimension, Engine, JudgedStep, LeastPeriods, MOST_PERIODS, Options, PlanIn, Problem,
    ProfileKind, Row, Run, Space, Trace,
};
use target_cost::Target;

use crate::input::{AnyProblem, Input};
use crate::progress::Progress;
use crate::targets::{self, TargetArguments};
use crate::{Ending, output, report};

/// Options of `compare`.
#[derive(Args)]
pub(crate) struct Arguments {
    #[command(flatten)]
    input: Input,
    #[command(flatten)]
    run: RunArguments,
    /// The formats to compare, comma-separated. Default: all; see `feedbits formats`.
    #[arg(long, visible_alias = "format", value_delimiter = ',', value_name = "F,F")]
    formats: Vec<String>,
    #[command(flatten)]
    targets: TargetArguments,
    /// Write a report into this folder: index.html, each picture as SVG, each table as CSV and JSON.
    #[arg(long, value_name = "DIR")]
    report: Option<PathBuf>,
    #[command(flatten)]
    output: output::Output,
}

/// How a part is run: options that several subcommands share.
#[derive(Args)]
pub(crate) struct RunArguments {
    /// Form of the path in real time. Default: pieces; `compare`, `servo` and `sweep` run both, side by side.
    #[arg(long, value_enum)]
    evaluate: Option<EvaluateName>,
    /// Solver of the next parameter. Newton goes with pieces, the others with de-boor.
    #[arg(long, value_enum)]
    solver: Option<SolverName>,
    /// Longest compiled piece, in mm.
    #[arg(long, allow_negative_numbers = true, value_name = "MM", default_value_t = 32.0)]
    piece_length: f64,
    /// The format to plan in: a format's name, or `same` for each its own.
    #[arg(long, value_name = "F", default_value = "f64")]
    plan_in: String,
    /// The transitions that the plan is made of.
    #[arg(long, value_enum, default_value_t = ProfileName::Cubic)]
    profile: ProfileName,
    /// Feed at the start of the path, in mm/s.
    #[arg(long, allow_negative_numbers = true, value_name = "MM_PER_S", default_value_t = 0.0)]
    start_feed: f64,
    /// Feed at the end of the path, in mm/s.
    #[arg(long, allow_negative_numbers = true, value_name = "MM_PER_S", default_value_t = 0.0)]
    end_feed: f64,
    /// Fluctuation that the solver stops at, in place of the machine file's.
    #[arg(long, allow_negative_numbers = true, value_name = "RATIO")]
    fluctuation: Option<f64>,
}

/// Forms of the path, by their names on the command line.
#[derive(Clone, Copy, PartialEq, Eq, ValueEnum)]
enum EvaluateName {
    /// One global parameter, de Boor's scheme each time.
    DeBoor,
    /// Compiled pieces.
    Pieces,
}

/// Solvers, by their names on the command line.
#[derive(Clone, Copy, PartialEq, Eq, ValueEnum)]
enum SolverName {
    /// Secant iteration on the chord.
    Secant,
    /// First-order Taylor expansion.
    #[value(name = "taylor-1")]
    Taylor1,
    /// Second-order Taylor expansion.
    #[value(name = "taylor-2")]
    Taylor2,
    /// Newton's correction of the step per chord.
    Newton,
}

/// Kinds of transitions, by their names on the command line.
#[derive(Clone, Copy, PartialEq, Eq, ValueEnum)]
enum ProfileName {
    /// Cubic polynomials of time.
    Cubic,
    /// Pieces of constant jerk.
    SCurve,
    /// Half-cosines.
    Trigonometric,
    /// S-curves, and half-cosines over stretches whose limit changes again before a transition has ended.
    Flexible,
    /// All of them side by side; for `plan` only.
    All,
}

impl RunArguments {
    /// The kinds of transitions that the options name.
    pub(crate) fn profiles(&self) -> &'static [ProfileKind] {
        use ProfileKind::{Cubic, Flexible, SCurve, Trigonometric};
        match self.profile {
            ProfileName::Cubic => &[Cubic],
            ProfileName::SCurve => &[SCurve],
            ProfileName::Trigonometric => &[Trigonometric],
            ProfileName::Flexible => &[Flexible],
            ProfileName::All => &ProfileKind::ALL,
        }
    }

    /// The engines that the options name; both forms of the path if they name none.
    pub(crate) fn engines(&self) -> Result<Vec<Engine>> {
        use EvaluateName::{DeBoor, Pieces};
        use SolverName::{Newton, Secant, Taylor1, Taylor2};
        Ok(match (self.evaluate, self.solver) {
            (None, None) => vec![Engine::DeBoorSecant, Engine::Pieces],
            (Some(DeBoor), None) | (Some(DeBoor) | None, Some(Secant)) => vec![Engine::DeBoorSecant],
            (Some(DeBoor) | None, Some(Taylor1)) => vec![Engine::DeBoorTaylor1],
            (Some(DeBoor) | None, Some(Taylor2)) => vec![Engine::DeBoorTaylor2],
            (Some(Pieces), None) | (Some(Pieces) | None, Some(Newton)) => vec![Engine::Pieces],
            (Some(DeBoor), Some(Newton)) => bail!("--solver newton runs on pieces: give --evaluate pieces"),
            (Some(Pieces), Some(_)) => {
                bail!("on pieces the solver is newton; the others go with --evaluate de-boor")
            }
        })
    }

    /// The options of a run, with the last of the engines.
    pub(crate) fn options(&self) -> Result<Options> {
        let [profile] = *self.profiles() else {
            bail!("--profile all goes with `plan`: expected one kind of transitions here");
        };
        self.options_with(profile)
    }

    /// The same for a problem, which is refused if it would run for hours.
    pub(crate) fn options_for<const D: usize>(&self, problem: &Problem<D>) -> Result<Options> {
        let options = self.options()?;
        expect_an_end(problem, &options)?;
        Ok(options)
    }

    /// The same with a kind of transitions in place of the one that the options name.
    pub(crate) fn options_with(&self, profile: ProfileKind) -> Result<Options> {
        let plan_in = match self.plan_in.as_str() {
            "" | "f64" => PlanIn::default(),
            "same" => PlanIn::Same,
            name => match by_name::<3>(name) {
                Some(format) => PlanIn::Format(format.name()),
                None => bail!(
                    "--plan-in {name}: no such format; `feedbits formats` lists them, `same` is each its own"
                ),
            },
        };
        for (option, value) in [("--start-feed", self.start_feed), ("--end-feed", self.end_feed)] {
            if !(value.is_finite() && value >= 0.0) {
                bail!("{option} {value}: expected a feed of at least 0 mm/s");
            }
        }
        if !(self.piece_length > 0.0 && self.piece_length.is_finite()) {
            bail!("--piece-length {}: expected a positive length in mm", self.piece_length);
        }
        if let Some(value) = self.fluctuation.filter(|f| !(*f > 0.0 && *f < 1.0)) {
            bail!("--fluctuation {value}: expected a ratio between 0 and 1");
        }
        Ok(Options {
            engine: self.engines()?.pop().unwrap_or(Engine::Pieces),
            piece_length_mm: self.piece_length,
            plan_in,
            profile,
            end_feeds_mm_per_s: [self.start_feed, self.end_feed],
            fluctuation: self.fluctuation,
            overrides: None,
        })
    }
}

/// Refuses what takes more periods than are run, before any is planned.
pub(crate) fn expect_an_end<const D: usize>(problem: &Problem<D>, options: &Options) -> Result<()> {
    let least = LeastPeriods::of(problem, options.end_feeds_mm_per_s);
    if least.are_too_many() {
        bail!("{}: {least}: expected at most {MOST_PERIODS}", problem.name);
    }
    Ok(())
}

/// Compares and prints; writes the report if one is asked for.
pub(crate) fn run(arguments: &Arguments) -> Result<Ending> {
    let targets = arguments.targets.read()?;
    match arguments.input.read()? {
        AnyProblem::Planar(problem) => compare(&problem, &targets, arguments),
        AnyProblem::Spatial(problem) => compare(&problem, &targets, arguments),
    }
}

fn compare<const D: usize>(problem: &Problem<D>, targets: &[Target], arguments: &Arguments) -> Result<Ending>
where
    Space: Dimension<D>,
{
    let formats = selected(&arguments.formats)?;
    let (engines, options) = (arguments.run.engines()?, arguments.run.options_for(problem)?);
    let progress = Progress::of("runs", formats.len() * engines.len());
    let wanted = arguments.report.is_some();
    let keep = |_: &Row, run: Option<(&Run, &[JudgedStep])>| {
        let trace = run.filter(|_| wanted).map(|(run, steps)| Trace::of(problem, run, steps));
        progress.step();
        trace
    };
    let (mut comparison, traces) = format_compare::compare_with(problem, &formats, &engines, &options, keep)?;
    progress.finish();
    if !targets.is_empty() {
        let progress = Progress::of("runs recorded for the targets", comparison.formats.len());
        format_compare::price_with(&mut comparison, problem, targets, &options, || progress.step())?;
        progress.finish();
    }
    let text = if arguments.output.json {
        serde_json::to_string_pretty(&comparison)? + "\n"
    } else {
        table(&comparison) + &targets::costs(&comparison, targets)
    };
    output::write(arguments.output.out.as_deref(), &text)?;
    if let Some(folder) = &arguments.report {
        let page = report::write(folder, problem, &comparison, (&traces, targets), &options)?;
        output::note(&format!("report in {}", page.display()));
    }
    Ok(if comparison.recommended.is_some() { Ending::Good } else { Ending::RequirementNotMet })
}

/// The formats of these names, or all if none is given.
pub(crate) fn selected<const D: usize>(names: &[String]) -> Result<Vec<Box<dyn format_compare::Format<D>>>>
where
    Space: Dimension<D>,
{
    if names.is_empty() {
        return Ok(format_compare::formats());
    }
    format_compare::select(names)
        .map_err(|name| anyhow::anyhow!("unknown format {name:?}: expected one that `feedbits formats` lists, or a fixed-point format such as I5F13: 3 to 64 bits in all, at least 2 of them before the point"))
}

/// The format of this name.
pub(crate) fn by_name<const D: usize>(name: &str) -> Option<Box<dyn format_compare::Format<D>>>
where
    Space: Dimension<D>,
{
    format_compare::select(&[name.to_string()]).ok().and_then(|mut found| found.pop())
}

fn table(comparison: &Comparison) -> String {
    let part = &comparison.part;
    let machine = &comparison.machine;
    let mut text = format!(
        "{}: {:.3} mm at {}{} mm/s, period {} ms, chord error {} mm, fluctuation {:.0e}",
        part.name,
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
    let mut table = Table::new();
    table.load_preset(presets::UTF8_FULL_CONDENSED).set_content_arrangement(ContentArrangement::Dynamic);
    table.set_header([
        "format",
        "bits",
        "path",
        "fluctuation\nmax",
        "\nmin",
        "\nmean",
        "\nat cruise",
        "length\nerror mm",
        "evaluations\nmean / max",
        "over-\nflows",
        "chord error\nmm",
        "position error\n(resolution) mm",
        "end error\nmm",
        "verdict",
    ]);
    for row in &comparison.formats {
        table.add_row(cells(row));
    }
    for column in table.column_iter_mut().skip(3).take(10) {
        column.set_cell_alignment(CellAlignment::Right);
    }
    let answer = match &comparison.recommended {
        Some(format) => format!("Cheapest format that is good enough: {format}"),
        None => "No format meets the requirements.".to_string(),
    };
    format!("{text}\n{table}\n{answer}\n")
}

fn cells(row: &Row) -> Vec<String> {
    let figure = |value: Option<f64>| value.map_or_else(String::new, |x| format!("{x:.1e}"));
    let fluctuation = |of: fn(&format_compare::Fluctuation) -> f64| figure(row.fluctuation.as_ref().map(of));
    vec![
        row.format.clone(),
        row.bits.to_string(),
        row.engine.to_string(),
        fluctuation(|f| f.max),
        fluctuation(|f| f.min),
        fluctuation(|f| f.mean_abs),
        fluctuation(|f| f.cruise_max_abs),
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
    ]
}
