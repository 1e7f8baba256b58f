//! A run that ends as soon as it is known to be bad.

use std::ops::ControlFlow;

use real::Backend;

use crate::bench::Observer;
use crate::case::Case;
use crate::judge::{Judge, OutputFound};
use crate::kernel::Kernel;
use crate::reference::Reference;

/// Judges the steps of a run until a requirement is broken, or until it is of no interest for another reason.
pub(crate) struct UntilBad<'a, F> {
    judge: Judge<'a>,
    is_of_no_interest: F,
    is_bad: bool,
}

impl<'a, F: Fn() -> bool> UntilBad<'a, F> {
    pub(crate) fn of<K: Kernel>(
        case: &'a Case<'_, K>,
        reference: &'a Reference,
        is_of_no_interest: F,
    ) -> Self {
        let judge = Judge::new(&case.outputs, &reference.outputs, case.steps);
        Self { judge, is_of_no_interest, is_bad: false }
    }

    /// The outputs of a run that is finished, if they meet every requirement.
    pub(crate) fn good(self) -> Option<Vec<OutputFound>> {
        let outputs = self.judge.finished();
        outputs.iter().all(|output| output.first_broken().is_none()).then_some(outputs)
    }
}

impl<R: Backend, F: Fn() -> bool> Observer<R> for UntilBad<'_, F> {
    fn ends(&mut self, step: usize, outputs: &[R]) -> ControlFlow<()> {
        self.is_bad |= self.judge.note(step, outputs.iter().map(|number| number.to_f64_pair()));
        self.is_bad |= (self.is_of_no_interest)();
        if self.is_bad { ControlFlow::Break(()) } else { ControlFlow::Continue(()) }
    }
}
