//! Files and folders until they are whole. They have names of their own, a run that fails removes its own, and so does a
//! signal that ends the program.

use std::fs::{self, File};
use std::io;
use std::path::{Path, PathBuf};
use std::sync::{Mutex, MutexGuard, PoisonError};

use tempfile::{NamedTempFile, TempDir};

/// The begin and end of the name of a file, or of a folder of files, until they are whole; [`BY_CHANCE`] characters stand
/// between.
const NAME: [&str; 2] = [".feedbits-", ".part"];

/// How many characters of a name are drawn by chance.
const BY_CHANCE: usize = 6;

/// The file in a folder of unfinished files whose lock tells that the folder is no leftover.
const LOCK: &str = "lock";

/// What a signal removes, in the order in which it was made. While it is locked, nothing is made.
static LISTED: Mutex<Vec<PathBuf>> = Mutex::new(Vec::new());

/// A path that a signal removes as long as this exists: an unfinished file or folder whole, another folder if it is empty.
pub(crate) struct Listed(PathBuf);

impl Listed {
    /// Lists a folder that is about to be made.
    pub(crate) fn folder(path: PathBuf) -> Self {
        locked().push(path.clone());
        Self(path)
    }

    pub(crate) fn path(&self) -> &Path {
        &self.0
    }

    /// Makes something unfinished and lists it, so that no signal comes between.
    fn made<T>(
        make: impl FnOnce() -> io::Result<T>,
        path: impl FnOnce(&T) -> &Path,
    ) -> io::Result<(Self, T)> {
        let mut list = locked();
        let made = make()?;
        let path = path(&made).to_path_buf();
        list.push(path.clone());
        Ok((Self(path), made))
    }
}

impl Drop for Listed {
    fn drop(&mut self) {
        locked().retain(|path| *path != self.0);
    }
}

fn locked() -> MutexGuard<'static, Vec<PathBuf>> {
    LISTED.lock().unwrap_or_else(PoisonError::into_inner)
}

/// Removes everything unfinished, the newest first. Until the answer is dropped, nothing new is made, and what has to wait
/// for that cannot say that its file is gone.
pub(crate) fn remove_all() -> impl Drop {
    /// Between two tries a run may have made another file in a folder, of those that its result has.
    const MOST_TRIES: usize = 100;
    let list = locked();
    for path in list.iter().rev() {
        if is_ours(path) {
            let is_gone =
                || fs::remove_file(path).or_else(|_| fs::remove_dir_all(path)).is_ok() || !path.exists();
            let _ = (0..MOST_TRIES).any(|_| is_gone());
        } else {
            // A folder that holds something stays.
            let _ = fs::remove_dir(path);
        }
    }
    list
}

/// A new file in a folder. Until it is closed, its lock tells that it is no leftover.
pub(crate) fn file_in(folder: &Path) -> io::Result<(Listed, NamedTempFile)> {
    let made = Listed::made(|| names().make_in(folder, |path| File::create_new(path)), NamedTempFile::path)?;
    // Where there are no locks, no other run removes the file either.
    let _ = made.1.as_file().try_lock();
    Ok(made)
}

/// A folder in the folder of files that belong together. They wait in it until all of them are whole.
pub(crate) struct Stage {
    /// Closed before the folder is removed.
    _lock: File,
    folder: TempDir,
    _listed: Listed,
}

impl Stage {
    pub(crate) fn in_folder(folder: &Path) -> io::Result<Self> {
        let (listed, folder) = Listed::made(|| names().tempdir_in(folder), TempDir::path)?;
        let lock = File::create_new(folder.path().join(LOCK))?;
        // Where there are no locks, no other run removes the folder either.
        let _ = lock.try_lock();
        Ok(Self { _lock: lock, folder, _listed: listed })
    }

    pub(crate) fn path(&self) -> &Path {
        self.folder.path()
    }
}

/// Removes what interrupted runs have left in a folder, but nothing that another run still writes.
pub(crate) fn clear(folder: &Path) {
    for entry in fs::read_dir(folder).into_iter().flatten().flatten() {
        let Ok(kind) = entry.file_type() else { continue };
        let is_left = |path: &Path| File::open(path).is_ok_and(|file| file.try_lock().is_ok());
        let (path, lock) = (entry.path(), entry.path().join(LOCK));
        let is_ours = is_ours(&path);
        if is_ours && kind.is_file() && is_left(&path) {
            let _ = fs::remove_file(path);
        } else if is_ours && kind.is_dir() && (is_left(&lock) || !lock.exists()) {
            let _ = fs::remove_dir_all(path);
        }
    }
}

/// Whether a path has the name of something unfinished.
fn is_ours(path: &Path) -> bool {
    let name = path.file_name().map(|name| name.to_string_lossy());
    let middle = name.as_deref().and_then(|name| name.strip_prefix(NAME[0])?.strip_suffix(NAME[1]));
    middle.is_some_and(|by_chance| by_chance.len() == BY_CHANCE)
}

fn names() -> tempfile::Builder<'static, 'static> {
    let mut names = tempfile::Builder::new();
    names.prefix(NAME[0]).suffix(NAME[1]).rand_bytes(BY_CHANCE);
    names
}
