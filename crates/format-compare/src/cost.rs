//! What a period costs on a target, and what that says about the formats.

use std::collections::BTreeMap;

use real::FormatName;
use serde::Serialize;
use target_cost::{Cycles, Kind, Measure, NoPrice, StepCost, Target};

use crate::compare::{Comparison, Row, Verdict, in_parallel};
use crate::formats::{Dimension, Space, plan_for, select};
use crate::problem::Problem;
use crate::recorded::RecordedRun;
use crate::requirement::Requirement;
use crate::run::{Options, Refusal};

/// The cost of a run on one target.
#[derive(Clone, Debug, PartialEq, Serialize)]
#[serde(untagged)]
pub enum Cost {
    /// Every operation has a price.
    Known(PeriodCost),
    /// One has none: nobody has published it.
    Unknown {
        /// The operation.
        unknown: &'static str,
    },
}

/// The cost of a period.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct PeriodCost {
    /// Mean over the run.
    pub mean: f64,
    /// The dearest period of the run.
    pub max: f64,
    /// Low and high of the mean.
    pub mean_range: [f64; 2],
    /// Low and high of the dearest period.
    pub max_range: [f64; 2],
    /// What is counted.
    pub measure: Measure,
    /// Where the figure is from.
    pub level: Level,
    /// The dearest period, in microseconds, if the clock is known.
    pub microseconds_max: Option<f64>,
    /// The same as a share of the interpolation period.
    pub share_of_period: Option<f64>,
    /// The kind of operation that takes most of the work.
    pub dominating: &'static str,
    /// Its share of the work.
    pub dominating_share: f64,
    /// DSP blocks, on an FPGA.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub dsp_blocks: Option<u32>,
    /// The distance at which steps of other axes may begin, on an FPGA.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub initiation_interval_max: Option<f64>,
}

/// Where a figure is from.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Level {
    /// The recorded step on a model of the target, from manuals.
    Scheduled,
    /// The recorded step, with costs of operations counted in an emulator of the instruction set.
    ScheduledOnCountedCosts,
}

impl PeriodCost {
    /// Whether the dearest period fits the interpolation period; unknown without a clock.
    #[must_use]
    pub fn fits(&self) -> Option<bool> {
        self.share_of_period.map(|share| share <= 1.0)
    }
}

/// Records every row of `comparison` that was not refused, prices it on each of `targets`, and recommends anew: on the
/// first target, the cheapest of the formats that are good and fit the period. A format that fits the period on none of
/// the targets is no longer good.
///
/// # Errors
/// [`Refusal`] if no plan can be made: that of the comparison.
pub fn price<const D: usize>(
    comparison: &mut Comparison,
    problem: &Problem<D>,
    targets: &[Target],
    options: &Options,
) -> Result<(), Refusal>
where
    Space: Dimension<D>,
{
    price_with(comparison, problem, targets, options, || ())
}

/// The same, calling `recorded` as each row has been recorded, which is what takes the time.
///
/// # Errors
/// As [`price`].
pub fn price_with<const D: usize>(
    comparison: &mut Comparison,
    problem: &Problem<D>,
    targets: &[Target],
    options: &Options,
    recorded: impl Fn() + Sync,
) -> Result<(), Refusal>
where
    Space: Dimension<D>,
{
    let recorded = in_parallel(&comparison.formats, |row| {
        let run = record(row, problem, options);
        recorded();
        run
    });
    for (row, recorded) in comparison.formats.iter_mut().zip(recorded) {
        let Some((name, run)) = recorded? else { continue };
        row.operations = Some(operations(&run));
        for target in targets {
            row.cycles.insert(target.name.clone(), cost(&run, target, name, problem.period_s()));
        }
        demand_that_it_fits(row, targets);
    }
    recommend(comparison, targets);
    Ok(())
}

/// The row's run, recorded; none if it was refused.
fn record<const D: usize>(
    row: &Row,
    problem: &Problem<D>,
    options: &Options,
) -> Result<Option<(FormatName, RecordedRun)>, Refusal>
where
    Space: Dimension<D>,
{
    let format = select::<D>(std::slice::from_ref(&row.format)).ok().and_then(|mut found| found.pop());
    let Some(format) = format.filter(|_| !matches!(row.verdict, Verdict::Refused(_))) else {
        return Ok(None);
    };
    let options = Options { engine: row.engine, ..options.clone() };
    let plan = plan_for(problem, format.as_ref(), &options)?;
    Ok(Some((format.name(), Space::record(format.name(), problem, &plan, &options, usize::MAX)?)))
}

/// Mean operations of a step, by kind.
fn operations(run: &RecordedRun) -> BTreeMap<&'static str, f64> {
    let mut kinds = BTreeMap::new();
    let total: u32 = run.steps.iter().map(|(_, count)| count).sum();
    for (step, count) in &run.steps {
        for task in step.tasks.iter().filter(|task| task.operation != target_cost::Priced::Load) {
            *kinds.entry(task.operation.name()).or_insert(0.0) += f64::from(*count) / f64::from(total.max(1));
        }
    }
    kinds
}

fn cost(run: &RecordedRun, target: &Target, format: FormatName, period_s: f64) -> Cost {
    let priced = run
        .steps
        .iter()
        .map(|(step, count)| Ok((StepCost::of(step, target, format)?, f64::from(*count))))
        .collect::<Result<Vec<_>, NoPrice>>();
    let priced = match priced {
        Ok(priced) => priced,
        Err(none) => return Cost::Unknown { unknown: none.operation.name() },
    };
    let steps: f64 = priced.iter().map(|(_, count)| count).sum();
    let mean = priced.iter().map(|(step, count)| step.length * (count / steps.max(1.0))).sum::<Cycles>();
    let max = priced.iter().map(|(step, _)| step.length).fold(Cycles::default(), Cycles::max);
    let mut work: BTreeMap<&'static str, f64> = BTreeMap::new();
    for (step, count) in &priced {
        step.work.iter().for_each(|(name, cycles)| *work.entry(name).or_insert(0.0) += cycles * count);
    }
    let all: f64 = work.values().sum();
    let (dominating, most) = work.into_iter().max_by(|a, b| a.1.total_cmp(&b.1)).unwrap_or(("nothing", 0.0));
    let clock = target.clock_mhz(format.bits()).filter(|_| target.measure == Measure::Cycles);
    let fpga = target.kind == Kind::Fpga;
    Cost::Known(PeriodCost {
        mean: mean.typical,
        max: max.typical,
        mean_range: [mean.low, mean.high],
        max_range: [max.low, max.high],
        measure: target.measure,
        level: if target.calibrated { Level::ScheduledOnCountedCosts } else { Level::Scheduled },
        microseconds_max: clock.map(|mhz| max.typical / mhz),
        share_of_period: clock.map(|mhz| max.typical / mhz * 1e-6 / period_s),
        dominating,
        dominating_share: if all > 0.0 { most / all } else { 0.0 },
        dsp_blocks: fpga.then(|| priced.iter().map(|(step, _)| step.dsp_blocks).max().unwrap_or(0)),
        initiation_interval_max: fpga
            .then(|| priced.iter().map(|(step, _)| step.initiation_interval.typical).fold(0.0, f64::max)),
    })
}

/// Adds to the requirements that the dearest period fits the interpolation period on one of the targets: on the one on which it
/// takes the least of it, if that is known for all.
fn demand_that_it_fits(row: &mut Row, targets: &[Target]) {
    let known = |target: &Target| match row.cycles.get(&target.name) {
        Some(Cost::Known(cost)) => Some((cost.share_of_period?, cost.microseconds_max?)),
        _ => None,
    };
    let Some(costs) = targets.iter().map(known).collect::<Option<Vec<_>>>() else { return };
    let Some((share, microseconds)) = costs.into_iter().min_by(|a, b| a.0.total_cmp(&b.0)) else { return };
    row.requirements.push(Requirement {
        what: "dearest period in an interpolation period",
        found: share,
        limit: 1.0,
        unit: "ratio",
        at: None,
        broken: format!("a period takes {microseconds:.0} µs, {share:.1} times the interpolation period"),
    });
    row.verdict = Verdict::of(&row.requirements);
}

/// The cheapest good row on each target.
fn recommend(comparison: &mut Comparison, targets: &[Target]) {
    for target in targets {
        let price = |row: &Row| match row.cycles.get(&target.name) {
            // An FPGA is bought by its blocks, a processor by its time.
            Some(Cost::Known(cost)) if cost.fits() != Some(false) => {
                Some((f64::from(cost.dsp_blocks.unwrap_or(0)), cost.max))
            }
            _ => None,
        };
        let good = comparison.formats.iter().filter(|row| row.verdict.is_good());
        let cheapest = good
            .filter_map(|row| Some((price(row)?, row)))
            .min_by(|((a, b), _), ((c, d), _)| a.total_cmp(c).then(b.total_cmp(d)));
        if let Some((_, row)) = cheapest {
            let choice = (row.format.clone(), row.engine);
            comparison.recommended_on.insert(target.name.clone(), choice);
        }
    }
    if let Some(first) = targets.first() {
        let choice = comparison.recommended_on.get(&first.name);
        comparison.recommended = choice.map(|(format, _)| format.clone());
        comparison.recommended_engine = choice.map(|(_, engine)| *engine);
    }
}
