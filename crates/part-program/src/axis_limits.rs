//! Limits of single axes: the tables `[machine.axes.x]` of a TOML file, and so on.

use domains::Key;
use domains::machine::{
    AXIS_ACCELERATION, AXIS_JERK, AXIS_KEYS, AXIS_VELOCITY, ROTARY_ACCELERATION, ROTARY_JERK, ROTARY_JUMP,
    ROTARY_KEYS, ROTARY_VELOCITY, VELOCITY_JUMP,
};
use serde::Serialize;
use toml::de::DeTable;

use crate::assumed_value::{AssumedValue, assumed};
use crate::diagnostic::Report;
use crate::source::Span;
use crate::toml_table::TableReader;

/// Limits of single axes, where the file gives them.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize)]
pub struct Axes {
    /// Table `[machine.axes.x]`.
    pub x: AxisLimits,
    /// Table `[machine.axes.y]`.
    pub y: AxisLimits,
    /// Table `[machine.axes.z]`.
    pub z: AxisLimits,
    /// Table `[machine.axes.a]`.
    #[serde(skip_serializing_if = "is_default")]
    pub a: RotaryLimits,
    /// Table `[machine.axes.b]`.
    #[serde(skip_serializing_if = "is_default")]
    pub b: RotaryLimits,
    /// Table `[machine.axes.c]`.
    #[serde(skip_serializing_if = "is_default")]
    pub c: RotaryLimits,
    /// Table `[machine.axes.u]`.
    #[serde(skip_serializing_if = "is_default")]
    pub u: AxisLimits,
    /// Table `[machine.axes.v]`.
    #[serde(skip_serializing_if = "is_default")]
    pub v: AxisLimits,
    /// Table `[machine.axes.w]`.
    #[serde(skip_serializing_if = "is_default")]
    pub w: AxisLimits,
}

/// Serde hands over a reference.
fn is_default<T: Default + PartialEq>(limits: &T) -> bool {
    *limits == T::default()
}

impl Axes {
    /// The limits of the side axes, in degrees or mm, in the order of [`SIDE_AXES`](crate::SIDE_AXES).
    #[must_use]
    pub fn of_side_axes(&self) -> [SideLimits; 6] {
        let [a, b, c] = [self.a, self.b, self.c].map(|axis| SideLimits {
            velocity: axis.velocity_deg_per_s,
            acceleration: axis.acceleration_deg_per_s2,
            jerk: axis.jerk_deg_per_s3,
            velocity_jump: axis.velocity_jump_deg_per_s,
        });
        let [u, v, w] = [self.u, self.v, self.w].map(|axis| SideLimits {
            velocity: axis.velocity_mm_per_s,
            acceleration: axis.acceleration_mm_per_s2,
            jerk: axis.jerk_mm_per_s3,
            velocity_jump: axis.velocity_jump_mm_per_s,
        });
        [a, b, c, u, v, w]
    }
}

/// The limits of an axis that turns.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize)]
pub struct RotaryLimits {
    /// In degrees/s.
    pub velocity_deg_per_s: Option<f64>,
    /// In degrees/s².
    pub acceleration_deg_per_s2: Option<f64>,
    /// In degrees/s³.
    pub jerk_deg_per_s3: Option<f64>,
    /// Where its share of the path changes, in degrees/s.
    pub velocity_jump_deg_per_s: Option<f64>,
}

/// The limits of a side axis, in its unit, degrees or mm, and seconds.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct SideLimits {
    /// The largest velocity.
    pub velocity: Option<f64>,
    /// The largest acceleration.
    pub acceleration: Option<f64>,
    /// The largest jerk.
    pub jerk: Option<f64>,
    /// The largest jump of the velocity where the axis' share of the path changes.
    pub velocity_jump: Option<f64>,
}

/// The limits of one axis.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize)]
pub struct AxisLimits {
    /// In mm/s.
    pub velocity_mm_per_s: Option<f64>,
    /// In mm/s².
    pub acceleration_mm_per_s2: Option<f64>,
    /// In mm/s³.
    pub jerk_mm_per_s3: Option<f64>,
    /// At a break of the tangent, in mm/s.
    pub velocity_jump_mm_per_s: Option<f64>,
}

impl RotaryLimits {
    /// Each limit with its key.
    pub(crate) fn by_keys(&mut self) -> Vec<(&'static Key, &mut Option<f64>)> {
        vec![
            (&ROTARY_VELOCITY, &mut self.velocity_deg_per_s),
            (&ROTARY_ACCELERATION, &mut self.acceleration_deg_per_s2),
            (&ROTARY_JERK, &mut self.jerk_deg_per_s3),
            (&ROTARY_JUMP, &mut self.velocity_jump_deg_per_s),
        ]
    }
}

impl AxisLimits {
    /// Each limit with its key.
    pub(crate) fn by_keys(&mut self) -> Vec<(&'static Key, &mut Option<f64>)> {
        vec![
            (&AXIS_VELOCITY, &mut self.velocity_mm_per_s),
            (&AXIS_ACCELERATION, &mut self.acceleration_mm_per_s2),
            (&AXIS_JERK, &mut self.jerk_mm_per_s3),
            (&VELOCITY_JUMP, &mut self.velocity_jump_mm_per_s),
        ]
    }
}

/// The limits of axes, and their assumed values.
pub(crate) fn axes_from(
    report: &mut Report<'_>,
    header: Span,
    table: &DeTable<'_>,
) -> (Axes, Vec<AssumedValue>) {
    let mut assumed = Vec::new();
    let mut linear = |key| axis_from(report, (header, table), key, (&AXIS_KEYS, linear_limits), &mut assumed);
    let [x, y, z, u, v, w] = ["x", "y", "z", "u", "v", "w"].map(&mut linear);
    let mut rotary =
        |key| axis_from(report, (header, table), key, (&ROTARY_KEYS, rotary_limits), &mut assumed);
    let [a, b, c] = ["a", "b", "c"].map(&mut rotary);
    let axes = Axes { x, y, z, a, b, c, u, v, w };
    let mut keys = TableReader::new(report, "[machine.axes]", header, table);
    for key in ["x", "y", "z", "a", "b", "c", "u", "v", "w"] {
        keys.optional(key);
    }
    keys.finish();
    (axes, assumed)
}

/// Reads the table of one axis, if there is one, and adds its assumed values to `of_axes`.
fn axis_from<L: Default>(
    report: &mut Report<'_>,
    (header, table): (Span, &DeTable<'_>),
    key: &'static str,
    (known, limits_of): (&[Key], fn(&mut TableReader<'_, '_, '_>) -> L),
    of_axes: &mut Vec<AssumedValue>,
) -> L {
    let mut keys = TableReader::new(report, "[machine.axes]", header, table);
    let Some((header, table)) = keys.table(key) else { return L::default() };
    let mut keys = TableReader::new(report, format!("[machine.axes.{key}]"), header, table);
    let limits = limits_of(&mut keys);
    of_axes.extend(assumed(&mut keys, Some(key), known));
    keys.finish();
    limits
}

fn linear_limits(keys: &mut TableReader<'_, '_, '_>) -> AxisLimits {
    AxisLimits {
        velocity_mm_per_s: keys.optional_number(&AXIS_VELOCITY),
        acceleration_mm_per_s2: keys.optional_number(&AXIS_ACCELERATION),
        jerk_mm_per_s3: keys.optional_number(&AXIS_JERK),
        velocity_jump_mm_per_s: keys.optional_number(&VELOCITY_JUMP),
    }
}

fn rotary_limits(keys: &mut TableReader<'_, '_, '_>) -> RotaryLimits {
    RotaryLimits {
        velocity_deg_per_s: keys.optional_number(&ROTARY_VELOCITY),
        acceleration_deg_per_s2: keys.optional_number(&ROTARY_ACCELERATION),
        jerk_deg_per_s3: keys.optional_number(&ROTARY_JERK),
        velocity_jump_deg_per_s: keys.optional_number(&ROTARY_JUMP),
    }
}
