//! The file of a sweep. Its first line holds the sweep's parameters. Then it has a line of JSON for each cell, in the
//! order in which they end. A whole line is written at once, so an interruption tears only the last one.
//!
//! The last member of each line, `crc32`, is the checksum of the bytes of the line before it, in eight hexadecimal digits. So a
//! line in which a digit was changed is told from one that was written.

use std::collections::HashSet;
use std::fs::{File, OpenOptions, TryLockError};
use std::io::{BufRead, BufReader, Read, Seek, SeekFrom, Write};
use std::path::Path;

use anyhow::{Context, Result, bail};
use foreign_text::in_a_file_name;
use format_report::{Sweep, SweepCell};
use part_program::MAX_TEXT;
use secant_interp::crc32;
use serde::Serialize;
use serde::de::DeserializeOwned;

use crate::places::Place;
use crate::{files, output};

/// The file of a sweep that runs.
pub(crate) struct SweepFile {
    file: File,
    name: String,
    /// Total length of the whole lines, in bytes.
    whole: u64,
    /// Why a cell could not be written. No other is written after it.
    failure: Option<String>,
}

impl SweepFile {
    /// Opens the file of a sweep and returns the cells that it has. No other sweep may write it until it is closed. A
    /// file that is not of this sweep is left unchanged. If its last line is torn, that line is cut off.
    pub(crate) fn resume(place: &Place, plan: &Sweep) -> Result<(Self, Vec<SweepCell>)> {
        let Some(path) = place.path() else { bail!("a sweep needs a file: give --out") };
        let name = path.display();
        let cannot = || format!("cannot open {name}");
        let mut file = OpenOptions::new()
            .read(true)
            .write(true)
            .create(true)
            .truncate(false)
            .open(path)
            .with_context(cannot)?;
        if !file.metadata().with_context(cannot)?.is_file() {
            // A pipe would be waited for.
            bail!("{name} is no file: a sweep reads what it has before it goes on");
        }
        lock(&file, path)?;
        let header = line(plan)?;
        let (found, lines) = parsed(&name.to_string(), BufReader::new(&file))?;
        let (torn, whole) = (!lines.last.is_empty(), lines.whole);
        let Some((found, cells)) = found else {
            if !header.as_bytes().starts_with(&lines.last) {
                bail!("{name} is not the file of a sweep: give another --out");
            }
            if torn {
                file.set_len(0).with_context(cannot)?;
                file.seek(SeekFrom::Start(0)).with_context(cannot)?;
            }
            let mut file = Self { file, name: name.to_string(), whole: 0, failure: None };
            file.add_line(&header)?;
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
            file.set_len(whole).with_context(cannot)?;
        }
        file.seek(SeekFrom::End(0)).with_context(cannot)?;
        Ok((Self { file, name: name.to_string(), whole, failure: None }, cells))
    }

    /// Adds a cell that is finished.
    ///
    /// # Errors
    /// If it cannot be written, as on a full disk, or if one before it could not. The file then ends behind the last
    /// whole line.
    pub(crate) fn add(&mut self, cell: &SweepCell) -> Result<()> {
        self.add_line(&line(cell)?)
    }

    /// An error if a cell could not be written.
    pub(crate) fn expect_room(&self) -> Result<()> {
        self.failure.as_ref().map_or(Ok(()), |failure| bail!("{failure}"))
    }

    fn add_line(&mut self, line: &str) -> Result<()> {
        self.expect_room()?;
        if let Err(error) = self.file.write_all(line.as_bytes()).and_then(|()| self.file.flush()) {
            self.failure = Some(format!("cannot write a finished cell to {}: {error}", self.name));
            // If what is torn cannot be cut off either, the next sweep does it.
            let _ = self.file.set_len(self.whole);
        } else {
            self.whole += u64::try_from(line.len())?;
        }
        self.expect_room()
    }
}

/// The begin of the last member of a line, and its end after the digits.
const CHECKSUM: [&str; 2] = [",\"crc32\":\"", "\"}\n"];

/// A line of the file: the parameters, or a cell.
pub(crate) fn line(value: &impl Serialize) -> Result<String> {
    let object = serde_json::to_string(value)?;
    let members = object.strip_suffix('}').unwrap_or(&object);
    Ok(format!("{members}{}", checksum_of(members)))
}

/// The end of a line: the checksum of what is before it.
fn checksum_of(members: &str) -> String {
    format!("{}{:08x}{}", CHECKSUM[0], crc32(members.as_bytes()), CHECKSUM[1])
}

/// What a line holds. `expected` says what that shall be.
fn read_line<T: DeserializeOwned>(line: &[u8], expected: &str) -> Result<T> {
    let text = str::from_utf8(line).ok();
    let Some((members, digits)) = text.and_then(|text| text.rsplit_once(CHECKSUM[0])) else {
        bail!(
            "expected {expected}, with a checksum at its end; without one, it was written by something else, or by an older feedbits"
        );
    };
    if format!("{}{}\n", CHECKSUM[0], digits.trim_ascii_end()) != checksum_of(members) {
        bail!(
            "it is damaged: its checksum is that of another line; take the line out, and `feedbits sweep` runs its cell again"
        );
    }
    serde_json::from_str(&format!("{members}}}")).with_context(|| format!("expected {expected}"))
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
    let file = files::open("the file", path)?;
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
    let plan: Sweep = read_line(&lines.last, "what is swept, as `feedbits sweep` writes it")
        .with_context(|| format!("{name}, line 1"))?;
    if plan.len() > MOST_CELLS {
        bail!("{name}, line 1: a sweep of {} cells: expected at most {MOST_CELLS}", plan.len());
    }
    expect_names_of_runs(name, &plan.runs)?;
    let mut cells = Vec::new();
    while lines.advance(name)? {
        let number = lines.number;
        let cell: SweepCell = read_line(&lines.last, "a cell of the sweep")
            .with_context(|| format!("{name}, line {number}"))?;
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
        let cannot = || format!("cannot read {name}");
        if self.source.fill_buf().with_context(cannot)?.first() == Some(&0) {
            bail!("{name}, line {}: begins with a byte of 0, not a line of a sweep", self.number);
        }
        let most = u64::try_from(MAX_TEXT)?;
        let length = (&mut self.source).take(most).read_until(b'\n', &mut self.last).with_context(cannot)?;
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

#[cfg(test)]
mod tests {
    use super::*;

    fn cell() -> SweepCell {
        SweepCell { cell: 7, period_ms: 0.1, feed_mm_per_s: 1e-7, size_mm: 12.5, ..SweepCell::default() }
    }

    /// The checksum is zlib's of the bytes before it.
    #[test]
    fn a_line_is_json_with_the_checksum_of_everybody() {
        #[derive(Serialize)]
        struct Small {
            cell: u32,
        }
        assert_eq!(line(&Small { cell: 0 }).expect("a line"), "{\"cell\":0,\"crc32\":\"d8404ab0\"}\n");
        let line = line(&cell()).expect("a line");
        let json: serde_json::Value = serde_json::from_str(&line).expect("JSON");
        assert_eq!(json["cell"], 7);
        assert_eq!(read_line::<SweepCell>(line.as_bytes(), "a cell").expect("a cell"), cell());
    }

    /// Whatever single byte of a line is another, or is missing or there twice: it is an error.
    #[test]
    fn every_changed_byte_is_found() {
        let line = line(&cell()).expect("a line").into_bytes();
        let is_refused = |changed: &[u8]| read_line::<SweepCell>(changed, "a cell").is_err();
        for at in 0..line.len() - 1 {
            for other in (0..=u8::MAX).filter(|other| *other != line[at]) {
                let mut changed = line.clone();
                changed[at] = other;
                assert!(is_refused(&changed), "byte {at} is {other}");
            }
            let mut longer = line.clone();
            longer.insert(at, line[at]);
            let mut shorter = line.clone();
            shorter.remove(at);
            assert!(is_refused(&longer) && is_refused(&shorter), "byte {at}");
        }
    }
}
