//! Lexer of part programs: a line to its words.
//!
//! A word is a letter and a number (`X12.5`, `G06.2`) or an expression (`X[#1+2]`). In Siemens programs it may be a
//! name, `=` and an expression (`PW=1.5`). Comments `( )` and from `;`, which ends a block of FANUC, block numbers, program numbers and `%` are not
//! words; a `%` that does not begin the program ends it. White space may stand anywhere but inside a number or a name.
//! In addition to words, a line may give values to variables, and commands that select the line to be executed next.

use crate::diagnostic::Report;
use crate::gcode::expression::{Fault, Parser};
use crate::gcode::known_words::{MAct, m_act_of};
use crate::gcode::line::{Line, Tape};
use crate::gcode::scope::Scope;
use crate::gcode::variables::Variable;
use crate::gcode::word::{Key, Word};
use crate::options::Dialect;
use crate::source::{Source, Span};

/// Reads one line that begins at byte `start` into `read`.
pub(crate) fn read_line(
    report: &mut Report<'_>,
    lenient: bool,
    scope: Scope<'_>,
    tape: &mut Tape,
    start: usize,
    line: &str,
    read: &mut Line,
) {
    read.clear();
    let mut lexer = Lexer { report, lenient, scope, start, line, at: 0, begun: tape.begun, read };
    lexer.skip(|c| c.is_ascii_whitespace());
    if lexer.peek() == Some(b'/') {
        let span = lexer.span(lexer.at, lexer.at + 1);
        lexer.report.of_kind(false, span, '/', "optional block: read as if the switch were off").note();
        lexer.at += 1;
        // If a control has several block-skip switches, the digit is the number of one.
        lexer.skip(|c| c.is_ascii_digit());
    }
    if !lexer.is_setting() {
        while lexer.item().is_some() {}
    }
    if scope.dialect == Some(Dialect::Fanuc) && lexer.read.next_block.is_none() {
        lexer.read.next_block = behind_semicolon(line, lexer.at);
    }
    tape.begun |= lexer.begun || !lexer.read.words.is_empty();
}

/// The byte behind the first `;` from byte `at` on that stands in no comment.
fn behind_semicolon(line: &str, at: usize) -> Option<usize> {
    let mut in_comment = false;
    let ends = |c: u8| {
        in_comment = c == b'(' || in_comment && c != b')';
        c == b';' && !in_comment
    };
    line.as_bytes().get(at..)?.iter().copied().position(ends).map(|index| at + index + 1)
}

/// The place in a line, behind the end of a program, of anything but comments and delimiters.
pub(crate) fn remainder(start: usize, line: &str) -> Option<Span> {
    let (modal, variables) = Default::default();
    let scope = Scope { modal: &modal, variables: &variables, dialect: None };
    let mut aside = Report::new(Source::new("", ""));
    let mut read = Line::default();
    read_line(&mut aside, false, scope, &mut Tape::default(), start, line, &mut read);
    let whole = Span::new(start, start + line.trim_end().len());
    let is_more = aside.has_errors() || read.command.is_some() || !read.assignments.is_empty();
    read.words.first().map(|word| word.span).or(is_more.then_some(whole))
}

/// Reads one line.
pub(super) struct Lexer<'r, 't, 'l> {
    pub(super) report: &'r mut Report<'t>,
    pub(super) lenient: bool,
    pub(super) scope: Scope<'l>,
    pub(super) start: usize,
    pub(super) line: &'l str,
    pub(super) at: usize,
    /// See [`Tape`].
    pub(super) begun: bool,
    pub(super) read: &'r mut Line,
}

impl Lexer<'_, '_, '_> {
    pub(super) fn peek(&self) -> Option<u8> {
        self.line.as_bytes().get(self.at).copied()
    }

    pub(super) fn span(&self, from: usize, to: usize) -> Span {
        Span::new(self.start + from, self.start + to)
    }

    pub(super) fn skip(&mut self, skipped: impl Fn(u8) -> bool) {
        while self.peek().is_some_and(&skipped) {
            self.at += 1;
        }
    }

    /// Takes a line that sets up a control and moves nothing: Grbl's `$100=250`, and commands of Klipper, `SET_FAN
    /// SPEED=1`.
    fn is_setting(&mut self) -> bool {
        let text = self.line.trim();
        let first = text.split_whitespace().next().unwrap_or("");
        let is_command = first.len() > 3
            && first.contains('_')
            && first.bytes().all(|c| c.is_ascii_uppercase() || c == b'_' || c.is_ascii_digit());
        let begin = self.line.len() - self.line.trim_start().len();
        let span = self.span(begin, begin + text.len());
        match text.as_bytes() {
            [b'$', b'H' | b'h', ..] => self.read.is_homing = true,
            [b'$' | b'?' | b'!' | b'~', ..] => {
                let said = format!("`{text}` sets the control up: it is left out");
                self.report.of_kind(false, span, '$', said).note();
            }
            _ if is_command => {
                self.report.of_kind(
                    false,
                    span,
                    '_',
                    format!("`{first}` is a command of the control: it is left out"),
                );
            }
            _ => return false,
        }
        true
    }

    /// Reads one item of the line; `None` at its end.
    fn item(&mut self) -> Option<()> {
        self.skip(|c| c.is_ascii_whitespace());
        let begin = self.at;
        match self.peek()? {
            // Text that a printer shows.
            _ if self.is_shown_text() => None,
            b';' => {
                self.read.next_block = Some(self.at + 1);
                None
            }
            b'%' => {
                self.at += 1;
                let ended = self.begun || !self.read.words.is_empty();
                if !ended {
                    self.skip_name_of_program();
                }
                self.read.ended = ended.then_some(self.at);
                self.begun = true;
                (!ended).then_some(())
            }
            b'(' => self.comment(),
            b'#' => self.assignment(false),
            b',' => self.corner(begin),
            c if c.is_ascii_alphabetic() || c == b'_' => self.address(begin),
            c @ (b'@' | b'^') => {
                self.at += 1;
                self.number(begin, Key::Letter(c))
            }
            _ => self.stray(begin),
        }
    }

    /// Passes the name or the number of a program behind its `%`: `%_N_PART_MPF`, `%1234`.
    fn skip_name_of_program(&mut self) {
        if self.line[self.at..].starts_with("_N_") {
            self.read.dialect = Some(Dialect::Siemens);
        }
        if self.peek().is_some_and(|c| c == b'_' || c.is_ascii_digit()) {
            self.skip(|c| c.is_ascii_alphanumeric() || c == b'_');
        }
    }

    /// Whether the last word was M117, M118, M23 or a check of the printer's model, M862. The text behind them has no words.
    fn is_shown_text(&self) -> bool {
        let has_text = |value: f64| value == 117.0 || m_act_of(value.trunc()) == Some(MAct::Text);
        let shows = |word: &Word| word.key == Key::Letter(b'M') && has_text(word.value);
        self.read.words.last().is_some_and(shows)
    }

    /// `,R5` or `,C5`.
    fn corner(&mut self, begin: usize) -> Option<()> {
        self.at += 1;
        self.skip(|c| c == b' ');
        let key = match self.peek().map(|c| c.to_ascii_uppercase()) {
            Some(b'R') => Key::CornerRadius,
            Some(b'C') => Key::CornerDistance,
            _ => {
                self.at = begin;
                return self.stray(begin);
            }
        };
        self.at += 1;
        self.number(begin, key)
    }

    /// A character with which no word begins.
    fn stray(&mut self, begin: usize) -> Option<()> {
        let c = self.line[begin..].chars().next()?;
        self.at += c.len_utf8();
        let what = if c.is_ascii_digit() || matches!(c, '.' | '+' | '-') {
            self.skip(is_number);
            format!("the number `{}` has no letter", &self.line[begin..self.at])
        } else {
            format!("`{}` is no part of a word", c.escape_debug())
        };
        let span = self.span(begin, self.at);
        if self.lenient {
            self.report.warning(span, what);
            self.read.unread.get_or_insert(span);
            return Some(());
        }
        self.report.error(span, what).expected("a word such as X12.5");
        None
    }

    /// A parser of expressions at the lexer's place.
    pub(super) fn parser(&self, is_round: bool) -> Parser<'_> {
        Parser::new(self.line, self.at, self.scope, is_round)
    }

    /// Takes the result of a parser, or reports its fault and ends the line.
    pub(super) fn parsed<T>(&mut self, read: Result<(T, usize), Fault>) -> Option<T> {
        match read {
            Ok((value, at)) => {
                self.at = at;
                Some(value)
            }
            Err(fault) => {
                fault.say(self.report, self.start);
                None
            }
        }
    }

    /// `#5 = expression`, or Siemens' `R5 = expression`.
    pub(super) fn assignment(&mut self, is_round: bool) -> Option<()> {
        let begin = self.at;
        let read = {
            let mut parser = self.parser(is_round);
            parser.variable().and_then(|(variable, place)| {
                if parser.peek() != Some(b'=') {
                    let message = "a variable without a letter before it or a value behind it";
                    return Err(Fault {
                        place,
                        message: message.into(),
                        expected: "a word, as X#5, or a value, as #5=1",
                    });
                }
                parser.at += 1;
                let value = parser.expression()?;
                Ok(((variable, value), parser.at))
            })
        };
        let (variable, value) = self.parsed(read)?;
        if matches!(variable, Variable::Number(0)) {
            let span = self.span(begin, self.at);
            self.report.error(span, "variable 0 cannot be given a value").expected("a variable from #1 on");
            return None;
        }
        self.read.dialect = match variable {
            Variable::Name(_) => Some(Dialect::LinuxCnc),
            Variable::R(_) => Some(Dialect::Siemens),
            Variable::Number(_) => self.read.dialect,
        };
        self.read.assignments.push((variable, value));
        Some(())
    }

    pub(super) fn comment(&mut self) -> Option<()> {
        let begin = self.at;
        let Some(length) = self.line[begin..].find(')') else {
            let end = self.line.trim_end().len().max(begin + 1);
            self.report
                .error(self.span(begin, end), "this comment has no end")
                .expected("a `)` on the same line");
            return None;
        };
        self.at = begin + length + 1;
        if let Some(at) = self.line[begin..self.at].find('\r') {
            let span = self.span(begin + at, begin + at + 1);
            self.report
                .warning(span, "a CR without LF in a comment: what follows it may be a line of its own")
                .expected("lines that end alike");
        }
        Some(())
    }
}

/// Whether a byte may stand in a number.
pub(super) fn is_number(c: u8) -> bool {
    c.is_ascii_digit() || matches!(c, b'.' | b'+' | b'-')
}
