//! The rate of a step generator as its register holds it: steps per tick of the clock, times a power of two.
//!
//! # Source
//! Peter-van-Tol/LiteX-CNC#21: 1000 steps per mm, and above 6 m/min, say 10, the direction is inverted. The power is one too
//! large: it was to be the first by which the clock falls to 400 kHz, and must be the one before. The clock of the comment is
//! 30 MHz. The register's greatest rate is taken as half a step per divided tick: ±2 in I2F30, once the rate is times four.

use kernel_size::{Input, InputError, Kernel, Output, Steps, compare};
use real::Real;

use crate::report::Report;

pub(crate) const REPORT: Report = Report {
    name: "rate-register",
    thread: "Peter-van-Tol/LiteX-CNC#21",
    fault: "A step rate that the register cannot hold wraps, and the axis runs backwards.",
    cure: "The rate is scaled by a power of two less.",
    reported_in: "I2F30",
    compare: |is_cured, formats| compare(&RateRegister { is_cured }, formats),
};

struct RateRegister {
    is_cured: bool,
}

/// In parts of 400 kHz: from 0 up to 10 m/min in steps of 0.1.
fn rate(step: usize) -> f64 {
    step as f64 * 0.1 / 60.0 * 1e6 / 400e3
}

impl Kernel for RateRegister {
    fn name(&self) -> &'static str {
        REPORT.name
    }

    fn steps(&self) -> usize {
        101
    }

    fn inputs(&self) -> Result<Vec<Input>, InputError> {
        Ok(vec![Input::generated("rate", (0.0, 1.0), self.steps(), rate)?])
    }

    /// Steps per tick.
    fn outputs(&self) -> Vec<Output> {
        let truth = (0..self.steps()).map(|step| rate(step) * 400e3 / 30e6);
        vec![Output::named("per_tick").within(1e-6).truth(truth.collect())]
    }

    fn run<R: Real>(&self, steps: &mut Steps<'_, R>) {
        // The first power of two by which 30 MHz falls to 400 kHz, and the one before.
        let shift = if self.is_cured { 6 } else { 7 };
        while let Some([rate]) = steps.begin() {
            let per_tick = rate * R::from_ratio(400, 30_000);
            let register = per_tick.ldexp(shift + 2).signal("register");
            steps.end([register.ldexp(-shift - 2)]);
        }
    }
}
