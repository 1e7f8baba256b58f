//! The files of a part.

use std::ops::Deref;

use askama::Template;
use real::Backend;

use crate::c_part::{COverride, CPart, ExpectedRun};
use crate::exponents::ToPhase;
use crate::name::CError;
use crate::overridden_run::OverriddenRun;
use crate::values::{Reader, Values};

/// The two files of a part.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct CFiles {
    /// `NAME.h`.
    pub header: String,
    /// `NAME.c`.
    pub source: String,
    /// Bytes of all tables.
    pub table_bytes: usize,
    /// The run that the self-test compares with.
    pub run: ExpectedRun,
}

#[derive(Template)]
#[template(path = "part.h", escape = "none")]
struct Header<'a>(&'a Values);

#[derive(Template)]
#[template(path = "part.c", escape = "none")]
struct Source<'a>(&'a Values);

impl Deref for Header<'_> {
    type Target = Values;
    fn deref(&self) -> &Values {
        self.0
    }
}

impl Deref for Source<'_> {
    type Target = Values;
    fn deref(&self) -> &Values {
        self.0
    }
}

impl<R: Backend, const D: usize> CPart<'_, R, D> {
    /// The text of both files.
    ///
    /// # Errors
    /// [`CError`] if C has no type for the format, or the path cannot be counted.
    pub fn files(&self) -> Result<CFiles, CError> {
        self.files_for(Reader::Compiler)
    }

    /// The same as a description of the step, for what has numbers of its own: fixed point of any width from 16 to 32 bits. Its section
    /// *Numbers* holds for those widths alone that C has.
    ///
    /// # Errors
    /// [`CError`] if the format is no such, or the path cannot be counted.
    pub fn description(&self) -> Result<CFiles, CError> {
        self.files_for(Reader::Hardware)
    }

    fn files_for(&self, reader: Reader) -> Result<CFiles, CError> {
        let overridden = self.feed_override.map(|COverride { feeds, commanded }| {
            OverriddenRun::of(self.path, &feeds, commanded, self.run.periods).ok_or(CError::Unfinished)
        });
        let overridden = overridden.transpose()?;
        let values = Values::of(self, overridden, reader)?;
        let text = |rendered: askama::Result<String>| rendered.map(with_end).unwrap_or_default();
        Ok(CFiles {
            header: text(Header(&values).render()),
            source: text(Source(&values).render()),
            table_bytes: values.table_bytes,
            run: self.run,
        })
    }
}

/// A text whose last line ends.
fn with_end(text: String) -> String {
    if text.ends_with('\n') { text } else { text + "\n" }
}
