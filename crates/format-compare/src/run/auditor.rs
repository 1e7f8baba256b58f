//! What keeps the numbers of an audited run: each signal by its name, or the range of all.

use real::{Audit, Extremes};

/// A record of what audited numbers meet.
pub(crate) trait Auditor: Send + Sized {
    /// Whether periods may be left out whose numbers all lie between those of two that are made, and lose nothing.
    const LEAVES_OUT: bool;

    /// Runs `work`, and keeps what the numbers of this thread met meanwhile.
    fn of<T>(work: impl FnOnce() -> T) -> (T, Self);

    /// Adds what another part of the same run met.
    fn join(&mut self, other: Self);
}

impl Auditor for Audit {
    const LEAVES_OUT: bool = false;

    fn of<T>(work: impl FnOnce() -> T) -> (T, Self) {
        Audit::of(work)
    }

    fn join(&mut self, other: Self) {
        Audit::join(self, other);
    }
}

impl Auditor for Extremes {
    const LEAVES_OUT: bool = true;

    fn of<T>(work: impl FnOnce() -> T) -> (T, Self) {
        Extremes::of(work)
    }

    fn join(&mut self, other: Self) {
        Extremes::join(self, other);
    }
}
