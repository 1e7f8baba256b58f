//! The steps of a move of the extruder: `n = (eₖ - eₖ₋₁) s`, with s steps per mm.
//!
//! # Source
//! Ultimaker/CuraEngine#14: with 800 steps per mm, a coordinate in f32 is rounded to 2 steps above 2²⁴/800 mm, 21 m; it
//! should be reset now and then. MarlinFirmware/Marlin#28192 resets at 1000 mm, where the resolution is about 0.00006 mm.

use kernel_size::{Input, InputError, Kernel, Output, Steps, compare};
use real::Real;

use crate::report::Report;

pub(crate) const REPORT: Report = Report {
    name: "extruder-position",
    thread: "Ultimaker/CuraEngine#14",
    fault: "Beyond 21 m of filament an f32 no longer holds single steps of the extruder.",
    cure: "The coordinate is reset after each metre.",
    reported_in: "f32",
    compare: |is_cured, formats| compare(&ExtruderPosition { is_cured }, formats),
};

struct ExtruderPosition {
    is_cured: bool,
}

impl Kernel for ExtruderPosition {
    fn name(&self) -> &'static str {
        REPORT.name
    }

    fn steps(&self) -> usize {
        4000
    }

    /// One step a move, from 21 m on; with resets, from the last half of a millimetre before one on.
    fn inputs(&self) -> Result<Vec<Input>, InputError> {
        let along = |step: usize| 20_999.5 + step as f64 / 800.0;
        let reset = |step: usize| if self.is_cured { along(step) % 1000.0 } else { along(step) };
        Ok(vec![Input::generated("e", (0.0, 22_000.0), self.steps(), reset)?])
    }

    fn outputs(&self) -> Vec<Output> {
        let truth = (0..self.steps()).map(|step| if step == 0 { 0.0 } else { 1.0 });
        vec![Output::named("steps").within(0.25).truth(truth.collect())]
    }

    fn run<R: Real>(&self, steps: &mut Steps<'_, R>) {
        let (steps_per_mm, metre) = (R::from_ratio(800, 1), R::from_ratio(1000, 1));
        let mut last = None;
        while let Some([e]) = steps.begin() {
            let mut travelled = (e - last.unwrap_or(e)).signal("travelled");
            if travelled < R::zero() {
                travelled = travelled + metre; // it was reset
            }
            last = Some(e);
            steps.end([steps_per_mm * travelled]);
        }
    }
}
