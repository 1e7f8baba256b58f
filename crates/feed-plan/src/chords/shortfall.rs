//! From a plan in arcs to one in chords: what the setpoints of each stage fall short by.
//!
//! An interpolator that makes each chord as long as the plan's arc gains a little in every bend, since the arc over
//! a chord is longer. After a thousand bends it is ahead of the plan by more than a bend is long, and passes the
//! next one at the feed of the straight. Here is found by how much each stage would have to be shortened for itself;
//! [`ScheduleBuf::shortened`](crate::ScheduleBuf::shortened) takes it off so that the feeds still meet.
//!
//! The run is followed chord by chord, stage after stage: each is shortened until the run is back on its plan at the end of
//! the last period that begins in it. What a stage cannot take back, the next ones do. Stages shorter than a period have no
//! chord of their own: as many as take a period are shortened together, so that their feeds fall all by the same. One that
//! took back all of a period's shortfall would lower the feed there many times too much.

use alloc::vec::Vec;
use core::ops::Range;

use nurbs_core::{Differentiate, Frenet, GaussLegendre};
use real::Real;

use crate::Cursor;
use crate::limit::vector::difference;
use crate::{FeedLimit, Schedule, Stage};

/// How often a stage is followed, at most; what is left falls by a factor of ten and more each time.
const TRIALS: usize = 8;
/// A run that is off by less than 2⁻³⁴ of a step is on its plan.
const ON_PLAN: i32 = -34;
/// The run is kept ahead of its plan by 2⁻²⁰ of a step up to the stage that ends at a stop: distances between limit points
/// are that uncertain, and what a stage lacks there could not be added to it.
const LEAD: i32 = -20;
/// Stages are shortened together if their highest feeds are within 2² of each other: where one is much slower, its bend is most of
/// what they fall short.
const SAME_FEED: i32 = 2;
/// Corrections of an arc until its chord is as long as wanted; each leaves an eighth of the squared angle of the
/// chord.
const CORRECTIONS: usize = 8;
/// Strides of at most an eighth of a chord in which it is looked for where that does not end: it is no longer than four
/// chords.
const STRIDES: usize = 48;
/// Halvings of the stride that it lies in.
const HALVINGS: usize = 48;

impl<R: Real> FeedLimit<R> {
    /// By how much each stage is to be shortened if each chord, not each arc, is to have the planned length, mm: at most
    /// half of the stage.
    ///
    /// `curves` are those that this limit was made of; where they are missing, nothing falls short. Parameters
    /// are interpolated between limit points, and what one is off does not add up: it is gone in the next
    /// period. Of stages that take a period only together all feeds fall by the same. Were each stage shortened for itself, a run
    /// by these chords would at the ends of its stages be within 1e-5 mm of the plan, in f64, where a stage has a period of its
    /// own and no step turns by a right angle; behind one that does, it may be off by a share of that step, which the next
    /// stages take back. A stop on the way is taken to be landed on, as the end is: nothing that a run is off there goes
    /// beyond it.
    ///
    /// See [`ScheduleBuf::shortened`](crate::ScheduleBuf::shortened) for what to do about it.
    #[must_use]
    pub fn shortfalls<const D: usize, C: Differentiate<R, D>>(
        &self,
        curves: &[C],
        schedule: &Schedule<'_, R>,
    ) -> Vec<R> {
        let mut shortfalls: Vec<R> = schedule.stages().iter().map(|_| R::zero()).collect();
        let mut short = schedule.stages().to_vec();
        let path = Path::new(self, curves);
        // A period that begins in one stage and ends in another is run with each of them.
        let mut run = Run { cursor: schedule.start(), planned: R::zero(), reached: R::zero() };
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

/// Where a run by chords stands.
#[derive(Clone, Copy)]
struct Run<R> {
    cursor: Cursor<R>,
    /// Distance that the plan is at.
    planned: R,
    /// Distance that the chords have come to.
    reached: R,
}

/// Where a run stands behind the last period that began in a stage, and before that period.
#[derive(Clone, Copy)]
struct End<R> {
    run: Run<R>,
    last_period: Run<R>,
    /// By how much the chords have come further than the plan and its lead; at a stop, by how much the last one would go
    /// beyond that.
    ahead: R,
}

/// A path by its arc length.
pub(crate) struct Path<'a, R, C, const D: usize> {
    pub(crate) limit: &'a FeedLimit<R>,
    curves: &'a [C],
    rule: GaussLegendre<R>,
    /// Whether the parameter says everywhere where the path is. Where it does not, a chord counts as long as its arc.
    is_resolved: bool,
}

impl<'a, R: Real, C: Differentiate<R, D>, const D: usize> Path<'a, R, C, D> {
    pub(crate) fn new(limit: &'a FeedLimit<R>, curves: &'a [C]) -> Self {
        Self { limit, curves, rule: GaussLegendre::new(), is_resolved: limit.is_resolved() }
    }

    fn is_resolved_at(&self, distance: R) -> bool {
        self.is_resolved || self.limit.is_resolved_at(distance)
    }

    /// The length of a step between two distances: of the chords from corner to corner.
    pub(crate) fn step_between(&self, from: R, to: R) -> R {
        let corners = self.limit.corners_from(from).iter().take_while(|corner| **corner < to);
        let ends = corners.copied().chain([to]);
        ends.fold((R::zero(), from), |(sum, from), to| (sum + self.leg(from, to), to)).0
    }

    /// The length of the chord between two distances without a corner in between.
    fn leg(&self, from: R, to: R) -> R {
        chord(&self.leaving(from), &self.arriving(from, to))
    }

    /// The point at a distance, on the path that goes on from there: after a rest that may be elsewhere than where the path before
    /// it ends.
    fn leaving(&self, distance: R) -> [R; D] {
        let place = match self.limit.begins_at_rest(distance) {
            Some(curve) => (curve, self.curves.get(curve).map_or(R::zero(), |curve| curve.domain().0)),
            None => self.limit.parameter_at(distance),
        };
        self.point(place)
    }

    /// The point at a distance, on the path that comes from another; no farther than the next rest.
    fn arriving(&self, from: R, to: R) -> [R; D] {
        let rest = self.limit.next_from_rest(from).filter(|(rest, _)| to >= *rest);
        let place = match rest.and_then(|(_, next)| next.checked_sub(1)) {
            Some(curve) => (curve, self.curves.get(curve).map_or(R::zero(), |curve| curve.domain().1)),
            None => self.limit.parameter_at(to),
        };
        self.point(place)
    }

    fn point(&self, (curve, u): (usize, R)) -> [R; D] {
        self.curves.get(curve).map_or([R::zero(); D], |curve| curve.point(u))
    }

    /// Arc length up to the point at a distance. That point is interpolated between limit points, and where the speed changes
    /// a little off: where a stage ends it would be taken for a shortfall, which no later stage could add to.
    fn length_to(&self, distance: R) -> R {
        let (index, u) = self.limit.parameter_at(distance);
        let is_resolved = self.is_resolved_at(distance);
        let before = self.limit.point_before(distance).filter(|point| is_resolved && point.curve == index);
        let (Some(begin), Some(curve)) = (before, self.curves.get(index)) else { return distance };
        let width = u - begin.u;
        let speed = |x: R| Frenet::of(&curve.derivatives(begin.u + width * x)).speed;
        begin.distance + width * self.rule.mean(&self.rule.points.map(speed))
    }

    /// Shortens stages until the run is on its plan behind them, as far as half of them will do: by how much, and where the run
    /// ends then.
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
        let enough = step.scale(ON_PLAN).max(R::resolution().scale(2) * self.limit.length().max(R::one()));
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
        // What the last chord has too much to land on a stop, or the lead that another is to leave.
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
                run.reached = run.planned;
                Some(wanted - rest)
            } else {
                run.reached = (run.reached + self.arc_of_step(run.reached, wanted)).min(self.limit.length());
                None
            };
            lead = wanted.scale(LEAD);
            (end, last_period) = (run, end);
        }
        let ahead = over_stop.unwrap_or_else(|| self.length_to(end.reached) - end.planned - lead);
        End { run: end, last_period, ahead }
    }

    /// The arc of a step from `begin` on: to each corner within it a chord, and behind the last one the first arc whose chord is as
    /// long as what is left.
    pub(crate) fn arc_of_step(&self, begin: R, wanted: R) -> R {
        if !(self.is_resolved_at(begin) && self.is_resolved_at(begin + wanted)) {
            return wanted;
        }
        let (mut from, mut left) = (begin, wanted);
        for &corner in self.limit.corners_from(begin) {
            let chord = if corner - from > left.scale(2) { left } else { self.leg(from, corner) };
            if chord >= left {
                break;
            }
            (from, left) = (corner, left - chord);
        }
        from - begin + self.arc_over(from, left)
    }

    /// The first arc from `begin` on whose chord is as long as wanted; four times the chord where none is.
    fn arc_over(&self, begin: R, wanted: R) -> R {
        let from = self.leaving(begin);
        let missing = |arc: R| wanted - chord(&from, &self.arriving(begin, begin + arc));
        let rounding = R::resolution() * self.limit.length().max(R::one());
        // A chord is no longer than its arc: an arc that is longer by what its chord lacks is not yet past the first.
        let mut arc = wanted;
        for _ in 0..CORRECTIONS {
            let rest = missing(arc);
            if !(rest.abs() > rounding) {
                return arc;
            }
            arc = (arc + rest).max(wanted.half()).min(wanted + wanted);
        }
        // Slow across a corner, where the way leads back along the chord. Behind it more than one arc may have the chord, and
        // the first may be near: strides begin with what was missing last.
        let (mut low, mut high) = (wanted.half(), arc);
        let (mut stride, longest) = (wanted.scale(-16), wanted.scale(-3));
        for _ in 0..STRIDES {
            let rest = missing(high);
            if !(rest > R::zero()) {
                break;
            }
            stride = (stride + stride).max(rest).min(longest);
            (low, high) = (high, (high + stride).min(wanted.scale(2)));
        }
        for _ in 0..HALVINGS {
            arc = low + (high - low).half();
            if missing(arc) > R::zero() { low = arc } else { high = arc }
        }
        arc
    }
}

/// Behind which stage those from `begin` on take a period together, or end at a stop, or go at another feed than the first by
/// more than [`SAME_FEED`].
fn end_of_period<R: Real>(schedule: &Schedule<'_, R>, begin: usize) -> usize {
    let stages = schedule.stages().get(begin..).unwrap_or_default();
    let mut left = schedule.interpolation_period();
    let goes_on = |pair: &&[Stage<R>]| {
        left = left - pair[0].duration;
        let [a, b] = [&stages[0], &pair[1]].map(|stage| stage.start_feed.max(stage.end_feed));
        let is_same_feed = a <= b.scale(SAME_FEED) && b <= a.scale(SAME_FEED);
        left > R::zero() && !pair[0].end_feed.is_zero() && is_same_feed
    };
    begin + 1 + stages.windows(2).take_while(goes_on).count()
}

/// What of `off` each stage is shortened by: its share of the time, so that all feeds fall by the same, and no more than half of
/// it.
fn parts<R: Real>(schedule: &Schedule<'_, R>, stages: Range<usize>, off: R) -> impl Iterator<Item = R> {
    let stages = schedule.stages().get(stages).unwrap_or_default();
    let duration = stages.iter().fold(R::zero(), |sum, stage| sum + stage.duration);
    let share = move |part: R| if duration > R::zero() { part / duration } else { R::zero() };
    stages.iter().map(move |stage| (off * share(stage.duration)).min(stage.length.half()))
}

impl<R: Real> Stage<R> {
    /// The stage with its distances and feeds scaled so that it is shorter by `off`, in the same time.
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

    /// A step over corners of any angle covers as much of the path as it is long; on a spline too, whose corner lies within.
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

    /// Between knots a rounding apart the parameter says nothing of where the path is, and what was read there was taken for
    /// shortfalls of a hundred millimetres: half of each stage before and behind.
    #[test]
    fn between_knots_a_rounding_apart_nothing_is_taken_for_a_shortfall() {
        // A circle of control points, a tenth of it on five knots that are neighbours among numbers.
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
        // Of a circle of 60 mm chords of 0.4 mm fall short by 2e-6 of themselves.
        let sum: f64 = shortfalls.iter().sum();
        assert!(sum < 1e-4 * limit.length(), "{sum} of {}: {shortfalls:?}", limit.length());
    }

    #[test]
    fn a_stage_shorter_than_a_period_does_not_take_back_what_a_period_falls_short() {
        // Of degree 2: at each knot the curvature steps, and the least feeds are held for a third of a period there.
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
