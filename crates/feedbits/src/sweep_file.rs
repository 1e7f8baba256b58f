//! The file of a sweep. Its first line holds the sweep's parameters. Then it has a line of JSON for each cell, in the
//! order in which they end. A whole line is written at once, so an interruption tears only the last one.

use std::collections::HashSet;
use std::fs::{File, OpenOptions, TryLockError};
use std::io::{BufRead, BufReader, Read, Seek, SeekFrom, Write};
use std::path::Path;

use anyhow::{Context, Result, bail};
use foreign_text::in_a_file_name;
use format_report::{Sweep, SweepCell};
use part_program::MAX_TEXT;

use crate::output;

/// Opens the file of a sweep and returns the cells that it has. No other sweep may write it until it is closed. A file
/// that is not of this sweep is left unchanged. If its last line is torn, that line is cut off.
pub(crate) fn resume(path: &Path, plan: &Sweep) -> Result<(File, Vec<SweepCell>)> {
    let name = path.display();
    let cannot = || format!("cannot open {name}");
    let mut file = OpenOptions::new()
        .read(true)
        .write(true)
        .create(true)
        .truncate(false)
        .open(path)
        .with_context(cannot)?;
    lock(&file, path)?;
    let header = serde_json::to_string(plan)? + "\n";
    let (found, lines) = parsed(&name.to_string(), BufReader::new(&file))?;
    let torn = !lines.last.is_empty();
    let Some((found, cells)) = found else {
        if !header.as_bytes().starts_with(&lines.last) {
            bail!("{name} is not the file of a sweep: give another --out");
        }
        if torn {
            file.set_len(0).with_context(cannot)?;
            file.seek(SeekFrom::Start(0)).with_context(cannot)?;
        }
        file.write_all(header.as_bytes()).with_context(cannot)?;
        return Ok((file, Vec::new()));
    };
    if found != *plan {
        bail!(
            "{name} is of another sweep (another part, machine, grid, list of formats or options): give another --out, or the \
             arguments it was begun with"
        );
    }
    if torn {
        output::note(&format!("the last line of {name} was torn and is run again"));
        file.set_len(lines.whole).with_context(cannot)?;
    }
    file.seek(SeekFrom::End(0)).with_context(cannot)?;
    Ok((file, cells))
}

/// Keeps other sweeps out of a file. If the file cannot be locked, as on some networks, a note says so.
fn lock(file: &File, path: &Path) -> Result<()> {
    let name = path.display();
    match file.try_lock() {
        Ok(()) => {}
        Err(TryLockError::WouldBlock) => {
            bail!("another sweep writes {name}: give another --out, or wait until it has ended");
        }
        Err(TryLockError::Error(error)) => {
            output::note(&format!("cannot lock {name} ({error}): let no other sweep write it"));
        }
    }
    Ok(())
}

/// Reads a sweep's file. Its last line may be torn, or its cell may still be written.
pub(crate) fn read(path: &Path) -> Result<Found> {
    let name = path.display();
    let file = File::open(path).with_context(|| format!("cannot read {name}"))?;
    let (found, _) = parsed(&name.to_string(), BufReader::new(file))?;
    found.with_context(|| format!("{name}: expected the file of a sweep, found no line of it"))
}

/// Cells of a sweep, at most.
pub(crate) const MOST_CELLS: usize = 1_000_000;

/// The sweep's parameters, and the cells in the file.
type Found = (Sweep, Vec<SweepCell>);

/// The parameters and the cells in the whole lines, if there is one, and where these lines end. Every cell is at the
/// place of its number, and has a result for each run or a reason.
fn parsed<S: BufRead>(name: &str, source: S) -> Result<(Option<Found>, Lines<S>)> {
    let mut lines = Lines { source, number: 0, whole: 0, last: Vec::new() };
    if !lines.advance(name)? {
        return Ok((None, lines));
    }
    let plan: Sweep = serde_json::from_slice(&lines.last)
        .with_context(|| format!("{name}, line 1: expected what is swept, as `feedbits sweep` writes it"))?;
    if plan.len() > MOST_CELLS {
        bail!("{name}, line 1: a sweep of {} cells: expected at most {MOST_CELLS}", plan.len());
    }
    expect_names_of_runs(name, &plan.runs)?;
    let mut cells = Vec::new();
    while lines.advance(name)? {
        let number = lines.number;
        let cell: SweepCell = serde_json::from_slice(&lines.last)
            .with_context(|| format!("{name}, line {number}: expected a cell of the sweep"))?;
        let place = Some((cell.period_ms, cell.feed_mm_per_s, cell.size_mm));
        let complete = cell.skipped.is_some() || cell.results.len() == plan.runs.len();
        if plan.place(cell.cell) != place || !complete {
            bail!("{name}, line {number}: cell {} does not belong to the grid of line 1", cell.cell);
        }
        cells.push(cell);
    }
    Ok((Some((plan, cells)), lines))
}

/// The longest name of a run.
const LONGEST_RUN: usize = 64;

/// Refuses runs whose pictures would not have names of their own.
fn expect_names_of_runs(name: &str, runs: &[String]) -> Result<()> {
    let mut files = HashSet::new();
    for run in runs {
        if run.len() > LONGEST_RUN || !files.insert(in_a_file_name(run)) {
            bail!(
                "{name}, line 1: expected runs such as \"I4F28 pieces\", each once; found {:?}",
                run.chars().take(LONGEST_RUN).collect::<String>()
            );
        }
    }
    Ok(())
}

/// Lines one by one: a sweep's file may be longer than the most that is read at once.
struct Lines<S> {
    source: S,
    /// Number of lines read, including a torn one.
    number: usize,
    /// Total length of the whole lines, in bytes.
    whole: u64,
    /// The last line read; at the end of the file, the torn line.
    last: Vec<u8>,
}

impl<S: BufRead> Lines<S> {
    /// Reads the next line; `false` if no whole line is left.
    fn advance(&mut self, name: &str) -> Result<bool> {
        self.last.clear();
        self.number += 1;
        let most = u64::try_from(MAX_TEXT)?;
        let length = (&mut self.source)
            .take(most)
            .read_until(b'\n', &mut self.last)
            .with_context(|| format!("cannot read {name}"))?;
        if self.last.ends_with(b"\n") {
            self.whole += u64::try_from(length)?;
            return Ok(true);
        }
        if length == MAX_TEXT {
            bail!("{name}, line {}: longer than {} MiB, not a line of a sweep", self.number, MAX_TEXT >> 20);
        }
        Ok(false)
    }
}
