//! The file of long work: of a sweep, or of a set of parts. Its first line says what the work is. Then it has a line of JSON for each
//! cell, or part, in the order in which they end. A whole line is written at once, so an interruption tears only the last one.
//!
//! The last member of each line, `crc32`, is the checksum of the bytes of the line before it, in eight hexadecimal digits. So a
//! line in which a digit was changed is told from one that was written.

use std::fs::{File, OpenOptions, TryLockError};
use std::io::{BufRead, BufReader, Cursor, Read, Seek, SeekFrom, Write};
use std::path::Path;

use anyhow::{Context, Result, bail};
use part_program::MAX_TEXT;
use secant_interp::crc32;
use serde::Serialize;
use serde::de::DeserializeOwned;

use crate::places::Place;
use crate::{files, output};

/// What the first line of a file says, and what its further lines are.
pub(crate) trait Work: Serialize + DeserializeOwned + PartialEq {
    /// A line that is not the first.
    type Line: Serialize + DeserializeOwned;
    /// What the work is called, as in "sweep".
    const NAME: &'static str;
    /// What a line is called, as in "cell".
    const LINE: &'static str;
    /// The option that names the file.
    const OPTION: &'static str;
    /// What tells two works apart.
    const TOLD_BY: &'static str;

    /// Refuses a first line that no `feedbits` has written.
    fn expect_plausible(&self) -> Result<()>;

    /// Refuses a line that does not belong to the work.
    fn expect_of_it(&self, line: &Self::Line) -> Result<()>;
}

/// The file of work that is done.
pub(crate) struct ResumedFile {
    file: File,
    name: String,
    /// What a line is called.
    line: &'static str,
    /// Total length of the whole lines, in bytes.
    whole: u64,
    /// Why a line could not be written. No other is written after it.
    failure: Option<String>,
}

impl ResumedFile {
    /// Opens the file of a work and returns the lines that it has. No other call may write it until it is closed. A
    /// file that is not of this work is left unchanged. If its last line is torn, that line is cut off.
    pub(crate) fn resume<W: Work>(place: &Place, work: &W) -> Result<(Self, Vec<W::Line>)> {
        let (what, option) = (W::NAME, W::OPTION);
        let Some(path) = place.path() else { bail!("a {what} needs a file: give {option}") };
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
            bail!("{name} is no file: a {what} reads what it has before it goes on");
        }
        lock::<W>(&file, path)?;
        let header = line(work)?;
        let (found, lines) = parsed::<W, _>(&name.to_string(), BufReader::new(&file))?;
        let (torn, whole) = (!lines.last.is_empty(), lines.whole);
        let Some((found, done)) = found else {
            if !header.as_bytes().starts_with(&lines.last) {
                bail!("{name} is not the file of a {what}: give another {option}");
            }
            if torn {
                file.set_len(0).with_context(cannot)?;
                file.seek(SeekFrom::Start(0)).with_context(cannot)?;
            }
            let mut file = Self { file, name: name.to_string(), line: W::LINE, whole: 0, failure: None };
            file.add_line(&header)?;
            return Ok((file, Vec::new()));
        };
        if found != *work {
            bail!(
                "{name} is of another {what} ({}): give another {option}, or the arguments it was begun with",
                W::TOLD_BY
            );
        }
        if torn {
            output::note(&format!("the last line of {name} was torn and is run again"));
            file.set_len(whole).with_context(cannot)?;
        }
        file.seek(SeekFrom::End(0)).with_context(cannot)?;
        Ok((Self { file, name: name.to_string(), line: W::LINE, whole, failure: None }, done))
    }

    /// Adds a line of what is finished.
    ///
    /// # Errors
    /// If it cannot be written, as on a full disk, or if one before it could not. The file then ends behind the last
    /// whole line.
    pub(crate) fn add(&mut self, finished: &impl Serialize) -> Result<()> {
        self.add_line(&line(finished)?)
    }

    /// An error if a line could not be written.
    pub(crate) fn expect_room(&self) -> Result<()> {
        self.failure.as_ref().map_or(Ok(()), |failure| bail!("{failure}"))
    }

    fn add_line(&mut self, line: &str) -> Result<()> {
        self.expect_room()?;
        if let Err(error) = self.file.write_all(line.as_bytes()).and_then(|()| self.file.flush()) {
            self.failure = Some(format!("cannot write a finished {} to {}: {error}", self.line, self.name));
            // If what is torn cannot be cut off either, the next call does it.
            let _ = self.file.set_len(self.whole);
        } else {
            self.whole += u64::try_from(line.len())?;
        }
        self.expect_room()
    }
}

/// The begin of the last member of a line, and its end after the digits.
const CHECKSUM: [&str; 2] = [",\"crc32\":\"", "\"}\n"];

/// A line of the file.
pub(crate) fn line(value: &impl Serialize) -> Result<String> {
    let object = serde_json::to_string(value)?;
    let members = object.strip_suffix('}').unwrap_or(&object);
    Ok(format!("{members}{}", checksum_of(members)))
}

/// The end of a line: the checksum of what is before it.
fn checksum_of(members: &str) -> String {
    format!("{}{:08x}{}", CHECKSUM[0], crc32(members.as_bytes()), CHECKSUM[1])
}

/// What a line holds, which is called `what`. `expected` says what that shall be.
pub(crate) fn read_line<T: DeserializeOwned>(line: &[u8], what: &str, expected: &str) -> Result<T> {
    let text = str::from_utf8(line).ok();
    let Some((members, digits)) = text.and_then(|text| text.rsplit_once(CHECKSUM[0])) else {
        bail!(
            "expected {expected}, with a checksum at its end; without one, it was written by something else, or by an older feedbits"
        );
    };
    if format!("{}{}\n", CHECKSUM[0], digits.trim_ascii_end()) != checksum_of(members) {
        bail!(
            "it is damaged: its checksum is that of another line; take the line out, and the next call runs its {what} again"
        );
    }
    serde_json::from_str(&format!("{members}}}")).with_context(|| format!("expected {expected}"))
}

/// Keeps other calls out of a file. If the file cannot be locked, as on some networks, a note says so.
fn lock<W: Work>(file: &File, path: &Path) -> Result<()> {
    let (name, what, option) = (path.display(), W::NAME, W::OPTION);
    match file.try_lock() {
        Ok(()) => {}
        Err(TryLockError::WouldBlock) => {
            bail!("another {what} writes {name}: give another {option}, or wait until it has ended");
        }
        Err(TryLockError::Error(error)) => {
            output::note(&format!("cannot lock {name} ({error}): let no other {what} write it"));
        }
    }
    Ok(())
}

/// A file of some work, of which the first line was read: a pipe gives it once.
pub(crate) struct Begun {
    name: String,
    /// The first line, or what there is of it.
    first: Vec<u8>,
    rest: BufReader<File>,
}

impl Begun {
    /// Opens a file and reads its first line.
    pub(crate) fn open(path: &Path) -> Result<Self> {
        let name = path.display().to_string();
        let source = BufReader::new(files::open("the file", path)?);
        let mut lines = Lines { source, what: "sweep or a set", number: 0, whole: 0, last: Vec::new() };
        lines.advance(&name)?;
        Ok(Self { name, first: lines.last, rest: lines.source })
    }

    pub(crate) fn name(&self) -> &str {
        &self.name
    }

    /// Whether the first line is that of such work.
    pub(crate) fn is_of<W: Work>(&self) -> bool {
        read_line::<W>(&self.first, W::LINE, W::NAME).is_ok()
    }

    /// Reads the file of a work. Its last line may be torn, or still be written.
    pub(crate) fn read<W: Work>(self) -> Result<Found<W>> {
        let Self { name, first, rest } = self;
        let (found, _) = parsed(&name, Cursor::new(first).chain(rest))?;
        found.with_context(|| format!("{name}: expected the file of a {}, found no line of it", W::NAME))
    }
}

/// What the work is, and the lines of it in the file.
type Found<W> = (W, Vec<<W as Work>::Line>);

/// What the whole lines say, if there is one, and where these lines end. Every line belongs to the work of the first.
fn parsed<W: Work, S: BufRead>(name: &str, source: S) -> Result<(Option<Found<W>>, Lines<S>)> {
    let mut lines = Lines { source, what: W::NAME, number: 0, whole: 0, last: Vec::new() };
    if !lines.advance(name)? {
        return Ok((None, lines));
    }
    let at = |number: usize| format!("{name}, line {number}");
    let expected = format!("what is done, as the first line of a {} has it", W::NAME);
    let work: W = read_line(&lines.last, W::LINE, &expected).with_context(|| at(1))?;
    work.expect_plausible().with_context(|| at(1))?;
    let mut done = Vec::new();
    let expected = format!("a {} of the {}", W::LINE, W::NAME);
    while lines.advance(name)? {
        let number = lines.number;
        let line: W::Line = read_line(&lines.last, W::LINE, &expected).with_context(|| at(number))?;
        work.expect_of_it(&line).with_context(|| at(number))?;
        done.push(line);
    }
    Ok((Some((work, done)), lines))
}

/// Lines one by one: a file may be longer than the most that is read at once.
struct Lines<S> {
    source: S,
    /// What the work is called.
    what: &'static str,
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
            bail!("{name}, line {}: begins with a byte of 0, not a line of a {}", self.number, self.what);
        }
        let most = u64::try_from(MAX_TEXT)?;
        let length = (&mut self.source).take(most).read_until(b'\n', &mut self.last).with_context(cannot)?;
        if self.last.ends_with(b"\n") {
            self.whole += u64::try_from(length)?;
            return Ok(true);
        }
        if length == MAX_TEXT {
            bail!(
                "{name}, line {}: longer than {} MiB, not a line of a {}",
                self.number,
                MAX_TEXT >> 20,
                self.what
            );
        }
        Ok(false)
    }
}

#[cfg(test)]
mod tests {
    use format_report::SweepCell;

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
        assert_eq!(read_line::<SweepCell>(line.as_bytes(), "cell", "a cell").expect("a cell"), cell());
    }

    /// Whatever single byte of a line is another, or is missing or there twice: it is an error.
    #[test]
    fn every_changed_byte_is_found() {
        let line = line(&cell()).expect("a line").into_bytes();
        let is_refused = |changed: &[u8]| read_line::<SweepCell>(changed, "cell", "a cell").is_err();
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
