//! Texts that the command prints. Its messages are folded to a terminal's width at the ends of words.

/// A text as it was printed.
pub(crate) fn text(bytes: &[u8]) -> String {
    String::from_utf8_lossy(bytes).into_owned()
}

/// The words of a message, with one blank between two.
pub(crate) fn unfolded(bytes: &[u8]) -> String {
    text(bytes).split_whitespace().collect::<Vec<_>>().join(" ")
}
