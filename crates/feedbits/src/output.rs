//! Where results go: to the terminal, or into a file that appears whole or not at all.

use std::fs;
use std::io::{self, Write};
use std::path::{Path, PathBuf};
use std::sync::atomic::{AtomicBool, Ordering};

use anyhow::{Context, Result};
use clap::Args;

/// Where a result goes.
#[derive(Args)]
pub(crate) struct Output {
    /// Write to this file instead of the terminal.
    #[arg(long, value_name = "PATH")]
    pub(crate) out: Option<PathBuf>,
    /// JSON instead of a table.
    #[arg(long)]
    pub(crate) json: bool,
}

/// Whether nothing but results, warnings and errors is to be printed.
static QUIET: AtomicBool = AtomicBool::new(false);

/// Prints nothing but results, warnings and errors from here on.
pub(crate) fn be_quiet() {
    QUIET.store(true, Ordering::Relaxed);
}

/// Whether nothing but results, warnings and errors is to be printed.
pub(crate) fn is_quiet() -> bool {
    QUIET.load(Ordering::Relaxed)
}

/// Says something beside the result.
pub(crate) fn note(text: &str) {
    if !is_quiet() {
        say(&format!("feedbits: {text}"));
    }
}

/// Writes a line to the error stream. Where that is closed or full, nobody listens, and the exit status says what there is
/// to say.
pub(crate) fn say(line: &str) {
    let _ = writeln!(io::stderr().lock(), "{line}");
}

/// Writes `text` to `path`, or to the terminal if there is none. The file is written under another name beside its
/// place and renamed when complete, so an error leaves what was there before. What a link points to is written; what is
/// no file, as a device or a pipe, takes the text as it comes.
pub(crate) fn write(path: Option<&Path>, text: &str) -> Result<()> {
    let Some(path) = path else {
        return match io::stdout().lock().write_all(text.as_bytes()) {
            Err(error) if error.kind() == io::ErrorKind::BrokenPipe => Ok(()),
            other => other.context("cannot write to the terminal"),
        };
    };
    let cannot = || format!("cannot write {}", path.display());
    let target = fs::canonicalize(path).unwrap_or_else(|_| path.to_path_buf());
    let is_other = fs::metadata(&target).is_ok_and(|found| !found.is_file() && !found.is_dir());
    if is_other {
        let mut device = fs::OpenOptions::new().write(true).open(&target).with_context(cannot)?;
        return device.write_all(text.as_bytes()).with_context(cannot);
    }
    let folder = target.parent().filter(|p| !p.as_os_str().is_empty()).unwrap_or(Path::new("."));
    let mut file = tempfile::NamedTempFile::new_in(folder).with_context(cannot)?;
    file.write_all(text.as_bytes()).with_context(cannot)?;
    file.as_file().sync_all().with_context(cannot)?;
    #[cfg(unix)]
    {
        use std::os::unix::fs::PermissionsExt;
        file.as_file().set_permissions(std::fs::Permissions::from_mode(0o644)).with_context(cannot)?;
    }
    file.persist(&target).with_context(cannot)?;
    Ok(())
}
