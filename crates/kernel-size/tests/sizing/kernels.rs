//! Kernels that tests run.

use kernel_size::{Input, InputError, Kernel, Output, Steps};
use real::Real;

/// A kernel of one input, which a test draws, and of one output.
pub(crate) struct One<F> {
    pub(crate) steps: usize,
    pub(crate) range: (f64, f64),
    pub(crate) output: Output,
    pub(crate) what: F,
}

/// What the kernel does with its steps.
pub(crate) trait What: Sync {
    fn run<R: Real>(&self, steps: &mut Steps<'_, R>);
}

impl<F: What> Kernel for One<F> {
    fn name(&self) -> &'static str {
        "one"
    }
    fn steps(&self) -> usize {
        self.steps
    }
    fn inputs(&self) -> Result<Vec<Input>, InputError> {
        Ok(vec![Input::drawn("x", 5, self.range, self.steps)?])
    }
    fn outputs(&self) -> Vec<Output> {
        vec![self.output.clone()]
    }
    fn run<R: Real>(&self, steps: &mut Steps<'_, R>) {
        self.what.run(steps);
    }
}

/// A kernel of one output.
pub(crate) fn one<F: What>(what: F, steps: usize, range: (f64, f64), output: Output) -> One<F> {
    One { steps, range, output, what }
}

/// A second-order filter, with its poles at the part 0.9 of the unit circle.
pub(crate) struct Biquad;

impl What for Biquad {
    fn run<R: Real>(&self, steps: &mut Steps<'_, R>) {
        let [a1, a2, b] = [("a1", 1.6), ("a2", -0.81), ("b", 0.07)].map(|(name, x)| steps.constant(name, x));
        let (mut before, mut last) = (R::zero(), R::zero());
        while let Some([x]) = steps.begin() {
            let now = R::sum_of_products([(b, x), (a1, last), (a2, before)]).signal("y");
            (before, last) = (last, now);
            steps.end([now]);
        }
    }
}

/// The sum of its inputs: it outgrows formats with few integer bits only after a while.
pub(crate) struct Sum;

impl What for Sum {
    fn run<R: Real>(&self, steps: &mut Steps<'_, R>) {
        let mut sum = R::zero();
        while let Some([x]) = steps.begin() {
            sum = (sum + x * R::from_ratio(1, 3)).signal("sum");
            steps.end([sum]);
        }
    }
}

/// Root, quotient and norm.
pub(crate) struct Roots;

impl What for Roots {
    fn run<R: Real>(&self, steps: &mut Steps<'_, R>) {
        while let Some([x]) = steps.begin() {
            let length = R::norm(&[x, R::one()]).signal("length");
            let root = (length + x.abs()).sqrt().signal("root");
            steps.end([(root / length).half()]);
        }
    }
}

/// The least input so far, which begins with the greatest number of the format.
pub(crate) struct Least;

impl What for Least {
    fn run<R: Real>(&self, steps: &mut Steps<'_, R>) {
        let mut least = R::max_value();
        while let Some([x]) = steps.begin() {
            least = least.min(x).signal("least");
            steps.end([least]);
        }
    }
}

/// Its quotients reach 8, which the format with one integer bit fewer holds but for less than its last digit.
pub(crate) struct Edge;

impl What for Edge {
    fn run<R: Real>(&self, steps: &mut Steps<'_, R>) {
        while let Some([_]) = steps.begin() {
            steps.end([R::from_ratio(4, 1) / R::from_ratio(1001, 2000)]);
        }
    }
}
