//! The increment of a trajectory: `Δ = v (tₖ - tₖ₋₁)`.
//!
//! # Source
//! ros-industrial/motoman#244: times become f32 on their way to the controller. After 4.6 hours they lose precision, the
//! increments are miscalculated, and a robot near its maximum velocity exceeds the limit. Here a point every 4 ms, from then on.

use kernel_size::{Input, InputError, Kernel, Output, Steps, compare};
use real::Real;

use crate::report::Report;

pub(crate) const REPORT: Report = Report {
    name: "trajectory-time",
    thread: "ros-industrial/motoman#244",
    fault: "After 4.6 hours a time in f32 no longer tells points apart, and a robot exceeds its speed limit.",
    cure: "Seconds and the part of a second are subtracted apart.",
    reported_in: "f32",
    compare: |is_cured, formats| compare(&TrajectoryTime { is_cured }, formats),
};

struct TrajectoryTime {
    is_cured: bool,
}

const START_S: usize = 16_560;

impl Kernel for TrajectoryTime {
    fn name(&self) -> &'static str {
        REPORT.name
    }

    fn steps(&self) -> usize {
        2500
    }

    fn inputs(&self) -> Result<Vec<Input>, InputError> {
        let range = (0.0, 20_000.0);
        let seconds = |step: usize| (START_S + step / 250) as f64;
        let part = |step: usize| (step % 250) as f64 * 0.004;
        Ok(vec![
            Input::generated("time", range, self.steps(), |step| seconds(step) + part(step))?,
            Input::generated("seconds", range, self.steps(), seconds)?,
            Input::generated("part", (0.0, 1.0), self.steps(), part)?,
        ])
    }

    /// In parts of the increment at full speed: 1, but for the first.
    fn outputs(&self) -> Vec<Output> {
        let truth = (0..self.steps()).map(|step| if step == 0 { 0.0 } else { 1.0 });
        vec![Output::named("increment").within(0.05).truth(truth.collect())]
    }

    fn run<R: Real>(&self, steps: &mut Steps<'_, R>) {
        let full_speed = R::from_ratio(250, 1);
        let mut last = None;
        while let Some([time, seconds, part]) = steps.begin() {
            let now = if self.is_cured { (seconds, part) } else { (time, R::zero()) };
            let before = last.unwrap_or(now);
            let passed = ((now.0 - before.0) + (now.1 - before.1)).signal("passed");
            last = Some(now);
            steps.end([full_speed * passed]);
        }
    }
}
