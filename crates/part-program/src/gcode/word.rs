//! Lexer of part programs: a line to its words.
//!
//! A word is a letter and a number (`X12.5`, `G06.2`) or an expression (`X[#1+2]`), or in Siemens programs a name, `=` and an expression
//! (`PW=1.5`). Comments `( )` and from `;`, block numbers, program numbers and `%` are no words; a `%` that does not begin the program
//! ends it. White space may stand anywhere but inside a number or a name. Beside words a line may give variables their values, and say
//! which line is executed next.

use crate::diagnostic::Report;
use crate::gcode::command::Command;
use crate::gcode::expression::{Fault, Parser, Scope, Value, is_function};
use crate::gcode::variables::Variable;
use crate::options::Dialect;
use crate::source::{Source, Span};
use crate::toml_table::nearest;

/// What a word addresses.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Key {
    /// A letter, in upper case.
    Letter(u8),
    /// `BSPLINE`, which has no number.
    Bspline,
    /// `SD=`, spline degree.
    SplineDegree,
    /// `PW=`, point weight.
    PointWeight,
    /// `PL=`, parameter interval length.
    IntervalLength,
    /// `CR=`, circle radius.
    CircleRadius,
    /// `,R` or `RND=`: the radius of the corner behind the move.
    CornerRadius,
    /// `,C` or `CHR=`: how much of the corner is cut off.
    CornerDistance,
}

const NAMES: [(&str, Key); 7] = [
    ("BSPLINE", Key::Bspline),
    ("SD", Key::SplineDegree),
    ("PW", Key::PointWeight),
    ("PL", Key::IntervalLength),
    ("CR", Key::CircleRadius),
    ("RND", Key::CornerRadius),
    ("CHR", Key::CornerDistance),
];

/// A word: what it addresses, its number and its place.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Word {
    pub(crate) key: Key,
    pub(crate) value: f64,
    pub(crate) span: Span,
}

/// What is known of a program from the lines before.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Tape {
    /// A word or a `%` has been read, so that the next `%` ends the program.
    begun: bool,
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
    fn clear(&mut self) {
        self.words.clear();
        self.assignments.clear();
        (self.command, self.dialect, self.is_homing, self.ended) = (None, None, false, None);
    }
}

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
        lexer.report.of_kind(false, span, '/', "optional block: read as if the switch were off");
        lexer.at += 1;
        // Of several switches, its number.
        lexer.skip(|c| c.is_ascii_digit());
    }
    if !lexer.is_setting() {
        while lexer.item().is_some() {}
    }
    tape.begun |= lexer.begun || !lexer.read.words.is_empty();
}

/// The value in brackets at byte `at` of a line that begins at byte `start`: the condition of a command.
pub(crate) fn condition(
    report: &mut Report<'_>,
    scope: Scope<'_>,
    start: usize,
    line: &str,
    at: usize,
) -> Option<f64> {
    let mut parser = Parser::new(line, at, scope, false);
    match parser.bracketed() {
        Ok(value) => Some(value.unwrap_or(0.0)),
        Err(fault) => {
            say(report, start, fault);
            None
        }
    }
}

/// The values in brackets from byte `at` of a line on: the arguments of a call.
pub(crate) fn arguments(
    report: &mut Report<'_>,
    scope: Scope<'_>,
    start: usize,
    line: &str,
    at: usize,
) -> Option<Vec<f64>> {
    let mut parser = Parser::new(line, at, scope, false);
    let mut values = Vec::new();
    while parser.peek() == Some(b'[') {
        match parser.bracketed() {
            Ok(value) => values.push(value.unwrap_or(0.0)),
            Err(fault) => {
                say(report, start, fault);
                return None;
            }
        }
    }
    Some(values)
}

fn say(report: &mut Report<'_>, start: usize, fault: Fault) {
    let span = Span::new(start + fault.place.start, start + fault.place.end);
    report.error(span, fault.message).expected(fault.expected);
}

/// Where in a line behind the end of a program something stands that is no comment and no delimiter.
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

    /// Takes a line that sets a control up and moves nothing: Grbl's `$100=250`, and commands of Klipper, `SET_FAN SPEED=1`.
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
                self.report.of_kind(
                    false,
                    span,
                    '$',
                    format!("`{text}` sets the control up: it is left out"),
                );
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
            b';' => None,
            b'%' => {
                self.at += 1;
                let ended = self.begun || !self.read.words.is_empty();
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

    /// Whether the last word was M117, M118 or M23, whose text is no word.
    fn is_shown_text(&self) -> bool {
        let shows = |word: &Word| word.key == Key::Letter(b'M') && [23.0, 117.0, 118.0].contains(&word.value);
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

    /// A character that begins no word.
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
            return Some(());
        }
        self.report.error(span, what).expected("a word such as X12.5");
        None
    }

    /// A parser of expressions that stands where the lexer does.
    pub(super) fn parser(&self, is_round: bool) -> Parser<'_> {
        Parser::new(self.line, self.at, self.scope, is_round)
    }

    /// Takes what a parser has read, or says what is wrong with it, and ends the line.
    pub(super) fn parsed<T>(&mut self, read: Result<(T, usize), Fault>) -> Option<T> {
        match read {
            Ok((value, at)) => {
                self.at = at;
                Some(value)
            }
            Err(fault) => {
                say(self.report, self.start, fault);
                None
            }
        }
    }

    /// `#5 = expression`, or Siemens' `R5 = expression`.
    fn assignment(&mut self, is_round: bool) -> Option<()> {
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

    /// A run of letters: an address with its number, or a word of a control's language.
    fn address(&mut self, begin: usize) -> Option<()> {
        self.skip(|c| c.is_ascii_alphabetic() || c == b'_');
        let name = &self.line[begin..self.at];
        match name.as_bytes() {
            [b'O' | b'o'] => return self.o_word(begin),
            [b'R' | b'r'] if self.is_assigned_parameter() => {
                self.at = begin;
                return self.assignment(true);
            }
            [letter] => return self.number(begin, Key::Letter(letter.to_ascii_uppercase())),
            _ => {}
        }
        match NAMES.iter().find(|(known, _)| known.eq_ignore_ascii_case(name)) {
            Some((_, Key::Bspline)) => {
                self.read.words.push(Word { key: Key::Bspline, value: 0.0, span: self.span(begin, self.at) });
                Some(())
            }
            Some((_, key)) => self.number(begin, *key),
            None => match name.to_ascii_uppercase().as_str() {
                "IF" => self.condition_of_fanuc(begin),
                "GOTO" => self.goto(begin, true),
                "WHILE" => self.fanuc_loop(begin, true),
                "DO" => self.fanuc_loop(begin, false),
                "END" => {
                    let number = self.whole_number()?;
                    self.command(begin, Command::End(number), Dialect::Fanuc)
                }
                // An address with the value of a function, written without a space.
                _ if is_function(&name[1..]) && self.next_is(b'[') => {
                    self.at = begin + 1;
                    self.number(begin, Key::Letter(name.as_bytes()[0].to_ascii_uppercase()))
                }
                _ => self.unknown_name(begin),
            },
        }
    }

    /// The next byte behind white space, which is not taken.
    fn next_is(&self, byte: u8) -> bool {
        self.line.as_bytes()[self.at..].iter().find(|c| !c.is_ascii_whitespace()) == Some(&byte)
    }

    /// Whether digits, or of Siemens brackets, and `=` stand behind an R.
    fn is_assigned_parameter(&self) -> bool {
        let rest = self.line[self.at..].trim_start();
        let behind = match rest.split_once(']') {
            Some((_, behind)) if rest.starts_with('[') && self.scope.dialect == Some(Dialect::Siemens) => {
                behind
            }
            _ => rest.trim_start_matches(|c: char| c.is_ascii_digit()),
        };
        behind.len() < rest.len() && behind.trim_start().starts_with('=')
    }

    /// The number of a word that begins at `begin`; the lexer stands behind its letter or name.
    fn number(&mut self, begin: usize, key: Key) -> Option<()> {
        let name_end = self.at;
        self.skip(|c| c == b' ' || c == b'\t');
        let is_assigned = self.peek() == Some(b'=');
        if is_assigned {
            self.at += 1;
            self.skip(|c| c == b' ' || c == b'\t');
        }
        let digits = self.at;
        if is_assigned || self.is_expression() {
            return self.evaluated(begin, key, is_assigned);
        }
        self.skip(is_number);
        let text = &self.line[digits..self.at];
        let name = &self.line[begin..name_end];
        match text.parse::<f64>() {
            Ok(value) if value.is_finite() => self.push(begin, key, value),
            _ if text.is_empty() => {
                let message = format!("`{name}` has no number");
                self.report
                    .error(self.span(begin, name_end), message)
                    .expected(format!("a number, as {name}12.5"));
            }
            _ => {
                let message = format!("`{text}` is no number");
                self.report
                    .error(self.span(digits, self.at), message)
                    .expected("digits with at most one point");
            }
        }
        Some(())
    }

    fn push(&mut self, begin: usize, key: Key, value: f64) {
        if !matches!(key, Key::Letter(b'N' | b'O')) {
            self.read.words.push(Word { key, value, span: self.span(begin, self.at) });
        }
    }

    /// Whether a value other than a plain number stands next.
    fn is_expression(&self) -> bool {
        let rest = self.line[self.at..].trim_start_matches(['+', '-', ' ', '\t']);
        let letters = rest.bytes().take_while(u8::is_ascii_alphabetic).count();
        rest.starts_with(['[', '#'])
            || is_function(&rest[..letters]) && rest[letters..].trim_start().starts_with('[')
    }

    /// A word whose value is an expression, or an assignment of Siemens.
    fn evaluated(&mut self, begin: usize, key: Key, is_assigned: bool) -> Option<()> {
        let read = {
            let mut parser = self.parser(is_assigned);
            let value = if is_assigned { parser.expression() } else { parser.operand() };
            value.map(|value| (value, parser.at))
        };
        match self.parsed(read)? {
            Some(value) => self.push(begin, key, value),
            // FANUC leaves out a word of a vacant variable.
            None if self.scope.dialect == Some(Dialect::Fanuc) => {}
            None => {
                let span = self.span(begin, self.at);
                self.report
                    .warning(span, "a variable that has no value is taken as 0, as LinuxCNC does")
                    .hint("FANUC leaves its word out, as with its dialect given");
                self.push(begin, key, 0.0);
            }
        }
        Some(())
    }

    /// A run of letters that is no name: letters without their numbers, or words of a control's language.
    fn unknown_name(&mut self, begin: usize) -> Option<()> {
        let name = self.line[begin..self.at].to_ascii_uppercase();
        const LANGUAGE: [&str; 11] =
            ["THEN", "ELSE", "ENDIF", "GOTOF", "GOTOB", "ENDWHILE", "FOR", "DEF", "PROC", "LOOP", "REPEAT"];
        if LANGUAGE.contains(&name.as_str()) || name.starts_with('_') {
            let end = self.line.trim_end().len().max(begin + 1);
            self.report
                .error(self.span(begin, end), format!("`{name}` is not executed"))
                .expected("a program without Siemens' jumps, loops and names of variables")
                .hint("let the control or the post-processor write the program with plain numbers");
            return None;
        }
        let known: Vec<&str> = NAMES.iter().map(|(name, _)| *name).collect();
        let near = nearest(&name, &known).filter(|_| name.len() > 2);
        if self.line[self.at..].trim_start_matches([' ', '\t']).starts_with('=') {
            return self.unknown_assignment(begin);
        }
        if name.len() <= 3 && near.is_none() {
            let message = format!("`{}` has no number", &name[..1]);
            self.report
                .error(self.span(begin, begin + 1), message)
                .expected(format!("a number, as {}12.5", &name[..1]));
            self.at = begin + 1;
            return Some(());
        }
        let span = self.span(begin, self.at);
        let message =
            format!("unknown word `{}`", self.line[begin..self.at].chars().take(40).collect::<String>());
        if self.lenient {
            self.report.of_kind(false, span, &name, message);
            self.skip(|c| c == b' ' || c == b'=');
            self.skip(is_number);
            return Some(());
        }
        let diagnostic = self.report.of_kind(true, span, &name, message);
        diagnostic.expected("a letter with a number, or BSPLINE, SD=, PW=, PL=, CR=");
        if let Some(near) = near {
            diagnostic.hint(format!("did you mean `{near}`?"));
        }
        None
    }

    /// A name that no reader knows, with `=` and its number; the lexer stands behind the name.
    fn unknown_assignment(&mut self, begin: usize) -> Option<()> {
        let message =
            format!("unknown word `{}=`", self.line[begin..self.at].chars().take(40).collect::<String>());
        self.skip(|c| c == b' ' || c == b'\t' || c == b'=');
        self.skip(is_number);
        let span = self.span(begin, self.at);
        if self.lenient {
            self.report.warning(span, message);
        } else {
            self.report.error(span, message).expected("a letter with a number, or SD=, PW=, PL=, CR=");
        }
        Some(())
    }
}

fn is_number(c: u8) -> bool {
    c.is_ascii_digit() || matches!(c, b'.' | b'+' | b'-')
}
