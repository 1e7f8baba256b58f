//! The commands of a line: FANUC's IF, GOTO, WHILE and END, and LinuxCNC's O-words.

use crate::gcode::command::{Command, Keyword, Label};
use crate::gcode::expression::Fault;
use crate::gcode::lexer::Lexer;
use crate::options::Dialect;

impl Lexer<'_, '_, '_> {
    pub(super) fn command(&mut self, begin: usize, command: Command, dialect: Dialect) -> Option<()> {
        self.read.dialect = Some(dialect);
        self.read.command = Some((command, self.span(begin, self.at)));
        None
    }

    /// A whole number, given by an expression.
    pub(super) fn whole_number(&mut self) -> Option<u32> {
        let read = {
            let mut parser = self.parser(false);
            let begin = parser.at;
            parser.operand().and_then(|value| {
                let value = value.unwrap_or(0.0).round();
                if !(0.0..=99_999_999.0).contains(&value) {
                    let message = format!("{value} is no number of a block or a loop");
                    return Err(Fault { place: begin..parser.at, message, expected: "a whole number" });
                }
                #[allow(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "checked above")]
                Ok((value as u32, parser.at))
            })
        };
        self.parsed(read)
    }

    /// FANUC's `IF [condition] GOTO 10` and `IF [condition] THEN #1=2`. The lexer must be behind IF.
    pub(super) fn condition_of_fanuc(&mut self, begin: usize) -> Option<()> {
        let holds = self.in_brackets()? != 0.0;
        self.skip(|c| c.is_ascii_whitespace());
        let keyword = self.at;
        self.skip(|c| c.is_ascii_alphabetic());
        match self.line[keyword..self.at].to_ascii_uppercase().as_str() {
            "GOTO" => self.goto(begin, holds),
            "THEN" => {
                self.read.dialect = Some(Dialect::Fanuc);
                holds.then_some(())
            }
            _ => {
                let span = self.span(begin, self.at.max(begin + 1));
                self.report
                    .error(span, "IF without GOTO or THEN")
                    .expected("IF [condition] GOTO 10, or THEN #1=2");
                None
            }
        }
    }

    fn in_brackets(&mut self) -> Option<f64> {
        let read = {
            let mut parser = self.parser(false);
            parser.bracketed().map(|value| (value.unwrap_or(0.0), parser.at))
        };
        self.parsed(read)
    }

    pub(super) fn goto(&mut self, begin: usize, is_taken: bool) -> Option<()> {
        let number = self.whole_number()?;
        if is_taken {
            return self.command(begin, Command::Goto(number), Dialect::Fanuc);
        }
        self.read.dialect = Some(Dialect::Fanuc);
        None
    }

    /// FANUC's `WHILE [condition] DO 1`, or `DO 1`, which has no condition.
    pub(super) fn fanuc_loop(&mut self, begin: usize, is_conditional: bool) -> Option<()> {
        let mut holds = true;
        if is_conditional {
            holds = self.in_brackets()? != 0.0;
            self.skip(|c| c.is_ascii_whitespace());
            let keyword = self.at;
            self.skip(|c| c.is_ascii_alphabetic());
            if !self.line[keyword..self.at].eq_ignore_ascii_case("DO") {
                let span = self.span(begin, self.at.max(begin + 1));
                self.report.error(span, "WHILE without DO").expected("WHILE [condition] DO 1");
                return None;
            }
        }
        let number = self.whole_number()?;
        self.command(begin, Command::While { number, holds }, Dialect::Fanuc)
    }

    /// `O1000`, the number of a program, or LinuxCNC's `o100 while [condition]`. The lexer must be behind the letter.
    pub(super) fn o_word(&mut self, begin: usize) -> Option<()> {
        let label = self.label()?;
        self.skip(|c| c.is_ascii_whitespace());
        while self.peek() == Some(b'(') {
            self.comment()?;
            self.skip(|c| c.is_ascii_whitespace());
        }
        let word = self.at;
        self.skip(|c| c.is_ascii_alphabetic());
        match Keyword::of(&self.line[word..self.at]) {
            Some(keyword) => {
                let at = self.at;
                self.command(begin, Command::Word { label, keyword, at }, Dialect::LinuxCnc)
            }
            None => {
                self.at = word;
                Some(())
            }
        }
    }

    /// The number or the name behind an O.
    fn label(&mut self) -> Option<Label> {
        let begin = self.at;
        self.skip(|c| c == b' ' || c == b'\t');
        if self.peek() == Some(b'<') {
            let Some(length) = self.line[self.at..].find('>') else {
                let span = self.span(begin, self.line.trim_end().len().max(begin + 1));
                self.report.error(span, "the name of this O-word has no end").expected("`>`");
                return None;
            };
            let name = Label::named(&self.line[self.at + 1..self.at + length]);
            self.at += length + 1;
            return Some(name);
        }
        self.whole_number().map(Label::Number)
    }
}
