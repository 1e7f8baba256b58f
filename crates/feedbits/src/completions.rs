//! `feedbits completions`: what a shell needs to complete the command's words.

use std::path::PathBuf;

use anyhow::Result;
use clap::{Args, CommandFactory};
use clap_complete::Shell;

use crate::{Ending, output};

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
    let mut script = Vec::new();
    clap_complete::generate(arguments.shell, &mut crate::Arguments::command(), "feedbits", &mut script);
    output::write(arguments.out.as_deref(), &String::from_utf8(script)?)?;
    Ok(Ending::Good)
}
