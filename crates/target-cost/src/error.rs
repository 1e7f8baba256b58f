//! Why a target file was refused.

use std::fmt;

/// The fault of a target file.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub enum TargetError {
    /// The file is not TOML, lacks a key, or has an unknown key.
    Toml {
        /// The file.
        file: String,
        /// Line, column and what was expected.
        error: toml::de::Error,
    },
    /// A value breaks a rule.
    Value {
        /// The file.
        file: String,
        /// The line of the key, from 1; `None` for a key that is left out.
        line: Option<usize>,
        /// The key, with the number of its table.
        key: String,
        /// Its value.
        value: String,
        /// The rule.
        expected: String,
    },
    /// The file has `calibrated = true`, but nothing was counted for a target of this name.
    NotCalibrated {
        /// The file.
        file: String,
        /// The name.
        name: String,
    },
}

impl fmt::Display for TargetError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Toml { file, error } => write!(f, "{file}: {error}"),
            Self::Value { file, line, key, value, expected } => {
                let line = line.map_or_else(String::new, |line| format!(":{line}"));
                write!(f, "{file}{line}: {key} = {value}: expected {expected}")
            }
            Self::NotCalibrated { file, name } => {
                write!(
                    f,
                    "{file}: name = {name:?} with calibrated = true: expected a target that was counted"
                )
            }
        }
    }
}

impl std::error::Error for TargetError {}
