//! The way from rest to rest in parts, each along the fastest profile or in S-curves.
//!
//! It is one part where every move leaves the path the same acceleration and jerk, and where the pieces found break no limit by more
//! than an even stretch heals. Else it is cut at key points, which are passed without acceleration:
//!
//! - where an axis leaves the path more or less than before, as from moves in the plane to a plunge;
//! - on both sides of an arc that breaks a limit, so that what is beside it is not stretched with it.
//!
//! A part of a way that is cut is one of S-curves where these are faster, and so is a way on which the jerk costs much time. All
//! parts are stretched evenly at the end, so the feeds at the cuts agree.

use alloc::vec::Vec;

use real::Real;

use crate::limit::axis_budget::Allowance;
use crate::plan::fastest::fastest::{Ends, Most, section};
use crate::plan::fastest::fit::{Fit, HARD, rounding};
use crate::plan::fastest::sections::{monotone, stage};
use crate::plan::key_points::Key;
use crate::plan::ramp_shape::RampShape;
use crate::plan::ramps::chain;
use crate::plan::stages::Stages;
use crate::schedule::stage::duration;
use crate::{FeedLimit, KinematicLimits, PlanError, Stage};

/// The limits along a part differ by no more than 2⁻¹³: the fastest plan is one S-curve up and one down.
const LEVEL: i32 = -13;
/// A plan that takes longer than without a limit of the jerk by no more than 2⁻⁵ is compared with no other. Where it does, minima are so
/// near to each other that the accelerations at them depend on each other, and S-curves may be faster.
const BY_JERK: i32 = -5;
/// The whole way, where it cannot be cut, is stretched by no more than 2⁻⁶. A part of it is not hard, since all others are stretched
/// with it.
const MOST_STRETCHED: i32 = -6;
/// Moves belong together where what they leave differs by no more than 2⁻⁵.
const SAME: i32 = -5;
/// How often a part is cut again.
const CUTS: usize = 3;

/// The keys of a section from rest to rest, and its S-curves.
pub(crate) struct SectionKeys<'a, R> {
    pub(crate) all: &'a [Key<R>],
    /// Its S-curves, or why there are none.
    pub(crate) slow: Result<SlowWay<'a, R>, PlanError>,
}

/// The keys that can be reached from each other, and the transitions between them.
#[derive(Clone, Copy)]
pub(crate) struct SlowWay<'a, R> {
    pub(crate) reached: &'a [Key<R>],
    pub(crate) curves: &'a [Stage<R>],
}

/// The stages of a section.
pub(crate) fn in_parts<R: Real>(
    limit: &FeedLimit<R>,
    limits: &KinematicLimits<R>,
    shape: &RampShape<R>,
    &SectionKeys { all: keys, slow }: &SectionKeys<'_, R>,
) -> Result<Vec<Stage<R>>, PlanError> {
    let [first, .., last] = keys else { return Ok(Vec::new()) };
    let curves = slow.map_or(&[][..], |slow| slow.curves);
    let all = Allowance::of_path(limits);
    let mut parts = Parts {
        limit,
        shape,
        period: limits.interpolation_period,
        ends: [first.point, last.point],
        curves,
        stages: Vec::new(),
        stretch: R::zero(),
    };
    let left = limit.allowance(first.point, last.point).min(all);
    if left == all {
        let found = parts.fit(keys, all);
        let is_sure = |fit: &Fit<R>| {
            fit.stretch <= R::one().ldexp(HARD) && fit.duration() - fit.free <= fit.free.ldexp(BY_JERK)
        };
        match found {
            Some(fit) if is_sure(&fit) => parts.take(&fit),
            found => parts.settle(slow?.reached, all, found, CUTS)?,
        }
        return Ok(parts.finished());
    }
    for part in alike(slow?.reached, all) {
        parts.plan(part, all, CUTS)?;
    }
    Ok(parts.finished())
}

/// Whether the limit is the same all along a part, as on a straight move.
fn is_level<R: Real>(limit: &FeedLimit<R>, [first, last]: [usize; 2]) -> bool {
    let Some([begin, inner @ .., end]) = limit.samples().get(first..=last) else { return false };
    let ends = [begin.lower_after, end.lower_before];
    let feeds = || inner.iter().map(|sample| sample.lower).chain(ends);
    let (low, high) = (feeds().fold(ends[0], R::min), feeds().fold(ends[0], R::max));
    high - low <= low.ldexp(LEVEL)
}

/// What the moves between keys leave at least.
fn least<R: Real>(keys: &[Key<R>], all: Allowance<R>) -> Allowance<R> {
    keys.iter().skip(1).fold(all, |least, key| least.min(key.allowance))
}

/// The keys in parts whose moves leave nearly the same; neighbours share a key.
fn alike<R: Real>(keys: &[Key<R>], all: Allowance<R>) -> Vec<&[Key<R>]> {
    let is_near = |a: R, b: R| a.max(b) - a.min(b) <= a.max(b).ldexp(SAME);
    let mut parts = Vec::new();
    let mut begin = 0;
    let mut here: Option<Allowance<R>> = None;
    for (k, key) in keys.iter().enumerate().skip(1) {
        let left = key.allowance.min(all);
        match here {
            Some(same)
                if !(is_near(same.acceleration, left.acceleration) && is_near(same.jerk, left.jerk)) =>
            {
                parts.extend(keys.get(begin..k));
                (begin, here) = (k - 1, Some(left));
            }
            Some(_) => {}
            None => here = Some(left),
        }
    }
    parts.extend(keys.get(begin..));
    parts
}

/// The keys in parts: one from the key before each of these ways to the key behind it, and what lies between.
fn around<'k, R: Real>(keys: &'k [Key<R>], ways: &[[R; 2]]) -> Vec<&'k [Key<R>]> {
    let last = keys.len().saturating_sub(1);
    let mut cuts = Vec::from([0]);
    for [begin, end] in ways {
        let before = keys.partition_point(|key| key.distance <= *begin).saturating_sub(1);
        let behind = keys.partition_point(|key| key.distance < *end).min(last);
        for cut in [before, behind] {
            if cuts.last().is_some_and(|other| *other < cut) {
                cuts.push(cut);
            }
        }
    }
    if cuts.last().is_some_and(|other| *other < last) {
        cuts.push(last);
    }
    cuts.windows(2).filter_map(|pair| keys.get(pair[0]..=pair[1])).collect()
}

struct Parts<'a, R> {
    limit: &'a FeedLimit<R>,
    shape: &'a RampShape<R>,
    period: R,
    /// Where the section begins and ends.
    ends: [usize; 2],
    /// The S-curves of the whole section; empty if there are none.
    curves: &'a [Stage<R>],
    stages: Vec<Stage<R>>,
    /// By how much all of them must be stretched, as a share.
    stretch: R,
}

impl<R: Real> Parts<'_, R> {
    /// Adds the way along these keys, which may be cut so many times.
    fn plan(&mut self, keys: &[Key<R>], all: Allowance<R>, cuts: usize) -> Result<(), PlanError> {
        let found = self.fit(keys, least(keys, all));
        self.settle(keys, all, found, cuts)
    }

    /// Adds what was found along these keys, or their parts, or S-curves.
    fn settle(
        &mut self,
        keys: &[Key<R>],
        all: Allowance<R>,
        found: Option<Fit<R>>,
        cuts: usize,
    ) -> Result<(), PlanError> {
        let [first, .., last] = keys else { return Ok(()) };
        // What is not hard has no hard arcs, and is one part.
        let parts = found.as_ref().map_or_else(Vec::new, |fit| around(keys, &fit.hard));
        if cuts > 0 && parts.len() > 1 {
            return parts.into_iter().try_for_each(|part| self.plan(part, all, cuts - 1));
        }
        let most = if self.is_whole(first, last) { MOST_STRETCHED } else { HARD };
        let quick = found.filter(|fit| fit.stretch <= R::one().ldexp(most));
        let mut part = Stages::new(self.limit);
        let slow = if self.is_whole(first, last) {
            self.curves
        } else {
            chain(self.limit, self.shape, keys, &mut part)?;
            part.all()
        };
        match quick {
            Some(fit) if fit.duration() + fit.duration() * fit.stretch < duration(slow) => self.take(&fit),
            _ => self.stages.extend_from_slice(slow),
        }
        Ok(())
    }

    fn is_whole(&self, first: &Key<R>, last: &Key<R>) -> bool {
        [first.point, last.point] == self.ends
    }

    /// The pieces from the first key to the last, with what is left of acceleration and jerk; none where the limit is level.
    fn fit(&self, keys: &[Key<R>], left: Allowance<R>) -> Option<Fit<R>> {
        let [from, .., to] = keys else { return None };
        let points = [from.point, to.point];
        if is_level(self.limit, points) {
            return None;
        }
        let most = Most { acceleration: left.acceleration, jerk: left.jerk, period: self.period };
        section(self.limit, &Ends { points, feeds: [from.feed, to.feed], start: R::zero() }, &most)
    }

    fn take(&mut self, fit: &Fit<R>) {
        let pieces = fit.pieces.iter().flat_map(|piece| monotone(piece).into_iter().flatten());
        self.stages.extend(pieces.map(|piece| stage(&piece)));
        self.stretch = self.stretch.max(fit.stretch + rounding());
    }

    fn finished(self) -> Vec<Stage<R>> {
        let slower = R::one() + self.stretch;
        self.stages.iter().map(|stage| stage.slowed(slower)).collect()
    }
}

#[cfg(test)]
mod tests {
    use crate::plan::look_ahead::stages;
    use crate::test_paths::{hashed, limit_through, paper_limits, polyline, seed_003};
    use crate::{AxisLimits, EndFeeds, FeedLimit, Junction, KinematicLimits, ProfileKind, least_duration};
    use nurbs_core::NurbsBuf;

    /// Before whole periods.
    fn duration(limit: &FeedLimit<f64>, limits: &KinematicLimits<f64>, kind: ProfileKind) -> f64 {
        let stages = stages(limit, limits, EndFeeds::default(), None, kind).unwrap();
        stages.iter().map(|stage| stage.duration).sum()
    }

    /// Levels of feed for some millimetres each, with a steep step from each to the next.
    fn staircase(count: u64) -> Vec<(f64, f64)> {
        let share = |i: u64, bits: u32| f64::from(hashed(i) >> bits & 0xff) / 256.0;
        let mut s = 0.0;
        let steps = (0..count).flat_map(|i| {
            let (begin, length, feed) = (s, 0.5 + 20.0 * share(i, 0), 0.05 + 0.4 * share(i, 8));
            s += length + 0.36;
            [(begin, feed), (begin + length, feed)]
        });
        steps.collect()
    }

    /// Between two steps there were no nodes, so that no arc fitted and a whole section was stretched or made of S-curves.
    #[test]
    fn staircases_are_near_their_bound() {
        for jerk in [2e-3, 1e-2, 5e-2] {
            let limits = KinematicLimits { jerk, ..paper_limits() };
            let limit = limit_through(&staircase(200));
            let bound = least_duration(&limit, &limits, EndFeeds::default());
            let [fast, curves] =
                [ProfileKind::Fastest, ProfileKind::SCurve].map(|kind| duration(&limit, &limits, kind));
            assert!(fast < 1.02 * bound && fast < curves, "J {jerk}: {fast}, bound {bound}");
        }
    }

    /// An acceleration that the jerk has in less than the shortest piece was taken for none: no arc fitted, each was tried again from the
    /// first on, and after half a minute the plan was one of S-curves.
    #[test]
    fn an_acceleration_that_is_there_at_once_is_used() {
        let slow = AxisLimits { acceleration: Some(1e-5), ..AxisLimits::default() };
        let limits = KinematicLimits { axes: [AxisLimits::default(), slow, slow], ..paper_limits() };
        let limit = FeedLimit::along(&[seed_003().as_curve()], &limits).unwrap();
        let plan = |kind| stages(&limit, &limits, EndFeeds::default(), None, kind).unwrap();
        let [fast, curves] = [ProfileKind::Fastest, ProfileKind::SCurve].map(plan);
        let [fast_time, curves_time] =
            [&fast, &curves].map(|stages| stages.iter().map(|stage| stage.duration).sum::<f64>());
        assert!(
            fast_time <= curves_time && 2 * fast.len() < curves.len(),
            "{fast_time} {curves_time} {} {}",
            fast.len(),
            curves.len()
        );
    }

    /// Distances from the path's begin were too coarse for the caps of a path of some metres.
    #[test]
    fn what_lies_far_along_a_path_is_planned_as_what_lies_at_its_begin() {
        let limits = KinematicLimits { jerk: 2e-3, ..paper_limits() };
        let once = staircase(40);
        let length = once.last().unwrap().0 + 1.0;
        let often = |count: u32| -> Vec<_> {
            let at = |k: u32| once.iter().map(move |(s, v)| (s + f64::from(k) * length, *v));
            (0..count).flat_map(at).collect()
        };
        let [few, many] = [5, 100].map(|count| {
            let limit = limit_through(&often(count));
            duration(&limit, &limits, ProfileKind::Fastest) / f64::from(count)
        });
        assert!(many < few * 1.0005, "{few} {many}");
    }

    /// One axis accelerates less than the others. What it leaves on its own moves held for the whole way: plans of engravings took up
    /// to 9 % longer than S-curves.
    #[test]
    fn a_slow_axis_slows_its_own_moves_alone() {
        let axes = [0.002, 0.01].map(|a| AxisLimits { acceleration: Some(a), ..AxisLimits::default() });
        let none = AxisLimits::default();
        for slow in axes {
            let junction = Junction::Deviation(0.01);
            let limits = KinematicLimits { jerk: 2e-3, axes: [none, slow, none], junction, ..paper_limits() };
            let mut points = vec![[0.0, 0.0]];
            for i in 0..60 {
                let [x, y] = points[points.len() - 1];
                points.push([x + 3.0 + f64::from(hashed(i) & 7), y]);
                if i % 10 == 9 {
                    points.push([x + 12.0, y + 2.0]);
                }
            }
            let curves = polyline(&points);
            let curves: Vec<_> = curves.iter().map(NurbsBuf::as_curve).collect();
            let limit = FeedLimit::along(&curves, &limits).unwrap();
            let [fast, curves] =
                [ProfileKind::Fastest, ProfileKind::SCurve].map(|kind| duration(&limit, &limits, kind));
            assert!(fast <= curves * (1.0 + 1e-4), "{fast} {curves}");
        }
    }
}
