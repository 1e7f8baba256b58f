//! Why a figure cannot be computed.

use std::error::Error;
use std::fmt;

/// A figure that cannot be computed, and the reason.
#[derive(Debug)]
pub struct PaperError {
    what: &'static str,
    reason: Box<dyn Error + Send + Sync>,
}

impl PaperError {
    /// The error of a computation of `what`.
    pub(crate) fn of<E: Into<Box<dyn Error + Send + Sync>>>(what: &'static str) -> impl FnOnce(E) -> Self {
        move |reason| Self { what, reason: reason.into() }
    }
}

impl fmt::Display for PaperError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(self.what)
    }
}

impl Error for PaperError {
    fn source(&self) -> Option<&(dyn Error + 'static)> {
        Some(self.reason.as_ref())
    }
}
