//! The steps of a run, as a kernel sees them.

use real::Real;

/// The steps of a run: what a kernel takes its inputs from, and gives its outputs to.
pub struct Steps<'a, R> {
    port: &'a mut (dyn Port<R> + 'a),
}

/// The side of a run that a kernel does not see.
pub(crate) trait Port<R> {
    /// A constant in this format.
    fn constant(&mut self, name: &'static str, value: f64) -> R;

    /// Begins a step and fills in its inputs; false if there is none left.
    fn begin(&mut self, inputs: &mut [R]) -> bool;

    /// Ends the step.
    fn end(&mut self, outputs: &[R]);
}

impl<'a, R: Real> Steps<'a, R> {
    pub(crate) fn new(port: &'a mut (dyn Port<R> + 'a)) -> Self {
        Self { port }
    }

    /// The constant nearest to `value`. It is a signal of this name: its register is sized too. A value that does not fit
    /// the format ends the run in it.
    pub fn constant(&mut self, name: &'static str, value: f64) -> R {
        self.port.constant(name, value)
    }

    /// Begins the next step: its inputs, in the order of [`Kernel::inputs`](crate::Kernel::inputs). `None` after the last
    /// step, or when nothing more is to be learnt from the run.
    #[inline]
    pub fn begin<const N: usize>(&mut self) -> Option<[R; N]> {
        let mut inputs = [R::zero(); N];
        self.port.begin(&mut inputs).then_some(inputs)
    }

    /// Ends the step with its outputs, in the order of [`Kernel::outputs`](crate::Kernel::outputs).
    #[inline]
    pub fn end<const N: usize>(&mut self, outputs: [R; N]) {
        self.port.end(&outputs);
    }
}
