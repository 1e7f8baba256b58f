//! `feedbits merge`: joins the files of shards, of a sweep or of a set of parts.

use std::collections::BTreeMap;
use std::iter;
use std::path::PathBuf;

use anyhow::{Context, Result, bail};
use clap::Args;
use foreign_text::in_lines;
use format_report::{Sweep, SweepCell};

use crate::ending::Ending;
use crate::places::Place;
use crate::resumed_file::Begun;
use crate::set::known::{Known, SetOfParts};
use crate::sweep::Places;
use crate::{output, report, resumed_file, sweep};

/// Options of `merge`.
#[derive(Args)]
pub(crate) struct Arguments {
    /// Files that `feedbits sweep` wrote, of the same sweep, or `compare` or `size` of the same parts.
    #[arg(required = true, value_name = "FILE")]
    files: Vec<PathBuf>,
    /// The file of all their cells or parts.
    #[arg(long, value_name = "PATH")]
    out: PathBuf,
    /// Write what there is, even if cells or parts are in none of the files.
    #[arg(long)]
    partial: bool,
    /// Write a report into this folder, with a heat map for each format.
    #[arg(long, value_name = "DIR")]
    report: Option<PathBuf>,
}

/// Joins the files and writes the result.
pub(crate) fn run(arguments: &Arguments) -> Result<Ending> {
    let Some((first, others)) = arguments.files.split_first() else { bail!("expected at least one file") };
    let first = Begun::open(first)?;
    if first.is_of::<SetOfParts>() {
        join_sets(arguments, first, others)
    } else {
        join_sweeps(arguments, first, others)
    }
}

/// The files, of which the first is open.
fn opened<'a>(first: Begun, others: &'a [PathBuf]) -> impl Iterator<Item = Result<Begun>> + use<'a> {
    iter::once(Ok(first)).chain(others.iter().map(|path| Begun::open(path)))
}

/// Joins the files of a set of parts.
fn join_sets(arguments: &Arguments, first: Begun, others: &[PathBuf]) -> Result<Ending> {
    if arguments.report.is_some() {
        bail!("--report: a report is of a sweep: expected the files of one, or no --report");
    }
    let (place, terminal) = (Place::named("--out", Some(&arguments.out))?, Place::terminal()?);
    let mut joined: Option<(SetOfParts, String)> = None;
    let mut known = Known::default();
    for file in opened(first, others) {
        let file = file?;
        let name = file.name().to_string();
        let (set, lines): (SetOfParts, _) = file.read()?;
        match &joined {
            Some((first, of)) if *first != set => bail!(
                "{of} and {name} are of different sets: expected the same parts, machine, formats and options"
            ),
            Some(_) => {}
            None => joined = Some((set, name.clone())),
        }
        lines.into_iter().try_for_each(|line| known.add(line)).with_context(|| name.clone())?;
    }
    let Some((set, _)) = joined else { bail!("expected at least one file") };
    let (all, done) = (set.parts.len(), known.len());
    let missing = (0..all).find(|part| known.ending(*part).is_none());
    if let (false, Some(first)) = (arguments.partial, missing) {
        bail!(
            "{} of {all} parts are in none of the files, the first of them {}: expected the files of all shards, run to their ends, or \
             --partial",
            all - done,
            set.parts[first].name
        );
    }
    let lines = known.lines(all).map(|line| resumed_file::line(&line));
    let text = resumed_file::line(&set)? + &lines.collect::<Result<String>>()?;
    output::write(&place, &text)?;
    let text = format!(
        "{done} of {all} parts in {}; the same {} without --shard and with --resume {0} has the answer\n",
        arguments.out.display(),
        set.set
    );
    output::write(&terminal, &in_lines(&text))?;
    Ok(Ending::Good)
}

/// Joins the files of a sweep.
fn join_sweeps(arguments: &Arguments, first: Begun, others: &[PathBuf]) -> Result<Ending> {
    let places = Places {
        folder: report::folder(arguments.report.as_deref())?,
        file: Place::named("--out", Some(&arguments.out))?,
        terminal: Place::terminal()?,
    };
    let mut joined = None;
    let mut cells: BTreeMap<usize, (SweepCell, String)> = BTreeMap::new();
    for file in opened(first, others) {
        let file = file?;
        let name = file.name().to_string();
        let (plan, found): (Sweep, _) = file.read()?;
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
