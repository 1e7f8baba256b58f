//! LinuxCNC's INI file.
//!
//! `[TRAJ]` has the unit of all lengths, `LINEAR_UNITS`, and limits along the path; `[AXIS_X]` to `[AXIS_Z]`, `[AXIS_0]` to `[AXIS_2]` before
//! version 2.8, have those of axes; `[JOINT_0]` and so on the drives. `[EMCMOT] SERVO_PERIOD` is the interpolation period, in ns. With
//! `PLANNER_TYPE = 1` and `MAX_LINEAR_JERK` the plan has a limit of the jerk.

use anyhow::{Result, bail};
use domains::machine::{
    ACCELERATION, AXIS_ACCELERATION, AXIS_JERK, AXIS_VELOCITY, DEVIATION, FEEDRATE, JERK, PERIOD,
};

use super::draft::{Axis, Corner, Draft, Said, assumed_jerk, increment, lesser};
use super::sections::{self, Style, has_section};
use super::settings::{Settings, Taken};

const STYLE: Style = Style { separators: &['='], has_continued_lines: false };

const INCH_MM: f64 = 25.4;

/// LinuxCNC's servo period where the file has none, in ns.
const SERVO_PERIOD_NS: f64 = 1e6;

pub(crate) fn is_linuxcnc(text: &str) -> bool {
    has_section(text, &["TRAJ", "EMCMOT", "KINS", "RS274NGC", "AXIS_X", "AXIS_0"])
}

/// The length of a unit of the file, in mm.
fn unit_mm(settings: &Settings) -> Result<f64> {
    let Some(unit) = settings.find("TRAJ.LINEAR_UNITS") else { return Ok(1.0) };
    match unit.value.to_lowercase().as_str() {
        "mm" | "metric" => Ok(1.0),
        "inch" | "in" | "imperial" => Ok(INCH_MM),
        // A number is that of units in a millimetre.
        other => match other.parse::<f64>() {
            Ok(per_mm) if (1e-3..=1e3).contains(&per_mm) => Ok(1.0 / per_mm),
            _ => bail!("{}: expected mm, inch or the units in a millimetre", settings.at(unit)),
        },
    }
}

/// The number of an axis, from the first of its sections that has it.
fn of_axes<'s>(
    settings: &'s Settings,
    key: &str,
    factor: f64,
    domain: &domains::Key,
) -> Result<[Option<Taken<'s>>; 3]> {
    let of = |axis: usize| {
        let letter = ["X", "Y", "Z"][axis];
        let [new, old, joint] =
            [format!("AXIS_{letter}.{key}"), format!("AXIS_{axis}.{key}"), format!("JOINT_{axis}.{key}")];
        settings.scaled(&[&new, &old, &joint], factor, domain)
    };
    Ok([of(0)?, of(1)?, of(2)?])
}

pub(crate) fn read(name: &str, text: &str) -> Result<Draft> {
    let settings = Settings::new(name, sections::settings(text, &STYLE), true);
    let unit = unit_mm(&settings)?;
    let velocities = of_axes(&settings, "MAX_VELOCITY", unit, &AXIS_VELOCITY)?;
    let accelerations = of_axes(&settings, "MAX_ACCELERATION", unit, &AXIS_ACCELERATION)?;
    let jerks = of_axes(&settings, "MAX_JERK", unit, &AXIS_JERK)?;
    let most = ["TRAJ.MAX_LINEAR_ACCELERATION", "TRAJ.MAX_ACCELERATION"];
    let most = settings.scaled(&most, unit, &ACCELERATION)?;
    let taken = settings.scaled(&["TRAJ.DEFAULT_LINEAR_ACCELERATION"], unit, &ACCELERATION)?;
    let acceleration = match most.or(taken) {
        Some(taken) => taken,
        None => lesser(&settings, &accelerations, "[TRAJ] MAX_LINEAR_ACCELERATION or MAX_ACCELERATION")?,
    };
    let said_acceleration = if most.is_some() {
        Said::of(acceleration, "")
    } else {
        Said::in_place_of(acceleration, ": no limit of the path")
    };
    let most = settings.scaled(&["TRAJ.MAX_LINEAR_VELOCITY", "TRAJ.MAX_VELOCITY"], unit, &FEEDRATE)?;
    let commanded = ["TRAJ.DEFAULT_LINEAR_VELOCITY", "TRAJ.DEFAULT_VELOCITY"];
    let commanded = settings.scaled(&commanded, unit, &FEEDRATE)?;
    let feedrate = match most.or(commanded) {
        Some(taken) => taken,
        None => lesser(&settings, &velocities, "[TRAJ] MAX_LINEAR_VELOCITY or DEFAULT_LINEAR_VELOCITY")?,
    };
    let why = "; taken where a program commands no feed";
    let said_feedrate = if most.is_some() {
        Said::of(feedrate, why)
    } else {
        Said::in_place_of(feedrate, &format!(": no limit of the path{why}"))
    };
    let period_ms = match settings.scaled(&["EMCMOT.SERVO_PERIOD"], 1e-6, &PERIOD)? {
        Some(taken) => Said::of(taken, " ns"),
        None => Said::assumed(SERVO_PERIOD_NS * 1e-6, "no [EMCMOT] SERVO_PERIOD: LinuxCNC's own."),
    };
    let (is_jerk_limited, jerks) = match planned_jerk(&settings, unit)? {
        Some(taken) => (Ok(taken), jerks),
        None => (Err(()), [None; 3]),
    };
    let jerk = match is_jerk_limited {
        Ok(taken) => Said::of(taken, ", with PLANNER_TYPE = 1"),
        Err(()) => assumed_jerk(
            &settings,
            "LinuxCNC's planner without PLANNER_TYPE = 1 and MAX_LINEAR_JERK",
            acceleration,
        )?,
    };
    let axis = |axis: usize| Axis {
        velocity: velocities[axis].map(|taken| Said::of(taken, "")),
        acceleration: accelerations[axis].map(|taken| Said::of(taken, "")),
        jerk: jerks[axis].map(|taken| Said::of(taken, "")),
        jump: None,
    };
    Ok(Draft {
        period_ms,
        feedrate: said_feedrate,
        acceleration: said_acceleration,
        jerk,
        chord_error: None,
        increment: increment(&settings, &steps_per_mm(&settings, unit)?)?,
        corner: corner(&settings)?,
        passes_spindle: None,
        axes: [axis(0), axis(1), axis(2)],
        left_out: left_out(text, &settings),
    })
}

/// The jerk along the path, if the planner limits it.
fn planned_jerk(settings: &Settings, unit: f64) -> Result<Option<Taken<'_>>> {
    let planner = settings.number(&["TRAJ.PLANNER_TYPE"])?;
    if planner.is_none_or(|planner| planner.value != 1.0) {
        return Ok(None);
    }
    let is_given = settings.number(&["TRAJ.MAX_LINEAR_JERK"])?.is_some_and(|jerk| jerk.value != 0.0);
    if is_given { settings.scaled(&["TRAJ.MAX_LINEAR_JERK"], unit, &JERK) } else { Ok(None) }
}

/// Steps or counts a millimetre of the joints of X and Y.
fn steps_per_mm(settings: &Settings, unit: f64) -> Result<Vec<Taken<'_>>> {
    let mut steps = Vec::new();
    for (joint, letter) in [(0, "X"), (1, "Y")] {
        let names = ["JOINT", "AXIS"].map(|section| {
            ["STEP_SCALE", "SCALE", "OUTPUT_SCALE", "INPUT_SCALE"]
                .map(|key| format!("{section}_{joint}.{key}"))
        });
        let names: Vec<&str> = names.iter().flatten().map(String::as_str).collect();
        let by_letter = format!("AXIS_{letter}.SCALE");
        let names = [&names[..], &[&by_letter]].concat();
        let Some(setting) = names.iter().find_map(|name| settings.find(name)) else { continue };
        // Older files have an offset behind the scale.
        let first = setting.value.split_whitespace().next().unwrap_or_default();
        match first.parse::<f64>() {
            Ok(value) => steps.push(Taken { value: value / unit, setting }),
            Err(_) => bail!("{}: expected a number", settings.at(setting)),
        }
    }
    Ok(steps)
}

/// The tolerance of a G64 that the control runs at its start, or an assumed one.
fn corner(settings: &Settings) -> Result<Corner> {
    let Some(code) = settings.find("RS274NGC.RS274NGC_STARTUP_CODE") else {
        return Ok(Corner::Deviation(Said::assumed(
            0.01,
            "the program commands G64 P0.01. Without P LinuxCNC rounds a corner however far that leads off it.",
        )));
    };
    let words: Vec<String> = code.value.to_uppercase().split_whitespace().map(str::to_string).collect();
    let has = |word: &str| words.iter().any(|one| one == word);
    let unit = if has("G20") { INCH_MM } else { 1.0 };
    if has("G61") || has("G61.1") {
        return Ok(Corner::Stop(format!("{}.", code.words())));
    }
    let tolerance = words
        .iter()
        .skip_while(|word| *word != "G64")
        .find_map(|word| word.strip_prefix('P')?.parse::<f64>().ok());
    match tolerance {
        Some(value) if value > 0.0 => {
            let taken = settings.within(Taken { value: value * unit, setting: code }, &DEVIATION)?;
            Ok(Corner::Deviation(Said::of(taken, "")))
        }
        _ => Ok(Corner::Deviation(Said::assumed(
            0.01,
            "RS274NGC_STARTUP_CODE has no G64 with P: the program commands G64 P0.01.",
        ))),
    }
}

/// What of the file is not read.
fn left_out(text: &str, settings: &Settings) -> Vec<String> {
    let included = text.lines().filter(|line| line.trim().to_uppercase().starts_with("#INCLUDE")).count();
    let mut left_out = Vec::new();
    if included > 0 {
        left_out.push(format!("{included} other files, which #INCLUDE names, are not read."));
    }
    let kinematics =
        settings.find("KINS.KINEMATICS").filter(|kins| !kins.value.to_lowercase().starts_with("trivkins"));
    left_out.extend(
        kinematics.map(|kins| format!("{}: limits of joints are no limits of axes there.", kins.words())),
    );
    left_out
}

#[cfg(test)]
pub(super) mod tests {
    use part_program::Junction;

    use super::super::tests::{expect_assumptions, machine_of};

    pub(crate) const SMALL: &str = "\
[EMC]
MACHINE = little
[EMCMOT]
SERVO_PERIOD = 500000
[RS274NGC]
RS274NGC_STARTUP_CODE = G21 G40 G64 P0.02
[KINS]
KINEMATICS = trivkins coordinates=XYZ
[TRAJ]
LINEAR_UNITS = mm
DEFAULT_LINEAR_VELOCITY = 40 # a comment
MAX_LINEAR_VELOCITY = 90
MAX_LINEAR_ACCELERATION = 800
[AXIS_X]
MAX_VELOCITY = 90
MAX_ACCELERATION = 900
[AXIS_Y]
MAX_VELOCITY = 80
MAX_ACCELERATION = 850
[AXIS_Z]
MAX_VELOCITY = 30
MAX_ACCELERATION = 300
[JOINT_0]
SCALE = -200
[JOINT_1]
SCALE = 400 0
";

    #[test]
    fn a_file_of_linuxcnc_makes_its_machine() {
        let (machine, made) = machine_of("mill.ini", SMALL);
        assert_eq!((machine.feedrate_mm_per_s, machine.acceleration_mm_per_s2), (90.0, 800.0));
        assert_eq!((machine.jerk_mm_per_s3, machine.interpolation_period_ms), (32_000.0, 0.5));
        assert_eq!((machine.position_increment_mm, machine.junction), (0.005, Junction::DeviationMm(0.02)));
        assert_eq!(
            (machine.axes.y.velocity_mm_per_s, machine.axes.z.acceleration_mm_per_s2),
            (Some(80.0), Some(300.0))
        );
        expect_assumptions(&made, 1);
    }

    /// Inches, a limit of the jerk, axes by number as before version 2.8, and no code at the start.
    #[test]
    fn units_and_jerk_are_those_of_the_file() {
        let text = SMALL
            .replace(
                "LINEAR_UNITS = mm",
                "LINEAR_UNITS = 0.03937007874015748\nPLANNER_TYPE = 1\nMAX_LINEAR_JERK = 1000",
            )
            .replace("AXIS_X", "AXIS_0")
            .replace("[RS274NGC]\nRS274NGC_STARTUP_CODE = G21 G40 G64 P0.02\n", "#INCLUDE more.inc\n")
            .replace("trivkins", "5axiskins");
        let (machine, made) = machine_of("mill.ini", &text);
        assert_eq!((machine.feedrate_mm_per_s, machine.jerk_mm_per_s3), (2286.0, 25_400.0));
        assert!((machine.axes.x.velocity_mm_per_s.unwrap() - 90.0 * 25.4).abs() < 1e-4);
        assert!(
            (machine.position_increment_mm - 25.4 / 200.0).abs() < 1e-8,
            "{}",
            machine.position_increment_mm
        );
        expect_assumptions(&made, 1);
        assert_eq!(
            made.text.lines().filter(|line| line.starts_with("# Not taken: ")).count(),
            2,
            "{}",
            made.text
        );
    }
}
