//! The end of a command.

use crate::interrupt;

/// The result of a command that did not fail.
#[derive(Clone, Copy, PartialEq, Eq)]
pub(crate) enum Ending {
    /// Every stated requirement is met.
    Good,
    /// A stated requirement is not met.
    RequirementNotMet,
    /// The input is bad; every error was printed.
    Refused,
    /// Every stated requirement is met, and a figure is worse than the baseline's.
    WorseThanBaseline,
    /// Every stated requirement is met, and parts of a set cannot be read or run.
    PartsRefused,
    /// Ctrl-C has ended the work; what was finished is printed.
    Interrupted,
}

impl Ending {
    /// The exit status, as the book's page on it has them.
    pub(crate) fn status(self) -> u8 {
        match self {
            Self::Good => 0,
            Self::RequirementNotMet => 1,
            Self::Refused => 2,
            Self::WorseThanBaseline => 3,
            Self::PartsRefused => 4,
            Self::Interrupted => interrupt::STATUS,
        }
    }
}
