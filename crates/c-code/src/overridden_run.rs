//! A run with feed override, whose result the self-test compares.

use real::Backend;
use secant_interp::{CompiledPath, FeedOverride};

/// A new rate from some period on.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct RateCommand {
    /// The number of setpoints before it.
    pub period: usize,
    /// The rate, in units of 2⁻³².
    pub rate: u64,
}

/// A run at changing rates.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct OverriddenRun {
    /// What is commanded.
    pub commands: Vec<RateCommand>,
    /// The number of setpoints.
    pub periods: usize,
    /// Their checksum.
    pub checksum: u64,
    /// The commands in words.
    pub sentence: String,
}

impl OverriddenRun {
    /// Runs the path.
    pub(crate) fn of<R: Backend, const D: usize>(
        _path: &CompiledPath<R, D>,
        _feeds: &FeedOverride,
        _periods: usize,
    ) -> Self {
        Self { commands: Vec::new(), periods: 0, checksum: 0, sentence: String::new() }
    }
}
