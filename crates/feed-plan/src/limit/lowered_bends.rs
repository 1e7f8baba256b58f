//! A limit that is lowered again where a run by chords would leave the path too far.

use real::Real;

use crate::FeedLimit;

impl<R: Real> FeedLimit<R> {
    /// Lowers the limit to a feed where the path bends between two distances, up to the points beside them. A point beside a straight that
    /// is longer than that way keeps its limit, or the limit of all the straight would fall.
    pub(crate) fn lower_bends(&mut self, from: R, to: R, feed: R) {
        let first = self.samples.partition_point(|sample| sample.point.distance <= from).max(1);
        for end in first..self.samples.len() {
            if self.samples[end - 1].point.distance >= to {
                break;
            }
            if !self.bends_before(end) {
                continue;
            }
            for point in [end - 1, end] {
                if self.is_beside_straight(point, to - from) {
                    continue;
                }
                let sample = &mut self.samples[point];
                let limits = [
                    &mut sample.point.feedrate,
                    &mut sample.lower,
                    &mut sample.lower_before,
                    &mut sample.lower_after,
                ];
                limits.into_iter().for_each(|limit| *limit = limit.min(feed));
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
