//! What Grbl and grblHAL print at `$$`: a line `$110=5000.000` a setting, perhaps with its meaning behind it in brackets.
//!
//! Grbl 1.1: `$11` junction deviation in mm, `$12` arc tolerance in mm, `$32` laser mode; `$100` to `$102` steps per mm of X, Y and Z,
//! `$110` to `$112` their greatest rates in mm/min, `$120` to `$122` their accelerations in mm/s². It prints lengths in mm, also with `$13=1`.

use anyhow::Result;
use domains::machine::{ACCELERATION, AXIS_ACCELERATION, AXIS_VELOCITY, CHORD_ERROR, DEVIATION, FEEDRATE};

use super::draft::{Axis, Corner, Draft, Said, assumed_jerk, increment, lesser};
use super::settings::{Setting, Settings, Taken};

/// The settings that every Grbl 1.1 has end here; those of the axes A, B and C are 103 to 105 and so on.
const LAST_OF_GRBL: u32 = 199;

/// Whether a text is such settings: at least one rate of an axis.
pub(crate) fn is_grbl(text: &str) -> bool {
    settings(text).iter().any(|setting| ["$110", "$111", "$120"].contains(&setting.name.as_str()))
}

fn settings(text: &str) -> Vec<Setting> {
    let setting = |(index, line): (usize, &str)| {
        let (number, rest) = line.trim().strip_prefix('$')?.split_once('=')?;
        let number: u32 = number.trim().parse().ok()?;
        let value = rest.split(['(', ';', '[']).next().unwrap_or_default().trim().to_string();
        Some(Setting { line: index + 1, name: format!("${number}"), value })
    };
    text.lines().enumerate().filter_map(setting).collect()
}

pub(crate) fn read(name: &str, text: &str) -> Result<Draft> {
    // A log may have the settings twice: the later ones are those that hold now.
    let settings = Settings::new(name, settings(text), false);
    let of_axes = |first: u32, factor, key| -> Result<[Option<Taken<'_>>; 3]> {
        let of = |axis: u32| settings.scaled(&[&format!("${}", first + axis)], factor, key);
        Ok([of(0)?, of(1)?, of(2)?])
    };
    let rates = of_axes(110, 1.0 / 60.0, &AXIS_VELOCITY)?;
    let accelerations = of_axes(120, 1.0, &AXIS_ACCELERATION)?;
    let steps = [settings.number(&["$100"])?, settings.number(&["$101"])?];
    let feedrate = settings
        .within(lesser(&settings, &rates, "$110 or $111, the greatest rate in mm/min,")?, &FEEDRATE)?;
    let acceleration = lesser(&settings, &accelerations, "$120 or $121, the acceleration in mm/s²,")?;
    let acceleration = settings.within(acceleration, &ACCELERATION)?;
    let numbers = || settings.all().iter().filter_map(|setting| setting.name[1..].parse::<u32>().ok());
    let period_ms = if numbers().any(|number| number > LAST_OF_GRBL) {
        Said::assumed(1.0, "1 ms, which a 32-bit processor has time for. The settings are those of grblHAL.")
    } else {
        Said::assumed(
            10.0,
            "10 ms: Grbl on an 8-bit processor renews the speed 100 times a second. A 32-bit control has time for 1 ms.",
        )
    };
    let corner = match settings.number(&["$11"])? {
        Some(taken) if taken.value == 0.0 => Corner::Stop(format!("{}.", taken.setting.words())),
        Some(taken) => {
            Corner::Deviation(Said::of(settings.within(taken, &DEVIATION)?, ", junction deviation"))
        }
        None => Corner::Deviation(Said::assumed(0.01, "no $11: Grbl's own junction deviation.")),
    };
    let laser = settings.number(&["$32"])?.filter(|laser| laser.value != 0.0);
    let axis = |axis: usize| Axis {
        velocity: rates[axis].map(|rate| Said::of(rate, " mm/min")),
        acceleration: accelerations[axis].map(|taken| Said::of(taken, " mm/s²")),
        ..Axis::default()
    };
    Ok(Draft {
        period_ms,
        feedrate: Said::in_place_of(
            feedrate,
            " mm/min, the lesser of X and Y: each axis has its own limit; taken where a program commands no feed",
        ),
        acceleration: Said::in_place_of(
            acceleration,
            " mm/s², the lesser of X and Y: each axis has its own limit",
        ),
        jerk: assumed_jerk(&settings, "Grbl", acceleration)?,
        chord_error: settings
            .scaled(&["$12"], 1.0, &CHORD_ERROR)?
            .map(|taken| Said::of(taken, ", arc tolerance: so far chords are off an arc")),
        increment: increment(&settings, &steps.into_iter().flatten().collect::<Vec<_>>())?,
        corner,
        passes_spindle: laser.map(|laser| format!("{}: laser mode.", laser.setting.words())),
        axes: [axis(0), axis(1), axis(2)],
        left_out: Vec::new(),
    })
}

#[cfg(test)]
pub(super) mod tests {
    use part_program::Junction;

    use super::super::tests::{expect_assumptions, machine_of};

    pub(crate) const SMALL: &str = "\
Grbl 1.1h ['$' for help]
$0=10
$11=0.015
$12=0.003
$32=0
$100=80.000 (x, step/mm)
$101=160.000
$102=400.000
$110=6000.000
$111=4800.000
$112=600.000
$120=350.000
$121=300.000
$122=50.000
ok
";

    #[test]
    fn settings_of_grbl_make_its_machine() {
        let (machine, made) = machine_of("grbl.txt", SMALL);
        assert_eq!((machine.feedrate_mm_per_s, machine.acceleration_mm_per_s2), (80.0, 300.0));
        assert_eq!((machine.jerk_mm_per_s3, machine.interpolation_period_ms), (12_000.0, 10.0));
        assert_eq!((machine.chord_error_mm, machine.position_increment_mm), (0.003, 0.0125));
        assert_eq!((machine.junction, machine.s_stops), (Junction::DeviationMm(0.015), true));
        assert_eq!(machine.axes.x.velocity_mm_per_s, Some(100.0));
        assert_eq!(
            (machine.axes.z.velocity_mm_per_s, machine.axes.z.acceleration_mm_per_s2),
            (Some(10.0), Some(50.0))
        );
        expect_assumptions(&made, 4);
    }

    /// grblHAL has settings that Grbl has not, and a laser passes words of the spindle.
    #[test]
    fn a_laser_on_grblhal_is_told() {
        let text = SMALL.replace("$32=0", "$32=1") + "$341=0\n$110=7200\n";
        let (machine, made) = machine_of("grbl.txt", &text);
        assert_eq!((machine.interpolation_period_ms, machine.s_stops), (1.0, false));
        // The last of two lines for a setting holds.
        assert_eq!(machine.axes.x.velocity_mm_per_s, Some(120.0));
        expect_assumptions(&made, 4);
    }
}
