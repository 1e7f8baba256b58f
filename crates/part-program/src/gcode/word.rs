//! Lexer of part programs: a line to its words.
//!
//! A word is a letter and a number (`X12.5`, `G06.2`), or in Siemens programs a name, `=` and a number (`PW=1.5`).
//! Comments `( )` and from `;`, block numbers, program numbers and `%` are no words; a `%` that does not begin the program
//! ends it. White space may stand anywhere but
//! inside a number or a name.

use crate::diagnostic::Report;
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
}

const NAMES: [(&str, Key); 5] = [
    ("BSPLINE", Key::Bspline),
    ("SD", Key::SplineDegree),
    ("PW", Key::PointWeight),
    ("PL", Key::IntervalLength),
    ("CR", Key::CircleRadius),
];

/// A word: what it addresses, its number and its place.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Word {
    pub(crate) key: Key,
    pub(crate) value: f64,
    pub(crate) span: Span,
}

/// Said of everything that is computed while a program runs.
const VARIABLES: &str = "variables and expressions are not evaluated";
const EXPAND: &str = "let the control or the post-processor write the program with plain numbers";

/// What is known of a program from the lines before.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Tape {
    /// A word or a `%` has been read, so that the next `%` ends the program.
    begun: bool,
}

/// The words of one line that begins at byte `start`, into `words`; the bytes that were read if a `%` ended the program.
pub(crate) fn words(
    report: &mut Report<'_>,
    lenient: bool,
    tape: &mut Tape,
    start: usize,
    line: &str,
    words: &mut Vec<Word>,
) -> Option<usize> {
    words.clear();
    let mut lexer = Lexer { report, lenient, start, line, at: 0, begun: tape.begun, ended: false };
    if lexer.peek() == Some(b'/') {
        let span = lexer.span(0, 1);
        lexer.report.warning(span, "optional block: read as if the switch were off");
        lexer.at = 1;
    }
    while lexer.word(words).is_some() {}
    tape.begun |= lexer.begun || !words.is_empty();
    lexer.ended.then_some(lexer.at)
}

/// Where in a line behind the end of a program something stands that is no comment and no delimiter.
pub(crate) fn remainder(start: usize, line: &str) -> Option<Span> {
    let mut aside = Report::new(Source::new("", ""));
    let mut found = Vec::new();
    words(&mut aside, false, &mut Tape::default(), start, line, &mut found);
    let whole = Span::new(start, start + line.trim_end().len());
    found.first().map(|word| word.span).or(aside.has_errors().then_some(whole))
}

struct Lexer<'r, 't, 'l> {
    report: &'r mut Report<'t>,
    lenient: bool,
    start: usize,
    line: &'l str,
    at: usize,
    /// See [`Tape`].
    begun: bool,
    ended: bool,
}

impl Lexer<'_, '_, '_> {
    fn peek(&self) -> Option<u8> {
        self.line.as_bytes().get(self.at).copied()
    }

    fn span(&self, from: usize, to: usize) -> Span {
        Span::new(self.start + from, self.start + to)
    }

    fn skip(&mut self, skipped: impl Fn(u8) -> bool) {
        while self.peek().is_some_and(&skipped) {
            self.at += 1;
        }
    }

    /// Reads one item of the line; `None` at its end.
    fn word(&mut self, words: &mut Vec<Word>) -> Option<()> {
        self.skip(|c| c.is_ascii_whitespace());
        let begin = self.at;
        match self.peek()? {
            b';' => None,
            b'%' => {
                self.at += 1;
                self.ended = self.begun || !words.is_empty();
                self.begun = true;
                (!self.ended).then_some(())
            }
            b'(' => self.comment(),
            c if c.is_ascii_alphabetic() || c == b'_' => self.address(begin, words),
            b'#' | b'[' | b']' | b'=' | b'$' | b'<' | b'>' => {
                self.refuse_rest(begin, VARIABLES, Some(EXPAND))
            }
            _ => {
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
        }
    }

    fn comment(&mut self) -> Option<()> {
        let begin = self.at;
        let Some(length) = self.line[begin..].find(')') else {
            let end = self.line.trim_end().len().max(begin + 1);
            self.report
                .error(self.span(begin, end), "this comment has no end")
                .expected("a `)` on the same line");
            return None;
        };
        self.at = begin + length + 1;
        Some(())
    }

    /// Says that the line from `begin` on is not read.
    fn refuse_rest(&mut self, begin: usize, message: &str, hint: Option<&str>) -> Option<()> {
        let end = begin + self.line[begin..].trim_end().len();
        let diagnostic = self.report.error(self.span(begin, end.max(begin + 1)), message);
        diagnostic.expected("words with plain numbers, such as X12.5");
        if let Some(hint) = hint {
            diagnostic.hint(hint);
        }
        None
    }

    fn address(&mut self, begin: usize, words: &mut Vec<Word>) -> Option<()> {
        self.skip(|c| c.is_ascii_alphabetic() || c == b'_');
        let name = &self.line[begin..self.at];
        let key = match name.as_bytes() {
            [letter] => Key::Letter(letter.to_ascii_uppercase()),
            _ => match NAMES.iter().find(|(known, _)| known.eq_ignore_ascii_case(name)) {
                Some((_, Key::Bspline)) => {
                    words.push(Word { key: Key::Bspline, value: 0.0, span: self.span(begin, self.at) });
                    return Some(());
                }
                Some((_, key)) => *key,
                None => return self.unknown_name(begin),
            },
        };
        self.number(begin, key, words)
    }

    /// The number of a word that begins at `begin`; the lexer stands behind its letter or name.
    fn number(&mut self, begin: usize, key: Key, words: &mut Vec<Word>) -> Option<()> {
        let name_end = self.at;
        self.skip(|c| c == b' ' || c == b'\t');
        let assigned = self.peek() == Some(b'=');
        if assigned {
            self.at += 1;
            self.skip(|c| c == b' ' || c == b'\t');
        }
        let digits = self.at;
        self.skip(is_number);
        let text = &self.line[digits..self.at];
        let name = &self.line[begin..name_end];
        match text.parse::<f64>() {
            Ok(value) if value.is_finite() => {
                if !matches!(key, Key::Letter(b'N' | b'O')) {
                    words.push(Word { key, value, span: self.span(begin, self.at) });
                }
            }
            _ if text.is_empty()
                && self
                    .peek()
                    .is_some_and(|c| b"#[$<".contains(&c) || assigned && c.is_ascii_alphabetic()) =>
            {
                return self.refuse_rest(begin, VARIABLES, Some(EXPAND));
            }
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

    /// A run of letters that is no name: letters without their numbers, or words of a control's language.
    fn unknown_name(&mut self, begin: usize) -> Option<()> {
        let name = self.line[begin..self.at].to_ascii_uppercase();
        const LANGUAGE: [&str; 14] = [
            "IF", "THEN", "ELSE", "GOTO", "GOTOF", "GOTOB", "WHILE", "DO", "END", "FOR", "DEF", "PROC",
            "SUB", "CALL",
        ];
        if LANGUAGE.contains(&name.as_str()) || name.starts_with('_') {
            return self.refuse_rest(begin, VARIABLES, Some(EXPAND));
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
            self.report.warning(span, message);
            self.skip(|c| c == b' ' || c == b'=');
            self.skip(is_number);
            return Some(());
        }
        let diagnostic = self.report.error(span, message);
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
