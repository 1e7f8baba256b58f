//! The cost of a step on targets, from its recorded operations.

use std::collections::BTreeMap;
use std::ops::ControlFlow;

use real::{Backend, FormatName, Graph, Recorded, Work};
use serde::Serialize;
use target_cost::{Cost, RecordedRun, Target, cost, operations};

use crate::bench::{Observer, run};
use crate::case::Case;
use crate::ended::Ended;
use crate::formats::in_format;
use crate::kernel::Kernel;
use crate::refusal::Refusal;

/// Most steps that are recorded.
const MOST_RECORDED: usize = 1 << 14;

/// What a step costs.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct StepPrice {
    /// The format.
    pub format: String,
    /// Number of steps that were recorded, from the first.
    pub recorded_steps: usize,
    /// Mean operations of a step, by kind.
    pub operations: BTreeMap<&'static str, f64>,
    /// By the name of each target: the cost of the mean and of the dearest step.
    pub targets: BTreeMap<String, Cost>,
}

/// Records the first steps of a kernel's run in a format, at most 2¹⁴, and prices them on each of these targets. The period
/// is the time that a step may take, in seconds, if there is one.
///
/// # Errors
/// As [`compare`](crate::compare()), and [`Refusal::Run`] if the kernel does not run in the format.
pub fn price<K: Kernel>(
    kernel: &K,
    format: FormatName,
    targets: &[Target],
    period_s: Option<f64>,
) -> Result<StepPrice, Refusal> {
    let case = Case::of(kernel, &[format])?;
    let (ended, recorded) = in_format(format, Recording { case: &case });
    if !matches!(ended, Ended::Finished | Ended::Enough) {
        return Err(Refusal::Run(format.to_string(), ended));
    }
    let costs = targets.iter().map(|target| (target.name.clone(), cost(&recorded, target, format, period_s)));
    Ok(StepPrice {
        format: format.to_string(),
        recorded_steps: recorded.steps.iter().map(|(_, count)| *count as usize).sum(),
        operations: operations(&recorded),
        targets: costs.collect(),
    })
}

struct Recording<'a, 'k, K> {
    case: &'a Case<'k, K>,
}

#[derive(Default)]
struct Recorder(RecordedRun);

impl<R: Backend> Observer<Recorded<R>> for Recorder {
    fn begins(&mut self, _step: usize) {
        // What the kernel does between steps, constants above all, is no part of one.
        drop(Graph::so_far());
    }

    fn ends(&mut self, step: usize, _outputs: &[Recorded<R>]) -> ControlFlow<()> {
        self.0.add(&Graph::so_far());
        if step + 1 < MOST_RECORDED { ControlFlow::Continue(()) } else { ControlFlow::Break(()) }
    }
}

impl<K: Kernel> Work for Recording<'_, '_, K> {
    type Output = (Ended, RecordedRun);

    fn in_backend<R: Backend>(self) -> Self::Output {
        let mut recorder = Recorder::default();
        let (ended, _) = Graph::of(|| run::<K, Recorded<R>>(self.case, &mut recorder));
        (ended, recorder.0)
    }
}
