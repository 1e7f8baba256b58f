//! A part that is planned, and judged in its format.

use std::borrow::Cow;

use anyhow::{Result, bail};
use format_compare::{ExactPlan, Format, Options, Problem};

/// A part that is planned, and judged in the format. With feed override, `problem` is that of the highest override.
pub(crate) struct Judged<'a, const D: usize> {
    pub(crate) problem: Cow<'a, Problem<D>>,
    pub(crate) plan: ExactPlan,
    pub(crate) options: Options,
    pub(crate) format: &'a dyn Format<D>,
    /// The part, its feed and the format, in a line.
    pub(crate) about: String,
    /// Why the run is not good enough; `None` if it is.
    pub(crate) fault: Option<String>,
}

/// Refuses tables that take more flash than there is.
pub(crate) fn expect_room(bytes: usize, flash: Option<usize>) -> Result<()> {
    match flash {
        Some(flash) if bytes > flash => {
            bail!("the tables take {bytes} bytes, and --flash says {flash}: nothing is written")
        }
        _ => Ok(()),
    }
}
