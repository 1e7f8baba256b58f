//! A planned path: its limit, and the plan in arcs and in chords, made together.

use alloc::vec::Vec;

use nurbs_core::Differentiate;
use real::Real;

use crate::axes::within_axes::plan_some_within_axes;
use crate::chords::kept::{Kept, kept};
use crate::limit::too_fast::TooFast;
use crate::{
    EndFeeds, FeedLimit, KinematicLimits, Lead, PlanError, ProfileKind, ScheduleBuf, Stage, plan_with,
    plan_within_axes,
};

/// The limit and the two plans of a path, which are known before it is run.
#[derive(Clone, Debug)]
pub struct Planned<R> {
    /// The largest feed at each distance.
    pub limit: FeedLimit<R>,
    /// The plan along the curves: distances are arc lengths.
    pub arcs: ScheduleBuf<R>,
    /// The plan that an interpolator runs: distances are summed lengths of the chords between setpoints.
    pub chords: ScheduleBuf<R>,
    /// By how much a run by the chords is ahead of the plan in arcs.
    pub lead: Lead<R>,
}

impl<R: Real> Planned<R> {
    /// Plans a path in three steps: the limit with [`FeedLimit::along`], the plan in arcs with [`plan_with`], and the
    /// plan [in chords](FeedLimit::in_chords). Where a run by the chords would leave the path by more than the chord error, the limit is
    /// lowered and the path planned again; a section in which it would take more than the acceleration or jerk of the path is slowed down.
    ///
    /// # Errors
    /// As [`FeedLimit::along`] and [`plan_with`].
    pub fn along<const D: usize, C: Differentiate<R, D>>(
        curves: &[C],
        limits: &KinematicLimits<R>,
        ends: EndFeeds<R>,
        kind: ProfileKind,
    ) -> Result<Self, PlanError> {
        Self::under(FeedLimit::along(curves, limits)?, curves, limits, ends, kind)
    }

    /// Plans a path under a limit that was made of these curves and limits, and that may have stops or feeds of its
    /// own.
    ///
    /// # Errors
    /// As [`plan_with`].
    pub fn under<const D: usize, C: Differentiate<R, D>>(
        limit: FeedLimit<R>,
        curves: &[C],
        limits: &KinematicLimits<R>,
        ends: EndFeeds<R>,
        kind: ProfileKind,
    ) -> Result<Self, PlanError> {
        let plan = |limit: &FeedLimit<R>| plan_with(limit, limits, ends, kind);
        let arcs = plan(&limit)?;
        if kind == ProfileKind::WithoutLookAhead {
            // Such a plan keeps no limit.
            let chords = limit.in_chords(curves, &arcs);
            let lead = limit.lead(curves, arcs.stages(), chords.stages(), limits.interpolation_period);
            return Ok(Self { limit, arcs, chords, lead });
        }
        let found = kept(&limit, arcs, curves, limits, false, |limit, _, _| plan(limit).ok());
        let found = match kind {
            ProfileKind::Fastest => or_s_curves(found, &limit, curves, limits, ends),
            _ => found,
        };
        Ok(Self::of(limit, found))
    }

    fn of(limit: FeedLimit<R>, found: Kept<R>) -> Self {
        let lead = found.lead();
        Self { limit, arcs: found.arcs, chords: found.chords, lead }
    }

    /// Curve and parameter of each rest on the way and at the end, in order. The path must be compiled with a joint at
    /// each.
    #[must_use]
    pub fn rests(&self) -> Vec<(usize, R)> {
        self.chords.stages().iter().filter_map(Stage::rest).collect()
    }
}

/// A plan; if its run left it in question, with S-curves in each section in which they are faster and kept by their run too.
fn or_s_curves<R: Real, C: Differentiate<R, D>, const D: usize>(
    found: Kept<R>,
    limit: &FeedLimit<R>,
    curves: &[C],
    limits: &KinematicLimits<R>,
    ends: EndFeeds<R>,
) -> Kept<R> {
    let plan = |limit: &FeedLimit<R>| plan_with(limit, limits, ends, ProfileKind::SCurve);
    if !found.is_in_question() {
        return found;
    }
    match plan(limit) {
        Ok(arcs) => {
            found.faster_by_sections(kept(limit, arcs, curves, limits, false, |limit, _, _| plan(limit).ok()))
        }
        Err(_) => found,
    }
}

/// A plan whose sections are planned again with less of the path's acceleration and jerk where their runs take too much, or slowed down where
/// that is faster.
fn by_strain_or_slower<C: Differentiate<f64, D>, const D: usize>(
    limit: &FeedLimit<f64>,
    arcs: ScheduleBuf<f64>,
    curves: &[C],
    limits: &KinematicLimits<f64>,
    plan_again: impl Fn(&FeedLimit<f64>, &ScheduleBuf<f64>, &[TooFast<f64>]) -> Option<ScheduleBuf<f64>>,
) -> Kept<f64> {
    let found = kept(limit, arcs.clone(), curves, limits, true, &plan_again);
    if !found.is_in_question() {
        return found;
    }
    found.better_by_sections(kept(limit, arcs, curves, limits, false, plan_again))
}

impl Planned<f64> {
    /// Plans a path as [`under`](Self::under) with [`ProfileKind::Fastest`], where no acceleration or jerk of an axis is limited, and each
    /// section anew for which an interior point finds a faster plan: [`plan_within_axes`].
    ///
    /// # Errors
    /// As [`plan_with`].
    pub fn fastest<const D: usize, C: Differentiate<f64, D> + Sync>(
        limit: FeedLimit<f64>,
        curves: &[C],
        limits: &KinematicLimits<f64>,
        ends: EndFeeds<f64>,
    ) -> Result<Self, PlanError> {
        let quick = |limit: &FeedLimit<f64>| plan_with(limit, limits, ends, ProfileKind::Fastest);
        let today = quick(&limit)?;
        let arcs = plan_within_axes(curves, limits, &limit, &today)?;
        let found = by_strain_or_slower(&limit, arcs, curves, limits, |limit, latest, ways| {
            plan_some_within_axes((curves, limits, limit), &quick(limit).ok()?, latest, is_on(ways)).ok()
        });
        let found = or_s_curves(found, &limit, curves, limits, ends);
        Ok(Self::of(limit, found))
    }

    /// Plans the sections of `today`, a plan of these curves, anew, so that each axis may use all of its acceleration and jerk:
    /// [`plan_within_axes`]. A section keeps its plan of `today` where no faster one is found. `limit` is that of the curves
    /// [without reserves](FeedLimit::without_reserves) for the axes, with the stops and feeds of the limit of `today`.
    ///
    /// # Errors
    /// As [`plan_within_axes`].
    pub fn within_axes<const D: usize, C: Differentiate<f64, D> + Sync>(
        today: &ScheduleBuf<f64>,
        limit: FeedLimit<f64>,
        curves: &[C],
        limits: &KinematicLimits<f64>,
    ) -> Result<Self, PlanError> {
        let arcs = plan_within_axes(curves, limits, &limit, today)?;
        let mut found = by_strain_or_slower(&limit, arcs, curves, limits, |limit, latest, ways| {
            plan_some_within_axes((curves, limits, limit), today, latest, is_on(ways)).ok()
        });
        if found.is_in_question() {
            let today = kept(&limit, today.clone(), curves, limits, false, |_, _, _| None);
            found = found.better_by_sections(today);
        }
        Ok(Self::of(limit, found))
    }
}

/// Whether one of these ways lies between the begin and the end of a section.
fn is_on(ways: &[TooFast<f64>]) -> impl Fn([f64; 2]) -> bool + Sync {
    let mut ends: Vec<_> = ways.iter().map(|way| (way.from, way.to)).collect();
    ends.sort_by(|a, b| a.0.total_cmp(&b.0));
    let mut farthest = f64::MIN;
    // How far the ways reach up to each.
    for (_, to) in &mut ends {
        farthest = farthest.max(*to);
        *to = farthest;
    }
    move |[begin, end]| {
        let count = ends.partition_point(|(from, _)| *from < end);
        count.checked_sub(1).and_then(|last| ends.get(last)).is_some_and(|(_, to)| begin < *to)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::test_paths::{paper_limits, polyline};

    #[test]
    fn the_three_belong_together() {
        let (curves, limits) = (polyline(&[[0.0, 0.0], [10.0, 0.0], [10.0, 8.0]]), paper_limits());
        let curves: Vec<_> = curves.iter().map(nurbs_core::NurbsBuf::as_curve).collect();
        let planned = Planned::along(&curves, &limits, EndFeeds::default(), ProfileKind::SCurve).unwrap();
        let limit = FeedLimit::along(&curves, &limits).unwrap();
        let arcs = plan_with(&limit, &limits, EndFeeds::default(), ProfileKind::SCurve).unwrap();
        assert_eq!(planned.limit.length(), limit.length());
        assert_eq!(planned.arcs.stages(), arcs.stages());
        assert_eq!(planned.chords.stages(), limit.in_chords(&curves, &arcs).stages());
        assert_eq!(planned.rests().last().map(|(curve, _)| *curve), Some(curves.len() - 1));
    }
}
