//! Marlin's Configuration.h.
//!
//! `DEFAULT_MAX_FEEDRATE`, `DEFAULT_MAX_ACCELERATION` and `DEFAULT_AXIS_STEPS_PER_UNIT` have a number for each of X, Y, Z and the extruders, in
//! mm and s; `DEFAULT_ACCELERATION` is that of a print. A corner is passed by `JUNCTION_DEVIATION_MM`, or with `CLASSIC_JERK` by jumps of
//! `DEFAULT_XJERK` and so on, which are velocities in mm/s. What is behind `//` or between `/*` and `*/` does not count.
//! `#if` is not evaluated: of several definitions of a name the first holds, and that is said.

use anyhow::{Result, bail};
use domains::machine::{ACCELERATION, AXIS_ACCELERATION, AXIS_VELOCITY, DEVIATION, FEEDRATE, VELOCITY_JUMP};

use super::draft::{Axis, Corner, Draft, Said, assumed_jerk, increment, lesser};
use super::settings::{Setting, Settings, Taken};

const FEEDRATES: &str = "DEFAULT_MAX_FEEDRATE";
const ACCELERATIONS: &str = "DEFAULT_MAX_ACCELERATION";
const STEPS: &str = "DEFAULT_AXIS_STEPS_PER_UNIT";
const JUMPS: [&str; 3] = ["DEFAULT_XJERK", "DEFAULT_YJERK", "DEFAULT_ZJERK"];
const JUNCTION_DEVIATION: &str = "JUNCTION_DEVIATION_MM";

pub(crate) fn is_marlin(text: &str) -> bool {
    text.lines().any(|line| {
        let mut words = line.split_whitespace();
        words.next() == Some("#define")
            && words.next().is_some_and(|name| [FEEDRATES, ACCELERATIONS].contains(&name))
    })
}

/// The definitions of a text without its comments.
fn settings(text: &str) -> Vec<Setting> {
    let mut settings = Vec::new();
    let mut is_comment = false;
    for (index, line) in text.lines().enumerate() {
        let code = without_comments(line, &mut is_comment);
        let Some(rest) = code.trim().strip_prefix("#define") else { continue };
        let rest = rest.trim();
        let (name, value) = rest.split_once([' ', '\t', '{']).unwrap_or((rest, ""));
        // The brace of a list may follow its name at once.
        let value = if rest[name.len()..].starts_with('{') { &rest[name.len()..] } else { value };
        settings.push(Setting { line: index + 1, name: name.to_string(), value: value.trim().to_string() });
    }
    settings
}

/// A line without its comments; `is_comment` says whether the line begins, and then whether it ends, within one.
fn without_comments(line: &str, is_comment: &mut bool) -> String {
    let mut code = String::new();
    let mut rest = line;
    loop {
        if *is_comment {
            let Some((_, behind)) = rest.split_once("*/") else { return code };
            (*is_comment, rest) = (false, behind);
        }
        let begin = rest.find("/*").unwrap_or(rest.len());
        let end = rest.find("//").unwrap_or(rest.len());
        if end <= begin {
            return code + &rest[..end];
        }
        code += &rest[..begin];
        (*is_comment, rest) = (true, &rest[begin + 2..]);
    }
}

/// The number that an expression of a definition is: a number, in brackets or with `f` behind it, or a name that is defined.
fn number(settings: &Settings, text: &str, depth: usize) -> Option<f64> {
    const DEEPEST: usize = 8;
    let text = text.trim().trim_start_matches('(').trim_end_matches(')').trim();
    let digits = text.strip_suffix(['f', 'F']).filter(|digits| digits.parse::<f64>().is_ok()).unwrap_or(text);
    if let Ok(value) = digits.parse() {
        return Some(value);
    }
    let defined = settings.find(text).filter(|_| depth < DEEPEST)?;
    number(settings, &defined.value, depth + 1)
}

/// The numbers of a list for X, Y and Z, times `factor`, in the domain of a key.
fn of_axes<'s>(
    settings: &'s Settings,
    name: &str,
    key: Option<&domains::Key>,
) -> Result<[Option<Taken<'s>>; 3]> {
    let mut found = [None; 3];
    let Some(setting) = settings.find(name) else { return Ok(found) };
    let list = setting.value.trim_start_matches('{').trim_end_matches([';', ' ']).trim_end_matches('}');
    for (place, text) in found.iter_mut().zip(list.split(',')) {
        let Some(value) = number(settings, text, 0) else {
            bail!(
                "{}: expected numbers for X, Y and Z, or names that are defined in this file",
                settings.at(setting)
            );
        };
        let taken = Taken { value, setting };
        *place = Some(key.map_or(Ok(taken), |key| settings.within(taken, key))?);
    }
    Ok(found)
}

/// The number of a name, if it is defined.
fn defined<'s>(settings: &'s Settings, name: &str) -> Result<Option<Taken<'s>>> {
    let Some(setting) = settings.find(name) else { return Ok(None) };
    match number(settings, &setting.value, 0) {
        Some(value) => Ok(Some(Taken { value, setting })),
        None => bail!("{}: expected a number, or a name that is defined in this file", settings.at(setting)),
    }
}

pub(crate) fn read(name: &str, text: &str) -> Result<Draft> {
    let settings = Settings::new(name, settings(text), true);
    let rates = of_axes(&settings, FEEDRATES, Some(&AXIS_VELOCITY))?;
    let accelerations = of_axes(&settings, ACCELERATIONS, Some(&AXIS_ACCELERATION))?;
    let steps = of_axes(&settings, STEPS, None)?;
    let feedrate = settings.within(lesser(&settings, &rates, FEEDRATES)?, &FEEDRATE)?;
    let acceleration = match defined(&settings, "DEFAULT_ACCELERATION")? {
        Some(taken) => taken,
        None => lesser(&settings, &accelerations, "DEFAULT_ACCELERATION or DEFAULT_MAX_ACCELERATION")?,
    };
    let acceleration = settings.within(acceleration, &ACCELERATION)?;
    let (corner, jumps) = corner(&settings, text)?;
    let axis = |axis: usize| Axis {
        velocity: rates[axis].map(|rate| Said::of(rate, "")),
        acceleration: accelerations[axis].map(|taken| Said::of(taken, "")),
        jerk: None,
        jump: jumps[axis].map(|jump| Said::of(jump, ": a jump of the velocity")),
    };
    Ok(Draft {
        period_ms: Said::assumed(1.0, "1 ms: Marlin has no period. It finds the time of every step."),
        feedrate: Said::in_place_of(
            feedrate,
            ", the lesser of X and Y: each axis has its own limit; taken where a program commands no feed",
        ),
        acceleration: Said::in_place_of(acceleration, ": a program may command another by M204"),
        jerk: assumed_jerk(&settings, "Marlin, with S_CURVE_ACCELERATION or without,", acceleration)?,
        chord_error: None,
        increment: increment(&settings, &steps[..2].iter().flatten().copied().collect::<Vec<_>>())?,
        corner,
        passes_spindle: None,
        axes: [axis(0), axis(1), axis(2)],
        left_out: left_out(&settings),
    })
}

/// How a corner is passed, and the jumps of X, Y and Z.
fn corner<'s>(settings: &'s Settings, text: &str) -> Result<(Corner, [Option<Taken<'s>>; 3])> {
    let deviation = defined(settings, JUNCTION_DEVIATION)?;
    if deviation.is_some() && !is_classic(settings, text) {
        let taken = deviation.map(|taken| settings.within(taken, &DEVIATION)).transpose()?;
        return Ok((
            taken.map_or_else(assumed_corner, |taken| Corner::Deviation(Said::of(taken, ""))),
            [None; 3],
        ));
    }
    let mut jumps = [None; 3];
    for (jump, name) in jumps.iter_mut().zip(JUMPS) {
        // An axis that may not jump has no key.
        let taken = defined(settings, name)?.filter(|taken| taken.value != 0.0);
        *jump = taken.map(|taken| settings.within(taken, &VELOCITY_JUMP)).transpose()?;
    }
    if jumps.iter().all(Option::is_none) {
        return Ok((assumed_corner(), jumps));
    }
    Ok((
        Corner::Jump(
            "CLASSIC_JERK: each axis may jump by DEFAULT_XJERK, DEFAULT_YJERK and DEFAULT_ZJERK.".into(),
        ),
        jumps,
    ))
}

fn assumed_corner() -> Corner {
    Corner::Deviation(Said::assumed(0.013, "no JUNCTION_DEVIATION_MM: Marlin's own."))
}

/// Whether corners are passed with jumps. Marlin 2 has the switch `CLASSIC_JERK`, and Marlin 1.1.9 `JUNCTION_DEVIATION`.
fn is_classic(settings: &Settings, text: &str) -> bool {
    let names_switch = |switch: &str| {
        let mut lines = text.lines().map(|line| line.trim_start_matches(['/', ' ', '\t']));
        lines.any(|line| {
            let mut words = line.split_whitespace();
            words.next() == Some("#define") && words.next() == Some(switch)
        })
    };
    if names_switch("CLASSIC_JERK") {
        return settings.find("CLASSIC_JERK").is_some();
    }
    names_switch("JUNCTION_DEVIATION") && settings.find("JUNCTION_DEVIATION").is_none()
}

/// Names that are defined more than once, of those that are taken.
fn left_out(settings: &Settings) -> Vec<String> {
    let taken = [FEEDRATES, ACCELERATIONS, STEPS, "DEFAULT_ACCELERATION", JUNCTION_DEVIATION];
    let twice = taken.iter().chain(&JUMPS).filter_map(|name| {
        let named: Vec<_> = settings.all().iter().filter(|setting| setting.name == **name).collect();
        let (first, others) = named.split_first()?;
        let other = others.iter().find(|other| other.value != first.value)?;
        Some(format!("{}: #if is not evaluated, and line {} is taken.", other.words(), first.line))
    });
    twice.collect()
}

#[cfg(test)]
pub(super) mod tests {
    use part_program::Junction;

    use super::super::tests::{expect_assumptions, machine_of};

    pub(crate) const SMALL: &str = "\
/**
 * #define DEFAULT_MAX_FEEDRATE { 1, 1, 1, 1 }
 */
#pragma once
#define STEPS 80
#define DEFAULT_AXIS_STEPS_PER_UNIT   { STEPS, 100, 400, 93 }
#define DEFAULT_MAX_FEEDRATE          { 200, 180, 8, 30 }
#define DEFAULT_MAX_ACCELERATION      { 2000, 1800, 100, 5000 }
#define DEFAULT_ACCELERATION          1500 /* X, Y */ // Z too
//#define CLASSIC_JERK
#if ENABLED(CLASSIC_JERK)
  #define DEFAULT_XJERK 9.0
  #define DEFAULT_YJERK 8.0
  #define DEFAULT_ZJERK 0.3
#endif
#if DISABLED(CLASSIC_JERK)
  #define JUNCTION_DEVIATION_MM 0.02f
#endif
";

    #[test]
    fn a_configuration_of_marlin_makes_its_machine() {
        let (machine, made) = machine_of("Configuration.h", SMALL);
        assert_eq!((machine.feedrate_mm_per_s, machine.acceleration_mm_per_s2), (180.0, 1500.0));
        assert_eq!((machine.jerk_mm_per_s3, machine.position_increment_mm), (60_000.0, 0.0125));
        assert_eq!(machine.junction, Junction::DeviationMm(0.02));
        assert_eq!(
            (machine.axes.x.velocity_mm_per_s, machine.axes.z.acceleration_mm_per_s2),
            (Some(200.0), Some(100.0))
        );
        expect_assumptions(&made, 4);
    }

    #[test]
    fn classic_jerk_is_a_jump_of_the_velocity() {
        for text in [
            SMALL.replace("//#define CLASSIC_JERK", "#define CLASSIC_JERK"),
            SMALL.replace("//#define CLASSIC_JERK", "//#define JUNCTION_DEVIATION"),
        ] {
            let (machine, _) = machine_of("Configuration.h", &text);
            assert_eq!(machine.junction, Junction::VelocityJump);
            assert_eq!(
                (machine.axes.x.velocity_jump_mm_per_s, machine.axes.z.velocity_jump_mm_per_s),
                (Some(9.0), Some(0.3))
            );
        }
        let on = SMALL.replace("//#define CLASSIC_JERK", "#define JUNCTION_DEVIATION");
        assert_eq!(machine_of("Configuration.h", &on).0.junction, Junction::DeviationMm(0.02));
    }

    /// A name that is defined by itself has no end.
    #[test]
    fn definitions_in_a_circle_are_refused() {
        let text = SMALL.replace("#define STEPS 80", "#define STEPS OTHER\n#define OTHER STEPS");
        let Err(error) = super::super::made("Configuration.h", &text) else { panic!("it is taken") };
        assert!(format!("{error:#}").starts_with("Configuration.h:7: "), "{error:#}");
        let twice = SMALL.to_string() + "#define DEFAULT_ACCELERATION 99\n";
        let (machine, made) = machine_of("Configuration.h", &twice);
        assert_eq!(machine.acceleration_mm_per_s2, 1500.0);
        assert!(made.text.contains("# Not taken: DEFAULT_ACCELERATION = 99"), "{}", made.text);
    }
}
