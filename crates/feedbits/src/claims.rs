//! The files that this call reads and writes. A file that is written has no second role: it is no input, and no other
//! output.
//!
//! A file is known by its device and inode, so another spelling of its name, a link and a hard link are the same file.
//! A file that does not exist yet is known by its folder and name. Where there are no inodes, a file is known by its
//! name after all links; a hard link is another file there.
//!
//! Inputs are claimed as they are opened, and outputs before they are opened, in any order: whichever comes second is
//! refused. Devices and pipes are no files; they may have several roles.

use std::fs::{File, Metadata};
use std::io;
use std::path::{Path, PathBuf};
use std::sync::{Mutex, PoisonError};

use anyhow::{Context, Result, bail};

/// A file, its role, and what a person calls it.
struct Claim {
    file: Identity,
    is_written: bool,
    shown: String,
}

/// What tells a file from all others.
#[derive(PartialEq, Eq)]
enum Identity {
    #[cfg(unix)]
    Inode {
        device: u64,
        inode: u64,
    },
    Name(PathBuf),
}

/// The files of this call so far.
static CLAIMS: Mutex<Vec<Claim>> = Mutex::new(Vec::new());

/// Claims an opened file as an input. `option` is what names it on the command line.
///
/// # Errors
/// If this call writes it.
pub(crate) fn read(option: &str, path: &Path, file: &File) -> Result<()> {
    let found = file.metadata().with_context(|| format!("cannot read {}", path.display()))?;
    claim(identity(&found, path), false, shown(option, path))
}

/// Claims the standard input as an input.
///
/// # Errors
/// If it is a file that this call writes.
pub(crate) fn read_standard_input() -> Result<()> {
    claim(of_stream(&io::stdin()), false, "the standard input".into())
}

/// Claims the standard output as an output.
///
/// # Errors
/// If it is a file that has another role in this call.
pub(crate) fn write_standard_output() -> Result<()> {
    claim(of_stream(&io::stdout()), true, "the standard output".into())
}

/// Claims the file at `path` as an output. `found` is what is there now, and `target` where the links of `path` lead.
///
/// # Errors
/// If it has another role in this call.
pub(crate) fn write(option: &str, path: &Path, target: &Path, found: Option<&Metadata>) -> Result<()> {
    let file = found.map_or_else(|| Some(Identity::Name(target.into())), |found| identity(found, target));
    claim(file, true, shown(option, path))
}

/// Refuses a folder that is to be made where this call writes a file that is not there yet. `target` is where the links of
/// `folder` lead.
///
/// # Errors
/// If a file of that name was claimed as an output.
pub(crate) fn make_folder(option: &str, folder: &Path, target: &Path) -> Result<()> {
    let claims = CLAIMS.lock().unwrap_or_else(PoisonError::into_inner);
    let file = Identity::Name(target.into());
    match claims.iter().find(|known| known.file == file) {
        Some(known) => {
            bail!(
                "the folder {} is also {}: expected a name of its own for each",
                shown(option, folder),
                known.shown
            )
        }
        None => Ok(()),
    }
}

fn shown(option: &str, path: &Path) -> String {
    format!("{option} {}", path.display())
}

/// The same output may be claimed again by the same words.
fn claim(file: Option<Identity>, is_written: bool, shown: String) -> Result<()> {
    let Some(file) = file else { return Ok(()) };
    let mut claims = CLAIMS.lock().unwrap_or_else(PoisonError::into_inner);
    let new = Claim { file, is_written, shown };
    let same = |known: &&Claim| known.file == new.file;
    if claims.iter().filter(same).any(|known| known.is_written == is_written && known.shown == new.shown) {
        return Ok(());
    }
    if let Some(known) = claims.iter().filter(same).find(|known| known.is_written || is_written) {
        let (written, other) = if is_written { (&new, known) } else { (known, &new) };
        let expected = if other.is_written {
            "expected a file of its own for each"
        } else {
            "expected another file to write, so that no input is lost"
        };
        bail!("{} is the same file as {}: {expected}", written.shown, other.shown);
    }
    claims.push(new);
    Ok(())
}

#[cfg(unix)]
fn identity(found: &Metadata, _path: &Path) -> Option<Identity> {
    use std::os::unix::fs::MetadataExt;
    found.is_file().then(|| Identity::Inode { device: found.dev(), inode: found.ino() })
}

#[cfg(not(unix))]
fn identity(found: &Metadata, path: &Path) -> Option<Identity> {
    std::fs::canonicalize(path).ok().filter(|_| found.is_file()).map(Identity::Name)
}

/// The file to which a shell has led a stream.
#[cfg(unix)]
fn of_stream(stream: &impl std::os::fd::AsFd) -> Option<Identity> {
    let file = File::from(stream.as_fd().try_clone_to_owned().ok()?);
    identity(&file.metadata().ok()?, Path::new(""))
}

#[cfg(not(unix))]
fn of_stream<S>(_stream: &S) -> Option<Identity> {
    None
}
