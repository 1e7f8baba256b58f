//! The length of the longest text that is read, and the error for a longer one.

use crate::diagnostic::{Diagnostics, Report};
use crate::source::{Source, Span};

/// Longest text that is read, in bytes: 64 MiB.
pub const MAX_TEXT: usize = 64 << 20;

/// A report on the text; an error if the text is too long.
pub(crate) fn opened<'t>(name: &str, text: &'t str) -> Result<Report<'t>, Diagnostics> {
    if text.len() > MAX_TEXT {
        return Err(too_long(name, text.len()));
    }
    Ok(Report::new(Source::new(name, text)))
}

/// Reports that a text of this many bytes is too long.
pub(crate) fn too_long(name: &str, length: usize) -> Diagnostics {
    let mut report = Report::new(Source::new(name, ""));
    report.error(Span::default(), format!("the text has {length} bytes")).expected("at most 64 MiB");
    report.finish().err().unwrap_or_default()
}
