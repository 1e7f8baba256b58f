//! Places of results: the terminal, or files that appear whole or not at all.

use std::collections::BTreeMap;
use std::fs::{self, File};
use std::io::{self, Write};
use std::path::{Path, PathBuf};

use crate::claims;
use crate::unfinished::{self, Listed, Stage};
use anyhow::{Context, Result, bail};

/// The terminal, or a file that has no other role in this call.
pub(crate) struct Place(Option<PathBuf>);

impl Place {
    /// The file that an option names; the terminal if it names none.
    ///
    /// # Errors
    /// Before any work, refuses a place where nothing can be written: a folder, or a file in a folder that does not
    /// exist or takes no new files. Refuses a file that this call reads, or writes for another option.
    pub(crate) fn named(option: &str, path: Option<&Path>) -> Result<Self> {
        let Some(path) = path else {
            claims::write_standard_output()?;
            return Ok(Self(None));
        };
        let place = Self::claimed(option, path)?;
        if fs::metadata(path).map_or(true, |found| found.is_file()) {
            let writable = target_of(path).and_then(|target| expect_writable(folder_of(&target)));
            writable.with_context(|| cannot_write(path))?;
        }
        Ok(place)
    }

    /// The terminal, for a command that also writes a file.
    ///
    /// # Errors
    /// If the standard output is a file that has another role in this call.
    pub(crate) fn terminal() -> Result<Self> {
        Self::named("", None)
    }

    fn claimed(option: &str, path: &Path) -> Result<Self> {
        if path
            .as_os_str()
            .as_encoded_bytes()
            .last()
            .is_some_and(|last| std::path::is_separator(char::from(*last)))
        {
            bail!("{}: a name that ends in a slash is that of a folder", cannot_write(path));
        }
        let found = before(path)?;
        let target = target_of(path).with_context(|| cannot_write(path))?;
        claims::write(option, path, &target, found.as_ref())?;
        Ok(Self(Some(path.to_path_buf())))
    }

    /// The path of the file; `None` for the terminal.
    pub(crate) fn path(&self) -> Option<&Path> {
        self.0.as_deref()
    }
}

/// A folder of files that belong together.
pub(crate) struct Folder {
    option: &'static str,
    path: PathBuf,
    /// The folders that were made for it, the outermost first.
    made: Vec<Listed>,
}

impl Folder {
    /// The folder that an option names, which is made if it does not exist. If nothing is written into it in the end,
    /// the folders that were made for it are removed.
    ///
    /// # Errors
    /// If the folder cannot be made, takes no new files, or is to be a file of this call.
    pub(crate) fn named(option: &'static str, path: &Path) -> Result<Self> {
        let is_missing =
            |folder: &&Path| !folder.as_os_str().is_empty() && fs::symlink_metadata(folder).is_err();
        let missing: Vec<_> = path.ancestors().take_while(is_missing).collect();
        for folder in &missing {
            target_of(folder).map_or(Ok(()), |target| claims::make_folder(option, folder, &target))?;
        }
        let made = missing.into_iter().rev().map(|folder| Listed::folder(folder.to_path_buf())).collect();
        let folder = Self { option, path: path.to_path_buf(), made };
        fs::create_dir_all(path).with_context(|| format!("cannot make the folder {}", path.display()))?;
        expect_writable(path).with_context(|| format!("cannot write into the folder {}", path.display()))?;
        Ok(folder)
    }

    pub(crate) fn path(&self) -> &Path {
        &self.path
    }

    /// The place of a file in the folder.
    ///
    /// # Errors
    /// If a folder is there, or a file that has another role in this call.
    pub(crate) fn place(&self, name: &str) -> Result<Place> {
        Place::claimed(self.option, &self.path.join(name))
    }

    /// Writes files by their names, as [`write_together()`] does, and leaves all others as they are. Before, removes what
    /// interrupted runs have left of unfinished files.
    pub(crate) fn write(&self, files: &[(&str, &str)]) -> Result<()> {
        unfinished::clear(&self.path);
        let places = files.iter().map(|(name, text)| Ok((self.place(name)?, *text)));
        let places: Vec<(Place, &str)> = places.collect::<Result<_>>()?;
        write_together(&places.iter().map(|(place, text)| (place, *text)).collect::<Vec<_>>())
    }
}

impl Drop for Folder {
    fn drop(&mut self) {
        for folder in self.made.iter().rev() {
            // A folder that holds something stays.
            let _ = fs::remove_dir(folder.path());
        }
    }
}

/// The begin of the message that a file cannot be written.
fn cannot_write(path: &Path) -> String {
    format!("cannot write {}", path.display())
}

/// The begin of the message that a result cannot be written.
pub(crate) fn cannot_write_to(place: &Place) -> String {
    place.path().map_or_else(|| "cannot write to the terminal".into(), cannot_write)
}

/// Has `fill` write the file at `path`. The file is written under another name beside its place and renamed when it is
/// complete, so an error leaves the old file unchanged. If `path` is a link, its target is written, whether the target
/// exists or not. If it is not a regular file, as a device or a pipe, the bytes go to it directly. The errors of `fill`
/// are its own.
pub(crate) fn write_file<T>(path: &Path, fill: impl FnOnce(&mut File) -> Result<T>) -> Result<T> {
    let cannot = || cannot_write(path);
    let before = before(path)?;
    if before.as_ref().is_some_and(|found| !found.is_file()) {
        let device = fs::OpenOptions::new().write(true).open(path);
        return fill(&mut device.with_context(cannot)?);
    }
    let target = target_of(path).with_context(cannot)?;
    let (_listed, mut file) = unfinished::file_in(folder_of(&target)).with_context(cannot)?;
    let filled = filled(file.as_file_mut(), path, before.as_ref(), fill)?;
    file.persist(&target).map_err(|failure| failure.error).with_context(cannot)?;
    Ok(filled)
}

/// Writes files that belong together, in this order.
///
/// All of them are written whole, and on the disk, under other names before the first takes its place. So where one
/// cannot be written, as on a full disk, all places are as they were. Then one after the other is renamed to its place. A
/// file system renames files one by one: if the run is killed between the first rename and the last, the files up to
/// there are new and the others old, each of them whole. Links are followed. Devices and pipes are refused.
pub(crate) fn write_together(files: &[(&Place, &str)]) -> Result<()> {
    let mut stages: BTreeMap<PathBuf, Stage> = BTreeMap::new();
    let mut renames = Vec::with_capacity(files.len());
    for (index, (place, text)) in files.iter().enumerate() {
        let Some(path) = place.path() else { bail!("cannot write several files to the terminal") };
        let cannot = || cannot_write(path);
        let before = before(path)?;
        if before.as_ref().is_some_and(|found| !found.is_file()) {
            bail!("{}: it is no file", cannot());
        }
        let target = target_of(path).with_context(cannot)?;
        let folder = folder_of(&target).to_path_buf();
        if !stages.contains_key(&folder) {
            let stage = Stage::in_folder(&folder).with_context(cannot)?;
            stages.insert(folder.clone(), stage);
        }
        let Some(stage) = stages.get(&folder) else { bail!(cannot()) };
        let waiting = stage.path().join(index.to_string());
        let mut file = File::create_new(&waiting).with_context(cannot)?;
        filled(&mut file, path, before.as_ref(), |file| {
            file.write_all(text.as_bytes()).with_context(cannot)
        })?;
        renames.push((waiting, target, path));
    }
    for (waiting, target, path) in renames {
        fs::rename(waiting, target).with_context(|| cannot_write(path))?;
    }
    Ok(())
}

/// Fills a new file that is to be at `path`, where `before` is now, and waits until it is on the disk.
fn filled<T>(
    file: &mut File,
    path: &Path,
    before: Option<&fs::Metadata>,
    fill: impl FnOnce(&mut File) -> Result<T>,
) -> Result<T> {
    if let Some(found) = before {
        // Before the text is in it: what was private is so all the while.
        file.set_permissions(found.permissions()).with_context(|| cannot_write(path))?;
    }
    let filled = fill(file)?;
    file.sync_all().with_context(|| cannot_write(path))?;
    Ok(filled)
}

/// The metadata of the file that is at `path` now; `None` if there is none. A folder there is an error.
fn before(path: &Path) -> Result<Option<fs::Metadata>> {
    let cannot = || cannot_write(path);
    match fs::metadata(path) {
        Ok(found) if found.is_dir() => bail!("{}: it is a folder", cannot()),
        Ok(found) => Ok(Some(found)),
        Err(error) if error.kind() == io::ErrorKind::NotFound => Ok(None),
        Err(error) => Err(error).with_context(cannot),
    }
}

/// Where the links of a path lead, as a name without links. If no file is there, its folder exists.
fn target_of(path: &Path) -> io::Result<PathBuf> {
    if let Ok(target) = fs::canonicalize(path) {
        return Ok(target);
    }
    let mut target = path.to_path_buf();
    while let Ok(next) = fs::read_link(&target) {
        target = target.parent().map_or_else(|| next.clone(), |folder| folder.join(&next));
    }
    let name = target.file_name().ok_or(io::ErrorKind::NotFound)?;
    Ok(fs::canonicalize(folder_of(&target))?.join(name))
}

/// An error if a folder takes no new files.
fn expect_writable(folder: &Path) -> io::Result<()> {
    tempfile::tempfile_in(folder).map(|_| ())
}

/// The folder that holds a file.
fn folder_of(path: &Path) -> &Path {
    path.parent().filter(|folder| !folder.as_os_str().is_empty()).unwrap_or(Path::new("."))
}
