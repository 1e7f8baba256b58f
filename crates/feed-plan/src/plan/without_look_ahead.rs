//! A run without look-ahead, the baseline that look-ahead is held against.
//!
//! In each period the control takes the largest feed V that the path allows where the period begins: that of the move, and that of
//! the chord error. It knows nothing of what comes, so it brakes for a bend within one period, whatever acceleration that takes. Only
//! rests are known: after one the feed rises with A, and before one it falls with A. With L for the distance from the section's start to
//! its rest, and v_0 and v_L for the feeds at both,
//!
//! v_{i+1} = min(V(s_i + v_i T), v_0 + A (i + 1) T, b), and s_{i+1} = s_i + (v_i + v_{i+1}) T/2,
//!
//! where b brakes with A from s_{i+1}: b² = v_L² + 2 A (L − s_i − (v_i + b) T/2). Within a period the feed changes evenly.
//!
//! Source: paper C (Wang Haitao et al.), section 1, whose figures 8a to 10a show such a run.

use real::Real;

use crate::plan::key_points::Key;
use crate::plan::stages::Stages;
use crate::{FeedLimit, FeedPiece, KinematicLimits, PlanError, StageShape};

/// A section from rest to rest, or to the end of the path.
pub(crate) fn without_look_ahead<R: Real>(
    limit: &FeedLimit<R>,
    limits: &KinematicLimits<R>,
    [from, to]: [&Key<R>; 2],
    stages: &mut Stages<'_, R>,
) -> Result<(), PlanError> {
    let (period, rise) = (limits.interpolation_period, limits.acceleration * limits.interpolation_period);
    let braking = |left: R, feed: R, end: R| {
        let (half, room) = (rise.half(), (limits.acceleration * left).ldexp(1) - rise * feed);
        (half * half + end * end + room).max(R::zero()).sqrt() - half
    };
    let (mut at, mut feed, mut most) = (from.distance, from.feed, from.feed);
    while at < to.distance {
        let left = to.distance - at;
        if left + left <= (feed + to.feed) * period {
            let duration = (left + left) / (feed + to.feed);
            stages.push(at, left, &piece(feed, to.feed, duration));
            return Ok(());
        }
        most = most + rise;
        // The limit is 0 at rests themselves.
        let ahead = (feed.max(rise.half()) * period).min(left.half());
        let next = limit.at(at + ahead).min(most).min(braking(left, feed, to.feed));
        let length = ((feed + next) * period).half();
        if !(length > R::zero() && at + length > at) {
            return Err(PlanError::CannotMove { index: from.point });
        }
        if next == feed {
            stages.constant(at, length, feed);
        } else {
            stages.push(at, length, &piece(feed, next, period));
        }
        (at, feed) = (at + length, next);
    }
    Ok(())
}

fn piece<R: Real>(start_feed: R, end_feed: R, duration: R) -> FeedPiece<R> {
    FeedPiece { shape: StageShape::Steady, start_feed, end_feed, duration }
}
