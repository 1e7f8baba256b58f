//! A task that is to run every 10 ms: once the clock has reached `next`, it runs, and `next = now + 10`.
//!
//! # Source
//! bitcraze/crazyflie-firmware#1301: `next` is a float. Beyond tick 0x2000000 the interval becomes too short, and a warning says
//! that the rate is around 125 Hz, after 9 hours and 20 minutes. There f32 has steps of 4 ms, and 10 becomes 8.

use kernel_size::{Input, InputError, Kernel, Output, Steps, compare};
use real::Real;

use crate::report::Report;

pub(crate) const REPORT: Report = Report {
    name: "tick-schedule",
    thread: "bitcraze/crazyflie-firmware#1301",
    fault: "Beyond tick 0x2000000 a task of 100 Hz, whose next tick is an f32, runs at 125 Hz.",
    cure: "The ticks since the last run are counted.",
    reported_in: "f32",
    compare: |is_cured, formats| compare(&TickSchedule { is_cured }, formats),
};

struct TickSchedule {
    is_cured: bool,
}

const START: f64 = 0x200_0000 as f64;

impl Kernel for TickSchedule {
    fn name(&self) -> &'static str {
        REPORT.name
    }

    /// A second.
    fn steps(&self) -> usize {
        1000
    }

    fn inputs(&self) -> Result<Vec<Input>, InputError> {
        Ok(vec![Input::generated("tick", (0.0, 1e8), self.steps(), |step| START + step as f64)?])
    }

    /// The first run is at once.
    fn outputs(&self) -> Vec<Output> {
        let truth = (0..self.steps()).map(|step| (1 + step / 10) as f64);
        vec![Output::named("runs").within(1.0).truth(truth.collect())]
    }

    fn run<R: Real>(&self, steps: &mut Steps<'_, R>) {
        let interval = R::from_ratio(10, 1);
        let (mut next, mut passed, mut runs) = (R::zero(), interval, R::zero());
        while let Some([tick]) = steps.begin() {
            let is_due = if self.is_cured { passed >= interval } else { tick >= next };
            if is_due {
                next = (tick + interval).signal("next");
                passed = R::zero();
                runs = runs + R::one();
            }
            passed = passed + R::one();
            steps.end([runs]);
        }
    }
}
