//! The feed limit as a function of the distance along the path: samples, and between them values that never exceed the
//! limit.
//!
//! At a corner or a cusp, the limit is 0 at one point only: a *stop*. The feed must be 0 there. On the way to each
//! neighbouring sample, that neighbour's limit holds.

use alloc::vec::Vec;

use nurbs_core::Differentiate;
use real::Real;

use crate::limit::axis_budget::Allowance;
use crate::limit::sample::{LimitSample, ScannedSample, interpolate, lowered};
use crate::limit::scan::{Scan, Scanned};
use crate::limit::stops::release_stops;
use crate::{KinematicLimits, LimitPoint, PlanError};

/// The largest feed that a path allows, as a function of the distance along it.
#[derive(Clone, Debug, PartialEq)]
pub struct FeedLimit<R> {
    pub(super) samples: Vec<LimitSample<R>>,
    /// Distances of the corners: where the tangent breaks.
    pub(super) corners: Vec<R>,
    /// The curves that begin at rest whatever their direction, with their distances. Such a curve may begin elsewhere
    /// than the one before it ends.
    pub(super) from_rest: Vec<(R, usize)>,
}

impl<R: Real> FeedLimit<R> {
    /// The limit along curves that follow each other, each starting where the one before ends.
    ///
    /// The path is sampled at steps of at most about one period at full feed, finer where the limit bends; each local
    /// minimum of the limit is found and becomes a point. Arc length is integrated along the way.
    ///
    /// A break of the tangent becomes a stop if it would, at the feedrate F, cut the corner by more than the chord
    /// error or change the velocity by more than A T: `θ > min(4E/(F T), A T/F)`. With another
    /// [`Junction`](crate::Junction) it becomes a point with the feed that the junction allows, if that is below F.
    /// Two more kinds of points are stops: a point where C' vanishes, as in a cusp; and the point with the least limit
    /// of a bend, if the limit there is below F/4096 or the radius below E/2, since a run slightly off its plan would
    /// skip the bend.
    ///
    /// Breaks of the tangent that are no stops are judged together: the chord of each arc that the plan travels in a
    /// period leaves the path by no more than 1.02 times the chord error, whether the arc passes lines, curves or
    /// breaks. With [`Junction::Deviation`](crate::Junction) the deviation is allowed instead where it is larger; with
    /// [`Junction::VelocityJump`](crate::Junction) a chord ends at a break that would be a stop. The chords of a run
    /// are as long as these arcs, so over a sharp corner they reach further: a step over one corner stays within the
    /// deviation, a step over several may exceed it. The breaks within a period take at most `1 + 2⁻⁸` times the
    /// centripetal acceleration, and the acceleration of each axis, that a bend may take. The jerk of an axis at a
    /// break is not limited.
    ///
    /// Between two points the limit is tested at three places. A bend narrower than a third of the finest step, 2⁻²⁰ of
    /// a span, can be missed.
    ///
    /// Within the chord error E of a stop, the chord error limits the feed no more than at the distance E from it: no
    /// chord that starts and ends there can leave the curve by more than E. The limits of the axes and of the
    /// centripetal acceleration hold up to the stop.
    ///
    /// # Errors
    /// [`PlanError::NotPositive`] for limits that [`validate`](KinematicLimits::validate) refuses,
    /// [`PlanError::PathEmpty`] without curves or length, [`PlanError::LengthOverflows`] when the format
    /// cannot hold lengths or derivatives.
    pub fn along<const D: usize, C: Differentiate<R, D>>(
        curves: &[C],
        limits: &KinematicLimits<R>,
    ) -> Result<Self, PlanError> {
        Self::along_with_stops(curves, limits, &[])
    }

    /// As [`along`](Self::along), with a stop at the begin of each curve whose index is in `stops`. The indices must be
    /// in order. Such an exact stop does not depend on the directions or on the [`Junction`](crate::Junction). Its
    /// curve may begin elsewhere than the one before it ends.
    ///
    /// # Errors
    /// As [`along`](Self::along).
    pub fn along_with_stops<const D: usize, C: Differentiate<R, D>>(
        curves: &[C],
        limits: &KinematicLimits<R>,
        stops: &[usize],
    ) -> Result<Self, PlanError> {
        limits.validate()?;
        Self::scanned(Scan::new(limits), curves, limits, stops)
    }

    /// The same without what is kept of the accelerations and jerks of the axes: for a plan that shares them out itself,
    /// [`plan_within_axes`](crate::plan_within_axes). The velocities of the axes, and their limits at breaks of the tangent and
    /// steps of the curvature, are in it.
    ///
    /// # Errors
    /// As [`along`](Self::along).
    pub fn without_reserves<const D: usize, C: Differentiate<R, D>>(
        curves: &[C],
        limits: &KinematicLimits<R>,
        stops: &[usize],
    ) -> Result<Self, PlanError> {
        limits.validate()?;
        Self::scanned(Scan::new(limits).without_reserves(), curves, limits, stops)
    }

    fn scanned<const D: usize, C: Differentiate<R, D>>(
        scan: Scan<'_, R, D>,
        curves: &[C],
        limits: &KinematicLimits<R>,
        stops: &[usize],
    ) -> Result<Self, PlanError> {
        let mut scan = scan.leaping_along_lines();
        for (index, curve) in curves.iter().enumerate() {
            scan.pass(index, curve, stops.binary_search(&index).is_ok())?;
        }
        scan.finish();
        let Scanned { samples, corners, from_rest } = scan.into_scanned();
        Ok(Self::assemble(samples, corners, limits.chord_error)?.resting_before(from_rest))
    }

    /// The limit where these curves begin at rest whatever their direction, given with the distances of their begins.
    pub(crate) fn resting_before(self, curves: Vec<(R, usize)>) -> Self {
        Self { from_rest: curves, ..self }
    }

    /// Caps the limit on each curve at the curve's own feed, given by its index: the F words of a program. A feed above
    /// the limit changes nothing, and may be infinite.
    ///
    /// # Errors
    /// [`PlanError::CurveFeedNotPositive`] names the first curve whose feed is zero, negative or not a number.
    pub fn capped(mut self, feed_of: impl Fn(usize) -> R) -> Result<Self, PlanError> {
        let positive = |curve: usize| {
            let feed = feed_of(curve);
            if feed > R::zero() { Ok(feed) } else { Err(PlanError::CurveFeedNotPositive { curve }) }
        };
        let mut before = self.samples.first().map_or(0, |sample| sample.point.curve);
        for sample in &mut self.samples {
            let feed = positive(sample.point.curve)?;
            // At a single point between two curves, the feeds of both hold.
            let feed = if sample.is_single { feed.min(positive(before)?) } else { feed };
            before = sample.point.curve;
            let LimitSample { point, lower, lower_before, lower_after, .. } = sample;
            for limit in [&mut point.feedrate, lower, lower_before, lower_after] {
                *limit = limit.min(feed);
            }
        }
        Ok(self)
    }

    /// A limit given by points. Between two of them `V²` is linear in the distance; a single point of feedrate 0 is a
    /// stop.
    ///
    /// Two points of the same distance make a jump. The first distance is 0.
    ///
    /// # Errors
    /// [`PlanError::PointsOutOfOrder`] when a distance is less than the one before, or a value is NaN;
    /// [`PlanError::PathEmpty`] when the last distance is 0.
    pub fn from_points(points: &[LimitPoint<R>]) -> Result<Self, PlanError> {
        let mut previous = R::zero();
        for (index, point) in points.iter().enumerate() {
            let in_order = if index == 0 { point.distance == previous } else { point.distance >= previous };
            if !(in_order
                && point.distance.is_finite()
                && point.feedrate >= R::zero()
                && point.feedrate.is_finite())
            {
                return Err(PlanError::PointsOutOfOrder { index });
            }
            previous = point.distance;
        }
        let samples = points.iter().copied().map(ScannedSample::new).collect();
        Self::assemble(samples, Vec::new(), R::zero())
    }

    /// The limit through complete samples. Within `chord_error` of a stop, the chord error does not limit the feed.
    pub(crate) fn assemble(
        mut samples: Vec<ScannedSample<R>>,
        corners: Vec<R>,
        chord_error: R,
    ) -> Result<Self, PlanError> {
        if !samples.last().is_some_and(|last| last.point.distance > R::zero()) {
            return Err(PlanError::PathEmpty);
        }
        let mut margin_after = R::zero();
        for sample in samples.iter_mut().rev() {
            let margin = sample.margin.max(core::mem::replace(&mut margin_after, sample.margin));
            // No stretch over which the limit could dip begins or ends with a single point.
            let margin = if sample.is_single { R::zero() } else { margin };
            sample.lower = lowered(sample.point.feedrate, margin);
        }
        release_stops(&mut samples, chord_error);
        Ok(Self { samples: LimitSample::all(samples), corners, from_rest: Vec::new() })
    }

    /// The points, in order of distance. Two points of the same distance are the limits on both sides of a joint; at a
    /// corner a stop stands between them.
    #[must_use]
    pub fn points(&self) -> impl ExactSizeIterator<Item = &LimitPoint<R>> + Clone {
        self.samples.iter().map(|sample| &sample.point)
    }

    pub(crate) fn samples(&self) -> &[LimitSample<R>] {
        &self.samples
    }

    /// Arc length of the path, mm.
    #[must_use]
    pub fn length(&self) -> R {
        self.samples.last().map_or_else(R::zero, |sample| sample.point.distance)
    }

    /// A lower bound of the limit at `distance`, which the planner keeps.
    ///
    /// Beyond the ends it is the bound at the end; for NaN it is 0.
    #[must_use]
    pub fn at(&self, distance: R) -> R {
        if distance.partial_cmp(&distance).is_none() {
            return R::zero();
        }
        let distance = distance.max(R::zero()).min(self.length());
        self.minimum_over(distance, distance)
    }

    /// The least lower bound over a stretch within the path.
    pub(crate) fn minimum_over(&self, from: R, to: R) -> R {
        let first = self.count_before(from);
        let end = self.count_up_to(to).max(first);
        let inside = &self.samples[first..end];
        let inside = inside.iter().fold(R::max_value(), |least, sample| least.min(sample.lower));
        let at_from = first.checked_sub(1).map_or(inside, |cell| self.in_cell(cell, from));
        let at_to = end.checked_sub(1).map_or(inside, |cell| self.in_cell(cell, to));
        inside.min(at_from).min(at_to)
    }

    /// Whether the lower bound is the same all over a stretch within the path.
    pub(crate) fn is_level_over(&self, from: R, to: R) -> bool {
        let first = self.count_up_to(from);
        let behind = self.count_before(to).max(first);
        let Some((_, (_, level))) = first.checked_sub(1).and_then(|cell| self.cell(cell)) else {
            return false;
        };
        let is_level = |sample: &LimitSample<R>| sample.lower == level && sample.lower_before == level;
        let inside = self.samples.get(first..behind).unwrap_or_default();
        let begins_level =
            |cell: usize| self.cell(cell).is_some_and(|((_, from), (_, to))| from == level && to == level);
        inside.iter().all(is_level) && (first - 1..behind).all(begins_level)
    }

    /// The lower value at `distance`, between points `cell` and `cell + 1`.
    fn in_cell(&self, cell: usize, distance: R) -> R {
        match self.cell(cell) {
            Some((from, to)) => interpolate(from, to, distance),
            None => R::max_value(),
        }
    }

    /// Distance and lower value at both ends of the stretch between points `cell` and `cell + 1`.
    pub(crate) fn cell(&self, cell: usize) -> Option<((R, R), (R, R))> {
        let (from, to) = (self.samples.get(cell)?, self.samples.get(cell + 1)?);
        Some(((from.point.distance, from.lower_after), (to.point.distance, to.lower_before)))
    }

    /// The limit from `distance` on. Distances still count from the path's start.
    pub(crate) fn beginning_at(mut self, distance: R) -> Self {
        let next = self.count_up_to(distance);
        if next == 0 || next >= self.samples.len() || !(distance > R::zero()) {
            return self;
        }
        let (curve, u) = self.parameter_at(distance);
        let lower = self.minimum_over(distance, distance);
        let after = self.in_cell(next - 1, distance);
        let Some(before) = self.samples.get(next - 1) else { return self };
        let point = LimitPoint { distance, curve, u, feedrate: lower };
        let first = LimitSample { point, is_single: lower < after, ..before.with_lower(lower) };
        self.samples.splice(..next, [LimitSample { lower_after: after, ..first }]);
        self
    }

    /// The acceleration and jerk that the axes leave for the path between two points.
    pub(crate) fn allowance(&self, from: usize, to: usize) -> Allowance<R> {
        let samples = self.samples.get(from + 1..to + 1).unwrap_or_default();
        samples.iter().fold(Allowance::unlimited(), |least, sample| least.min(sample.allowance))
    }

    /// The acceleration and jerk that the axes leave for the path between two distances.
    pub(crate) fn allowance_over(&self, from: R, to: R) -> Allowance<R> {
        let before = self.count_before(from).saturating_sub(1);
        let after = self.count_before(to);
        self.allowance(before, after.min(self.samples.len().saturating_sub(1)))
    }

    /// The samples between two distances, each of which rounding may have moved, and those at both.
    pub(crate) fn samples_between(&self, from: R, to: R) -> &[LimitSample<R>] {
        let rounding = self.rounding();
        let first = self.count_before(from - rounding);
        let behind = self.count_up_to(to + rounding);
        self.samples.get(first..behind).unwrap_or_default()
    }

    /// Whether the path bends between two distances, each of which rounding may have moved.
    pub(crate) fn bends_over(&self, from: R, to: R) -> bool {
        let rounding = self.rounding();
        let first = self.count_up_to(from + rounding);
        let behind = self.count_before(to - rounding) + 1;
        self.samples.iter().take(behind).skip(first).any(|sample| sample.bends)
    }

    /// By how much rounding may have moved a distance.
    pub(crate) fn rounding(&self) -> R {
        R::resolution().ldexp(6) * self.length().max(R::one())
    }

    /// Curve and parameter where a plan comes to rest. Rounding may have moved `distance`, so the place is the nearest
    /// stop or the path's end.
    pub(crate) fn rest_at(&self, distance: R) -> (usize, R) {
        let rounding = self.rounding();
        let first = self.count_before(distance - rounding);
        let off = |point: &LimitPoint<R>| (point.distance - distance).abs();
        let is_rest = |point: &LimitPoint<R>| point.feedrate.is_zero() || point.distance >= self.length();
        let near = self.samples.iter().skip(first).map(|sample| &sample.point);
        let near = near.take_while(|point| point.distance <= distance + rounding);
        let nearest = near.filter(|point| is_rest(point)).fold(None, |nearest, point| match nearest {
            Some(other) if off(other) < off(point) => nearest,
            _ => Some(point),
        });
        nearest.map_or_else(|| self.parameter_at(distance), |point| (point.curve, point.u))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Junction;
    use crate::test_paths::{
        Power, circle, hairpin, limit_along, limit_point, paper_limits, polyline, seed_000, seed_003,
        triple_knot,
    };
    use nurbs_core::{Evaluate, NurbsBuf, arc_length, radius};
    use proptest::prelude::*;

    fn along(curve: &NurbsBuf<f64, 2>) -> FeedLimit<f64> {
        limit_along(core::slice::from_ref(curve), &paper_limits())
    }

    fn longest_step(limit: &FeedLimit<f64>) -> f64 {
        let steps = limit.points().zip(limit.points().skip(1)).map(|(from, to)| to.distance - from.distance);
        steps.fold(0.0, f64::max)
    }

    fn least_lower(limit: &FeedLimit<f64>) -> f64 {
        limit.samples().iter().fold(f64::MAX, |least, sample| least.min(sample.lower))
    }

    /// The points at which the limit is 0.
    fn rests(limit: &FeedLimit<f64>) -> Vec<LimitPoint<f64>> {
        limit.samples().iter().filter(|sample| sample.lower == 0.0).map(|sample| sample.point).collect()
    }

    #[test]
    fn lengths_agree_with_a_reference_of_fifty_digits() {
        for (curve, length) in [
            (seed_000(), 834.706_924_931_909),
            (seed_003(), 134.006_017_053_295),
            (circle(10.0), 62.831_853_071_795_9),
        ] {
            let found = along(&curve).length();
            assert!((found / length - 1.0).abs() < 2e-15 * 10.0, "{found} against {length}");
        }
    }

    #[test]
    fn local_minima_are_points() {
        let limit = along(&seed_000());
        // V in mm/s found independently; u by solving for the extreme of the curvature with 40 digits.
        for (u, feedrate) in [
            (0.100_366_38, 111.4817),
            (0.302_844_95, 104.8954),
            (0.697_155_05, 104.8954),
            (0.899_633_62, 111.4817),
        ] {
            let near = limit.points().filter(|p| (p.u - u).abs() < 1e-3);
            let least = near.min_by(|a, b| a.feedrate.total_cmp(&b.feedrate)).unwrap();
            assert!((least.feedrate / 3e-3 - feedrate).abs() < 1e-4, "u={u}: {}", least.feedrate / 3e-3);
            assert!((least.u - u).abs() < 2e-8, "u={u}: {}", least.u);
        }
    }

    #[test]
    fn a_span_is_walked_to_its_end_in_small_steps() {
        // In the fourth span the walk once refused a step of the finest width for ever: rounding had made the step
        // slightly wider. The rest of the span became one stretch of 15 mm.
        let points = [
            [0., 0.],
            [0., 0.],
            [0., 0.],
            [37.123, 2.211],
            [2.295, 28.871],
            [27.731, 9.455],
            [33.568, 58.128],
            [0., 0.],
        ];
        let knots = [0., 0., 0., 0., 0.2, 0.4, 0.6, 0.8, 1., 1., 1., 1.];
        let curve = NurbsBuf::try_new(3, points.to_vec(), vec![1.0; 8], knots.to_vec()).unwrap();
        let limit = along(&curve);
        let longest = longest_step(&limit);
        assert!(longest <= 1.2, "{longest}");
        let reference = arc_length(&curve.as_curve(), 0.0, 1.0, 1e-13).length;
        assert!((limit.length() / reference - 1.0).abs() < 1e-12, "{} {reference}", limit.length());
    }

    #[test]
    fn points_are_about_a_period_apart() {
        let limit = along(&seed_000());
        let longest = longest_step(&limit);
        assert!(longest <= 1.2, "{longest}"); // 2 F T
        assert!(limit.points().len() < 2 * 834 * 10 / 6, "{}", limit.points().len());
    }

    #[test]
    fn the_lower_bound_is_close() {
        for curve in [seed_000(), seed_003()] {
            let limit = along(&curve);
            let shares = limit.samples().iter().map(|sample| sample.lower / sample.point.feedrate);
            let least = shares.clone().fold(1.0, f64::min);
            assert!(least > 1.0 - 0.004, "{least}"); // 2⁻⁸ of V², and a quarter more
            let mean = shares.sum::<f64>() / limit.points().len() as f64;
            assert!(mean > 1.0 - 1.5e-3, "{mean}");
        }
    }

    #[test]
    fn the_limit_of_a_circle_is_constant() {
        let limit = along(&circle(10.0));
        let expected = 2.0 * (0.0005 * (20.0 - 0.0005_f64)).sqrt();
        for i in 0..=1000 {
            let at = limit.at(limit.length() * f64::from(i) / 1000.0);
            assert!((at / expected - 1.0).abs() < 1e-12, "{at}");
        }
    }

    #[test]
    fn a_line_is_limited_by_the_feedrate_alone() {
        let line = polyline(&[[0.0, 0.0], [30.0, 40.0]]);
        let limit = along(&line[0]);
        assert!((limit.length() - 50.0).abs() < 1e-13);
        assert!(limit.points().all(|p| p.feedrate == 0.6));
        assert_eq!((limit.at(-1.0), limit.at(25.0), limit.at(99.0)), (0.6, 0.6, 0.6));
    }

    #[test]
    fn a_corner_is_a_stop_between_two_full_feeds() {
        let limit = along(&triple_knot());
        let points: Vec<_> = limit.points().collect();
        let stop = points.iter().position(|p| p.feedrate == 0.0).unwrap();
        let around = &points[stop - 1..=stop + 1];
        assert!(around.iter().all(|p| p.distance == around[0].distance), "{around:?}");
        assert!((around[0].feedrate, around[2].feedrate) == (0.6, 0.6), "{around:?}");
        assert_eq!(limit.at(around[1].distance), 0.0);
        assert_eq!(limit.at(around[1].distance + 1e-9), 0.6);
    }

    #[test]
    fn an_exact_stop_is_one_without_a_corner_and_whatever_the_junction() {
        let path = polyline(&[[0.0, 0.0], [10.0, 0.0], [20.0, 0.0], [20.0, 10.0]]);
        let curves: Vec<_> = path.iter().map(NurbsBuf::as_curve).collect();
        let limits = KinematicLimits { junction: crate::Junction::Deviation(0.1), ..paper_limits() };
        let stops = |stops: &[usize]| {
            let limit = FeedLimit::along_with_stops(&curves, &limits, stops).unwrap();
            let rests = limit.points().filter(|p| p.feedrate == 0.0);
            rests.map(|p| (p.curve, p.distance.round())).collect::<Vec<_>>()
        };
        assert!(stops(&[]).is_empty());
        assert_eq!(stops(&[1]), [(1, 10.0)]);
        // The first curve begins at rest anyway.
        assert_eq!(stops(&[0, 1, 2]), [(1, 10.0), (2, 20.0)]);
    }

    #[test]
    fn a_break_too_small_to_matter_is_no_stop() {
        // θ may be 4E/(F T) = 1/300, so that the chord over it leaves the corner by no more than E.
        let stops = |angle: f64| {
            let path = polyline(&[[0.0, 0.0], [10.0, 0.0], [20.0, 10.0 * angle]]);
            let limit = limit_along(&path, &paper_limits());
            limit.points().filter(|p| p.feedrate == 0.0).count()
        };
        assert_eq!((stops(0.0033), stops(0.0034)), (0, 1));
    }

    /// A break too small for a stop was once passed at full feed whatever the junction allowed.
    #[test]
    fn a_small_break_keeps_the_limit_of_its_junction() {
        let angle = 0.0033;
        let path = polyline(&[[0.0, 0.0], [20.0, 0.0], [40.0, 20.0 * angle]]);
        let at_break = |junction| {
            let limits = KinematicLimits { junction, ..paper_limits() };
            let limit = limit_along(&path, &limits);
            assert!(crate::plan(&limit, &limits, crate::EndFeeds::default()).is_ok());
            least_lower(&limit)
        };
        assert_eq!(at_break(Junction::Stop), 0.6);
        // 1e-4 over the greater component of e₂ - e₁, which is sin θ.
        let expected = 1e-4 / angle.atan().sin();
        let found = at_break(Junction::VelocityJump([1e-4; 3]));
        assert!((found / expected - 1.0).abs() < 1e-9, "{found} for {expected}");
        assert_eq!(at_break(Junction::VelocityJump([2e-3; 3])), 0.6); // 0.6 · 0.0033 = 1.98e-3
        // By the chord 2δ/tan(θ/2) = 0.0303; by the acceleration √(0.045 · 2.5e-5 · 7.3e5) = 0.91.
        let expected = 2.0 * 2.5e-5 / (angle.atan() / 2.0).tan();
        let found = at_break(Junction::Deviation(2.5e-5));
        assert!((found / expected - 1.0).abs() < 1e-9, "{found} for {expected}");
        assert_eq!(at_break(Junction::Deviation(1e-3)), 0.6);
    }

    /// A right angle within 0.1 mm: `V² = a δ/(√2 - 1)`.
    #[test]
    fn a_corner_is_rounded_with_no_more_than_the_centripetal_acceleration() {
        let path = polyline(&[[0.0, 0.0], [20.0, 0.0], [20.0, 20.0]]);
        for (centripetal, acceleration) in [(None, 0.045), (Some(0.01), 0.01), (Some(0.1), 0.045)] {
            let limits = KinematicLimits {
                junction: Junction::Deviation(0.1),
                centripetal_acceleration: centripetal,
                ..paper_limits()
            };
            let limit = limit_along(&path, &limits);
            let found = least_lower(&limit);
            let expected = (acceleration * 0.1 / (2.0_f64.sqrt() - 1.0)).sqrt();
            assert!((found / expected - 1.0).abs() < 1e-9, "{centripetal:?}: {found} for {expected}");
        }
    }

    #[test]
    fn a_cusp_is_a_stop_wherever_its_parameter_lies() {
        // Length of (10 t², 10 t³) from 0 to T: 10/27 ((4 + 9T²)^1.5 - 8).
        let length = |t: f64| 10.0 / 27.0 * ((4.0 + 9.0 * t * t).powf(1.5) - 8.0);
        for cusp in [0.5, 0.25, 0.31, 0.777_777, 1.0 / 3.0] {
            let curve = Power { origin: cusp, exponents: [2, 3], scale: 10.0 };
            let limit = FeedLimit::along(&[curve], &paper_limits()).unwrap();
            assert!((limit.length() - length(cusp) - length(1.0 - cusp)).abs() < 1e-6, "{}", limit.length());
            let stops = rests(&limit);
            assert_eq!(stops.len(), 1, "cusp at {cusp}: {stops:?}");
            assert!((stops[0].u - cusp).abs() < 1e-4 && (stops[0].distance - length(cusp)).abs() < 1e-6);
            let plan = crate::plan(&limit, &paper_limits(), crate::EndFeeds::default()).unwrap();
            assert!(
                plan.stages().iter().any(|s| s.start_feed == 0.0 && (s.start - length(cusp)).abs() < 1e-6)
            );
        }
    }

    #[test]
    fn a_bend_narrower_than_the_chord_error_is_a_stop() {
        // E/2 = 2.5e-4 mm.
        for (width, radius, expected) in [(0.04, 1.5e-5, 1), (0.16, 2.4e-4, 1), (0.168, 2.646e-4, 0)] {
            let curve = hairpin(width);
            assert!((nurbs_core::radius(&curve.as_curve().derivatives(0.5)) - radius).abs() < 1e-12);
            let limit = along(&curve);
            let rests: Vec<_> = rests(&limit).iter().map(|point| point.u).collect();
            assert_eq!(rests.len(), expected, "{width}: {rests:?}");
            assert!(rests.iter().all(|u| (u - 0.5).abs() < 1e-3), "{rests:?}");
        }
    }

    /// F/4096 is 0.05 mm a period, a hundred times the chord error. Each place with a limit below that was once a stop,
    /// and each stop released the places beside it. Of a bend of some tenths of a mm a single stop was left, and no
    /// limit.
    #[test]
    fn beside_the_stop_in_a_bend_its_limit_holds() {
        let limits = KinematicLimits { feedrate: 200.0, ..paper_limits() };
        let curve = hairpin(1.0);
        let limit = limit_along(core::slice::from_ref(&curve), &limits);
        let stops: Vec<_> = limit.points().filter(|point| point.feedrate == 0.0).collect();
        assert!(stops.len() == 1 && (stops[0].u - 0.5).abs() < 1e-3, "{stops:?}");
        let mut slow = 0;
        for point in limit.points() {
            let allowed = limits.feedrate_at_radius(radius(&curve.as_curve().derivatives(point.u)));
            let is_near_stop = (point.distance - stops[0].distance).abs() <= limits.chord_error;
            slow += u32::from(allowed < limits.feedrate / 4096.0);
            assert!(
                is_near_stop || limit.at(point.distance) <= allowed * (1.0 + 1e-9),
                "{point:?}: {allowed}"
            );
        }
        assert!(slow > 20, "{slow}");
    }

    /// From the stop on, the limit of the next point was once held: that point was 30 mm away.
    #[test]
    fn a_stop_releases_the_limit_within_the_chord_error_only() {
        let points =
            [(0.0, 0.0), (0.0, 0.2), (30.0, 0.8), (60.0, 0.2), (60.0, 0.0), (60.0, 0.6), (90.0, 0.6)];
        let samples = points.map(|(distance, feed)| ScannedSample::new(limit_point(distance, feed)));
        let limit = FeedLimit::assemble(samples.to_vec(), Vec::new(), 0.01).unwrap();
        // V² is linear: 0.04 to 0.64 over 30 mm.
        let wanted = |beyond: f64| Real::sqrt(0.04 + 0.6 * beyond / 30.0);
        for beyond in [0.005, 0.02, 0.1, 1.0, 7.0, 29.0] {
            let (above, least) = (wanted(beyond).powi(2) * (1.0 + 0.01 / beyond), wanted(beyond));
            for at in [beyond, 60.0 - beyond] {
                let found = limit.at(at);
                assert!(
                    found >= least * (1.0 - 1e-12) && found.powi(2) <= above * (1.0 + 1e-12),
                    "{at}: {found}"
                );
            }
        }
        assert_eq!(limit.at(61.0), 0.6);
    }

    #[test]
    fn a_fast_start_of_the_parameter_is_no_cusp() {
        // (t³, t⁶): C' = 0 at the start, then a parabola.
        let curve = Power { origin: 0.0, exponents: [3, 6], scale: 10.0 };
        let limit = FeedLimit::along(&[curve], &paper_limits()).unwrap();
        assert!(crate::plan(&limit, &paper_limits(), crate::EndFeeds::default()).is_ok());
        assert_eq!(rests(&limit).len(), 1);
    }

    /// Moves that turn by a little, along which nothing lowers the limit: before, a move had between 6 and 17 samples.
    #[test]
    fn a_straight_line_has_samples_at_its_ends_alone() {
        let points: Vec<_> = (0..=100).map(|i| [5.0 * f64::from(i), 1e-4 * f64::from(i % 2)]).collect();
        let limit = limit_along(&polyline(&points), &paper_limits());
        assert_eq!(limit.points().len(), 200);
        for (number, ends) in limit.samples().chunks(2).enumerate() {
            assert!(ends.iter().all(|end| end.lower == 0.6 && (end.speed - 5.0).abs() < 1e-8), "{ends:?}");
            let places = ends.iter().map(|end| (end.point.curve, end.point.u));
            assert!(places.eq([(number, 0.0), (number, 1.0)]), "{ends:?}");
        }
        // Through a window, a line has a sample a period.
        let limits = paper_limits();
        let mut scan = Scan::new(&limits);
        scan.pass(0, &polyline(&[[0.0, 0.0], [60.0, 0.0]])[0].as_curve(), false).unwrap();
        assert_eq!(scan.samples().len(), 101);
    }

    #[test]
    fn parameters_follow_the_arc_length() {
        let curve = seed_003();
        let limit = along(&curve);
        for i in 0..=500 {
            let u = f64::from(i) / 500.0;
            let distance = arc_length(&curve.as_curve(), 0.0, u, 1e-12).length;
            let (index, found) = limit.parameter_at(distance);
            assert!(index == 0 && (found - u).abs() < 1e-6, "{u}: {found}");
        }
    }

    /// Where the speed along a curve changes a thousandfold within a span, distances were once off by half of a
    /// stretch, and so were the lengths by which stages were shortened.
    #[test]
    fn parameters_follow_the_arc_length_where_the_speed_changes_much() {
        let points = vec![[0.0, 0.0], [40.0, 30.0], [80.0, 0.0]];
        let knots = vec![0.0, 0.0, 0.0, 1.0, 1.0, 1.0];
        let curve = NurbsBuf::try_new(2, points, vec![1e-3, 1.0, 1e3], knots).unwrap();
        let limit = along(&curve);
        for i in 1..=400 {
            let u = (f64::from(i) / 400.0).powi(4);
            let distance = arc_length(&curve.as_curve(), 0.0, u, 1e-12).length;
            let (_, found) = limit.parameter_at(distance);
            let off = arc_length(&curve.as_curve(), u.min(found), u.max(found), 1e-12).length;
            assert!(off < 1e-3, "{u}: {off} mm at {distance} mm");
        }
    }

    #[test]
    fn refused_points_are_named() {
        let from = |points: &[LimitPoint<f64>]| FeedLimit::from_points(points).map(|limit| limit.length());
        assert_eq!(from(&[]), Err(PlanError::PathEmpty));
        assert_eq!(from(&[limit_point(0.0, 1.0)]), Err(PlanError::PathEmpty));
        assert_eq!(
            from(&[limit_point(0.5, 1.0), limit_point(2.0, 1.0)]),
            Err(PlanError::PointsOutOfOrder { index: 0 })
        );
        let falling = [limit_point(0.0, 1.0), limit_point(2.0, 1.0), limit_point(1.0, 1.0)];
        assert_eq!(from(&falling), Err(PlanError::PointsOutOfOrder { index: 2 }));
        assert_eq!(
            from(&[limit_point(0.0, 1.0), limit_point(1.0, f64::NAN)]),
            Err(PlanError::PointsOutOfOrder { index: 1 })
        );
        let none: [NurbsBuf<f64, 2>; 0] = [];
        let curves = none.each_ref().map(NurbsBuf::as_curve);
        assert_eq!(FeedLimit::along(&curves, &paper_limits()).map(|l| l.length()), Err(PlanError::PathEmpty));
        let still = polyline(&[[1.0, 1.0], [1.0, 1.0]]);
        assert_eq!(
            FeedLimit::along(&[still[0].as_curve()], &paper_limits()).map(|l| l.length()),
            Err(PlanError::PathEmpty)
        );
    }

    #[test]
    fn a_format_that_overflows_says_so() {
        use real::I16F16;
        let curve = seed_000().convert::<I16F16>().unwrap();
        let limits = crate::test_paths::in_range::<I16F16>(&paper_limits());
        // C'' is 8e4 mm here: more than the format holds.
        let outcome = FeedLimit::along(&[curve.as_curve()], &limits);
        assert!(outcome.is_err() || outcome.is_ok_and(|limit| limit.points().len() > 1));
    }

    proptest! {
        #![proptest_config(ProptestConfig::with_cases(64))]

        #[test]
        fn the_lower_bound_is_one(
            points in prop::collection::vec(prop::array::uniform2(0.0..60.0_f64), 4..10), places in prop::collection::vec(0.0..1.0_f64, 20),
        ) {
            let inner = points.len() - 4;
            let knots = [0.0; 4].into_iter().chain((1..=inner).map(|i| i as f64 / (inner + 1) as f64)).chain([1.0; 4]);
            let curve = NurbsBuf::try_new(3, points.clone(), vec![1.0; points.len()], knots.collect()).unwrap();
            let curve = curve.as_curve();
            let Ok(limit) = FeedLimit::along(&[curve], &paper_limits()) else { return Ok(()) };
            for u in places {
                let derivatives = nurbs_core::Differentiate::derivatives(&curve, u);
                let exact = paper_limits().feedrate_at_radius(radius(&derivatives));
                let distance = arc_length(&curve, curve.domain().0, u, 1e-13).length;
                let bound = limit.at(distance);
                let released = limit.points().any(|p| p.feedrate == 0.0 && (p.distance - distance).abs() < 2e-3);
                prop_assert!(released || bound <= exact * (1.0 + 1e-9), "u={u}: {bound} above {exact}");
            }
        }
    }
}
