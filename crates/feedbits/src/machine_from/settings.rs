//! Settings of a control: names with values, each in a line of a file.

use anyhow::{Result, bail};
use domains::{Key, shown};

/// A setting.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Setting {
    /// Its line, from 1.
    pub(crate) line: usize,
    pub(crate) name: String,
    pub(crate) value: String,
}

/// The settings of a file.
pub(crate) struct Settings {
    /// The file's name.
    pub(crate) file: String,
    all: Vec<Setting>,
    /// Whether the first of settings with the same name holds, or the last.
    first_holds: bool,
}

/// A number of a setting, with the setting that it is from.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Taken<'s> {
    pub(crate) value: f64,
    pub(crate) setting: &'s Setting,
}

impl Settings {
    pub(crate) fn new(file: &str, all: Vec<Setting>, first_holds: bool) -> Self {
        Self { file: file.to_string(), all, first_holds }
    }

    /// The setting of this name that holds.
    pub(crate) fn find(&self, name: &str) -> Option<&Setting> {
        let mut named = self.all.iter().filter(|setting| setting.name.eq_ignore_ascii_case(name));
        if self.first_holds { named.next() } else { named.next_back() }
    }

    /// All settings, in the order of the file.
    pub(crate) fn all(&self) -> &[Setting] {
        &self.all
    }

    /// The number of the first of these names that is set.
    ///
    /// # Errors
    /// If its value is no number.
    pub(crate) fn number(&self, names: &[&str]) -> Result<Option<Taken<'_>>> {
        let Some(setting) = names.iter().find_map(|name| self.find(name)) else { return Ok(None) };
        match setting.value.parse::<f64>() {
            Ok(value) => Ok(Some(Taken { value, setting })),
            Err(_) => bail!("{}: expected a number", self.at(setting)),
        }
    }

    /// The number of the first of these names that is set, times `factor`, within the domain of a key of the machine file.
    ///
    /// # Errors
    /// If it is no number, or beside the domain.
    pub(crate) fn scaled(&self, names: &[&str], factor: f64, key: &Key) -> Result<Option<Taken<'_>>> {
        let Some(Taken { value, setting }) = self.number(names)? else { return Ok(None) };
        self.within(Taken { value: value * factor, setting }, key).map(Some)
    }

    /// As [`scaled`](Self::scaled), of a setting that must be there. `what` says what it is.
    pub(crate) fn needed(&self, names: &[&str], factor: f64, key: &Key, what: &str) -> Result<Taken<'_>> {
        match self.scaled(names, factor, key)? {
            Some(taken) => Ok(taken),
            None => bail!("{}: no {}: expected {what}", self.file, names.join(" or ")),
        }
    }

    /// A number that follows from a setting, if the machine file may have it.
    pub(crate) fn within<'s>(&self, taken: Taken<'s>, key: &Key) -> Result<Taken<'s>> {
        if key.holds(taken.value) {
            return Ok(taken);
        }
        bail!(
            "{}: {} is {}: expected {}",
            self.at(taken.setting),
            key.name,
            shown(taken.value),
            key.expected()
        )
    }

    /// The place of a setting, with what it says.
    pub(crate) fn at(&self, setting: &Setting) -> String {
        const LONGEST: usize = 60;
        let value: String = setting.value.chars().take(LONGEST).collect();
        format!("{}:{}: {} = {value}", self.file, setting.line, setting.name)
    }
}

impl Setting {
    /// The setting as a comment names it.
    pub(crate) fn words(&self) -> String {
        format!("{} = {}, line {}", self.name, self.value, self.line)
    }
}
