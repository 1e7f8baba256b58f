//! One part in one format: what is asked, what comes out, why it may be refused.

use std::fmt;

use feed_plan::{PlanError, ProfileKind};
use nurbs_core::{CompileError, CurveError};
use real::{Audit, Backend, FormatName};
use secant_interp::Method;
use serde::Serialize;

use crate::exact_plan::ExactPlan;
use crate::overrides::OverrideCommands;
use crate::problem::Problem;
use crate::{on_global_parameter, on_pieces};

/// The form in which real time has the path, and what solves on it.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum Engine {
    /// The textbook way: one global parameter, de Boor's scheme each time, paper A's secant iteration.
    DeBoorSecant,
    /// The same with a first-order Taylor step.
    DeBoorTaylor1,
    /// The same with a second-order Taylor step.
    DeBoorTaylor2,
    /// Compiled pieces, the chord without loss, Newton's correction without division.
    Pieces,
}

impl core::fmt::Display for Engine {
    fn fmt(&self, f: &mut core::fmt::Formatter<'_>) -> core::fmt::Result {
        f.pad(match self {
            Self::DeBoorSecant => "raw",
            Self::DeBoorTaylor1 => "raw, taylor 1",
            Self::DeBoorTaylor2 => "raw, taylor 2",
            Self::Pieces => "pieces",
        })
    }
}

/// How a part is run.
#[derive(Clone, Debug)]
pub struct Options {
    /// The form of the path and the solver.
    pub engine: Engine,
    /// Longest compiled piece, in mm.
    pub piece_length_mm: f64,
    /// The format to plan in.
    pub plan_in: PlanIn,
    /// The transitions that the plan is made of.
    pub profile: ProfileKind,
    /// Feeds at the two ends of the path, in mm/s.
    pub end_feeds_mm_per_s: [f64; 2],
    /// The fluctuation that the solver stops at. By default the machine file's Δ on the global parameter, and the
    /// format's resolution on pieces.
    pub fluctuation: Option<f64>,
    /// Changes of the feed while the plan runs, on pieces.
    pub overrides: Option<OverrideCommands>,
}

impl Default for Options {
    fn default() -> Self {
        Self {
            engine: Engine::Pieces,
            piece_length_mm: 32.0,
            plan_in: PlanIn::default(),
            profile: ProfileKind::default(),
            end_feeds_mm_per_s: [0.0; 2],
            fluctuation: None,
            overrides: None,
        }
    }
}

/// The format that a plan is made in.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum PlanIn {
    /// The same for all rows.
    Format(FormatName),
    /// Each format plans for itself.
    Same,
}

impl Default for PlanIn {
    fn default() -> Self {
        Self::Format(f64::name())
    }
}

/// Why a part is not run in a format.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub enum Refusal {
    /// The curve does not fit the format, or is none after rounding.
    Curve(CurveError),
    /// A limit of the machine, in mm and periods, is beyond the format's range or rounds to zero.
    Limit {
        /// The limit.
        what: &'static str,
        /// Its value.
        value: f64,
        /// The format.
        format: FormatName,
    },
    /// No plan can be made in the format that it is to be made in.
    PlanIn(FormatName, Box<Refusal>),
    /// No plan exists.
    Plan(PlanError),
    /// The pieces do not fit the format.
    Compile(CompileError),
    /// A curve of the part that cannot be pieces, and where the part has it.
    CurveAt {
        /// Name of the part.
        part: String,
        /// Line of the move.
        line: usize,
        /// What is wrong with it.
        error: CompileError,
    },
    /// The interpolator with one global parameter runs one curve.
    ManyCurves(usize),
    /// A controller has no type of this format.
    NoType(FormatName),
    /// The run was given up.
    Unfinished {
        /// The periods that it took.
        periods: usize,
        /// The format.
        format: FormatName,
    },
}

impl fmt::Display for Refusal {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Curve(error) => error.fmt(f),
            Self::Limit { what, value, format } => {
                write!(f, "{what} = {value:.3e} (mm, periods) is out of range or zero in {format}")
            }
            Self::PlanIn(format, refusal) => write!(f, "planning in {format}: {refusal}"),
            Self::Plan(error) => write!(f, "planning failed: {error}"),
            Self::Compile(error) => error.fmt(f),
            Self::CurveAt { part, line, error } => write!(f, "{part}:{line}: {error}"),
            Self::ManyCurves(count) => write!(f, "one global parameter runs one curve, not {count}"),
            Self::NoType(format) => {
                write!(f, "{format} is no type of a controller: expected a float, or 8, 16, 32 or 64 bits")
            }
            Self::Unfinished { periods, format } => {
                write!(f, "the run in {format} is not at the end of the path after {periods} periods")
            }
        }
    }
}

impl std::error::Error for Refusal {}

impl From<CurveError> for Refusal {
    fn from(error: CurveError) -> Self {
        Self::Curve(error)
    }
}

impl From<PlanError> for Refusal {
    fn from(error: PlanError) -> Self {
        Self::Plan(error)
    }
}

impl From<CompileError> for Refusal {
    fn from(error: CompileError) -> Self {
        Self::Compile(error)
    }
}

/// One setpoint, exactly as the format holds it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct RunStep {
    /// Index of the curve.
    pub curve: usize,
    /// The parameter, as a sum of two floats.
    pub u: (f64, f64),
    /// The commanded point, in mm.
    pub point_mm: [f64; 3],
    /// The chord that the plan wanted, in mm, as a sum of two floats.
    pub wanted_mm: (f64, f64),
    /// The planned feed at the end of the period, in mm/s; with an override, the mean over the period.
    pub feed_mm_per_s: f64,
    /// Evaluations of the curve.
    pub evaluations: u32,
}

/// A run from the start of a path to its end.
#[derive(Clone, Debug)]
pub struct Run {
    /// The setpoints, a period each.
    pub steps: Vec<RunStep>,
    /// Whether the last setpoint is the path's end.
    pub finished: bool,
    /// Periods that the plan takes; the run may take more or fewer when rounding delays or hastens it.
    pub planned_periods: u32,
    /// The step between two neighbouring commanded points, in mm: of a float, at the largest coordinate.
    pub resolution_mm: f64,
    /// The step between two neighbouring positions of a printer's filament where it is furthest from 0, in mm: of a fixed-point format, in
    /// the smallest range that holds it.
    pub filament_step_mm: Option<f64>,
    /// Half a unit in the last place of what the solver seeks, over the step: what rounding it alone may cost, as a
    /// fluctuation. On the global parameter, `½ ulp(u)/(u_{i+1} - u_i)`, the largest over the steps at cruise; on
    /// pieces, `½ ulp(L)/L` of the full step `L = F·T`, for there the parameter is a 64-bit phase and the length the
    /// coarser of the two. Other roundings of a step add to it.
    pub fluctuation_resolution: f64,
    /// What the format's arithmetic met.
    pub audit: Audit,
}

/// The step between neighbouring numbers of `R` at the magnitude of `largest`.
pub(crate) fn resolution_at<R: Backend>(largest: f64) -> f64 {
    match R::name() {
        FormatName::Fixed { .. } => R::resolution().to_f64(),
        _ => R::resolution().to_f64() * largest,
    }
}

/// The step between neighbouring numbers of `R` in mm, where a position of its own scale is as far from 0 as `farthest_mm`.
pub(crate) fn own_step_mm<R: Backend>(farthest_mm: f64) -> f64 {
    match R::name() {
        FormatName::Fixed { .. } => {
            let doublings = (farthest_mm / R::max_value().to_f64()).log2().ceil();
            R::resolution().to_f64() * doublings.max(0.0).exp2()
        }
        _ => unit_in_last_place::<R>(farthest_mm),
    }
}

/// The distance of `value` from the next larger number of `R`.
pub(crate) fn unit_in_last_place<R: Backend>(value: f64) -> f64 {
    match R::name() {
        FormatName::Fixed { .. } => R::resolution().to_f64(),
        _ => R::resolution().to_f64() * value.abs().log2().floor().exp2(),
    }
}

/// Runs `problem` in the format `R`, and once more in the auditing form `A` of the same format.
pub(crate) fn audited<R: Backend, A: Backend, const D: usize>(
    problem: &Problem<D>,
    plan: &ExactPlan,
    options: &Options,
) -> Result<Run, Refusal> {
    let mut run = once::<R, D>(problem, plan, options)?;
    run.filament_step_mm = problem.filament_mm.filter(|farthest| *farthest > 0.0).map(own_step_mm::<R>);
    let (again, audit) = Audit::of(|| once::<A, D>(problem, plan, options));
    debug_assert!(again.is_ok_and(|again| again.steps == run.steps), "an audit changes no value");
    run.audit = audit;
    Ok(run)
}

fn once<R: Backend, const D: usize>(
    problem: &Problem<D>,
    plan: &ExactPlan,
    options: &Options,
) -> Result<Run, Refusal> {
    match options.engine {
        Engine::DeBoorSecant => on_global_parameter::run::<R, D>(problem, plan, options, Method::Secant),
        Engine::DeBoorTaylor1 => on_global_parameter::run::<R, D>(problem, plan, options, Method::Taylor1),
        Engine::DeBoorTaylor2 => on_global_parameter::run::<R, D>(problem, plan, options, Method::Taylor2),
        Engine::Pieces => on_pieces::run::<R, D>(problem, plan, options),
    }
}

/// Periods after which a run is given up: the format cannot run this plan.
pub(crate) fn most_periods(planned: u32) -> usize {
    2 * planned as usize + 16
}
