//! Klipper's printer.cfg.
//!
//! `[printer]` has `max_velocity`, `max_accel`, `max_z_velocity`, `max_z_accel` in mm and s, and `square_corner_velocity`, v: the speed through a
//! corner of 90 degrees, which Klipper turns into a junction deviation of v² (√2 − 1) / `max_accel`. A stepper moves
//! `rotation_distance` mm a turn of `full_steps_per_rotation` times `microsteps` steps.

use anyhow::{Result, bail};
use domains::machine::{ACCELERATION, AXIS_ACCELERATION, AXIS_VELOCITY, DEVIATION, FEEDRATE};

use super::draft::{Axis, Corner, Draft, Said, assumed_jerk, increment};
use super::sections::{self, Style, has_section};
use super::settings::{Settings, Taken};

const STYLE: Style = Style { separators: &[':', '='], has_continued_lines: true };

/// Klipper's own where the file has none, in mm/s.
const SQUARE_CORNER_VELOCITY: f64 = 5.0;
const FULL_STEPS: f64 = 200.0;

pub(crate) fn is_klipper(text: &str) -> bool {
    has_section(text, &["printer", "stepper_x", "mcu"])
}

pub(crate) fn read(name: &str, text: &str) -> Result<Draft> {
    let settings = Settings::new(name, sections::settings(text, &STYLE), false);
    let needed = |key, what| settings.needed(&["printer.max_velocity"], 1.0, key, what);
    let velocity = needed(&AXIS_VELOCITY, "[printer] max_velocity, in mm/s")?;
    let feedrate = needed(&FEEDRATE, "[printer] max_velocity, in mm/s")?;
    let acceleration =
        settings.needed(&["printer.max_accel"], 1.0, &ACCELERATION, "[printer] max_accel, in mm/s²")?;
    let steps: Vec<Taken<'_>> = ["stepper_x", "stepper_y", "stepper_a"]
        .iter()
        .map(|stepper| steps_per_mm(&settings, stepper))
        .collect::<Result<Vec<_>>>()?
        .into_iter()
        .flatten()
        .collect();
    let plane = || Axis { velocity: Some(Said::of(velocity, "")), ..Axis::default() };
    let z = Axis {
        velocity: settings
            .scaled(&["printer.max_z_velocity"], 1.0, &AXIS_VELOCITY)?
            .map(|taken| Said::of(taken, "")),
        acceleration: settings
            .scaled(&["printer.max_z_accel"], 1.0, &AXIS_ACCELERATION)?
            .map(|taken| Said::of(taken, "")),
        ..Axis::default()
    };
    Ok(Draft {
        period_ms: Said::assumed(1.0, "1 ms: Klipper has no period. It finds the time of every step."),
        feedrate: Said::of(feedrate, "; taken where a program commands no feed"),
        acceleration: Said::of(acceleration, ""),
        jerk: assumed_jerk(&settings, "Klipper", acceleration)?,
        chord_error: None,
        increment: increment(&settings, &steps)?,
        corner: corner(&settings, acceleration)?,
        passes_spindle: None,
        axes: [plane(), plane(), z],
        left_out: left_out(text, &settings),
    })
}

/// The junction deviation of the speed through a corner.
fn corner(settings: &Settings, acceleration: Taken<'_>) -> Result<Corner> {
    let deviation =
        |velocity: f64| velocity * velocity * (std::f64::consts::SQRT_2 - 1.0) / acceleration.value;
    let Some(taken) = settings.number(&["printer.square_corner_velocity"])? else {
        let value = settings
            .within(Taken { value: deviation(SQUARE_CORNER_VELOCITY), ..acceleration }, &DEVIATION)?
            .value;
        let why = "no square_corner_velocity: Klipper's own 5 mm/s, v² (√2 - 1) / max_accel.";
        return Ok(Corner::Deviation(Said::assumed(value, why)));
    };
    if taken.value == 0.0 {
        return Ok(Corner::Stop(format!("{}.", taken.setting.words())));
    }
    let taken = settings.within(Taken { value: deviation(taken.value), ..taken }, &DEVIATION)?;
    Ok(Corner::Deviation(Said::of(taken, ": v² (√2 - 1) / max_accel")))
}

/// Steps a millimetre of a stepper, if the file has it.
fn steps_per_mm<'s>(settings: &'s Settings, stepper: &str) -> Result<Option<Taken<'s>>> {
    let key = |key: &str| format!("{stepper}.{key}");
    if let Some(taken) = settings.number(&[&key("step_distance")])? {
        return Ok(Some(Taken { value: 1.0 / taken.value, ..taken }));
    }
    let Some(distance) = settings.number(&[&key("rotation_distance")])? else { return Ok(None) };
    let microsteps = settings.number(&[&key("microsteps")])?.map_or(1.0, |taken| taken.value);
    let full_steps =
        settings.number(&[&key("full_steps_per_rotation")])?.map_or(FULL_STEPS, |taken| taken.value);
    let gears = match settings.find(&key("gear_ratio")) {
        Some(setting) => match gear_ratio(&setting.value) {
            Some(ratio) => ratio,
            None => bail!("{}: expected ratios such as 80:20", settings.at(setting)),
        },
        None => 1.0,
    };
    Ok(Some(Taken { value: full_steps * microsteps * gears / distance.value, ..distance }))
}

/// The product of ratios such as `5:1, 80:20`.
fn gear_ratio(text: &str) -> Option<f64> {
    let ratio = |one: &str| {
        let (motor, axis) = one.split_once(':')?;
        Some(motor.trim().parse::<f64>().ok()? / axis.trim().parse::<f64>().ok()?)
    };
    text.split(',').map(|one| ratio(one.trim())).product()
}

/// What of the file is not read.
fn left_out(text: &str, settings: &Settings) -> Vec<String> {
    let included = text.lines().filter(|line| line.trim_start().starts_with("[include ")).count();
    let mut left_out = Vec::new();
    if included > 0 {
        left_out.push(format!("{included} other files, which [include] names, are not read."));
    }
    let kinematics = settings.find("printer.kinematics");
    let kinematics = kinematics
        .filter(|one| !["cartesian", "corexy", "corexz", "hybrid_corexy"].contains(&one.value.as_str()));
    left_out.extend(kinematics.map(|one| format!("{}: limits of its own kinematics.", one.words())));
    left_out
}

#[cfg(test)]
pub(super) mod tests {
    use part_program::Junction;

    use super::super::tests::{expect_assumptions, machine_of};

    pub(crate) const SMALL: &str = "\
# my printer
[printer]
kinematics: cartesian
max_velocity: 250   # mm/s
max_accel: 2500
max_z_velocity = 6
max_z_accel: 120
square_corner_velocity: 4
[stepper_x]
microsteps: 16
rotation_distance: 32
[stepper_y]
microsteps: 32
rotation_distance: 32
gear_ratio: 40:20
[gcode_macro START]
gcode:
    G28
    max_velocity: 1
#*# <- SAVE_CONFIG ->
#*# max_accel = 1
";

    #[test]
    fn a_file_of_klipper_makes_its_machine() {
        let (machine, made) = machine_of("printer.cfg", SMALL);
        assert_eq!((machine.feedrate_mm_per_s, machine.acceleration_mm_per_s2), (250.0, 2500.0));
        assert_eq!((machine.jerk_mm_per_s3, machine.position_increment_mm), (100_000.0, 0.01));
        let Junction::DeviationMm(deviation) = machine.junction else { panic!("{:?}", machine.junction) };
        // 4² (√2 - 1) / 2500
        assert!((deviation - 16.0 * 0.414_213_562 / 2500.0).abs() < 1e-9, "{deviation}");
        assert_eq!(
            (machine.axes.z.velocity_mm_per_s, machine.axes.z.acceleration_mm_per_s2),
            (Some(6.0), Some(120.0))
        );
        expect_assumptions(&made, 2);
    }

    #[test]
    fn what_the_file_does_not_say_is_klippers_own() {
        let text = SMALL
            .replace("square_corner_velocity: 4\n", "[include more.cfg]\n")
            .replace("cartesian", "delta");
        let (_, made) = machine_of("printer.cfg", &text);
        expect_assumptions(&made, 3);
        assert_eq!(made.said.len(), 5, "{:?}", made.said);
        let (machine, _) = machine_of("printer.cfg", &SMALL.replace("velocity: 4", "velocity: 0"));
        assert_eq!(machine.junction, Junction::Stop);
    }
}
