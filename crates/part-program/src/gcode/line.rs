//! What stands in a line.

use crate::gcode::command::Command;
use crate::gcode::variables::{Value, Variable};
use crate::gcode::word::Word;
use crate::options::Dialect;
use crate::source::Span;

/// What is known of a program from the lines before.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Tape {
    /// A word or a `%` has been read, so that the next `%` ends the program.
    pub(super) begun: bool,
}

/// What stands in a line, with every expression evaluated.
#[derive(Default)]
pub(crate) struct Line {
    pub(crate) words: Vec<Word>,
    /// Variables with their new values, which hold from the next block on.
    pub(crate) assignments: Vec<(Variable, Value)>,
    /// What the line says of the order in which lines are executed.
    pub(crate) command: Option<(Command, Span)>,
    /// A control whose way of writing commands or variables the line shows.
    pub(crate) dialect: Option<Dialect>,
    /// `$H` of Grbl: the machine goes to a place of its own.
    pub(crate) is_homing: bool,
    /// The bytes that were read, if a `%` ended the program.
    pub(crate) ended: Option<usize>,
}

impl Line {
    pub(super) fn clear(&mut self) {
        self.words.clear();
        self.assignments.clear();
        (self.command, self.dialect, self.is_homing, self.ended) = (None, None, false, None);
    }
}
