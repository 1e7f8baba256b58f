//! A path in one width after another, each time with as few integer bits as the compiled path allows.

use std::ops::RangeInclusive;

use nurbs_core::CompileError;
use real::{Datapath, FormatName, RuntimeFormat};

use crate::judge::judged_run::JudgedRun;
use crate::judge::reference::Reference;
use crate::problem::problem::Problem;
use crate::refusal::Refusal;
use crate::run::formats::{Dimension, Space};
use crate::run::job::Job;
use crate::run::observer::Observer;
use crate::run::options::{Engine, Options};
use crate::run::run::AboutRun;

/// Widths that are tried, in bits.
pub(crate) const WIDTHS: RangeInclusive<u32> = 12..=48;

/// Integer bits, with the sign, with which a search begins.
pub(crate) const FEWEST_INTEGER_BITS: u32 = 2;

/// The solver's share of the fluctuation that is allowed. The format's roundings may have the rest.
const SHARE_OF_SOLVER: f64 = 0.25;

/// The options of a search: it runs on pieces, and the solver stops at its share of the fluctuation that is allowed.
pub(crate) fn search_options<const D: usize>(problem: &Problem<D>, options: &Options) -> Options {
    Options {
        engine: Engine::Pieces,
        fluctuation: options.fluctuation.or(Some(SHARE_OF_SOLVER * problem.machine.fluctuation_limit)),
        ..options.clone()
    }
}

/// A path with its plan and its judge.
pub(crate) struct Trial<'a, const D: usize> {
    pub(crate) job: Job<'a, D>,
    pub(crate) datapath: Datapath,
    reference: Reference<'a, D>,
}

impl<'a, const D: usize> Trial<'a, D>
where
    Space: Dimension<D>,
{
    pub(crate) fn new(job: Job<'a, D>, datapath: Datapath) -> Result<Self, Refusal> {
        Ok(Self { job, datapath, reference: Reference::new(job.problem)? })
    }

    /// Judges the run in this format that `run` makes in front of an observer.
    pub(crate) fn judged(
        &self,
        format: FormatName,
        run: impl FnOnce(&dyn Observer) -> Result<AboutRun, Refusal>,
    ) -> Result<JudgedRun, Refusal> {
        JudgedRun::of_run((format, Engine::Pieces), self.job.problem, &self.reference, self.job.options, run)
    }

    /// The run at this width with the fewest integer bits for which the path compiles, tried from `fewest` on.
    pub(crate) fn narrowest_integer_part(&self, width: u32, fewest: u32) -> JudgedRun {
        let (Job { problem, plan, options }, datapath) = (self.job, self.datapath);
        let mut integer_bits = fewest;
        loop {
            let fraction_bits = width.saturating_sub(integer_bits);
            let name = FormatName::Fixed { integer_bits, fraction_bits, datapath };
            let format = RuntimeFormat::new(width, fraction_bits, datapath.rounding, datapath.overflow);
            let Some(format) = format else {
                let (what, value) = ("integer bits", f64::from(integer_bits));
                let refusal = Refusal::Limit { what, value, format: name };
                return JudgedRun::refused((name, Engine::Pieces), &refusal);
            };
            let tried = Space::at_run_time(format);
            let run = |observer: &dyn Observer| tried.run_before(problem, plan, options, observer);
            match self.judged(format.name(), run) {
                Ok(judged) => return judged,
                Err(Refusal::Compile(CompileError::DoesNotFit { integer_bits: needed, .. }))
                    if needed > integer_bits =>
                {
                    integer_bits = needed;
                }
                Err(Refusal::Limit { .. }) if integer_bits < 8 => integer_bits += 1,
                Err(refusal) => return JudgedRun::refused((format.name(), Engine::Pieces), &refusal),
            }
        }
    }
}
