//! One pass along the path: samples of the feed limit over the arc length.
//!
//! The samples of each span are appended to the path. If a junction has a feed of its own, a single point with that
//! feed comes before them; at a corner with a stop, the feed is 0.

use alloc::vec::Vec;

use nurbs_core::{Differentiate, tangent_breaks};
use real::Real;

use crate::limit::fine_moves::FineMoves;
use crate::limit::junctions::{Junctions, Turn};
use crate::limit::sample::{ScannedSample, lowered};
use crate::limit::span_walk::{Sample, Sampling, Span, Station, Stretch};
use crate::{KinematicLimits, LimitPoint, PlanError};

/// The samples of the path so far.
pub(crate) struct Scan<'l, R, const D: usize> {
    sampling: Sampling<'l, R>,
    junctions: Junctions<'l, R>,
    distance: R,
    /// Tangent and curvature vector at the end of the path so far.
    end: Option<([R; D], [R; D])>,
    samples: Vec<ScannedSample<R>>,
    /// The limit that several breaks of the tangent within one step make together.
    fine_moves: FineMoves<R, D>,
    /// Distances at which the tangent breaks.
    corners: Vec<R>,
    /// The curves that begin at rest, with their distances.
    from_rest: Vec<(R, usize)>,
}

/// What a scan finds along a path.
pub(crate) struct Scanned<R> {
    pub(crate) samples: Vec<ScannedSample<R>>,
    /// Distances at which the tangent breaks.
    pub(crate) corners: Vec<R>,
    /// The curves that begin at rest, with their distances.
    pub(crate) from_rest: Vec<(R, usize)>,
}

impl<'l, R: Real, const D: usize> Scan<'l, R, D> {
    pub(crate) fn new(limits: &'l KinematicLimits<R>) -> Self {
        Self {
            sampling: Sampling::new(limits),
            junctions: Junctions::new(limits),
            distance: R::zero(),
            end: None,
            samples: Vec::new(),
            fine_moves: FineMoves::new(limits),
            corners: Vec::new(),
            from_rest: Vec::new(),
        }
    }

    /// This scan without what spans ask of the accelerations and jerks of the axes; junctions still do.
    pub(crate) fn without_reserves(self) -> Self {
        Self { sampling: self.sampling.without_reserves(), ..self }
    }

    /// This scan with no samples between the ends of straight lines.
    pub(crate) fn leaping_along_lines(self) -> Self {
        Self { sampling: self.sampling.leaping_along_lines(), ..self }
    }

    /// Samples one curve. It begins at rest if `from_rest`, whatever the directions.
    pub(crate) fn pass<C: Differentiate<R, D>>(
        &mut self,
        curve: usize,
        shape: &C,
        from_rest: bool,
    ) -> Result<(), PlanError> {
        (0..shape.span_count())
            .try_for_each(|index| self.pass_span(curve, shape, index, from_rest && index == 0))
    }

    /// Samples one span of a curve; it begins at rest if `from_rest`.
    pub(crate) fn pass_span<C: Differentiate<R, D>>(
        &mut self,
        curve: usize,
        shape: &C,
        index: usize,
        from_rest: bool,
    ) -> Result<(), PlanError> {
        let span = Span { shape, index, sampling: &self.sampling };
        let mut stations = span.stations();
        if !span.correct_lengths(&mut stations) {
            return Err(PlanError::SpanTooUneven { curve, span: index });
        }
        self.join(curve, shape, index, &stations, from_rest);
        self.append(curve, shape, &stations).ok_or(PlanError::LengthOverflows { curve })?;
        if index + 1 >= shape.span_count() {
            self.recall(shape, index);
        }
        Ok(())
    }

    /// Ends the path.
    pub(crate) fn finish(&mut self) {
        self.fine_moves.end(&mut self.samples);
    }

    /// What was found along the whole path.
    pub(crate) fn into_scanned(self) -> Scanned<R> {
        Scanned { samples: self.samples, corners: self.corners, from_rest: self.from_rest }
    }

    /// The samples so far, without those forgotten.
    pub(crate) fn samples(&self) -> &[ScannedSample<R>] {
        &self.samples
    }

    /// The samples so far that no later curve can change. A break still to come may lower the samples that a chord over
    /// it reaches, and the sample before those.
    pub(crate) fn settled(&self) -> &[ScannedSample<R>] {
        let begin = self.fine_moves.open_from(self.distance);
        let count = self.samples.partition_point(|sample| sample.point.distance <= begin);
        self.samples.get(..count.saturating_sub(1)).unwrap_or_default()
    }

    /// Distances at which the tangent breaks, without those forgotten.
    pub(crate) fn corners(&self) -> &[R] {
        &self.corners
    }

    /// The curves that begin at rest, with their distances.
    pub(crate) fn curves_from_rest(&self) -> &[(R, usize)] {
        &self.from_rest
    }

    /// Arc length of the curves sampled so far.
    pub(crate) fn length(&self) -> R {
        self.distance
    }

    /// Drops the samples before the last one that is no farther than `distance`.
    pub(crate) fn forget_before(&mut self, distance: R) {
        let kept = self.samples.partition_point(|sample| sample.point.distance <= distance);
        self.samples.drain(..kept.saturating_sub(1));
        self.corners.retain(|corner| *corner > distance);
        self.from_rest.retain(|(begin, _)| *begin > distance);
    }

    /// Joins the path so far to the first sample of a span. A single point between them has the feed of the junction,
    /// if that is lower than the limits on both sides; with `from_rest` it is a stop.
    fn join<C: Differentiate<R, D>>(
        &mut self,
        curve: usize,
        shape: &C,
        index: usize,
        stations: &[Station<R, D>],
        from_rest: bool,
    ) {
        let Some(Station { at: first, .. }) = stations.first() else { return };
        let is_corner = self.end.is_some_and(|(tangent, _)| tangent_breaks(&tangent, &first.tangent));
        if is_corner {
            self.corners.push(self.distance);
        }
        if from_rest && self.end.is_some() {
            self.from_rest.push((self.distance, curve));
        }
        let is_lowest = |feedrate: &R| *feedrate < self.lower_beside(stations);
        let stop = (from_rest && self.end.is_some()).then(R::zero);
        let turn = self.end.map(|end| Turn::between(end, first));
        let feedrate = stop.or_else(|| self.junctions.feed(turn.as_ref()?).filter(is_lowest));
        if let Some(feedrate) = feedrate {
            let single = self.sample(curve, &Sample { feedrate, ..*first }, None);
            self.samples.push(ScannedSample { is_single: true, rests: feedrate.is_zero(), ..single });
        }
        if index > 0 && turn.as_ref().is_some_and(|turn| self.fine_moves.is_break(turn.size)) {
            self.recall(shape, index - 1);
        }
        let is_jump = turn.as_ref().is_some_and(|turn| self.junctions.is_jump(turn));
        if is_jump || feedrate.is_some_and(|feedrate| feedrate.is_zero()) {
            self.fine_moves.end(&mut self.samples);
        }
        match &turn {
            Some(turn) if !self.fine_moves.is_empty() => self.fine_moves.turn(turn.size, first.tangent),
            _ => self.fine_moves.pass(self.distance, shape.derivatives(first.u).point, first.tangent),
        }
        // A line has no samples inside that would tell its speed.
        let is_line = shape.is_line(index);
        let is_continuation = |end: &ScannedSample<R>| {
            let is_as_fast = !is_line || end.speed == first.speed;
            end.point.curve == curve && end.point.feedrate == first.feedrate && is_as_fast
        };
        if !self.samples.last().is_some_and(is_continuation) {
            self.samples.push(self.sample(curve, first, None));
        }
        if let Some(begin) = self.samples.last_mut() {
            begin.bends |= !is_corner && turn.as_ref().is_some_and(|turn| self.junctions.turns(turn));
        }
    }

    /// Appends the samples of a span after its first one; `None` when the format overflows, so that a distance does not
    /// increase.
    fn append<C: Differentiate<R, D>>(
        &mut self,
        curve: usize,
        shape: &C,
        stations: &[Station<R, D>],
    ) -> Option<()> {
        let point_at = |u| shape.derivatives(u).point;
        for (before, station) in (0..).zip(stations.get(1..)?) {
            let Station { at, stretch } = station;
            let stretch = stretch.as_ref()?;
            let next = self.distance + stretch.length;
            if !(stretch.length >= R::zero() && next >= self.distance && next.is_finite()) {
                return None;
            }
            self.distance = next;
            self.samples.push(self.sample(curve, at, Some(stretch)));
            if self.fine_moves.is_waiting() && bends_at(&stations[before..]) {
                self.fine_moves.pass(next, point_at(at.u), at.tangent);
            }
            if at.feedrate.is_zero() {
                self.fine_moves.end(&mut self.samples);
                self.fine_moves.pass(next, point_at(at.u), at.tangent);
            }
        }
        self.fine_moves.settle(&mut self.samples);
        self.end = stations.last().map(|last| (last.at.tangent, last.at.bend));
        Some(())
    }

    /// Gives [`FineMoves`] the end of the path so far. The last span sampled is `index`.
    fn recall<C: Differentiate<R, D>>(&mut self, shape: &C, mut index: usize) {
        self.fine_moves.recall(&self.samples, |u| {
            while index > 0 && u < shape.span_bounds(index).0 {
                index -= 1;
            }
            let span = Span { shape, index, sampling: &self.sampling };
            // `derivatives_in` is inlined into `sample` as long as it has no other caller.
            (shape.derivatives(u).point, span.sample(u).tangent)
        });
    }

    /// A sample of the limit at the end of the path, with the stretch that leads there.
    fn sample(&self, curve: usize, at: &Sample<R, D>, before: Option<&Stretch<R>>) -> ScannedSample<R> {
        let &Sample { u, speed, feedrate, beside_stop, .. } = at;
        let point = LimitPoint { distance: self.distance, curve, u, feedrate };
        let sample = ScannedSample { speed, feedrate_beside_stop: beside_stop, ..ScannedSample::new(point) };
        before.map_or(sample, |stretch| ScannedSample {
            bends: stretch.bends,
            margin: stretch.course.margin,
            allowance: stretch.allowance,
            margin_beside_stop: stretch.beside_stop.margin,
            allowance_beside_stop: stretch.reserve,
            ..sample
        })
    }

    /// The lower one of the two bounds of the limit before and behind the point where these samples begin. A single
    /// point above either bound would be a summit that the flank on that side cannot reach.
    fn lower_beside(&self, stations: &[Station<R, D>]) -> R {
        let before = self.samples.last().map(|end| lowered(end.point.feedrate, end.margin));
        let after = stations.windows(2).next().map(|pair| {
            let margin = pair[1].stretch.as_ref().map_or_else(R::zero, |stretch| stretch.course.margin);
            lowered(pair[0].at.feedrate, margin)
        });
        before.into_iter().chain(after).fold(R::max_value(), R::min)
    }
}

/// Whether the second of these stations is the last one, or does not lie on a straight line with its neighbours.
fn bends_at<R, const D: usize>(stations: &[Station<R, D>]) -> bool {
    let [_, here, behind, ..] = stations else { return true };
    [here, behind].iter().any(|station| station.stretch.as_ref().is_none_or(|stretch| stretch.bends))
}

#[cfg(test)]
mod tests {
    use nurbs_core::NurbsBuf;
    use proptest::prelude::*;

    use super::Scan;
    use crate::plan::promises::{kept, planned};
    use crate::test_paths::{limit_along, paper_limits, polyline};
    use crate::{AxisLimits, FeedLimit, KinematicLimits, ProfileKind};

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

    /// Path and axes at the same limits, T = 1.
    fn axes_like_the_path(acceleration: f64, jerk: f64) -> KinematicLimits<f64> {
        let axis = AxisLimits { velocity: None, acceleration: Some(acceleration), jerk: Some(jerk) };
        let limits = KinematicLimits { feedrate: 0.8, acceleration, jerk, ..paper_limits() };
        KinematicLimits { chord_error: 1e-3, axes: [axis; 3], ..limits }
    }

    /// At the knot the axes' jerk lowered the limit on both sides below what the step of curvature allows: its single point
    /// stood above both, and was taken for a summit that no flank reached.
    #[test]
    fn a_step_of_curvature_within_a_slow_stretch_is_no_summit() {
        let points = vec![[-2.9, 9.1], [-7.4, 6.9], [-0.1, -1.0], [13.2, 9.1]];
        let curve = NurbsBuf::try_new_nonrational(2, points, vec![0., 0., 0., 1., 2., 2., 2.]).unwrap();
        planned(&curve, &axes_like_the_path(0.02, 1e-4));
    }

    proptest! {
        #![proptest_config(ProptestConfig::with_cases(200))]

        #[test]
        fn a_curve_of_degree_two_is_planned_whatever_its_axes(
            points in prop::collection::vec(prop::array::uniform2(-15.0..15.0_f64), 4..8),
            acceleration in 5e-3..0.05_f64, jerk in 5e-5..1e-2_f64,
        ) {
            let inner = (1..points.len() - 2).map(|knot| knot as f64);
            let knots = [0.0; 3].into_iter().chain(inner).chain([(points.len() - 2) as f64; 3]).collect();
            let curve = NurbsBuf::try_new_nonrational(2, points, knots).unwrap();
            let limits = axes_like_the_path(acceleration, jerk);
            let limit = FeedLimit::along(&[curve.as_curve()], &limits).unwrap();
            for pair in limit.samples().windows(3).filter(|samples| samples[1].is_single) {
                prop_assert!(pair[1].lower <= pair[0].lower.min(pair[2].lower), "{pair:?}");
            }
            for kind in ProfileKind::ALL {
                kept(&limit, &limits, kind);
            }
        }
    }
}
