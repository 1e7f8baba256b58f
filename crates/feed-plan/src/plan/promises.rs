//! What every plan promises, for tests: checked over all of its stages, and over its periods.

use nurbs_core::NurbsBuf;
use real::Backend;

use crate::test_paths::limit_along;
use crate::{EndFeeds, FeedLimit, KinematicLimits, ProfileKind, ScheduleBuf, jerk_free_duration, plan_with};

/// Worst of each promise over a plan, as ratios to what is allowed; the last is the jump of feed at
/// joints.
#[derive(Debug)]
pub(crate) struct Worst {
    pub(crate) feed: f64,
    pub(crate) acceleration: f64,
    pub(crate) jerk: f64,
    pub(crate) joint: f64,
}

pub(crate) fn worst<R: Backend>(
    limit: &FeedLimit<R>,
    limits: &KinematicLimits<R>,
    plan: &ScheduleBuf<R>,
) -> Worst {
    let mut worst = Worst { feed: 0.0, acceleration: 0.0, jerk: 0.0, joint: 0.0 };
    let mut end: Option<(R, R)> = None;
    // The sampled distance may be off by rounding, over a stop or a jump of the limit.
    let rounding = limit.length() * R::resolution() + R::resolution();
    let allowed_near =
        |place: R| limit.at(place).max(limit.at(place - rounding)).max(limit.at(place + rounding));
    for stage in plan.stages() {
        if let Some((distance, feed)) = end {
            let jump = (stage.start - distance).to_f64().abs().max((stage.start_feed - feed).to_f64().abs());
            worst.joint = worst.joint.max(jump);
        }
        end = Some((stage.start + stage.length, stage.end_feed));
        for i in 0..=200 {
            let time = stage.duration * R::from_ratio(i, 200);
            let allowed = allowed_near(stage.start + stage.distance_at(time));
            let (a, j) = (stage.acceleration_at(time).abs(), stage.jerk_at(time).abs());
            let feed = stage.feed_at(time);
            // At a stop both are zero.
            if feed > R::zero() {
                worst.feed = worst.feed.max(feed.to_f64() / allowed.to_f64().max(1e-9));
            }
            worst.acceleration = worst.acceleration.max(a.to_f64() / limits.acceleration.to_f64());
            worst.jerk = worst.jerk.max(j.to_f64() / limits.jerk.to_f64());
        }
    }
    worst
}

/// Every promise of [`plan_with`], from rest to rest, to rounding of f64.
fn assert_kept(limit: &FeedLimit<f64>, limits: &KinematicLimits<f64>, plan: &ScheduleBuf<f64>) {
    let worst = worst(limit, limits, plan);
    assert!(worst.feed <= 1.0 + 1e-9, "{worst:?}");
    assert!(worst.acceleration <= 1.0 + 1e-12 && worst.jerk <= 1.0 + 1e-12, "{worst:?}");
    assert!(worst.joint <= 1e-9 * limit.length(), "{worst:?}");
    let schedule = plan.as_schedule();
    assert!((schedule.length() - limit.length()).abs() <= 1e-12 * limit.length().max(1.0));
    let periods = schedule.periods() as f64;
    assert!((schedule.duration() / limits.interpolation_period - periods).abs() <= 1e-12 * periods);
    assert!(plan.stages().iter().all(|stage| stage.duration > 0.0 && stage.length > 0.0));
    let (first, last) = (plan.stages().first().unwrap(), plan.stages().last().unwrap());
    assert_eq!((first.start, first.start_feed, last.end_feed), (0.0, 0.0, 0.0));
    let bound = jerk_free_duration(limit, limits, EndFeeds::default());
    assert!(schedule.duration() >= bound * (1.0 - 1e-3), "{} is faster than {bound}", schedule.duration());

    // What the real-time loop sees.
    let mut cursor = schedule.start();
    let mut travelled = 0.0;
    while let Some(step) = schedule.advance(&mut cursor) {
        assert!(step > 0.0, "{step}");
        travelled += step;
    }
    // The sum rounds too, once a period.
    let tolerance = (1e-12 + periods * f64::EPSILON) * limit.length().max(1.0);
    assert!((travelled - limit.length()).abs() <= tolerance, "{travelled} after {periods} periods");
    assert_eq!(cursor.period(), schedule.periods());
}

/// The plan from rest to rest, which keeps every promise.
pub(crate) fn kept(
    limit: &FeedLimit<f64>,
    limits: &KinematicLimits<f64>,
    kind: ProfileKind,
) -> ScheduleBuf<f64> {
    let plan = plan_with(limit, limits, EndFeeds::default(), kind).unwrap();
    assert_kept(limit, limits, &plan);
    plan
}

/// The limit along a curve, and the plan from rest to rest under it.
pub(crate) fn planned(
    curve: &NurbsBuf<f64, 2>,
    limits: &KinematicLimits<f64>,
) -> (FeedLimit<f64>, ScheduleBuf<f64>) {
    let limit = limit_along(core::slice::from_ref(curve), limits);
    let plan = kept(&limit, limits, ProfileKind::Cubic);
    (limit, plan)
}
