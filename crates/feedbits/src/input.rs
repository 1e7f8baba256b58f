//! What every subcommand reads: a part, and the machine that is to follow it.

use std::fs;
use std::path::{Path, PathBuf};

use anyhow::{Context, Result, bail};
use clap::Args;
use format_compare::Problem;
use part_program::{Machine, Part};

/// The example that runs when no part is named: paper A's curve and machine.
const EXAMPLE: &str = include_str!("../../../data/seed-000.toml");

/// The part and its machine.
#[derive(Args)]
pub(crate) struct Input {
    /// Part: a curve file (TOML) or a part program, told by its content. Default: the built-in example.
    part: Option<PathBuf>,
    /// Machine file (TOML with a table `machine`). Default: the machine in the part's own file.
    #[arg(long, value_name = "FILE")]
    machine: Option<PathBuf>,
}

/// A problem in the number of dimensions that its part has.
pub(crate) enum AnyProblem {
    Planar(Problem<2>),
    Spatial(Problem<3>),
}

impl Input {
    /// Reads both files as a problem to plan and run.
    pub(crate) fn read(&self) -> Result<AnyProblem> {
        let (part, machine) = self.part_and_machine()?;
        Ok(if part.curves.iter().all(|curve| curve.dimension == 2) {
            AnyProblem::Planar(Problem::new(&part, &machine)?)
        } else {
            AnyProblem::Spatial(Problem::new(&part, &machine)?)
        })
    }

    /// Reads both files.
    pub(crate) fn part_and_machine(&self) -> Result<(Part, Machine)> {
        let part = match &self.part {
            Some(path) => part_program::read_part(&path.display().to_string(), &text(path)?)?,
            None => part_program::read_part("built-in example", EXAMPLE)?,
        };
        for warning in &part.warnings {
            eprintln!("{warning}");
        }
        let machine = self.machine(&part)?;
        Ok((part, machine))
    }

    fn machine(&self, part: &Part) -> Result<Machine> {
        if let Some(path) = &self.machine {
            return Ok(part_program::read_machine(&path.display().to_string(), &text(path)?)?);
        }
        match &part.machine {
            Some(machine) => Ok(machine.clone()),
            None => bail!("{} names no machine: give its limits with --machine FILE.toml", part.name),
        }
    }
}

/// A whole file as text.
pub(crate) fn text(path: &Path) -> Result<String> {
    let bytes = fs::read(path).with_context(|| format!("cannot read {}", path.display()))?;
    String::from_utf8(bytes).map_err(|error| {
        let at = error.utf8_error().valid_up_to();
        anyhow::anyhow!(
            "{}: byte {at} is not UTF-8 text: expected a curve file or a part program",
            path.display()
        )
    })
}
