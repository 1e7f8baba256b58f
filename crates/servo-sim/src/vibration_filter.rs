//! The vibration filter: a notch on the velocity command, which keeps it from exciting a resonance of the machine.
//!
//! In continuous time, with the centre ω₀ and the width b between the two frequencies that are passed by 1/√2,
//!
//! `N(s) = (s² + ω₀²) / (s² + b s + ω₀²)`.
//!
//! Sampled every h it is made by the trapezoidal rule, with the tangents chosen such that centre and width are exact
//! whatever h is. With θ = ωh,
//!
//! `N(e^(iθ)) = (cos θ - cos θ₀) / (cos θ - cos θ₀ + i tan(bh/2) sin θ)`,
//!
//! which is 0 at ω₀, 1 at rest, and 1/√2 in magnitude at two frequencies exactly b apart. Elsewhere it differs from the
//! continuous filter by `h² (b² + |ω₀² - ω²|)/24` to lowest order.

use std::f64::consts::TAU;

use nalgebra::Complex;
use real::{Backend, Real};

use crate::ServoError;
use crate::control_law::in_format;

/// Centre and width of a notch.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Notch {
    /// Centre ω₀, in rad/s.
    pub frequency: f64,
    /// Width b, in rad/s.
    pub bandwidth: f64,
}

impl Notch {
    /// A notch by its centre and width in Hz; `None` for a width of 0, which passes everything.
    #[must_use]
    pub fn of_hertz(frequency: f64, bandwidth: f64) -> Option<Self> {
        (bandwidth > 0.0).then_some(Self { frequency: TAU * frequency, bandwidth: TAU * bandwidth })
    }

    /// N(s) in continuous time.
    #[must_use]
    pub fn continuous(&self, s: Complex<f64>) -> Complex<f64> {
        let centre = self.frequency * self.frequency;
        (s * s + centre) / (s * s + s * self.bandwidth + centre)
    }

    /// N(e^(iθ)) of the filter that is run every `sub_step` (s), at the angular frequency ω (rad/s).
    #[must_use]
    pub fn sampled(&self, sub_step: f64, frequency: f64) -> Complex<f64> {
        let passed = (frequency * sub_step).cos() - (self.frequency * sub_step).cos();
        let damped = (self.bandwidth * sub_step / 2.0).tan() * (frequency * sub_step).sin();
        Complex::new(passed, 0.0) / Complex::new(passed, damped)
    }
}

/// A notch as the controller runs it, in its number format: a state-variable filter.
///
/// With `g = tan(ω₀h/2)`, `k = 2 tan(bh/2)/sin(ω₀h)`, the states p (band-pass) and q (low-pass) and the input u:
///
/// `v₁ = (p + g(u - q)) / (1 + g(g + k))`, `v₂ = q + g v₁`, `p ← 2v₁ - p`, `q ← 2v₂ - q`, `y = u - k v₁`.
///
/// At a constant velocity p is zero, so that the low frequency of the notch does not magnify the format's rounding.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct VibrationFilter<R> {
    /// 1/(1 + g(g + k)).
    band_keeps: R,
    /// g/(1 + g(g + k)).
    band_takes: R,
    /// g.
    slope: R,
    /// k.
    depth: R,
}

/// The state of the filter; zero at rest.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct FilterState<R> {
    /// Band-pass state p, in the unit of the input.
    pub band: R,
    /// Low-pass state q, in the unit of the input.
    pub low: R,
}

impl<R: Backend> VibrationFilter<R> {
    /// The filter, run every `sub_step` (s); both frequencies at most a quarter of its rate.
    ///
    /// # Errors
    /// [`ServoError::ParameterNotInFormat`] if a constant is out of the format's range or vanishes in it.
    pub fn try_new(notch: &Notch, sub_step: f64) -> Result<Self, ServoError> {
        let slope = (notch.frequency * sub_step / 2.0).tan();
        let depth = 2.0 * (notch.bandwidth * sub_step / 2.0).tan() / (notch.frequency * sub_step).sin();
        let keeps = 1.0 / (1.0 + slope * (slope + depth));
        Ok(Self {
            band_keeps: in_format("vibration filter, band-pass", keeps)?,
            band_takes: in_format("vibration filter, input", slope * keeps)?,
            slope: in_format("vibration filter, centre", slope)?,
            depth: in_format("vibration filter, width", depth)?,
        })
    }
}

impl<R: Real> VibrationFilter<R> {
    /// Takes a velocity command and returns the filtered one.
    pub fn step(&self, state: &mut FilterState<R>, input: R) -> R {
        let band = R::sum_of_products([(self.band_keeps, state.band), (self.band_takes, input - state.low)]);
        let low = self.slope.mul_add(band, state.low);
        *state = FilterState { band: band + band - state.band, low: low + low - state.low };
        input - self.depth * band
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;
    use real::I8F24;

    const H: f64 = 0.125e-3;

    /// Amplitude ratio and phase of a filter that has run a sinusoid until its start has died away.
    fn measured<R: Backend>(notch: &Notch, sub_step: f64, frequency: f64, amplitude: f64) -> Complex<f64> {
        let filter = VibrationFilter::<R>::try_new(notch, sub_step).unwrap();
        let mut state = FilterState { band: R::zero(), low: R::zero() };
        let settled = (100.0 / (notch.bandwidth * sub_step)).ceil();
        let turns = (frequency * sub_step * settled / TAU).ceil().max(50.0);
        let count = (turns * TAU / (frequency * sub_step)).round();
        // A whole number of turns in a whole number of steps.
        let theta = turns * TAU / count;
        let (mut k, mut sum) = (0.0, Complex::new(0.0, 0.0));
        while k < settled + count {
            let input = R::from_f64(amplitude * (k * theta).cos()).unwrap();
            let output = filter.step(&mut state, input).to_f64();
            if k >= settled {
                sum += Complex::new((k * theta).cos(), -(k * theta).sin()) * output;
            }
            k += 1.0;
        }
        // The exact frequency that was run differs from the one asked for by less than one part in the count.
        sum * (2.0 / (count * amplitude))
    }

    #[test]
    fn the_filter_has_the_frequency_response_of_its_closed_form() {
        let notch = Notch::of_hertz(200.0, 60.0).unwrap();
        for hertz in [20.0, 100.0, 160.0, 200.0, 250.0, 800.0] {
            // 8000 cycles a second: a whole number of turns of these in whole seconds, so nothing is shifted.
            let found = measured::<f64>(&notch, H, TAU * hertz, 1.0);
            let expected = notch.sampled(H, TAU * hertz);
            assert!((found - expected).norm() < 1e-9, "{hertz} Hz: {found} {expected}");
        }
    }

    #[test]
    fn centre_and_width_are_exact_whatever_the_sub_step() {
        let notch = Notch::of_hertz(200.0, 60.0).unwrap();
        for sub_step in [1e-3, 0.5e-3, 0.125e-3, 1e-5] {
            assert_eq!(notch.sampled(sub_step, notch.frequency).norm(), 0.0);
            assert!(measured::<f64>(&notch, sub_step, notch.frequency, 1.0).norm() < 1e-9, "{sub_step}");
            // Where the response is 1/√2: bisection on either side of the centre.
            let edge = |mut inner: f64, mut outer: f64| {
                for _ in 0..80 {
                    let middle = (inner + outer) / 2.0;
                    let is_inside = notch.sampled(sub_step, middle).norm() < 0.5_f64.sqrt();
                    *(if is_inside { &mut inner } else { &mut outer }) = middle;
                }
                inner
            };
            let width = edge(notch.frequency, TAU * 450.0) - edge(notch.frequency, 1.0);
            assert!((width / notch.bandwidth - 1.0).abs() < 1e-9, "{sub_step}: {width}");
        }
    }

    #[test]
    fn a_constant_velocity_passes_and_fixed_point_adds_little() {
        let notch = Notch::of_hertz(200.0, 60.0).unwrap();
        let filter = VibrationFilter::<I8F24>::try_new(&notch, H).unwrap();
        let mut state = FilterState::default();
        let input = I8F24::from_f64(0.0083).unwrap();
        let last = (0..20_000).map(|_| filter.step(&mut state, input)).last().unwrap();
        let off = (last - input).to_f64().abs();
        assert!(off <= 4.0 * I8F24::resolution().to_f64(), "{off}");
        let found = measured::<I8F24>(&notch, H, notch.frequency, 0.01);
        assert!(found.norm() < 1e-4, "{found}");
    }

    #[test]
    fn a_notch_without_width_is_none() {
        assert_eq!(Notch::of_hertz(200.0, 0.0), None);
    }

    proptest! {
        /// The stated error of the discretisation, to lowest order: what is left out is of relative order (θ/2)².
        #[test]
        fn the_response_depends_on_the_sub_step_by_second_order(
            centre in 20.0..900.0_f64,
            width in 5.0..400.0_f64,
            hertz in 1.0..900.0_f64,
            sub_steps in 4.0..64.0_f64,
        ) {
            let notch = Notch::of_hertz(centre, width).unwrap();
            let (h, frequency) = (1e-3 / sub_steps, TAU * hertz);
            let exact = notch.continuous(Complex::new(0.0, frequency));
            let off = (notch.sampled(h, frequency) - exact).norm();
            let squares = notch.bandwidth.powi(2) + (notch.frequency.powi(2) - frequency.powi(2)).abs();
            let highest = notch.frequency.max(frequency).max(notch.bandwidth) * h / 2.0;
            let bound = h * h * squares / 24.0 * (1.0 + highest.powi(2)) + 1e-12;
            prop_assert!(off <= bound, "{off} > {bound}");
        }
    }
}
