//! The place of a block.

use crate::source::Span;

/// The place of a block: in the text, and in the order of execution.
#[derive(Clone, Copy, Debug)]
pub(crate) struct BlockPlace {
    pub(crate) span: Span,
    pub(crate) block: u32,
}
