//! Operators of expressions: their names, their precedence, and their results.

use crate::gcode::variables::Value;
use crate::options::Dialect;

/// LinuxCNC takes two values for equal if they differ by less.
pub(crate) const EQUAL: f64 = 1e-4;

/// An operator of two values.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum Operator {
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

/// The names of the operators with their precedence. A longer name comes before one with which it begins.
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

/// The precedence of an operator.
fn strength_of(operator: Operator) -> u8 {
    OPERATORS.iter().find(|(_, one, _)| *one == operator).map_or(0, |(_, _, strength)| *strength)
}

impl Operator {
    /// The operator at the begin of a text, by the rules of a control, with its precedence and its length.
    pub(crate) fn next(rest: &[u8], dialect: Option<Dialect>) -> Option<(Self, u8, usize)> {
        OPERATORS.iter().find_map(|(text, operator, strength)| {
            let is_next =
                rest.len() >= text.len() && rest[..text.len()].eq_ignore_ascii_case(text.as_bytes());
            let strength = match operator {
                Self::And if is_of_bits(dialect) => strength_of(Self::Times),
                Self::Or | Self::ExclusiveOr if is_of_bits(dialect) => strength_of(Self::Plus),
                _ => *strength,
            };
            is_next.then_some((*operator, strength, text.len()))
        })
    }

    /// The result of the operator for two values, by the rules of a control; the error has the fault and the expected
    /// values.
    pub(crate) fn apply(
        self,
        dialect: Option<Dialect>,
        a: Value,
        b: Value,
    ) -> Result<Value, (&'static str, &'static str)> {
        let (x, y) = (a.unwrap_or(0.0), b.unwrap_or(0.0));
        let truth = |holds: bool| f64::from(u8::from(holds));
        let is_equal = match dialect {
            _ if a.is_none() || b.is_none() => a == b,
            Some(Dialect::Fanuc | Dialect::Siemens) => x == y,
            _ => (x - y).abs() < EQUAL,
        };
        let value = match self {
            Self::Power if x < 0.0 && y.fract() != 0.0 => {
                return Err(("a root of a negative number", "a number of at least 0 before `**`"));
            }
            Self::Over | Self::Modulo | Self::WholeQuotient if y == 0.0 => {
                return Err(("a division by 0", "a divisor other than 0"));
            }
            Self::Power => x.powf(y),
            Self::Times => x * y,
            Self::Over => x / y,
            Self::Modulo => x.rem_euclid(y.abs()),
            Self::WholeQuotient => (x / y).trunc(),
            Self::Plus => x + y,
            Self::Minus => x - y,
            Self::Equal => truth(is_equal),
            Self::Unequal => truth(!is_equal),
            Self::Greater => truth(x > y),
            Self::AtLeast => truth(x >= y),
            Self::Less => truth(x < y),
            Self::AtMost => truth(x <= y),
            Self::And | Self::Or | Self::ExclusiveOr if is_of_bits(dialect) => {
                let (Some(x), Some(y)) = (bits(x), bits(y)) else {
                    return Err((
                        "bits of a number that is not whole, or negative",
                        "whole numbers from 0 on",
                    ));
                };
                f64::from(match self {
                    Self::And => x & y,
                    Self::Or => x | y,
                    _ => x ^ y,
                })
            }
            Self::And => truth(x != 0.0 && y != 0.0),
            Self::Or => truth(x != 0.0 || y != 0.0),
            Self::ExclusiveOr => truth((x != 0.0) != (y != 0.0)),
        };
        if value.is_finite() {
            Ok(Some(value))
        } else {
            Err(("a result beyond all numbers", "a smaller one"))
        }
    }
}

/// Whether AND, OR and XOR are FANUC's.
fn is_of_bits(dialect: Option<Dialect>) -> bool {
    dialect == Some(Dialect::Fanuc)
}

/// A number whose bits FANUC combines.
fn bits(value: f64) -> Option<u32> {
    #[allow(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "whole, within u32")]
    ((0.0..=f64::from(u32::MAX)).contains(&value) && value.fract() == 0.0).then_some(value as u32)
}
