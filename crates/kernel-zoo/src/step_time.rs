//! The time of a motor's last step before it stands: a root of `p(t) = target` by false position.
//!
//! `p(t) = (1 + ε) x (2 - x)` in steps, with x = t/T, comes to rest at 1 + ε. The step is due at
//! `t = T (1 - √(ε/(1 + ε)))`. The less is left beyond it, the flatter the curve is there. False position keeps the end of
//! its bracket that is on the steep side, so its guesses creep.
//!
//! # Source
//! Klipper3d/klipper#3142: the search for step times does not hang, but now and then takes 1.6 s in place of 2 ms. The
//! thread shows no move, so ε is ours: 10⁻ᵏ in step k. The cure is that of #3362, a secant that falls back on halving.

use kernel_size::{Input, InputError, Kernel, Output, Steps, compare};
use real::Real;

use crate::report::Report;

pub(crate) const REPORT: Report = Report {
    name: "step-time",
    thread: "Klipper3d/klipper#3142",
    fault: "The search for the time of a step just before a stop takes thousands of guesses.",
    cure: "A guess that does not halve the bracket is followed by one in its middle.",
    reported_in: "f64",
    compare: |is_cured, formats| compare(&StepTime { is_cured }, formats),
};

struct StepTime {
    is_cured: bool,
}

/// Guesses are made no more.
const MOST: usize = 2000;

fn beyond(step: usize) -> f64 {
    0.1_f64.powi(i32::try_from(step).unwrap_or(i32::MAX))
}

impl Kernel for StepTime {
    fn name(&self) -> &'static str {
        REPORT.name
    }

    fn steps(&self) -> usize {
        8
    }

    fn inputs(&self) -> Result<Vec<Input>, InputError> {
        Ok(vec![Input::generated("beyond", (0.0, 1.0), self.steps(), beyond)?])
    }

    /// At most 40 guesses, and the time to 10⁻⁵ of T.
    fn outputs(&self) -> Vec<Output> {
        let time = |step: usize| 1.0 - (beyond(step) / (1.0 + beyond(step))).sqrt();
        vec![
            Output::named("guesses").within(40.0).truth(vec![0.0; self.steps()]),
            Output::named("time").within(1e-5).truth((0..self.steps()).map(time).collect()),
        ]
    }

    fn run<R: Real>(&self, steps: &mut Steps<'_, R>) {
        let close = R::from_ratio(1, 1 << 30);
        while let Some([beyond]) = steps.begin() {
            let error = |x: R| (R::one() + beyond) * x * (R::from_ratio(2, 1) - x) - R::one();
            let (mut low, mut high) = ((R::zero(), -R::one()), (R::one(), beyond));
            let (mut guesses, mut is_slow) = (0, false);
            let mut here = high;
            while guesses < MOST && here.1.abs() > close {
                let width = high.0 - low.0;
                let by = if is_slow { width.half() } else { -low.1 * (width / (high.1 - low.1)) };
                let time = (low.0 + by).signal("time");
                here = (time, error(time).signal("error"));
                *(if here.1 < R::zero() { &mut low } else { &mut high }) = here;
                is_slow = self.is_cured && high.0 - low.0 > width.half();
                guesses += 1;
            }
            steps.end([R::from_ratio(i32::try_from(guesses).unwrap_or(i32::MAX), 1), here.0]);
        }
    }
}
