//! The input of a run: a problem, a plan of it, and the options.

use std::sync::OnceLock;

use feed_plan::Lead;
use nurbs_core::{CutPath, NurbsBuf, PieceLimits};
use real::DoubleDouble;

use crate::plan::exact_plan::ExactPlan;
use crate::problem::problem::Problem;
use crate::refusal::Refusal;
use crate::run::options::Options;

/// The slot of the run-time format in which work is done in few backends: in slot 0 the format of a run may be in force.
pub(crate) const FEW: usize = 1;

/// A run that is to be made, in one format or in several.
pub struct Job<'a, const D: usize> {
    pub(crate) problem: &'a Problem<D>,
    pub(crate) plan: &'a ExactPlan,
    pub(crate) options: &'a Options,
    /// The result of [`cut`](Self::cut), made at the first call.
    cut: OnceLock<Result<CutPath<DoubleDouble, D>, Refusal>>,
}

impl<'a, const D: usize> Job<'a, D> {
    /// The run of `problem` by a plan of it.
    #[must_use]
    pub fn new(problem: &'a Problem<D>, plan: &'a ExactPlan, options: &'a Options) -> Self {
        Self { problem, plan, options, cut: OnceLock::new() }
    }

    /// The path cut into pieces, with a joint at each rest of the plan: what all formats have in common.
    pub(crate) fn cut(&self) -> Result<&CutPath<DoubleDouble, D>, Refusal> {
        self.cut.get_or_init(|| self.make_cut()).as_ref().map_err(Refusal::clone)
    }

    fn make_cut(&self) -> Result<CutPath<DoubleDouble, D>, Refusal> {
        let Self { problem, plan, options, .. } = self;
        let limits = problem.limits_per_period()?;
        let curves: Vec<_> = problem.curves.iter().map(NurbsBuf::as_curve).collect();
        // With overrides, the plan is made for the highest of them, and a coarse format may round the feed up.
        let fastest = limits.feedrate.max(plan.greatest_feed());
        let limits =
            PieceLimits { length_mm: options.piece_length_mm, step_mm: fastest + limits.acceleration };
        let stops: Vec<_> = plan.rests().collect();
        CutPath::new(&curves, &limits, &stops).map_err(|error| problem.refusal(error))
    }

    /// Periods after which the run is given up: the format cannot run this plan.
    pub(crate) fn most_periods(&self) -> u64 {
        most_periods(self.plan.periods())
    }

    /// By how much a run by the chords that were planned is ahead of the plan along the path; `None` if the feed is overridden, the plan sees
    /// a window of the path alone, or the path has no limit in f64.
    pub(crate) fn lead(&self) -> Option<Lead<f64>> {
        let is_as_planned = self.options.overrides.is_none() && self.options.window_mm.is_none();
        is_as_planned.then(|| self.plan.lead(self.problem)).flatten()
    }
}

/// The periods after which a run is given up whose plan takes `planned` periods.
pub(crate) fn most_periods(planned: u64) -> u64 {
    planned.saturating_mul(2).saturating_add(16)
}

/// Additional periods that a section may take to land: most take a dozen.
pub(crate) const MOST_LATE: u64 = 256;

/// The periods after which a section is given up that takes `planned` periods.
pub(crate) fn most_of_section(planned: u64) -> u64 {
    most_periods(planned).saturating_add(MOST_LATE)
}
