//! The numbers of all lanes that a common step needs, side by side.

use nurbs_core::{MAX_DEGREE, Pieces};
use real::Real;

use crate::pieces::trend::Trend;

/// One number of each lane.
pub(crate) type Row<T, const W: usize> = [T; W];

/// The numbers of one lane.
#[inline(always)]
pub(crate) fn of_lane<T: Copy, const N: usize, const W: usize>(rows: &[Row<T, W>; N], lane: usize) -> [T; N] {
    core::array::from_fn(|n| rows[n][lane])
}

/// The first N rows of coefficients of one lane.
#[inline(always)]
pub(crate) fn first_of_lane<T: Copy, const N: usize, const D: usize, const W: usize>(
    rows: &[[Row<T, W>; D]; MAX_DEGREE],
    lane: usize,
) -> [[T; D]; N] {
    core::array::from_fn(|k| of_lane(&rows[k], lane))
}

/// Puts the numbers of one lane into their rows.
#[inline(always)]
pub(crate) fn put<T: Copy, const N: usize, const W: usize>(
    rows: &mut [Row<T, W>; N],
    lane: usize,
    values: [T; N],
) {
    for (row, value) in rows.iter_mut().zip(values) {
        row[lane] = value;
    }
}

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
    /// q̃_k of the chord, as many as the loops take.
    pub(crate) chord: [[Row<R, W>; D]; MAX_DEGREE],
    /// ω̃_k; of no meaning while no lane has weights.
    pub(crate) weight: [[Row<R, W>; 1]; MAX_DEGREE],
    pub(crate) offset: [Row<R, W>; D],
    /// n_1, n_2, … of the pieces.
    pub(crate) numerator: [[Row<R, W>; D]; MAX_DEGREE],
    /// w_0 of the pieces; 1 without weights.
    pub(crate) constant: Row<R, W>,
    /// w_1, w_2, …; without weights they add nothing.
    pub(crate) weights: [[Row<R, W>; 1]; MAX_DEGREE],
    /// The least and greatest step per chord.
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

/// A coefficient of a power that a polynomial does not have. It is -0: added to any number, to 0 and -0 too, its
/// products leave that number's bits as they are.
fn no_term<R: Real>() -> R {
    -R::zero()
}

impl<const W: usize> Words<W> {
    pub(crate) fn new() -> Self {
        let none = [0; W];
        Self { phase: none, left: none, middle: [none; 2], period: [none; 2], is_common: [false; W] }
    }
}

impl<R: Real, const D: usize, const W: usize> Numbers<R, D, W> {
    pub(crate) fn new() -> Self {
        let (zero, none) = ([R::zero(); W], [no_term(); W]);
        Self {
            newest: zero,
            rise: zero,
            fall: zero,
            chord: [[none; D]; MAX_DEGREE],
            weight: [[none]; MAX_DEGREE],
            offset: [zero; D],
            numerator: [[none; D]; MAX_DEGREE],
            constant: [R::one(); W],
            weights: [[none]; MAX_DEGREE],
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

    /// Puts the coefficients of a piece into a lane, of which the loops take so many. Weights only if the path has some: a lane without
    /// has those of [`leave_weights`](Self::leave_weights).
    #[inline]
    pub(crate) fn put_coefficients(
        &mut self,
        lane: usize,
        pieces: &Pieces<'_, R, D>,
        piece: usize,
        count: usize,
    ) {
        let degree = pieces.degree;
        let numerator = pieces.numerators.get(degree * piece..).unwrap_or_default();
        for (k, rows) in self.numerator.iter_mut().take(count).enumerate() {
            let n = numerator.get(k).filter(|_| k < degree);
            put(rows, lane, n.copied().unwrap_or([no_term(); D]));
        }
        if let Some([constant, weights @ ..]) = pieces.weights.get((degree + 1) * piece..) {
            self.constant[lane] = *constant;
            for (k, [row]) in self.weights.iter_mut().take(count).enumerate() {
                row[lane] = weights.get(k).filter(|_| k < degree).copied().unwrap_or(no_term());
            }
        }
    }

    /// Makes W of a lane 1.
    pub(crate) fn leave_weights(&mut self, lane: usize) {
        self.constant[lane] = R::one();
        for [row] in &mut self.weights {
            row[lane] = no_term();
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
