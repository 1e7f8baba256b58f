//! `feedbits completions`: what a shell needs to complete the command's words, and the words.
//!
//! The script asks this program at each press of the key, so that lists with commas, files beside presets, and what a later version
//! adds are completed too.

use std::ffi::OsStr;
use std::path::PathBuf;

use anyhow::{Context, Result};
use clap::{Args, CommandFactory};
use clap_complete::engine::{CompletionCandidate, PathCompleter, ValueCompleter};
use clap_complete::env::Shells;
use clap_complete::{CompleteEnv, Shell};
use part_program::Dialect;

use crate::machine::PRESETS;
use crate::{Ending, output};

/// The environment variable by which a script says that it asks for words, and for which shell.
const VARIABLE: &str = "FEEDBITS_COMPLETE";
const PROGRAM: &str = "feedbits";

/// Options of `completions`.
#[derive(Args)]
pub(crate) struct Arguments {
    /// The shell.
    shell: Shell,
    /// Write to this file instead of the terminal.
    #[arg(long, value_name = "PATH")]
    out: Option<PathBuf>,
}

/// Prints the script.
pub(crate) fn run(arguments: &Arguments) -> Result<Ending> {
    let name = arguments.shell.to_string();
    let shells = Shells::builtins();
    let shell = shells.completer(&name).with_context(|| format!("no script for {name}"))?;
    let mut script = Vec::new();
    shell.write_registration(VARIABLE, PROGRAM, PROGRAM, PROGRAM, &mut script)?;
    output::write(arguments.out.as_deref(), &String::from_utf8(script)?)?;
    Ok(Ending::Good)
}

/// Gives a script the words that it asks for, and ends; does nothing where none asks.
pub(crate) fn answer() {
    CompleteEnv::with_factory(crate::Arguments::command).var(VARIABLE).bin(PROGRAM).complete();
}

fn candidate(word: impl Into<String>, help: impl Into<String>) -> CompletionCandidate {
    CompletionCandidate::new(word.into()).help(Some(help.into().into()))
}

/// The built-in formats.
pub(crate) fn formats() -> Vec<CompletionCandidate> {
    let names = format_compare::formats::<3>().into_iter().map(|format| format.name());
    names.map(|name| candidate(name.to_string(), format!("{} bits", name.bits()))).collect()
}

/// What may be planned in.
pub(crate) fn planners() -> Vec<CompletionCandidate> {
    let mut words = formats();
    words.push(candidate("same", "each format plans for itself"));
    words
}

/// The built-in targets.
pub(crate) fn targets() -> Vec<CompletionCandidate> {
    let targets = target_cost::built_in().unwrap_or_default();
    targets.into_iter().map(|target| candidate(target.name, target.title)).collect()
}

/// The dialects of part programs.
pub(crate) fn dialects() -> Vec<CompletionCandidate> {
    Dialect::ALL.map(|dialect| CompletionCandidate::new(dialect.name())).into()
}

/// The machines that have a name.
pub(crate) fn presets() -> Vec<CompletionCandidate> {
    PRESETS.iter().map(|preset| candidate(preset.name, preset.title())).collect()
}

/// The machines that have a name, and files.
pub(crate) fn machines(begun: &OsStr) -> Vec<CompletionCandidate> {
    let begins = |word: &CompletionCandidate| {
        word.get_value().as_encoded_bytes().starts_with(begun.as_encoded_bytes())
    };
    let mut words: Vec<CompletionCandidate> = presets().into_iter().filter(begins).collect();
    words.extend(PathCompleter::any().complete(begun));
    words
}

#[cfg(test)]
mod tests {
    use std::ffi::OsString;

    use super::*;

    /// The words that are offered for the last one of a command line.
    fn offered(line: &str) -> Vec<String> {
        let words: Vec<OsString> = line.split(' ').map(OsString::from).collect();
        let last = words.len() - 1;
        let mut command = crate::Arguments::command();
        let folder = std::path::Path::new(env!("CARGO_MANIFEST_DIR"));
        let found = clap_complete::engine::complete(&mut command, words, last, Some(folder)).expect("words");
        found.iter().map(|word| word.get_value().to_string_lossy().into_owned()).collect()
    }

    #[test]
    fn names_are_offered_wherever_a_command_takes_them() {
        for (line, expected) in [
            ("feedbits compare --formats I8", "I8F24"),
            ("feedbits compare --formats I4F28,f", "I4F28,f32"),
            ("feedbits compare --format f6", "f64"),
            ("feedbits sweep --formats I2", "I2F30"),
            ("feedbits servo --formats I2", "I2F30"),
            ("feedbits soak --formats I2", "I2F30"),
            ("feedbits interpolate --format I1", "I16F16"),
            ("feedbits compile --format I1", "I16F16"),
            ("feedbits plan --plan-in sa", "same"),
            ("feedbits plan --profile s-", "s-curve"),
            ("feedbits compare --targets cortex-m4f,cortex-m0", "cortex-m4f,cortex-m0plus"),
            ("feedbits targets cortex-m4", "cortex-m4f"),
            ("feedbits check --dialect f", "fanuc"),
            ("feedbits convert --to g0", "g06.2"),
            ("feedbits compare --machine router-", "router-linuxcnc"),
            ("feedbits compare --machine Car", "Cargo.toml"),
            ("feedbits compare Car", "Cargo.toml"),
            ("feedbits machine mi", "mill"),
            ("feedbits completions z", "zsh"),
        ] {
            let offered = offered(line);
            assert!(offered.iter().any(|word| word == expected), "{line}: {offered:?}");
        }
        assert_eq!(offered("feedbits machine router-l"), ["router-linuxcnc"]);
    }
}
