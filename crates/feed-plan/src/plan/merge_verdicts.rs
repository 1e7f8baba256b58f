//! Why a plan of the profile `Flexible` merges transitions or keeps them apart.

use alloc::vec::Vec;

use real::Real;

use crate::plan::flexible::{MergeVerdict, merge};
use crate::plan::look_ahead::stages;
use crate::{EndFeeds, FeedLimit, KinematicLimits, PlanError, ProfileKind};

/// What a plan of the profile `Flexible` decides, place by place: paper C's “acceleration + deceleration → acceleration” and
/// “→ deceleration”. Distances and times are those before the plan is stretched to whole periods.
///
/// # Errors
/// As [`plan_with`](crate::plan_with).
pub fn merge_verdicts<R: Real>(
    limit: &FeedLimit<R>,
    limits: &KinematicLimits<R>,
    ends: EndFeeds<R>,
) -> Result<Vec<MergeVerdict<R>>, PlanError> {
    let curves = stages(limit, limits, ends, None, ProfileKind::SCurve)?;
    let mut verdicts = Vec::new();
    merge(limit, limits, &curves, |verdict| verdicts.push(verdict));
    Ok(verdicts)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::plan::flexible::KeptApart;
    use crate::test_paths::{paper_limits, seed_000, seed_003};
    use crate::{StageKind, StageShape, plan_with};

    /// As many verdicts are merges as the plan has half-cosines and merged constant feeds, and each verdict is true of its stretch.
    #[test]
    fn the_verdicts_are_those_of_the_plan() {
        for curve in [seed_000(), seed_003()] {
            let limits = paper_limits();
            let limit = FeedLimit::along(&[curve.as_curve()], &limits).unwrap();
            let verdicts = merge_verdicts(&limit, &limits, EndFeeds::default()).unwrap();
            let plan = plan_with(&limit, &limits, EndFeeds::default(), ProfileKind::Flexible).unwrap();
            let cosines = plan.stages().iter().filter(|stage| stage.shape == StageShape::Cosine).count();
            let merges = verdicts.iter().filter(|verdict| verdict.outcome.is_ok());
            let of_cosines = merges.clone().filter(|verdict| verdict.stretch.kind() != StageKind::Constant);
            assert_eq!(cosines, of_cosines.count());
            assert!(merges.clone().count() > 0 || cosines == 0);
            let mut at = 0.0;
            for verdict in &verdicts {
                let stretch = &verdict.stretch;
                assert!(stretch.start >= at && verdict.transitions > 1, "{verdict:?}");
                at = stretch.start;
                match verdict.outcome {
                    Ok(time) => {
                        assert!(
                            (time - 2.0 * stretch.length / (stretch.start_feed + stretch.end_feed)).abs()
                                < 1e-9 * time
                        );
                        at += stretch.length * (1.0 - 1e-12);
                    }
                    Err(KeptApart::Acceleration(times) | KeptApart::Jerk(times)) => assert!(times > 1.0),
                    Err(KeptApart::Time(times)) => assert!(times > 1.0 + 1.0 / 64.0),
                    Err(KeptApart::Limit { distance, feed, limit: most }) => {
                        assert!(feed > most && most <= limit.at(distance).max(feed));
                        assert!(
                            distance >= stretch.start && distance <= stretch.start + stretch.length + 1e-9
                        );
                    }
                    Err(KeptApart::Rest) => assert_eq!(stretch.start_feed + stretch.end_feed, 0.0),
                }
            }
        }
    }
}
