//! Functions of expressions that take one number; angles are in degrees.

use crate::gcode::variables::Value;
use crate::options::Dialect;

/// The functions of one value.
const FUNCTIONS: [&str; 18] = [
    "ABS", "ACOS", "ASIN", "ATAN", "ATAN2", "COS", "EXISTS", "EXP", "FIX", "FUP", "LN", "NOT", "POT",
    "ROUND", "SIN", "SQRT", "TAN", "TRUNC",
];

/// Whether a run of letters is a function.
pub(crate) fn is_function(name: &str) -> bool {
    FUNCTIONS.iter().any(|function| function.eq_ignore_ascii_case(name))
}

/// A function of one number, by the rules of a control; the error is the range of numbers that it accepts.
pub(crate) fn function(name: &str, x: f64, dialect: Option<Dialect>) -> Result<Value, &'static str> {
    let is_fanuc = dialect == Some(Dialect::Fanuc);
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
