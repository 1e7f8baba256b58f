//! Where the results of a set are kept: in memory, in the file of the set, and in a folder of results by what they are of.

use std::fs::File;
use std::io::{BufRead, BufReader, Write};
use std::path::PathBuf;

use anyhow::{Context, Result};

use crate::fingerprint::fingerprint_of;
use crate::output;
use crate::places::{Folder, Place, write_file};
use crate::resumed_file::{ResumedFile, line, read_line};
use crate::set::known::{Known, PartEnding, PartOfSet, SetLine, SetOfParts};

/// The results of a set.
pub(crate) struct Store {
    known: Known,
    file: Option<ResumedFile>,
    cache: Option<Cache>,
}

impl Store {
    /// What the file of the set and the folder of results have.
    pub(crate) fn open(set: &SetOfParts, file: Option<&Place>, folder: Option<Folder>) -> Result<Self> {
        let mut store = Self { known: Known::default(), file: None, cache: None };
        if let Some(place) = file {
            let (file, lines) = ResumedFile::resume(place, set)?;
            store.file = Some(file);
            lines.into_iter().try_for_each(|line| store.known.add(line))?;
        }
        if let Some(folder) = folder {
            let cache = Cache { folder, keys: set.parts.iter().map(|part| key(set, part)).collect() };
            for part in 0..set.parts.len() {
                for line in cache.lines_of(part) {
                    store.take_in(line)?;
                }
            }
            store.cache = Some(cache);
        }
        Ok(store)
    }

    /// Takes in a line that the folder has and the file may not have.
    fn take_in(&mut self, line: SetLine) -> Result<()> {
        if !self.known.has(&line) {
            self.file.as_mut().map_or(Ok(()), |file| file.add(&line))?;
        }
        self.known.add(line)
    }

    /// What is known so far.
    pub(crate) fn known(&self) -> &Known {
        &self.known
    }

    /// An error if a line could not be written: nothing more is run in vain.
    pub(crate) fn expect_room(&self) -> Result<()> {
        self.file.as_ref().map_or(Ok(()), ResumedFile::expect_room)
    }

    /// Adds what was found out, in memory and where it is kept.
    pub(crate) fn add(&mut self, line: SetLine) -> Result<()> {
        self.file.as_mut().map_or(Ok(()), |file| file.add(&line))?;
        let part = line.part();
        self.known.add(line)?;
        self.cache.as_ref().map_or(Ok(()), |cache| cache.write(part, &self.known))
    }
}

/// A folder of results, a file for each part as it is now. The file is named by all that a result depends on.
struct Cache {
    folder: Folder,
    /// The name of each part's file.
    keys: Vec<String>,
}

/// The name of a part's file.
fn key(set: &SetOfParts, part: &PartOfSet) -> String {
    let text = format!("{} {} {} {}", set.set, set.fingerprint, part.fingerprint, part.name);
    format!("{}-{}.jsonl", fingerprint_of(&text), part.fingerprint)
}

impl Cache {
    fn path(&self, part: usize) -> PathBuf {
        self.folder.path().join(&self.keys[part])
    }

    /// The lines of a part's file, none if there is no such file. A file that is damaged is as if it were not there.
    fn lines_of(&self, part: usize) -> Vec<SetLine> {
        let Ok(file) = File::open(self.path(part)) else { return Vec::new() };
        let mut lines = Vec::new();
        let mut source = BufReader::new(file);
        loop {
            let mut bytes = Vec::new();
            match source.read_until(b'\n', &mut bytes) {
                Ok(0) => return lines,
                Ok(_) => match read_line::<SetLine>(&bytes, "part", "a part of a set") {
                    Ok(line) => lines.push(line.of_part(part)),
                    Err(_) => break,
                },
                Err(_) => break,
            }
        }
        output::note(&format!("{} is damaged: its part is run again", self.path(part).display()));
        Vec::new()
    }

    /// Writes what is known of a part, unless it cannot be read.
    fn write(&self, part: usize, known: &Known) -> Result<()> {
        if matches!(known.ending(part), Some(PartEnding::Unread(_)) | None) {
            return Ok(());
        }
        let lines = known.lines_of(part).map(|of_part| line(&of_part.of_part(0)));
        let text = lines.collect::<Result<String>>()?;
        let path = self.path(part);
        write_file(&path, |file| {
            file.write_all(text.as_bytes()).with_context(|| format!("cannot write {}", path.display()))
        })
    }
}
