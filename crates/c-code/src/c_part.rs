//! What becomes C.

use secant_interp::{CompiledPath, FeedOverride};

use crate::name::CName;

/// A path and its plan that become C.
#[derive(Clone, Debug)]
pub struct CPart<'a, R, const D: usize> {
    /// The begin of all public names.
    pub name: CName,
    /// What the files are of, in a line: any text, of which a comment gets what it can hold.
    pub about: String,
    /// Why the run is not good enough, in a comment likewise; `None` if it is.
    pub fault: Option<String>,
    /// Path and plan.
    pub path: &'a CompiledPath<R, D>,
    /// T, in s.
    pub period_s: f64,
    /// The run from begin to end.
    pub run: ExpectedRun,
    /// Feed override, if the files shall have it.
    pub feed_override: Option<COverride>,
}

/// Feed override of a part.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct COverride {
    /// How fast the rate may change.
    pub feeds: FeedOverride,
    /// The share of the plan's own speed at which the feed is the commanded one, 100 %.
    pub commanded: f64,
}

/// What a self-test compares with.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct ExpectedRun {
    /// The number of setpoints.
    pub periods: usize,
    /// Their [`PositionChecksum`](secant_interp::PositionChecksum).
    pub checksum: u64,
}
