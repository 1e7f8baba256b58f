//! The limits of a machine for the setpoints of a log, per period.

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
            Of::Axis(axis) => AXES.get(axis).copied(),
            _ => None,
        }
    }

    pub(crate) fn unit(&self) -> &'static str {
        UNITS[self.stated.order]
    }
}

/// The limits that hold for a motion with setpoints every `period_s`. The feed along the path is the share of what each step commands.
pub(crate) fn limits_of(machine: &StatedLimits, period_s: f64, feed_mm_per_s: Option<f64>) -> Vec<LogLimit> {
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
    feed.into_iter().chain(total).chain(of_axes).collect()
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
