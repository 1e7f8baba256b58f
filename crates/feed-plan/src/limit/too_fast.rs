//! A limit that is lowered again where a run by chords would leave the path too far, or where an axis would take too much.

use alloc::vec::Vec;

use real::Real;

use crate::FeedLimit;
use crate::limit::axis_budget::Allowance;

/// A way that is passed too fast.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct TooFast<R> {
    pub(crate) from: R,
    pub(crate) to: R,
    /// How long the way is over which that shows.
    pub(crate) way: R,
    /// How many times as long it must take.
    pub(crate) longer: R,
    pub(crate) slower: Slower<R>,
}

/// How a way is passed more slowly.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum Slower<R> {
    /// At this feed, and its corners at another one.
    Feed { feed: R, at_corners: R },
    /// With feeds that change with these shares of the acceleration and jerk that are allowed for it, of so much at most.
    Changes { most: Allowance<R>, shares: Allowance<R> },
}

impl<R: Real> FeedLimit<R> {
    /// Lowers what ways that are passed too fast allow, up to the points beside them. Where they overlap, the least share counts.
    pub(crate) fn lower_over(&mut self, ways: &[TooFast<R>]) {
        let all = Allowance { acceleration: R::one(), jerk: R::one() };
        let mut changes: Vec<(Allowance<R>, Allowance<R>)> =
            self.samples.iter().map(|_| (Allowance::unlimited(), all)).collect();
        ways.iter().for_each(|way| self.lower_over_one(way, &mut changes));
        for (sample, (most, shares)) in
            self.samples.iter_mut().zip(changes).filter(|(_, (_, shares))| *shares != all)
        {
            sample.allowance = sample.allowance.min(most).times(shares);
        }
    }

    /// Lowers the limit of the feed over a way, or the shares by which feeds change. A point beside a straight that is longer than what
    /// shows that it is passed too fast keeps its limit, or the limit of all the straight would fall.
    fn lower_over_one(
        &mut self,
        &TooFast { from, to, way, slower, .. }: &TooFast<R>,
        changes: &mut [(Allowance<R>, Allowance<R>)],
    ) {
        let first = self.samples.partition_point(|sample| sample.point.distance <= from).max(1);
        for (end, change) in changes.iter_mut().enumerate().skip(first) {
            if self.samples[end - 1].point.distance >= to {
                break;
            }
            match slower {
                Slower::Feed { feed, at_corners } => {
                    for point in [end - 1, end] {
                        if !self.is_beside_straight(point, way) {
                            self.samples[point].lower_to(feed);
                        }
                    }
                    if self.samples[end].is_single && self.samples[end].point.distance <= to {
                        self.samples[end].lower_corner_to(at_corners);
                    }
                }
                Slower::Changes { most, shares } => {
                    *change = (most, change.1.min(shares));
                }
            }
        }
    }

    /// The way to a point from the one before.
    fn way_before(&self, point: usize) -> Option<R> {
        let before = self.samples.get(point.checked_sub(1)?)?;
        Some(self.samples.get(point)?.point.distance - before.point.distance)
    }

    /// Whether the way to a point has a length and bends.
    fn bends_before(&self, point: usize) -> bool {
        self.way_before(point).is_some_and(|way| way > R::zero())
            && self.samples.get(point).is_some_and(|sample| sample.bends)
    }

    /// Whether a straight longer than this begins or ends at a point.
    fn is_beside_straight(&self, point: usize, length: R) -> bool {
        let is_long = |point: usize| self.way_before(point).is_some_and(|way| way > length);
        [point, point + 1].into_iter().any(|point| is_long(point) && !self.bends_before(point))
    }
}
