//! Many formats side by side, with a verdict each and a recommendation.

use std::collections::BTreeMap;
use std::fmt;

use part_program::Machine;
use real::FormatName;
use serde::Serialize;

use crate::cost::Cost;
use crate::fewest_bits::FewestBits;
use crate::formats::{Dimension, Format, Space, plan_for};
use crate::metrics::{Fluctuation, JudgedStep, PerPeriod, jerk_max_mm_per_s3};
use crate::not_of_format::NotOfFormat;
use crate::problem::Problem;
use crate::reference::Reference;
use crate::requirement::{Measured, Requirement, requirements};
use crate::run::{Engine, Options, PlanIn, Refusal, Run};

/// The result of a comparison.
#[derive(Clone, Debug, Serialize)]
pub struct Comparison {
    /// What was run.
    pub part: PartSummary,
    /// The machine's limits.
    pub machine: Machine,
    /// What the formats are judged by.
    pub reference: &'static str,
    /// A row a format, in the order of rising cost.
    pub formats: Vec<Row>,
    /// The first format whose verdict is good; priced on targets, the cheapest on the first of them.
    pub recommended: Option<String>,
    /// How that format is to be run.
    pub recommended_engine: Option<Engine>,
    /// The cheapest good format on each target, and how it is to be run.
    #[serde(skip_serializing_if = "BTreeMap::is_empty")]
    pub recommended_on: BTreeMap<String, (String, Engine)>,
    /// The fewest bits that are enough, where [`fewest_bits`](crate::fewest_bits()) was asked.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub fewest_bits: Option<FewestBits>,
    /// Why no format is good, if even `f64` is not: what [`not_of_format`](crate::not_of_format) found, where it was asked.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub not_a_question_of_format: Option<NotOfFormat>,
}

/// What was run.
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
    /// Planned time, in s; absent when each format plans for itself.
    pub planned_time_s: Option<f64>,
    /// The lowest feedrate that a move commands, in mm/s; absent where all command the machine's.
    pub lowest_feedrate_mm_per_s: Option<f64>,
}

/// One format's figures. They are absent when the format was refused.
#[derive(Clone, Debug, Serialize)]
pub struct Row {
    /// The format's name.
    pub format: String,
    /// Its width.
    pub bits: u32,
    /// The form of the path and the solver.
    pub engine: Engine,
    /// Feedrate fluctuation.
    pub fluctuation: Option<Fluctuation>,
    /// Evaluations of the curve per period.
    pub evaluations: Option<PerPeriod>,
    /// Results that did not fit the format, and divisions by zero.
    pub saturations: Option<u64>,
    /// Integer bits, with the sign, that the largest named signal took.
    pub integer_bits_needed: Option<u32>,
    /// Largest distance of the curve from a chord, in mm, of the periods that pass no corner.
    pub chord_error_mm_max: Option<f64>,
    /// The same of the periods that pass a corner; 0 where none does.
    pub corner_error_mm_max: Option<f64>,
    /// Largest distance of a commanded point from the exact curve at its parameter, in mm.
    pub position_error_mm_max: Option<f64>,
    /// The step between two neighbouring commanded points, in mm: no position can be better than half of it.
    pub position_resolution_mm: Option<f64>,
    /// What rounding the solved quantity alone may cost at cruise, as a fluctuation; see
    /// [`Run::fluctuation_resolution`].
    pub fluctuation_resolution: Option<f64>,
    /// Distance of the last commanded point from the curve's end, in mm.
    pub end_error_mm: Option<f64>,
    /// Largest change of acceleration along the path from one period to the next, over T, in mm/s³, with that of the last step:
    /// `|c_{i+1} - 2 c_i + c_{i-1}|/T³` for the chords c. No requirement, for over corners that are passed it is what they take.
    pub jerk_max_mm_per_s3: Option<f64>,
    /// Periods run.
    pub periods: Option<u32>,
    /// Mean operations of a period, by kind; absent unless priced on targets.
    pub operations: Option<BTreeMap<&'static str, f64>>,
    /// What a period costs, by target.
    pub cycles: BTreeMap<String, Cost>,
    /// What the run must keep, with what was found.
    pub requirements: Vec<Requirement>,
    /// Good, or what is broken.
    pub verdict: Verdict,
}

/// Whether a format meets the machine file's requirements.
#[derive(Clone, Debug, PartialEq, Serialize)]
#[serde(rename_all = "snake_case", tag = "result", content = "reasons")]
pub enum Verdict {
    /// Every requirement is met.
    Good,
    /// Requirements that are not met, each with figure and limit.
    Bad(Vec<String>),
    /// The part cannot be run in the format.
    Refused(String),
}

impl Verdict {
    pub(crate) fn of(requirements: &[Requirement]) -> Self {
        let broken: Vec<_> =
            requirements.iter().filter(|one| !one.holds()).map(|one| one.broken.clone()).collect();
        if broken.is_empty() { Self::Good } else { Self::Bad(broken) }
    }

    /// Whether every requirement is met.
    #[must_use]
    pub fn is_good(&self) -> bool {
        *self == Self::Good
    }
}

impl fmt::Display for Verdict {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Good => f.write_str("good"),
            Self::Bad(reasons) => f.write_str(&reasons.join("; ")),
            Self::Refused(reason) => write!(f, "refused: {reason}"),
        }
    }
}

/// Runs `problem` in each format by each of `engines`, on as many threads as the machine has cores, and judges each
/// run.
///
/// The f64 plan is made once for all, unless the options let each format plan for itself.
///
/// # Errors
/// [`Refusal`] when the reference itself cannot be made or planned: the part or the limits are at fault, not a
/// format.
pub fn compare<const D: usize>(
    problem: &Problem<D>,
    formats: &[Box<dyn Format<D>>],
    engines: &[Engine],
    options: &Options,
) -> Result<Comparison, Refusal>
where
    Space: Dimension<D>,
{
    compare_with(problem, formats, engines, options, |_, _| ()).map(|(comparison, _)| comparison)
}

/// The same, and what `keep` makes of each row, of its run and of the steps as the reference judged them. There is no
/// run where the format was refused. `keep` is called as the runs end, on the thread that ran them, so that what a
/// run takes in memory can be given back before the next.
///
/// # Errors
/// As [`compare`].
pub fn compare_with<T: Send, const D: usize>(
    problem: &Problem<D>,
    formats: &[Box<dyn Format<D>>],
    engines: &[Engine],
    options: &Options,
    keep: impl Fn(&Row, Option<(&Run, &[JudgedStep])>) -> T + Sync,
) -> Result<(Comparison, Vec<T>), Refusal>
where
    Space: Dimension<D>,
{
    let reference = Reference::new(problem)?;
    let common = match options.plan_in {
        PlanIn::Same => None,
        PlanIn::Format(_) => match formats.first() {
            Some(any) => Some(plan_for(problem, any.as_ref(), options)?),
            None => None,
        },
    };
    let row = |(format, engine): (&dyn Format<D>, Engine)| -> (Row, T) {
        let options = &Options { engine, ..options.clone() };
        let plan = match &common {
            Some(plan) => Ok(plan.clone()),
            None => format.plan(problem, options),
        };
        match plan.and_then(|plan| format.run(problem, &plan, options)) {
            Ok(run) => {
                let steps = reference.judge(&run);
                let row = judged((format.name(), engine), problem, &reference, (&run, &steps));
                let kept = keep(&row, Some((&run, &steps)));
                (row, kept)
            }
            Err(refusal) => {
                let row = refused((format.name(), engine), &refusal);
                let kept = keep(&row, None);
                (row, kept)
            }
        }
    };
    let runs: Vec<(&dyn Format<D>, Engine)> =
        formats.iter().flat_map(|format| engines.iter().map(|engine| (format.as_ref(), *engine))).collect();
    let (rows, kept): (Vec<Row>, Vec<T>) = in_parallel(&runs, |run| row(*run)).into_iter().unzip();
    let recommended = rows.iter().find(|row| row.verdict.is_good());
    let comparison = Comparison {
        part: PartSummary {
            name: problem.name.clone(),
            curves: problem.curves.len(),
            rapids_left_out: problem.rapids_left_out,
            length_mm: reference.length_mm(),
            planned_time_s: common.map(|plan| problem.period_s() * f64::from(plan.periods())),
            lowest_feedrate_mm_per_s: problem
                .feed_shares
                .iter()
                .copied()
                .reduce(f64::min)
                .map(|share| share * problem.machine.feedrate_mm_per_s),
        },
        machine: problem.machine.clone(),
        reference: "double-double, 106 bits",
        recommended: recommended.map(|row| row.format.clone()),
        recommended_engine: recommended.map(|row| row.engine),
        recommended_on: BTreeMap::new(),
        fewest_bits: None,
        not_a_question_of_format: None,
        formats: rows,
    };
    Ok((comparison, kept))
}

/// Maps `work` over `items`, in order, on all cores.
pub fn in_parallel<T: Sync, U: Send>(items: &[T], work: impl Fn(&T) -> U + Sync) -> Vec<U> {
    let workers = std::thread::available_parallelism().map_or(1, usize::from).min(items.len().max(1));
    let next = std::sync::atomic::AtomicUsize::new(0);
    let results = std::sync::Mutex::new(Vec::new());
    std::thread::scope(|scope| {
        for _ in 0..workers {
            scope.spawn(|| {
                loop {
                    let index = next.fetch_add(1, std::sync::atomic::Ordering::Relaxed);
                    let Some(item) = items.get(index) else { break };
                    let result = work(item);
                    results.lock().unwrap_or_else(std::sync::PoisonError::into_inner).push((index, result));
                }
            });
        }
    });
    let mut results = results.into_inner().unwrap_or_else(std::sync::PoisonError::into_inner);
    results.sort_by_key(|(index, _)| *index);
    results.into_iter().map(|(_, result)| result).collect()
}

pub(crate) fn refused((name, engine): (FormatName, Engine), refusal: &Refusal) -> Row {
    Row {
        format: name.to_string(),
        bits: name.bits(),
        engine,
        fluctuation: None,
        evaluations: None,
        saturations: None,
        integer_bits_needed: None,
        chord_error_mm_max: None,
        corner_error_mm_max: None,
        position_error_mm_max: None,
        position_resolution_mm: None,
        fluctuation_resolution: None,
        end_error_mm: None,
        jerk_max_mm_per_s3: None,
        periods: None,
        operations: None,
        cycles: BTreeMap::new(),
        requirements: Vec::new(),
        verdict: Verdict::Refused(refusal.to_string()),
    }
}

pub(crate) fn judged<const D: usize>(
    (name, engine): (FormatName, Engine),
    problem: &Problem<D>,
    reference: &Reference<D>,
    (run, steps): (&Run, &[JudgedStep]),
) -> Row {
    let fluctuation = Fluctuation::of(steps, problem.machine.feedrate_mm_per_s * problem.period_s());
    let end_error = reference.end_error_mm(run);
    let saturations = run.audit.overflows + run.audit.divisions_by_zero;

    let measured = Measured::of(steps, &fluctuation, saturations, end_error);
    let requirements = requirements(run, problem, &measured);
    let ends_at_rest = run.steps.last().is_some_and(|step| step.feed_mm_per_s == 0.0);

    Row {
        format: name.to_string(),
        bits: name.bits(),
        engine,
        fluctuation: Some(fluctuation),
        evaluations: Some(PerPeriod::of(run.steps.iter().map(|step| step.evaluations))),
        saturations: Some(saturations),
        integer_bits_needed: Some(run.audit.integer_bits_needed()),
        chord_error_mm_max: Some(measured.chord_error_mm.figure),
        corner_error_mm_max: Some(measured.corner_error_mm.figure),
        position_error_mm_max: Some(measured.position_error_mm.figure),
        position_resolution_mm: Some(run.resolution_mm),
        fluctuation_resolution: Some(run.fluctuation_resolution),
        end_error_mm: Some(end_error),
        jerk_max_mm_per_s3: Some(jerk_max_mm_per_s3(steps, problem.period_s(), ends_at_rest)),
        periods: u32::try_from(run.steps.len()).ok(),
        operations: None,
        cycles: BTreeMap::new(),
        verdict: Verdict::of(&requirements),
        requirements,
    }
}
