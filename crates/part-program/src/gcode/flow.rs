//! The order in which the lines of a program are executed: calls, loops, conditions and jumps.
//!
//! | control | commands |
//! |---|---|
//! | LinuxCNC | `o100 sub` … `endsub`, `call`, `return`; `if`, `elseif`, `else`, `endif`; `while` … `endwhile`, `do` … `while`, `repeat` … `endrepeat`, `break`, `continue` |
//! | FANUC | `IF [ ] GOTO 10`, `IF [ ] THEN`, `GOTO 10`, `WHILE [ ] DO 1` … `END 1`; `G65 P9000 A1`, `M98 P9000 L3` … `M99`, `M99 P10` |
//!
//! A program that repeats lines without an end is stopped: at most [`MAX_REPEATED`] lines, with at most
//! [`MAX_REPEATED_BYTES`] bytes, are executed again. After an error the number of lines is less.
//!
//! # Source
//! LinuxCNC, "O Codes"; FANUC Series 30i, B-63944EN/03, chapter 16.

use crate::diagnostic::Report;
use crate::gcode::bracketed;
use crate::gcode::command::{Command, Keyword, Label};
use crate::gcode::marks::Marks;
use crate::gcode::modal::Modal;
use crate::gcode::scope::Scope;
use crate::gcode::variables::{FANUC_LOCALS, Variables};
use crate::options::Dialect;
use crate::source::Span;

/// Most lines, in total, that jumps, calls and loops may execute again.
pub(crate) const MAX_REPEATED: usize = 2_000_000;
/// Most bytes of these lines.
pub(crate) const MAX_REPEATED_BYTES: usize = 1 << 26;
/// Most lines that are executed again in a program in which an error has been found.
const MAX_REPEATED_WITH_ERRORS: usize = 100_000;
/// Most calls within one another.
const MAX_CALLS: usize = 100;
/// Most loops and conditions within one another, in one program or subprogram.
const MAX_NESTED: usize = 100;

/// A call of a subprogram: `G65` with arguments, or `M98`.
pub(crate) struct Call {
    /// Number of the program, P.
    pub(crate) program: u32,
    /// The number of times that it is executed.
    pub(crate) times: u32,
    /// The variables that a macro call gives to the subprogram; `None` for M98.
    pub(crate) arguments: Option<Vec<(u32, f64)>>,
    pub(crate) span: Span,
}

/// A loop or a condition that has begun and not ended.
#[derive(Clone, Debug)]
pub(super) struct Nested {
    pub(super) kind: Kind,
    /// Line on which it began.
    pub(super) line: usize,
    /// The number of times that its lines have begun.
    pub(super) turn: u32,
}

#[derive(Clone, Debug, PartialEq)]
pub(super) enum Kind {
    If(Label),
    While(Label),
    Do(Label),
    Repeat { label: Label, left: u32 },
    Fanuc(u32),
}

/// A program, or a subprogram that was called.
#[derive(Default)]
pub(super) struct Frame {
    /// The line of the call.
    call_line: usize,
    /// The first line that a call executes, and how many more times it is executed.
    first: usize,
    again: u32,
    /// Whether it has variables of its own.
    has_locals: bool,
    pub(super) nested: Vec<Nested>,
}

/// The line that is executed next.
pub(crate) struct Flow {
    /// The line that is executed, from 0.
    pub(crate) line: usize,
    pub(super) next: usize,
    /// The marks of the program, found when the first command needs them.
    marks: Option<Marks>,
    frames: Vec<Frame>,
    /// The furthest line so far. A line before it is executed again.
    furthest: usize,
    pub(super) repeated: usize,
    pub(super) repeated_bytes: usize,
    /// Whether a call was made, so that subprograms may follow the program's end.
    pub(crate) has_called: bool,
}

/// The state that the commands of a line change.
pub(crate) struct Context<'c, 'r, 't> {
    pub(crate) report: &'r mut Report<'t>,
    pub(crate) variables: &'c mut Variables,
    pub(crate) modal: &'c Modal,
    pub(crate) dialect: Option<Dialect>,
}

impl Context<'_, '_, '_> {
    pub(super) fn line(&self, line: usize) -> (usize, &str) {
        self.report.source.line(line)
    }

    /// The value in brackets at a byte of a line.
    pub(super) fn condition(&mut self, line: usize, at: usize) -> Option<f64> {
        let (start, text) = self.report.source.line(line);
        let scope = Scope { variables: self.variables, modal: self.modal, dialect: self.dialect };
        bracketed::condition(self.report, scope, start, text, at)
    }

    /// The values in brackets from a byte of a line on.
    pub(super) fn arguments(&mut self, line: usize, at: usize) -> Option<Vec<f64>> {
        let (start, text) = self.report.source.line(line);
        let scope = Scope { variables: self.variables, modal: self.modal, dialect: self.dialect };
        bracketed::arguments(self.report, scope, start, text, at)
    }
}

impl Default for Flow {
    fn default() -> Self {
        Self {
            line: 0,
            next: 0,
            marks: None,
            frames: vec![Frame::default()],
            furthest: 0,
            repeated: 0,
            repeated_bytes: 0,
            has_called: false,
        }
    }
}

impl Flow {
    /// Goes on to the next line; `None` at the end of the text, or if too many lines were repeated, which is reported.
    pub(crate) fn advance(&mut self, report: &mut Report<'_>) -> Option<usize> {
        let line = self.next;
        if line >= report.source.lines() {
            return None;
        }
        if line < self.furthest {
            self.repeated += 1;
            self.repeated_bytes += report.source.line(line).1.len();
            // The same faults would be found in each turn.
            if report.has_errors() && self.repeated > MAX_REPEATED_WITH_ERRORS {
                return None;
            }
            if self.repeated > MAX_REPEATED || self.repeated_bytes > MAX_REPEATED_BYTES {
                let (start, text) = report.source.line(line);
                let again = self.repeated - 1;
                report
                    .error(
                        Span::new(start, start + text.trim_end().len()),
                        format!("{again} lines were executed again, and the program has not ended"),
                    )
                    .expected("loops and calls that end");
                return None;
            }
        }
        (self.line, self.next, self.furthest) = (line, line + 1, self.furthest.max(line + 1));
        report.within = self.frames.last().and_then(|frame| {
            let turn = frame.nested.iter().rev().find(|nested| !matches!(nested.kind, Kind::If(_)));
            turn.map(|nested| (nested.line + 1, Some(nested.turn)))
                .or((self.frames.len() > 1).then_some((frame.call_line + 1, None)))
        });
        Some(line)
    }

    /// Whether another line than the one behind this one is executed next.
    pub(crate) fn has_jumped(&self) -> bool {
        self.next != self.line + 1
    }

    /// Whether the line stands in a subprogram.
    pub(crate) fn is_called(&self) -> bool {
        self.frames.len() > 1
    }

    pub(super) fn frame(&mut self) -> &mut Frame {
        if self.frames.is_empty() {
            self.frames.push(Frame::default());
        }
        let last = self.frames.len() - 1;
        &mut self.frames[last]
    }

    pub(super) fn marks(&mut self, report: &Report<'_>) -> &Marks {
        self.marks.get_or_insert_with(|| Marks::of(report))
    }

    /// Executes the command of the current line.
    pub(crate) fn obey(
        &mut self,
        context: &mut Context<'_, '_, '_>,
        command: Command,
        span: Span,
    ) -> Option<()> {
        match command {
            Command::Goto(number) => self.jump(context.report, number, self.line, span)?,
            Command::While { number, holds } => self.fanuc_while(context, number, holds, span)?,
            Command::End(number) => self.fanuc_end(context, number, span)?,
            Command::Word { label, keyword, at } => self.o_word(context, &label, keyword, at, span)?,
        }
        Some(())
    }

    /// Goes to the block with a number, in the program in which line `here` stands. A missing block is reported.
    fn jump(&mut self, report: &mut Report<'_>, number: u32, here: usize, span: Span) -> Option<()> {
        let Some(line) = self.marks(report).block(number, here) else {
            let message = format!("there is no block N{number} in this program");
            report.error(span, message).expected("the number of a block");
            return None;
        };
        self.next = line;
        Some(())
    }

    /// `M99 P10`: leaves the subprogram, if it is one, and goes to a block of the calling program.
    pub(crate) fn return_to(
        &mut self,
        report: &mut Report<'_>,
        variables: &mut Variables,
        number: u32,
        span: Span,
    ) -> Option<()> {
        let here = if self.is_called() { self.frame().call_line } else { self.line };
        self.frame().again = 0;
        self.return_from(variables);
        self.jump(report, number, here, span)
    }

    fn fanuc_while(
        &mut self,
        context: &mut Context<'_, '_, '_>,
        number: u32,
        holds: bool,
        span: Span,
    ) -> Option<()> {
        let line = self.line;
        let kind = Kind::Fanuc(number);
        if !holds {
            let ends = self
                .marks(context.report)
                .ends
                .get(&number)
                .and_then(|ends| ends.iter().find(|end| **end > line));
            let Some(end) = ends.copied() else {
                context
                    .report
                    .error(span, format!("DO{number} has no END{number}"))
                    .expected("one behind it");
                return None;
            };
            self.leave(&kind);
            self.next = end + 1;
            return Some(());
        }
        match self.frame().nested.iter().rposition(|nested| nested.kind == kind && nested.line == line) {
            Some(index) => self.frame().nested.truncate(index + 1),
            None => {
                self.leave(&kind);
                self.begin(context, kind, span)?;
            }
        }
        Some(())
    }

    fn fanuc_end(&mut self, context: &mut Context<'_, '_, '_>, number: u32, span: Span) -> Option<()> {
        let kind = Kind::Fanuc(number);
        let Some(index) = self.begun(&kind) else {
            context.report.error(span, format!("END{number} without DO{number}")).expected("one before it");
            return None;
        };
        self.next = self.turn_again(index);
        Some(())
    }

    /// Index of the innermost loop or condition of a kind that has begun.
    pub(super) fn begun(&mut self, kind: &Kind) -> Option<usize> {
        self.frame().nested.iter().rposition(|nested| nested.kind == *kind)
    }

    /// Begins the next turn of a loop, and ends everything that has begun within it. Returns the line on which the loop
    /// began.
    pub(super) fn turn_again(&mut self, index: usize) -> usize {
        let nested = &mut self.frame().nested;
        nested.truncate(index + 1);
        nested[index].turn = nested[index].turn.saturating_add(1);
        nested[index].line
    }

    /// Ends a loop or a condition and all within it, if it has begun.
    pub(super) fn leave(&mut self, kind: &Kind) {
        if let Some(index) = self.begun(kind) {
            self.frame().nested.truncate(index);
        }
    }

    pub(super) fn begin(&mut self, context: &mut Context<'_, '_, '_>, kind: Kind, span: Span) -> Option<()> {
        let line = self.line;
        if self.frame().nested.len() == MAX_NESTED {
            let message = format!("more than {MAX_NESTED} loops and conditions within one another");
            context.report.error(span, message).expected("fewer of them");
            return None;
        }
        self.frame().nested.push(Nested { kind, line, turn: 1 });
        Some(())
    }

    /// The first line behind `after` that has one of the keywords of a label.
    pub(super) fn find(
        &mut self,
        report: &Report<'_>,
        label: &Label,
        after: usize,
        keywords: &[Keyword],
    ) -> Option<(usize, Keyword)> {
        let lines = self.marks(report).words.get(label)?;
        let begin = lines.partition_point(|(line, _)| *line <= after);
        let is_wanted = |(line, keyword): &(usize, Option<Keyword>)| {
            keyword.filter(|keyword| keywords.contains(keyword)).map(|keyword| (*line, keyword))
        };
        lines[begin..].iter().find_map(is_wanted)
    }

    /// As `find`, from the current line on. A missing line is reported.
    pub(super) fn needed(
        &mut self,
        context: &mut Context<'_, '_, '_>,
        label: &Label,
        keyword: Keyword,
        span: Span,
    ) -> Option<usize> {
        let found = self.find(context.report, label, self.line, &[keyword]);
        if found.is_none() {
            let message = format!("`{label}` has no {} behind it", keyword.name());
            context.report.error(span, message).expected(format!("a line `{label} {}`", keyword.name()));
        }
        found.map(|(line, _)| line)
    }

    pub(super) fn enter(
        &mut self,
        report: &mut Report<'_>,
        first: usize,
        again: u32,
        has_locals: bool,
        span: Span,
    ) -> Option<()> {
        if self.frames.len() > MAX_CALLS {
            report
                .error(span, format!("more than {MAX_CALLS} calls within one another"))
                .expected("calls that return");
            return None;
        }
        self.has_called = true;
        self.frames.push(Frame { call_line: self.line, first, again, has_locals, nested: Vec::new() });
        self.next = first;
        Some(())
    }

    /// Goes on behind the call of the current subprogram, or executes the subprogram again.
    pub(crate) fn return_from(&mut self, variables: &mut Variables) {
        if !self.is_called() {
            return;
        }
        let frame = self.frame();
        if frame.again > 0 {
            frame.again -= 1;
            frame.nested.clear();
            self.next = self.frame().first;
            return;
        }
        if let Some(frame) = self.frames.pop() {
            variables.calls = self.frames.len() - 1;
            self.next = frame.call_line + 1;
            if frame.has_locals {
                variables.leave();
            }
        }
    }

    /// Calls a program by its number. Returns whether the program exists.
    pub(crate) fn call(&mut self, report: &mut Report<'_>, variables: &mut Variables, call: &Call) -> bool {
        let program_line = |marks: &Marks, program: u32| {
            let lines = marks.words.get(&Label::Number(program))?;
            let is_begin = |keyword: &Option<Keyword>| matches!(keyword, None | Some(Keyword::Sub));
            lines.iter().find(|(_, keyword)| is_begin(keyword)).map(|(line, _)| line + 1)
        };
        let marks = self.marks(report);
        // Older controls write the number of repetitions before a program number of four digits.
        let (first, times) = match program_line(marks, call.program) {
            Some(first) => (first, call.times),
            None => match program_line(marks, call.program % 10_000) {
                Some(first) if call.program >= 10_000 => (first, call.program / 10_000),
                _ => return false,
            },
        };
        if times == 0 {
            return true;
        }
        let has_locals = call.arguments.is_some();
        if let Some(arguments) = &call.arguments {
            variables.enter(FANUC_LOCALS, arguments);
        }
        if self.enter(report, first, times - 1, has_locals, call.span).is_none() {
            self.next = usize::MAX;
        }
        variables.calls = self.frames.len() - 1;
        true
    }
}
