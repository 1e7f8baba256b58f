//! The destination of results: the terminal, or a file that appears whole or not at all.

use std::fs;
use std::io::{self, Write};
use std::path::{Path, PathBuf};
use std::process::ExitCode;
use std::sync::atomic::{AtomicBool, Ordering};

use anyhow::{Context, Result, bail};
use clap::Args;
use foreign_text::in_lines;

use crate::screen;

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

/// Whether only results, warnings and errors are printed.
static QUIET: AtomicBool = AtomicBool::new(false);

/// From now on prints only results, warnings and errors.
pub(crate) fn be_quiet() {
    QUIET.store(true, Ordering::Relaxed);
}

/// Whether only results, warnings and errors are printed.
pub(crate) fn is_quiet() -> bool {
    QUIET.load(Ordering::Relaxed)
}

/// Prints a note beside the result.
pub(crate) fn note(text: &str) {
    if !is_quiet() {
        say(&format!("feedbits: {text}"));
    }
}

/// `did you mean …? ` if a known word is near to `word`, otherwise an empty text.
pub(crate) fn did_you_mean(word: &str, known: &[&str]) -> String {
    part_program::nearest(word, known).map_or_else(String::new, |meant| format!("did you mean `{meant}`? "))
}

/// A number with its noun: the one for a single thing, or the one for several.
pub(crate) fn counted(count: usize, one: &str, others: &str) -> String {
    format!("{count} {}", if count == 1 { one } else { others })
}

/// Writes a line to the error stream, folded to the screen. Names and input that it quotes may hold what a terminal acts on; that
/// becomes a `?`. If that stream is closed or full the line is lost, and only the exit status tells the result.
pub(crate) fn say(line: &str) {
    let _ = writeln!(io::stderr().lock(), "{}", screen::message(&in_lines(line)));
}

/// Prints the error in the command line, or the help that the command line asks for. Returns the exit status.
pub(crate) fn usage(error: &clap::Error) -> ExitCode {
    if error.use_stderr() {
        let text = screen::message(&error.render().ansi().to_string());
        let _ = anstream::stderr().lock().write_all(text.as_bytes());
    } else {
        let _ = error.print();
    }
    ExitCode::from(u8::try_from(error.exit_code()).unwrap_or(2))
}

/// The begin of the message that a file cannot be written.
fn cannot_write(path: &Path) -> String {
    format!("cannot write {}", path.display())
}

/// The same for a file, or for the terminal if there is no path.
pub(crate) fn cannot_write_to(path: Option<&Path>) -> String {
    path.map_or_else(|| "cannot write to the terminal".into(), cannot_write)
}

/// The begin and end of a file's name until the file is whole; six random characters stand between.
const UNFINISHED: [&str; 2] = [".feedbits-", ".part"];

/// Writes `text` to `path`, or to the terminal if there is no path. The file is written under another name beside its
/// place and renamed when it is complete, so an error leaves the old file unchanged. If `path` is a link, its target is
/// written, whether the target exists or not. If it is not a regular file, as a device or a pipe, the text goes to it
/// directly. Styles are shown on a terminal that has them, unless the environment says NO_COLOR, and are left out
/// elsewhere.
pub(crate) fn write(path: Option<&Path>, text: &str) -> Result<()> {
    // Whatever takes styles out takes other characters out too, which JSON may hold.
    let has_styles = text.contains('\u{1b}');
    let Some(path) = path else {
        let written = if has_styles {
            anstream::stdout().lock().write_all(text.as_bytes())
        } else {
            io::stdout().lock().write_all(text.as_bytes())
        };
        return match written {
            Err(error) if error.kind() == io::ErrorKind::BrokenPipe => Ok(()),
            other => other.context("cannot write to the terminal"),
        };
    };
    let text = if has_styles { anstream::adapter::strip_str(text).to_string() } else { text.to_string() };
    write_file(path, |file| file.write_all(text.as_bytes()).with_context(|| cannot_write(path)))
}

/// As [`write()`], for a text without styles that `by` writes bit by bit. If `by` fails, no file appears.
pub(crate) fn write_by<T>(
    path: Option<&Path>,
    by: impl FnOnce(&mut (dyn Write + Send)) -> Result<T>,
) -> Result<T> {
    let Some(path) = path else {
        let mut terminal = Terminal(io::BufWriter::new(io::stdout()));
        let result = by(&mut terminal)?;
        terminal.flush().context("cannot write to the terminal")?;
        return Ok(result);
    };
    write_file(path, |file| {
        let mut buffer = io::BufWriter::new(file);
        let result = by(&mut buffer)?;
        buffer.flush().with_context(|| cannot_write(path))?;
        Ok(result)
    })
}

/// The terminal, or a pipe: what a reader that has gone away does not take is lost.
struct Terminal<W: Write>(io::BufWriter<W>);

impl<W: Write> Write for Terminal<W> {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        match self.0.write(bytes) {
            Err(error) if error.kind() == io::ErrorKind::BrokenPipe => Ok(bytes.len()),
            other => other,
        }
    }

    fn flush(&mut self) -> io::Result<()> {
        match self.0.flush() {
            Err(error) if error.kind() == io::ErrorKind::BrokenPipe => Ok(()),
            other => other,
        }
    }
}

/// Has `fill` write the file at `path`, which appears whole or not at all, as from [`write()`]. Bytes are written as they are, and the
/// errors of `fill` are its own.
pub(crate) fn write_file<T>(path: &Path, fill: impl FnOnce(&mut fs::File) -> Result<T>) -> Result<T> {
    let before = before(path)?;
    if before.as_ref().is_some_and(|found| !found.is_file()) {
        let device = fs::OpenOptions::new().write(true).open(path);
        return fill(&mut device.with_context(|| cannot_write(path))?);
    }
    let (file, target, filled) = unfinished(path, before, fill)?;
    file.persist(&target).map_err(|failure| failure.error).with_context(|| cannot_write(path))?;
    Ok(filled)
}

/// Writes several files that belong together: all of them appear, whole, or none.
pub(crate) fn write_together(files: &[(&Path, &str)]) -> Result<()> {
    let mut written = Vec::with_capacity(files.len());
    for (path, text) in files {
        let before = before(path)?;
        if before.as_ref().is_some_and(|found| !found.is_file()) {
            bail!("{}: it is no file", cannot_write(path));
        }
        let fill = |file: &mut fs::File| file.write_all(text.as_bytes()).with_context(|| cannot_write(path));
        written.push((*path, unfinished(path, before, fill)?));
    }
    for (path, (file, target, ())) in written {
        let persisted = file.persist(&target).map_err(|failure| failure.error);
        persisted.with_context(|| cannot_write(path))?;
    }
    Ok(())
}

/// What `fill` writes, in a file of another name beside its place, which is returned too. `before` is what is at the place
/// now.
fn unfinished<T>(
    path: &Path,
    before: Option<fs::Metadata>,
    fill: impl FnOnce(&mut fs::File) -> Result<T>,
) -> Result<(tempfile::NamedTempFile, PathBuf, T)> {
    let cannot = || cannot_write(path);
    let target = match before {
        Some(_) => fs::canonicalize(path).with_context(cannot)?,
        None => named_at_last(path),
    };
    let mut file = tempfile::Builder::new()
        .prefix(UNFINISHED[0])
        .suffix(UNFINISHED[1])
        .make_in(folder_of(&target), |path| fs::File::create_new(path))
        .with_context(cannot)?;
    // Until the file is closed, the lock tells that it is no leftover.
    let _ = file.as_file().try_lock();
    if let Some(found) = before {
        // Before the text is in it: what was private is so all the while.
        file.as_file().set_permissions(found.permissions()).with_context(cannot)?;
    }
    let filled = fill(file.as_file_mut())?;
    file.as_file().sync_all().with_context(cannot)?;
    Ok((file, target, filled))
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

/// Before long work, refuses a place to which [`write()`] cannot write: a folder, or a file in a folder that does not
/// exist.
pub(crate) fn expect_place(path: Option<&Path>) -> Result<()> {
    let Some(path) = path else { return Ok(()) };
    if before(path)?.is_none() {
        fs::metadata(folder_of(&named_at_last(path))).with_context(|| cannot_write(path))?;
    }
    Ok(())
}

/// The folder that holds a file.
fn folder_of(path: &Path) -> &Path {
    path.parent().filter(|folder| !folder.as_os_str().is_empty()).unwrap_or(Path::new("."))
}

/// Removes from a folder the unfinished files that an interrupted run has left, but none that another run still writes.
pub(crate) fn clear_unfinished(folder: &Path) {
    for entry in fs::read_dir(folder).into_iter().flatten().flatten() {
        let name = entry.file_name().to_string_lossy().into_owned();
        let middle = name.strip_prefix(UNFINISHED[0]).and_then(|rest| rest.strip_suffix(UNFINISHED[1]));
        let is_ours = middle
            .is_some_and(|by_chance| by_chance.len() == 6 && entry.metadata().is_ok_and(|m| m.is_file()));
        let is_left = || fs::File::open(entry.path()).is_ok_and(|file| file.try_lock().is_ok());
        if is_ours && is_left() {
            let _ = fs::remove_file(entry.path());
        }
    }
}

/// The name to which links lead if no file is there.
fn named_at_last(path: &Path) -> PathBuf {
    let mut target = path.to_path_buf();
    while let Ok(next) = fs::read_link(&target) {
        target = target.parent().map_or_else(|| next.clone(), |folder| folder.join(&next));
    }
    target
}
