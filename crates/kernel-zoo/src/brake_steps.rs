//! The steps of a ramp down from a velocity, from those of the ramp up: `n = c a/d`, where `c = m (v²/(2a))`.
//!
//! # Source
//! laurb9/StepperDriver#138: in 32-bit integers c a overflows. At 2400 rpm with m = 128 microsteps, n is -1989672, and the motor
//! never brakes. At 6 rpm with a = 32000 steps/s², c is cut to 0 and with it n, where d = 100 takes 2 full steps. The cure is
//! n = m (v²/(2d)). A turn has 200 steps, and the ramp of the thread's first case is taken as a = 1000 steps/s².

use kernel_size::{Input, InputError, Kernel, Output, Steps, compare};
use real::Real;

use crate::report::Report;

pub(crate) const REPORT: Report = Report {
    name: "brake-steps",
    thread: "laurb9/StepperDriver#138",
    fault: "A count of steps is first cut to an integer and then multiplied beyond 32 bits: a motor never brakes, or at once.",
    cure: "The steps of the ramp down are computed from the velocity.",
    reported_in: "I32F0",
    compare: |is_cured, formats| compare(&BrakeSteps { is_cured }, formats),
};

struct BrakeSteps {
    is_cured: bool,
}

const MICROSTEPS: i32 = 128;
const DECELERATION: i32 = 100;

impl Kernel for BrakeSteps {
    fn name(&self) -> &'static str {
        REPORT.name
    }

    fn steps(&self) -> usize {
        400
    }

    /// Step k is at 6 (k + 1) rpm, where a velocity is a whole number of steps per second.
    fn inputs(&self) -> Result<Vec<Input>, InputError> {
        Ok(vec![Input::generated("rpm", (0.0, 2400.0), self.steps(), |step| 6.0 * (step + 1) as f64)?])
    }

    /// In microsteps, after a gentle and after a sharp ramp up: to a full step.
    fn outputs(&self) -> Vec<Output> {
        let right = |step: usize| {
            f64::from(MICROSTEPS) * (20.0 * (step + 1) as f64).powi(2) / f64::from(2 * DECELERATION)
        };
        let truth: Vec<f64> = (0..self.steps()).map(right).collect();
        ["after_1000", "after_32000"]
            .map(|name| Output::named(name).within(128.0).truth(truth.clone()))
            .into()
    }

    fn run<R: Real>(&self, steps: &mut Steps<'_, R>) {
        let whole = |number: i32| R::from_ratio(number, 1);
        while let Some([rpm]) = steps.begin() {
            let velocity = rpm * whole(200) / whole(60);
            let square = (velocity * velocity).signal("square");
            let ramp = |acceleration: i32| whole(MICROSTEPS) * (square / whole(2 * acceleration));
            let brake = |acceleration: i32| {
                if self.is_cured {
                    return ramp(DECELERATION);
                }
                let up = ramp(acceleration).signal("up");
                (up * whole(acceleration)).signal("product") / whole(DECELERATION)
            };
            steps.end([brake(1000), brake(32_000)]);
        }
    }
}
