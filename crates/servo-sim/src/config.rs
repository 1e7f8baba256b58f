//! The servo file: the drive's parameters, as a drive engineer would write them on one page.
//!
//! ```toml
//! [servo]
//! position_gain_per_s = 50.7
//! velocity_lag_ms = 0.39
//! feed_forward = 0.98
//! ```

use std::fmt;

use domains::{Key, servo};
use serde::{Deserialize, Serialize};

use crate::error::{in_domain, positive, within};
use crate::{Notch, SampledLoop, ServoError, velocity_gain_of_load_inertia};

/// Parameters of one axis, in the units of the servo file. A parameter that the file leaves out is zero, unless stated
/// otherwise.
///
/// The position loop commands a velocity in proportion to its error, plus the feed-forward. The velocity loop follows
/// as a first-order lag, within friction and the acceleration limit. The table follows the motor through the backlash.
/// The encoder sits on the motor.
#[derive(Clone, Copy, Debug, PartialEq, Deserialize, Serialize)]
#[serde(deny_unknown_fields)]
pub struct ServoParameters {
    /// Position loop gain Kp, in 1/s: commanded velocity over position error.
    pub position_gain_per_s: f64,
    /// Lag τ of the velocity loop at a velocity gain of 100 %, in ms: its bandwidth is 1/(2πτ).
    pub velocity_lag_ms: f64,
    /// Lag τᵢ of the current loop below the velocity loop, in ms; 0 for none. At most the lag of the velocity loop at its
    /// gain, τ/g, or the velocity rings.
    #[serde(default)]
    pub current_lag_ms: f64,
    /// Velocity feed-forward α: the part of the commanded velocity that is added. 98 % is 0.98.
    #[serde(default)]
    pub feed_forward: f64,
    /// Acceleration feed-forward β: the part of `τ · commanded acceleration` that is added to the velocity.
    #[serde(default)]
    pub acceleration_feed_forward: f64,
    /// Velocity loop gain g, in per cent. The lag is τ/g.
    #[serde(default = "velocity_gain_percent")]
    pub velocity_gain_percent: f64,
    /// Inertia of the load in 256ths of the motor's, as FANUC's parameter 2021 has it: it sets the velocity gain to
    /// [`velocity_gain_of_load_inertia`](crate::velocity_gain_of_load_inertia). A file gives this or the gain; values that disagree are refused.
    #[serde(default)]
    pub load_inertia_256ths: Option<f64>,
    /// The velocity gain at which the velocity loop oscillates, in per cent. A first-order lag never oscillates, so
    /// this limit must be measured on the machine. By default 429 %: the paper runs at 300 %, which is 70 % of its
    /// limit.
    #[serde(default = "velocity_gain_limit_percent")]
    pub velocity_gain_limit_percent: f64,
    /// The current limit: the largest acceleration of the drive, in mm/s². If it is left out there is no limit.
    #[serde(default)]
    pub acceleration_limit_mm_per_s2: Option<f64>,
    /// Coulomb friction, as the deceleration that it causes, in mm/s².
    #[serde(default)]
    pub friction_mm_per_s2: f64,
    /// Play between motor and table, in mm.
    #[serde(default)]
    pub backlash_mm: f64,
    /// The offset that the control adds to the command at a reversal, to make up for the play, in mm.
    #[serde(default)]
    pub backlash_compensation_mm: f64,
    /// Acceleration that the control adds after a reversal, in mm/s².
    #[serde(default)]
    pub backlash_acceleration_mm_per_s2: f64,
    /// How long the control adds it, in ms; rounded to whole sub-steps.
    #[serde(default)]
    pub backlash_acceleration_ms: f64,
    /// Step of the encoder, in mm; 0 for an exact one.
    #[serde(default)]
    pub encoder_resolution_mm: f64,
    /// Length of the moving average over the setpoints of each axis (linear acceleration after interpolation), in ms; 0
    /// for none. It makes the radius of a circle smaller by `R(ωt)²/24`.
    #[serde(default)]
    pub command_filter_ms: f64,
    /// Length of the moving average over the feed along the path (linear acceleration before interpolation), in ms; 0 for
    /// none. The axes must agree on it. It leaves the path as it is; see [`ramp_feed`](crate::ramp_feed). Setpoints
    /// that are given to [`Servo`](crate::Servo) are taken as ramped already.
    #[serde(default)]
    pub feed_ramp_ms: f64,
    /// Centre of the vibration filter, a notch on the velocity command, in Hz; at most a quarter of the position
    /// loop's rate.
    #[serde(default)]
    pub vibration_filter_hz: f64,
    /// Width of the vibration filter, in Hz: between the two frequencies that are passed by 1/√2. 0 for no filter.
    #[serde(default)]
    pub vibration_filter_bandwidth_hz: f64,
    /// Position loop cycles in one interpolation period.
    #[serde(default = "sub_steps")]
    pub sub_steps: u32,
}

fn velocity_gain_percent() -> f64 {
    100.0
}

/// The paper runs at 300 % and says that this is 70 % of the gain at which the loop oscillates.
fn velocity_gain_limit_percent() -> f64 {
    300.0 / 0.7
}

/// A position loop of 0.125 ms at a period of 1 ms.
fn sub_steps() -> u32 {
    8
}

impl ServoParameters {
    /// An ideal drive except for the gain Kp and the lag τ: no feed-forward, friction, backlash or limit.
    #[must_use]
    pub fn new(position_gain_per_s: f64, velocity_lag_ms: f64) -> Self {
        Self {
            position_gain_per_s,
            velocity_lag_ms,
            current_lag_ms: 0.0,
            feed_forward: 0.0,
            acceleration_feed_forward: 0.0,
            velocity_gain_percent: velocity_gain_percent(),
            load_inertia_256ths: None,
            velocity_gain_limit_percent: velocity_gain_limit_percent(),
            acceleration_limit_mm_per_s2: None,
            friction_mm_per_s2: 0.0,
            backlash_mm: 0.0,
            backlash_compensation_mm: 0.0,
            backlash_acceleration_mm_per_s2: 0.0,
            backlash_acceleration_ms: 0.0,
            encoder_resolution_mm: 0.0,
            command_filter_ms: 0.0,
            feed_ramp_ms: 0.0,
            vibration_filter_hz: 0.0,
            vibration_filter_bandwidth_hz: 0.0,
            sub_steps: sub_steps(),
        }
    }

    /// Reads the table `[servo]` of a TOML text and checks it. It does not check stability, which depends on the
    /// interpolation period: see [`validate`](Self::validate).
    ///
    /// # Errors
    /// [`ReadError`]: line and column of a key that is unknown, missing or not a number; or line, key and value that
    /// break a rule.
    pub fn from_toml(text: &str) -> Result<Self, ReadError> {
        #[derive(Deserialize)]
        struct File<T> {
            servo: Option<T>,
        }
        /// The key that a load inertia replaces, where it is given.
        #[derive(Deserialize)]
        struct Given {
            velocity_gain_percent: Option<f64>,
        }
        let file: File<ServoParameters> = toml::from_str(text).map_err(ReadError::Toml)?;
        let mut parameters = file.servo.ok_or(ReadError::NoTable)?;
        let given: File<Given> = toml::from_str(text).map_err(ReadError::Toml)?;
        let gain_is_given = given.servo.is_some_and(|keys| keys.velocity_gain_percent.is_some());
        if let Some(inertia) = parameters.load_inertia_256ths
            && !gain_is_given
        {
            parameters.velocity_gain_percent = velocity_gain_of_load_inertia(inertia);
        }
        let at_its_line = |error: ServoError| ReadError::Value { error, line: line_of(text, &error) };
        parameters.check_values().map_err(at_its_line)?;
        Ok(parameters)
    }

    /// Checks every value, and the stability of the position loop at this interpolation period T (s).
    ///
    /// # Errors
    /// [`ServoError`], naming key, value and the relation that does not hold.
    pub fn validate(&self, period_s: f64) -> Result<(), ServoError> {
        self.check_values()?;
        let sub_step_s = self.sub_step_s(positive("interpolation period", period_s)?);
        self.check_vibration_filter(sub_step_s)?;
        self.sampled_loop(sub_step_s).validate()
    }

    fn check_load_inertia(&self) -> Result<(), ServoError> {
        let Some(load_inertia_256ths) = self.load_inertia_256ths else { return Ok(()) };
        if self.velocity_gain_percent == velocity_gain_of_load_inertia(load_inertia_256ths) {
            return Ok(());
        }
        let velocity_gain_percent = self.velocity_gain_percent;
        Err(ServoError::GainAgainstInertia { velocity_gain_percent, load_inertia_256ths })
    }

    /// These parameters at another velocity gain, in per cent, in place of one set by the load's inertia.
    #[must_use]
    pub fn with_velocity_gain(self, velocity_gain_percent: f64) -> Self {
        Self { velocity_gain_percent, load_inertia_256ths: None, ..self }
    }

    /// Refuses a vibration filter that is too fast for the position loop.
    fn check_vibration_filter(&self, sub_step_s: f64) -> Result<(), ServoError> {
        let most = 0.25 / sub_step_s;
        within(servo::FILTER_CENTRE.name, self.vibration_filter_hz, 0.0, most)?;
        within(servo::FILTER_WIDTH.name, self.vibration_filter_bandwidth_hz, 0.0, most)?;
        Ok(())
    }

    /// Refuses a vibration filter that has only one of its two values.
    fn check_both_of_filter(&self) -> Result<(), ServoError> {
        let [centre, width] = [self.vibration_filter_hz, self.vibration_filter_bandwidth_hz];
        match (centre > 0.0, width > 0.0) {
            (true, false) => positive(servo::FILTER_WIDTH.name, width).map(drop),
            (false, true) => positive(servo::FILTER_CENTRE.name, centre).map(drop),
            _ => Ok(()),
        }
    }

    /// The position loop, closed every `sub_step_s` (s).
    pub(crate) fn sampled_loop(&self, sub_step_s: f64) -> SampledLoop {
        SampledLoop {
            vibration_filter: self.notch(),
            current_lag: self.current_lag_ms / 1000.0,
            ..SampledLoop::new(self.position_gain_per_s, self.lag_s(), sub_step_s)
        }
    }

    /// The vibration filter, if there is one.
    #[must_use]
    pub fn notch(&self) -> Option<Notch> {
        Notch::of_hertz(self.vibration_filter_hz, self.vibration_filter_bandwidth_hz)
    }

    fn check_values(&self) -> Result<(), ServoError> {
        for (key, value) in self.values() {
            in_domain(key, value)?;
        }
        self.check_load_inertia()?;
        let velocity_lag_ms = self.lag_s() * 1000.0;
        if self.current_lag_ms > velocity_lag_ms {
            let current_lag_ms = self.current_lag_ms;
            return Err(ServoError::CurrentLoopSlow { current_lag_ms, velocity_lag_ms });
        }
        if self.velocity_gain_percent >= self.velocity_gain_limit_percent {
            return Err(ServoError::VelocityLoopOscillates {
                velocity_gain_percent: self.velocity_gain_percent,
                limit_percent: self.velocity_gain_limit_percent,
            });
        }
        match self.acceleration_limit_mm_per_s2 {
            Some(limit) if self.friction_mm_per_s2 >= limit => Err(ServoError::CannotMove {
                friction_mm_per_s2: self.friction_mm_per_s2,
                acceleration_limit_mm_per_s2: limit,
            }),
            _ => self.check_both_of_filter(),
        }
    }

    /// Each key that is given, with its value.
    fn values(&self) -> impl Iterator<Item = (&'static Key, f64)> + use<> {
        let always = [
            (&servo::POSITION_GAIN, self.position_gain_per_s),
            (&servo::VELOCITY_LAG, self.velocity_lag_ms),
            (&servo::CURRENT_LAG, self.current_lag_ms),
            (&servo::FEED_FORWARD, self.feed_forward),
            (&servo::ACCELERATION_FEED_FORWARD, self.acceleration_feed_forward),
            (&servo::VELOCITY_GAIN, self.velocity_gain_percent),
            (&servo::VELOCITY_GAIN_LIMIT, self.velocity_gain_limit_percent),
            (&servo::FRICTION, self.friction_mm_per_s2),
            (&servo::BACKLASH, self.backlash_mm),
            (&servo::BACKLASH_COMPENSATION, self.backlash_compensation_mm),
            (&servo::BACKLASH_ACCELERATION, self.backlash_acceleration_mm_per_s2),
            (&servo::BACKLASH_ACCELERATION_TIME, self.backlash_acceleration_ms),
            (&servo::ENCODER, self.encoder_resolution_mm),
            (&servo::COMMAND_FILTER, self.command_filter_ms),
            (&servo::FEED_RAMP, self.feed_ramp_ms),
            (&servo::FILTER_CENTRE, self.vibration_filter_hz),
            (&servo::FILTER_WIDTH, self.vibration_filter_bandwidth_hz),
            (&servo::SUB_STEPS, f64::from(self.sub_steps)),
        ];
        let inertia = self.load_inertia_256ths.map(|inertia| (&servo::LOAD_INERTIA, inertia));
        let limit = self.acceleration_limit_mm_per_s2.map(|limit| (&servo::ACCELERATION_LIMIT, limit));
        inertia.into_iter().chain(always).chain(limit)
    }

    /// The lag of the velocity loop at its gain, τ/g, in s.
    #[must_use]
    pub fn lag_s(&self) -> f64 {
        self.velocity_lag_ms / 1000.0 / (self.velocity_gain_percent / 100.0)
    }

    /// The largest distance from its command that the loop may keep at rest: `f τ/Kp + q + (b + c)/2`.
    ///
    /// - `f τ/Kp`: an error e commands the velocity `Kp e`, for which the drive pulls with `Kp e/τ`; the friction f can
    ///   hold this;
    /// - `q`: the encoder's value is within half of its step q, and the control law's extrapolation from two values is
    ///   within another half;
    /// - `b/2`: the table may be anywhere in the play b; `c/2`: the compensation moves the command by this.
    ///
    /// Units: f in mm/s², τ = [`lag_s`](Self::lag_s) in s, Kp in 1/s, q, b, c and result in mm.
    #[must_use]
    pub fn standstill_error_mm(&self) -> f64 {
        self.friction_mm_per_s2 * self.lag_s() / self.position_gain_per_s
            + self.encoder_resolution_mm
            + (self.backlash_mm + self.backlash_compensation_mm) / 2.0
    }

    /// Time between two cycles of the position loop, in s, at an interpolation period T (s).
    #[must_use]
    pub fn sub_step_s(&self, period_s: f64) -> f64 {
        period_s / f64::from(self.sub_steps)
    }
}

/// Why a servo file was refused.
#[derive(Clone, Debug, PartialEq)]
pub enum ReadError {
    /// It is not TOML, or a key is unknown, missing or of the wrong type.
    Toml(toml::de::Error),
    /// It has no table `[servo]`.
    NoTable,
    /// A value breaks a rule.
    Value {
        /// The rule, key and value.
        error: ServoError,
        /// The line of the key, from 1; `None` for a key that is left out, or stands in an inline table.
        line: Option<usize>,
    },
}

/// The line on which the table `[servo]` sets the key of this error.
fn line_of(text: &str, error: &ServoError) -> Option<usize> {
    let key = error.key()?;
    let sets_key = |line: &str| {
        line.trim_start().strip_prefix(key).is_some_and(|rest| rest.trim_start().starts_with('='))
    };
    let mut lines = text.lines().zip(1..).skip_while(|(line, _)| !line.trim_start().starts_with("[servo]"));
    lines.find(|(line, _)| sets_key(line)).map(|(_, number)| number)
}

impl fmt::Display for ReadError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Toml(error) => error.fmt(f),
            Self::NoTable => {
                write!(f, "expected a table [servo]: a line `[servo]` and the drive's keys below it")
            }
            Self::Value { error, line: Some(line) } => write!(f, "line {line}: {error}"),
            Self::Value { error, line: None } => error.fmt(f),
        }
    }
}

impl std::error::Error for ReadError {}

#[cfg(test)]
mod tests {
    use super::*;

    fn message(text: &str) -> String {
        ServoParameters::from_toml(text).unwrap_err().to_string()
    }

    const MINIMAL: &str = "[servo]\nposition_gain_per_s = 30\nvelocity_lag_ms = 1.0\n";

    #[test]
    fn the_sample_file_is_read() {
        let sample = ServoParameters::from_toml(include_str!("../../../data/servo.toml")).unwrap();
        assert_eq!((sample.position_gain_per_s, sample.velocity_lag_ms), (50.7, 0.39));
        assert_eq!(sample.validate(1e-3), Ok(()));
    }

    #[test]
    fn keys_left_out_mean_an_ideal_drive() {
        assert_eq!(ServoParameters::from_toml(MINIMAL), Ok(ServoParameters::new(30.0, 1.0)));
    }

    #[test]
    fn a_key_that_is_unknown_or_missing_is_named_with_its_line() {
        let unknown = message(&(MINIMAL.to_string() + "feedforward = 0.9\n"));
        assert!(unknown.contains("feedforward") && unknown.contains("line 4"), "{unknown}");
        let missing = message("[servo]\nposition_gain_per_s = 30\n");
        assert!(missing.contains("velocity_lag_ms"), "{missing}");
    }

    #[test]
    fn a_value_that_breaks_a_rule_is_named() {
        for (line, expected) in [
            ("feed_forward = 98", "feed_forward = 98: expected a number of 0 to 1.5"),
            ("feed_forward = nan", "feed_forward = NaN: expected a number of 0 to 1.5"),
            ("backlash_mm = -1e-3", "backlash_mm = -0.001: expected a number of 0 to 100 mm"),
            ("feed_ramp_ms = -24", "feed_ramp_ms = -24: expected a number of 0 to 10000 ms"),
            ("vibration_filter_hz = 200", "vibration_filter_bandwidth_hz = 0: expected a positive number"),
            ("vibration_filter_bandwidth_hz = 60", "vibration_filter_hz = 0: expected a positive number"),
            ("vibration_filter_hz = nan", "vibration_filter_hz = NaN: expected a number of 0 to 1e6 Hz"),
            ("current_lag_ms = -0.1", "current_lag_ms = -0.1: expected 0, or a number of 1e-6 to 10000 ms"),
            (
                "current_lag_ms = 1.5",
                "line 4: current_lag_ms = 1.5: expected at most 1, the lag of the velocity loop",
            ),
            ("sub_steps = 0", "sub_steps = 0: expected a whole number of 1 to 10000"),
            (
                "acceleration_limit_mm_per_s2 = 0",
                "acceleration_limit_mm_per_s2 = 0: expected a number of 0.001 to 1e8 mm/s²",
            ),
            ("velocity_gain_percent = 450", "oscillates from velocity_gain_limit_percent = 429 on"),
            ("friction_mm_per_s2 = 9\nacceleration_limit_mm_per_s2 = 9", "the axis cannot move"),
        ] {
            let text = MINIMAL.to_string() + line;
            assert!(message(&text).contains(expected), "{line}: {}", message(&text));
        }
    }

    #[test]
    fn a_value_that_breaks_a_rule_is_named_with_its_line() {
        for (text, expected) in [
            (
                MINIMAL.to_string() + "\n# feed_forward = 1\n  feed_forward=98",
                "line 6: feed_forward = 98: expected",
            ),
            (MINIMAL.replace("30", "-30"), "line 2: position_gain_per_s = -30: expected"),
            (
                MINIMAL.to_string() + "velocity_gain_limit_percent = 50",
                "velocity_gain_percent = 100: the velocity",
            ),
            (
                "servo = { position_gain_per_s = 0, velocity_lag_ms = 1 }".to_string(),
                "position_gain_per_s = 0: expected a number of 0.001 to 1e6 1/s",
            ),
        ] {
            assert!(message(&text).starts_with(expected), "{text}: {}", message(&text));
        }
    }

    #[test]
    fn a_file_without_the_table_is_told_what_is_expected() {
        for text in ["", "position_gain_per_s = 30\nvelocity_lag_ms = 1\n", "[machine]\nfeed = 1\n"] {
            assert!(message(text).starts_with("expected a table [servo]"), "{text}: {}", message(text));
        }
    }

    /// A position loop of 0.125 ms runs at 8 kHz.
    #[test]
    fn a_vibration_filter_beyond_a_quarter_of_the_rate_is_refused() {
        let at = |vibration_filter_hz| ServoParameters {
            vibration_filter_hz,
            vibration_filter_bandwidth_hz: 60.0,
            ..ServoParameters::new(50.7, 0.39)
        };
        assert_eq!(at(2000.0).validate(1e-3), Ok(()));
        let refused = at(2001.0).validate(1e-3).unwrap_err();
        assert_eq!(refused.to_string(), "vibration_filter_hz = 2001: expected a number from 0 to 2000");
    }

    /// The paper: a velocity gain of 300 % for a load inertia of about 512.
    #[test]
    fn a_load_inertia_sets_the_velocity_gain() {
        for (inertia, percent) in [(0.0, 100.0), (256.0, 200.0), (512.0, 300.0)] {
            assert_eq!(velocity_gain_of_load_inertia(inertia), percent);
            let text = format!("{MINIMAL}load_inertia_256ths = {inertia}");
            let read = ServoParameters::from_toml(&text).unwrap();
            assert_eq!(read.velocity_gain_percent, percent);
            assert!((read.lag_s() * percent - 0.1).abs() < 1e-15, "{read:?}");
        }
    }

    #[test]
    fn a_load_inertia_that_the_gain_contradicts_is_refused_with_its_line() {
        for (lines, expected) in [
            (
                "velocity_gain_percent = 100\nload_inertia_256ths = 512",
                "line 5: load_inertia_256ths = 512: it sets velocity_gain_percent to 300, and 100 is given; expected one of \
                 the two keys",
            ),
            ("load_inertia_256ths = -1", "line 4: load_inertia_256ths = -1: expected a number of 0 to 1e6"),
            ("load_inertia_256ths = 1000", "velocity_gain_percent = 490.625: the velocity loop oscillates"),
        ] {
            let said = message(&format!("{MINIMAL}{lines}"));
            assert!(said.starts_with(expected), "{lines}: {said}");
        }
        assert!(
            ServoParameters::from_toml(&format!(
                "{MINIMAL}velocity_gain_percent = 300\nload_inertia_256ths = 512"
            ))
            .is_ok()
        );
    }

    #[test]
    fn more_velocity_gain_is_less_lag() {
        let at =
            |percent| ServoParameters { velocity_gain_percent: percent, ..ServoParameters::new(30.0, 3.0) };
        assert!((at(300.0).lag_s() - 0.001).abs() < 1e-15);
        assert!((at(100.0).lag_s() - 0.003).abs() < 1e-15);
    }
}
