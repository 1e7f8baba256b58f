//! The tables `[machine]` and `[machine.axes.x]` of a machine file.

use crate::domain::Domain;
use crate::key::{Key, LeftOut, Value};

/// From a controller at 1 MHz to one that sets a point a second.
const PERIOD_DOMAIN: Domain = Domain::of(1e-3, 1e3, "ms");
/// From a nanometre a second to a hundred metres a second.
pub const FEED: Domain = Domain::of(1e-6, 1e5, "mm/s");
/// From a ten-millionth of the acceleration of gravity to ten thousand times it.
pub const ACCELERATIONS: Domain = Domain::of(1e-3, 1e8, "mm/s²");
const JERKS: Domain = Domain::of(1e-3, 1e12, "mm/s³");
/// From a picometre, which no drive resolves, to a decimetre.
const DISTANCE: Domain = Domain::of(1e-9, 1e2, "mm");
/// Below that, a double tells no ratio from 0.
const RATIO: Domain = Domain::ratio(1e-16);

/// T, the time between two setpoints.
pub const PERIOD: Key =
    Key::number("interpolation_period_ms", PERIOD_DOMAIN, "T, the time between two setpoints");
/// F, where the part commands no feed.
pub const FEEDRATE: Key = Key::number(
    "feedrate_mm_per_s",
    FEED,
    "F where the part commands no feed; it is not a limit: a part that commands more runs faster",
);
/// A, along the path.
pub const ACCELERATION: Key =
    Key::number("acceleration_mm_per_s2", ACCELERATIONS, "A, the most along the path");
/// J, along the path.
pub const JERK: Key = Key::number("jerk_mm_per_s3", JERKS, "J, the most along the path");
/// E, the micrometre that a mill or a stage is built to; paper A takes half of it.
pub const CHORD_ERROR: Key = Key::number(
    "chord_error_mm",
    DISTANCE,
    "E, the largest distance allowed between the curve and the straight line between two setpoints; if a corner lies between \
     them, the greater of E and `junction_deviation_mm` is allowed",
)
.or(1e-3);
/// Δ. 1e-4 of a step of 0.1 mm, 100 mm/s at 1 ms, is the 10 nm that drives tell apart.
pub const FLUCTUATION_LIMIT: Key = Key::number(
    "fluctuation_limit",
    RATIO,
    "Δ, the largest fluctuation allowed for a step at cruise; `--fluctuation` overrides it",
)
.or(1e-4);
/// ε. 1e-10 is a nanometre of a path of 10 m.
pub const PARAMETER_TOLERANCE: Key = Key::number(
    "parameter_tolerance",
    RATIO,
    "ε, the change of the global parameter at which the textbook's solver may stop",
)
.or(1e-10);
/// K. More iterations than the upper end are a loop, not a solver.
pub const MAX_ITERATIONS: Key = Key::whole(
    "max_iterations",
    [1, 1000],
    "",
    "K, the evaluations that all pieces of a step share; each further piece takes up to two when they are used up",
)
.or(8.0);
/// Whether the machine rests at words for the spindle.
pub const S_STOPS: Key = Key {
    name: "s_stops",
    value: Value::Truth,
    left_out: LeftOut::Words("true"),
    meaning: "whether the machine rests at S words and at M3, M4 and M5; a laser passes them",
};
/// 10 nm, as FANUC's increment system IS-D.
pub const INCREMENT: Key = Key::number(
    "position_increment_mm",
    DISTANCE,
    "the least step that the drives resolve; a setpoint may be this far off the path",
)
.or(1e-5);
/// Across the path.
pub const CENTRIPETAL: Key =
    Key::number("centripetal_acceleration_mm_per_s2", ACCELERATIONS, "the most across the path, V²/ρ")
        .optional("no limit but E's");
/// How the tool passes a break of the tangent.
pub const JUNCTION: Key = Key {
    name: "junction",
    value: Value::Word(&["stop", "deviation", "velocity-jump"]),
    left_out: LeftOut::Words("`\"stop\"`"),
    meaning: "how the tool passes a break of the tangent: it rests there; it passes as if the corner were rounded; each axis \
              may jump in velocity",
};
/// δ.
pub const DEVIATION: Key = Key::number(
    "junction_deviation_mm",
    DISTANCE,
    "δ, with `\"deviation\"`: the distance by which a corner may be cut; passed corners are judged by the greater of δ and E",
)
.optional("");
/// The keys of a table whose values the machine's control does not state.
pub const ASSUMED: Key = Key {
    name: "assumed",
    value: Value::Keys,
    left_out: LeftOut::Words("`[]`"),
    meaning: "keys of this table that the machine's control does not state: a plan keeps their values, and `judge` judges a log by \
              them only if it is asked to",
};

/// The keys of the table `[machine]`.
pub const KEYS: [Key; 14] = [
    PERIOD,
    FEEDRATE,
    ACCELERATION,
    JERK,
    CHORD_ERROR,
    FLUCTUATION_LIMIT,
    PARAMETER_TOLERANCE,
    MAX_ITERATIONS,
    S_STOPS,
    INCREMENT,
    CENTRIPETAL,
    JUNCTION,
    DEVIATION,
    ASSUMED,
];

/// The most of one axis.
pub const AXIS_VELOCITY: Key = Key::number("velocity_mm_per_s", FEED, "the most of that axis").optional("");
/// The most of one axis.
pub const AXIS_ACCELERATION: Key =
    Key::number("acceleration_mm_per_s2", ACCELERATIONS, "the most of that axis").optional("");
/// The most of one axis.
pub const AXIS_JERK: Key = Key::number("jerk_mm_per_s3", JERKS, "the most of that axis").optional("");
/// The most at a break of the tangent.
pub const VELOCITY_JUMP: Key = Key::number(
    "velocity_jump_mm_per_s",
    FEED,
    "with `junction = \"velocity-jump\"`: the largest jump at a break of the tangent; without the key the axis may not jump. \
     The plan does not limit by how much such a jump cuts the corner; a verdict allows E",
)
.optional("");

/// From a millionth of a degree a second to nearly three hundred turns a second.
const ROTARY_FEED: Domain = Domain::of(1e-6, 1e5, "degrees/s");
/// The largest velocity of an axis that turns.
pub const ROTARY_VELOCITY: Key =
    Key::number("velocity_deg_per_s", ROTARY_FEED, "the most of that axis").optional("");
/// The largest acceleration of an axis that turns.
pub const ROTARY_ACCELERATION: Key =
    Key::number("acceleration_deg_per_s2", Domain::of(1e-3, 1e8, "degrees/s²"), "the most of that axis")
        .optional("");
/// The largest jerk of an axis that turns.
pub const ROTARY_JERK: Key =
    Key::number("jerk_deg_per_s3", Domain::of(1e-3, 1e12, "degrees/s³"), "the most of that axis")
        .optional("");
/// The largest jump of its velocity where the angle that it turns along a mm of the path changes.
pub const ROTARY_JUMP: Key = Key::number(
    "velocity_jump_deg_per_s",
    ROTARY_FEED,
    "the largest jump where the angle turned along a mm of the path changes; without the key, as much as a period hides",
)
.optional("");

/// The keys of the table `[machine.axes.a]`, `.b` or `.c`.
pub const ROTARY_KEYS: [Key; 5] = [ROTARY_VELOCITY, ROTARY_ACCELERATION, ROTARY_JERK, ROTARY_JUMP, ASSUMED];

/// The keys of the table `[machine.axes.x]`, `.y`, `.z`, `.u`, `.v` or `.w`.
pub const AXIS_KEYS: [Key; 5] = [AXIS_VELOCITY, AXIS_ACCELERATION, AXIS_JERK, VELOCITY_JUMP, ASSUMED];
