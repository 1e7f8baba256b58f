//! The table `[servo]` of a servo file.

use crate::domain::Domain;
use crate::key::Key;
use crate::machine::ACCELERATIONS;

const TIME: Domain = Domain::of(0.0, 1e4, "ms");
const PLAY: Domain = Domain::of(0.0, 1e2, "mm");
const PART: Domain = Domain::of(0.0, 1.5, "");
const HERTZ: Domain = Domain::of(0.0, 1e6, "Hz");

/// Kp.
pub const POSITION_GAIN: Key = Key::number(
    "position_gain_per_s",
    Domain::of(1e-3, 1e6, "1/s"),
    "Kp of the position loop: commanded velocity over position error",
);
/// τ.
pub const VELOCITY_LAG: Key = Key::number(
    "velocity_lag_ms",
    Domain::of(1e-3, 1e4, "ms"),
    "τ, the lag of the velocity loop at a velocity gain of 100 %",
);
/// τᵢ.
pub const CURRENT_LAG: Key = Key::number(
    "current_lag_ms",
    Domain::of(1e-6, 1e4, "ms").or_zero(),
    "τᵢ, the lag of the current loop below the velocity loop, at most the lag of that loop at its gain",
)
.or(0.0);
/// α.
pub const FEED_FORWARD: Key =
    Key::number("feed_forward", PART, "α, the part of the commanded velocity that is added: 98 % is 0.98")
        .or(0.0);
/// β.
pub const ACCELERATION_FEED_FORWARD: Key = Key::number(
    "acceleration_feed_forward",
    PART,
    "β, the part of τ times the commanded acceleration that is added to the velocity",
)
.or(0.0);
/// g.
pub const VELOCITY_GAIN: Key =
    Key::number("velocity_gain_percent", Domain::of(0.1, 1e6, "%"), "g of the velocity loop: the lag is τ/g")
        .or(100.0);
/// FANUC's parameter 2021.
pub const LOAD_INERTIA: Key = Key::number(
    "load_inertia_256ths",
    Domain::of(0.0, 1e6, ""),
    "inertia of the load in 256ths of the motor's, as FANUC's parameter 2021 has it; it sets `velocity_gain_percent`",
)
.optional("not given");
/// The paper runs at 300 % and says that this is 70 % of the gain at which the loop oscillates.
pub const VELOCITY_GAIN_LIMIT: Key = Key::number(
    "velocity_gain_limit_percent",
    Domain::of(0.1, 1e6, "%"),
    "the velocity gain at which the velocity loop oscillates, measured on the machine",
)
.optional("428.6");
/// The current limit.
pub const ACCELERATION_LIMIT: Key = Key::number(
    "acceleration_limit_mm_per_s2",
    ACCELERATIONS,
    "the largest acceleration of the drive, by its current",
)
.optional("no limit");
/// Coulomb friction.
pub const FRICTION: Key = Key::number(
    "friction_mm_per_s2",
    Domain::of(0.0, 1e9, "mm/s²"),
    "Coulomb friction, as the deceleration that it causes; below the limit of acceleration",
)
.or(0.0);
/// Play.
pub const BACKLASH: Key = Key::number("backlash_mm", PLAY, "play between motor and table").or(0.0);
/// What the control adds for the play.
pub const BACKLASH_COMPENSATION: Key = Key::number(
    "backlash_compensation_mm",
    PLAY,
    "the offset that the control adds to the command at a reversal",
)
.or(0.0);
/// What the control adds after a reversal.
pub const BACKLASH_ACCELERATION: Key = Key::number(
    "backlash_acceleration_mm_per_s2",
    Domain::of(0.0, 1e8, "mm/s²"),
    "acceleration that the control adds after a reversal",
)
.or(0.0);
/// How long.
pub const BACKLASH_ACCELERATION_TIME: Key =
    Key::number("backlash_acceleration_ms", TIME, "how long the control adds it").or(0.0);
/// The encoder's step.
pub const ENCODER: Key = Key::number(
    "encoder_resolution_mm",
    Domain::of(1e-9, 10.0, "mm").or_zero(),
    "step of the encoder; 0 is exact",
)
.or(0.0);
/// After interpolation.
pub const COMMAND_FILTER: Key =
    Key::number("command_filter_ms", TIME, "length of the moving average over the setpoints of each axis")
        .or(0.0);
/// Before interpolation.
pub const FEED_RAMP: Key = Key::number(
    "feed_ramp_ms",
    TIME,
    "length of the moving average over the feed along the path, the same on all axes",
)
.or(0.0);
/// The notch's centre.
pub const FILTER_CENTRE: Key = Key::number(
    "vibration_filter_hz",
    HERTZ,
    "centre of the notch on the velocity command, at most a quarter of the position loop's rate",
)
.or(0.0);
/// The notch's width.
pub const FILTER_WIDTH: Key =
    Key::number("vibration_filter_bandwidth_hz", HERTZ, "width of that notch; 0 is none").or(0.0);
/// A position loop of 0.125 ms at a period of 1 ms is 8.
pub const SUB_STEPS: Key =
    Key::whole("sub_steps", [1, 10_000], "", "cycles of the position loop in an interpolation period")
        .or(8.0);

/// The keys of the table `[servo]`.
pub const KEYS: [Key; 20] = [
    POSITION_GAIN,
    VELOCITY_LAG,
    CURRENT_LAG,
    FEED_FORWARD,
    ACCELERATION_FEED_FORWARD,
    VELOCITY_GAIN,
    LOAD_INERTIA,
    VELOCITY_GAIN_LIMIT,
    ACCELERATION_LIMIT,
    FRICTION,
    BACKLASH,
    BACKLASH_COMPENSATION,
    BACKLASH_ACCELERATION,
    BACKLASH_ACCELERATION_TIME,
    ENCODER,
    COMMAND_FILTER,
    FEED_RAMP,
    FILTER_CENTRE,
    FILTER_WIDTH,
    SUB_STEPS,
];
