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
//! A variable that has no value is *vacant*. It counts as 0, except where it is compared with one that is vacant, too, such as FANUC's
//! `#0`.
//!
//! The grammar is small, spans of faults and white space within names are not, which is why no parser of another library is used.
//!
//! # Source
//! LinuxCNC, "Expressions", whose order of operators this is; FANUC Series 30i, B-63944EN/03, section 16.4; SINUMERIK 840D sl,
//! Programming Manual Job Planning, "Calculation functions".

use std::ops::Range;

use crate::arc::Plane;
use crate::gcode::modal::{FeedMode, Modal, Motion};
use crate::gcode::variables::{HIGHEST, Variable, Variables};
use crate::options::Dialect;

/// A value; `None` is that of a vacant variable.
pub(crate) type Value = Option<f64>;

/// Brackets within brackets; each takes some stack.
const MAX_DEPTH: usize = 64;
/// Values that LinuxCNC takes for equal differ by less.
const EQUAL: f64 = 1e-4;

/// What is wrong with an expression, and where in its line.
#[derive(Debug)]
pub(crate) struct Fault {
    pub(crate) place: Range<usize>,
    pub(crate) message: String,
    pub(crate) expected: &'static str,
}

/// What expressions read: the values of variables, and where the tool is.
#[derive(Clone, Copy)]
pub(crate) struct Scope<'a> {
    pub(crate) variables: &'a Variables,
    pub(crate) modal: &'a Modal,
    pub(crate) dialect: Option<Dialect>,
}

impl Scope<'_> {
    /// The value of a variable, or of what a control keeps under its name.
    pub(crate) fn get(&self, variable: &Variable) -> Value {
        self.variables.get(variable).or_else(|| match variable {
            Variable::Number(number) => self.kept_number(*number),
            Variable::Name(name) => self.kept_name(name),
            Variable::R(_) => Some(0.0),
        })
    }

    /// Where the tool is, by the numbers of LinuxCNC and FANUC, and the settings of LinuxCNC that have a number.
    fn kept_number(&self, number: u32) -> Value {
        let axis = |first: u32| self.modal.programmed((number - first) as usize);
        match number {
            5420..=5422 => Some(axis(5420)),
            5001..=5003 | 5021..=5023 | 5041..=5043 => Some(axis(number / 10 * 10 + 1)),
            // FANUC's words in force.
            4001..=4120 if self.dialect == Some(Dialect::Fanuc) => self.kept_word(number),
            5220 => Some(f64::from(self.modal.work_offset) + 1.0),
            1..=HIGHEST if self.dialect == Some(Dialect::LinuxCnc) => Some(0.0),
            _ => None,
        }
    }

    /// The number of the word in force of a group, as FANUC keeps it; `None` of groups that are not followed.
    fn kept_word(&self, number: u32) -> Value {
        let modal = self.modal;
        Some(match number {
            4001 => match modal.motion {
                Motion::Rapid => 0.0,
                Motion::Line => 1.0,
                Motion::Arc { clockwise: true } => 2.0,
                Motion::Arc { clockwise: false } => 3.0,
                _ => return None,
            },
            4002 => match modal.plane {
                Plane::Xy => 17.0,
                Plane::Zx => 18.0,
                Plane::Yz => 19.0,
            },
            4003 => 90.0 + f64::from(u8::from(modal.incremental)),
            4005 => match modal.feed_mode {
                FeedMode::InverseTime => 93.0,
                FeedMode::PerMinute => 94.0,
                FeedMode::PerRevolution => 95.0,
            },
            4006 => 21.0 - f64::from(u8::from(modal.inches)),
            4014 if modal.work_offset < 6 => 54.0 + f64::from(modal.work_offset),
            4109 => modal.feedrate_mm_per_s? * 60.0 / modal.mm(1.0),
            4119 => modal.spindle_per_minute?,
            _ => return None,
        })
    }

    /// LinuxCNC's predefined names.
    fn kept_name(&self, name: &str) -> Value {
        let (modal, truth) = (self.modal, |holds| f64::from(u8::from(holds)));
        let count = |calls: usize| u32::try_from(calls).map_or(0.0, f64::from);
        Some(match name {
            "_x" => modal.programmed(0),
            "_y" => modal.programmed(1),
            "_z" => modal.programmed(2),
            "_a" | "_b" | "_c" | "_u" | "_v" | "_w" | "_task" | "_remap_level" => 0.0,
            // Nothing has been returned.
            "_value" | "_value_returned" => 0.0,
            "_lathe_diameter_mode" => 0.0,
            "_lathe_radius_mode" => 1.0,
            "_ccomp" => 400.0,
            "_plane" => match modal.plane {
                Plane::Xy => 170.0,
                Plane::Zx => 180.0,
                Plane::Yz => 190.0,
            },
            "_motion_mode" => match modal.motion {
                Motion::None => 800.0,
                Motion::Rapid => 0.0,
                Motion::Line => 10.0,
                Motion::Arc { clockwise: true } => 20.0,
                Motion::Arc { clockwise: false } => 30.0,
                _ => return None,
            },
            "_inverse_time" => truth(modal.feed_mode == FeedMode::InverseTime),
            "_units_per_minute" => truth(modal.feed_mode == FeedMode::PerMinute),
            "_units_per_rev" => truth(modal.feed_mode == FeedMode::PerRevolution),
            "_ijk_absolute_mode" => truth(modal.absolute_centres),
            "_rpm" => modal.spindle_per_minute.unwrap_or(0.0),
            "_call_level" => count(self.variables.calls),
            "_metric" => truth(!modal.inches),
            "_imperial" => truth(modal.inches),
            "_absolute" => truth(!modal.incremental),
            "_incremental" => truth(modal.incremental),
            "_feed" => modal.feedrate_mm_per_s.unwrap_or(0.0) * 60.0 / modal.mm(1.0),
            "_coord_system" if modal.work_offset > 5 => 585.0 + f64::from(modal.work_offset),
            "_coord_system" => 540.0 + 10.0 * f64::from(modal.work_offset),
            "_vmajor" => 2.9,
            "_vminor" => 0.0,
            _ => return None,
        })
    }
}

/// Reads expressions of one line, from a byte on.
pub(crate) struct Parser<'a> {
    pub(crate) line: &'a str,
    pub(crate) at: usize,
    pub(crate) scope: Scope<'a>,
    /// Round brackets group, as Siemens writes them; elsewhere they hold comments.
    pub(crate) is_round: bool,
    depth: usize,
}

type Parsed<T> = Result<T, Fault>;

/// An operator of two values.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Operator {
    Power,
    Times,
    Over,
    Modulo,
    WholeQuotient,
    Plus,
    Minus,
    Equal,
    Unequal,
    Greater,
    AtLeast,
    Less,
    AtMost,
    And,
    Or,
    ExclusiveOr,
}

/// The operators as they are written, longer ones before those that begin them, each with how strongly it binds.
const OPERATORS: [(&str, Operator, u8); 24] = [
    ("**", Operator::Power, 5),
    ("*", Operator::Times, 4),
    ("/", Operator::Over, 4),
    ("MOD", Operator::Modulo, 4),
    ("DIV", Operator::WholeQuotient, 4),
    ("+", Operator::Plus, 3),
    ("-", Operator::Minus, 3),
    ("EQ", Operator::Equal, 2),
    ("NE", Operator::Unequal, 2),
    ("GT", Operator::Greater, 2),
    ("GE", Operator::AtLeast, 2),
    ("LT", Operator::Less, 2),
    ("LE", Operator::AtMost, 2),
    ("==", Operator::Equal, 2),
    ("<>", Operator::Unequal, 2),
    (">=", Operator::AtLeast, 2),
    ("<=", Operator::AtMost, 2),
    (">", Operator::Greater, 2),
    ("<", Operator::Less, 2),
    ("AND", Operator::And, 1),
    ("XOR", Operator::ExclusiveOr, 1),
    ("OR", Operator::Or, 1),
    ("&&", Operator::And, 1),
    ("||", Operator::Or, 1),
];

/// How strongly an operator binds.
fn strength_of(operator: Operator) -> u8 {
    OPERATORS.iter().find(|(_, one, _)| *one == operator).map_or(0, |(_, _, strength)| *strength)
}

/// A number whose bits FANUC combines.
fn bits(value: f64) -> Option<u32> {
    #[allow(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "whole, within u32")]
    ((0.0..=f64::from(u32::MAX)).contains(&value) && value.fract() == 0.0).then_some(value as u32)
}

/// The functions of one value.
const FUNCTIONS: [&str; 18] = [
    "ABS", "ACOS", "ASIN", "ATAN", "ATAN2", "COS", "EXISTS", "EXP", "FIX", "FUP", "LN", "NOT", "POT",
    "ROUND", "SIN", "SQRT", "TAN", "TRUNC",
];

/// Whether a run of letters is a function.
pub(crate) fn is_function(name: &str) -> bool {
    FUNCTIONS.iter().any(|function| function.eq_ignore_ascii_case(name))
}

impl<'a> Parser<'a> {
    /// A parser that stands at byte `at` of a line.
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

    /// Takes a byte if it is the next one.
    fn takes(&mut self, byte: u8) -> bool {
        let is_next = self.peek() == Some(byte);
        self.at += usize::from(is_next);
        is_next
    }

    /// An expression with operators, up to where it does not go on.
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

    /// Operators that bind at least as strongly as `least`.
    fn binary(&mut self, least: u8) -> Parsed<Value> {
        let mut value = self.operand()?;
        while let Some((operator, strength, end)) =
            self.operator().filter(|(_, strength, _)| *strength >= least)
        {
            let begin = self.at;
            self.at = end;
            let other = self.binary(strength + 1)?;
            value = self
                .apply(operator, value, other)
                .or_else(|(message, expected)| self.fault(begin, message, expected))?;
        }
        Ok(value)
    }

    /// The operator that stands next, with how strongly it binds and where it ends; it is not taken.
    fn operator(&mut self) -> Option<(Operator, u8, usize)> {
        self.peek()?;
        let rest = &self.line.as_bytes()[self.at..];
        OPERATORS.iter().find_map(|(text, operator, strength)| {
            let is_next =
                rest.len() >= text.len() && rest[..text.len()].eq_ignore_ascii_case(text.as_bytes());
            let strength = match operator {
                Operator::And if self.is_of_bits() => strength_of(Operator::Times),
                Operator::Or | Operator::ExclusiveOr if self.is_of_bits() => strength_of(Operator::Plus),
                _ => *strength,
            };
            is_next.then_some((*operator, strength, self.at + text.len()))
        })
    }

    /// Whether AND, OR and XOR are FANUC's.
    fn is_of_bits(&self) -> bool {
        self.scope.dialect == Some(Dialect::Fanuc)
    }

    fn apply(&self, operator: Operator, a: Value, b: Value) -> Result<Value, (&'static str, &'static str)> {
        let (x, y) = (a.unwrap_or(0.0), b.unwrap_or(0.0));
        let truth = |holds: bool| f64::from(u8::from(holds));
        let is_equal = match self.scope.dialect {
            _ if a.is_none() || b.is_none() => a == b,
            Some(Dialect::Fanuc | Dialect::Siemens) => x == y,
            _ => (x - y).abs() < EQUAL,
        };
        let value = match operator {
            Operator::Power if x < 0.0 && y.fract() != 0.0 => {
                return Err(("a root of a negative number", "a number of at least 0 before `**`"));
            }
            Operator::Over | Operator::Modulo | Operator::WholeQuotient if y == 0.0 => {
                return Err(("a division by 0", "a divisor other than 0"));
            }
            Operator::Power => x.powf(y),
            Operator::Times => x * y,
            Operator::Over => x / y,
            Operator::Modulo => x.rem_euclid(y.abs()),
            Operator::WholeQuotient => (x / y).trunc(),
            Operator::Plus => x + y,
            Operator::Minus => x - y,
            Operator::Equal => truth(is_equal),
            Operator::Unequal => truth(!is_equal),
            Operator::Greater => truth(x > y),
            Operator::AtLeast => truth(x >= y),
            Operator::Less => truth(x < y),
            Operator::AtMost => truth(x <= y),
            Operator::And | Operator::Or | Operator::ExclusiveOr if self.is_of_bits() => {
                let (Some(x), Some(y)) = (bits(x), bits(y)) else {
                    return Err((
                        "bits of a number that is not whole, or negative",
                        "whole numbers from 0 on",
                    ));
                };
                f64::from(match operator {
                    Operator::And => x & y,
                    Operator::Or => x | y,
                    _ => x ^ y,
                })
            }
            Operator::And => truth(x != 0.0 && y != 0.0),
            Operator::Or => truth(x != 0.0 || y != 0.0),
            Operator::ExclusiveOr => truth((x != 0.0) != (y != 0.0)),
        };
        if value.is_finite() {
            Ok(Some(value))
        } else {
            Err(("a result beyond all numbers", "a smaller one"))
        }
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
        let text = &self.line[begin..self.at];
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
                format!("there is no variable {number}"),
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
                self.function(&name, x)
                    .or_else(|expected| self.fault(begin, format!("{name} of {x} is no number"), expected))
            }
        }
    }

    fn function(&self, name: &str, x: f64) -> Result<Value, &'static str> {
        let is_fanuc = self.scope.dialect == Some(Dialect::Fanuc);
        let value = match name {
            "ABS" => x.abs(),
            "ACOS" if x.abs() > 1.0 => return Err("a number of -1 to 1"),
            "ASIN" if x.abs() > 1.0 => return Err("a number of -1 to 1"),
            "ACOS" => x.acos().to_degrees(),
            "ASIN" => x.asin().to_degrees(),
            "COS" => x.to_radians().cos(),
            "EXP" => x.exp(),
            "FIX" if is_fanuc => x.trunc(),
            "FIX" => x.floor(),
            "FUP" if is_fanuc => x.abs().ceil().copysign(x),
            "FUP" => x.ceil(),
            "LN" if x <= 0.0 => return Err("a number above 0"),
            "LN" => x.ln(),
            "POT" => x * x,
            "ROUND" => x.round(),
            "SIN" => x.to_radians().sin(),
            "SQRT" if x < 0.0 => return Err("a number of at least 0"),
            "SQRT" => x.sqrt(),
            "TAN" => x.to_radians().tan(),
            _ => x.trunc(),
        };
        if value.is_finite() { Ok(Some(value)) } else { Err("a smaller number") }
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
