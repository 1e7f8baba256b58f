//! How a command ends.

/// How a command that did not fail ended.
#[derive(Clone, Copy, PartialEq, Eq)]
pub(crate) enum Ending {
    /// Every stated requirement is met.
    Good,
    /// One is not.
    RequirementNotMet,
}
