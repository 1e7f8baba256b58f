//! The end of a command.

/// The result of a command that did not fail.
#[derive(Clone, Copy, PartialEq, Eq)]
pub(crate) enum Ending {
    /// Every stated requirement is met.
    Good,
    /// A stated requirement is not met.
    RequirementNotMet,
    /// The input is bad; every error was printed.
    Refused,
    /// Ctrl-C has ended the work; what was finished is printed.
    Interrupted,
}
