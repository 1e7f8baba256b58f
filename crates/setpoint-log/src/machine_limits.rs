//! The limits of a machine for the setpoints of a log, per period.

use domains::machine::{ACCELERATION, AXIS_ACCELERATION, AXIS_JERK, AXIS_VELOCITY, FEEDRATE, JERK};
use domains::{Key, shown};
use limit_judge::{Of, StatedLimit};
use part_program::{Junction, StatedLimits};

use crate::period::ClockLimits;

/// A limit, with its value in the machine's unit.
#[derive(Clone, Copy, Debug)]
pub(crate) struct LogLimit {
    pub(crate) stated: StatedLimit,
    pub(crate) value: f64,
}

const AXES: [&str; 3] = ["X", "Y", "Z"];
const UNITS: [&str; 3] = ["mm/s", "mm/s²", "mm/s³"];

impl LogLimit {
    pub(crate) fn axis(&self) -> Option<&'static str> {
        match self.stated.of {
            Of::Axis(axis) | Of::Jump(axis) => AXES.get(axis).copied(),
            _ => None,
        }
    }

    pub(crate) fn unit(&self) -> &'static str {
        UNITS[self.stated.order]
    }
}

/// The limits that hold for a motion with setpoints every `period_s`. The feed along the path is the share of what each step commands.
/// `knows_turns` says whether it is known by how much the path turns at corners, where velocities may jump.
pub(crate) fn limits_of(
    machine: &StatedLimits,
    period_s: f64,
    feed_mm_per_s: Option<f64>,
    knows_turns: bool,
) -> Vec<LogLimit> {
    let powers = [period_s, period_s.powi(2), period_s.powi(3)];
    let feed = feed_mm_per_s
        .map(|value| LogLimit { stated: StatedLimit { of: Of::Vector, order: 0, most: 1.0 }, value });
    let total = machine.acceleration_mm_per_s2.zip(machine.centripetal_acceleration_mm_per_s2);
    let total = total.map(|(along, across)| {
        let value = along.hypot(across);
        LogLimit { stated: StatedLimit { of: Of::Vector, order: 1, most: value * powers[1] }, value }
    });
    let axes = [machine.axes.x, machine.axes.y, machine.axes.z];
    let of_axes = axes.into_iter().enumerate().flat_map(|(axis, limits)| {
        let values = [limits.velocity_mm_per_s, limits.acceleration_mm_per_s2, limits.jerk_mm_per_s3];
        let one = move |(order, value): (usize, Option<f64>)| {
            let value = value?;
            let stated = StatedLimit { of: Of::Axis(axis), order, most: value * powers[order] };
            Some(LogLimit { stated, value })
        };
        values.into_iter().enumerate().filter_map(one)
    });
    let may_jump = machine.junction == Junction::VelocityJump && knows_turns;
    let jumps = axes.into_iter().enumerate().filter(|_| may_jump).filter_map(|(axis, limits)| {
        let value = limits.velocity_jump_mm_per_s?;
        Some(LogLimit { stated: StatedLimit { of: Of::Jump(axis), order: 0, most: value * period_s }, value })
    });
    feed.into_iter().chain(total).chain(of_axes).chain(jumps).collect()
}

/// Leaves out the limits of axes of which a log has no positions, and has a sentence for each such axis.
pub(crate) fn not_in_log(limits: &mut Vec<LogLimit>, has_axes: [bool; 3]) -> Vec<String> {
    let is_of = |limit: &LogLimit, axis: usize| limit.axis() == Some(AXES[axis]);
    let missing: Vec<usize> =
        (0..3).filter(|axis| !has_axes[*axis] && limits.iter().any(|limit| is_of(limit, *axis))).collect();
    limits.retain(|limit| !missing.iter().any(|axis| is_of(limit, *axis)));
    missing.into_iter().map(|axis| format!("limits of {}: the log has no column of it", AXES[axis])).collect()
}

/// The most by which each axis changes its step within a period, in mm, where the machine bounds that: one that stops at corners does.
pub(crate) fn most_turns(machine: &StatedLimits, junction: Junction, period_s: f64) -> [Option<f64>; 3] {
    let axes = [machine.axes.x, machine.axes.y, machine.axes.z];
    let stops = junction == Junction::Stop;
    axes.map(|axis| Some(axis.acceleration_mm_per_s2.filter(|_| stops)? * period_s.powi(2)))
}

/// What the clock has to know of a machine. Where the velocity may jump, so much more.
pub(crate) fn clock_limits(machine: &StatedLimits, period_s: f64) -> ClockLimits {
    let axes = [machine.axes.x, machine.axes.y, machine.axes.z];
    let change_mm = axes.map(|axis| {
        let jump = axis.velocity_jump_mm_per_s.filter(|_| machine.junction == Junction::VelocityJump);
        let own = axis.acceleration_mm_per_s2?;
        Some(own * period_s.powi(2) + jump.unwrap_or(0.0) * period_s)
    });
    ClockLimits { period_s, change_mm }
}

/// A sentence for each limit that the machine's file does not state. A value that the file only assumes is no stated
/// limit.
pub(crate) fn not_stated(machine: &StatedLimits, feed_mm_per_s: Option<f64>) -> Vec<String> {
    let along = |name: &str, has: bool, of: &str, key: &Key| {
        let said = match machine.assumed_value(None, key.name) {
            Some(value) => format!("{name}: the machine's file assumes {} {}", shown(value), key.unit()),
            None => format!("{name}: {of}"),
        };
        (!has).then_some(said)
    };
    let of_path = [
        along("feed", feed_mm_per_s.is_some(), "neither the machine nor a part states one", &FEEDRATE),
        along(
            "acceleration along the path",
            machine.acceleration_mm_per_s2.is_some(),
            "the machine states none",
            &ACCELERATION,
        ),
        along("jerk along the path", machine.jerk_mm_per_s3.is_some(), "the machine states none", &JERK),
    ];
    let axes = [machine.axes.x, machine.axes.y, machine.axes.z];
    let of_axes = [
        ("velocity", axes.map(|axis| axis.velocity_mm_per_s), AXIS_VELOCITY),
        ("acceleration", axes.map(|axis| axis.acceleration_mm_per_s2), AXIS_ACCELERATION),
        ("jerk", axes.map(|axis| axis.jerk_mm_per_s3), AXIS_JERK),
    ];
    let lacks = |(name, has, key): (&str, [Option<f64>; 3], Key)| {
        let missing: Vec<usize> = (0..3).filter(|axis| has[*axis].is_none()).collect();
        let (assumed, unknown): (Vec<usize>, Vec<usize>) = missing
            .into_iter()
            .partition(|axis| machine.assumed_value(Some(["x", "y", "z"][*axis]), key.name).is_some());
        [(assumed, "the machine's file assumes one"), (unknown, "the machine states none")].map(
            |(of, why)| {
                let of: Vec<&str> = of.into_iter().map(|axis| AXES[axis]).collect();
                (!of.is_empty()).then(|| format!("{name} of {}: {why}", of.join(", ")))
            },
        )
    };
    of_path.into_iter().chain(of_axes.into_iter().flat_map(lacks)).flatten().collect()
}
