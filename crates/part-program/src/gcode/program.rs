//! A whole program: its lines in the order in which they are executed.

use crate::diagnostic::Report;
use crate::gcode::flow::Context;
use crate::gcode::lexer;
use crate::gcode::line::{Line, Tape};
use crate::gcode::reader::Reader;
use crate::gcode::scope::Scope;
use crate::options::{Dialect, ReadOptions};
use crate::part::Part;
use crate::side_axes::SideMove;
use crate::source::Span;
use crate::tool_table::ToolTable;

/// Reads a whole program into `part`. Errors and warnings go to the report.
pub(crate) fn read(report: &mut Report<'_>, part: &mut Part, options: ReadOptions, tools: &ToolTable) {
    let length = report.source.text.len();
    let mut reader = Reader::new(report, part, options, tools);
    reader.lines();
    reader.end_compensation();
    if let Some(corner) = reader.corner.take() {
        corner.say_unmet(reader.report);
    }
    reader.report.within = None;
    if let Some(span) = reader.cut_speed_from.filter(|_| !reader.names_y) {
        reader.refuse_lathe(span, "G96 keeps the speed of the cut, and nothing moves on Y");
    }
    reader.close(Span::new(length, length));
    reader.part.left_out = reader.unheld.words().map(|(_, words)| words);
    reader.part.unit_is_assumed = !reader.names_unit && options.unit.is_none();
    part.feedrate_mm_per_s = part.highest_feedrate();
    if !part.side_moves.iter().any(SideMove::moves) {
        part.side_moves = Vec::new();
    }
    if part.curves.is_empty() && !report.has_errors() {
        let cause = report.first_warning().map(|first| format!("line {}: {}", first.line, first.message));
        let error = report.error(Span::new(0, 0), "the program holds no curve");
        error.expected("a move from one point to another");
        if let Some(cause) = cause {
            error.hint(format!("what was read over may be why: {cause}"));
        }
    }
}

impl Reader<'_, '_, '_> {
    /// Executes the lines of the program in their order.
    fn lines(&mut self) {
        let (mut read, mut tape) = (Line::default(), Tape::default());
        while let Some(index) = self.flow.advance(self.report) {
            let (start, line) = self.report.source.line(index);
            let mut begin = 0;
            while let Some((next, goes_elsewhere)) =
                self.next_block(&mut read, &mut tape, start + begin, &line[begin..])
            {
                begin += next;
                if goes_elsewhere {
                    let span = Span::new(start + begin, start + line.trim_end().len());
                    self.report
                        .error(span, "a block behind a jump or a call, on its line")
                        .expected("one of these blocks a line");
                    break;
                }
            }
            if self.is_full() {
                let span = Span::new(start, start + line.trim_end().len());
                let message = "the program makes more curves than are taken";
                self.report.error(span, message).expected("fewer turns of arcs, holes and repeated lines");
                return;
            }
            self.ended |= read.ended.is_some();
            if self.ended {
                let behind = read.ended.or(read.next_block).map_or(line.len(), |at| begin + at);
                self.look_behind_the_end(start + behind, &line[behind..], index);
                return;
            }
        }
        if self.flow.is_called() && !self.report.has_errors() {
            let end = self.report.source.text.len();
            self.report
                .error(Span::new(end, end), "the program ends within a subprogram")
                .expected("M99 or endsub at the end of the subprogram");
        }
    }

    /// Executes the block that begins a text. If FANUC's `;` ends it and another follows, returns where that begins, and
    /// whether this one has a command that leads elsewhere.
    fn next_block(
        &mut self,
        read: &mut Line,
        tape: &mut Tape,
        start: usize,
        text: &str,
    ) -> Option<(usize, bool)> {
        let scope = Scope { variables: &self.variables, modal: &self.modal, dialect: self.options.dialect };
        lexer::read_line(self.report, self.options.lenient, scope, tape, start, text, read);
        let has_command = read.command.is_some();
        self.line(read);
        if self.options.dialect != Some(Dialect::Fanuc) {
            read.next_block = None;
        }
        let next = read.next_block.filter(|_| read.ended.is_none() && !self.ended)?;
        if text[next..].trim_matches([' ', '\t', '\r', '\n', ';']).is_empty() {
            return None;
        }
        if self.is_declared {
            return Some((next, has_command || self.flow.has_jumped()));
        }
        let message = "what follows is read as a comment: `;` ends a block of fanuc";
        let span = Span::new(start + next - 1, start + next);
        self.report.of_kind(false, span, ';', message).hint("with `--dialect fanuc` it does");
        None
    }

    /// Executes the words and the command of a line.
    fn line(&mut self, read: &mut Line) {
        if let Some(dialect) = read.dialect {
            self.options.dialect.get_or_insert(dialect);
        }
        self.block_number = self.block_number.saturating_add(1);
        if read.is_homing {
            (0..3).for_each(|axis| self.lose(axis));
        }
        for (variable, value) in read.assignments.drain(..) {
            self.variables.set(variable, value);
        }
        self.flags.clone_from(&read.flags);
        self.others.is_printer |= !self.flags.is_empty();
        self.unread_name = read.unread;
        self.obey_names(&read.name_acts);
        if read.words.is_empty() && read.unread.is_some() {
            self.lose_track_of_all();
            self.forget_the_last_move();
        }
        self.block(&mut read.words);
        if let Some((command, span)) = read.command.take() {
            let mut context = Context {
                report: self.report,
                variables: &mut self.variables,
                modal: &self.modal,
                dialect: self.options.dialect,
            };
            let is_obeyed = self.flow.obey(&mut context, command, span).is_some();
            self.ended |= !is_obeyed;
        }
    }

    /// Warns of words behind the end of the program, unless they may be those of subprograms.
    fn look_behind_the_end(&mut self, start: usize, rest: &str, index: usize) {
        if self.report.has_errors() || self.flow.has_called {
            return;
        }
        self.report.within = None;
        let mut found = lexer::remainder(start, rest);
        let mut index = index + 1;
        while found.is_none() && index < self.report.source.lines() {
            let (start, line) = self.report.source.line(index);
            found = lexer::remainder(start, line);
            index += 1;
        }
        if let Some(span) = found {
            self.report.warning(span, "what follows the end of the program is not read");
        }
    }
}
