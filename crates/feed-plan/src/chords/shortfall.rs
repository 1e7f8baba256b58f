//! From a plan in arcs to one in chords: how much the chords of each stage fall short of its arcs.
//!
//! An interpolator that makes each chord as long as the plan's arc gains a little in every bend, since the arc over a
//! chord is longer than the chord. After a thousand bends the run is ahead of the plan by more than the length of a
//! bend, and passes the next bend at the feed of the straight. This module finds by how much each stage would have to
//! be shortened for itself; [`ScheduleBuf::shortened`](crate::ScheduleBuf::shortened) takes these lengths off so that
//! the feeds still meet.
//!
//! The run is followed chord by chord, stage after stage. Each stage is shortened until the run is back on its plan at
//! the end of the last period that begins in the stage. A difference that one stage cannot take back is left to the
//! next ones. Stages shorter than a period have no chord of their own. Stages that together take a period are shortened
//! together, so that their feeds all fall by the same amount: if one short stage took back the shortfall of a whole
//! period, its feed would fall many times too much.

use alloc::vec::Vec;
use core::cell::Cell;
use core::ops::Range;

use nurbs_core::{Differentiate, Frenet, GaussLegendre};
use real::Real;

use crate::Cursor;
use crate::limit::vector::difference;
use crate::schedule::stage::duration;
use crate::{FeedLimit, Schedule, Stage};

/// How often a stage is followed, at most; the remaining difference falls by a factor of ten or more each time.
const TRIALS: usize = 8;
/// A run that is off by less than 2⁻³⁴ of a step is on its plan.
const ON_PLAN: i32 = -34;
/// The run is kept ahead of its plan by 2⁻²⁰ of a step up to the stage that ends at a stop. Distances between limit
/// points are uncertain by about that much, and a length that is missing at the stop could not be added.
const LEAD: i32 = -20;
/// Stages are shortened together if their highest feeds are within 2² of each other. If one stage is much slower, its
/// bend causes most of the shortfall.
const SAME_FEED: i32 = 2;
/// Corrections of an arc until its chord is as long as wanted; each correction leaves an error of an eighth of the
/// squared angle of the chord.
const CORRECTIONS: usize = 8;
/// Where the corrections do not converge, the arc is looked for in strides of at most an eighth of a chord. It is no
/// longer than four chords.
const STRIDES: usize = 48;
/// Halvings of the stride in which the arc ends.
const HALVINGS: usize = 48;

impl<R: Real> FeedLimit<R> {
    /// By how much each stage must be shortened, mm, if each chord, not each arc, is to have the planned length: at
    /// most half of the stage.
    ///
    /// `curves` are those that this limit was made of; where they are missing, nothing falls short. Parameters are
    /// interpolated between limit points. Their errors do not add up: each is gone in the next period. Where several
    /// stages together take a period, all their feeds fall by the same amount.
    ///
    /// If each stage were shortened for itself, a run by these chords would be within 1e-5 mm of the plan at the ends
    /// of stages, in f64. That holds where each stage has a period of its own and no step turns by a right angle.
    /// Behind a step that does, the run may be off by a share of that step, which the next stages take back. The run is
    /// taken to land on each stop on the way, as it does at the end, so an error before a stop is not carried beyond
    /// it.
    ///
    /// [`ScheduleBuf::shortened`](crate::ScheduleBuf::shortened) applies these lengths.
    #[must_use]
    pub fn shortfalls<const D: usize, C: Differentiate<R, D>>(
        &self,
        curves: &[C],
        schedule: &Schedule<'_, R>,
    ) -> Vec<R> {
        let mut shortfalls: Vec<R> = schedule.stages().iter().map(|_| R::zero()).collect();
        let mut short = schedule.stages().to_vec();
        let path = Path::new(self, curves);
        // A period that begins in one stage and ends in another is run once for each of the two.
        let begin = schedule.stages().first().map_or(R::zero(), |first| first.start);
        let mut run = Run { cursor: schedule.start(), planned: begin, reached: begin };
        let mut begins_in = 0;
        while begins_in < schedule.stages().len() {
            let stages = begins_in..end_of_period(schedule, begins_in);
            let (off, end) = path.take_back(schedule, stages.clone(), &mut short, run);
            let parts = parts(schedule, stages.clone(), off);
            shortfalls.iter_mut().skip(begins_in).zip(parts).for_each(|(shortfall, part)| *shortfall = part);
            run = end.last_period;
            begins_in = end.run.cursor.stage().max(stages.end);
        }
        shortfalls
    }
}

/// The state of a run by chords.
#[derive(Clone, Copy)]
struct Run<R> {
    cursor: Cursor<R>,
    /// Distance that the plan has come to.
    planned: R,
    /// Distance that the chords have come to.
    reached: R,
}

/// The state of a run behind the last period that began in a stage, and its state before that period.
#[derive(Clone, Copy)]
struct End<R> {
    run: Run<R>,
    last_period: Run<R>,
    /// By how much the chords have come further than the plan and its lead; at a stop, by how much the last chord would
    /// pass the stop.
    ahead: R,
}

/// A path by its arc length.
pub(crate) struct Path<'a, R, C, const D: usize> {
    pub(crate) limit: &'a FeedLimit<R>,
    /// The curves from the one with the index `first` on.
    curves: &'a [C],
    first: usize,
    rule: GaussLegendre<R>,
    /// Whether the parameter tells everywhere where the path is. Where it does not, a chord counts as long as its arc.
    is_resolved: bool,
    /// The point of the limit and the corner at which the last searches ended: a run goes on from where it was.
    last: [Cell<usize>; 2],
}

impl<'a, R: Real, C: Differentiate<R, D>, const D: usize> Path<'a, R, C, D> {
    pub(crate) fn new(limit: &'a FeedLimit<R>, curves: &'a [C]) -> Self {
        Self::in_view(limit, 0, curves)
    }

    /// A part of a path, of the curves from the one with the index `first` on.
    pub(crate) fn in_view(limit: &'a FeedLimit<R>, first: usize, curves: &'a [C]) -> Self {
        Self {
            limit,
            curves,
            first,
            rule: GaussLegendre::new(),
            is_resolved: limit.is_resolved(),
            last: Default::default(),
        }
    }

    fn curve(&self, index: usize) -> Option<&C> {
        self.curves.get(index.checked_sub(self.first)?)
    }

    fn is_resolved_at(&self, distance: R) -> bool {
        self.is_resolved || self.limit.is_resolved_at(distance)
    }

    /// The length of a step between two distances: the sum of its chords from corner to corner.
    pub(crate) fn step_between(&self, from: R, to: R) -> R {
        let corners = self.limit.corners_near(from, &self.last[1]).iter().take_while(|corner| **corner < to);
        let ends = corners.copied().chain([to]);
        ends.fold((R::zero(), from), |(sum, from), to| (sum + self.leg(from, to), to)).0
    }

    /// The length of the chord between two distances without a corner in between.
    fn leg(&self, from: R, to: R) -> R {
        chord(&self.leaving(from), &self.arriving(from, to))
    }

    /// The point from which the path goes on at a distance. After a rest, it may be another point than the one at which
    /// the path before the rest ends.
    pub(crate) fn leaving(&self, distance: R) -> [R; D] {
        let place = match self.limit.begins_at_rest(distance) {
            Some(curve) => (curve, self.curve(curve).map_or(R::zero(), |curve| curve.domain().0)),
            None => self.parameter_at(distance),
        };
        self.point(place)
    }

    /// The point at which the path from `from` arrives at `to`; at the latest, the next rest.
    pub(crate) fn arriving(&self, from: R, to: R) -> [R; D] {
        let rest = self.limit.next_from_rest(from).filter(|(rest, _)| to >= *rest);
        let place = match rest.and_then(|(_, next)| next.checked_sub(1)) {
            Some(curve) => (curve, self.curve(curve).map_or(R::zero(), |curve| curve.domain().1)),
            None => self.parameter_at(to),
        };
        self.point(place)
    }

    /// Whether the way between two distances is on one straight line, whose chords are as long as its arcs.
    fn is_along_a_line(&self, from: R, to: R) -> bool {
        let curve = self.limit.curve_over(from, to, &self.last[0]).and_then(|curve| self.curve(curve));
        curve.is_some_and(|curve| curve.span_count() == 1 && curve.is_line(0))
    }

    fn parameter_at(&self, distance: R) -> (usize, R) {
        self.limit.parameter_near(distance, &self.last[0])
    }

    /// Whether a corner lies within a step.
    pub(crate) fn passes_corner(&self, from: R, to: R) -> bool {
        self.limit.corners_near(from, &self.last[1]).first().is_some_and(|corner| *corner < to)
    }

    fn point(&self, (curve, u): (usize, R)) -> [R; D] {
        self.curve(curve).map_or([R::zero(); D], |curve| curve.point(u))
    }

    /// Arc length up to the point that is found at a distance. The point is interpolated between limit points, and is a
    /// little off where the speed changes. At the end of a stage this error would be taken for a shortfall, and if it
    /// is negative, no later stage could make up for it.
    pub(crate) fn length_to(&self, distance: R) -> R {
        let (index, u) = self.parameter_at(distance);
        let is_resolved = self.is_resolved_at(distance);
        let before = self.limit.point_before(distance).filter(|point| is_resolved && point.curve == index);
        let (Some(begin), Some(curve)) = (before, self.curve(index)) else { return distance };
        let width = u - begin.u;
        let speed = |x: R| Frenet::of(&curve.derivatives(begin.u + width * x)).speed;
        begin.distance + width * self.rule.mean(&self.rule.points.map(speed))
    }

    /// Shortens the stages, each by at most half, until the run is on its plan behind them. Returns the length that was
    /// taken off, and the state of the run there.
    fn take_back(
        &self,
        arcs: &Schedule<'_, R>,
        stages: Range<usize>,
        short: &mut [Stage<R>],
        from: Run<R>,
    ) -> (R, End<R>) {
        let whole = arcs.stages().get(stages.clone()).unwrap_or_default();
        let length = whole.iter().fold(R::zero(), |sum, stage| sum + stage.length);
        let fastest =
            whole.iter().fold(R::zero(), |most, stage| most.max(stage.start_feed).max(stage.end_feed));
        let shorten = |short: &mut [Stage<R>], off: R| {
            let parts = parts(arcs, stages.clone(), off);
            for ((stage, whole), part) in short.iter_mut().skip(stages.start).zip(whole).zip(parts) {
                *stage = whole.shortened_by(part);
            }
        };
        let mut follow = |off: R| {
            shorten(short, off);
            self.follow(arcs, short, stages.end, from)
        };
        let within_half = |off: R| off.max(R::zero()).min(length.half());
        let step = fastest * arcs.interpolation_period();
        let enough = step.ldexp(ON_PLAN).max(R::resolution().ldexp(2) * self.limit.length().max(R::one()));
        let mut off = within_half(self.length_to(from.reached) - from.planned);
        let mut end = follow(off);
        let mut best = (off, end);
        for _ in 1..TRIALS {
            let next = within_half(off + end.ahead);
            if !(end.ahead.abs() > enough) || next == off {
                break;
            }
            (off, end) = (next, follow(next));
            if end.ahead.abs() < best.1.ahead.abs() {
                best = (off, end);
            }
        }
        shorten(short, best.0);
        best
    }

    /// Follows the shortened plan by chords, to the end of the last period that begins before stage `behind`.
    fn follow(&self, arcs: &Schedule<'_, R>, short: &[Stage<R>], behind: usize, from: Run<R>) -> End<R> {
        let chords = Schedule::new(short, arcs.interpolation_period(), arcs.periods());
        let (mut end, mut last_period) = (from, from);
        // By how much the last chord is too long to land on a stop; and the lead that any other chord is to leave.
        let (mut over_stop, mut lead) = (None, R::zero());
        while end.cursor.stage() < behind {
            let mut run = end;
            let begun_in = run.cursor.stage();
            let mut by_chord = run.cursor;
            let (Some(arc), Some(wanted)) = (arcs.advance(&mut run.cursor), chords.advance(&mut by_chord))
            else {
                break;
            };
            run.planned = run.planned + arc;
            let passed = short.get(begun_in..run.cursor.stage()).unwrap_or_default();
            over_stop = if passed.iter().any(|stage| stage.end_feed.is_zero()) {
                let rest = self.step_between(run.reached, run.planned);
                run.planned = run.planned + self.gaps(arcs, begun_in..run.cursor.stage());
                run.reached = run.planned;
                Some(wanted - rest)
            } else {
                run.reached = (run.reached + self.arc_of_step(run.reached, wanted)).min(self.limit.length());
                None
            };
            lead = wanted.ldexp(LEAD);
            (end, last_period) = (run, end);
        }
        let ahead = over_stop.unwrap_or_else(|| self.length_to(end.reached) - end.planned - lead);
        End { run: end, last_period, ahead }
    }

    /// The length of path between these stages and the next ones, in a plan that holds some sections alone.
    fn gaps(&self, arcs: &Schedule<'_, R>, stages: Range<usize>) -> R {
        let pairs = stages.filter_map(|stage| arcs.stages().get(stage).zip(arcs.stages().get(stage + 1)));
        let gaps = pairs.map(|(stage, next)| next.start - (stage.start + stage.length));
        gaps.filter(|gap| gap.abs() > self.limit.rounding()).fold(R::zero(), |sum, gap| sum + gap)
    }

    /// The arc of a step that begins at `begin`. The step has a chord to each corner within it. Behind the last corner
    /// it ends with the first arc whose chord is as long as the length that is left.
    pub(crate) fn arc_of_step(&self, begin: R, wanted: R) -> R {
        let is_resolved = || self.is_resolved_at(begin) && self.is_resolved_at(begin + wanted);
        if self.is_along_a_line(begin, begin + wanted) || !is_resolved() {
            return wanted;
        }
        let (mut from, mut left) = (begin, wanted);
        for &corner in self.limit.corners_near(begin, &self.last[1]) {
            let way = corner - from;
            let chord = if way > left.ldexp(2) { left } else { self.leg(from, corner) };
            if chord >= left {
                break;
            }
            // Where the path turns back before the corner, a step may end before it though the corner is near.
            if way > left {
                let arc = self.arc_over(from, left);
                if arc <= way {
                    return from - begin + arc;
                }
            }
            (from, left) = (corner, left - chord);
        }
        from - begin + self.arc_over(from, left)
    }

    /// The first arc from `begin` on whose chord is as long as wanted; four times that length if there is no such arc.
    fn arc_over(&self, begin: R, wanted: R) -> R {
        let from = self.leaving(begin);
        let missing = |arc: R| wanted - chord(&from, &self.arriving(begin, begin + arc));
        let rounding = R::resolution() * self.limit.length().max(R::one());
        // A chord is no longer than its arc. So the arc, lengthened by what its chord lacks, does not pass the first
        // solution.
        let mut arc = wanted;
        for _ in 0..CORRECTIONS {
            let rest = missing(arc);
            if !(rest.abs() > rounding) {
                return arc;
            }
            arc = (arc + rest).max(wanted.half()).min(wanted + wanted);
        }
        // Corrections converge slowly across a corner where the path leads back along the chord. Behind such a corner
        // several arcs may have the wanted chord, and the first may be near: strides begin with the length that was
        // missing last.
        let (mut low, mut high) = (wanted.half(), arc);
        let (mut stride, longest) = (wanted.ldexp(-16), wanted.ldexp(-3));
        for _ in 0..STRIDES {
            let rest = missing(high);
            if !(rest > R::zero()) {
                break;
            }
            stride = (stride + stride).max(rest).min(longest);
            (low, high) = (high, (high + stride).min(wanted.ldexp(2)));
        }
        for _ in 0..HALVINGS {
            arc = low + (high - low).half();
            if missing(arc) > R::zero() { low = arc } else { high = arc }
        }
        arc
    }
}

/// The index behind the stages from `begin` on that are shortened together. They end once they take a period, at a
/// stop, or before a stage whose feed differs from the first one's by more than [`SAME_FEED`].
fn end_of_period<R: Real>(schedule: &Schedule<'_, R>, begin: usize) -> usize {
    let stages = schedule.stages().get(begin..).unwrap_or_default();
    let mut left = schedule.interpolation_period();
    let goes_on = |pair: &&[Stage<R>]| {
        left = left - pair[0].duration;
        let [a, b] = [&stages[0], &pair[1]].map(|stage| stage.start_feed.max(stage.end_feed));
        let is_same_feed = a <= b.ldexp(SAME_FEED) && b <= a.ldexp(SAME_FEED);
        left > R::zero() && !pair[0].end_feed.is_zero() && is_same_feed
    };
    begin + 1 + stages.windows(2).take_while(goes_on).count()
}

/// The parts of `off` by which the stages are shortened. Each is proportional to the stage's time, so that all feeds
/// fall by the same amount, and at most half of the stage.
fn parts<R: Real>(schedule: &Schedule<'_, R>, stages: Range<usize>, off: R) -> impl Iterator<Item = R> {
    let stages = schedule.stages().get(stages).unwrap_or_default();
    let duration = duration(stages);
    let share = move |part: R| if duration > R::zero() { part / duration } else { R::zero() };
    stages.iter().map(move |stage| (off * share(stage.duration)).min(stage.length.half()))
}

impl<R: Real> Stage<R> {
    /// Shortens the stage by `off` in the same time: its length and feeds are scaled.
    fn shortened_by(&self, off: R) -> Self {
        if !(off > R::zero()) {
            return *self;
        }
        let share = off / self.length;
        let scaled = |quantity: R| quantity - quantity * share;
        let (length, start_feed, end_feed) =
            (scaled(self.length), scaled(self.start_feed), scaled(self.end_feed));
        Self { length, start_feed, end_feed, ..*self }
    }
}

fn chord<R: Real, const D: usize>(from: &[R; D], to: &[R; D]) -> R {
    R::norm(&difference(to, from))
}

#[cfg(test)]
mod tests {
    use nurbs_core::NurbsBuf;

    use super::*;
    use crate::test_paths::{in_periods, jerk_over_periods, polyline};
    use crate::{EndFeeds, Junction, KinematicLimits, ProfileKind, plan_with};

    /// A step over corners of any angle covers a length of path equal to its own; so does a step on a spline with a
    /// corner inside.
    #[test]
    fn a_step_over_corners_goes_along_the_path() {
        let limits = in_periods(2e-3, 150.0, 1500.0, 3e4, 2e-3);
        let limits = KinematicLimits { junction: Junction::Deviation(0.02), ..limits };
        for degrees in [0.1_f64, 30.0, 90.0, 150.0, 179.0] {
            let (sine, cosine) = degrees.to_radians().sin_cos();
            let points =
                [[0.0, 0.0], [10.0, 0.0], [10.0 + 0.004 * cosine, 0.004 * sine], [20.0, 0.004 * sine]];
            let lines = polyline(&points);
            let knots = vec![0.0, 0.0, 1.0, 2.0, 3.0, 3.0];
            let spline = [NurbsBuf::try_new_nonrational(1, points.to_vec(), knots).unwrap()];
            for curves in [lines, spline.to_vec()] {
                let curves: Vec<_> = curves.iter().map(NurbsBuf::as_curve).collect();
                let limit = FeedLimit::along(&curves, &limits).unwrap();
                let path = Path::new(&limit, &curves);
                for begin in [9.7, 9.992, 9.995, 9.9999, 10.0, 10.001, 10.3] {
                    let arc = path.arc_of_step(begin, 0.01);
                    assert!((arc - 0.01).abs() < 1e-12, "{degrees}° from {begin}: {arc}");
                    let step = path.step_between(begin, begin + 0.01);
                    assert!((step - 0.01).abs() < 1e-12, "{degrees}° from {begin}: {step}");
                }
            }
        }
    }

    /// The corner at the end of a path that leads there and back lies nearer than the step is long. The step was taken for one over the
    /// corner, and a run for half of a stage ahead of its plan.
    #[test]
    fn a_step_ends_before_a_turn_with_a_corner_behind_it() {
        let limits = in_periods(2e-3, 150.0, 1500.0, 3e4, 2e-3);
        let hairpin = NurbsBuf::try_new_nonrational(
            2,
            vec![[0.0, 0.0], [0.02, 0.0], [0.0, 0.0001]],
            vec![0.0, 0.0, 0.0, 1.0, 1.0, 1.0],
        );
        let curves = [hairpin.unwrap(), polyline(&[[0.0, 0.0001], [0.0, 5.0]]).remove(0)];
        let curves: Vec<_> = curves.iter().map(NurbsBuf::as_curve).collect();
        let limit = FeedLimit::along(&curves, &limits).unwrap();
        let path = Path::new(&limit, &curves);
        // The turn is at 0.01 mm. A chord along the way there is as long as its arc.
        for (begin, step) in [(0.0, 0.0095), (0.001, 0.008), (0.002, 0.007)] {
            let arc = path.arc_of_step(begin, step);
            assert!((arc - step).abs() < 1e-5, "{step} from {begin}: {arc}");
        }
    }

    /// Between knots that differ by a rounding, the parameter does not tell where the path is. Lengths that were read
    /// there were once taken for shortfalls of a hundred millimetres: half of each stage before and behind.
    #[test]
    fn between_knots_a_rounding_apart_nothing_is_taken_for_a_shortfall() {
        // Control points on a circle; a tenth of them belong to five knots that are neighbouring floats.
        let turn = |i: u32| (core::f64::consts::TAU / 24.0 * f64::from(i)).sin_cos();
        let points: Vec<_> = (0..=24).map(turn).map(|(sine, cosine)| [60.0 * cosine, 60.0 * sine]).collect();
        let inner = (1..22).map(|i: i32| match i {
            9..=13 => f64::from_bits(0.5_f64.to_bits() + u64::try_from(i - 9).unwrap()),
            _ => f64::from(i) / 22.0,
        });
        let knots = [0.0; 4].into_iter().chain(inner).chain([1.0; 4]).collect();
        let curve = NurbsBuf::try_new_nonrational(3, points, knots).unwrap();
        let limits = in_periods(2e-3, 200.0, 3000.0, 1e5, 1e-3);
        let curves = [curve.as_curve()];
        let limit = FeedLimit::along(&curves, &limits).unwrap();
        assert!(!limit.is_resolved() && limit.is_resolved_at(1.0));
        let arcs = plan_with(&limit, &limits, EndFeeds::default(), ProfileKind::Cubic).unwrap();
        let shortfalls = limit.shortfalls(&curves, &arcs.as_schedule());
        // On a circle with a radius of 60 mm, chords of 0.4 mm fall short by 2e-6 of themselves.
        let sum: f64 = shortfalls.iter().sum();
        assert!(sum < 1e-4 * limit.length(), "{sum} of {}: {shortfalls:?}", limit.length());
    }

    #[test]
    fn a_stage_shorter_than_a_period_does_not_take_back_what_a_period_falls_short() {
        // A curve of degree 2: at each knot the curvature steps, and the plan holds the least feeds for a third of a
        // period there.
        let points = vec![
            [-7.3753, -16.7373, 9.3019],
            [22.2662, -17.081, -28.3976],
            [35.339, -31.7846, 3.4055],
            [24.611, -9.2709, -33.7096],
            [35.1245, -31.3344, 2.6632],
            [90.5311, 39.7678, -54.1386],
            [97.4253, -31.7965, -24.8756],
            [87.5479, -9.865, 30.6717],
            [34.4717, -20.6296, 69.5025],
        ];
        let inner = [0.085_769_383, 0.144_210_576, 0.338_493_775, 0.474_950_68, 0.933_961_651, 0.960_811_05];
        let knots = [&[0.0; 3][..], &inner, &[1.0; 3]].concat();
        let curve = NurbsBuf::try_new(2, points, vec![1.0; 9], knots).unwrap();
        let limits = in_periods(1.074e-3, 402.89, 3217.6, 18399.0, 8.549e-3);
        let limit = FeedLimit::along(&[curve.as_curve()], &limits).unwrap();
        for kind in ProfileKind::ALL {
            let arcs = plan_with(&limit, &limits, EndFeeds::default(), kind).unwrap();
            let short = arcs.stages().iter().filter(|stage| stage.duration < 1.0);
            assert!(short.count() > 1, "{kind:?}: no stage is shorter than a period");
            let chords =
                arcs.clone().shortened(&limit, &limit.shortfalls(&[curve.as_curve()], &arcs.as_schedule()));
            let [planned, chords] =
                [&arcs, &chords].map(|plan| jerk_over_periods(&plan.as_schedule()) / limits.jerk);
            assert!(planned <= 1.0 && chords <= 1.0 + 1e-9, "{kind:?}: {planned} {chords}");
        }
    }
}
