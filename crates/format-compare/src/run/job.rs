//! The input of a run: a problem, a plan of it, and the options.

use feed_plan::Lead;

use crate::plan::exact_plan::ExactPlan;
use crate::problem::problem::Problem;
use crate::run::options::Options;

/// A run that is to be made.
#[derive(Clone, Copy)]
pub(crate) struct Job<'a, const D: usize> {
    pub(crate) problem: &'a Problem<D>,
    pub(crate) plan: &'a ExactPlan,
    pub(crate) options: &'a Options,
}

impl<const D: usize> Job<'_, D> {
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
