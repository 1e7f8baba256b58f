//! The contents of a line.

use crate::gcode::command::Command;
use crate::gcode::unread_names::NameAct;
use crate::gcode::variables::{Value, Variable};
use crate::gcode::word::Word;
use crate::options::Dialect;
use crate::source::Span;

/// The state of a program after the lines before.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Tape {
    /// A word or a `%` has been read, so that the next `%` ends the program.
    pub(super) begun: bool,
}

/// The contents of a line, with every expression evaluated.
#[derive(Default)]
pub(crate) struct Line {
    pub(crate) words: Vec<Word>,
    /// Letters without a number, and those with a text, where a printer takes them.
    pub(crate) flags: Vec<u8>,
    /// Variables with their new values, which hold from the next block on.
    pub(crate) assignments: Vec<(Variable, Value)>,
    /// A name or a character that is not read: its block is left out.
    pub(crate) unread: Option<Span>,
    /// What names that are not read do to the blocks behind them.
    pub(crate) name_acts: Vec<NameAct>,
    /// The command of the line that changes the order of lines.
    pub(crate) command: Option<(Command, Span)>,
    /// The control whose way of writing commands or variables is found in the line.
    pub(crate) dialect: Option<Dialect>,
    /// Whether the line is `$H` of Grbl: the machine goes to its home position.
    pub(crate) is_homing: bool,
    /// The byte behind a `;` that ended the block.
    pub(crate) next_block: Option<usize>,
    /// The number of bytes read, if a `%` ended the program.
    pub(crate) ended: Option<usize>,
}

impl Line {
    pub(super) fn clear(&mut self) {
        self.words.clear();
        self.assignments.clear();
        self.flags.clear();
        self.name_acts.clear();
        (self.command, self.dialect, self.is_homing) = (None, None, false);
        (self.unread, self.next_block, self.ended) = (None, None, None);
    }
}
