//! What commands say, whose lines are folded to a terminal's width wherever its words end.

/// The words with a blank between two.
pub(crate) fn unfolded(bytes: &[u8]) -> String {
    String::from_utf8_lossy(bytes).split_whitespace().collect::<Vec<_>>().join(" ")
}
