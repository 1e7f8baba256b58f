//! Velocity from an angle sensor: `ω = (θₖ - θₖ₋₁)/T`, where θ counts whole turns too.
//!
//! # Source
//! simplefoc/Arduino-FOC#83: one f32 for the total angle, and motors stop after a number of turns, around 30 000 rad. The
//! difference by turns and by angle apart is that of simplefoc/Arduino-FOC#527.

use kernel_size::{Input, InputError, Kernel, Output, Steps, compare};
use real::Real;

use crate::report::Report;

pub(crate) const REPORT: Report = Report {
    name: "turns-and-angle",
    thread: "simplefoc/Arduino-FOC#83",
    fault: "From about 30 000 rad on the total angle in f32 no longer shows by how much the shaft has turned.",
    cure: "Turns and angle are subtracted apart, and then added.",
    reported_in: "f32",
    compare: |is_cured, formats| compare(&TurnsAndAngle { is_cured }, formats),
};

struct TurnsAndAngle {
    is_cured: bool,
}

/// 1 rad/s, a thousand times a second.
const START_RAD: f64 = 30_000.0;

impl Kernel for TurnsAndAngle {
    fn name(&self) -> &'static str {
        REPORT.name
    }

    fn steps(&self) -> usize {
        10_000
    }

    fn inputs(&self) -> Result<Vec<Input>, InputError> {
        let angle = |step: usize| START_RAD + step as f64 * 1e-3;
        let turn = std::f64::consts::TAU;
        Ok(vec![
            Input::generated("turns", (0.0, 5000.0), self.steps(), |step| (angle(step) / turn).floor())?,
            Input::generated("angle", (0.0, turn), self.steps(), |step| angle(step) % turn)?,
        ])
    }

    fn outputs(&self) -> Vec<Output> {
        let truth = (0..self.steps()).map(|step| if step == 0 { 0.0 } else { 1.0 });
        vec![Output::named("velocity").within(0.1).truth(truth.collect())]
    }

    fn run<R: Real>(&self, steps: &mut Steps<'_, R>) {
        let turn = steps.constant("turn", std::f64::consts::TAU);
        let rate = R::from_ratio(1000, 1);
        let mut last = None;
        while let Some([turns, angle]) = steps.begin() {
            let (last_turns, last_angle) = last.unwrap_or((turns, angle));
            let travelled = if self.is_cured {
                (turns - last_turns) * turn + (angle - last_angle)
            } else {
                let total = turns.mul_add(turn, angle).signal("total");
                total - last_turns.mul_add(turn, last_angle)
            };
            last = Some((turns, angle));
            steps.end([travelled.signal("travelled") * rate]);
        }
    }
}
