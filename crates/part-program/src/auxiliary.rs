//! Words that do not move the tool: M, S, T, D and H, and those of axes other than X, Y and Z.

/// A word that does not move the tool.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Auxiliary {
    /// M, S, T, D or H; A, B, C, U, V or W of an axis that turns the part, E of an extruder that works while the tool rests.
    pub letter: char,
    /// Its number.
    pub value: f64,
    /// Line of its block, from 1.
    pub line: u32,
    /// Number of its block in the order of execution, from 1.
    pub block: u32,
    /// Whether the machine goes on without a rest at it.
    pub is_passed: bool,
}

impl Auxiliary {
    /// A word in a block of this line and number; the machine rests at it.
    pub(crate) fn new(letter: impl Into<char>, value: f64, line: usize, block: u32) -> Self {
        let line = u32::try_from(line).unwrap_or(u32::MAX);
        Self { letter: letter.into(), value, line, block, is_passed: false }
    }
}
