//! Expressions of a program: `[#1 + 2 * SIN[30]]` of LinuxCNC and FANUC, `R1 + 2 * SIN(30)` of Siemens.
//!
//! From the operators that bind most to those that bind least:
//!
//! | operators | |
//! |---|---|
//! | `**` | power, of LinuxCNC |
//! | `*` `/` `MOD` `DIV` | `MOD` is never negative |
//! | `+` `-` | |
//! | `EQ` `NE` `GT` `GE` `LT` `LE`, of Siemens `==` `<>` `>` `>=` `<` `<=` | 1 or 0; LinuxCNC takes values for equal that are less than 0.0001 apart |
//! | `AND` `OR` `XOR` | of what is not 0; FANUC's are those of the bits, and bind as `*` (`AND`) and as `+` do |
//!
//! Functions: `ABS` `ACOS` `ASIN` `ATAN[y]/[x]` `COS` `EXISTS` `EXP` `FIX` `FUP` `LN` `ROUND` `SIN` `SQRT` `TAN`, of Siemens `ATAN2(y, x)`
//! `POT` and `TRUNC`; angles are in degrees. `FIX` goes to the next lower whole number and `FUP` to the next higher one, of FANUC toward
//! 0 and away from it.
//!
//! A variable without a value is *vacant*. It counts as 0, except in a comparison with another vacant variable, such as
//! FANUC's `#0`.
//!
//! No parser library is used: the grammar is small, and most of the work is spans of faults and white space within
//! names.
//!
//! # Source
//! LinuxCNC, "Expressions", whose order of operators this is; FANUC Series 30i, B-63944EN/03, section 16.4; SINUMERIK 840D sl,
//! Programming Manual Job Planning, "Calculation functions".

use std::ops::Range;

use domains::shown;

use crate::diagnostic::Report;
use crate::gcode::function::{function, is_function};
use crate::gcode::operator::{EQUAL, Operator};
use crate::gcode::scope::Scope;
use crate::gcode::variables::{HIGHEST, Value, Variable};
use crate::options::Dialect;
use crate::source::Span;

/// Most brackets within brackets; each takes some stack.
const MAX_DEPTH: usize = 64;
/// The fault of an expression, with its place in the line.
#[derive(Debug)]
pub(crate) struct Fault {
    pub(crate) place: Range<usize>,
    pub(crate) message: String,
    pub(crate) expected: &'static str,
}

impl Fault {
    /// Reports the fault; the line begins at byte `start`.
    pub(crate) fn say(self, report: &mut Report<'_>, start: usize) {
        let span = Span::new(start + self.place.start, start + self.place.end);
        report.error(span, self.message).expected(self.expected);
    }
}

/// A parser of the expressions of one line, from a byte on.
pub(crate) struct Parser<'a> {
    pub(crate) line: &'a str,
    pub(crate) at: usize,
    pub(crate) scope: Scope<'a>,
    /// Whether round brackets group, as Siemens writes them; otherwise they hold comments.
    pub(crate) is_round: bool,
    depth: usize,
}

type Parsed<T> = Result<T, Fault>;

impl<'a> Parser<'a> {
    /// A parser at byte `at` of a line.
    pub(crate) fn new(line: &'a str, at: usize, scope: Scope<'a>, is_round: bool) -> Self {
        Self { line, at, scope, is_round, depth: 0 }
    }

    /// The next byte that is neither white space nor in a comment.
    pub(crate) fn peek(&mut self) -> Option<u8> {
        loop {
            match self.line.as_bytes().get(self.at)? {
                c if c.is_ascii_whitespace() => self.at += 1,
                b'(' if !self.is_round => match self.line[self.at..].find(')') {
                    Some(length) => self.at += length + 1,
                    None => return None,
                },
                c => return Some(*c),
            }
        }
    }

    fn fault<T>(&self, begin: usize, message: impl Into<String>, expected: &'static str) -> Parsed<T> {
        let end = self.at.max(begin + 1).min(self.line.len().max(begin + 1));
        Err(Fault { place: begin..end, message: message.into(), expected })
    }

    /// Consumes a byte if it is the next one.
    fn takes(&mut self, byte: u8) -> bool {
        let is_next = self.peek() == Some(byte);
        self.at += usize::from(is_next);
        is_next
    }

    /// An expression with operators, as long as it goes on.
    pub(crate) fn expression(&mut self) -> Parsed<Value> {
        self.binary(1)
    }

    /// `[expression]`.
    pub(crate) fn bracketed(&mut self) -> Parsed<Value> {
        self.brackets(false).map(|(value, _)| value)
    }

    /// `[expression]`, or `[first, second]` where a function takes two.
    fn brackets(&mut self, may_be_two: bool) -> Parsed<(Value, Option<Value>)> {
        let is_open = matches!(self.peek(), Some(b'[')) || self.is_round && self.peek() == Some(b'(');
        let begin = self.at;
        if !is_open {
            return self.fault(begin, "an expression without a bracket", "`[`");
        }
        let close = if self.line.as_bytes()[begin] == b'[' { b']' } else { b')' };
        self.at += 1;
        if self.depth == MAX_DEPTH {
            return self.fault(
                begin,
                format!("more than {MAX_DEPTH} brackets within one another"),
                "fewer brackets",
            );
        }
        self.depth += 1;
        let value = self.expression()?;
        let second = if may_be_two && self.takes(b',') { Some(self.expression()?) } else { None };
        self.depth -= 1;
        if !self.takes(close) {
            let place = self.at;
            self.at = place + self.line[place..].chars().next().map_or(0, char::len_utf8);
            return self.fault(
                place.min(self.line.len()),
                "the bracket of this expression is not closed here",
                "`]` or an operator",
            );
        }
        Ok((value, second))
    }

    /// The next operator, with its precedence and its end. It is not consumed.
    fn operator(&mut self) -> Option<(Operator, u8, usize)> {
        self.peek()?;
        let rest = &self.line.as_bytes()[self.at..];
        let (operator, strength, length) = Operator::next(rest, self.scope.dialect)?;
        Some((operator, strength, self.at + length))
    }

    /// Evaluates operators that bind at least as strongly as `least`.
    fn binary(&mut self, least: u8) -> Parsed<Value> {
        let mut value = self.operand()?;
        while let Some((operator, strength, end)) =
            self.operator().filter(|(_, strength, _)| *strength >= least)
        {
            let begin = self.at;
            self.at = end;
            let other = self.binary(strength + 1)?;
            value = operator
                .apply(self.scope.dialect, value, other)
                .or_else(|(message, expected)| self.fault(begin, message, expected))?;
        }
        Ok(value)
    }

    /// A number, a variable, a function or brackets, with signs before it.
    pub(crate) fn operand(&mut self) -> Parsed<Value> {
        let mut is_negative = false;
        while let Some(sign @ (b'-' | b'+')) = self.peek() {
            is_negative ^= sign == b'-';
            self.at += 1;
        }
        let value = match self.peek() {
            Some(b'#') => self.variable().and_then(|(variable, place)| self.read(&variable, place)),
            Some(b'[') => self.bracketed(),
            Some(b'(') if self.is_round => self.bracketed(),
            Some(c) if c.is_ascii_digit() || c == b'.' => self.number().map(Some),
            Some(c) if c.is_ascii_alphabetic() => self.named(),
            _ => {
                let begin = self.at;
                self.fault(begin, "a value is missing here", "a number, a variable, a function or `[`")
            }
        }?;
        Ok(if is_negative { Some(-value.unwrap_or(0.0)) } else { value })
    }

    fn number(&mut self) -> Parsed<f64> {
        let begin = self.at;
        let is_digit = |c: &&u8| c.is_ascii_digit() || **c == b'.';
        self.at += self.line.as_bytes()[begin..].iter().take_while(is_digit).count();
        let mut text = std::borrow::Cow::from(&self.line[begin..self.at]);
        // LinuxCNC passes over white space between digits.
        while self.scope.dialect == Some(Dialect::LinuxCnc) {
            let rest = self.line[self.at..].trim_start_matches([' ', '\t']);
            let digits = rest.bytes().take_while(|c| is_digit(&c)).count();
            if digits == 0 {
                break;
            }
            text.to_mut().push_str(&rest[..digits]);
            self.at = self.line.len() - rest.len() + digits;
        }
        match text.parse::<f64>() {
            Ok(value) if value.is_finite() => Ok(value),
            _ => self.fault(begin, format!("`{text}` is no number"), "digits with at most one point"),
        }
    }

    /// `#5`, `##5`, `#[…]` or `#<name>`; `R5` or `R[…]` where round brackets group.
    pub(crate) fn variable(&mut self) -> Parsed<(Variable, Range<usize>)> {
        self.peek();
        let begin = self.at;
        let is_r = self.line.as_bytes().get(begin).is_some_and(|c| c.eq_ignore_ascii_case(&b'R'));
        self.at += 1;
        if self.peek() == Some(b'<') {
            let Some(length) = self.line[self.at..].find('>') else {
                return self.fault(begin, "the name of this variable has no end", "`>`");
            };
            let name: String =
                self.line[self.at + 1..self.at + length].chars().filter(|c| !c.is_whitespace()).collect();
            self.at += length + 1;
            return Ok((Variable::Name(name.to_lowercase().into()), begin..self.at));
        }
        if self.depth == MAX_DEPTH {
            return self.fault(
                begin,
                format!("more than {MAX_DEPTH} variables within one another"),
                "fewer of them",
            );
        }
        self.depth += 1;
        let number = match self.peek() {
            Some(c) if c.is_ascii_digit() => self.number()?,
            _ => self.operand()?.unwrap_or(0.0),
        };
        self.depth -= 1;
        let whole = number.round();
        if (number - whole).abs() > EQUAL || !(0.0..=f64::from(HIGHEST)).contains(&whole) {
            return self.fault(
                begin,
                format!("there is no variable {}", shown(number)),
                "a whole number of 0 to 99999",
            );
        }
        #[allow(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "0 ..= HIGHEST")]
        let number = whole as u32;
        Ok((if is_r { Variable::R(number) } else { Variable::Number(number) }, begin..self.at))
    }

    fn read(&self, variable: &Variable, place: Range<usize>) -> Parsed<Value> {
        match (variable, self.scope.get(variable)) {
            (Variable::Name(name), None) => Err(Fault {
                place,
                message: format!("`#<{name}>` has no value"),
                expected: "a block before this one that gives it one",
            }),
            (_, value) => Ok(value),
        }
    }

    /// A function with its value in brackets, or Siemens' `R5`.
    fn named(&mut self) -> Parsed<Value> {
        let begin = self.at;
        let bytes = &self.line.as_bytes()[begin..];
        let letters = bytes.iter().take_while(|c| c.is_ascii_alphabetic()).count();
        if letters == 1 && bytes[0].eq_ignore_ascii_case(&b'R') && self.is_round {
            return self.variable().and_then(|(variable, place)| self.read(&variable, place));
        }
        let is_atan2 =
            bytes.len() > letters && bytes[..letters].eq_ignore_ascii_case(b"ATAN") && bytes[letters] == b'2';
        self.at += letters + usize::from(is_atan2);
        let name = self.line[begin..self.at].to_ascii_uppercase();
        if !is_function(&name) {
            return self.fault(
                begin,
                format!("`{name}` is no function"),
                "ABS, ACOS, ASIN, ATAN, COS, EXISTS, EXP, FIX, FUP, LN, ROUND, SIN, SQRT or TAN",
            );
        }
        match name.as_str() {
            "EXISTS" => self.exists(),
            "ATAN" => self.atan(),
            "ATAN2" => self.two_in_brackets().map(|(y, x)| Some(y.atan2(x).to_degrees())),
            "NOT" => {
                let x = self.bracketed()?.unwrap_or(0.0);
                Ok(Some(f64::from(u8::from(x == 0.0))))
            }
            _ => {
                let x = self.bracketed()?.unwrap_or(0.0);
                function(&name, x, self.scope.dialect).or_else(|expected| {
                    self.fault(begin, format!("{name} of {} is no number", shown(x)), expected)
                })
            }
        }
    }

    /// `EXISTS[#<name>]`.
    fn exists(&mut self) -> Parsed<Value> {
        let begin = self.at;
        if !(self.takes(b'[') && self.peek() == Some(b'#')) {
            return self.fault(begin, "EXISTS without a variable", "[#<name>]");
        }
        let (variable, _) = self.variable()?;
        if !self.takes(b']') {
            return self.fault(begin, "EXISTS without its closing bracket", "]");
        }
        Ok(Some(f64::from(u8::from(self.scope.get(&variable).is_some()))))
    }

    /// `ATAN[y]/[x]`, of FANUC also `ATAN[y, x]` and `ATAN[y]`.
    fn atan(&mut self) -> Parsed<Value> {
        let begin = self.at;
        let (y, x) = self.brackets(true)?;
        let y = y.unwrap_or(0.0);
        if let Some(x) = x {
            return Ok(Some(y.atan2(x.unwrap_or(0.0)).to_degrees()));
        }
        if self.peek() != Some(b'/') {
            return Ok(Some(y.atan().to_degrees()));
        }
        self.at += 1;
        if self.peek() != Some(b'[') {
            return self.fault(begin, "ATAN[y] divided by what is not in brackets", "ATAN[y]/[x]");
        }
        let x = self.bracketed()?.unwrap_or(0.0);
        Ok(Some(y.atan2(x).to_degrees()))
    }

    /// `[first, second]`.
    fn two_in_brackets(&mut self) -> Parsed<(f64, f64)> {
        let begin = self.at;
        let close = if self.peek() == Some(b'[') { b']' } else { b')' };
        if self.depth == MAX_DEPTH || !(self.takes(b'[') || self.is_round && self.takes(b'(')) {
            return self.fault(begin, "a function of two values without brackets", "(y, x)");
        }
        self.depth += 1;
        let first = self.expression()?.unwrap_or(0.0);
        if !self.takes(b',') {
            return self.fault(begin, "a function of two values with one", "(y, x)");
        }
        let second = self.expression()?.unwrap_or(0.0);
        self.depth -= 1;
        if !self.takes(close) {
            return self.fault(begin, "a function without its closing bracket", "(y, x)");
        }
        Ok((first, second))
    }
}
