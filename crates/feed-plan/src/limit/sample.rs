//! One sample of the feed limit, and the limit between two of them.
//!
//! What a planner needs from the limit is a promise: *this feed is allowed from here to there*. Samples alone
//! do not give it, since between two samples the limit may dip. So each sample carries a second value, a
//! little lower, chosen so that the curve through these lower values stays below the limit in between as
//! well. Between samples `V²` is taken as linear in the distance: near a sharp bend the chord limit is
//! `√(8Eρ)/T`, so its square is as smooth as the radius, and a constant acceleration is a straight line.

use alloc::vec::Vec;

use real::Real;

use crate::limit::axis_budget::Allowance;

/// The feed limit at one point of the path.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LimitPoint<R> {
    /// Arc length from the path's start, mm.
    pub distance: R,
    /// Index of the curve.
    pub curve: usize,
    /// Parameter on that curve.
    pub u: R,
    /// Largest feed there; 0 at a stop.
    pub feedrate: R,
}

/// A sample while the path is scanned: a point of the limit, with the properties of the point and of the stretch that leads to it from
/// the sample before.
///
/// Within E of a stop the chord error does not limit the feed, so the sample holds its values with and without the
/// chord error. Once all samples are known, a [`LimitSample`] is made of each.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct ScannedSample<R> {
    pub(crate) point: LimitPoint<R>,
    /// `|C'|`, mm; 0 if unknown.
    pub(crate) speed: R,
    /// Whether the limit holds at this point alone, not beside it.
    pub(crate) is_single: bool,
    /// Whether the tool rests here, at a corner or because the program says so, even if another rest is near.
    pub(crate) rests: bool,
    /// Whether the direction changes over the stretch, or at the point by less than at a corner. If so, chords are
    /// shorter than the path.
    pub(crate) bends: bool,
    /// By how much `V²` may dip below the straight line over the stretch.
    pub(crate) margin: R,
    /// The acceleration and jerk that the axes leave for the path on the stretch.
    pub(crate) allowance: Allowance<R>,
    /// The feed limit at the point without the chord error.
    pub(crate) feedrate_beside_stop: R,
    /// The margin of that limit.
    pub(crate) margin_beside_stop: R,
    /// The acceleration and jerk that the axes leave for the path on the stretch if it is passed at
    /// `feedrate_beside_stop`.
    pub(crate) allowance_beside_stop: Allowance<R>,
    /// Lower value of the limit at the point: see [`LimitSample`].
    pub(crate) lower: R,
}

impl<R: Real> ScannedSample<R> {
    /// A sample at which only the feed is limited.
    pub(crate) fn new(point: LimitPoint<R>) -> Self {
        let feedrate = point.feedrate;
        Self {
            point,
            speed: R::zero(),
            is_single: feedrate.is_zero(),
            rests: false,
            bends: false,
            margin: R::zero(),
            allowance: Allowance::unlimited(),
            feedrate_beside_stop: R::max_value(),
            margin_beside_stop: R::zero(),
            allowance_beside_stop: Allowance::unlimited(),
            lower: feedrate,
        }
    }
}

/// A sample of the limit, once all are known.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct LimitSample<R> {
    pub(crate) point: LimitPoint<R>,
    /// `|C'|`, mm; 0 if unknown.
    pub(crate) speed: R,
    /// Whether the limit holds at this point alone, not beside it.
    pub(crate) is_single: bool,
    /// Whether the direction changes over the stretch before the point, or at the point by less than at a corner.
    pub(crate) bends: bool,
    /// The acceleration and jerk that the axes leave for the path on the stretch before the point.
    pub(crate) allowance: Allowance<R>,
    /// Lower value of the limit at the point: 0 at a stop, never more than its `feedrate` elsewhere, except
    /// next to a stop. [`FeedLimit`](crate::FeedLimit) finds it when the samples are complete.
    pub(crate) lower: R,
    /// The lower value at the end of the stretch before the point; it differs from `lower` at a stop only.
    pub(crate) lower_before: R,
    /// The lower value at the begin of the stretch after the point.
    pub(crate) lower_after: R,
}

impl<R: Real> LimitSample<R> {
    /// The samples in this form. `collect` puts them into the memory of `scanned`
    /// where std does so; the rest is given back.
    pub(crate) fn all(scanned: Vec<ScannedSample<R>>) -> Vec<Self> {
        let one =
            |ScannedSample {
                 point, speed, is_single, bends, allowance, lower, feedrate_beside_stop, ..
             }| {
                // At a single point, until the loop below: the feed beside a stop.
                let beside = if is_single { feedrate_beside_stop } else { lower };
                Self {
                    point,
                    speed,
                    is_single,
                    bends,
                    allowance,
                    lower,
                    lower_before: beside,
                    lower_after: beside,
                }
            };
        let mut samples: Vec<_> = scanned.into_iter().map(one).collect();
        samples.shrink_to_fit();
        for i in 0..samples.len() {
            let LimitSample { is_single: true, lower_after: beside, .. } = samples[i] else { continue };
            let most = |neighbour: Option<usize>| {
                let neighbour = neighbour.and_then(|neighbour| samples.get(neighbour));
                neighbour.map_or_else(R::zero, |sample| sample.lower.min(beside))
            };
            (samples[i].lower_before, samples[i].lower_after) =
                (most(i.checked_sub(1)), most(i.checked_add(1)));
        }
        samples
    }

    /// Lowers the limit at the point and on both sides of it.
    pub(crate) fn lower_to(&mut self, feed: R) {
        self.lower_corner_to(feed);
        (self.lower_before, self.lower_after) = (self.lower_before.min(feed), self.lower_after.min(feed));
    }

    /// Lowers the limit at the point alone.
    pub(crate) fn lower_corner_to(&mut self, feed: R) {
        (self.point.feedrate, self.lower) = (self.point.feedrate.min(feed), self.lower.min(feed));
    }

    /// The sample with the same lower value at the point and on both sides of it.
    pub(crate) fn with_lower(self, lower: R) -> Self {
        Self { lower, lower_before: lower, lower_after: lower, ..self }
    }
}

/// `√(V² - margin)`, but at least half of V: samples do not resolve a deeper dip.
pub(crate) fn lowered<R: Real>(feedrate: R, margin: R) -> R {
    if !(margin > R::zero()) {
        return feedrate;
    }
    (feedrate * feedrate - margin).sqrt().max(feedrate.half())
}

/// The feed at `distance` on the stretch between two points (distance, feed), `V²` linear in the distance.
pub(crate) fn interpolate<R: Real>(from: (R, R), to: (R, R), distance: R) -> R {
    let length = to.0 - from.0;
    if from.1 == to.1 || !(length > R::zero()) {
        return from.1.min(to.1);
    }
    let x = (distance - from.0) / length;
    let square = from.1 * from.1 + x * ((to.1 - from.1) * (to.1 + from.1));
    square.sqrt().max(from.1.min(to.1)).min(from.1.max(to.1))
}

/// The distance at which the feed is `feed` on the stretch between two points (distance, feed): the inverse of
/// [`interpolate`].
pub(crate) fn distance_at_feed<R: Real>(from: (R, R), to: (R, R), feed: R) -> R {
    if from.1 == to.1 {
        return to.0;
    }
    let x = ((feed - from.1) / (to.1 - from.1)) * ((feed + from.1) / (to.1 + from.1));
    from.0 + (to.0 - from.0) * x.max(R::zero()).min(R::one())
}
