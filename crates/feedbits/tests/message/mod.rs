//! Messages of commands, which are folded to a terminal's width at the ends of words.

/// The words of a message, with one blank between two.
pub(crate) fn unfolded(bytes: &[u8]) -> String {
    String::from_utf8_lossy(bytes).split_whitespace().collect::<Vec<_>>().join(" ")
}
