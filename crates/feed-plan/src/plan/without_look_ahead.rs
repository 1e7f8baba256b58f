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

use crate::plan::key_points::{Key, cannot_move};
use crate::plan::stages::Stages;
use crate::{FeedLimit, FeedPiece, KinematicLimits, PlanError, StageShape};

/// Stages that a plan may have, at most: each period in which the feed changes is one.
const MOST_STAGES: usize = 1 << 20;

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
            return Err(cannot_move(limit, from));
        }
        if stages.count() >= MOST_STAGES {
            return Err(PlanError::TooManyPeriods { most: 1 << 20 });
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

#[cfg(test)]
mod tests {
    use crate::test_paths::{limit_through, paper_limits, seed_000, seed_003};
    use crate::{EndFeeds, FeedLimit, ProfileKind, Stage, plan_with};

    fn planned(limit: &FeedLimit<f64>) -> Vec<Stage<f64>> {
        plan_with(limit, &paper_limits(), EndFeeds::default(), ProfileKind::WithoutLookAhead)
            .unwrap()
            .stages()
            .to_vec()
    }

    /// On a straight line it is the trapezoid: the time is L/F + F/A.
    #[test]
    fn a_straight_line_is_a_trapezoid() {
        let limits = paper_limits();
        for length in [0.003, 1.7, 20.0, 333.3_f64] {
            let limit = limit_through(&[(0.0, limits.feedrate), (length, limits.feedrate)]);
            let stages = planned(&limit);
            let feed = limits.feedrate.min((limits.acceleration * length).sqrt());
            let wanted = length / feed + feed / limits.acceleration;
            let taken: f64 = stages.iter().map(|stage| stage.duration).sum();
            // Each ramp ends within a period, and the plan takes whole periods.
            assert!(
                taken >= wanted * (1.0 - 1e-12) && taken <= wanted + 3.0,
                "{length}: {taken} for {wanted}"
            );
            let most = stages.iter().map(|stage| stage.piece().peak_acceleration()).fold(0.0, f64::max);
            assert!(most <= limits.acceleration * (1.0 + 1e-9), "{length}: {most}");
        }
    }

    /// The feed of each period is what the path allows where it begins, and each stage begins where the one before ends.
    #[test]
    fn each_period_takes_what_the_path_allows_where_it_begins() {
        for curve in [seed_000(), seed_003()] {
            let (limits, limit) =
                (paper_limits(), FeedLimit::along(&[curve.as_curve()], &paper_limits()).unwrap());
            let stages = planned(&limit);
            let (mut at, mut feed, mut most) = (0.0, 0.0, 0.0_f64);
            for stage in &stages {
                assert!(
                    (stage.start - at).abs() < 1e-9 && (stage.start_feed - feed).abs() < 1e-9,
                    "{stage:?}"
                );
                (at, feed) = (stage.start + stage.length, stage.end_feed);
                most = most.max(stage.piece().peak_acceleration());
                // The feed was taken a period ahead, where the limit has changed by what one period changes.
                let near =
                    limit.at(stage.start - 0.1).max(limit.at(stage.start)).max(limit.at(stage.start + 0.1));
                assert!(stage.start_feed <= near * 1.001, "{stage:?}: {near}");
            }
            assert!((at - limit.length()).abs() < 1e-9 && feed == 0.0);
            // Paper A's curve is so gentle that A holds; paper D's has sharp bends.
            assert_eq!(most > 2.0 * limits.acceleration, curve.control_points().len() == 10, "{most}");
        }
    }
}
