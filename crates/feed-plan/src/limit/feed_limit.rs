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
    /// cannot hold lengths or derivatives, [`PlanError::SpanTooUneven`] where the finest step, 2⁻²⁰ of a span, takes the length
    /// of the path wrongly by more than the distance of a period at full feed.
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
    use crate::test_paths::{
        circle, limit_point, paper_limit_along, paper_limits, polyline, seed_000, seed_003,
    };
    use nurbs_core::{Evaluate, NurbsBuf, arc_length, radius};
    use proptest::prelude::*;

    #[test]
    fn lengths_agree_with_a_reference_of_fifty_digits() {
        for (curve, length) in [
            (seed_000(), 834.706_924_931_909),
            (seed_003(), 134.006_017_053_295),
            (circle(10.0), 62.831_853_071_795_9),
        ] {
            let found = paper_limit_along(&curve).length();
            assert!((found / length - 1.0).abs() < 2e-15 * 10.0, "{found} against {length}");
        }
    }

    #[test]
    fn the_lower_bound_is_close() {
        for curve in [seed_000(), seed_003()] {
            let limit = paper_limit_along(&curve);
            let shares = limit.samples().iter().map(|sample| sample.lower / sample.point.feedrate);
            let least = shares.clone().fold(1.0, f64::min);
            assert!(least > 1.0 - 0.004, "{least}"); // 2⁻⁸ of V², and a quarter more
            let mean = shares.sum::<f64>() / limit.points().len() as f64;
            assert!(mean > 1.0 - 1.5e-3, "{mean}");
        }
    }

    #[test]
    fn the_limit_of_a_circle_is_constant() {
        let limit = paper_limit_along(&circle(10.0));
        let expected = 2.0 * (0.0005 * (20.0 - 0.0005_f64)).sqrt();
        for i in 0..=1000 {
            let at = limit.at(limit.length() * f64::from(i) / 1000.0);
            assert!((at / expected - 1.0).abs() < 1e-12, "{at}");
        }
    }

    #[test]
    fn a_line_is_limited_by_the_feedrate_alone() {
        let line = polyline(&[[0.0, 0.0], [30.0, 40.0]]);
        let limit = paper_limit_along(&line[0]);
        assert!((limit.length() - 50.0).abs() < 1e-13);
        assert!(limit.points().all(|p| p.feedrate == 0.6));
        assert_eq!((limit.at(-1.0), limit.at(25.0), limit.at(99.0)), (0.6, 0.6, 0.6));
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

    /// C'' of the shorter path is 8e4 mm, which I16F16 does not hold; its length needs none. The longer one has 53 m, of which the format
    /// holds 32: the length of its first span is not found.
    #[test]
    fn a_path_that_is_longer_than_the_format_holds_is_refused() {
        use crate::test_paths::{Fixed, in_fixed, in_range};
        let scaled = |scale: f64| {
            let short = seed_000();
            let points = short.control_points().iter().map(|point| point.map(|x| scale * x)).collect();
            NurbsBuf::try_new(short.degree(), points, short.weights().to_vec(), short.knots().to_vec())
                .unwrap()
        };
        in_fixed("I16F16", || {
            let length = |scale: f64| {
                let curve = scaled(scale).convert::<Fixed>().unwrap();
                let limits = in_range::<Fixed>(&paper_limits());
                FeedLimit::along(&[curve.as_curve()], &limits)
                    .map(|limit| real::Backend::to_f64(limit.length()))
            };
            let found = length(1.0).unwrap();
            assert!((found - 834.707).abs() < 0.05, "{found}");
            assert_eq!(length(64.0), Err(PlanError::SpanTooUneven { curve: 0, span: 0 }));
        });
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
            let limit = FeedLimit::along(&[curve], &paper_limits()).map_err(|error| TestCaseError::reject(error.to_string()))?;
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
