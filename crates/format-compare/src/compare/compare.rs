//! Many formats side by side, each with a verdict, and a recommendation.

use std::collections::BTreeMap;
use std::sync::atomic::{AtomicU64, Ordering};

use part_program::Machine;
use serde::Serialize;

use crate::judge::judged_run::JudgedRun;
use crate::judge::judgement::Judge;
use crate::judge::not_of_format::NotOfFormat;
use crate::judge::reference::Reference;
use crate::judge::stated_limits::stated_limits;
use crate::judge::trace::{Coarseness, Trace};
use crate::plan::exact_plan::ExactPlan;
use crate::plan::plan_summary::OverLimits;
use crate::problem::problem::Problem;
use crate::refusal::Refusal;
use crate::run::formats::{Dimension, Format, Space, plan_for};
use crate::run::job::Job;
use crate::run::observer::Observer;
use crate::run::options::{Engine, Options, PlanIn};
use crate::size::fewest_bits::FewestBits;
use feed_plan::in_parallel;

/// The result of a comparison.
#[derive(Clone, Debug, Serialize)]
pub struct Comparison {
    /// The part that was run.
    pub part: PartSummary,
    /// The machine's limits, with the highest commanded feedrate in place of its own.
    pub machine: Machine,
    /// The reference against which the formats are judged.
    pub reference: &'static str,
    /// One run for each format and engine, in the order of rising cost.
    pub formats: Vec<JudgedRun>,
    /// The number of runs that an interruption has left out.
    #[serde(skip_serializing_if = "is_none")]
    pub interrupted_runs: usize,
    /// The first format whose verdict is good. After pricing on targets, it is the cheapest good one on the first
    /// target.
    pub recommended: Option<String>,
    /// The engine that runs the recommended format.
    pub recommended_engine: Option<Engine>,
    /// The cheapest good format on each target, with the engine that runs it.
    #[serde(skip_serializing_if = "BTreeMap::is_empty")]
    pub recommended_on: BTreeMap<String, (String, Engine)>,
    /// The fewest bits that are enough, if [`fewest_bits`](crate::fewest_bits()) was called. It searches among formats that follow a
    /// common plan: where each plans for itself, there is none.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub fewest_bits: Option<FewestBits>,
    /// Why no format is good if even `f64` is not: the result of [`not_of_format`](crate::not_of_format), if it was
    /// called.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub not_a_question_of_format: Option<NotOfFormat>,
}

#[allow(clippy::trivially_copy_pass_by_ref, reason = "serde passes a reference")]
fn is_none(count: &usize) -> bool {
    *count == 0
}

/// The part that was run, in figures.
#[derive(Clone, Debug, Serialize)]
pub struct PartSummary {
    /// Name of the part.
    pub name: String,
    /// Number of curves.
    pub curves: usize,
    /// Number of rapid moves that are not run.
    pub rapids_left_out: usize,
    /// Arc length, in mm.
    pub length_mm: f64,
    /// How long the plan takes that all formats run, in s; absent if each format plans for itself.
    pub planned_time_s: Option<f64>,
    /// By which part of itself the planned feed is lowered for setpoints, at most, because their chords are shorter than the path's arcs:
    /// the fluctuation is against the plan as lowered. Absent if each format plans for itself.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub lowered_for_chords: Option<f64>,
    /// How much of the path the planner had in view at a time, in mm; absent if it was the whole path.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub window_mm: Option<f64>,
    /// The lowest feedrate that a move commands, in mm/s; absent if all moves have the same one.
    pub lowest_feedrate_mm_per_s: Option<f64>,
    /// How far a plan without look-ahead is above the limits, which no verdict judges; absent for other plans.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub without_look_ahead: Option<OverLimits>,
}

/// Runs `problem` in each format by each of `engines`, on as many threads as the machine has cores, and judges each
/// run.
///
/// The f64 plan is made once for all, unless the options let each format plan for itself.
///
/// # Errors
/// [`Refusal`] when the reference cannot be made or planned: the part or the limits are at fault, not a format.
pub fn compare<const D: usize>(
    problem: &Problem<D>,
    formats: &[Box<dyn Format<D>>],
    engines: &[Engine],
    options: &Options,
) -> Result<Comparison, Refusal>
where
    Space: Dimension<D>,
{
    compare_with(problem, formats, engines, options, &Watch::default()).map(|compared| compared.comparison)
}

/// A comparison, and what is made on the way to it.
pub struct Compared {
    /// The comparison.
    pub comparison: Comparison,
    /// The trace of each run, if they were asked for; `None` where the format was refused.
    pub traces: Vec<Option<Trace>>,
    /// The plan that all runs follow, unless each format plans for itself.
    pub plan: Option<ExactPlan>,
}

/// What is wanted beside a comparison.
pub struct Watch<'a> {
    /// Whether each run has a [`Trace`].
    pub traces: bool,
    /// Called with the periods of all runs that have been judged, and with those that there are, if the plan is common.
    pub progress: &'a (dyn Fn(u64, u64) + Sync),
}

impl Default for Watch<'_> {
    fn default() -> Self {
        Self { traces: false, progress: &|_, _| () }
    }
}

/// The plan that the runs of a comparison follow; `None` where each format plans for itself.
///
/// # Errors
/// [`Refusal`] when no plan can be made.
pub fn common_plan<const D: usize>(
    problem: &Problem<D>,
    formats: &[Box<dyn Format<D>>],
    options: &Options,
) -> Result<Option<ExactPlan>, Refusal>
where
    Space: Dimension<D>,
{
    Ok(planned_for_all(problem, formats, options)?.map(ExactPlan::without_limit))
}

fn planned_for_all<const D: usize>(
    problem: &Problem<D>,
    formats: &[Box<dyn Format<D>>],
    options: &Options,
) -> Result<Option<ExactPlan>, Refusal>
where
    Space: Dimension<D>,
{
    match (options.plan_in, formats.first()) {
        (PlanIn::Same, _) | (PlanIn::Format(_), None) => Ok(None),
        (PlanIn::Format(_), Some(any)) => plan_for(problem, any.as_ref(), options).map(Some),
    }
}

/// As [`compare`], and returns the common plan, and a trace of each run if `watch` asks for it.
///
/// # Errors
/// As [`compare`].
pub fn compare_with<const D: usize>(
    problem: &Problem<D>,
    formats: &[Box<dyn Format<D>>],
    engines: &[Engine],
    options: &Options,
    watch: &Watch<'_>,
) -> Result<Compared, Refusal>
where
    Space: Dimension<D>,
{
    let reference = Reference::new(problem)?;
    let common = planned_for_all(problem, formats, options)?;
    // No run asks for the limit, only a page with traces does.
    let common = common.map(|plan| if watch.traces { plan } else { plan.without_limit() });
    let runs: Vec<(&dyn Format<D>, usize)> =
        formats.iter().flat_map(|format| (0..engines.len()).map(|index| (format.as_ref(), index))).collect();
    let planned = common.as_ref().map_or(0, ExactPlan::periods);
    let (all, done) = (planned * runs.len() as u64, AtomicU64::new(0));
    let judge = Judge {
        reference: &reference,
        full_step_mm: problem.full_step_mm(),
        limits: &stated_limits(problem, 1.0),
        starts_at_rest: options.starts_at_rest(),
        traced: watch.traces.then(|| Coarseness::of(planned, reference.length_mm())),
        progress: &|periods| (watch.progress)(done.fetch_add(periods, Ordering::Relaxed) + periods, all),
        is_enough: None,
    };
    let by_engine: Vec<_> =
        engines.iter().map(|engine| Options { engine: *engine, ..options.clone() }).collect();
    // The path is cut once for all formats that follow the common plan.
    let jobs: Vec<_> = by_engine
        .iter()
        .map(|options| common.as_ref().map(|plan| Job::new(problem, plan, options)))
        .collect();
    let judged = |(format, index): (&dyn Format<D>, usize)| {
        let (options, job) = (&by_engine[index], &jobs[index]);
        let run = |observer: &dyn Observer| match job {
            Some(job) => format.run_job(job, observer),
            None => format.run_before(problem, &plan_for(problem, format, options)?, options, observer),
        };
        let name = (format.name(), options.engine);
        match judge.judge(run) {
            Ok((run, judgement)) => (JudgedRun::of(name, problem, &run, &judgement), judgement.trace),
            Err(refusal) => (JudgedRun::refused(name, &refusal), None),
        }
    };
    // A run that was interrupted is left out. One that had ended before may be left out too.
    let whole = |run| Some(judged(run)).filter(|_| !options.is_interrupted());
    let judged = in_parallel(&runs, |run| whole(*run));
    let left_out = judged.iter().filter(|run| run.is_none()).count();
    let (runs, traces): (Vec<_>, Vec<_>) = judged.into_iter().flatten().unzip();
    // Without all runs there is no recommendation.
    let recommended = runs.iter().find(|run| run.verdict.is_good() && left_out == 0);
    let feedrate_mm_per_s = problem.feedrate_mm_per_s();
    let lowest = problem.feeds_mm_per_s.iter().copied().reduce(f64::min);
    let comparison = Comparison {
        part: PartSummary {
            name: problem.name.clone(),
            curves: problem.curves.len(),
            rapids_left_out: problem.rapids_left_out,
            length_mm: reference.length_mm(),
            without_look_ahead: common.as_ref().and_then(|plan| OverLimits::of(plan, problem)),
            planned_time_s: common.as_ref().map(|plan| problem.period_s() * plan.periods() as f64),
            lowered_for_chords: common.as_ref().map(ExactPlan::lowering),
            window_mm: options.window_mm,
            lowest_feedrate_mm_per_s: lowest.filter(|lowest| *lowest < feedrate_mm_per_s),
        },
        machine: Machine { feedrate_mm_per_s, ..problem.machine.clone() },
        reference: "double-double, 106 bits",
        recommended: recommended.map(|run| run.format.clone()),
        recommended_engine: recommended.map(|run| run.engine),
        recommended_on: BTreeMap::new(),
        fewest_bits: None,
        not_a_question_of_format: None,
        formats: runs,
        interrupted_runs: left_out,
    };
    Ok(Compared { comparison, traces, plan: common })
}
