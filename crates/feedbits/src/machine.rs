//! `feedbits machine`: named machines, to try a part on and to start a machine file from.

use std::fmt::Write;
use std::path::PathBuf;

use anyhow::{Result, bail};
use clap::Args;
use clap_complete::ArgValueCandidates;
use domains::{TABLES, markdown};
use part_program::Machine;
use serde::Serialize;

use crate::ending::Ending;
use crate::machine_from::machine_from;
use crate::presets::{PRESETS, expected, named};
use crate::{candidates, output};

/// Options of `machine`.
#[derive(Args)]
pub(crate) struct Arguments {
    /// The preset whose file is to be printed. Default: all presets, with their sources.
    #[arg(add = ArgValueCandidates::new(candidates::presets))]
    preset: Option<String>,
    /// Print every key of every file, every word and every option that takes a number, with its unit, its domain and its default, as
    /// tables in Markdown.
    #[arg(long, conflicts_with_all = ["preset", "json", "from"])]
    keys: bool,
    /// Make a machine file from the settings of a control, told by their content: what Grbl and grblHAL print at $$, LinuxCNC's INI
    /// file, Klipper's printer.cfg, FluidNC's config.yaml or Marlin's Configuration.h. What is assumed is said, and stands in comments.
    #[arg(long, value_name = "FILE", conflicts_with = "preset")]
    from: Option<PathBuf>,
    #[command(flatten)]
    output: output::Output,
}

#[derive(Serialize)]
struct Listed {
    name: &'static str,
    title: &'static str,
    sources: Vec<&'static str>,
    machine: Machine,
}

/// Lists the presets, or prints the file of one.
pub(crate) fn run(arguments: &Arguments) -> Result<Ending> {
    let place = arguments.output.place()?;
    let json = arguments.output.json;
    let text = match &arguments.preset {
        _ if arguments.from.is_some() => from_settings(arguments)?,
        None if arguments.keys => tables(),
        Some(name) => {
            let Some(preset) = named(name) else { bail!("unknown preset {name:?}: {}", expected(name)) };
            if json { serde_json::to_string_pretty(&preset.machine()?)? + "\n" } else { preset.text.into() }
        }
        None => {
            let listed = PRESETS.iter().map(|preset| {
                let (name, title, sources) = (preset.name, preset.title(), preset.sources());
                Ok(Listed { name, title, sources, machine: preset.machine()? })
            });
            let listed: Vec<Listed> = listed.collect::<Result<_>>()?;
            if json { serde_json::to_string_pretty(&listed)? + "\n" } else { list(&listed)? }
        }
    };
    output::write(&place, &text)?;
    Ok(Ending::Good)
}

/// The machine file that settings make; each assumption is said.
fn from_settings(arguments: &Arguments) -> Result<String> {
    let Some(path) = &arguments.from else { return Ok(String::new()) };
    let made = machine_from(path)?;
    made.said.iter().for_each(|line| output::note(line));
    if !arguments.output.json {
        return Ok(made.text);
    }
    let machine = part_program::read_machine(&path.display().to_string(), &made.text)?;
    Ok(serde_json::to_string_pretty(&machine)? + "\n")
}

/// The tables of all keys, each below its title.
fn tables() -> String {
    let tables = TABLES.iter().map(|table| format!("## {}\n\n{}", table.title, markdown(table)));
    tables.collect::<Vec<_>>().join("\n")
}

fn list(listed: &[Listed]) -> Result<String> {
    let mut text = String::new();
    for Listed { name, title, sources, machine } in listed {
        writeln!(text, "{name}\n    {title}")?;
        writeln!(
            text,
            "    {} mm/s, {} mm/s², {} mm/s³, a setpoint every {} ms",
            machine.feedrate_mm_per_s,
            machine.acceleration_mm_per_s2,
            machine.jerk_mm_per_s3,
            machine.interpolation_period_ms
        )?;
        sources.iter().try_for_each(|source| writeln!(text, "    from {source}"))?;
    }
    text += "\nTo run a part on one: feedbits compare part.nc --machine router\n\
             To start a file from one: feedbits machine router > my-machine.toml\n\
             Its comments say where each value is from, and which are assumed.\n";
    Ok(text)
}
