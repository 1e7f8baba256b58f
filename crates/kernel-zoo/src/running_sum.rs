//! The mean of the last n errors by a running sum: `s ← s + eₖ - eₖ₋ₙ`.
//!
//! # Source
//! wpilibsuite/allwpilib#469: the sum in double precision gathers rounding errors, so that a controller may never see that it
//! is on target. Here a controller counts as on target when the mean is at most the resolution of its numbers.

use kernel_size::{Input, InputError, Kernel, Output, Steps, compare};
use real::Real;

use crate::report::Report;

pub(crate) const REPORT: Report = Report {
    name: "running-sum",
    thread: "wpilibsuite/allwpilib#469",
    fault: "A running sum of errors in f64 does not return to 0: a command may never end.",
    cure: "The sum is formed anew in each step.",
    reported_in: "f64",
    compare: |is_cured, formats| compare(&RunningSum { is_cured }, formats),
};

struct RunningSum {
    is_cured: bool,
}

/// Errors in the mean.
const COUNT: usize = 8;

/// From this step on the error is 0.
const SETTLED: usize = 4000;

impl Kernel for RunningSum {
    fn name(&self) -> &'static str {
        REPORT.name
    }

    fn steps(&self) -> usize {
        5000
    }

    /// Counts of an encoder: a swing that dies away far from the target, which is reached then.
    fn inputs(&self) -> Result<Vec<Input>, InputError> {
        let swing = |step: usize| (1e3 * (-(step as f64) / 700.0).exp() * (step as f64 * 0.1).cos()).round();
        let error = |step: usize| if step < SETTLED { swing(step) + 2000.0 } else { 0.0 };
        Ok(vec![Input::generated("counts", (0.0, 3100.0), self.steps(), error)?])
    }

    fn outputs(&self) -> Vec<Output> {
        let truth = (0..self.steps()).map(|step| if step < SETTLED + COUNT - 1 { 0.0 } else { 1.0 });
        vec![Output::named("on_target").exact().truth(truth.collect())]
    }

    fn run<R: Real>(&self, steps: &mut Steps<'_, R>) {
        let (mut errors, mut sum, mut place) = ([R::zero(); COUNT], R::zero(), 0);
        while let Some([counts]) = steps.begin() {
            let error = (counts * R::from_ratio(1, 10)).signal("error");
            sum = (sum + error - errors[place]).signal("sum");
            errors[place] = error;
            place = (place + 1) % COUNT;
            if self.is_cured {
                sum = errors.iter().fold(R::zero(), |sum, error| sum + *error);
            }
            let mean = sum.ldexp(-3).abs().signal("mean");
            steps.end([if mean <= R::resolution() { R::one() } else { R::zero() }]);
        }
    }
}
