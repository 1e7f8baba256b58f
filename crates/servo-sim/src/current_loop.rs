//! The velocity loop above a current loop that lags: second order in the velocity, solved exactly.
//!
//! `x' = v`, `v' = a - f·sgn(v)`, `τᵢ a' = clamp((v_c - v)/τ, ±A) - a`
//!
//! for a velocity command `v_c` that is held. As without the lag, each phase is linear and has a closed form:
//!
//! - *saturated*: a decays to ±A with τᵢ;
//! - *linear*: `y = v - w` with the target `w = v_c - fτ·sgn(v)` and `b = v'` obey `y' = b`, `b' = -y/(τ τᵢ) - b/τᵢ`;
//! - *stuck*: `v = 0`, a decays to the commanded pull, until it exceeds f.
//!
//! A phase also ends where b is zero, which has a closed form. So v is monotone in a phase, and the first of the limits
//! that it passes (zero, or the ends `v_c ± Aτ` of the linear range) is found by bisection to the last bit.

use crate::motor::MotorState;

/// Constants of a drive whose current lags: those of [`Drive`](crate::Drive), with `current_lag` above 0.
#[derive(Clone, Copy, Debug)]
pub(crate) struct CurrentLoop {
    pub(crate) lag: f64,
    pub(crate) current_lag: f64,
    pub(crate) acceleration_limit: f64,
    pub(crate) friction: f64,
}

/// The law of a phase in which the motor moves.
#[derive(Clone, Copy)]
enum Law {
    /// The pull goes to this value.
    Saturated(f64),
    /// The velocity goes to this value.
    Linear(f64),
}

impl CurrentLoop {
    /// The motor after `duration` (s) under a held `command` (mm/s).
    pub(crate) fn advance(&self, mut motor: MotorState, command: f64, duration: f64) -> MotorState {
        // A phase a half-turn of the velocity, which has lost 84 % of its amplitude where τᵢ = τ; the others are for
        // limits and rounding.
        const PHASES: usize = 500;
        let mut left = duration;
        for _ in 0..PHASES {
            if left <= 0.0 {
                break;
            }
            left -= self.phase(&mut motor, command, left, true);
        }
        if left > 0.0 {
            // After so many half-turns the velocity is at its target to the last bit, and meets no limit.
            self.phase(&mut motor, command, left, false);
        }
        motor
    }

    /// Moves the motor through one phase, or through `left` seconds of it, and returns the duration. It looks for limits
    /// and turns only if `may_end`.
    fn phase(&self, motor: &mut MotorState, command: f64, left: f64, may_end: bool) -> f64 {
        let limit = self.acceleration_limit;
        let wanted = ((command - motor.velocity) / self.lag).clamp(-limit, limit);
        if motor.velocity == 0.0 && self.sticks(motor.pull, wanted) {
            return self.stuck_phase(motor, wanted, left);
        }
        let direction =
            [motor.velocity, motor.pull, wanted].into_iter().find(|x| *x != 0.0).map_or(0.0, f64::signum);
        let friction = direction * self.friction;
        let slope = motor.pull - friction;
        let [low, high] = [command - limit * self.lag, command + limit * self.lag];
        let law = if motor.velocity < low || (motor.velocity == low && slope < 0.0) {
            Law::Saturated(limit)
        } else if motor.velocity > high || (motor.velocity == high && slope > 0.0) {
            Law::Saturated(-limit)
        } else {
            Law::Linear(command - friction * self.lag)
        };
        let has_limits = may_end && (self.friction > 0.0 || limit.is_finite());
        let turn = if has_limits { self.extremum(law, motor, slope) } else { f64::INFINITY };
        let time = turn.min(left);
        let end = self.after(law, motor, slope, time);
        let zero = if self.friction > 0.0 { 0.0 } else { f64::NAN };
        let passed = first_passed([zero, low, high], motor.velocity, end.velocity);
        if let Some(value) = passed.filter(|_| may_end) {
            let time = self.time_of(value, law, motor, slope, time);
            *motor = MotorState { velocity: value, ..self.after(law, motor, slope, time) };
            return time;
        }
        // At an extremum of the velocity the pull is just that of friction.
        *motor = if turn <= left { MotorState { pull: friction, ..end } } else { end };
        time
    }

    fn sticks(&self, pull: f64, wanted: f64) -> bool {
        let outward = if pull == 0.0 { wanted.signum() } else { pull.signum() };
        pull.abs() < self.friction || (pull.abs() == self.friction && (wanted - pull) * outward <= 0.0)
    }

    fn stuck_phase(&self, motor: &mut MotorState, wanted: f64, left: f64) -> f64 {
        let breaks_off = wanted.signum() * self.friction;
        if wanted.abs() > self.friction {
            let time = self.current_lag * ((wanted - motor.pull) / (wanted - breaks_off)).ln();
            if time <= left {
                motor.pull = breaks_off;
                return time;
            }
        }
        motor.pull += (motor.pull - wanted) * (-left / self.current_lag).exp_m1();
        left
    }

    /// The motor after `time` (s) of a phase that begins with `slope` b = v'.
    fn after(&self, law: Law, motor: &MotorState, slope: f64, time: f64) -> MotorState {
        let friction = motor.pull - slope;
        match law {
            Law::Saturated(pull) => {
                let last = pull - friction;
                let decayed = -(-time / self.current_lag).exp_m1();
                let excess = slope - last;
                let shift = excess * self.current_lag * decayed;
                MotorState {
                    position: motor.position
                        + (motor.velocity + last * time / 2.0) * time
                        + self.current_lag * (excess * time - shift),
                    velocity: motor.velocity + last * time + shift,
                    pull: motor.pull - excess * decayed,
                }
            }
            Law::Linear(target) => {
                let excess = motor.velocity - target;
                let product = self.lag * self.current_lag;
                let half_rate = 0.5 / self.current_lag;
                let (even, odd) = self.decay(time);
                let new_excess = excess * even + (slope + half_rate * excess) * odd;
                let new_slope = slope * even - (half_rate * slope + excess / product) * odd;
                MotorState {
                    position: motor.position + target * time
                        - product * (new_slope - slope)
                        - self.lag * (new_excess - excess),
                    velocity: target + new_excess,
                    pull: new_slope + friction,
                }
            }
        }
    }

    /// σ² - 1/(τ τᵢ) with σ = 1/(2τᵢ): positive for two real roots.
    fn discriminant(&self) -> f64 {
        (0.25 / self.current_lag - 1.0 / self.lag) / self.current_lag
    }

    /// `e^(-σt) cosh(δt)` and `e^(-σt) sinh(δt)/δ`, with δ² the discriminant; a cosine and a sine where it is negative.
    fn decay(&self, time: f64) -> (f64, f64) {
        let (half_rate, square) = (0.5 / self.current_lag, self.discriminant());
        if square > 0.0 {
            let split = square.sqrt();
            // The slow root, -σ + δ without cancellation.
            let slow = (-time / (self.lag * self.current_lag * (half_rate + split))).exp();
            let fast = (-2.0 * split * time).exp_m1();
            (slow * (1.0 + fast / 2.0), -slow * fast / (2.0 * split))
        } else {
            let (turn, decay) = ((-square).sqrt(), (-half_rate * time).exp());
            let sine = if turn == 0.0 { time } else { (turn * time).sin() / turn };
            (decay * (turn * time).cos(), decay * sine)
        }
    }

    /// The time until the velocity is at its next extremum; infinite if there is none.
    fn extremum(&self, law: Law, motor: &MotorState, slope: f64) -> f64 {
        let time = match law {
            Law::Saturated(pull) => {
                let last = pull - (motor.pull - slope);
                if slope * last < 0.0 { self.current_lag * (-slope / last).ln_1p() } else { f64::INFINITY }
            }
            Law::Linear(target) => {
                let square = self.discriminant();
                let against = 0.5 / self.current_lag * slope
                    + (motor.velocity - target) / (self.lag * self.current_lag);
                if square < 0.0 {
                    let turn = (-square).sqrt();
                    let angle = (turn * slope).atan2(against);
                    (if angle > 0.0 { angle } else { angle + std::f64::consts::PI }) / turn
                } else if square == 0.0 {
                    slope / against
                } else {
                    (square.sqrt() * slope / against).atanh() / square.sqrt()
                }
            }
        };
        if time > 0.0 { time } else { f64::INFINITY }
    }

    /// The time at which the velocity, monotone until `end` (s), is `value`.
    fn time_of(&self, value: f64, law: Law, motor: &MotorState, slope: f64, end: f64) -> f64 {
        let is_before =
            |time| (self.after(law, motor, slope, time).velocity - value) * (motor.velocity - value) > 0.0;
        let (mut before, mut behind) = (0.0, end);
        loop {
            let middle = before + (behind - before) / 2.0;
            if middle <= before || middle >= behind {
                return behind;
            }
            *(if is_before(middle) { &mut before } else { &mut behind }) = middle;
        }
    }
}

/// The first of `limits` on the way from one velocity to another, without the start; NaN is none.
fn first_passed(limits: [f64; 3], from: f64, to: f64) -> Option<f64> {
    let is_passed = |limit: &f64| (*limit - from) * (*limit - to) <= 0.0 && *limit != from;
    let nearer = |a: &f64, b: &f64| (a - from).abs().total_cmp(&(b - from).abs());
    limits.into_iter().filter(|limit| limit.is_finite()).filter(is_passed).min_by(nearer)
}

#[cfg(test)]
mod tests {
    use super::*;
    use nalgebra::{Matrix4, Vector4};
    use proptest::prelude::*;

    fn ideal(current_lag: f64) -> CurrentLoop {
        CurrentLoop { lag: 0.39e-3, current_lag, acceleration_limit: f64::INFINITY, friction: 0.0 }
    }

    #[test]
    fn a_linear_step_is_the_matrix_exponential_of_the_system() {
        // State (x, v, a, v_c), the command held. A quarter of the lag is the critical case.
        for current_lag in [1e-5, 0.39e-3 / 4.0, 0.2e-3, 0.39e-3] {
            let drive = ideal(current_lag);
            let (own, below) = (1.0 / current_lag, 1.0 / (current_lag * drive.lag));
            let system = Matrix4::new(
                0.0, 1.0, 0.0, 0.0, //
                0.0, 0.0, 1.0, 0.0, //
                0.0, -below, -own, below, //
                0.0, 0.0, 0.0, 0.0,
            );
            for duration in [1e-6, 1e-4, 1e-3, 1e-2] {
                let expected = (system * duration).exp() * Vector4::new(3.0, -20.0, 5000.0, 70.0);
                let start = MotorState { position: 3.0, velocity: -20.0, pull: 5000.0 };
                let found = drive.advance(start, 70.0, duration);
                assert!(
                    (found.position - expected.x).abs() < 1e-11,
                    "{current_lag} {duration}: {found:?} {expected}"
                );
                assert!(
                    (found.velocity - expected.y).abs() < 1e-9,
                    "{current_lag} {duration}: {found:?} {expected}"
                );
                assert!(
                    (found.pull - expected.z).abs() < 1e-5,
                    "{current_lag} {duration}: {found:?} {expected}"
                );
            }
        }
    }

    /// The same motor by Euler's method in steps of 10 ns, through saturation, standstill and reversal.
    #[test]
    fn limits_and_friction_are_those_of_small_steps() {
        let drive =
            CurrentLoop { lag: 1e-3, current_lag: 0.4e-3, acceleration_limit: 5000.0, friction: 800.0 };
        let start = MotorState { position: 0.0, velocity: 12.0, pull: 0.0 };
        let mut exact = start;
        let (mut x, mut v, mut a) = (0.0_f64, 12.0_f64, 0.0_f64);
        let dt = 1e-8;
        for command in [-30.0, 0.3, 0.9, -0.5, 0.0] {
            for _ in 0..10 {
                exact = drive.advance(exact, command, 1e-3);
                for _ in 0..100_000 {
                    let wanted = ((command - v) / drive.lag).clamp(-5000.0, 5000.0);
                    let next = if v == 0.0 && a.abs() <= 800.0 {
                        0.0
                    } else {
                        let direction = if v == 0.0 { a.signum() } else { v.signum() };
                        let next = v + (a - direction * 800.0) * dt;
                        if v * next < 0.0 { 0.0 } else { next }
                    };
                    x += v * dt;
                    a += (wanted - a) / drive.current_lag * dt;
                    v = next;
                }
                let off = (exact.position - x).abs().max((exact.velocity - v).abs() * 1e-3);
                assert!(off < 2e-6, "{command}: {exact:?} {x} {v} {a}");
            }
        }
    }

    /// Ten million half-turns in one step: the rest of it was left out, and the motor stood still.
    #[test]
    fn a_step_of_many_half_turns_is_made_to_its_end() {
        let drive = CurrentLoop { lag: 1e-8, current_lag: 1e-8, acceleration_limit: 1e12, friction: 5.0 };
        let found = drive.advance(MotorState::default(), 70.0, 1.0);
        assert!((found.position - 70.0).abs() < 1e-5 && (found.velocity - 70.0).abs() < 1e-6, "{found:?}");
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
            ratio in 0.01..1.0_f64,
        ) {
            let current_lag = ratio * lag;
            let drive = CurrentLoop { lag, current_lag, acceleration_limit: limit, friction: friction_ratio * limit };
            let start = MotorState { position: 0.0, velocity, pull: 0.0 };
            let at_once = drive.advance(start, command, 0.02);
            let bit_by_bit = (0..1000).fold(start, |motor, _| drive.advance(motor, command, 0.02 / 1000.0));
            prop_assert!((at_once.position - bit_by_bit.position).abs() < 1e-9, "{at_once:?} {bit_by_bit:?}");
            prop_assert!((at_once.velocity - bit_by_bit.velocity).abs() < 1e-6, "{at_once:?} {bit_by_bit:?}");
        }
    }
}
