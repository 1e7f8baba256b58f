//! The outcome of a run whose promises are checked.

/// The result of a run that broke no promise.
#[derive(Clone, Debug, PartialEq)]
pub enum Outcome<F> {
    /// The run reached its end.
    Ran(F),
    /// The path was refused: the reason, in words.
    Refused(String),
}
