//! A planar part on a machine, run in f64 and judged.

use format_compare::{
    ExactPlan, FeedSample, Fluctuation, JudgedStep, Options, Problem, Reference, Run, formats,
};
use part_program::{Machine, Part, read_machine, read_part};
use real::Backend;

use crate::error::PaperError;

/// A run of a plan in f64.
pub(crate) struct Judged {
    pub(crate) plan: ExactPlan,
    pub(crate) run: Run,
    pub(crate) steps: Vec<JudgedStep>,
}

impl Judged {
    /// Plans and runs.
    pub(crate) fn new(problem: &Problem<2>, options: &Options) -> Result<Self, PaperError> {
        let planned =
            ExactPlan::in_format_with::<f64, 2>(problem, options.end_feeds_mm_per_s, options.profile);
        let plan = planned.map_err(PaperError::of("the plan"))?;
        let all = formats::<2>();
        let format = all.iter().find(|format| format.name() == f64::name());
        let format = format.ok_or("f64 is not built in").map_err(PaperError::of("the run"))?;
        let run = format.run(problem, &plan, options).map_err(PaperError::of("the run"))?;
        let reference = Reference::new(problem).map_err(PaperError::of("the reference"))?;
        let steps = reference.judge(&run.steps);
        Ok(Self { plan, run, steps })
    }

    /// The figures of all steps but the landing, which takes what the curve has left.
    pub(crate) fn fluctuation(&self, problem: &Problem<2>) -> Fluctuation {
        Fluctuation::of(self.without_landing(), problem.full_step_mm())
    }

    /// The steps of at least a quarter of F T: a step of a Taylor expansion next to rest may be short by nearly all of it.
    pub(crate) fn long_steps(&self, problem: &Problem<2>) -> Vec<JudgedStep> {
        let long = |step: &&JudgedStep| step.wanted_mm >= 0.25 * problem.full_step_mm();
        self.without_landing().iter().filter(long).copied().collect()
    }

    /// All steps but the landing: the last of the plan, and those of a run that is late.
    pub(crate) fn without_landing(&self) -> &[JudgedStep] {
        let planned =
            usize::try_from(self.run.about.planned_periods).unwrap_or(usize::MAX).min(self.steps.len());
        &self.steps[..planned.saturating_sub(1)]
    }

    /// The plan, eight times a period.
    pub(crate) fn sampled(&self, problem: &Problem<2>) -> Result<Vec<FeedSample>, PaperError> {
        self.plan.sampled(problem, 8).map_err(PaperError::of("the samples of the plan"))
    }
}

/// A text as a part.
pub(crate) fn part(name: &str, text: &str) -> Result<Part, PaperError> {
    read_part(name, text).map_err(PaperError::of("the part"))
}

/// A text as a machine.
pub(crate) fn machine(name: &str, text: &str) -> Result<Machine, PaperError> {
    read_machine(name, text).map_err(PaperError::of("the machine"))
}

/// A part on a machine.
pub(crate) fn problem(part: &Part, machine: &Machine) -> Result<Problem<2>, PaperError> {
    Problem::new(part, machine).map_err(PaperError::of("the part on its machine"))
}

/// The largest magnitude; 0 of nothing.
pub(crate) fn largest(numbers: impl IntoIterator<Item = f64>) -> f64 {
    numbers.into_iter().fold(0.0, |most, x| if x.abs() > most { x.abs() } else { most })
}
