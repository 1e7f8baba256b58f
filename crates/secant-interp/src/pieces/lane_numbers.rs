//! The numbers of all lanes that a common step needs, side by side.

use real::Real;

use crate::pieces::state::CUBIC;
use crate::pieces::trend::Trend;

/// One number of each lane.
pub(crate) type Row<T, const W: usize> = [T; W];

/// The integers of the lanes.
#[derive(Clone, Debug)]
#[repr(C, align(64))] // A row does not straddle the lines of the cache.
pub(crate) struct Words<const W: usize> {
    /// Each lane's phase on its piece.
    pub(crate) phase: Row<u64, W>,
    /// The periods that are left of those for which the lane has distances; [`NONE`] after a period for which it had
    /// none.
    pub(crate) left: Row<u64, W>,
    /// The middle of the period after the next, as a fraction of the stage, and the increment of that per period: each
    /// is a phase and its lower word.
    pub(crate) middle: [Row<u64, W>; 2],
    pub(crate) period: [Row<u64, W>; 2],
    /// Whether the step was a common one.
    pub(crate) is_common: Row<bool, W>,
}

/// A count of periods that is one less than 0.
pub(crate) const NONE: u64 = u64::MAX;

/// The numbers of the lanes.
#[derive(Clone, Debug)]
#[repr(C, align(64))] // A row does not straddle the lines of the cache.
pub(crate) struct Numbers<R, const D: usize, const W: usize> {
    /// σ of the last steps: the newest, its rise, and the fall expected for the next one.
    pub(crate) newest: Row<R, W>,
    pub(crate) rise: Row<R, W>,
    pub(crate) fall: Row<R, W>,
    pub(crate) chord: [[Row<R, W>; D]; CUBIC],
    pub(crate) offset: [Row<R, W>; D],
    /// n_1 to n_3 of the pieces, and the least and greatest step per chord.
    pub(crate) numerator: [[Row<R, W>; D]; CUBIC],
    pub(crate) range: [Row<R, W>; 2],
    /// For the stages, the share of a period, the feed at the begin and its change.
    pub(crate) share: Row<R, W>,
    pub(crate) feed: Row<R, W>,
    pub(crate) change: Row<R, W>,
    /// The place in the stage at the middle of the next period.
    pub(crate) time: Row<R, W>,
    /// The distance of the period.
    pub(crate) length: Row<R, W>,
    /// Each lane's place on its piece, and the place from which on a guess is not tried; [`nowhere`] in a lane that
    /// takes no common step.
    pub(crate) t: Row<R, W>,
    pub(crate) end: Row<R, W>,
    /// The largest |f| and |g| for which one correction is enough.
    pub(crate) residual: Row<R, W>,
    pub(crate) growth: Row<R, W>,
    /// σ of this step, and the step on the piece; -1 if one evaluation on the piece did not find it.
    pub(crate) found: Row<R, W>,
    pub(crate) step: Row<R, W>,
}

/// A place before which no guess ends.
pub(crate) fn nowhere<R: Real>() -> R {
    -R::max_value()
}

impl<const W: usize> Words<W> {
    pub(crate) fn new() -> Self {
        let none = [0; W];
        Self { phase: none, left: none, middle: [none; 2], period: [none; 2], is_common: [false; W] }
    }
}

impl<R: Real, const D: usize, const W: usize> Numbers<R, D, W> {
    pub(crate) fn new() -> Self {
        let zero = [R::zero(); W];
        Self {
            newest: zero,
            rise: zero,
            fall: zero,
            chord: [[zero; D]; CUBIC],
            offset: [zero; D],
            numerator: [[zero; D]; CUBIC],
            range: [zero; 2],
            share: zero,
            feed: zero,
            change: zero,
            time: zero,
            length: zero,
            t: zero,
            end: [nowhere(); W],
            residual: zero,
            growth: zero,
            found: zero,
            step: zero,
        }
    }

    #[inline(always)]
    pub(crate) fn trend(&self, lane: usize) -> Trend<R> {
        Trend { newest: self.newest[lane], rise: self.rise[lane], fall: self.fall[lane] }
    }

    #[inline(always)]
    pub(crate) fn put_trend(&mut self, lane: usize, trend: &Trend<R>) {
        (self.newest[lane], self.rise[lane], self.fall[lane]) = (trend.newest, trend.rise, trend.fall);
    }
}
