//! `feedbits completions`: a script with which a shell completes the command's words.
//!
//! The script asks this program each time the key is pressed. So it also completes lists with commas, files beside
//! presets, and words of later versions.

use std::env;
use std::ffi::OsStr;
use std::io::{self, Write};
use std::path::{Path, PathBuf};
use std::process::ExitCode;

use anyhow::{Context, Result};
use clap::Args;
use clap_complete::Shell;
use clap_complete::env::{EnvCompleter, Shells};

use crate::ending::Ending;
use crate::output;
use crate::places::Place;

/// The environment variable by which a script asks for words, and names its shell.
const VARIABLE: &str = "FEEDBITS_COMPLETE";
const PROGRAM: &str = "feedbits";
const SHELLS: Shells<'static> = Shells::builtins();

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
    let place = Place::named("--out", arguments.out.as_deref())?;
    let script = script(completer(arguments.shell.to_string().as_ref())?)?;
    output::write(&place, &String::from_utf8(script)?)?;
    Ok(Ending::Good)
}

/// If a script asks for words of `command`, prints them and returns the exit status; otherwise does nothing.
pub(crate) fn answer(command: fn() -> clap::Command) -> Option<ExitCode> {
    let shell = env::var_os(VARIABLE).filter(|shell| !shell.is_empty() && shell != "0")?;
    let printed = words(&shell, command).and_then(|words| output::printed(io::stdout().write_all(&words)));
    Some(output::status_of(printed))
}

/// What a shell reads: the words for the end of the command line behind `--`; the script if nothing is there.
fn words(shell: &OsStr, command: fn() -> clap::Command) -> Result<Vec<u8>> {
    let completer = completer(shell)?;
    let line: Vec<_> = env::args_os().skip_while(|word| word != "--").skip(1).collect();
    if line.is_empty() {
        return script(completer);
    }
    let mut command = command();
    command.build();
    let mut words = Vec::new();
    completer.write_complete(&mut command, line, env::current_dir().ok().as_deref(), &mut words)?;
    Ok(words)
}

fn script(completer: &dyn EnvCompleter) -> Result<Vec<u8>> {
    let mut script = Vec::new();
    completer.write_registration(VARIABLE, PROGRAM, PROGRAM, PROGRAM, &mut script)?;
    Ok(script)
}

/// What knows the language of a shell, which is named as in the variable SHELL or in short.
fn completer(shell: &OsStr) -> Result<&'static dyn EnvCompleter> {
    let name = Path::new(shell).file_stem().unwrap_or(shell).to_string_lossy();
    SHELLS.completer(&name).with_context(|| {
        let known: Vec<_> = SHELLS.names().collect();
        format!("{VARIABLE}: unknown shell {name:?}, expected one of {}", known.join(", "))
    })
}

#[cfg(test)]
mod tests {
    use std::ffi::OsString;

    use clap::CommandFactory;

    /// The words offered for the last word of a command line.
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
