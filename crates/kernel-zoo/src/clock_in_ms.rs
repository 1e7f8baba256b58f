//! The time between two calls: `dt = nowₖ - nowₖ₋₁`.
//!
//! # Source
//! microsoft/AirSim#929: the clock's milliseconds since 1970 are cast to f32 and then subtracted. 1522772381699, …696 and …702
//! all become 1522772344832, so that dt is 0 and the integral and derivative parts of a controller are not applied.

use kernel_size::{Input, InputError, Kernel, Output, Steps, compare};
use real::Real;

use crate::report::Report;

pub(crate) const REPORT: Report = Report {
    name: "clock-in-ms",
    thread: "microsoft/AirSim#929",
    fault: "Milliseconds since 1970 become f32 before they are subtracted: a controller's time step is 0.",
    cure: "The clock counts from the start of the program.",
    reported_in: "f32",
    compare: |is_cured, formats| compare(&ClockInMs { is_cured }, formats),
};

struct ClockInMs {
    is_cured: bool,
}

const START_MS: f64 = 1_522_772_381_696.0;

impl Kernel for ClockInMs {
    fn name(&self) -> &'static str {
        REPORT.name
    }

    /// A minute.
    fn steps(&self) -> usize {
        20_000
    }

    fn inputs(&self) -> Result<Vec<Input>, InputError> {
        let zero = if self.is_cured { START_MS } else { 0.0 };
        let clock = |step: usize| START_MS - zero + 3.0 * step as f64;
        Ok(vec![Input::generated("clock", (0.0, 2e12), self.steps(), clock)?])
    }

    fn outputs(&self) -> Vec<Output> {
        let truth = (0..self.steps()).map(|step| if step == 0 { 0.0 } else { 3.0 });
        vec![Output::named("dt").exact().truth(truth.collect())]
    }

    fn run<R: Real>(&self, steps: &mut Steps<'_, R>) {
        let mut last = None;
        while let Some([now]) = steps.begin() {
            let dt = (now - last.unwrap_or(now)).signal("dt");
            last = Some(now);
            steps.end([dt]);
        }
    }
}
