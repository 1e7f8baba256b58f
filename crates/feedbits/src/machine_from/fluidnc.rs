//! FluidNC's config.yaml.
//!
//! `axes: x:` has `steps_per_mm`, `max_rate_mm_per_min` and `acceleration_mm_per_sec2`; `junction_deviation_mm` and `arc_tolerance_mm` stand
//! at the begin of a line. FluidNC reads a small part of YAML, keys with values by their indentation, and so does this: files that
//! no reader of YAML takes are in use.

use anyhow::Result;
use domains::machine::{ACCELERATION, AXIS_ACCELERATION, AXIS_VELOCITY, CHORD_ERROR, DEVIATION, FEEDRATE};

use super::draft::{Axis, Corner, Draft, Said, assumed_jerk, increment, lesser};
use super::settings::{Setting, Settings, Taken};

/// FluidNC's own where the file has none.
const DEVIATION_MM: f64 = 0.01;
const ARC_TOLERANCE_MM: f64 = 0.002;

pub(crate) fn is_fluidnc(text: &str) -> bool {
    let settings = settings(text);
    let of_axes = ["max_rate_mm_per_min", "acceleration_mm_per_sec2", "steps_per_mm"];
    settings
        .iter()
        .any(|one| one.name.starts_with("axes.") && of_axes.iter().any(|key| one.name.ends_with(key)))
}

/// The keys with values, each named by those above it with dots between.
fn settings(text: &str) -> Vec<Setting> {
    const DEEPEST: usize = 16;
    let mut above: Vec<(usize, String)> = Vec::new();
    let mut settings = Vec::new();
    for (index, line) in text.lines().enumerate() {
        let words = line.trim();
        let Some((key, value)) = words.split_once(':').filter(|_| !words.starts_with(['#', '-'])) else {
            continue;
        };
        let indentation = line.len() - line.trim_start().len();
        above.retain(|(of_key, _)| *of_key < indentation);
        let (key, value) = (key.trim().to_lowercase(), without_comment(value));
        if above.len() == DEEPEST {
            continue;
        }
        let names: Vec<&str> = above.iter().map(|(_, name)| name.as_str()).chain([key.as_str()]).collect();
        settings.push(Setting { line: index + 1, name: names.join("."), value: value.to_string() });
        if value.is_empty() {
            above.push((indentation, key));
        }
    }
    settings
}

/// A value without quotes and the comment behind it.
fn without_comment(value: &str) -> &str {
    let value = value.split_once(" #").map_or(value, |(value, _)| value).trim();
    let value = if value.starts_with('#') { "" } else { value };
    value.trim_matches(['"', '\''])
}

pub(crate) fn read(name: &str, text: &str) -> Result<Draft> {
    let settings = Settings::new(name, settings(text), false);
    let of_axes = |key: &str, factor, domain| -> Result<[Option<Taken<'_>>; 3]> {
        let of = |axis: &str| settings.scaled(&[&format!("axes.{axis}.{key}")], factor, domain);
        Ok([of("x")?, of("y")?, of("z")?])
    };
    let rates = of_axes("max_rate_mm_per_min", 1.0 / 60.0, &AXIS_VELOCITY)?;
    let accelerations = of_axes("acceleration_mm_per_sec2", 1.0, &AXIS_ACCELERATION)?;
    let steps = [settings.number(&["axes.x.steps_per_mm"])?, settings.number(&["axes.y.steps_per_mm"])?];
    let feedrate = settings.within(lesser(&settings, &rates, "max_rate_mm_per_min")?, &FEEDRATE)?;
    let acceleration =
        settings.within(lesser(&settings, &accelerations, "acceleration_mm_per_sec2")?, &ACCELERATION)?;
    let corner = match settings.number(&["junction_deviation_mm"])? {
        Some(taken) if taken.value == 0.0 => Corner::Stop(format!("{}.", taken.setting.words())),
        Some(taken) => Corner::Deviation(Said::of(settings.within(taken, &DEVIATION)?, "")),
        None => Corner::Deviation(Said::assumed(DEVIATION_MM, "no junction_deviation_mm: FluidNC's own.")),
    };
    let chord_error = match settings.scaled(&["arc_tolerance_mm"], 1.0, &CHORD_ERROR)? {
        Some(taken) => Said::of(taken, ": so far chords are off an arc"),
        None => Said::assumed(
            ARC_TOLERANCE_MM,
            "no arc_tolerance_mm: FluidNC's own; so far chords are off an arc.",
        ),
    };
    let axis = |axis: usize| Axis {
        velocity: rates[axis].map(|rate| Said::of(rate, " mm/min")),
        acceleration: accelerations[axis].map(|taken| Said::of(taken, "")),
        ..Axis::default()
    };
    Ok(Draft {
        period_ms: Said::assumed(
            1.0,
            "1 ms, which a 32-bit processor has time for. FluidNC's steps follow the line, not a chord.",
        ),
        feedrate: Said::in_place_of(
            feedrate,
            " mm/min, the lesser of X and Y: each axis has its own limit; taken where a program commands no feed",
        ),
        acceleration: Said::in_place_of(acceleration, ", the lesser of X and Y: each axis has its own limit"),
        jerk: assumed_jerk(&settings, "FluidNC", acceleration)?,
        chord_error: Some(chord_error),
        increment: increment(&settings, &steps.into_iter().flatten().collect::<Vec<_>>())?,
        corner,
        passes_spindle: laser(&settings),
        axes: [axis(0), axis(1), axis(2)],
        left_out: left_out(&settings),
    })
}

/// Why the machine is a laser, if it is one: a spindle of that kind, or the laser mode of early versions.
fn laser(settings: &Settings) -> Option<String> {
    let is_laser = |one: &&Setting| {
        one.name == "laser" || one.name == "laser_mode" && one.value.eq_ignore_ascii_case("true")
    };
    settings.all().iter().find(is_laser).map(|one| format!("{}: a laser.", one.words()))
}

/// What of the file is not taken.
fn left_out(settings: &Settings) -> Vec<String> {
    let kinematics = settings.all().iter().filter_map(|one| {
        let name = one.name.strip_prefix("kinematics.").filter(|name| !name.contains('.'))?;
        (name != "cartesian")
            .then(|| format!("{}: limits of motors are no limits of axes there.", one.words()))
    });
    kinematics.collect()
}

#[cfg(test)]
pub(super) mod tests {
    use part_program::Junction;

    use super::super::tests::{expect_assumptions, machine_of};

    pub(crate) const SMALL: &str = "\
name: \"little\"
axes:
  shared_stepper_disable_pin: NO_PIN
  x:
    steps_per_mm: 100.000
    max_rate_mm_per_min: 3000   # mm/min
    acceleration_mm_per_sec2: 250
    homing:
      seek_mm_per_min: 200
    motor0:
      pulloff_mm 1.000
  y:
    steps_per_mm: 100
    max_rate_mm_per_min: 2400
    acceleration_mm_per_sec2: 200
  z:
    steps_per_mm: 400
    max_rate_mm_per_min: 600
    acceleration_mm_per_sec2: 80
junction_deviation_mm: 0.020
arc_tolerance_mm: 0.004
";

    #[test]
    fn a_file_of_fluidnc_makes_its_machine() {
        let (machine, made) = machine_of("config.yaml", SMALL);
        assert_eq!((machine.feedrate_mm_per_s, machine.acceleration_mm_per_s2), (40.0, 200.0));
        assert_eq!((machine.jerk_mm_per_s3, machine.interpolation_period_ms), (8000.0, 1.0));
        assert_eq!((machine.chord_error_mm, machine.position_increment_mm), (0.004, 0.01));
        assert_eq!((machine.junction, machine.s_stops), (Junction::DeviationMm(0.02), true));
        assert_eq!(
            (machine.axes.x.velocity_mm_per_s, machine.axes.z.acceleration_mm_per_s2),
            (Some(50.0), Some(80.0))
        );
        expect_assumptions(&made, 4);
    }

    #[test]
    fn what_the_file_does_not_say_is_fluidncs_own() {
        let text = SMALL.replace(
            "junction_deviation_mm: 0.020\narc_tolerance_mm: 0.004\n",
            "Laser:\n  tool_num: 0\nkinematics:\n  CoreXY:\n",
        );
        let (machine, made) = machine_of("config.yaml", &text);
        assert_eq!((machine.s_stops, machine.junction), (false, Junction::DeviationMm(0.01)));
        expect_assumptions(&made, 6);
        assert_eq!(made.said.len(), 7, "{:?}", made.said);
    }
}
