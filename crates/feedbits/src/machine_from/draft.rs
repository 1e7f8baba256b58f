//! A machine file in the making: each value with the setting it is from, or with what is assumed.

use std::fmt::Write;

use anyhow::{Result, bail};
use domains::Key;
use domains::machine::{
    ACCELERATION, ASSUMED, AXIS_ACCELERATION, AXIS_JERK, AXIS_VELOCITY, CHORD_ERROR, DEVIATION, FEEDRATE,
    INCREMENT, JERK, JUNCTION, PERIOD, S_STOPS, VELOCITY_JUMP,
};
use foreign_text::in_a_line;

use super::settings::{Settings, Taken};

/// A value with the reason for it.
#[derive(Clone, Debug)]
pub(crate) struct Said {
    value: f64,
    why: String,
    is_assumed: bool,
}

impl Said {
    /// A value that settings give.
    pub(crate) fn of(taken: Taken<'_>, more: &str) -> Self {
        Self { value: taken.value, why: format!("{}{more}.", taken.setting.words()), is_assumed: false }
    }

    /// A value that is assumed, and why.
    pub(crate) fn assumed(value: f64, why: &str) -> Self {
        Self { value, why: why.to_string(), is_assumed: true }
    }

    /// A value that settings give for something else, and that is taken for want of a limit that they state.
    pub(crate) fn in_place_of(taken: Taken<'_>, more: &str) -> Self {
        Self { is_assumed: true, ..Self::of(taken, more) }
    }
}

/// How a corner is passed.
#[derive(Clone, Debug)]
pub(crate) enum Corner {
    /// At rest; the words say why.
    Stop(String),
    /// Within a deviation.
    Deviation(Said),
    /// With a jump of each axis's velocity, which the axes have.
    Jump(String),
}

/// The limits of an axis.
#[derive(Clone, Debug, Default)]
pub(crate) struct Axis {
    pub(crate) velocity: Option<Said>,
    pub(crate) acceleration: Option<Said>,
    pub(crate) jerk: Option<Said>,
    pub(crate) jump: Option<Said>,
}

/// A machine file in the making.
#[derive(Clone, Debug)]
pub(crate) struct Draft {
    pub(crate) period_ms: Said,
    pub(crate) feedrate: Said,
    pub(crate) acceleration: Said,
    pub(crate) jerk: Said,
    pub(crate) chord_error: Option<Said>,
    pub(crate) increment: Option<Said>,
    pub(crate) corner: Corner,
    /// Why the machine does not rest at words of the spindle, if it does not.
    pub(crate) passes_spindle: Option<String>,
    /// Of X, Y and Z.
    pub(crate) axes: [Axis; 3],
    /// What of the settings is not taken.
    pub(crate) left_out: Vec<String>,
}

/// The time after which the acceleration of a machine without a limit of the jerk is there, in s: 25 ms, as in the presets.
const RISE_S: f64 = 0.025;

/// The jerk of a control that has no limit of it.
pub(crate) fn assumed_jerk(settings: &Settings, control: &str, acceleration: Taken<'_>) -> Result<Said> {
    let jerk = settings.within(Taken { value: acceleration.value / RISE_S, ..acceleration }, &JERK)?;
    Ok(Said::assumed(
        jerk.value,
        &format!("{control} has no limit of the jerk. The acceleration is there after 25 ms."),
    ))
}

/// The least step of the drives, which is one over the steps per mm: the coarsest of these axes, as setpoints are judged in all of them alike.
pub(crate) fn increment(settings: &Settings, steps_per_mm: &[Taken<'_>]) -> Result<Option<Said>> {
    let least =
        steps_per_mm.iter().copied().min_by(|one, other| one.value.abs().total_cmp(&other.value.abs()));
    let Some(least) = least else { return Ok(None) };
    let step = settings.within(Taken { value: 1.0 / least.value.abs(), ..least }, &INCREMENT)?;
    Ok(Some(Said::of(step, ": one over the steps per mm")))
}

/// The lesser of the numbers of X and Y. Z is left to its own limits: it is often far slower.
pub(crate) fn lesser<'s>(
    settings: &Settings,
    axes: &[Option<Taken<'s>>; 3],
    what: &str,
) -> Result<Taken<'s>> {
    let of_plane = axes[..2].iter().flatten().copied();
    match of_plane.min_by(|one, other| one.value.total_cmp(&other.value)) {
        Some(taken) => Ok(taken),
        None => bail!("{}: expected {what} of X or Y", settings.file),
    }
}

impl Draft {
    /// Each assumption in a line, and what of the settings is not taken.
    pub(crate) fn said(&self) -> Vec<String> {
        let mut said: Vec<String> = self
            .values()
            .into_iter()
            .filter(|(_, value)| value.is_assumed)
            .map(|(key, value)| {
                format!("{} = {} is assumed: {}", key.name, number(value.value), in_a_line(&value.why))
            })
            .collect();
        said.extend(self.left_out.iter().map(|text| in_a_line(text)));
        said
    }

    /// The values of the table `machine`, in the order of the file.
    fn values(&self) -> Vec<(&'static Key, &Said)> {
        let mut values: Vec<(&'static Key, &Said)> = vec![
            (&PERIOD, &self.period_ms),
            (&FEEDRATE, &self.feedrate),
            (&ACCELERATION, &self.acceleration),
            (&JERK, &self.jerk),
        ];
        values.extend(self.chord_error.iter().map(|said| (&CHORD_ERROR, said)));
        values.extend(self.increment.iter().map(|said| (&INCREMENT, said)));
        if let Corner::Deviation(said) = &self.corner {
            values.push((&DEVIATION, said));
        }
        values
    }

    /// The machine file. `name` is the file of the settings, and `control` what they are.
    pub(crate) fn toml(&self, name: &str, control: &str) -> String {
        let mut text = format!("# Made from {}, {control}.\n", in_a_line(name));
        for left_out in &self.left_out {
            line(&mut text, &format!("# Not taken: {}", in_a_line(left_out)));
        }
        text +=
            "#\n# docs/machine-file.md explains the keys, and what a key is that is left out.\n[machine]\n";
        for (key, said) in self.values() {
            if key.name == DEVIATION.name {
                line(&mut text, &format!("{} = \"deviation\"", JUNCTION.name));
            }
            value(&mut text, key, said);
        }
        match &self.corner {
            Corner::Deviation(_) => {}
            Corner::Stop(why) => word(&mut text, JUNCTION.name, "\"stop\"", why),
            Corner::Jump(why) => word(&mut text, JUNCTION.name, "\"velocity-jump\"", why),
        }
        if let Some(why) = &self.passes_spindle {
            word(&mut text, S_STOPS.name, "false", why);
        }
        assumed(&mut text, &self.values());
        for (axis, letter) in self.axes.iter().zip(["x", "y", "z"]) {
            axis.toml(&mut text, letter);
        }
        text
    }
}

impl Axis {
    fn toml(&self, text: &mut String, letter: &str) {
        let values = [
            (&AXIS_VELOCITY, &self.velocity),
            (&AXIS_ACCELERATION, &self.acceleration),
            (&AXIS_JERK, &self.jerk),
            (&VELOCITY_JUMP, &self.jump),
        ];
        let values: Vec<_> =
            values.into_iter().filter_map(|(key, said)| Some((key, said.as_ref()?))).collect();
        if !values.is_empty() {
            line(text, &format!("\n[machine.axes.{letter}]"));
            values.iter().for_each(|(key, said)| value(text, key, said));
            assumed(text, &values);
        }
    }
}

/// A key with its comment.
fn value(text: &mut String, key: &Key, said: &Said) {
    let assumed = if said.is_assumed { "Assumed: " } else { "" };
    line(text, &format!("# {assumed}{}", in_a_line(&said.why)));
    line(text, &format!("{} = {}", key.name, number(said.value)));
}

/// The key that names those of a table that are assumed, if there are any.
fn assumed(text: &mut String, values: &[(&'static Key, &Said)]) {
    let names: Vec<String> = values
        .iter()
        .filter(|(_, said)| said.is_assumed)
        .map(|(key, _)| format!("\"{}\"", key.name))
        .collect();
    if !names.is_empty() {
        line(text, "# What is assumed above: a plan keeps it, and no log is judged by it.");
        line(text, &format!("{} = [{}]", ASSUMED.name, names.join(", ")));
    }
}

/// A key with a word, and its comment.
fn word(text: &mut String, key: &str, word: &str, why: &str) {
    line(text, &format!("# {}", in_a_line(why)));
    line(text, &format!("{key} = {word}"));
}

fn line(text: &mut String, line: &str) {
    // Writing to a String cannot fail.
    let _ = writeln!(text, "{line}");
}

/// A number of at most nine digits, as TOML has it.
fn number(value: f64) -> String {
    format!("{value:.8e}").parse::<f64>().unwrap_or(value).to_string()
}
