//! Machines that have a name, and the machine that `--machine` selects.

use std::path::Path;

use anyhow::{Result, bail};
use part_program::{Machine, StatedLimits};

use crate::{files, output};

/// A machine that has a name.
pub(crate) struct Preset {
    /// The name for `--machine`. It has no dot and no slash, since these make a path.
    pub(crate) name: &'static str,
    /// A machine file. Its first line describes the machine; the lines after it name the sources of its values.
    pub(crate) text: &'static str,
}

/// The presets of these names, each a file in data/machines.
macro_rules! presets {
    ($($name:literal),+) => {
        &[$(Preset { name: $name, text: include_str!(concat!("../../../data/machines/", $name, ".toml")) }),+]
    };
}

/// Every preset: hobby machines by their control, then industrial ones.
pub(crate) const PRESETS: &[Preset] =
    presets!["router-8bit", "router", "router-linuxcnc", "laser", "printer", "mill", "stage"];

impl Preset {
    /// The description of the machine.
    pub(crate) fn title(&self) -> &'static str {
        let first = self.text.lines().next().unwrap_or_default();
        first.trim_start_matches("# ").trim_end_matches('.')
    }

    /// The sources of its values.
    pub(crate) fn sources(&self) -> Vec<&'static str> {
        self.text.lines().filter_map(|line| line.strip_prefix("# Source: ")).collect()
    }

    /// The machine that its file describes.
    pub(crate) fn machine(&self) -> Result<Machine> {
        Ok(part_program::read_machine(&format!("preset {}", self.name), self.text)?)
    }
}

/// The machine that `--machine` selects: a preset, or a file. A word without `.`, `/` and `\` is a preset's name if
/// there is such a preset. So the meaning of a command does not depend on the folder in which it runs.
pub(crate) fn read(path: &Path) -> Result<Machine> {
    match selected(path)? {
        Selected::Preset(preset) => preset.machine(),
        Selected::File(text) => Ok(part_program::read_machine(&path.display().to_string(), &text)?),
    }
}

/// The limits of the machine that `--machine` selects, of which its file may leave some out.
pub(crate) fn read_limits(path: &Path) -> Result<StatedLimits> {
    match selected(path)? {
        Selected::Preset(preset) => {
            Ok(part_program::read_limits(&format!("preset {}", preset.name), preset.text)?)
        }
        Selected::File(text) => Ok(part_program::read_limits(&path.display().to_string(), &text)?),
    }
}

/// What `--machine` selects.
enum Selected {
    Preset(&'static Preset),
    /// The text of a file.
    File(String),
}

fn selected(path: &Path) -> Result<Selected> {
    let word = path.to_str().filter(|word| !word.contains(['.', '/', '\\']));
    if let Some(preset) = word.and_then(named) {
        if path.exists() {
            let name = preset.name;
            output::note(&format!("--machine {name} is the preset; the file here is --machine ./{name}"));
        }
        return Ok(Selected::Preset(preset));
    }
    if let Some(word) = word.filter(|_| !path.exists()) {
        bail!("--machine {word}: no such preset and no such file: {}", expected(word));
    }
    Ok(Selected::File(files::text("--machine", path, files::MOST_OF_MACHINE)?))
}

/// The preset of a name.
pub(crate) fn named(name: &str) -> Option<&'static Preset> {
    PRESETS.iter().find(|preset| preset.name == name)
}

/// The preset that may have been meant instead of `name`, and the list of all.
pub(crate) fn expected(name: &str) -> String {
    let names: Vec<&str> = PRESETS.iter().map(|preset| preset.name).collect();
    let meant = output::did_you_mean(name, &names);
    format!("{meant}presets are {}; `feedbits machine` says what they are", names.join(", "))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_preset_is_a_machine_with_a_title_and_a_source() {
        for preset in PRESETS {
            let machine = preset.machine().expect("a machine");
            assert!(!preset.name.contains(['.', '/', '\\']), "{}", preset.name);
            assert!(preset.title().len() > 10 && preset.title().len() <= 76, "{}", preset.title());
            assert!(!preset.sources().is_empty(), "{}", preset.name);
            assert!(preset.sources().iter().all(|source| source.len() <= 71), "{:?}", preset.sources());
            assert!(machine.jerk_mm_per_s3 >= machine.acceleration_mm_per_s2, "{}", preset.name);
        }
    }

    /// Every value has a source: a user cannot start from a value of unknown origin.
    #[test]
    fn every_value_of_a_preset_has_a_comment_above_it() {
        for preset in PRESETS {
            let mut said = false;
            for line in preset.text.lines() {
                match line {
                    "" | "[machine]" => said = false,
                    comment if comment.starts_with('#') => said = true,
                    value => assert!(said || value.starts_with('['), "{}: {line}", preset.name),
                }
            }
        }
    }

    /// What a comment calls assumed is what the key says, so that no log is judged by it.
    #[test]
    fn what_a_preset_assumes_stands_in_a_comment_and_in_the_key() {
        for preset in PRESETS {
            let (mut is_assumed, mut in_comments) = (false, Vec::new());
            for pair in preset.text.lines().collect::<Vec<_>>().windows(2) {
                let [before, line] = pair else { continue };
                let begins = line.starts_with('#') && !before.starts_with('#');
                is_assumed =
                    if begins { line.starts_with("# Assumed: ") } else { is_assumed && !line.is_empty() };
                let number = line.split_once(" = ").filter(|(_, value)| value.parse::<f64>().is_ok());
                in_comments.extend(number.filter(|_| is_assumed).map(|(key, _)| key));
            }
            let limits = part_program::read_limits(preset.name, preset.text).expect("limits");
            let in_key: Vec<&str> = limits.assumed.iter().map(|one| one.key).collect();
            assert_eq!(in_key, in_comments, "{}", preset.name);
            let all = limits.clone().with_assumed();
            assert_eq!(all.jerk_mm_per_s3, Some(preset.machine().expect("a machine").jerk_mm_per_s3));
            assert_eq!(
                limits.jerk_mm_per_s3.is_none(),
                in_key.contains(&"jerk_mm_per_s3"),
                "{}",
                preset.name
            );
        }
    }

    /// A preset leaves out values that have a default, so that its file shows only its own.
    #[test]
    fn a_preset_says_nothing_about_solvers() {
        for preset in PRESETS {
            for key in ["parameter_tolerance", "max_iterations", "fluctuation_limit"] {
                assert!(!preset.text.contains(key), "{}: {key}", preset.name);
            }
        }
    }
}
