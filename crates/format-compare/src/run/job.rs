//! The input of a run: a problem, a plan of it, and the options.

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
    pub(crate) fn most_periods(&self) -> usize {
        most_periods(self.plan.periods())
    }
}

/// The periods after which a run is given up whose plan takes `planned` periods.
pub(crate) fn most_periods(planned: u32) -> usize {
    2 * planned as usize + 16
}
