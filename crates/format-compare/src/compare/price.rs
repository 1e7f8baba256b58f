//! The runs of a comparison priced on targets.

use std::cmp::Ordering;

use real::FormatName;
use target_cost::{Cost, RecordedRun, Target, cost, operations};

use crate::compare::compare::{Compared, Comparison};
use crate::judge::judged_run::{JudgedRun, Verdict};
use crate::judge::requirement::Requirement;
use crate::plan::exact_plan::ExactPlan;
use crate::problem::problem::Problem;
use crate::refusal::Refusal;
use crate::run::formats::{Dimension, Space, common_or_plan_for, format_named};
use crate::run::options::Options;
use feed_plan::in_parallel;

/// What is demanded beside precision once targets are known.
const DEAREST_PERIOD: &str = "dearest period in an interpolation period";

/// Records every run of `comparison` that was not refused, prices it on each of `targets`, and makes a new
/// recommendation. It recommends the format that costs least on the first target, among those that are good and fit the
/// period. A format that fits the period on none of the targets is no longer good. `recorded` is called each time a run
/// has been recorded, since recording takes most of the time.
///
/// # Errors
/// [`Refusal`] if no plan can be made, as in the comparison.
pub fn price<const D: usize>(
    Compared { comparison, plan, .. }: &mut Compared,
    problem: &Problem<D>,
    targets: &[Target],
    options: &Options,
    recorded: impl Fn() + Sync,
) -> Result<(), Refusal>
where
    Space: Dimension<D>,
{
    let recorded = in_parallel(&comparison.formats, |run| {
        let again = record(run, problem, plan.as_ref(), options);
        recorded();
        again
    });
    for (run, recorded) in comparison.formats.iter_mut().zip(recorded) {
        let Some((name, recorded)) = recorded? else { continue };
        run.operations = Some(operations(&recorded));
        for target in targets {
            run.cycles.insert(target.name.clone(), cost(&recorded, target, name, Some(problem.period_s())));
        }
        demand_that_it_fits(run, targets);
    }
    recommend(comparison, targets);
    Ok(())
}

/// Repeats a run and records it; `None` if the run was refused.
fn record<const D: usize>(
    run: &JudgedRun,
    problem: &Problem<D>,
    common: Option<&ExactPlan>,
    options: &Options,
) -> Result<Option<(FormatName, RecordedRun)>, Refusal>
where
    Space: Dimension<D>,
{
    let Some(format) = format_named(&run.format).filter(|_| !run.is_refused()) else { return Ok(None) };
    let options = Options { engine: run.engine, ..options.clone() };
    let plan = common_or_plan_for(common, problem, format.as_ref(), &options)?;
    Ok(Some((format.name(), format.record(problem, &plan, &options, usize::MAX)?)))
}

impl JudgedRun {
    /// The dearest period as a share of the interpolation period, if it is longer and all else is good enough.
    #[must_use]
    pub fn is_only_too_slow(&self) -> Option<f64> {
        let mut broken = self.requirements.iter().filter(|one| !one.holds());
        let only = broken.next().filter(|one| one.what == DEAREST_PERIOD)?;
        broken.next().is_none().then_some(only.found)
    }
}

/// Adds a requirement: the dearest period must fit the interpolation period on at least one of the targets. The target
/// on which it takes the least share counts. Nothing is added unless that share is known for all targets.
fn demand_that_it_fits(run: &mut JudgedRun, targets: &[Target]) {
    let known = |target: &Target| match run.cycles.get(&target.name) {
        Some(Cost::Known(cost)) => Some((cost.share_of_period?, cost.microseconds_max?)),
        _ => None,
    };
    let Some(costs) = targets.iter().map(known).collect::<Option<Vec<_>>>() else { return };
    let Some((share, microseconds)) = costs.into_iter().min_by(|a, b| a.0.total_cmp(&b.0)) else { return };
    run.requirements.push(Requirement {
        what: DEAREST_PERIOD,
        found: share,
        limit: 1.0,
        unit: "ratio",
        at: None,
        seen_within_mm: None,
        is_of_motion: false,
        broken: format!("a period takes {microseconds:.0} µs, {share:.1} times the interpolation period"),
    });
    run.verdict = Verdict::of(&run.requirements);
}

/// The cheapest good run on each target.
fn recommend(comparison: &mut Comparison, targets: &[Target]) {
    for target in targets {
        // Times are compared where all are known. A clock that is known for some formats alone compares cycles.
        let cost_of = |run: &JudgedRun| match run.cycles.get(&target.name) {
            Some(Cost::Known(cost)) => Some(cost.microseconds_max),
            _ => None,
        };
        let are_timed = comparison.formats.iter().filter_map(cost_of).all(|time| time.is_some());
        let price = |run: &JudgedRun| match run.cycles.get(&target.name) {
            // The cost of an FPGA is its blocks first, and then its LUTs; that of a processor its time.
            Some(Cost::Known(cost)) if cost.fits() != Some(false) => Some([
                f64::from(cost.dsp_blocks.unwrap_or(0)),
                f64::from(cost.luts.unwrap_or(0)),
                cost.microseconds_max.filter(|_| are_timed).unwrap_or(cost.max),
            ]),
            _ => None,
        };
        let good = comparison.formats.iter().filter(|run| run.verdict.is_good());
        let cheapest = good
            .filter_map(|run| Some((price(run)?, run)))
            .min_by(|(a, _), (b, _)| a.partial_cmp(b).unwrap_or(Ordering::Equal));
        if let Some((_, run)) = cheapest {
            let choice = (run.format.clone(), run.engine);
            comparison.recommended_on.insert(target.name.clone(), choice);
        }
    }
    if let Some(first) = targets.first() {
        let choice = comparison.recommended_on.get(&first.name);
        comparison.recommended = choice.map(|(format, _)| format.clone());
        comparison.recommended_engine = choice.map(|(_, engine)| *engine);
    }
}
