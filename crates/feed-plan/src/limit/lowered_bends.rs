//! A limit that is lowered again where a run by chords would leave the path too far.

use real::Real;

use crate::FeedLimit;

impl<R: Real> FeedLimit<R> {
    /// Lowers the limit to a feed where the path bends between two distances, up to the points beside them.
    pub(crate) fn lower_bends(&mut self, from: R, to: R, feed: R) {
        let first = self.samples.partition_point(|sample| sample.point.distance <= from).max(1);
        for end in first..self.samples.len() {
            let [begin, end] = [end - 1, end];
            let (at, before) = (self.samples[end].point.distance, self.samples[begin].point.distance);
            if before >= to {
                break;
            }
            if !(self.samples[end].bends && at > before) {
                continue;
            }
            for sample in [begin, end] {
                let sample = &mut self.samples[sample];
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
}
