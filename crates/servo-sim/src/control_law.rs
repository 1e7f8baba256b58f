//! The position loop as a controller runs it: one velocity command a sub-step, in the controller's number format.
//!
//! In the literature the loop works in continuous time: `v_c = Kp (r - x) + α r' + β τ r''`. If it is sampled every h
//! and its command is held for h, it acts on a state that is h/2 old on average. This adds a lag of h/2, which changes
//! every result with the step size. The law below works with the state in the *middle* of the sub-step that it
//! commands. The setpoint there is known, because the path ahead is known. The position there is extrapolated from the
//! last two encoder values:
//!
//! `v_c = Kp (r_{k+½} - (3x_k - x_{k-1})/2) + α (r_{k+1} - r_k)/h + β τ r''`.
//!
//! The remaining effect of the sampling is of second order in h; see [`SampledLoop`](crate::SampledLoop) for its size.

use real::{Backend, Real};

use crate::ServoError;

/// One sub-step of the commanded motion of an axis.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct CommandedMotion<R> {
    /// The setpoint r_k at the start of the sub-step, in mm.
    pub start: R,
    /// `r_{k+1} - r_k`, in mm: the velocity times h.
    pub increment: R,
    /// Change of the increment from one sub-step to the next, in mm: the acceleration times h².
    pub increment_change: R,
}

/// Gains of the position loop, per sub-step h.
///
/// The unit of time is the sub-step, so a velocity is in mm per sub-step, and fits the format if a position does.
///
/// Accuracy: rounding in a format of resolution ε moves the position by up to about `ε/(Kp h)`, because the error times
/// the small gain `Kp h` must not round to zero. With Kp = 50.7/s and h = 0.125 ms that is 160 ε, or 2.4 µm in I16F16
/// and 10 nm in I8F24.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ControlLaw<R> {
    /// `Kp h`.
    gain: R,
    /// α.
    feed_forward: R,
    /// `β τ/h`.
    acceleration_feed_forward: R,
}

impl<R: Backend> ControlLaw<R> {
    /// The law with position gain Kp (1/s), feed-forward α, acceleration feed-forward times lag βτ (s), sub-step h (s).
    ///
    /// # Errors
    /// [`ServoError::ParameterNotInFormat`] if one of them, per sub-step, is out of the format's range or rounds to
    /// zero.
    pub fn try_new(
        position_gain: f64,
        feed_forward: f64,
        acceleration_lag: f64,
        sub_step: f64,
    ) -> Result<Self, ServoError> {
        Ok(Self {
            gain: in_format("position gain per sub-step", position_gain * sub_step)?,
            feed_forward: in_format("feed-forward", feed_forward)?,
            acceleration_feed_forward: in_format(
                "acceleration feed-forward in sub-steps",
                acceleration_lag / sub_step,
            )?,
        })
    }
}

impl<R: Real> ControlLaw<R> {
    /// The velocity command for this sub-step, in mm per sub-step. `encoder` is the encoder's value now,
    /// `previous_encoder` its value one sub-step ago.
    pub fn velocity_command(&self, motion: &CommandedMotion<R>, encoder: R, previous_encoder: R) -> R {
        let lead = motion.increment - (encoder - previous_encoder);
        let error = motion.start - encoder + lead.half();
        R::sum_of_products([
            (self.gain, error),
            (self.feed_forward, motion.increment),
            (self.acceleration_feed_forward, motion.increment_change),
        ])
    }
}

/// `value` in the format `R`. A value that is out of range, or rounds to zero, is refused.
pub(crate) fn in_format<R: Backend>(what: &'static str, value: f64) -> Result<R, ServoError> {
    match R::from_f64(value) {
        Some(number) if value == 0.0 || !number.is_zero() => Ok(number),
        _ => Err(ServoError::ParameterNotInFormat { what, value, format: R::name() }),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use real::{I8F24, I16F16};

    const H: f64 = 0.125e-3;

    #[test]
    fn a_steady_error_asks_for_gain_times_error() {
        // 30 1/s and 5.33 mm: 160 mm/s, or 0.02 mm a sub-step.
        let law = ControlLaw::try_new(30.0, 0.0, 0.0, H).unwrap();
        let motion = CommandedMotion { start: 16.0 / 3.0, increment: 160.0 * H, increment_change: 0.0 };
        let command = law.velocity_command(&motion, 0.0, -160.0 * H);
        assert!((command / H - 160.0).abs() < 1e-12, "{}", command / H);
    }

    #[test]
    fn without_error_the_feed_forward_is_all_there_is() {
        let law = ControlLaw::try_new(30.0, 0.98, 0.5e-3, H).unwrap();
        let (velocity, acceleration) = (100.0, 2000.0);
        let increment = velocity * H;
        let motion = CommandedMotion { start: 7.0, increment, increment_change: acceleration * H * H };
        let command = law.velocity_command(&motion, 7.0, 7.0 - increment) / H;
        assert!((command - (0.98 * velocity + 0.5e-3 * acceleration)).abs() < 1e-10, "{command}");
    }

    /// The promise of the docstring: the position that a format cannot tell from the right one.
    #[test]
    fn the_dead_zone_of_a_format_is_its_resolution_over_the_gain() {
        fn dead_zone<R: Backend>() -> f64 {
            let law = ControlLaw::<R>::try_new(50.7, 0.0, 0.0, H).unwrap();
            let zero = R::zero();
            let command = |error: f64| {
                let motion = CommandedMotion {
                    start: R::from_f64(error).unwrap(),
                    increment: zero,
                    increment_change: zero,
                };
                law.velocity_command(&motion, zero, zero)
            };
            (1..).map(|n| f64::from(n) * 1e-9).find(|&error| !command(error).is_zero()).unwrap()
        }
        let resolution = |bits: i32| 2.0_f64.powi(-bits);
        for (found, bits) in [(dead_zone::<I16F16>(), 16), (dead_zone::<I8F24>(), 24)] {
            let bound = resolution(bits) / (50.7 * H);
            assert!(found <= bound && found > 0.4 * bound, "{bits} bits: {found} against {bound}");
        }
    }

    #[test]
    fn a_gain_that_vanishes_in_the_format_is_refused() {
        let refused = ControlLaw::<I16F16>::try_new(0.05, 0.0, 0.0, H).unwrap_err();
        assert!(refused.to_string().contains("position gain per sub-step = 6.250e-6"), "{refused}");
    }
}
