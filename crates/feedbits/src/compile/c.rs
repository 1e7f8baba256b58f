//! A part as a header and a source in C99.

use std::path::Path;

use anyhow::{Context, Result, bail};
use c_code::CName;
use format_compare::{CRequest, Dimension, Format, Space};

use super::judged::{Judged, expect_room};
use crate::output;
use crate::places::{Place, write_together};
use crate::progress::Progress;

/// The two files, and the begin of the public names in them.
pub(crate) struct CPlace {
    name: CName,
    header: Place,
    source: Place,
}

impl CPlace {
    /// The files at `out`, which names them without an ending.
    pub(crate) fn of(out: Option<&Path>) -> Result<Self> {
        let Some(out) = out else {
            bail!("--language c writes two files: give --out PATH, for PATH.h and PATH.c");
        };
        let name = out.file_name().unwrap_or_default().to_string_lossy();
        if let Some(stem) = name.strip_suffix(".c").or_else(|| name.strip_suffix(".h")) {
            bail!("--out {name}: expected a name without an ending, as `{stem}`, for {stem}.h and {stem}.c");
        }
        let name = CName::try_new(&name).context("--out")?;
        let place = |extension| Place::named("--out", Some(&out.with_extension(extension)));
        Ok(Self { name, header: place("h")?, source: place("c")? })
    }
}

/// Refuses a format that C has no type for.
pub(crate) fn expect_type<const D: usize>(format: &dyn Format<D>) -> Result<()> {
    Ok(c_code::expect_type(format.name())?)
}

/// Writes the part.
pub(crate) fn write<const D: usize>(
    judged: &Judged<'_, D>,
    place: &CPlace,
    flash: Option<usize>,
    progress: Progress,
) -> Result<()>
where
    Space: Dimension<D>,
{
    let Judged { problem, plan, options, format, about, fault } = judged;
    let CPlace { name, header, source } = place;
    let request =
        CRequest { name: name.clone(), about: about.clone(), fault: fault.clone(), is_description: false };
    let files = format.c_files(problem, plan, options, &request)?;
    expect_room(files.table_bytes, flash)?;
    progress.finish();
    write_together(&[(header, &files.header), (source, &files.source)])?;
    let (bytes, run) = (files.table_bytes, files.run);
    let [header, source] = [header, source].map(|place| place.path().unwrap_or(Path::new("")).display());
    output::note(&format!(
        "{header} and {source}: {} periods; {bytes} bytes of tables; checksum {:#018x}",
        run.periods, run.checksum
    ));
    Ok(())
}
