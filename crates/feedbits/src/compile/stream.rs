//! A part as a file of sections, which a controller reads through a small buffer.

use std::io::{BufWriter, Write};
use std::path::{Path, PathBuf};

use anyhow::{Context, Result, bail};
use format_compare::{StreamFailure, StreamRequest};

use super::judged::Judged;
use crate::output;
use crate::places::{self, Place};
use crate::progress::Progress;

/// The file, and the buffer of its reader.
pub(crate) struct StreamPlace {
    file: PathBuf,
    /// Bytes of the buffer, if they are known.
    buffer: Option<usize>,
}

impl StreamPlace {
    /// The file at `out`.
    pub(crate) fn of(out: Option<&Path>, buffer: Option<usize>) -> Result<Self> {
        let Some(out) = out else { bail!("--stream writes a file: give --out PATH") };
        Place::named("--out", Some(out))?;
        Ok(Self { file: out.to_path_buf(), buffer })
    }
}

/// Writes the part.
pub(crate) fn write<const D: usize>(
    judged: &Judged<'_, D>,
    place: &StreamPlace,
    progress: Progress,
) -> Result<()> {
    let Judged { problem, plan, options, format, .. } = judged;
    let StreamPlace { file: path, buffer } = place;
    let cannot = || format!("cannot write {}", path.display());
    let header = places::write_file(path, |file| {
        let mut to = BufWriter::new(file);
        let mut request = StreamRequest { buffer: *buffer, to: &mut to };
        let header = match format.stream(problem, plan, options, &mut request) {
            Err(StreamFailure::Write(error)) => return Err(error).with_context(cannot),
            other => other?,
        };
        to.flush().with_context(cannot)?;
        Ok(header)
    })?;
    progress.finish();
    let counted =
        |count: u32, one, more| output::counted(usize::try_from(count).unwrap_or(usize::MAX), one, more);
    let sections = counted(header.sections, "section", "sections");
    let pieces = counted(header.largest_pieces, "piece", "pieces");
    let stages = counted(header.largest_stages, "stage", "stages");
    output::note(&format!(
        "{}: {} periods in {sections}, {} bytes; it takes a buffer of {} bytes and room for {pieces} and {stages}; checksum \
         {:#018x}",
        path.display(),
        header.periods,
        header.file_bytes,
        header.largest_bytes,
        header.checksum
    ));
    Ok(())
}
