//! Results, and messages beside them.

use std::cell::RefCell;
use std::ffi::OsString;
use std::io::{self, Write};
use std::process::ExitCode;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Mutex, PoisonError};

use anyhow::{Context, Result, anyhow};
use clap::Args;
use clap::error::ErrorKind;
use foreign_text::in_lines;
use part_program::Diagnostics;

use crate::places::{self, Place, cannot_write_to};
use crate::screen;

/// Where a result goes.
#[derive(Args)]
pub(crate) struct Output {
    /// Write to this file instead of the terminal.
    #[arg(long, value_name = "PATH")]
    pub(crate) out: Option<std::path::PathBuf>,
    /// JSON instead of a table.
    #[arg(long)]
    pub(crate) json: bool,
}

impl Output {
    /// The place of the result. Errors are those of [`Place::named`].
    pub(crate) fn place(&self) -> Result<Place> {
        Place::named("--out", self.out.as_deref())
    }
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

/// Notes and warnings about the input, until the work begins; `None` from then on.
static HELD: Mutex<Option<Vec<String>>> = Mutex::new(Some(Vec::new()));

thread_local! {
    /// What [`kept`] keeps on this thread; `None` while nothing is kept.
    static KEPT: RefCell<Option<Vec<String>>> = const { RefCell::new(None) };
}

/// The result of `work`, and the notes and warnings that it would have printed on this thread.
pub(crate) fn kept<T>(work: impl FnOnce() -> T) -> (T, Vec<String>) {
    KEPT.set(Some(Vec::new()));
    let result = work();
    (result, KEPT.take().unwrap_or_default())
}

/// Whether notes and warnings of this thread are kept.
pub(crate) fn is_kept() -> bool {
    KEPT.with_borrow(Option::is_some)
}

/// Prints a note beside the result, as [`warn()`] does.
pub(crate) fn note(text: &str) {
    if !is_quiet() {
        warn(&format!("feedbits: {text}"));
    }
}

/// Prints a warning about the input; before the work has begun, once it begins. So a command that is refused says why it
/// is refused, and nothing else.
pub(crate) fn warn(text: &str) {
    let is_kept = KEPT.with_borrow_mut(|kept| kept.as_mut().map(|kept| kept.push(text.to_string())));
    if is_kept.is_some() {
        return;
    }
    let mut held = HELD.lock().unwrap_or_else(PoisonError::into_inner);
    match held.as_mut() {
        Some(held) => held.push(text.to_string()),
        None => say(text),
    }
}

/// Prints the notes and warnings so far: nothing that could have been known before is refused from here on.
pub(crate) fn begin_work() {
    let held = HELD.lock().unwrap_or_else(PoisonError::into_inner).take();
    held.iter().flatten().for_each(|text| say(text));
}

/// `did you mean …? ` if a known word is near to `word`, otherwise an empty text.
pub(crate) fn did_you_mean(word: &str, known: &[&str]) -> String {
    part_program::nearest(word, known).map_or_else(String::new, |meant| format!("did you mean `{meant}`? "))
}

/// A number with its noun: the one for a single thing, or the one for several.
pub(crate) fn counted(count: usize, one: &str, others: &str) -> String {
    format!("{count} {}", if count == 1 { one } else { others })
}

/// Writes a message to the error stream, folded to the screen and with [`screen::MOST_BYTES`] at most. Names and input that it quotes may
/// hold what a terminal acts on; that becomes a `?`. If that stream is closed or full the message is lost, and only the exit status tells
/// the result.
pub(crate) fn say(text: &str) {
    let _ = writeln!(io::stderr().lock(), "{}", screen::message(&in_lines(text)));
}

/// Says why a command is refused, in one message. Of many errors in a text it has the first.
pub(crate) fn refuse(error: &anyhow::Error) {
    let text = format!("feedbits: {error:#}");
    let in_a_text = error.chain().find_map(|cause| cause.downcast_ref::<Diagnostics>());
    say(&in_a_text.map_or(text.clone(), |errors| first_errors(&text, errors.count())));
}

/// The first of `count` errors, which stand in paragraphs of their own, and how many there are more.
fn first_errors(text: &str, count: usize) -> String {
    const ROOM_FOR_MORE: usize = 80;
    let mut room = screen::MOST_BYTES - ROOM_FOR_MORE;
    let fits = |paragraph: &&str| {
        let taken = screen::message(paragraph).len() + "\n\n".len();
        let fits = taken <= room;
        room = room.saturating_sub(taken);
        fits
    };
    let shown: Vec<&str> = text.split("\n\n").take_while(fits).collect();
    match shown.len() {
        shown if shown >= count => text.to_string(),
        // A single error that is too long is cut in its middle.
        0 => text.to_string(),
        some => format!(
            "{}\n\nand {} more; `feedbits check` prints all errors of a part",
            shown.join("\n\n"),
            count - some
        ),
    }
}

/// Prints the error in the command line, or the help that the command line asks for. Returns the exit status.
pub(crate) fn usage(error: &clap::Error) -> ExitCode {
    if error.kind() == ErrorKind::InvalidUtf8 {
        refuse(&anyhow!(
            "not UTF-8: {}: expected such bytes in names of files alone",
            words_that_are_no_text()
        ));
        return ExitCode::from(2);
    }
    if error.use_stderr() {
        let (styled, plain) = (error.render().ansi().to_string(), error.render().to_string());
        let printable = in_lines(&plain);
        // Neither a style of a long text is cut, nor is one of the command line's own kept.
        let has_styles = printable == plain && styled.len() <= screen::MOST_BYTES / 2;
        let text = screen::message(if has_styles { &styled } else { &printable });
        let _ = anstream::stderr().lock().write_all(text.as_bytes());
        return ExitCode::from(u8::try_from(error.exit_code()).unwrap_or(2));
    }
    status_of(printed(error.print()))
}

/// The words of the command line that are no text, each behind the option before it: the parser does not say which it took for
/// a number or a name.
fn words_that_are_no_text() -> String {
    let words: Vec<_> = std::env::args_os().collect();
    let pairs = words.windows(2).filter(|pair| pair[1].to_str().is_none());
    let shown = |pair: &[OsString]| {
        let word = format!("{:?}", pair[1].to_string_lossy());
        let option = pair[0].to_str().filter(|before| before.starts_with("--"));
        option.map_or(word.clone(), |option| format!("{option} {word}"))
    };
    pairs.map(shown).collect::<Vec<_>>().join(", ")
}

/// The exit status of a print, which is refused if it failed.
pub(crate) fn status_of(printed: Result<()>) -> ExitCode {
    match printed {
        Ok(()) => ExitCode::SUCCESS,
        Err(error) => {
            refuse(&error);
            ExitCode::from(2)
        }
    }
}

/// The end of a print to the terminal, once it has taken everything. What a reader that has gone away does not take is
/// lost.
pub(crate) fn printed(result: io::Result<()>) -> Result<()> {
    match result.and_then(|()| io::stdout().flush()) {
        Err(error) if error.kind() == io::ErrorKind::BrokenPipe => Ok(()),
        other => other.context("cannot write to the terminal"),
    }
}

/// Writes `text` to a place: a file appears whole or not at all, as [`places::write_file`] says. Styles are shown on a
/// terminal that has them, unless the environment says NO_COLOR, and are left out elsewhere.
pub(crate) fn write(place: &Place, text: &str) -> Result<()> {
    begin_work();
    // Whatever takes styles out takes other characters out too, which JSON may hold.
    let has_styles = text.contains('\u{1b}');
    let Some(path) = place.path() else {
        return printed(if has_styles {
            anstream::stdout().lock().write_all(text.as_bytes())
        } else {
            io::stdout().lock().write_all(text.as_bytes())
        });
    };
    let text = if has_styles { anstream::adapter::strip_str(text).to_string() } else { text.to_string() };
    places::write_file(path, |file| file.write_all(text.as_bytes()).with_context(|| cannot_write_to(place)))
}

/// As [`write()`], for a text without styles that `by` writes bit by bit. If `by` fails, no file appears. What fails of its writing
/// names the place.
pub(crate) fn write_by<T>(place: &Place, by: impl FnOnce(&mut (dyn Write + Send)) -> Result<T>) -> Result<T> {
    begin_work();
    let by = |to: &mut (dyn Write + Send)| {
        by(to).map_err(|error| match error.chain().any(|cause| cause.is::<io::Error>()) {
            true => error.context(cannot_write_to(place)),
            false => error,
        })
    };
    let Some(path) = place.path() else {
        let mut terminal = Terminal(io::BufWriter::new(io::stdout()));
        let result = by(&mut terminal);
        if result.is_ok() {
            printed(terminal.flush())?;
        }
        // After an error, what is not printed yet is dropped.
        let _ = terminal.0.into_parts();
        return result;
    };
    places::write_file(path, |file| {
        let mut buffer = io::BufWriter::new(file);
        let result = by(&mut buffer)?;
        buffer.flush().with_context(|| cannot_write_to(place))?;
        Ok(result)
    })
}

/// The terminal, or a pipe: what a reader that has gone away does not take is lost.
struct Terminal(io::BufWriter<io::Stdout>);

impl Write for Terminal {
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
