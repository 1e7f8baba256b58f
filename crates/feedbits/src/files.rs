//! Reads whole files and pipes, up to the largest size of their kind. Every file that is opened here is claimed as an input of
//! this call. `option` is what names it on the command line.

use std::fs::File;
use std::io::Read;
use std::path::Path;

use anyhow::{Context, Result, bail};
use part_program::{MAX_PROGRAM, MAX_TEXT};

use crate::claims;

/// The largest part, in bytes.
pub(crate) const MOST_OF_PART: usize = MAX_PROGRAM;
/// The largest machine file: the machine may stand in a curve file.
pub(crate) const MOST_OF_MACHINE: usize = MAX_TEXT;
/// The largest servo or target file: each value takes some hundred bytes.
pub(crate) const MOST_OF_SMALL: usize = 1 << 20;
/// The largest result of an earlier run.
pub(crate) const MOST_OF_RESULT: usize = 16 << 20;

/// So many zeros at the begin of a file are no text.
const NOTHING: usize = 512;

/// A whole file as text.
pub(crate) fn text(option: &str, path: &Path, most: usize) -> Result<String> {
    String::from_utf8(bytes(option, path, most)?).map_err(|error| {
        let at = error.utf8_error().valid_up_to();
        anyhow::anyhow!("{}: byte {at} is not UTF-8 text: expected a text file", path.display())
    })
}

/// A whole file. A file that is too long is refused before memory is taken for it; a pipe, once it has given too much.
pub(crate) fn bytes(option: &str, path: &Path, most: usize) -> Result<Vec<u8>> {
    let name = path.display().to_string();
    let file = open(option, path)?;
    if file.metadata().with_context(|| format!("cannot read {name}"))?.len() > u64::try_from(most)? {
        bail!(too_long(&name, most));
    }
    taken(&name, file, most)
}

/// Opens a file to read it.
///
/// # Errors
/// If it cannot be opened, or if this call writes it.
pub(crate) fn open(option: &str, path: &Path) -> Result<File> {
    let file = File::open(path).with_context(|| format!("cannot read {}", path.display()))?;
    claims::read(option, path, &file)?;
    Ok(file)
}

/// All bytes of a source, unless there are too many, or nothing but zeros as in `/dev/zero`.
pub(crate) fn taken(name: &str, mut source: impl Read, most: usize) -> Result<Vec<u8>> {
    let mut bytes = Vec::new();
    let mut take = |count: usize, bytes: &mut Vec<u8>| {
        let taken = (&mut source).take(u64::try_from(count)?).read_to_end(bytes);
        taken.map(drop).with_context(|| format!("cannot read {name}"))
    };
    take(NOTHING, &mut bytes)?;
    if bytes.len() == NOTHING && bytes.iter().all(|byte| *byte == 0) {
        bail!("{name} begins with {NOTHING} bytes of 0: expected text");
    }
    take(most - NOTHING + 1, &mut bytes)?;
    if bytes.len() > most {
        bail!(too_long(name, most));
    }
    Ok(bytes)
}

fn too_long(name: &str, most: usize) -> String {
    format!("{name} is longer than {} MiB, the most that is read", most >> 20)
}

#[cfg(test)]
mod tests {
    use std::io::repeat;

    use super::*;

    /// Sources without an end: one of zeros, and one of text.
    #[test]
    fn no_source_takes_more_than_its_kind_may() {
        let refused = |byte: u8, most: usize| taken("it", repeat(byte), most).unwrap_err().to_string();
        assert_eq!(refused(0, MOST_OF_PART), "it begins with 512 bytes of 0: expected text");
        assert_eq!(refused(b'x', MOST_OF_SMALL), "it is longer than 1 MiB, the most that is read");
        assert_eq!(taken("it", &b"ab"[..], MOST_OF_SMALL).unwrap(), b"ab");
        let whole = vec![b'x'; MOST_OF_SMALL];
        assert_eq!(taken("it", &whole[..], MOST_OF_SMALL).unwrap().len(), MOST_OF_SMALL);
    }
}
