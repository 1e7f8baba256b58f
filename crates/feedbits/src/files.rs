//! Reads whole files and pipes, up to the largest size allowed.

use std::fs::File;
use std::io::Read;
use std::path::Path;

use anyhow::{Context, Result, bail};
use part_program::MAX_TEXT;

/// A whole file as text.
pub(crate) fn text(path: &Path) -> Result<String> {
    String::from_utf8(bytes(path)?).map_err(|error| {
        let at = error.utf8_error().valid_up_to();
        anyhow::anyhow!("{}: byte {at} is not UTF-8 text: expected a TOML file", path.display())
    })
}

/// A whole file. A file that is too long is refused before memory is taken for it; a pipe, once it has given too much.
pub(crate) fn bytes(path: &Path) -> Result<Vec<u8>> {
    let name = path.display().to_string();
    let cannot = || format!("cannot read {name}");
    let file = File::open(path).with_context(cannot)?;
    if file.metadata().with_context(cannot)?.len() > u64::try_from(MAX_TEXT)? {
        bail!(too_long(&name));
    }
    taken(&name, file)
}

/// All bytes of a source, unless there are too many.
pub(crate) fn taken(name: &str, source: impl Read) -> Result<Vec<u8>> {
    let mut bytes = Vec::new();
    let most = u64::try_from(MAX_TEXT)? + 1;
    source.take(most).read_to_end(&mut bytes).with_context(|| format!("cannot read {name}"))?;
    if bytes.len() > MAX_TEXT {
        bail!(too_long(name));
    }
    Ok(bytes)
}

fn too_long(name: &str) -> String {
    format!("{name} is longer than {} MiB, the most that is read", MAX_TEXT >> 20)
}
