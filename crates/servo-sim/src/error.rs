//! The reasons why a servo or a test of it is refused.

use std::fmt;

use domains::{Key, shown};
use real::FormatName;

use crate::load_inertia::velocity_gain_of_load_inertia;

/// The reason why parameters, a loop, a run or a circle test were refused. Keys are those of the servo file.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub enum ServoError {
    /// A value must be positive and finite, and is not.
    NotPositive {
        /// Name of the argument or key.
        key: &'static str,
        /// The value given.
        value: f64,
    },
    /// The value of a key is outside of its domain, or not a number.
    OutsideDomain {
        /// The key.
        key: &'static Key,
        /// The value given.
        value: f64,
    },
    /// A value is outside its range, or not a number.
    OutOfRange {
        /// Name of the argument or key.
        key: &'static str,
        /// The value given.
        value: f64,
        /// The least value allowed.
        least: f64,
        /// The greatest value allowed.
        most: f64,
    },
    /// The velocity loop's gain is at or above the gain at which the loop oscillates.
    VelocityLoopOscillates {
        /// The gain given, in per cent.
        velocity_gain_percent: f64,
        /// The gain at which the loop oscillates, in per cent.
        limit_percent: f64,
    },
    /// The velocity gain is not the one that the load's inertia sets.
    GainAgainstInertia {
        /// The gain given, in per cent.
        velocity_gain_percent: f64,
        /// The load's inertia, in 256ths of the motor's.
        load_inertia_256ths: f64,
    },
    /// The current loop is slower than the velocity loop above it.
    CurrentLoopSlow {
        /// The lag of the current loop, in ms.
        current_lag_ms: f64,
        /// The lag of the velocity loop at its gain, in ms.
        velocity_lag_ms: f64,
    },
    /// The axes of a machine have different numbers of sub-steps.
    SubStepsDiffer {
        /// The number of the first axis.
        first: u32,
        /// The number of the other axis.
        other: u32,
    },
    /// The axes of a machine have different ramps of the feed, which they share.
    FeedRampsDiffer {
        /// The ramp of the first axis, in ms.
        first: f64,
        /// The ramp of the other axis, in ms.
        other: f64,
    },
    /// Friction takes all of the drive's acceleration.
    CannotMove {
        /// Deceleration by friction, in mm/s².
        friction_mm_per_s2: f64,
        /// The drive's limit, in mm/s².
        acceleration_limit_mm_per_s2: f64,
    },
    /// The sampled position loop is not stable.
    Unstable {
        /// The gain given, in 1/s.
        position_gain_per_s: f64,
        /// The gain at which the loop begins to oscillate, in 1/s.
        largest_gain_per_s: f64,
        /// Factor by which an error grows from one sub-step to the next.
        spectral_radius: f64,
        /// Time between two sub-steps, in ms.
        sub_step_ms: f64,
    },
    /// A parameter does not fit the number format of the control law, or becomes zero in it.
    ParameterNotInFormat {
        /// The parameter, per sub-step.
        what: &'static str,
        /// Its value.
        value: f64,
        /// The format.
        format: FormatName,
    },
    /// A setpoint or a position does not fit the number format of the control law.
    PositionNotInFormat {
        /// Index of the axis.
        axis: usize,
        /// The position, in mm.
        value: f64,
        /// The format.
        format: FormatName,
    },
    /// A circle takes so few periods that its setpoints are a polygon.
    CircleTooFast {
        /// Setpoints on a turn.
        setpoints_per_turn: f64,
        /// The fewest allowed.
        least: f64,
    },
    /// Once settled, the table is not where the path ends.
    DoesNotArrive {
        /// Distance of the table from the end, in mm.
        end_error_mm: f64,
        /// The largest distance that friction, play and encoder of the resting loops explain, or half of the path's
        /// reach.
        most_mm: f64,
    },
    /// The table has been less than half as far from the start as the path leads.
    StaysBehind {
        /// The largest distance of the table from the start, in mm.
        reach_mm: f64,
        /// The largest distance of the path from the start, in mm.
        commanded_mm: f64,
    },
    /// The table does not go round the circle's centre once while the setpoints do.
    DoesNotTurn {
        /// The angle by which the table goes round, in degrees, counter-clockwise.
        turned_degrees: f64,
    },
    /// A path has no curve, or a curve that has no length.
    PathEmpty,
}

impl ServoError {
    /// The key of the servo file whose value was refused; `None` if the error is not about one key.
    #[must_use]
    pub fn key(&self) -> Option<&'static str> {
        match self {
            Self::OutsideDomain { key, .. } => Some(key.name),
            Self::NotPositive { key, .. } | Self::OutOfRange { key, .. } => Some(key),
            Self::VelocityLoopOscillates { .. } => Some("velocity_gain_percent"),
            Self::GainAgainstInertia { .. } => Some("load_inertia_256ths"),
            Self::CurrentLoopSlow { .. } => Some("current_lag_ms"),
            Self::CannotMove { .. } => Some("friction_mm_per_s2"),
            Self::SubStepsDiffer { .. } => Some("sub_steps"),
            Self::FeedRampsDiffer { .. } => Some("feed_ramp_ms"),
            Self::Unstable { .. } => Some("position_gain_per_s"),
            _ => None,
        }
    }
}

impl fmt::Display for ServoError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match *self {
            Self::NotPositive { key, value } => {
                write!(f, "{key} = {}: expected a positive number", shown(value))
            }
            Self::OutsideDomain { key, value } => {
                write!(f, "{} = {}: expected {}", key.name, shown(value), key.expected())
            }
            Self::OutOfRange { key, value, least, most } => {
                let [value, least, most] = [value, least, most].map(shown);
                write!(f, "{key} = {value}: expected a number from {least} to {most}")
            }
            Self::VelocityLoopOscillates { velocity_gain_percent, limit_percent } => write!(
                f,
                "velocity_gain_percent = {velocity_gain_percent}: the velocity loop oscillates from \
                 velocity_gain_limit_percent = {limit_percent:.0} on; 70 % of that is usual"
            ),
            Self::GainAgainstInertia { velocity_gain_percent, load_inertia_256ths } => write!(
                f,
                "load_inertia_256ths = {load_inertia_256ths}: it sets velocity_gain_percent to {}, and \
                 {velocity_gain_percent} is given; expected one of the two keys",
                velocity_gain_of_load_inertia(load_inertia_256ths)
            ),
            Self::CurrentLoopSlow { current_lag_ms, velocity_lag_ms } => write!(
                f,
                "current_lag_ms = {current_lag_ms}: expected at most {velocity_lag_ms}, the lag of the velocity loop at \
                 its gain, or the velocity rings"
            ),
            Self::SubStepsDiffer { first, other } => {
                write!(f, "sub_steps = {other}: expected {first} as on the first axis")
            }
            Self::FeedRampsDiffer { first, other } => {
                write!(f, "feed_ramp_ms = {other}: expected {first} as on the first axis")
            }
            Self::CannotMove { friction_mm_per_s2, acceleration_limit_mm_per_s2 } => write!(
                f,
                "friction_mm_per_s2 = {friction_mm_per_s2}: expected less than \
                 acceleration_limit_mm_per_s2 = {acceleration_limit_mm_per_s2}, or the axis cannot move"
            ),
            Self::Unstable { position_gain_per_s, largest_gain_per_s, spectral_radius, sub_step_ms } => {
                write!(
                    f,
                    "position_gain_per_s = {position_gain_per_s}: the position loop, closed every {sub_step_ms} ms, is \
                 unstable: an error grows by {spectral_radius:.3} a sub-step; expected less than \
                 {largest_gain_per_s:.1} 1/s, or more sub_steps"
                )
            }
            Self::ParameterNotInFormat { what, value, format } => {
                write!(f, "{what} = {value:.3e} is out of range or zero in {format}")
            }
            Self::PositionNotInFormat { axis, value, format } => {
                write!(f, "axis {axis}: position {value} mm is out of range in {format}")
            }
            Self::CircleTooFast { setpoints_per_turn, least } => write!(
                f,
                "the circle is passed in {setpoints_per_turn:.1} interpolation periods: expected at least {least}"
            ),
            Self::DoesNotArrive { end_error_mm, most_mm } => write!(
                f,
                "the table does not follow: it ends {:.3} µm from the end of the path, expected at most {:.3} µm",
                end_error_mm * 1000.0,
                most_mm * 1000.0
            ),
            Self::StaysBehind { reach_mm, commanded_mm } => write!(
                f,
                "the table does not follow: it goes {reach_mm:.4} mm from the start, the path goes {commanded_mm:.4} mm"
            ),
            Self::DoesNotTurn { turned_degrees } => {
                // Adding 0 turns -0.0 into 0.0.
                let turned = (turned_degrees * 10.0).round() / 10.0 + 0.0;
                write!(
                    f,
                    "the table does not follow the circle: it goes {turned:.1}° round the centre in a turn of 360°"
                )
            }
            Self::PathEmpty => write!(f, "the path has no curve, or one without length"),
        }
    }
}

impl std::error::Error for ServoError {}

/// Refuses a value that is not positive and finite.
pub(crate) fn positive(key: &'static str, value: f64) -> Result<f64, ServoError> {
    if value > 0.0 && value.is_finite() { Ok(value) } else { Err(ServoError::NotPositive { key, value }) }
}

/// Refuses a value that is not in the domain of its key.
pub(crate) fn in_domain(key: &'static Key, value: f64) -> Result<(), ServoError> {
    if key.holds(value) { Ok(()) } else { Err(ServoError::OutsideDomain { key, value }) }
}

/// Refuses a value that is not in `least ..= most`.
pub(crate) fn within(key: &'static str, value: f64, least: f64, most: f64) -> Result<f64, ServoError> {
    if (least..=most).contains(&value) {
        Ok(value)
    } else {
        Err(ServoError::OutOfRange { key, value, least, most })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn messages_name_key_value_and_relation() {
        let error = positive("velocity_lag_ms", -1.0).unwrap_err();
        assert_eq!(error.to_string(), "velocity_lag_ms = -1: expected a positive number");
        let error = within("feed_forward", 98.0, 0.0, 1.5).unwrap_err();
        assert_eq!(error.to_string(), "feed_forward = 98: expected a number from 0 to 1.5");
        let error = ServoError::DoesNotArrive { end_error_mm: 0.5, most_mm: 2e-6 };
        let expected = "the table does not follow: it ends 500.000 µm from the end of the path, expected at most 0.002 µm";
        assert_eq!(error.to_string(), expected);
        let error = ServoError::DoesNotTurn { turned_degrees: -0.04 };
        assert!(error.to_string().contains("it goes 0.0° round"), "{error}");
        assert!(positive("x", f64::NAN).is_err() && within("x", f64::NAN, 0.0, 1.0).is_err());
    }
}
