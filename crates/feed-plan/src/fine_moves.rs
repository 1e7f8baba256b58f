//! Moves finer than a step: the feed at which no chord of one period leaves the path by more than the chord error, however many
//! breaks of the tangent it passes.
//!
//! A chord from p before a place c of the path to q behind it leaves that place by the distance of it from the line through the
//! chord's ends. With `A = C(c) - C(c-p)`, `B = C(c+q) - C(c)`, that is the part across A + B of
//!
//! ```text
//! h = (q A - p B) / (p + q)
//! ```
//!
//! In the middle, p = q = L/2, h is half of A - B: for breaks of the tangent by Δe_k at distances d_k along the path
//! `¼ Σ Δe_k (L - 2 d_k)`, for a curvature κ `κ L²/8`, and their sum where there is both. One formula serves lines, curves and what
//! joins them.
//!
//! For turns of one sign a chord is farthest from the path at a break. So at each break the chord is lengthened
//! until h is more than is allowed: the first such length L, not the greatest without, since a wave as long as a chord hides from it.
//! Between two lengths at which an end of the chord passes a break, h is convex: it is greatest at one of them. Then `V ≤ L/T`
//! holds for L/2 on both sides of the break, and up to the sample beyond. The middle is not quite where a chord over two breaks is
//! farthest from the path: of two alike, half a chord apart, it is at 3/8 of its length, by an eighth more. So chords that have the
//! break up to an eighth off their middle are looked at as well where the middle comes near.
//!
//! What is allowed is exceeded by [`SLACK`] before a limit is set. So breaks in a row of the same shape share one limit,
//! a break that is passed slowly enough anyway costs no more than one look, and plans over joints that are smooth but for rounding
//! stay what they were.
//!
//! A stop ends a chord. What is beyond it is taken as going straight on, and so it is beyond the path's ends.

use alloc::collections::VecDeque;
use alloc::vec::Vec;

use real::Real;

use crate::feed_limit::{Measured, lowered};
use crate::{Junction, KinematicLimits};

/// A limit is set where h is more than 2⁻⁷ above what is allowed.
const SLACK: i32 = -7;
/// A chord is lengthened by 2⁻⁴ at least, where breaks are denser than that.
const LENGTHENING: i32 = -4;
/// From 2⁻⁴⁰ of the longest chord on, that is so many times.
const MOST_LENGTHENINGS: usize = 512;
/// Secants to the length at which h is what is allowed.
const SECANTS: usize = 6;
/// Where h in the middle is below 1 - 2⁻² of what is allowed, it is nowhere above.
const NEAR: i32 = -2;
/// Where else in a chord a break is looked at, in sixteenths of it. Without 7 and 9, chords along random moves leave them by up to
/// 1.04 of what is allowed; with them, by no more than the slack.
const OFF_MIDDLE: [i32; 4] = [6, 7, 9, 10];
/// What a million of its kind within a step do not add up to the chord error with is no break: 2⁻²⁰ of the one that does alone.
const NOTABLE: i32 = -20;
/// Places kept at least before any are forgotten.
const FEW: usize = 64;

/// A place of the path.
#[derive(Clone, Copy, Debug)]
struct Place<R, const D: usize> {
    distance: R,
    point: [R; D],
    tangent: [R; D],
}

/// The path as far as a chord reaches, and the breaks that were not looked at yet.
#[derive(Debug)]
pub(crate) struct FineMoves<R, const D: usize> {
    /// In order; two of the same distance where the tangent breaks.
    places: Vec<Place<R, D>>,
    /// How many places there are when some are forgotten.
    full: usize,
    /// Their distances, in order. The path beyond them is not known far enough yet.
    breaks: VecDeque<R>,
    /// Largest difference of unit tangents that is no break.
    negligible: R,
    /// Half of the chord at full feed, and how far a chord reaches from a break.
    half_step: R,
    reach: R,
    period: R,
    /// The distance between chord and path that is allowed.
    allowed: R,
}

impl<R: Real, const D: usize> FineMoves<R, D> {
    /// `rounding` is the largest difference of unit tangents that rounding may make.
    pub(crate) fn new(limits: &KinematicLimits<R>, rounding: R) -> Self {
        let period = limits.interpolation_period;
        let half_step = (limits.feedrate * period).half();
        let allowed = match limits.junction {
            Junction::Deviation(deviation) => deviation.max(limits.chord_error),
            _ => limits.chord_error,
        };
        let alone = limits.chord_error.scale(1) / half_step;
        Self {
            places: Vec::new(),
            full: FEW,
            breaks: VecDeque::new(),
            negligible: rounding.max(alone.scale(NOTABLE)),
            half_step,
            reach: half_step + half_step.scale(-2),
            period,
            allowed,
        }
    }

    /// The path goes on here, with this tangent.
    pub(crate) fn pass(&mut self, distance: R, point: [R; D], tangent: [R; D]) {
        self.places.push(Place { distance, point, tangent });
    }

    /// The path goes on from where it is, with another tangent; the difference has this length.
    pub(crate) fn turn(&mut self, turn: R, tangent: [R; D]) {
        let Some(end) = self.places.last().copied().filter(|_| turn > self.negligible) else { return };
        self.places.push(Place { tangent, ..end });
        if self.breaks.back().is_none_or(|last| *last < end.distance) {
            self.breaks.push_back(end.distance);
        }
    }

    /// Whether the path has a place yet from which it could go on.
    pub(crate) fn is_empty(&self) -> bool {
        self.places.is_empty()
    }

    /// Ends the path, and with it every chord: what follows begins anew.
    pub(crate) fn end(&mut self, samples: &mut [Measured<R>]) {
        while let Some(at) = self.breaks.pop_front() {
            self.limit_at(at, samples);
        }
        self.places.clear();
    }

    /// Lowers the samples around each break that the path is known far enough beyond, and forgets what no chord reaches any more.
    pub(crate) fn settle(&mut self, samples: &mut [Measured<R>]) {
        let Some(end) = self.places.last().map(|place| place.distance) else { return };
        while let Some(at) = self.breaks.front().copied().filter(|at| end - *at >= self.reach) {
            self.breaks.pop_front();
            self.limit_at(at, samples);
        }
        if self.places.len() >= self.full {
            let begin = self.open_from(end);
            let kept = self.places.partition_point(|place| place.distance <= begin);
            self.places.drain(..kept.saturating_sub(1));
            self.full = FEW.max(self.places.len().saturating_mul(2));
        }
    }

    /// The distance from which on limits may still be lowered, of a path that goes on at `end`.
    pub(crate) fn open_from(&self, end: R) -> R {
        self.breaks.front().copied().unwrap_or(end) - self.reach
    }

    /// Limits the feed around the break at this distance.
    fn limit_at(&self, at: R, samples: &mut [Measured<R>]) {
        let first = samples.partition_point(|sample| sample.point.distance < at);
        let here = samples.iter().skip(first).take_while(|sample| sample.point.distance <= at);
        let feed = here.fold(R::max_value(), |least, sample| least.min(sample.point.feedrate));
        let most = (feed * self.period).half().min(self.half_step);
        let Some(half) = self.first_too_long(at, most) else { return };
        let feed = (half + half) / self.period;
        let before = lower(samples.iter_mut().take(first).rev(), feed, |distance| at - distance >= half);
        let behind = lower(samples.iter_mut().skip(first), feed, |distance| distance - at >= half);
        for single in first.saturating_sub(before)..first.saturating_add(behind) {
            lower_single(samples, single);
        }
    }

    /// Half of the shortest chord over the break at this distance that leaves the path by more than is allowed, if that is below
    /// `most`.
    fn first_too_long(&self, at: R, most: R) -> Option<R> {
        let mut chord = Chord::new(&self.places, at)?;
        let mut held = (R::zero(), R::zero());
        for _ in 0..MOST_LENGTHENINGS {
            let (half, _) = held;
            if !(half < most) {
                return None;
            }
            let half = chord.next_break().max(half + half.scale(LENGTHENING)).min(most);
            chord.lengthen_to(half);
            let error = self.error(&chord);
            if error > self.allowed + self.allowed.scale(SLACK) {
                return Some(self.crossing(chord, held, (half, error)));
            }
            held = (half, error);
        }
        None
    }

    /// Half of the chord at which the error is what is allowed: between that of a chord that holds and that of one that does not, by
    /// secants. The error being convex, each is short of it.
    fn crossing(&self, mut chord: Chord<'_, R, D>, mut held: (R, R), mut over: (R, R)) -> R {
        for _ in 0..SECANTS {
            let (width, rise) = (over.0 - held.0, over.1 - held.1);
            let room = self.allowed - held.1;
            if !(room > self.allowed.scale(SLACK) && rise > R::zero()) {
                break;
            }
            let half = held.0 + width * (room / rise);
            chord.shorten_to(half);
            let error = self.error(&chord);
            if error > self.allowed { over = (half, error) } else { held = (half, error) }
        }
        held.0
    }

    /// By how much the chord leaves the path at the break, or one of the same length does that has it at another place.
    fn error(&self, chord: &Chord<'_, R, D>) -> R {
        let one_half = R::one().half();
        let middle = self.across(chord, one_half);
        if middle <= self.allowed - self.allowed.scale(NEAR) {
            return middle;
        }
        let off_middle = OFF_MIDDLE.iter().map(|sixteenths| R::from_ratio(*sixteenths, 16));
        off_middle.fold(middle, |most, share| most.max(self.across(chord, share)))
    }

    /// The distance of the break from a chord of this length that has it at this share of it.
    fn across(&self, chord: &Chord<'_, R, D>, share: R) -> R {
        let [begin, end] = chord.ends(share);
        let centre = &chord.centre;
        let (before, behind): ([R; D], [R; D]) =
            (core::array::from_fn(|d| centre[d] - begin[d]), core::array::from_fn(|d| end[d] - centre[d]));
        let rest = R::one() - share;
        let offset: [R; D] = core::array::from_fn(|d| rest * before[d] - share * behind[d]);
        let length = R::norm(&offset);
        let along: [R; D] = core::array::from_fn(|d| before[d] + behind[d]);
        let square = R::sum_of_products(along.into_iter().zip(along));
        // Distances along the path are rounded, and that says nothing about the chord's error.
        if length <= self.allowed || !(square > R::zero()) {
            return length;
        }
        let rounded = R::sum_of_products(offset.into_iter().zip(along)) / square;
        R::norm(&core::array::from_fn::<_, D, _>(|d| offset[d] - rounded * along[d]))
    }
}

/// A chord over a break, as far before it as behind it along the path.
struct Chord<'a, R, const D: usize> {
    places: &'a [Place<R, D>],
    at: R,
    centre: [R; D],
    half: R,
    /// The places from the first to the second are within the chord.
    within: (usize, usize),
}

impl<'a, R: Real, const D: usize> Chord<'a, R, D> {
    /// Of no length; `None` beyond the places.
    fn new(places: &'a [Place<R, D>], at: R) -> Option<Self> {
        let first = places.partition_point(|place| place.distance < at);
        let centre = places.get(first)?.point;
        let mut chord = Self { places, at, centre, half: R::zero(), within: (first, first) };
        chord.lengthen_to(R::zero());
        Some(chord)
    }

    fn distance_of(&self, place: usize) -> Option<R> {
        self.places.get(place).map(|place| place.distance)
    }

    fn lengthen_to(&mut self, half: R) {
        let (begin, end) = (self.at - half, self.at + half);
        let (mut first, mut beyond) = self.within;
        while first > 0 && self.distance_of(first - 1).is_some_and(|distance| distance >= begin) {
            first -= 1;
        }
        while self.distance_of(beyond).is_some_and(|distance| distance <= end) {
            beyond += 1;
        }
        (self.half, self.within) = (half, (first, beyond));
    }

    fn shorten_to(&mut self, half: R) {
        let (first, beyond) = self.within;
        let within = self.places.get(first..beyond).unwrap_or_default();
        let skipped = within.partition_point(|place| place.distance < self.at - half);
        let kept = within.partition_point(|place| place.distance <= self.at + half);
        (self.half, self.within) = (half, (first + skipped, first + kept));
    }

    /// Half of the next longer chord that ends at a place; of any length beyond them.
    fn next_break(&self) -> R {
        let (first, beyond) = self.within;
        let before = first.checked_sub(1).and_then(|place| self.distance_of(place));
        let before = before.map_or_else(R::max_value, |distance| self.at - distance);
        let behind = self.distance_of(beyond).map_or_else(R::max_value, |distance| distance - self.at);
        before.min(behind)
    }

    /// Both ends of a chord of this length that has the break at this share of it.
    fn ends(&self, share: R) -> [[R; D]; 2] {
        let length = self.half + self.half;
        if share == R::one().half() {
            let (first, beyond) = self.within;
            return [self.point(first, self.at - self.half), self.point(beyond, self.at + self.half)];
        }
        [self.at - length * share, self.at + length * (R::one() - share)].map(|distance| {
            let next = self.places.partition_point(|place| place.distance < distance);
            self.point(next, distance)
        })
    }

    /// The point at this distance, which is before place `next` and not before the one before that: by the cubic that has the
    /// tangents of both, or straight on beyond the ends.
    fn point(&self, next: usize, distance: R) -> [R; D] {
        let before = next.checked_sub(1).and_then(|place| self.places.get(place));
        match (before, self.places.get(next)) {
            (Some(from), Some(to)) if to.distance > from.distance => from.on_the_way_to(to, distance),
            (Some(near), _) | (None, Some(near)) => {
                let length = distance - near.distance;
                core::array::from_fn(|d| near.point[d] + length * near.tangent[d])
            }
            (None, None) => self.centre,
        }
    }
}

impl<R: Real, const D: usize> Place<R, D> {
    /// The point at a distance between this place and the next.
    fn on_the_way_to(&self, to: &Self, distance: R) -> [R; D] {
        let length = to.distance - self.distance;
        let x = (distance - self.distance) / length;
        let rest = R::one() - x;
        let bend = x * rest;
        core::array::from_fn(|d| {
            let step = to.point[d] - self.point[d];
            let (first, last) = (length * self.tangent[d] - step, length * to.tangent[d] - step);
            self.point[d] + x * step + bend * (rest * first - x * last)
        })
    }
}

/// Lowers samples to a feed, until one is beyond reach, which is lowered too, or a stop. How many were looked at.
fn lower<'a, R: Real + 'a>(
    samples: impl Iterator<Item = &'a mut Measured<R>>,
    feed: R,
    is_beyond: impl Fn(R) -> bool,
) -> usize {
    let mut count = 0;
    for sample in samples {
        if !(sample.point.feedrate > R::zero()) {
            break;
        }
        sample.point.feedrate = sample.point.feedrate.min(feed);
        count += 1;
        if is_beyond(sample.point.distance) {
            break;
        }
    }
    count
}

/// Lowers a limit that holds at one point alone to what holds beside it now: above that, it would be a summit.
fn lower_single<R: Real>(samples: &mut [Measured<R>], single: usize) {
    let beside = |place: Option<usize>| {
        let sample = place.and_then(|place| samples.get(place))?;
        let margin = place.and_then(|place| samples.get(place + 1)).map_or_else(R::zero, |next| next.margin);
        Some(lowered(sample.point.feedrate, sample.margin.max(margin)))
    };
    let most = [beside(single.checked_sub(1)), beside(single.checked_add(1))].into_iter().flatten();
    let most = most.fold(R::max_value(), R::min);
    if let Some(sample) = samples.get_mut(single).filter(|sample| sample.is_single) {
        sample.point.feedrate = sample.point.feedrate.min(most);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::test_paths::{paper_limits, polyline};
    use crate::{EndFeeds, FeedLimit, ProfileKind, plan_with};
    use nurbs_core::NurbsBuf;
    use proptest::prelude::*;

    /// Points of a path by their distance.
    struct Track {
        points: Vec<[f64; 2]>,
        distances: Vec<f64>,
    }

    impl Track {
        fn of(points: &[[f64; 2]]) -> Self {
            let mut distances = vec![0.0];
            for pair in points.windows(2) {
                let step = (pair[1][0] - pair[0][0]).hypot(pair[1][1] - pair[0][1]);
                distances.push(distances.last().unwrap() + step);
            }
            Self { points: points.to_vec(), distances }
        }

        fn at(&self, distance: f64) -> [f64; 2] {
            let next = self.distances.partition_point(|d| *d < distance).clamp(1, self.points.len() - 1);
            let (a, b) = (self.points[next - 1], self.points[next]);
            let (from, to) = (self.distances[next - 1], self.distances[next]);
            let x = if to > from { ((distance - from) / (to - from)).clamp(0.0, 1.0) } else { 0.0 };
            [a[0] + x * (b[0] - a[0]), a[1] + x * (b[1] - a[1])]
        }

        /// The largest distance of a point of the path from the chord between two distances.
        fn chord_error(&self, from: f64, to: f64) -> f64 {
            let (a, b) = (self.at(from), self.at(to));
            let along = [b[0] - a[0], b[1] - a[1]];
            let length = along[0].hypot(along[1]);
            let first = self.distances.partition_point(|d| *d <= from);
            let end = self.distances.partition_point(|d| *d < to).max(first);
            let off = |p: &[f64; 2]| ((p[0] - a[0]) * along[1] - (p[1] - a[1]) * along[0]).abs() / length;
            self.points[first..end].iter().map(off).fold(0.0, f64::max)
        }
    }

    /// The largest error of a chord of one period along the plan, at eight phases, that passes no stop.
    fn worst_chord(track: &Track, limit: &FeedLimit<f64>, limits: &KinematicLimits<f64>, kind: ProfileKind) -> f64 {
        let plan = plan_with(limit, limits, EndFeeds::default(), kind).unwrap();
        let mut places = Vec::new();
        let (mut time, mut stage_index) = (0.0, 0);
        let stages = plan.stages();
        for i in 0.. {
            let t = f64::from(i) / 8.0;
            while stage_index < stages.len() && t > time + stages[stage_index].duration {
                time += stages[stage_index].duration;
                stage_index += 1;
            }
            let Some(stage) = stages.get(stage_index) else { break };
            places.push(stage.start + stage.distance_at(t - time));
        }
        let stops: Vec<_> = limit.points().iter().filter(|p| p.feedrate == 0.0).map(|p| p.distance).collect();
        let passes_stop = |from: f64, to: f64| stops.iter().any(|stop| from < *stop && *stop < to);
        let chords = places.iter().zip(&places[8.min(places.len())..]);
        let chords = chords.filter(|(from, to)| !passes_stop(**from, **to));
        chords.map(|(from, to)| track.chord_error(*from, *to)).fold(0.0, f64::max)
    }

    fn views(curves: &[NurbsBuf<f64, 2>]) -> Vec<nurbs_core::NurbsCurve<'_, f64, 2>> {
        curves.iter().map(NurbsBuf::as_curve).collect()
    }

    fn arc(radius: f64, step: f64, angle: f64) -> Vec<[f64; 2]> {
        let count = (radius * angle / step).round() as u32;
        let at = |i: u32| angle * f64::from(i) / f64::from(count);
        (0..=count).map(|i| [radius * at(i).sin(), radius * (1.0 - at(i).cos())]).collect()
    }

    #[test]
    fn a_circle_of_fine_moves_is_limited_as_a_circle() {
        for (radius, step) in [(1.0, 0.001), (10.0, 0.01), (10.0, 0.001), (5.0, 0.01), (30.0, 0.05)] {
            let points = arc(radius, step, 6.0);
            let curves = polyline(&points);
            let limits = paper_limits();
            let limit = FeedLimit::along(&views(&curves), &limits).unwrap();
            let expected = crate::chord_feedrate(radius, 5e-4, 1.0);
            let (mut least, mut most) = (f64::MAX, 0.0_f64);
            for i in 100..=900 {
                let at = limit.at(limit.length() * f64::from(i) / 1000.0);
                (least, most) = (least.min(at), most.max(at));
            }
            let worst = worst_chord(&Track::of(&points), &limit, &limits, ProfileKind::Cubic) / 5e-4;
            println!("{radius} {step}: {} {} worst {worst}, points {}", least / expected, most / expected, limit.points().len());
        }
    }

    fn random_path() -> impl Strategy<Value = Vec<[f64; 2]>> {
        let scale = prop_oneof![Just(0.002), Just(0.02), Just(0.1), Just(0.4)];
        let moves = prop::collection::vec((0.1..1.0_f64, -1.0..1.0_f64), 20..600);
        (scale, 0.0..1.0_f64, moves).prop_map(|(scale, bias, moves)| {
            let (mut angle, mut points) = (0.0_f64, vec![[0.0, 0.0]]);
            for (length, turn) in moves {
                let last = *points.last().unwrap();
                points.push([last[0] + scale * length * angle.cos(), last[1] + scale * length * angle.sin()]);
                angle += 3.3e-3 * (bias + (1.0 - bias) * turn);
            }
            points
        })
    }

    #[test]
    #[ignore = "a look"]
    fn look() {
        use proptest::strategy::ValueTree;
        let mut runner = proptest::test_runner::TestRunner::deterministic();
        let mut all = Vec::new();
        for _ in 0..400 {
            let points = random_path().new_tree(&mut runner).unwrap().current();
            let curves = polyline(&points);
            let limits = paper_limits();
            let limit = FeedLimit::along(&views(&curves), &limits).unwrap();
            let worst = worst_chord(&Track::of(&points), &limit, &limits, ProfileKind::SCurve) / 5e-4;
            let least = limit.points().iter().map(|p| p.feedrate).fold(1.0, f64::min);
            all.push((worst, least, points.len(), limit.length()));
        }
        all.sort_by(|a, b| b.0.total_cmp(&a.0));
        for row in all.iter().take(25) {
            println!("{row:?}");
        }
        println!("limited: {}", all.iter().filter(|row| row.1 < 0.6).count());
    }
}
