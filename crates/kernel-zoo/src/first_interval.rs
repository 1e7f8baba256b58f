//! The ticks of a step timer up to the first step of a frame: `first = (F/δ) r`, where F are the ticks of a frame, δ the steps
//! in it and r the part of a step that is left. Rounded down, the step after it might still fall into the frame. So where
//! `first + F/δ ≤ F`, first becomes longer by what is missing.
//!
//! # Source
//! MarlinFirmware/Marlin#28187, where a review asks what a variable of 32 bits, 5 of them after the point, does at an extremely
//! low speed: the interval F/δ then has the very highest bits. The sum is signed. It asks too for an interval that is large
//! enough to be ignored. F is 2000, a millisecond of 2 MHz, and δ is at least 2⁻¹⁶, one unit of the thread's.

use kernel_size::{Input, InputError, Kernel, Output, Steps, compare};
use real::Real;

use crate::report::Report;

pub(crate) const REPORT: Report = Report {
    name: "first-interval",
    thread: "MarlinFirmware/Marlin#28187",
    fault: "At the lowest speed the interval between two steps overflows, and the first step comes far too late.",
    cure: "An interval of many frames is taken as 2²⁵ ticks.",
    reported_in: "I27F5",
    compare: |is_cured, formats| compare(&FirstInterval { is_cured }, formats),
};

struct FirstInterval {
    is_cured: bool,
}

const FRAME: i32 = 2000;

impl Kernel for FirstInterval {
    fn name(&self) -> &'static str {
        REPORT.name
    }

    fn steps(&self) -> usize {
        7
    }

    /// In units of 2⁻¹⁶ steps: from 64 down to 1 in a frame. Half of them are left.
    fn inputs(&self) -> Result<Vec<Input>, InputError> {
        let units = |step: usize| f64::from(64 >> step);
        Ok(vec![Input::generated("units", (1.0, 64.0), self.steps(), units)?])
    }

    /// In ticks: the first step is in the middle of the frame.
    fn outputs(&self) -> Vec<Output> {
        vec![Output::named("first").within(1.0).truth(vec![f64::from(FRAME) / 2.0; self.steps()])]
    }

    fn run<R: Real>(&self, steps: &mut Steps<'_, R>) {
        let frame = R::from_ratio(FRAME, 1);
        while let Some([units]) = steps.begin() {
            let ticks = frame / units;
            let first = (ticks * units.half()).signal("first");
            let ticks = if self.is_cured { ticks.min(R::from_ratio(512, 1)) } else { ticks };
            let next = (first + ticks.ldexp(16).signal("interval")).signal("next");
            let missing = if next <= frame { frame - next + R::resolution() } else { R::zero() };
            steps.end([first + missing]);
        }
    }
}
