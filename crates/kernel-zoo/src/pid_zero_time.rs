//! A PID controller with measured time: `u = kₚ e + I + k_d (eₖ - eₖ₋₁)/T`, `I ← I + kᵢ e T`, and a filter, `y ← y + (u - y)/4`.
//!
//! # Source
//! Ardumower/Sunray#161: a filtered value becomes NaN after a stop, and the drives are dead. A comment thinks that a stop resets the
//! loop's time, so that T is 0 and something is divided by it; its cure is T ≥ 0.000001. The loop runs at 50 Hz.

use kernel_size::{Input, InputError, Kernel, Output, Steps, compare};
use real::Real;

use crate::report::Report;

pub(crate) const REPORT: Report = Report {
    name: "pid-zero-time",
    thread: "Ardumower/Sunray#161",
    fault: "After a stop the time step is 0, a quotient is NaN, and a filter never forgets it.",
    cure: "The time step is at least a microsecond.",
    reported_in: "f32",
    compare: |is_cured, formats| compare(&PidZeroTime { is_cured }, formats),
};

struct PidZeroTime {
    is_cured: bool,
}

/// The step of the stop.
const STOP: usize = 250;

fn error(step: usize) -> f64 {
    0.2 * (step as f64 * 0.05).sin()
}
fn period(step: usize) -> f64 {
    if step == STOP { 0.0 } else { 0.02 }
}

impl Kernel for PidZeroTime {
    fn name(&self) -> &'static str {
        REPORT.name
    }

    fn steps(&self) -> usize {
        500
    }

    /// In the step of the stop the error is still that of the step before.
    fn inputs(&self) -> Result<Vec<Input>, InputError> {
        let held = |step: usize| error(if step == STOP { step - 1 } else { step });
        Ok(vec![
            Input::generated("error", (-1.0, 1.0), self.steps(), held)?,
            Input::generated("period", (0.0, 1.0), self.steps(), period)?,
        ])
    }

    /// Without a derivative in the step of the stop.
    fn outputs(&self) -> Vec<Output> {
        let (mut last, mut integral, mut filtered) = (error(0), 0.0, 0.0);
        let course = (0..self.steps()).map(|step| {
            let error = if step == STOP { last } else { error(step) };
            integral += 0.5 * error * period(step);
            let slope = if step == STOP { 0.0 } else { (error - last) / period(step) };
            last = error;
            filtered += 0.25 * (error + integral + 0.05 * slope - filtered);
            filtered
        });
        vec![Output::named("filtered").within(0.002).truth(course.collect())]
    }

    fn run<R: Real>(&self, steps: &mut Steps<'_, R>) {
        let [by_sum, by_slope, least] = [(1, 2), (1, 20), (1, 1_000_000)].map(|(n, d)| R::from_ratio(n, d));
        let (mut last, mut integral, mut filtered) = (None, R::zero(), R::zero());
        while let Some([error, period]) = steps.begin() {
            let period = if self.is_cured { period.max(least) } else { period };
            integral = (integral + by_sum * error * period).signal("integral");
            let slope = ((error - last.unwrap_or(error)) / period).signal("slope");
            last = Some(error);
            let output = by_slope.mul_add(slope, error + integral);
            filtered = filtered + (output - filtered).ldexp(-2);
            steps.end([filtered]);
        }
    }
}
