//! What is run: a problem, a plan of it, and how.

use crate::plan::exact_plan::ExactPlan;
use crate::problem::problem::Problem;
use crate::run::options::Options;

/// A run that is asked for.
#[derive(Clone, Copy)]
pub(crate) struct Job<'a, const D: usize> {
    pub(crate) problem: &'a Problem<D>,
    pub(crate) plan: &'a ExactPlan,
    pub(crate) options: &'a Options,
}

impl<const D: usize> Job<'_, D> {
    /// Periods after which the run is given up: the format cannot run this plan.
    pub(crate) fn most_periods(&self) -> usize {
        most_periods(self.plan.periods())
    }
}

/// Periods after which a run is given up that is planned to take so many.
pub(crate) fn most_periods(planned: u32) -> usize {
    2 * planned as usize + 16
}
