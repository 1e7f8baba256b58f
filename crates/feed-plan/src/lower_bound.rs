//! How fast the path could be passed if jerk were free.
//!
//! In the phase plane of distance and feed the time-optimal motion under `|a| ≤ A` and a feed limit is found by
//! two sweeps: forward, the feed rises from each point by no more than A allows, `V² ≤ V₀² + 2 A s`; backward
//! likewise; the lower of both is optimal. No plan that also limits the jerk can be faster.

use alloc::vec::Vec;

use real::Real;

use crate::{FeedLimit, KinematicLimits};

/// Duration of the fastest motion from rest to rest under the limit and `|a| ≤ A`, jerk being free.
///
/// Between limit points the acceleration is constant, which passes each stretch in `2 Δs/(V_i + V_{i+1})`. The
/// points are taken as they are, without the margin that a plan keeps: the value is a lower bound to
/// within the sampling of the limit, about 10⁻⁴ of the duration.
/// A limit that is zero over a stretch gives the greatest number of the format.
#[must_use]
pub fn jerk_free_duration<R: Real>(limit: &FeedLimit<R>, limits: &KinematicLimits<R>) -> R {
    let points = limit.points();
    // Next to a stop the lower value is the one that counts, and the higher one.
    let feeds = points.iter().zip(limit.nodes()).map(|(point, node)| point.feedrate.max(node.lower));
    let mut squares: Vec<R> = feeds.map(|feed| feed * feed).collect();
    for end in [squares.len().saturating_sub(1), 0] {
        if let Some(square) = squares.get_mut(end) {
            *square = R::zero();
        }
    }
    let distances: Vec<R> = points.iter().map(|point| point.distance).collect();
    let twice_acceleration = limits.acceleration + limits.acceleration;
    for i in 1..squares.len() {
        squares[i] = squares[i].min(squares[i - 1] + twice_acceleration * (distances[i] - distances[i - 1]));
    }
    for i in (1..squares.len()).rev() {
        squares[i - 1] =
            squares[i - 1].min(squares[i] + twice_acceleration * (distances[i] - distances[i - 1]));
    }
    let mut duration = R::zero();
    for i in 1..squares.len() {
        let length = distances[i] - distances[i - 1];
        let sum = squares[i].sqrt() + squares[i - 1].sqrt();
        if length > R::zero() {
            if !(sum > R::zero()) {
                return R::max_value();
            }
            duration = duration + (length + length) / sum;
        }
    }
    duration
}
