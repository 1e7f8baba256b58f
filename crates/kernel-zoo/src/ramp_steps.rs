//! The steps of a ramp up to a velocity: `n = v²/(2a)`.
//!
//! # Source
//! laurb9/StepperDriver#20: in 32-bit integers and microsteps per second it overflows at 450 rpm with 32 microsteps, and at 900
//! rpm or so with fewer; a velocity in steps per second avoids that. A turn has 200 steps, and a is 1000 steps/s² here.

use kernel_size::{Input, InputError, Kernel, Output, Steps, compare};
use real::Real;

use crate::report::Report;

pub(crate) const REPORT: Report = Report {
    name: "ramp-steps",
    thread: "laurb9/StepperDriver#20",
    fault: "The square of a velocity in microsteps per second overflows 32 bits, and a motor creeps.",
    cure: "The velocity is in steps per second.",
    reported_in: "I32F0",
    compare: |is_cured, formats| compare(&RampSteps { is_cured }, formats),
};

struct RampSteps {
    is_cured: bool,
}

impl Kernel for RampSteps {
    fn name(&self) -> &'static str {
        REPORT.name
    }

    fn steps(&self) -> usize {
        900
    }

    /// Step k is at k + 1 rpm.
    fn inputs(&self) -> Result<Vec<Input>, InputError> {
        Ok(vec![Input::generated("rpm", (0.0, 900.0), self.steps(), |step| (step + 1) as f64)?])
    }

    /// In microsteps, of 16 and of 32 to a step: to half a step, and what a velocity in whole steps per second is off by.
    fn outputs(&self) -> Vec<Output> {
        let truth = |microsteps: f64| {
            let of = move |step: usize| ((step + 1) as f64 * 200.0 / 60.0).powi(2) / 2000.0 * microsteps;
            (0..900).map(of).collect()
        };
        vec![
            Output::named("of_16").within(64.0).truth(truth(16.0)),
            Output::named("of_32").within(128.0).truth(truth(32.0)),
        ]
    }

    fn run<R: Real>(&self, steps: &mut Steps<'_, R>) {
        while let Some([rpm]) = steps.begin() {
            let of = |microsteps: i32| {
                let (unit, after) = if self.is_cured { (1, microsteps) } else { (microsteps, 1) };
                let velocity = rpm * R::from_ratio(200 * unit, 1) / R::from_ratio(60, 1);
                let velocity = velocity.signal("velocity");
                let square = (velocity * velocity).signal("square");
                square / R::from_ratio(2000 * unit, 1) * R::from_ratio(after, 1)
            };
            steps.end([of(16), of(32)]);
        }
    }
}
