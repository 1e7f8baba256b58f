//! The parts of a call: files, folders and lists of them.

use std::collections::HashSet;
use std::fs;
use std::path::{Path, PathBuf};

use anyhow::{Context, Result, bail};
use clap::Args;

use crate::claims;
use crate::files::{self, MOST_OF_SMALL};
use crate::input::{Input, Reading};
use crate::output;
use crate::places::{Folder, Place};
use crate::shard::Shard;

/// Parts of a set, at most.
const MOST_PARTS: usize = 100_000;

/// The endings of names by which a file of a folder is a part. A curve file, whose ending is that of machine files too, is known by its
/// tables.
const ENDINGS: [&str; 16] = [
    "nc", "ngc", "gcode", "gco", "g", "tap", "cnc", "gc", "mpf", "spf", "ptp", "eia", "iso", "min", "dxf",
    "canon",
];

/// The parts of a call, and the options that several of them have.
#[derive(Args)]
pub(crate) struct Parts {
    /// Parts: each a curve file (TOML), a part program, what LinuxCNC's rs274 prints of one, a drawing (DXF) or geomdl's JSON, told by
    /// its content, of at most 64 MiB; a folder, of which every file is taken that is a part by its ending or is a curve file, also in
    /// its folders; or @LIST, a file with a part or a folder in each line. `-` alone is the standard input. Default: the built-in
    /// example.
    #[arg(value_name = "PART")]
    parts: Vec<PathBuf>,
    #[command(flatten)]
    reading: Reading,
    /// Of several parts: end as if the parts that cannot be read or run were not there. Without this the status is 4.
    #[arg(long)]
    skip_refused: bool,
    /// Of several parts: keep each part's result in this folder, and take from there what has not changed: the part, the machine, the
    /// targets, the options and the version.
    #[arg(long, value_name = "DIR")]
    cache: Option<PathBuf>,
    /// Of several parts: the file of finished parts, a line of JSON a part. What it has is not run again. Default with --shard: that of
    /// the shard, as in compare-2-of-8.jsonl.
    #[arg(long, value_name = "PATH")]
    resume: Option<PathBuf>,
    /// Of several parts: run only those of shard i of n, as in 1/4; the first is 1. `feedbits merge` joins the files, and the same call
    /// with the joined file and without --shard has the answer.
    #[arg(long, value_name = "I/N")]
    shard: Option<Shard>,
}

/// A part of a set.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(crate) struct PartFile {
    pub(crate) path: PathBuf,
    /// The name by which its result knows it.
    pub(crate) name: String,
}

/// What a call says of its parts.
pub(crate) enum Given<'a> {
    /// One part, or none.
    One(Input),
    /// A set of parts.
    Set(&'a Parts),
}

impl Parts {
    /// One part, or a set: several, a folder, a list, or one with an option that sets have.
    pub(crate) fn given(&self) -> Given<'_> {
        let has_options =
            self.skip_refused || self.cache.is_some() || self.resume.is_some() || self.shard.is_some();
        match &self.parts[..] {
            [] if !has_options => Given::One(Input::new(None, &self.reading)),
            [one] if !has_options && list(one).is_none() && !one.is_dir() => {
                Given::One(Input::new(Some(one), &self.reading))
            }
            _ => Given::Set(self),
        }
    }

    pub(crate) fn reading(&self) -> &Reading {
        &self.reading
    }

    /// Whether parts that are refused change no status.
    pub(crate) fn skips_refused(&self) -> bool {
        self.skip_refused
    }

    /// The shard that is run.
    pub(crate) fn shard(&self) -> Option<Shard> {
        self.shard
    }

    /// The folder of results that are kept.
    pub(crate) fn cache(&self) -> Result<Option<Folder>> {
        self.cache.as_deref().map(|folder| Folder::named("--cache", folder)).transpose()
    }

    /// The file of finished parts of `command`, if there is to be one.
    pub(crate) fn resumed(&self, command: &str) -> Result<Option<Place>> {
        let by_default = self.shard.map(|shard| shard.file(command));
        let path = self.resume.clone().or(by_default);
        path.map(|path| Place::named("--resume", Some(&path))).transpose()
    }

    /// The files of the set in the order of the call, those of a folder in the order of their names. A file that is named twice is taken
    /// once. A note says what of the folders is left out.
    ///
    /// # Errors
    /// If a folder or a list cannot be read, or this call writes one of the files.
    pub(crate) fn files(&self) -> Result<Vec<PartFile>> {
        let mut found = Found::default();
        for part in &self.parts {
            match list(part) {
                Some(list) => found.add_list(Path::new(list))?,
                None => found.add(part)?,
            }
        }
        found.say_left_out();
        if found.parts.is_empty() {
            bail!("no part is given: expected files, folders that hold some, or @LIST");
        }
        found.parts.iter().try_for_each(|part| expect_only_read(&part.path))?;
        Ok(found.parts)
    }
}

/// Refuses a part that this call writes: as one of many it would count as a part that cannot be read, and be lost. A part that cannot be
/// opened is counted later.
fn expect_only_read(part: &Path) -> Result<()> {
    fs::File::open(part).map_or(Ok(()), |file| claims::read("the part", part, &file))
}

/// The file of a list, if a word names one: a file whose own name begins with `@` is a part.
fn list(word: &Path) -> Option<&str> {
    word.to_str()?.strip_prefix('@').filter(|_| !word.exists())
}

/// The parts so far.
#[derive(Default)]
struct Found {
    parts: Vec<PartFile>,
    known: HashSet<PathBuf>,
    left_out: Vec<PathBuf>,
}

impl Found {
    /// Adds what the lines of a list name, relative to the folder of the call.
    fn add_list(&mut self, list: &Path) -> Result<()> {
        let text = files::text("the list", list, MOST_OF_SMALL)?;
        for line in text.lines().map(str::trim).filter(|line| !line.is_empty() && !line.starts_with('#')) {
            if line.starts_with('@') {
                bail!(
                    "{}: {line}: expected a part or a folder in each line, not another list",
                    list.display()
                );
            }
            self.add(Path::new(line)).with_context(|| list.display().to_string())?;
        }
        Ok(())
    }

    /// Adds a file, or the parts of a folder.
    fn add(&mut self, path: &Path) -> Result<()> {
        if path == Path::new("-") {
            bail!(
                "-: the standard input is read as a single part: expected files and folders beside other parts"
            );
        }
        if path.is_dir() { self.add_folder(path) } else { self.add_file(path) }
    }

    fn add_file(&mut self, path: &Path) -> Result<()> {
        if fs::metadata(path).is_ok_and(|found| !found.is_file()) {
            bail!(
                "{}: a part of a set is read more than once: expected a file, not a pipe or a device",
                path.display()
            );
        }
        let same = fs::canonicalize(path).unwrap_or_else(|_| path.to_path_buf());
        if !self.known.insert(same) {
            return Ok(());
        }
        if self.parts.len() == MOST_PARTS {
            bail!(
                "more than {MOST_PARTS} parts: expected fewer, as by several calls with a --resume file each"
            );
        }
        self.parts.push(PartFile { path: path.to_path_buf(), name: path.display().to_string() });
        Ok(())
    }

    /// Adds the parts of a folder and of its folders. Links to folders are not followed, so there is no circle.
    fn add_folder(&mut self, folder: &Path) -> Result<()> {
        let cannot = || format!("cannot read the folder {}", folder.display());
        let entries = fs::read_dir(folder).with_context(cannot)?.collect::<Result<Vec<_>, _>>();
        let mut entries = entries.with_context(cannot)?;
        entries.sort_by_key(fs::DirEntry::file_name);
        for entry in entries {
            let path = entry.path();
            if entry.file_type().with_context(cannot)?.is_dir() {
                self.add_folder(&path)?;
            } else if is_part(&path) {
                self.add_file(&path)?;
            } else {
                self.left_out.push(path);
            }
        }
        Ok(())
    }

    fn say_left_out(&self) {
        const SHOWN: usize = 5;
        let Some(count) = Some(self.left_out.len()).filter(|count| *count > 0) else { return };
        let shown: Vec<_> = self.left_out.iter().take(SHOWN).map(|path| path.display().to_string()).collect();
        let more = if count > SHOWN { format!(" and {} more", count - SHOWN) } else { String::new() };
        output::note(&format!(
            "{} of the folders left out, no parts by their endings: {}{more}; name a file to have it read",
            output::counted(count, "file is", "files are"),
            shown.join(", ")
        ));
    }
}

/// Whether a file of a folder is a part.
fn is_part(path: &Path) -> bool {
    let ending = path.extension().map(|ending| ending.to_string_lossy().to_lowercase()).unwrap_or_default();
    if ending != "toml" {
        return ENDINGS.contains(&ending.as_str());
    }
    let is_curve =
        |line: &str| line.trim_start_matches(['[', ' ']).starts_with("curve") && line.starts_with('[');
    fs::metadata(path).is_ok_and(|found| found.is_file())
        && files::text("the part", path, files::MOST_OF_PART).is_ok_and(|text| text.lines().any(is_curve))
}
