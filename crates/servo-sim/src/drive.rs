//! The velocity loop and the motor: a first-order lag with a limit on acceleration and Coulomb friction, solved
//! exactly.
//!
//! `x' = v`, `v' = clamp((v_c - v)/τ, ±A) - f·sgn(v)`
//!
//! for a velocity command `v_c` that is held. The right-hand side is linear within each of the following phases, and
//! each has a closed form that also gives its end:
//!
//! - *saturated*, `|v_c - v| > Aτ`: constant acceleration;
//! - *linear*: with the target `w = v_c - fτ·sgn(v)`, `v = w + (v_0 - w)e^(-t/τ)`, `x = x_0 + w t + (v_0 - w)τ(1 - e^(-t/τ))`;
//!   this is the matrix exponential of the system, written out;
//! - *stuck*: `v = 0` and the drive pulls with less than f.
//!
//! Either moving phase also ends where v passes zero, since friction changes its sign there.
//!
//! So a step has no discretisation error, whatever its length and however often a limit is reached.

use crate::current_loop::CurrentLoop;
use crate::motor::MotorState;

/// Constants of the drive of one axis.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Drive {
    /// The lag τ of the velocity loop, in s, positive.
    pub lag: f64,
    /// The lag τᵢ of the current loop below, in s; 0 for none. `τᵢ a' = clamp((v_c - v)/τ, ±A) - a` then takes the place
    /// of the pull.
    pub current_lag: f64,
    /// The acceleration limit A, in mm/s²; infinite for no limit.
    pub acceleration_limit: f64,
    /// Coulomb friction f < A, in mm/s².
    pub friction: f64,
}

impl Drive {
    /// The motor after `duration` (s) under a held `velocity_command` (mm/s).
    #[must_use]
    pub fn advance(&self, mut motor: MotorState, velocity_command: f64, duration: f64) -> MotorState {
        if self.current_lag > 0.0 {
            let Self { lag, current_lag, acceleration_limit, friction } = *self;
            let below = CurrentLoop { lag, current_lag, acceleration_limit, friction };
            return below.advance(motor, velocity_command, duration);
        }
        // At most these: saturated, zero, saturated, linear; or linear, zero, linear. The other phases are for
        // rounding.
        const PHASES: usize = 8;
        let mut left = duration;
        for _ in 0..PHASES {
            if left <= 0.0 {
                break;
            }
            left -= self.phase(&mut motor, velocity_command, left);
        }
        debug_assert!(left <= 0.0 || !velocity_command.is_finite(), "{left} s left of {duration}: {motor:?}");
        motor
    }

    /// Moves the motor through one phase, or through `left` seconds of it. Returns the duration.
    fn phase(&self, motor: &mut MotorState, command: f64, left: f64) -> f64 {
        let pull =
            ((command - motor.velocity) / self.lag).clamp(-self.acceleration_limit, self.acceleration_limit);
        let direction = if motor.velocity == 0.0 { pull.signum() } else { motor.velocity.signum() };
        if motor.velocity == 0.0 && pull.abs() <= self.friction {
            return left;
        }
        let friction = -direction * self.friction;
        let velocity_at_limit = command - pull.signum() * self.acceleration_limit * self.lag;
        // The comparison is exact after a saturated phase, because that phase ends by setting exactly this velocity.
        let saturated = (velocity_at_limit - motor.velocity) * pull.signum() > 0.0;
        if saturated {
            self.saturated_phase(motor, pull + friction, velocity_at_limit, left)
        } else {
            self.linear_phase(motor, command + friction * self.lag, left)
        }
    }

    fn saturated_phase(&self, motor: &mut MotorState, acceleration: f64, until: f64, left: f64) -> f64 {
        let time_to = |velocity: f64| (velocity - motor.velocity) / acceleration;
        let stops = motor.velocity * acceleration < 0.0;
        let (end, velocity) = match (time_to(until), time_to(0.0)) {
            (_, rest) if stops && rest <= time_to(until) => (rest, 0.0),
            (limit, _) => (limit, until),
        };
        let (time, velocity) =
            if end <= left { (end, velocity) } else { (left, motor.velocity + acceleration * left) };
        motor.position += (motor.velocity + velocity) / 2.0 * time;
        motor.velocity = velocity;
        time
    }

    fn linear_phase(&self, motor: &mut MotorState, target: f64, left: f64) -> f64 {
        let excess = motor.velocity - target;
        let rest = if motor.velocity * target < 0.0 {
            self.lag * (-motor.velocity / target).ln_1p()
        } else {
            f64::INFINITY
        };
        let time = rest.min(left);
        let decayed = -(-time / self.lag).exp_m1(); // 1 - e^(-t/τ)
        motor.position += target * time + excess * self.lag * decayed;
        motor.velocity = if rest <= left { 0.0 } else { motor.velocity - excess * decayed };
        time
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use nalgebra::{Matrix3, Vector3};
    use proptest::prelude::*;

    const IDEAL: Drive =
        Drive { lag: 0.39e-3, current_lag: 0.0, acceleration_limit: f64::INFINITY, friction: 0.0 };

    #[test]
    fn a_linear_step_is_the_matrix_exponential_of_the_system() {
        // State (x, v, v_c), the command held: x' = v, v' = (v_c - v)/τ, v_c' = 0.
        let rate = 1.0 / IDEAL.lag;
        let system = Matrix3::new(0.0, 1.0, 0.0, 0.0, -rate, rate, 0.0, 0.0, 0.0);
        for duration in [1e-6, 1e-4, 1e-3, 1e-2] {
            let expected = (system * duration).exp() * Vector3::new(3.0, -20.0, 70.0);
            let found =
                IDEAL.advance(MotorState { position: 3.0, velocity: -20.0, pull: 0.0 }, 70.0, duration);
            assert!((found.position - expected.x).abs() < 1e-12, "{duration}: {found:?} {expected}");
            assert!((found.velocity - expected.y).abs() < 1e-11, "{duration}: {found:?} {expected}");
        }
    }

    #[test]
    fn a_saturated_start_takes_the_time_of_the_limit() {
        // 100 mm/s at 5000 mm/s² with τ = 1 ms: saturated to 95 mm/s, for 19 ms and 0.9025 mm, then a lag that is
        // through after 30 ms more: 5 mm/s · 1 ms = 5 µm behind.
        let drive = Drive { lag: 1e-3, current_lag: 0.0, acceleration_limit: 5000.0, friction: 0.0 };
        let at_limit = drive.advance(MotorState::default(), 100.0, 0.019);
        assert!((at_limit.velocity - 95.0).abs() < 1e-9 && (at_limit.position - 0.9025).abs() < 1e-12);
        let later = drive.advance(MotorState::default(), 100.0, 0.049);
        assert!((later.position - (0.9025 + 3.0 - 0.005)).abs() < 1e-9, "{later:?}");
    }

    #[test]
    fn friction_leaves_the_velocity_short_by_friction_times_lag() {
        let drive = Drive { friction: 400.0, ..IDEAL };
        for command in [50.0_f64, -50.0] {
            let settled = drive.advance(MotorState::default(), command, 0.1);
            let expected = command - command.signum() * 400.0 * IDEAL.lag;
            assert!((settled.velocity - expected).abs() < 1e-9, "{settled:?}");
        }
    }

    #[test]
    fn a_drive_that_pulls_less_than_friction_sticks() {
        let drive = Drive { friction: 400.0, ..IDEAL };
        let weak = 0.99 * 400.0 * IDEAL.lag;
        assert_eq!(drive.advance(MotorState::default(), weak, 1.0), MotorState::default());
        let stopped = drive.advance(MotorState { position: 0.0, velocity: 5.0, pull: 0.0 }, weak, 1.0);
        assert_eq!(stopped.velocity, 0.0);
        assert!(drive.advance(MotorState::default(), weak / 0.98, 1.0).position > 0.0);
    }

    proptest! {
        /// No discretisation error: one step is as good as a thousand, through every limit and reversal.
        #[test]
        fn step_size_does_not_matter(
            velocity in -100.0..100.0_f64,
            command in -100.0..100.0_f64,
            limit in 1e3..1e5_f64,
            friction_ratio in 0.0..0.95_f64,
            lag in 1e-4..1e-2_f64,
        ) {
            let drive = Drive { lag, current_lag: 0.0, acceleration_limit: limit, friction: friction_ratio * limit };
            let start = MotorState { position: 0.0, velocity, pull: 0.0 };
            let at_once = drive.advance(start, command, 0.02);
            let bit_by_bit = (0..1000).fold(start, |motor, _| drive.advance(motor, command, 0.02 / 1000.0));
            prop_assert!((at_once.position - bit_by_bit.position).abs() < 1e-9, "{at_once:?} {bit_by_bit:?}");
            prop_assert!((at_once.velocity - bit_by_bit.velocity).abs() < 1e-7, "{at_once:?} {bit_by_bit:?}");
        }

        /// The velocity never changes faster than limit and friction allow.
        #[test]
        fn acceleration_is_limited(velocity in -100.0..100.0_f64, command in -1e4..1e4_f64, limit in 1e3..1e5_f64) {
            let drive = Drive { lag: 1e-3, current_lag: 0.0, acceleration_limit: limit, friction: 0.1 * limit };
            let after = drive.advance(MotorState { position: 0.0, velocity, pull: 0.0 }, command, 1e-3);
            let change = (after.velocity - velocity).abs();
            prop_assert!(change <= 1.1 * limit * 1e-3 * (1.0 + 1e-9), "{change}");
        }
    }
}
