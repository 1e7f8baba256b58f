//! A low-pass filter of second order behind a current sensor.
//!
//! `yₖ = b₀ xₖ + b₁ xₖ₋₁ + b₂ xₖ₋₂ - a₁ yₖ₋₁ - a₂ yₖ₋₂`, with the coefficients of R. Bristow-Johnson's "Cookbook formulae for audio
//! equalizer biquad filter coefficients": 10 kHz, a corner at 400 Hz, Q = 1/√2.

use kernel_size::{Input, InputError, Kernel, Output, Steps};
use real::Real;

/// The filter.
pub struct Biquad;

impl Kernel for Biquad {
    fn name(&self) -> &'static str {
        "biquad"
    }

    fn steps(&self) -> usize {
        10_000
    }

    /// In parts of the sensor's range: half a second of a current that swings, and another of noise.
    fn inputs(&self) -> Result<Vec<Input>, InputError> {
        let swing = |step: usize| 0.6 * (step as f64 * 0.01).sin();
        let noise = Input::drawn("noise", 1, (-0.4, 0.4), self.steps())?;
        let current = |step: usize| swing(step) + noise.values()[step];
        Ok(vec![Input::generated("current", (-1.0, 1.0), self.steps(), current)?])
    }

    /// Half a unit of a converter of 12 bits.
    fn outputs(&self) -> Vec<Output> {
        vec![Output::named("filtered").within(0.5 / 2048.0).drift(1e-5)]
    }

    fn run<R: Real>(&self, steps: &mut Steps<'_, R>) {
        let angle = std::f64::consts::TAU * 400.0 / 10_000.0;
        let (alpha, cosine) = (angle.sin() / 2.0_f64.sqrt(), angle.cos());
        let of = |value: f64| value / (1.0 + alpha);
        let b0 = steps.constant("b0", of((1.0 - cosine) / 2.0));
        let [a1, a2] = [("a1", of(-2.0 * cosine)), ("a2", of(1.0 - alpha))]
            .map(|(name, value)| steps.constant(name, value));
        let (mut x, mut y) = ([R::zero(); 2], [R::zero(); 2]);
        while let Some([current]) = steps.begin() {
            let products = [(b0, current), (b0 + b0, x[0]), (b0, x[1]), (-a1, y[0]), (-a2, y[1])];
            let filtered = R::sum_of_products(products).signal("filtered");
            (x, y) = ([current, x[0]], [filtered, y[0]]);
            steps.end([filtered]);
        }
    }
}
