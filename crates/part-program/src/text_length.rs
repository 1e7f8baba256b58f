//! The length of the longest text that is read, and the error for a longer one.

use crate::diagnostic::{Diagnostics, Report};
use crate::source::{Source, Span};

/// Longest part program that is read, in bytes, and longest output of rs274: 512 MiB.
pub const MAX_PROGRAM: usize = 512 << 20;
/// Longest text of any other kind that is read, in bytes: 64 MiB. Each byte of a TOML table takes many of memory.
pub const MAX_TEXT: usize = 64 << 20;

/// A report on the text; an error if the text is longer than `most` bytes.
pub(crate) fn opened<'t>(name: &str, text: &'t str, most: usize) -> Result<Report<'t>, Diagnostics> {
    if text.len() > most {
        return Err(too_long(name, text.len(), most));
    }
    Ok(Report::new(Source::new(name, text)))
}

/// Reports that a text of this many bytes is longer than `most`.
pub(crate) fn too_long(name: &str, length: usize, most: usize) -> Diagnostics {
    let mut report = Report::new(Source::new(name, ""));
    let expected = format!("at most {} MiB", most >> 20);
    report.error(Span::default(), format!("the text has {length} bytes")).expected(expected);
    report.finish().err().unwrap_or_default()
}
