//! The angle of a motor that turns without a sensor: `θ ← θ + ω T`.
//!
//! # Source
//! simplefoc/Arduino-FOC#37: at 0.5 rad/s the motor stopped after about 14 minutes, when the angle had reached 512.00.
//! There f32 has steps of 2⁻¹⁴ rad, and a sum less than half a step is lost: periods of up to 61 µs, 50 µs here.

use kernel_size::{Input, InputError, Kernel, Output, Steps, compare};
use real::Real;

use crate::report::Report;

pub(crate) const REPORT: Report = Report {
    name: "open-loop-angle",
    thread: "simplefoc/Arduino-FOC#37",
    fault: "A motor at 0.5 rad/s stops when its angle, a sum in f32, reaches 512.00 rad.",
    cure: "The angle is kept within one turn.",
    reported_in: "f32",
    compare: |is_cured, formats| compare(&OpenLoopAngle { is_cured }, formats),
};

struct OpenLoopAngle {
    is_cured: bool,
}

/// Where the run begins: 200 steps before 512 rad, and the same angle without its 81 turns.
const START: f64 = 512.0 - 200.0 * 25e-6;

impl Kernel for OpenLoopAngle {
    fn name(&self) -> &'static str {
        REPORT.name
    }

    fn steps(&self) -> usize {
        2000
    }

    fn inputs(&self) -> Result<Vec<Input>, InputError> {
        Ok(vec![Input::generated("velocity", (0.0, 1.0), self.steps(), |_| 0.5)?])
    }

    fn outputs(&self) -> Vec<Output> {
        vec![Output::named("angle").within(0.005)]
    }

    fn run<R: Real>(&self, steps: &mut Steps<'_, R>) {
        let turn = std::f64::consts::TAU;
        let period = R::from_ratio(1, 20_000);
        let mut angle = steps.constant("start", if self.is_cured { START % turn } else { START });
        let turn = steps.constant("turn", turn);
        while let Some([velocity]) = steps.begin() {
            angle = velocity.mul_add(period, angle).signal("angle");
            if self.is_cured && angle >= turn {
                angle = angle - turn;
            }
            steps.end([angle]);
        }
    }
}
