//! The data of a report.

use format_compare::{Comparison, FeedSample, Trace};
use target_cost::{StepCost, Target};

/// The data of a report: a comparison, and the data kept of its runs.
#[derive(Clone, Copy, Debug)]
pub struct Material<'a> {
    /// The comparison.
    pub comparison: &'a Comparison,
    /// The trace of each row of the comparison; `None` where the format was refused.
    pub traces: &'a [Option<Trace>],
    /// The plan, sampled; empty if each format plans for itself.
    pub plan: &'a [FeedSample],
    /// Runs by the papers' solvers on the raw path in f64; may be empty.
    pub solvers: &'a [Solver],
    /// The targets that the comparison was priced on.
    pub targets: &'a [Target],
    /// Schedules of a period on targets.
    pub schedules: &'a [Schedule<'a>],
    /// The command that makes the report again.
    pub command: &'a str,
}

/// A run by one of the papers' solvers.
#[derive(Clone, Debug)]
pub struct Solver {
    /// The solver's name.
    pub name: String,
    /// The trace of its run.
    pub trace: Trace,
}

/// A period on a target.
#[derive(Clone, Debug)]
pub struct Schedule<'a> {
    /// The target.
    pub target: &'a Target,
    /// Format and form of the path.
    pub run: String,
    /// When each operation runs.
    pub cost: StepCost,
}

impl Material<'_> {
    /// The interpolation period, in s.
    pub(crate) fn period_s(&self) -> f64 {
        self.comparison.machine.interpolation_period_ms / 1000.0
    }
}
