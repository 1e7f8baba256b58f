//! The points of the limit between which a plan is made: the ends and the local minima.

use alloc::vec::Vec;

use real::Real;

use crate::limit::axis_budget::Allowance;
use crate::{FeedLimit, PlanError};

/// Minima less deep than 2⁻⁸ of the limit are no key points: the samples of a constant limit have many. The plan still
/// keeps below them.
const SIGNIFICANT: i32 = -8;

/// Feeds at the two ends of the path; at rest by default.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct EndFeeds<R> {
    /// Feed at the start.
    pub start: R,
    /// Feed at the end.
    pub end: R,
}

/// A limit point that the plan passes with zero acceleration.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Key<R> {
    pub(crate) point: usize,
    pub(crate) distance: R,
    pub(crate) feed: R,
    /// The limit points between which the limit is highest on the way from the key before.
    pub(crate) summit: (usize, usize),
    /// The acceleration and jerk that the axes leave for the path on the way from the key before.
    pub(crate) allowance: Allowance<R>,
}

/// The error that no feed leads on from a key point.
pub(crate) fn cannot_move<R: Real>(limit: &FeedLimit<R>, from: &Key<R>) -> PlanError {
    let curve = limit.samples().get(from.point).map_or(0, |sample| sample.point.curve);
    PlanError::CannotMove { curve }
}

/// The ends and the significant minima of the limit.
pub(crate) fn key_points<R: Real>(limit: &FeedLimit<R>, ends: EndFeeds<R>) -> Result<Vec<Key<R>>, PlanError> {
    let samples = limit.samples();
    let last = samples.len().saturating_sub(1);
    let key = |point: usize, feed: R| {
        let distance = samples.get(point).map_or_else(R::zero, |sample| sample.point.distance);
        Key { point, distance, feed, summit: (point, point), allowance: Allowance::unlimited() }
    };
    let start = end_feed(limit, 0, ("start feed", ends.start), PlanError::StartFeedTooHigh)?;
    let mut keys = Vec::from([key(0, start)]);
    let (mut is_falling, mut extreme) = (true, 0);
    for (i, sample) in samples.iter().enumerate() {
        let Some(reference) = samples.get(extreme).map(|sample| sample.lower) else { break };
        let significance = reference.ldexp(SIGNIFICANT);
        let is_beyond = if is_falling { sample.lower < reference } else { sample.lower > reference };
        if is_beyond {
            extreme = i;
        } else if is_falling && sample.lower > reference + significance + significance {
            if extreme > 0 {
                keys.push(key(extreme, reference));
            }
            (is_falling, extreme) = (false, i);
        } else if !is_falling && sample.lower < reference - significance {
            (is_falling, extreme) = (true, i);
        }
    }
    if is_falling && extreme > 0 && extreme < last {
        keys.extend(samples.get(extreme).map(|sample| key(extreme, sample.lower)));
    }
    let end = end_feed(limit, last, ("end feed", ends.end), PlanError::EndFeedTooHigh)?;
    keys.push(key(last, end));
    Ok(keys)
}

/// Checks a feed asked for at an end of the path against the lower bound of the limit there.
fn end_feed<R: Real>(
    limit: &FeedLimit<R>,
    point: usize,
    (what, feed): (&'static str, R),
    too_high: PlanError,
) -> Result<R, PlanError> {
    let sample = limit.samples().get(point).ok_or(PlanError::PathEmpty)?;
    if !(feed >= R::zero()) {
        return Err(PlanError::Negative { what });
    }
    if feed > sample.point.feedrate { Err(too_high) } else { Ok(feed.min(sample.lower)) }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::test_paths::limit_through;

    fn keys_of(feeds: &[f64]) -> Vec<usize> {
        let points: Vec<_> = feeds.iter().enumerate().map(|(i, feed)| (i as f64, *feed)).collect();
        let limit = limit_through(&points);
        key_points(&limit, EndFeeds::default()).unwrap().iter().map(|key| key.point).collect()
    }

    #[test]
    fn each_valley_has_one_key_and_each_plateau_at_most_one() {
        assert_eq!(keys_of(&[5.0, 5.0, 5.0]), [0, 2]);
        assert_eq!(keys_of(&[5.0, 3.0, 4.0, 2.0, 5.0]), [0, 1, 3, 4]);
        assert_eq!(keys_of(&[5.0, 3.0, 3.0, 3.0, 5.0]), [0, 1, 4]);
        assert_eq!(keys_of(&[1.0, 2.0, 3.0]), [0, 2]);
        assert_eq!(keys_of(&[5.0, 0.0, 5.0, 0.0, 5.0]), [0, 1, 3, 4]);
    }

    #[test]
    fn ripple_of_rounding_makes_no_keys() {
        assert_eq!(keys_of(&[5.0, 4.999, 5.001, 4.998, 5.0, 4.999, 5.0]), [0, 3, 6]);
    }
}
