//! A judged run: figures, requirements and the verdict.

use std::collections::BTreeMap;
use std::fmt;

use real::FormatName;
use serde::Serialize;
use target_cost::Cost;

use crate::judge::judgement::{Judge, Judgement};
use crate::judge::metrics::{Fluctuation, PerPeriod};
use crate::judge::reference::Reference;
use crate::judge::requirement::{Findings, Requirement, requirements};
use crate::judge::stated_limits::{seen_within_mm, stated_limits};
use crate::judge::tally::Tally;
use crate::problem::problem::Problem;
use crate::refusal::Refusal;
use crate::run::observer::Observer;
use crate::run::options::{Engine, Options};
use crate::run::run::AboutRun;

/// The run in one format by one engine, with its verdict and its figures. A refused run has no figures.
#[derive(Clone, Debug, Serialize)]
pub struct JudgedRun {
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
    /// Integer bits, with the sign, that the largest named signal needed.
    pub integer_bits_needed: Option<u32>,
    /// Largest distance of the curve from a chord, in mm, over the periods that pass no corner.
    pub chord_error_mm_max: Option<f64>,
    /// Largest distance of the curve from a chord, in mm, over the periods that pass a corner; 0 if none does.
    pub corner_error_mm_max: Option<f64>,
    /// Largest distance of a commanded point from the exact curve at its parameter, in mm.
    pub position_error_mm_max: Option<f64>,
    /// The step between two neighbouring commanded points, in mm: no position can be better than half of it.
    pub position_resolution_mm: Option<f64>,
    /// The fluctuation at cruise that comes from rounding the step per chord alone; see
    /// [`AboutRun::fluctuation_resolution`].
    pub fluctuation_resolution: Option<f64>,
    /// Distance of the last commanded point from the curve's end, in mm.
    pub end_error_mm: Option<f64>,
    /// Largest change of acceleration along the path from one period to the next, over T, in mm/s³: `|c_{i+1} - 2 c_i +
    /// c_{i-1}|/T³` for the chords c, including the last one. The requirement for the jerk along the path is judged on arc lengths.
    pub jerk_max_mm_per_s3: Option<f64>,
    /// Periods run.
    pub periods: Option<u64>,
    /// Mean operations of a period, by kind; absent unless priced on targets.
    pub operations: Option<BTreeMap<&'static str, f64>>,
    /// The cost of a period on each target.
    pub cycles: BTreeMap<String, Cost>,
    /// The requirements of the run, each with the figure found.
    pub requirements: Vec<Requirement>,
    /// Good, or the requirements that are broken.
    pub verdict: Verdict,
}

impl JudgedRun {
    /// The entry of a refused run: it has no figures.
    pub(crate) fn refused((format, engine): (FormatName, Engine), refusal: &Refusal) -> Self {
        Self {
            format: format.to_string(),
            bits: format.bits(),
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

    /// Judges the run that `run` makes in front of an observer.
    pub(crate) fn of_run<const D: usize>(
        name: (FormatName, Engine),
        problem: &Problem<D>,
        reference: &Reference<'_, D>,
        options: &Options,
        run: impl FnOnce(&dyn Observer) -> Result<AboutRun, Refusal>,
    ) -> Result<Self, Refusal> {
        let judge = Judge {
            reference,
            full_step_mm: problem.full_step_mm(),
            limits: &stated_limits(problem, 1.0),
            starts_at_rest: options.starts_at_rest(),
            traced: None,
            progress: &|_| (),
            is_enough: None,
        };
        let (run, judgement) = judge.judge(run)?;
        Ok(Self::of(name, problem, &run, &judgement))
    }

    /// The figures of a run of `problem` as it was judged.
    pub(crate) fn of<const D: usize>(
        (format, engine): (FormatName, Engine),
        problem: &Problem<D>,
        run: &AboutRun,
        judged: &Judgement<D>,
    ) -> Self {
        let tally = &judged.tally;
        let found = findings(problem, run, tally, judged.end_error_mm);
        let requirements = requirements(run, problem, &found);
        Self {
            format: format.to_string(),
            bits: format.bits(),
            engine,
            fluctuation: Some(tally.fluctuation().0),
            evaluations: Some(tally.evaluations.per_period()),
            saturations: Some(found.saturations),
            integer_bits_needed: Some(run.extremes.integer_bits_needed()),
            chord_error_mm_max: Some(found.chord_error_mm.figure),
            corner_error_mm_max: Some(found.corner_error_mm.figure),
            position_error_mm_max: Some(found.position_error_mm.figure),
            position_resolution_mm: Some(run.resolution_mm),
            fluctuation_resolution: Some(run.fluctuation_resolution),
            end_error_mm: Some(found.end_error_mm),
            jerk_max_mm_per_s3: Some(tally.jerk_max_mm_per_s3(problem.period_s())),
            periods: Some(tally.steps),
            operations: None,
            cycles: BTreeMap::new(),
            verdict: Verdict::of(&requirements),
            requirements,
        }
    }

    /// Whether there was no run.
    #[must_use]
    pub fn is_refused(&self) -> bool {
        matches!(self.verdict, Verdict::Refused(_))
    }
}

/// What the figures of a run say of each requirement.
fn findings<const D: usize>(
    problem: &Problem<D>,
    run: &AboutRun,
    tally: &Tally,
    end_error_mm: f64,
) -> Findings {
    let seen_within_mm = seen_within_mm(run, problem);
    Findings {
        fluctuation: tally.fluctuation().1,
        saturations: run.extremes.overflows + run.extremes.divisions_by_zero,
        chord_error_mm: tally.chord_error_mm,
        corner_error_mm: tally.corner_error_mm,
        position_error_mm: tally.position_error_mm,
        end_error_mm,
        limits: tally.differences.findings(seen_within_mm, problem.machine.junction.hidden_at_corners_mm()),
        periods: tally.steps,
        last: tally.last,
    }
}

/// The requirements of a run of `problem` of which a part was judged: what the part breaks, the whole does.
pub(crate) fn requirements_so_far<const D: usize>(
    problem: &Problem<D>,
    run: &AboutRun,
    part: &Tally,
) -> Vec<Requirement> {
    requirements(run, problem, &findings(problem, run, part, 0.0))
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
