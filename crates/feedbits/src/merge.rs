//! `feedbits merge`: joins the files of a sweep's shards.

use std::collections::BTreeMap;
use std::path::PathBuf;

use anyhow::{Result, bail};
use clap::Args;
use format_report::{Sweep, SweepCell};

use crate::ending::Ending;
use crate::places::Place;
use crate::sweep::Places;
use crate::{output, report, resumed_file, sweep};

/// Options of `merge`.
#[derive(Args)]
pub(crate) struct Arguments {
    /// Files that `feedbits sweep` wrote, of the same sweep.
    #[arg(required = true, value_name = "FILE")]
    files: Vec<PathBuf>,
    /// The file of all their cells.
    #[arg(long, value_name = "PATH")]
    out: PathBuf,
    /// Write what there is, even if cells of the sweep are in none of the files.
    #[arg(long)]
    partial: bool,
    /// Write a report into this folder, with a heat map for each format.
    #[arg(long, value_name = "DIR")]
    report: Option<PathBuf>,
}

/// Joins the files and writes the result.
pub(crate) fn run(arguments: &Arguments) -> Result<Ending> {
    let places = Places {
        folder: report::folder(arguments.report.as_deref())?,
        file: Place::named("--out", Some(&arguments.out))?,
        terminal: Place::terminal()?,
    };
    let mut joined = None;
    let mut cells: BTreeMap<usize, (SweepCell, String)> = BTreeMap::new();
    for path in &arguments.files {
        let name = path.display().to_string();
        let (plan, found): (Sweep, _) = resumed_file::read(path)?;
        match &joined {
            None => joined = Some((plan, name.clone())),
            Some((first, of)) if *first != plan => bail!(
                "{of} and {name} are of different sweeps: expected the same part, machine, grid, formats and options"
            ),
            Some(_) => {}
        }
        for cell in found {
            if let Some((known, of)) = cells.get(&cell.cell)
                && *known != cell
            {
                bail!("{of} and {name} contradict each other on cell {}", cell.cell);
            }
            cells.entry(cell.cell).or_insert((cell, name.clone()));
        }
    }
    let Some((plan, _)) = joined else { bail!("expected at least one file") };
    let missing: Vec<usize> = (0..plan.len()).filter(|cell| !cells.contains_key(cell)).collect();
    if let (false, [first, ..]) = (arguments.partial, &missing[..]) {
        bail!(
            "{} of {} cells are in none of the files, the first of them {first}: expected the files of all shards, run to \
             their ends, or --partial",
            missing.len(),
            plan.len()
        );
    }
    let cells: Vec<SweepCell> = cells.into_values().map(|(cell, _)| cell).collect();
    let mut text = resumed_file::line(&plan)?;
    for cell in &cells {
        text += &resumed_file::line(cell)?;
    }
    let report = sweep::report_of(&plan, &cells, &places)?;
    output::write(&places.file, &text)?;
    sweep::conclude(&plan, &cells, &places, report.as_ref())
}
