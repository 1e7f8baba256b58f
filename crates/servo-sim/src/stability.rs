//! The stability of the sampled position loop, and the effect of sampling on it.
//!
//! In continuous time the error of the loop without input obeys `x'' τ + x' + Kp x = 0`: it is stable for every gain,
//! and free of overshoot up to `Kp = 1/(4τ)`. Closed every h, with the control law's extrapolation, the loop is a
//! linear map of (x_k, h·v_k, x_{k-1}). With k = Kp h, e = exp(-h/τ), p = τ(1 - e)/h and the held command
//! `h v_c = -k (3x_k - x_{k-1})/2`:
//!
//! `x_{k+1} = x_k + p h v_k + (1 - p) h v_c`, `h v_{k+1} = e h v_k + (1 - e) h v_c`.
//!
//! A vibration filter has two states more, and a
//! current loop that lags one; in continuous time such a loop is stable up to `Kp = 1/τᵢ`.
//!
//! The loop is stable while every eigenvalue of that matrix is less than 1 in magnitude.

use nalgebra::{Complex, Matrix3, SMatrix};

use crate::{Drive, FilterState, MotorState, Notch, ServoError, VibrationFilter};

/// A position loop that is closed every `sub_step`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SampledLoop {
    /// Position gain Kp, in 1/s.
    pub position_gain: f64,
    /// Lag τ of the velocity loop, in s.
    pub lag: f64,
    /// Time h between two cycles, in s.
    pub sub_step: f64,
    /// The vibration filter on the velocity command.
    pub vibration_filter: Option<Notch>,
    /// Lag τᵢ of the current loop, in s; 0 for none.
    pub current_lag: f64,
}

impl SampledLoop {
    /// A loop of a gain Kp (1/s), a lag τ (s) and nothing else, closed every h (s).
    #[must_use]
    pub fn new(position_gain: f64, lag: f64, sub_step: f64) -> Self {
        Self { position_gain, lag, sub_step, vibration_filter: None, current_lag: 0.0 }
    }

    /// The factor by which an error grows or decays from one sub-step to the next, in the long run: the largest
    /// magnitude of the eigenvalues. Infinite if a parameter is not a finite number above 0.
    #[must_use]
    pub fn spectral_radius(&self) -> f64 {
        let magnitude = |z: &Complex<f64>| z.re.hypot(z.im);
        if self.vibration_filter.is_some() || self.current_lag != 0.0 {
            let system = self.system_with_all();
            if !system.iter().all(|x| x.is_finite()) {
                return f64::INFINITY;
            }
            return system.complex_eigenvalues().iter().map(magnitude).fold(0.0, f64::max);
        }
        let system = self.system();
        if !system.iter().all(|x| x.is_finite()) {
            return f64::INFINITY;
        }
        system.complex_eigenvalues().iter().map(magnitude).fold(0.0, f64::max)
    }

    /// Damping ratio ζ = 1/(2√(Kp τ)) of the continuous loop; below 1 it overshoots.
    #[must_use]
    pub fn damping_ratio(&self) -> f64 {
        0.5 / (self.position_gain * self.lag).sqrt()
    }

    /// The gain Kp at which the loop begins to oscillate, in 1/s, to a relative error of 1e-9.
    #[must_use]
    pub fn largest_position_gain(&self) -> f64 {
        let unstable = |position_gain: f64| Self { position_gain, ..*self }.spectral_radius() >= 1.0;
        let mut high = 1.0 / self.sub_step;
        // k = Kp h is at most of the order of 1 + τ/h. The bound of the loop is only needed if a parameter is NaN.
        for _ in 0..1000 {
            if unstable(high) {
                break;
            }
            high *= 2.0;
        }
        let mut low = 0.0;
        for _ in 0..60 {
            let middle = low + (high - low) / 2.0;
            if unstable(middle) {
                high = middle;
            } else {
                low = middle;
            }
        }
        low
    }

    /// Sub-steps in which an error decays to e⁻²⁰ of what it was; at most 1e6.
    pub(crate) fn settling_sub_steps(&self) -> f64 {
        (-20.0 / self.spectral_radius().ln()).clamp(1.0, 1e6)
    }

    /// Refuses a loop that is not stable.
    ///
    /// # Errors
    /// [`ServoError::Unstable`], with the gain that would just be stable.
    pub fn validate(&self) -> Result<(), ServoError> {
        let spectral_radius = self.spectral_radius();
        if spectral_radius < 1.0 {
            return Ok(());
        }
        Err(ServoError::Unstable {
            position_gain_per_s: self.position_gain,
            largest_gain_per_s: self.largest_position_gain(),
            spectral_radius,
            sub_step_ms: self.sub_step * 1000.0,
        })
    }

    fn system(&self) -> Matrix3<f64> {
        let PerSubStep { gain: k, decay: e, path: p } = self.per_sub_step();
        let (now, before) = (-1.5 * k, 0.5 * k);
        Matrix3::new(
            1.0 + (1.0 - p) * now,
            p,
            (1.0 - p) * before, //
            (1.0 - e) * now,
            e,
            (1.0 - e) * before, //
            1.0,
            0.0,
            0.0,
        )
    }

    /// The map of (x, h v, h² a, x_before, p, q), with the pull a above a lagging current loop and the states p and q of
    /// the vibration filter: its columns are the images of the unit vectors.
    fn system_with_all(&self) -> SMatrix<f64, 6, 6> {
        let gain = self.position_gain * self.sub_step;
        let filter =
            self.vibration_filter.map(|notch| VibrationFilter::<f64>::try_new(&notch, self.sub_step));
        let mut columns = SMatrix::<f64, 6, 6>::identity();
        for mut column in columns.column_iter_mut() {
            let [x, v, a, before, band, low] = core::array::from_fn(|row| column[row]);
            let mut state = FilterState { band, low };
            let command = -gain * (3.0 * x - before) / 2.0;
            let command = match &filter {
                Some(Ok(filter)) => filter.step(&mut state, command),
                Some(Err(_)) => f64::NAN,
                None => command,
            };
            let [next, velocity, pull] = self.drive([x, v, a], command);
            // States that nothing has are forgotten, for kept they would count as an error that stays.
            let pull = if self.current_lag > 0.0 { pull } else { 0.0 };
            let [band, low] = if filter.is_some() { [state.band, state.low] } else { [0.0; 2] };
            column.copy_from_slice(&[next, velocity, pull, x, band, low]);
        }
        columns
    }

    /// (x, h v, h² a) a sub-step later under the command `h v_c`, without friction and limit.
    pub(crate) fn drive(&self, [x, v, a]: [f64; 3], command: f64) -> [f64; 3] {
        let h = self.sub_step;
        let drive = Drive {
            lag: self.lag,
            current_lag: self.current_lag,
            acceleration_limit: f64::INFINITY,
            friction: 0.0,
        };
        let motor = MotorState { position: x, velocity: v / h, pull: a / (h * h) };
        let moved = drive.advance(motor, command / h, h);
        [moved.position, moved.velocity * h, moved.pull * h * h]
    }

    pub(crate) fn per_sub_step(&self) -> PerSubStep {
        let ratio = self.sub_step / self.lag;
        PerSubStep {
            gain: self.position_gain * self.sub_step,
            decay: (-ratio).exp(),
            path: -(-ratio).exp_m1() / ratio,
        }
    }
}

/// A loop with the sub-step as the unit of time.
pub(crate) struct PerSubStep {
    /// k = Kp h.
    pub(crate) gain: f64,
    /// e = exp(-h/τ): the part of the velocity error that remains after a sub-step.
    pub(crate) decay: f64,
    /// p = τ(1 - e)/h: the distance that a velocity of 1 travels while it decays.
    pub(crate) path: f64,
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    fn fitted(sub_step: f64) -> SampledLoop {
        SampledLoop::new(50.7, 0.39e-3, sub_step)
    }

    #[test]
    fn a_short_lag_leaves_the_limit_of_extrapolation() {
        // τ → 0: z³ - z² + k(3z² - z)/2 = 0, and at z = -1: -2 + 2k = 0, so Kp h = 1; a lag adds 2τ/h to that.
        let limit = SampledLoop::new(1.0, 1e-9, 1e-3).largest_position_gain();
        assert!((limit - 1000.0 * (1.0 + 2e-6)).abs() < 1e-6, "{limit}");
    }

    #[test]
    fn a_short_sub_step_decays_as_the_continuous_loop() {
        // The slow root of τs² + s + Kp = 0.
        let slow = (-1.0 + (1.0_f64 - 4.0 * 50.7 * 0.39e-3).sqrt()) / (2.0 * 0.39e-3);
        let sampled = fitted(1e-5);
        let found = sampled.spectral_radius().ln() / 1e-5;
        assert!((found / slow - 1.0).abs() < 1e-6, "{found} {slow}");
        assert!((sampled.damping_ratio() - 3.5557).abs() < 1e-3);
    }

    #[test]
    fn a_gain_beyond_the_limit_is_refused_and_the_limit_named() {
        let limit = fitted(1e-3).largest_position_gain();
        let at = |factor: f64| SampledLoop { position_gain: factor * limit, ..fitted(1e-3) };
        assert_eq!(at(0.999).validate(), Ok(()));
        let message = at(1.001).validate().unwrap_err().to_string();
        assert!(message.contains("is unstable") && message.contains(&format!("{limit:.1} 1/s")), "{message}");
    }

    #[test]
    fn parameters_that_are_no_numbers_are_unstable() {
        for gain in [f64::NAN, f64::INFINITY] {
            let no_loop = SampledLoop { position_gain: gain, ..fitted(1e-3) };
            assert!(no_loop.validate().is_err());
        }
    }

    /// A short sub-step leaves the continuous loop `s(1 + τs)(s² + bs + ω₀²) + Kp(s² + ω₀²) = 0`, whose limit is
    /// Routh's. In powers of s: τ, 1 + τb, b + τω₀² + Kp, ω₀², Kp ω₀².
    #[test]
    fn a_vibration_filter_lowers_the_limit_to_that_of_the_continuous_loop() {
        let (lag, notch) = (2e-3, Notch::of_hertz(60.0, 40.0).unwrap());
        let (b, c) = (notch.bandwidth, notch.frequency.powi(2));
        let is_stable = |gain: f64| {
            let [a4, a3, a2, a1, a0] = [lag, 1.0 + lag * b, b + lag * c + gain, c, gain * c];
            let b1 = a2 - a4 * a1 / a3;
            b1 > 0.0 && a1 - a3 * a0 / b1 > 0.0
        };
        let (mut low, mut high) = (0.0, 1e5);
        for _ in 0..100 {
            let middle = (low + high) / 2.0;
            *(if is_stable(middle) { &mut low } else { &mut high }) = middle;
        }
        let sampled = SampledLoop { vibration_filter: Some(notch), ..SampledLoop::new(1.0, lag, 1e-5) };
        let found = sampled.largest_position_gain();
        assert!((found / low - 1.0).abs() < 1e-3, "{found} {low}");
        assert!(found < 0.5 * SampledLoop::new(1.0, lag, 1e-5).largest_position_gain());
    }

    /// `τ τᵢ s³ + τ s² + s + Kp`: Routh's condition is `Kp < 1/τᵢ`, whatever τ is.
    #[test]
    fn a_current_lag_lowers_the_limit_to_one_over_it() {
        for (lag, current_lag) in [(0.39e-3, 0.2e-3), (2e-3, 0.5e-3), (1e-3, 1e-3)] {
            let sampled = SampledLoop { current_lag, ..SampledLoop::new(1.0, lag, 1e-6) };
            let found = sampled.largest_position_gain();
            assert!((found * current_lag - 1.0).abs() < 3e-3, "{lag} {current_lag}: {found}");
        }
    }

    /// The largest position of the loop, let go at 1 mm, over the last of `cycles`.
    fn amplitude_after(sampled: &SampledLoop, cycles: f64) -> f64 {
        let drive =
            Drive { lag: sampled.lag, current_lag: 0.0, acceleration_limit: f64::INFINITY, friction: 0.0 };
        let mut motor = MotorState { position: 1.0, velocity: 0.0, pull: 0.0 };
        let mut before = 1.0;
        let mut largest = 0.0_f64;
        let mut left = cycles;
        while left > 0.0 {
            left -= 1.0;
            let command = -sampled.position_gain * (3.0 * motor.position - before) / 2.0;
            before = motor.position;
            motor = drive.advance(motor, command, sampled.sub_step);
            if motor.position.abs() > 1e6 {
                return motor.position.abs(); // on its way out of all numbers
            }
            if left < 50.0 {
                largest = largest.max(motor.position.abs());
            }
        }
        largest
    }

    proptest! {
        /// The limit is where the simulated loop turns from decay to growth.
        #[test]
        fn the_limit_is_that_of_the_simulation(lag in 1e-4..1e-2_f64, sub_step in 5e-5..2e-3_f64) {
            let at = |position_gain| SampledLoop::new(position_gain, lag, sub_step);
            let limit = at(1.0).largest_position_gain();
            // Three per cent from the limit, an error takes some hundred lags to decay or grow.
            let cycles = f64::max(4000.0, 1000.0 * lag / sub_step);
            prop_assert!(amplitude_after(&at(0.97 * limit), cycles) < 0.1);
            prop_assert!(amplitude_after(&at(1.03 * limit), cycles) > 10.0);
        }
    }
}
