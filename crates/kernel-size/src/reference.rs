//! The reference: the same kernel in double-double.

use std::ops::ControlFlow;
use std::sync::Arc;

use real::{Backend, Decision, DoubleDouble, Watch, Watched, Watching};
use serde::Serialize;

use crate::bench::{Observer, run};
use crate::case::Case;
use crate::ended::Ended;
use crate::judge::{Judge, OutputFound, Pair};
use crate::kernel::Kernel;
use crate::refusal::Refusal;

/// How good the reference is by right values that are known otherwise.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct ReferenceFound {
    /// How its run ended.
    pub ended: Ended,
    /// Its outputs: without errors where they are the right values themselves.
    pub outputs: Vec<OutputFound>,
    /// Whether it meets every requirement. If it does not, the fault is not one of formats.
    pub good: bool,
}

/// The run in double-double.
pub(crate) struct Reference {
    /// The outputs, one step after the other.
    pub(crate) outputs: Vec<Pair>,
    pub(crate) decisions: Arc<[bool]>,
    /// The number of decisions before each step.
    before: Vec<usize>,
    pub(crate) found: ReferenceFound,
}

type Number = Watched<DoubleDouble>;

#[derive(Default)]
struct Kept {
    outputs: Vec<Pair>,
    before: Vec<usize>,
}

impl Observer<Number> for Kept {
    fn begins(&mut self, _step: usize) {
        self.before.push(Watch::count_so_far());
    }

    fn ends(&mut self, _step: usize, outputs: &[Number]) -> ControlFlow<()> {
        self.outputs.extend(outputs.iter().map(|number| number.to_f64_pair()));
        ControlFlow::Continue(())
    }
}

/// Ends the run after a step.
struct Until(usize);

impl Observer<Number> for Until {
    fn ends(&mut self, step: usize, _outputs: &[Number]) -> ControlFlow<()> {
        if step < self.0 { ControlFlow::Continue(()) } else { ControlFlow::Break(()) }
    }
}

impl Reference {
    pub(crate) fn of<K: Kernel>(case: &Case<'_, K>) -> Result<Self, Refusal> {
        let mut kept = Kept::default();
        let (ended, watch) = Watch::of(Watching::All, || run(case, &mut kept));
        let is_needed = case.outputs.iter().any(|output| output.truth.is_none());
        if is_needed && ended != Ended::Finished {
            return Err(Refusal::Reference(ended));
        }
        let Kept { outputs, before } = kept;
        let mut judge = Judge::new(&case.outputs, &outputs, case.steps);
        for (step, values) in outputs.chunks(case.outputs.len().max(1)).enumerate() {
            judge.note(step, values.iter().copied());
        }
        let judged = if ended == Ended::Finished { judge.finished() } else { judge.so_far() };
        let good = ended == Ended::Finished && judged.iter().all(|one| one.first_broken().is_none());
        let found = ReferenceFound { ended, outputs: judged, good };
        Ok(Self { outputs, decisions: watch.decisions.into(), before, found })
    }

    /// The step of a decision.
    pub(crate) fn step_of(&self, decision: usize) -> usize {
        self.before.partition_point(|first| *first <= decision).saturating_sub(1)
    }

    /// A decision of the reference, from the same run once more.
    pub(crate) fn decision<K: Kernel>(case: &Case<'_, K>, number: usize, step: usize) -> Option<Decision> {
        Watch::of(Watching::Only(number), || run(case, &mut Until(step))).1.found
    }
}
