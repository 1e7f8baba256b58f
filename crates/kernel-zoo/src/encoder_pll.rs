//! A tracking loop behind an encoder: `p ← p + T v`, `δ = count - p`, `p ← p + T kₚ δ`, `v ← v + T kᵢ δ`.
//!
//! # Source
//! odriverobotics/ODrive#37: the loop holds the count in a float, which has problems after only a few million counts; the
//! position should be an integer and a fraction. Here at 8 kHz and a bandwidth of 100/s, kₚ = 200/s and kᵢ = kₚ²/4.

use kernel_size::{Input, InputError, Kernel, Output, Steps, compare};
use real::Real;

use crate::report::Report;

pub(crate) const REPORT: Report = Report {
    name: "encoder-pll",
    thread: "odriverobotics/ODrive#37",
    fault: "A tracking loop that holds the encoder's count in f32 fails after a few million counts.",
    cure: "The position is a whole count and a fraction.",
    reported_in: "f32",
    compare: |is_cured, formats| compare(&EncoderPll { is_cured }, formats),
};

struct EncoderPll {
    is_cured: bool,
}

const START: f64 = 5e6;

impl Kernel for EncoderPll {
    fn name(&self) -> &'static str {
        REPORT.name
    }

    fn steps(&self) -> usize {
        8000
    }

    /// 1000 counts a second.
    fn inputs(&self) -> Result<Vec<Input>, InputError> {
        let count = |step: usize| START + (step as f64 / 8.0).floor();
        Ok(vec![Input::generated("count", (0.0, 2e7), self.steps(), count)?])
    }

    fn outputs(&self) -> Vec<Output> {
        vec![Output::named("velocity").within(5.0)]
    }

    fn run<R: Real>(&self, steps: &mut Steps<'_, R>) {
        let [by_position, by_velocity] = [(200, 8000), (10_000, 8000)].map(|(n, d)| R::from_ratio(n, d));
        let mut whole = steps.constant("start", START);
        let (mut part, mut velocity) = (R::zero(), R::zero());
        while let Some([count]) = steps.begin() {
            let travelled = velocity * R::from_ratio(1, 8000);
            if self.is_cured {
                part = (part + travelled).signal("part");
                while part >= R::one() {
                    (whole, part) = (whole + R::one(), part - R::one());
                }
            } else {
                whole = (whole + travelled).signal("position");
            }
            let off = ((count - whole) - part).signal("off");
            let corrected = by_position * off;
            if self.is_cured {
                part = part + corrected
            } else {
                whole = whole + corrected
            }
            velocity = by_velocity.mul_add(off, velocity).signal("velocity");
            steps.end([velocity]);
        }
    }
}
