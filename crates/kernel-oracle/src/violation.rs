//! A broken promise.

use std::fmt;

/// A promise that was broken, with the figure and its bound.
#[derive(Clone, Debug, PartialEq)]
pub struct Violation {
    /// The promise.
    pub what: &'static str,
    /// The format, where it matters.
    pub format: String,
    /// Number of the step, of the sample, or of the piece.
    pub step: usize,
    /// The figure.
    pub value: f64,
    /// The bound of the figure.
    pub bound: f64,
}

impl fmt::Display for Violation {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self { what, format, step, value, bound } = self;
        write!(f, "{what} in {format}, step {step}: {value:e} is above {bound:e}")
    }
}

impl std::error::Error for Violation {}

/// The figure of one promise as a share of its bound.
///
/// # Errors
/// A figure above its bound.
pub fn demand(
    what: &'static str,
    format: &str,
    step: usize,
    value: f64,
    bound: f64,
) -> Result<f64, Violation> {
    if value <= bound {
        return Ok(if bound > 0.0 { value / bound } else { 0.0 });
    }
    Err(Violation { what, format: format.to_string(), step, value, bound })
}
