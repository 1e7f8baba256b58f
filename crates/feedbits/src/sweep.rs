//! `feedbits sweep`: for which periods, feeds and part sizes does a format stay good?

use std::collections::{BTreeMap, HashSet};
use std::path::PathBuf;
use std::str::FromStr;
use std::sync::{Mutex, PoisonError};

use anyhow::{Result, bail};
use clap::Args;
use clap_complete::ArgValueCandidates;
use domains::Key;
use domains::options::{MOST_PERIODS, SWEEP_FEED, SWEEP_PERIOD, SWEEP_POINTS, SWEEP_SCALE};
use foreign_text::in_lines;
use format_compare::{
    Cost, Dimension, Engine, Format, JudgedRun, LeastPeriods, Options, PeriodCost, Problem, Space, Verdict,
    Watch,
};
use format_report::{Report, Sweep, SweepCell, SweepCost, SweepResult};
use part_program::{Curve, Machine, Move, Nurbs, Part};
use target_cost::Target;

use crate::bounds::{expect_an_end, expect_few_pieces};
use crate::ending::Ending;
use crate::fingerprint::fingerprint_of;
use crate::formats::selected;
use crate::input::Input;
use crate::numbers::{refusal, whole};
use crate::places::{Folder, Place};
use crate::progress::Progress;
use crate::resumed_file::ResumedFile;
use crate::run_arguments::RunArguments;
use crate::shard::Shard;
use crate::targets::TargetArguments;
use crate::{candidates, output, report, sweep_file};

/// Options of `sweep`.
#[derive(Args)]
pub(crate) struct Arguments {
    #[command(flatten)]
    input: Input,
    #[command(flatten)]
    run: RunArguments,
    /// Interpolation periods, in ms: `lo..hi` in equal ratios, `lo..hi/N` with N points, or one value. Default: the
    /// machine's.
    #[arg(long, allow_hyphen_values = true, value_name = "LO..HI", value_parser = span(&SWEEP_PERIOD))]
    period: Option<Span>,
    /// Commanded feeds, in mm/s, in the same form. Default: the part's or the machine's.
    #[arg(long, allow_hyphen_values = true, value_name = "LO..HI", value_parser = span(&SWEEP_FEED))]
    feed: Option<Span>,
    /// Sizes of the part, in mm, in the same form: it is scaled until its largest extent is that. Default: as it is.
    #[arg(long, allow_hyphen_values = true, value_name = "LO..HI", value_parser = span(&SWEEP_SCALE))]
    scale: Option<Span>,
    /// Points of each span that does not say.
    #[arg(
        long,
        value_name = "N",
        default_value_t = 5,
        value_parser = whole::<u16>(&SWEEP_POINTS)
    )]
    points: u16,
    /// The formats to run, comma-separated. Default: all; see `feedbits formats`. Names in Q notation are
    /// read by the register that they fill: Q8.24 (Arm) and Q7.24 (TI) are I8F24.
    #[arg(long, visible_alias = "format", value_delimiter = ',', value_parser = crate::formats::name, value_name = "F,F", add = ArgValueCandidates::new(candidates::formats))]
    formats: Vec<String>,
    #[command(flatten)]
    targets: TargetArguments,
    /// The most periods of a run; a cell that needs more is left out, and says so.
    #[arg(long, value_name = "N", default_value_t = 100_000, value_parser = whole::<u32>(&MOST_PERIODS))]
    most_periods: u32,
    /// Run only the cells of shard i of n, as in 1/4; the first is 1. `feedbits merge` joins the files.
    #[arg(long, value_name = "I/N", default_value = "1/1")]
    shard: Shard,
    /// The file of results, a line of JSON a cell. Cells that it has are not run again. Default: sweep.jsonl, or that of the
    /// shard, as in sweep-2-of-8.jsonl.
    #[arg(long, value_name = "PATH")]
    out: Option<PathBuf>,
    /// Write a report into this folder, with a heat map for each format.
    #[arg(long, value_name = "DIR")]
    report: Option<PathBuf>,
}

/// A range of values in equal ratios.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Span {
    low: f64,
    high: f64,
    points: Option<usize>,
}

impl FromStr for Span {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        let expected =
            || format!("{text:?}: expected a positive number, LO..HI or LO..HI/N, as in 0.25..4/8");
        let number = |text: &str| {
            text.trim().parse::<f64>().ok().filter(|x| *x > 0.0 && x.is_finite()).ok_or_else(expected)
        };
        let (range, points) = match text.split_once('/') {
            Some((range, points)) => {
                let points = points.trim().parse::<u16>().ok().filter(|n| SWEEP_POINTS.holds(f64::from(*n)));
                (range, Some(points.ok_or_else(expected)?.into()))
            }
            None => (text, None),
        };
        let Some((low, high)) = range.split_once("..") else {
            let value = number(range)?;
            return Ok(Self { low: value, high: value, points: Some(1) });
        };
        let (low, high) = (number(low)?, number(high)?);
        if low > high { Err(expected()) } else { Ok(Self { low, high, points }) }
    }
}

impl Span {
    /// The values, both ends included.
    fn values(self, points: usize) -> Vec<f64> {
        let points = if self.low < self.high { self.points.unwrap_or(points) } else { 1 };
        let last = points - 1;
        let value = |place: usize| match place {
            0 => self.low,
            _ if place == last => self.high,
            _ => rounded(self.low * (self.high / self.low).powf(place as f64 / last as f64)),
        };
        (0..points).map(value).collect()
    }
}

/// Rounds to six digits, since people read the values of a grid.
fn rounded(value: f64) -> f64 {
    format!("{value:.5e}").parse().unwrap_or(value)
}

/// A parser of a span whose ends are within the domain of an option.
fn span(key: &'static Key) -> impl Fn(&str) -> Result<Span, String> + Clone + Send + Sync + 'static {
    move |text| {
        let span: Span = text.parse()?;
        match [span.low, span.high].into_iter().find(|end| !key.holds(*end)) {
            Some(end) => Err(refusal(key, end)),
            None => Ok(span),
        }
    }
}

/// The part and the machine from which every cell is made.
struct Base {
    part: Part,
    machine: Machine,
    /// Largest extent, in mm.
    extent_mm: f64,
    /// What each run is priced on.
    targets: Vec<Target>,
}

/// Sweeps, or continues where an earlier run ended.
pub(crate) fn run(arguments: &Arguments) -> Result<Ending> {
    let places = Places {
        folder: report::folder(arguments.report.as_deref())?,
        file: Place::named(
            "--out",
            Some(&arguments.out.clone().unwrap_or_else(|| arguments.shard.file("sweep"))),
        )?,
        terminal: Place::terminal()?,
    };
    let (part, machine) = arguments.run.part_and_machine(&arguments.input, &arguments.input.text()?)?;
    if part.curves.iter().all(|curve| curve.dimension() == 2) {
        sweep::<2>(part, machine, &places, arguments)
    } else {
        sweep::<3>(part, machine, &places, arguments)
    }
}

/// Where the results of a sweep go.
pub(crate) struct Places {
    /// The folder of the report, if there is to be one.
    pub(crate) folder: Option<Folder>,
    /// The file of all cells.
    pub(crate) file: Place,
    pub(crate) terminal: Place,
}

fn sweep<const D: usize>(
    part: Part,
    machine: Machine,
    places: &Places,
    arguments: &Arguments,
) -> Result<Ending>
where
    Space: Dimension<D>,
{
    let formats = selected::<D>(&arguments.formats)?;
    let (engines, options) = (arguments.run.engines()?, arguments.run.options()?);
    let base = Base::new::<D>(part, machine, arguments.targets.read()?)?;
    let plan = base.sweep(arguments, &formats, &engines, &options)?;
    let (file, done) = ResumedFile::resume(&places.file, &plan)?;
    let known: HashSet<usize> = done.iter().map(|cell| cell.cell).collect();
    let left: Vec<usize> =
        (0..plan.len()).filter(|cell| arguments.shard.has(*cell) && !known.contains(cell)).collect();
    let progress = Progress::of("cells", left.len() + done.len());
    progress.start_at(done.len());
    let file = Mutex::new(file);
    let cells = feed_plan::in_parallel(&left, |number| -> Result<SweepCell> {
        let file = || file.lock().unwrap_or_else(PoisonError::into_inner);
        // Once the disk is full no cell is run in vain.
        file().expect_room()?;
        let cell = base.cell(&plan, *number, arguments.most_periods, (&formats, &engines, &options))?;
        file().add(&cell)?;
        progress.step();
        Ok(cell)
    });
    progress.finish();
    let mut cells: Vec<SweepCell> =
        cells.into_iter().chain(done.into_iter().map(Ok)).collect::<Result<_>>()?;
    cells.sort_by_key(|cell| cell.cell);
    let report = report_of(&plan, &cells, places)?;
    conclude(&plan, &cells, places, report.as_ref())
}

/// The report of a sweep, if there is to be one. Its cells say which pictures it has, and a report is refused whose files have
/// another role in this call.
pub(crate) fn report_of(plan: &Sweep, cells: &[SweepCell], places: &Places) -> Result<Option<Report>> {
    let Some(folder) = &places.folder else { return Ok(None) };
    let report = plan.report(cells, &report::command())?;
    report.files.iter().try_for_each(|(name, _)| folder.place(name).map(|_| ()))?;
    Ok(Some(report))
}

/// Prints the results. Before, writes the report if there is to be one: if it cannot be written, nothing is printed beside
/// the error.
pub(crate) fn conclude(
    plan: &Sweep,
    cells: &[SweepCell],
    places: &Places,
    report: Option<&Report>,
) -> Result<Ending> {
    let Places { folder, file, terminal } = places;
    let page =
        folder.as_ref().zip(report).map(|(folder, report)| report::into(folder, report)).transpose()?;
    let file = file.path().map_or_else(String::new, |file| file.display().to_string());
    let mut text = format!("{} of {} cells in {file}\n", cells.len(), plan.len());
    for (run, name) in plan.runs.iter().enumerate() {
        let (good, all) = plan.good(cells, run);
        text += &format!("{name}: good in {good} of {all}\n");
    }
    for (target, cheapest) in cheapest(cells) {
        let counts: Vec<String> = cheapest.iter().map(|(run, cells)| format!("{run} in {cells}")).collect();
        text += &format!("cheapest on {target}: {}\n", counts.join(", "));
    }
    let skipped = cells.iter().filter(|cell| cell.skipped.is_some()).count();
    if skipped > 0 {
        text += &format!("{skipped} cells were not run; the file says why\n");
    }
    // The names in it come from files.
    output::write(terminal, &in_lines(&text))?;
    if let Some(page) = page {
        output::note(&format!("report in {}", page.display()));
    }
    // A shard lacks cells that other shards may have.
    let is_whole = cells.len() == plan.len();
    let is_bad = (0..plan.runs.len()).all(|run| plan.good(cells, run).0 == 0);
    Ok(if is_whole && is_bad { Ending::RequirementNotMet } else { Ending::Good })
}

/// For each target the runs that are the cheapest good ones, with the number of cells in which each of them is.
fn cheapest(cells: &[SweepCell]) -> BTreeMap<&str, BTreeMap<&str, usize>> {
    let mut counts: BTreeMap<&str, BTreeMap<&str, usize>> = BTreeMap::new();
    for (target, run) in cells.iter().flat_map(|cell| &cell.cheapest) {
        *counts.entry(target).or_default().entry(run).or_default() += 1;
    }
    counts
}

impl Base {
    fn new<const D: usize>(part: Part, machine: Machine, targets: Vec<Target>) -> Result<Self> {
        let problem = Problem::<D>::new(&part, &machine)?;
        // The curves of the problem. Its rapid moves are left out.
        let curves: Vec<_> = problem.curves.iter().map(|curve| Curve::from(Nurbs::of(curve, 3))).collect();
        let bounds = part_program::bounding_box_mm(&curves);
        let extent_mm =
            bounds.map_or(0.0, |(least, most)| (0..D).map(|d| most[d] - least[d]).fold(0.0, f64::max));
        if extent_mm <= 0.0 || !extent_mm.is_finite() {
            bail!("{}: the part has no extent", part.name);
        }
        Ok(Self { part, machine, extent_mm, targets })
    }

    fn sweep<const D: usize>(
        &self,
        arguments: &Arguments,
        formats: &[Box<dyn Format<D>>],
        engines: &[Engine],
        options: &Options,
    ) -> Result<Sweep> {
        let values = |span: Option<Span>, own: f64| {
            span.map_or_else(|| vec![own], |span| span.values(arguments.points.into()))
        };
        let own_feed = self.part.feedrate_mm_per_s.unwrap_or(self.machine.feedrate_mm_per_s);
        let runs = formats.iter().flat_map(|format| engines.iter().map(move |engine| (format, engine)));
        // The line and the words of a move change no cell.
        let of_move = |one: &Move| (one.kind, one.feedrate_mm_per_s, one.exact_stop);
        let moves: Vec<_> = self.part.moves.iter().map(of_move).collect();
        let plan = Sweep {
            part: self.part.name.clone(),
            fingerprint: fingerprint_of(&format!(
                "{:?}{moves:?}{}{options:?}{}{}{}",
                self.part.curves,
                serde_json::to_string(&self.machine)?,
                arguments.most_periods,
                env!("CARGO_PKG_VERSION"),
                // Without targets the text is as it always was.
                if self.targets.is_empty() { String::new() } else { format!("{:?}", self.targets) },
            )),
            fluctuation_limit: self.machine.fluctuation_limit,
            periods_ms: values(arguments.period, self.machine.interpolation_period_ms),
            feeds_mm_per_s: values(arguments.feed, own_feed),
            sizes_mm: values(arguments.scale, self.extent_mm),
            runs: runs.map(|(format, engine)| format!("{} {engine}", format.name())).collect(),
        };
        if plan.len() > sweep_file::MOST_CELLS {
            bail!("{} cells: expected at most {}", plan.len(), sweep_file::MOST_CELLS);
        }
        Ok(plan)
    }

    fn cell<const D: usize>(
        &self,
        plan: &Sweep,
        number: usize,
        most_periods: u32,
        (formats, engines, options): (&[Box<dyn Format<D>>], &[Engine], &Options),
    ) -> Result<SweepCell>
    where
        Space: Dimension<D>,
    {
        let Some((period_ms, feed_mm_per_s, size_mm)) = plan.place(number) else {
            bail!("cell {number} of {}: there is none", plan.len());
        };
        let mut cell = SweepCell { cell: number, period_ms, feed_mm_per_s, size_mm, ..SweepCell::default() };
        let scale = size_mm / self.extent_mm;
        let problem = self.scaled::<D>(scale, period_ms, feed_mm_per_s)?;
        let periods = LeastPeriods::of(&problem, options.end_feeds_mm_per_s).periods;
        if periods > f64::from(most_periods) {
            cell.skipped = Some(format!("takes {periods:.0} periods, more than {most_periods}"));
            return Ok(cell);
        }
        if let Err(too_many) =
            expect_few_pieces(&problem, options).and_then(|()| expect_an_end(&problem, options))
        {
            cell.skipped = Some(too_many.to_string());
            return Ok(cell);
        }
        match format_compare::compare_with(&problem, formats, engines, options, &Watch::default()) {
            Ok(mut compared) => {
                if !self.targets.is_empty() {
                    format_compare::price(&mut compared, &problem, &self.targets, options, || ())?;
                }
                let comparison = compared.comparison;
                cell.results = comparison.formats.iter().map(result).collect();
                let named = |(target, (format, engine))| (target, format!("{format} {engine}"));
                cell.cheapest = comparison.recommended_on.into_iter().map(named).collect();
            }
            Err(refusal) => cell.skipped = Some(refusal.to_string()),
        }
        Ok(cell)
    }

    fn scaled<const D: usize>(&self, scale: f64, period_ms: f64, feed_mm_per_s: f64) -> Result<Problem<D>> {
        let mut part = self.part.clone();
        for point in part.curves.iter_mut().flat_map(Curve::control_points_mm_mut) {
            *point = point.map(|x| x * scale);
        }
        let mut machine = self.machine.clone();
        machine.interpolation_period_ms = period_ms;
        Ok(Problem::new(&part, &machine)?.at_feedrate(feed_mm_per_s))
    }
}

fn result(row: &JudgedRun) -> SweepResult {
    SweepResult {
        good: row.verdict.is_good(),
        fluctuation: row.fluctuation.map(|fluctuation| fluctuation.cruise_max_abs),
        reason: match &row.verdict {
            Verdict::Good => String::new(),
            Verdict::Bad(reasons) => reasons.join("; "),
            Verdict::Refused(reason) => format!("refused: {reason}"),
        },
        cycles: row.cycles.iter().filter_map(|(target, cost)| Some((target.clone(), known(cost)?))).collect(),
    }
}

/// The cost of a period, if every operation has a price.
fn known(cost: &Cost) -> Option<SweepCost> {
    let Cost::Known(cost) = cost else { return None };
    let PeriodCost { max, microseconds_max, share_of_period, dsp_blocks, .. } = *cost;
    Some(SweepCost { max, microseconds_max, share_of_period, dsp_blocks })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_span_has_equal_ratios_and_its_ends() {
        let span: Span = "0.25..4/5".parse().expect("a span");
        assert_eq!(span.values(8), [0.25, 0.5, 1.0, 2.0, 4.0]);
        assert_eq!("10..1000".parse::<Span>().expect("a span").values(3), [10.0, 100.0, 1000.0]);
        assert_eq!("3".parse::<Span>().expect("a span").values(9), [3.0]);
        assert_eq!("1..7/1".parse::<Span>().expect("a span").values(9), [1.0]);
        for wrong in ["", "..", "4..1", "0..1", "-1", "1..2/0", "1..2/x", "nan", "1..inf"] {
            assert!(wrong.parse::<Span>().is_err(), "{wrong}");
        }
    }

    /// The spans have the bounds of the machine file's own reader.
    #[test]
    fn spans_end_where_a_machine_file_does() {
        assert_eq!(SWEEP_PERIOD.value, domains::machine::PERIOD.value);
        assert_eq!(SWEEP_FEED.value, domains::machine::FEEDRATE.value);
        let parsed = span(&SWEEP_PERIOD);
        assert!(parsed("1..1000").is_ok());
        assert_eq!(parsed("1..1001"), Err("1001: expected a number of 0.001 to 1000 ms".into()));
        assert!(parsed("1e-4..1").is_err());
    }
}
