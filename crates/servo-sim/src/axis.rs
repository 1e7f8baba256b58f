//! One axis: control law, drive, play and encoder, a period at a time.

use real::Backend;

use crate::ServoError;
use crate::backlash::{Play, ReversalCompensation, ReversalState};
use crate::control_law::{CommandedMotion, ControlLaw};
use crate::drive::Drive;
use crate::motor::MotorState;
use crate::{FilterState, ServoParameters, VibrationFilter};

/// The constants of one axis: the controller's in the format `R`, and the machine's in f64.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Axis<R> {
    law: ControlLaw<R>,
    reversal: ReversalCompensation<R>,
    vibration_filter: Option<VibrationFilter<R>>,
    drive: Drive,
    play: Play,
    encoder_resolution: f64,
    sub_steps: i32,
    sub_step: f64,
    settling_sub_steps: f64,
    standstill_error: f64,
    dead_zone: f64,
}

/// The values of an axis that change.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct AxisState<R> {
    motor: MotorState,
    table: f64,
    setpoint: R,
    period_increment: R,
    encoder: R,
    filter: FilterState<R>,
    reversal: ReversalState,
}

/// An axis at the end of a sub-step.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct AxisSample {
    /// The commanded position, in mm.
    pub command: f64,
    /// The motor, in mm of the axis.
    pub motor: f64,
    /// The table, in mm.
    pub table: f64,
}

impl<R: Backend> Axis<R> {
    /// An axis with these parameters at an interpolation period T (s).
    ///
    /// # Errors
    /// [`ServoError`] if a value is out of its range, the loop is unstable, or a gain does not fit the format.
    pub fn try_new(parameters: &ServoParameters, period: f64) -> Result<Self, ServoError> {
        parameters.validate(period)?;
        let (lag, sub_step) = (parameters.lag_s(), parameters.sub_step_s(period));
        let position_gain = parameters.position_gain_per_s;
        let acceleration_lag = parameters.acceleration_feed_forward * lag;
        let sampled = parameters.sampled_loop(sub_step);
        let filter = parameters.notch().map(|notch| VibrationFilter::try_new(&notch, sub_step));
        Ok(Self {
            law: ControlLaw::try_new(position_gain, parameters.feed_forward, acceleration_lag, sub_step)?,
            reversal: ReversalCompensation::try_new(
                parameters.backlash_compensation_mm,
                parameters.backlash_acceleration_mm_per_s2,
                parameters.backlash_acceleration_ms / 1000.0,
                lag,
                sub_step,
            )?,
            vibration_filter: filter.transpose()?,
            drive: Drive {
                lag,
                current_lag: parameters.current_lag_ms / 1000.0,
                acceleration_limit: parameters.acceleration_limit_mm_per_s2.unwrap_or(f64::INFINITY),
                friction: parameters.friction_mm_per_s2,
            },
            play: Play { width: parameters.backlash_mm },
            encoder_resolution: parameters.encoder_resolution_mm,
            sub_steps: i32::try_from(parameters.sub_steps).unwrap_or(i32::MAX),
            sub_step,
            settling_sub_steps: sampled.settling_sub_steps(),
            standstill_error: parameters.standstill_error_mm(),
            dead_zone: 2.0 * R::resolution().to_f64() / (position_gain * sub_step),
        })
    }

    /// The axis at rest at `position` (mm), the motor in the middle of the play; `None` if the format cannot hold it.
    #[must_use]
    pub fn at_rest(&self, position: f64) -> Option<AxisState<R>> {
        Some(AxisState {
            motor: MotorState { position, velocity: 0.0, pull: 0.0 },
            table: position,
            setpoint: R::from_f64(position)?,
            period_increment: R::zero(),
            encoder: self.read_encoder(position)?,
            filter: FilterState { band: R::zero(), low: R::zero() },
            reversal: ReversalState::default(),
        })
    }

    /// Runs one period towards `setpoint` and passes the end of each sub-step to `record`. `None` if the motor reaches
    /// a position that the format cannot hold.
    pub fn run_period(
        &self,
        state: &mut AxisState<R>,
        setpoint: R,
        mut record: impl FnMut(AxisSample),
    ) -> Option<()> {
        let start = state.setpoint;
        let period_increment = setpoint - start;
        let part = R::from_ratio(1, self.sub_steps);
        let increment = period_increment * part;
        let increment_change = (period_increment - state.period_increment) * part * part;
        for sub_step in 0..self.sub_steps {
            let at = |sub_step| R::from_ratio(sub_step, self.sub_steps).mul_add(period_increment, start);
            let added = self.reversal.step(&mut state.reversal, period_increment);
            let motion =
                CommandedMotion { start: at(sub_step) + added.position, increment, increment_change };
            let encoder = self.read_encoder(state.motor.position)?;
            let command = self.law.velocity_command(&motion, encoder, state.encoder) + added.velocity;
            let command = match &self.vibration_filter {
                Some(filter) => filter.step(&mut state.filter, command),
                None => command,
            };
            state.encoder = encoder;
            state.motor = self.drive.advance(state.motor, command.to_f64() / self.sub_step, self.sub_step);
            if !state.motor.position.is_finite() {
                return None;
            }
            state.table = self.play.follow(state.table, state.motor.position);
            let reached = if sub_step + 1 == self.sub_steps { setpoint } else { at(sub_step + 1) };
            record(AxisSample { command: reached.to_f64(), motor: state.motor.position, table: state.table });
        }
        state.setpoint = setpoint;
        state.period_increment = period_increment;
        Some(())
    }

    /// Sub-steps a period.
    pub(crate) fn sub_steps(&self) -> i32 {
        self.sub_steps
    }

    /// Time between two sub-steps, in s.
    pub(crate) fn sub_step(&self) -> f64 {
        self.sub_step
    }

    /// Periods after which an error has decayed to e⁻²⁰, 2e-9 of what it was.
    pub(crate) fn settling_periods(&self) -> f64 {
        (self.settling_sub_steps / f64::from(self.sub_steps)).ceil()
    }

    /// The largest distance from its setpoint that this loop may keep at rest, in mm: the part due to its parameters,
    /// and the rounding of the control law and of the encoder in the drive's format, `2ε/(Kp h)`.
    pub(crate) fn standstill_error(&self, state: &AxisState<R>) -> f64 {
        let scale = if R::IS_FLOATING { state.setpoint.to_f64().abs().max(1.0) } else { 1.0 };
        self.standstill_error + self.dead_zone * scale
    }

    fn read_encoder(&self, position: f64) -> Option<R> {
        let step = self.encoder_resolution;
        R::from_f64(if step > 0.0 { (position / step).round() * step } else { position })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use real::{I8F24, I16F16};

    const T: f64 = 1e-3;

    /// Command, motor and table after `periods` at a constant feed (mm/s).
    fn at_constant_feed<R: Backend>(parameters: &ServoParameters, feed: f64, periods: i32) -> AxisSample {
        let axis = Axis::<R>::try_new(parameters, T).unwrap();
        let mut state = axis.at_rest(0.0).unwrap();
        let mut last = AxisSample { command: 0.0, motor: 0.0, table: 0.0 };
        for period in 1..=periods {
            let setpoint = R::from_f64(f64::from(period) * feed * T).unwrap();
            axis.run_period(&mut state, setpoint, |sample| last = sample).unwrap();
        }
        last
    }

    #[test]
    fn following_error_is_feed_over_gain() {
        // The paper's example: 160 mm/s at 30 1/s. 160/30 = 5.333 mm.
        let sample = at_constant_feed::<f64>(&ServoParameters::new(30.0, 0.39), 160.0, 2000);
        let error = sample.command - sample.table;
        assert!((error - 16.0 / 3.0).abs() < 1e-9, "{error}");
    }

    #[test]
    fn with_feed_forward_the_following_error_falls_as_one_minus_alpha() {
        for alpha in [0.0, 0.5, 0.95, 0.98, 0.99, 1.0] {
            let parameters = ServoParameters { feed_forward: alpha, ..ServoParameters::new(30.0, 0.39) };
            let sample = at_constant_feed::<f64>(&parameters, 160.0, 2000);
            let error = sample.command - sample.table;
            let expected = (1.0 - alpha) * 160.0 / 30.0;
            assert!((error - expected).abs() < 1e-9, "alpha={alpha}: {error} {expected}");
        }
    }

    #[test]
    fn friction_adds_friction_times_lag_over_gain() {
        // A velocity short by fτ/g costs fτ/(g Kp): at 400 mm/s², 0.39 ms, 50.7 1/s and 200 %: 1.54 µm.
        let parameters = ServoParameters {
            feed_forward: 1.0,
            friction_mm_per_s2: 400.0,
            velocity_gain_percent: 200.0,
            ..ServoParameters::new(50.7, 0.39)
        };
        let sample = at_constant_feed::<f64>(&parameters, 100.0, 2000);
        let expected = 400.0 * 0.39e-3 / 2.0 / 50.7;
        assert!((sample.command - sample.table - expected).abs() < 1e-9, "{sample:?} {expected}");
    }

    #[test]
    fn the_table_trails_the_motor_by_half_the_play_and_compensation_makes_up_for_it() {
        let play =
            ServoParameters { backlash_mm: 0.01, feed_forward: 1.0, ..ServoParameters::new(50.0, 0.4) };
        let plain = at_constant_feed::<f64>(&play, 100.0, 2000);
        assert!((plain.command - plain.table - 0.005).abs() < 1e-9, "{plain:?}");
        let compensated = ServoParameters { backlash_compensation_mm: 0.01, ..play };
        let sample = at_constant_feed::<f64>(&compensated, 100.0, 2000);
        assert!((sample.command - sample.table).abs() < 1e-9, "{sample:?}");
    }

    #[test]
    fn a_coarse_encoder_keeps_the_error_within_its_step() {
        let exact = ServoParameters { feed_forward: 1.0, ..ServoParameters::new(50.0, 0.4) };
        let coarse = ServoParameters { encoder_resolution_mm: 0.001, ..exact };
        let difference = at_constant_feed::<f64>(&coarse, 20.0, 1000).table
            - at_constant_feed::<f64>(&exact, 20.0, 1000).table;
        assert!(difference != 0.0 && difference.abs() <= 0.001, "{difference}");
    }

    #[test]
    fn the_law_in_fixed_point_stays_within_its_dead_zone() {
        // Resolution over gain a sub-step, as the control law promises: 2.4 µm in I16F16, 10 nm in I8F24. The gain's
        // own rounding, 2⁻¹⁷/0.0063 = 0.12 % in I16F16, acts on what feed-forward leaves over: nothing here.
        let parameters = ServoParameters { feed_forward: 1.0, ..ServoParameters::new(50.7, 0.39) };
        let exact = at_constant_feed::<f64>(&parameters, 31.25, 1000).table;
        let dead_zone = |bits: i32| 2.0_f64.powi(-bits) / (50.7 * T / 8.0);
        let coarse = at_constant_feed::<I16F16>(&parameters, 31.25, 1000).table;
        let fine = at_constant_feed::<I8F24>(&parameters, 31.25, 1000).table;
        assert!((coarse - exact).abs() < dead_zone(16), "{coarse} {exact}");
        assert!((fine - exact).abs() < dead_zone(24), "{fine} {exact}");
        assert!((fine - exact).abs() < (coarse - exact).abs());
    }

    #[test]
    fn a_motor_beyond_the_formats_range_is_told() {
        let axis = Axis::<I8F24>::try_new(&ServoParameters::new(50.0, 0.4), T).unwrap();
        assert!(axis.at_rest(200.0).is_none());
    }
}
