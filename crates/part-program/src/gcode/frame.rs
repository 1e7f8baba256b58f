//! Frames of coordinates that are not read.

/// What ends a frame of coordinates that is not read.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Frame {
    /// Ten times the number of this G word.
    Until(u16),
    /// A frame of Siemens, which replaces it.
    UntilReplaced,
    /// Nothing: where the zero of the coordinates is cannot be told.
    ForEver,
}
