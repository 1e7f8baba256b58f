//! The trait of a kernel.

use real::Real;

use crate::input::{Input, InputError};
use crate::output::Output;
use crate::steps::Steps;

/// A computation over any number of steps, with state between them, written once for all number formats.
///
/// State lives in the variables of [`run`](Kernel::run): what is declared before its loop is kept from step to step. Names
/// given by [`Real::signal`] are the registers that are sized and the places that an answer names. Inputs and constants
/// are signals by their own names.
pub trait Kernel: Sync {
    /// The name, in answers.
    fn name(&self) -> &'static str;

    /// Number of steps, at most 2²⁴.
    fn steps(&self) -> usize;

    /// The inputs, each with a value for each step.
    ///
    /// # Errors
    /// What the constructors of [`Input`] find.
    fn inputs(&self) -> Result<Vec<Input>, InputError>;

    /// The outputs, and what is required of them.
    fn outputs(&self) -> Vec<Output>;

    /// Runs the kernel: begins a step, computes, ends the step with the outputs, until no step is left.
    ///
    /// ```text
    /// let mut state = R::zero();
    /// while let Some([x]) = steps.begin() {
    ///     state = …;
    ///     steps.end([state]);
    /// }
    /// ```
    ///
    /// A loop within a step must end by itself: nothing can end it from outside. A panic is caught, and reported with its
    /// step.
    fn run<R: Real>(&self, steps: &mut Steps<'_, R>);
}
