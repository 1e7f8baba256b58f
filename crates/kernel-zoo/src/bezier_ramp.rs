//! A ramp along a Bézier curve: `v = V (6x⁵ - 15x⁴ + 10x³)` with `x = t r`, where r is the reciprocal of the ramp's time.
//!
//! # Source
//! MarlinFirmware/Marlin#12491: r is 2²⁴ over the time in ticks, as an integer. For 1970000 ticks it is 8 and not 8.52, so that
//! the curve is computed for 2097152 ticks, and the velocity jumps where the ramp ends.

use kernel_size::{Input, InputError, Kernel, Output, Steps, compare};
use real::Real;

use crate::report::Report;

pub(crate) const REPORT: Report = Report {
    name: "bezier-ramp",
    thread: "MarlinFirmware/Marlin#12491",
    fault: "The reciprocal of a ramp's time is cut to an integer, and the velocity jumps at the ramp's end.",
    cure: "The time is divided by the ramp's time.",
    reported_in: "I32F32",
    compare: |is_cured, formats| compare(&BezierRamp { is_cured }, formats),
};

struct BezierRamp {
    is_cured: bool,
}

const TICKS: f64 = 1_970_000.0;

/// `⌊x⌋` for x from 0 to 2³²: a phase has the 32 bits of its integer part first.
fn floor<R: Real>(x: R) -> R {
    R::from_phase(x.to_phase(-32) & !0xffff_ffff, 32)
}

impl Kernel for BezierRamp {
    fn name(&self) -> &'static str {
        REPORT.name
    }

    fn steps(&self) -> usize {
        1001
    }

    fn inputs(&self) -> Result<Vec<Input>, InputError> {
        let ticks = |step: usize| step as f64 * (TICKS / 1000.0);
        Ok(vec![Input::generated("ticks", (0.0, TICKS), self.steps(), ticks)?])
    }

    /// In parts of the velocity at the end.
    fn outputs(&self) -> Vec<Output> {
        let x = |step: usize| step as f64 / 1000.0;
        let truth = |step: usize| x(step).powi(3) * (10.0 + x(step) * (6.0 * x(step) - 15.0));
        vec![Output::named("velocity").within(1e-3).truth((0..self.steps()).map(truth).collect())]
    }

    fn run<R: Real>(&self, steps: &mut Steps<'_, R>) {
        let [six, ten, fifteen] = [6, 10, 15].map(|n| R::from_ratio(n, 1));
        let ramp = steps.constant("ramp", TICKS);
        let reciprocal = floor(R::from_ratio(1 << 24, 1) / ramp).signal("reciprocal");
        while let Some([ticks]) = steps.begin() {
            let x = if self.is_cured { ticks / ramp } else { (ticks * reciprocal).ldexp(-24) }.signal("x");
            let in_x = x.mul_add(six, -fifteen).mul_add(x, ten);
            steps.end([(x * x * x * in_x).signal("velocity")]);
        }
    }
}
