//! Moves finer than a step: the feed at which the chord of a period leaves the path by no more than the chord error,
//! however many breaks of the tangent it passes.
//!
//! Let a chord go from p before a place c of the path to q behind it. It leaves the place by the place's distance from
//! the line through the chord's ends. With `A = C(c) - C(c-p)`, `B = C(c+q) - C(c)`, that distance is the part across A
//! + B of
//!
//! ```text
//! h = (q A - p B) / (p + q)
//! ```
//!
//! In the middle, p = q = L/2, h is half of A - B. For breaks of the tangent by Δe_k at distances d_k along the path it
//! is `¼ Σ Δe_k (L - 2 d_k)`, for a curvature κ it is `κ L²/8`, and where there is both it is the sum. One formula
//! serves lines, curves and their joints.
//!
//! For turns of one sign a chord is farthest from the path at a break. So at each break the chord is lengthened until h
//! is more than is allowed. The limit comes from the first such length L, not from the greatest length with an allowed
//! h, since a wave as long as a chord hides from the chord. Between two lengths at which an end of the chord passes a
//! break, h is convex: it is greatest at one of the two. Then `V ≤ L/T` holds for L/2 on both sides of the break, and
//! up to the sample beyond.
//!
//! A chord over two breaks is not quite farthest from the path where a break is in its middle. For two equal breaks,
//! half a chord apart, it is farthest at 3/8 of its length, by an eighth more than in the middle. So where the middle
//! comes near the allowed distance, chords that have the break up to an eighth off their middle are tested as well.
//!
//! A limit is set only where the allowed distance is exceeded by 2⁻⁸ ([`SLACK`]). So breaks in a row of the same shape
//! share one limit, a break that the plan passes slowly anyway costs a single test, and plans over joints that are
//! smooth up to rounding stay the same.
//!
//! A corner that is passed with [`Junction::Deviation`] has a feed of its own. That feed holds for a whole step V T on
//! both sides. So a period over the corner begins and ends within these steps, however fast the feed rises beyond them
//! ([`FineMoves::step_over_corner`]).
//!
//! The difference A - B also gives the accelerations that turning needs: see [`TurningLimits`].
//!
//! A stop ends a chord. Beyond a stop, and beyond the path's ends, the path is taken to go straight on.

use alloc::collections::VecDeque;
use alloc::vec::Vec;

use real::Real;

use crate::limit::broken_chord::{Chord, PathPoint, SLACK, crossing};
use crate::limit::lowered_samples::{lower_acceleration_around, lower_around};
use crate::limit::rounded_moves::RoundedMoves;
use crate::limit::sample::ScannedSample;
use crate::limit::span_walk::tangent_rounding;
use crate::limit::turning_limits::{TurningLimits, reserve_over};
use crate::limit::vector::{across, difference, sum};
use crate::{Junction, KinematicLimits, LimitPoint};

/// Where breaks are denser than that, a chord is lengthened by at least 2⁻⁴ of itself.
const LENGTHENING: i32 = -4;
/// Most lengthenings: that many lead from 2⁻⁴⁰ of the longest chord to the longest.
const MOST_LENGTHENINGS: usize = 512;
/// The last chord is used again if it is shorter than the one found by at most 2⁻⁷ of it, or longer by at most 2⁻¹¹.
const EVEN: i32 = -7;
/// If turning uses more than this share of the axes' limits for turning, 2⁻⁴, the path keeps to its reserve.
const NOTICEABLE: i32 = -4;
/// Where h in the middle is at most 1 - 2⁻² of the allowed distance, h exceeds that distance nowhere.
const NEAR: i32 = -2;
/// Other places within a chord at which a break is tested, in sixteenths of the chord. Without 7 and 9, chords along
/// random moves leave them by up to 1.04 of the allowed distance; with them, by 1.01.
const OFF_MIDDLE: [i32; 4] = [6, 7, 9, 10];
/// Breaks under 2⁻²⁰ of the one that alone uses up the chord error are ignored: a million of them within a step stay
/// within the chord error.
const NOTABLE: i32 = -20;
/// Places are not forgotten before there are at least this many.
const FEW: usize = 64;

/// The path as far as a chord reaches, and the breaks that have not been tested yet.
#[derive(Debug)]
pub(crate) struct FineMoves<R, const D: usize> {
    /// Places in order; where the tangent breaks, two of them have the same distance.
    places: Vec<PathPoint<R, D>>,
    /// At this number of places some are forgotten.
    full: usize,
    /// The distances of breaks, in order, beyond which the path is not known far enough yet.
    breaks: VecDeque<R>,
    /// Largest difference of unit tangents that is no break.
    negligible: R,
    /// Half of the chord at full feed, and how far a chord reaches from a break.
    half_step: R,
    reach: R,
    period: R,
    /// The distance between chord and path that is allowed.
    allowed: R,
    /// The distance by which a single corner may be cut, with [`Junction::Deviation`].
    deviation: Option<R>,
    turning: Option<TurningLimits<R>>,
    rounded: Option<RoundedMoves<R>>,
    /// The last feed at which the axes can follow rounded moves.
    last_feed: R,
    /// Half of the last chord that limited the feed.
    last_half: R,
}

impl<R: Real, const D: usize> FineMoves<R, D> {
    pub(crate) fn new(limits: &KinematicLimits<R>) -> Self {
        let period = limits.interpolation_period;
        let turning = TurningLimits::new(limits);
        let half_step = (limits.feedrate * period).half();
        let deviation = match limits.junction {
            Junction::Deviation(deviation) => Some(deviation),
            _ => None,
        };
        let allowed = deviation.map_or(limits.chord_error, |most| most.max(limits.chord_error));
        let reaches_whole_step = turning.is_some() || deviation.is_some();
        let alone = limits.chord_error.ldexp(1) / half_step;
        let rounded = RoundedMoves::new(limits);
        let of_chord = half_step + if reaches_whole_step { half_step } else { half_step.ldexp(-2) };
        let reach = rounded.as_ref().map_or(of_chord, |moves| of_chord.max(moves.reach(limits.feedrate)));
        Self {
            places: Vec::new(),
            full: FEW,
            breaks: VecDeque::new(),
            negligible: tangent_rounding::<R>().max(alone.ldexp(NOTABLE)),
            half_step,
            reach,
            period,
            allowed,
            deviation,
            turning,
            rounded,
            last_feed: R::zero(),
            last_half: R::zero(),
        }
    }

    /// Adds a place from which the path goes on with this tangent.
    pub(crate) fn pass(&mut self, distance: R, point: [R; D], tangent: [R; D]) {
        self.places.push(PathPoint { distance, point, tangent });
    }

    /// From its known end the path goes on with another tangent; `turn` is the length of the tangents' difference.
    pub(crate) fn turn(&mut self, turn: R, tangent: [R; D]) {
        let Some(end) = self.places.last().copied().filter(|_| self.is_break(turn)) else { return };
        self.places.push(PathPoint { tangent, ..end });
        if self.breaks.back().is_none_or(|last| *last < end.distance) {
            self.breaks.push_back(end.distance);
        }
    }

    /// Whether unit tangents whose difference has this length make a break.
    pub(crate) fn is_break(&self, turn: R) -> bool {
        turn > self.negligible
    }

    /// Whether a chord over the last break reaches beyond the known path. Only there are the places of the path needed.
    pub(crate) fn is_waiting(&self) -> bool {
        self.breaks.back().zip(self.places.last()).is_some_and(|(at, end)| end.distance - *at < self.reach)
    }

    /// Whether no place is known from which the path could go on.
    pub(crate) fn is_empty(&self) -> bool {
        self.places.is_empty()
    }

    /// Adds the places before the last sample that a chord over a break at that sample would reach, as far as they are
    /// on the same curve. They are missing because a path without breaks is not recorded. `place_at` gives point and
    /// tangent at a parameter.
    pub(crate) fn recall(
        &mut self,
        samples: &[ScannedSample<R>],
        mut place_at: impl FnMut(R) -> ([R; D], [R; D]),
    ) {
        let Some(end) = samples.last().map(|sample| sample.point) else { return };
        let known_to = self.places.last().map(|place| place.distance);
        let is_unknown = |point: &LimitPoint<R>| {
            point.curve == end.curve && known_to.is_none_or(|known| point.distance > known)
        };
        let known = self.places.len();
        for point in samples.iter().rev().map(|sample| sample.point).take_while(is_unknown) {
            let is_another = |later: &PathPoint<R, D>| point.distance < later.distance;
            if self.places.get(known..).unwrap_or_default().last().is_none_or(is_another) {
                let (at, tangent) = place_at(point.u);
                self.pass(point.distance, at, tangent);
            }
            if point.distance <= end.distance - self.reach {
                // The places that were known before do not lead up to here.
                self.places.drain(..known);
                self.places.reverse();
                return;
            }
        }
        if let Some(recalled) = self.places.get_mut(known..) {
            recalled.reverse();
        }
    }

    /// Ends the path and every chord on it. The next place begins a new path.
    pub(crate) fn end(&mut self, samples: &mut Vec<ScannedSample<R>>) {
        while let Some(at) = self.breaks.pop_front() {
            self.limit_at(at, samples);
        }
        self.places.clear();
    }

    /// Lowers the samples around each break beyond which the path is known far enough. Forgets places that no chord
    /// reaches any more.
    pub(crate) fn settle(&mut self, samples: &mut Vec<ScannedSample<R>>) {
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

    /// For a path that goes on at `end`: the distance from which on limits may still be lowered.
    pub(crate) fn open_from(&self, end: R) -> R {
        self.breaks.front().copied().unwrap_or(end) - self.reach
    }

    /// Limits the feed around the break at this distance.
    fn limit_at(&mut self, at: R, samples: &mut Vec<ScannedSample<R>>) {
        if let Some(step) = self.step_over_corner(at) {
            lower_around(samples, at, step, step / self.period);
        }
        let first = samples.partition_point(|sample| sample.point.distance < at);
        let here = samples.iter().skip(first).take_while(|sample| sample.point.distance <= at);
        let half_at =
            |most: R, sample: &ScannedSample<R>| most.min((sample.point.feedrate * self.period).half());
        let half_there = here.clone().fold(self.half_step, half_at);
        // A limit at one point alone does not hold for the period over the point.
        let mut half = here.filter(|sample| !sample.is_single).fold(self.half_step, half_at);
        if let Some(least) = self.first_too_long(at, half, self.allowed, |chord| self.error(chord)) {
            let least = self.as_before(least);
            lower_around(samples, at, least, (least + least) / self.period);
            half = least;
        }
        if let Some(limits) = &self.turning {
            self.limit_turning(limits, at, half.min(half_there).ldexp(1), samples);
        }
        self.limit_rounded(at, samples);
    }

    /// Limits the feed to that at which the axes can follow the moves around a corner at this distance.
    fn limit_rounded(&mut self, at: R, samples: &mut Vec<ScannedSample<R>>) {
        let first = samples.partition_point(|sample| sample.point.distance < at);
        let Some(feed) = samples.get(first).map(|sample| sample.point.feedrate) else { return };
        let Some((found, way)) = self.rounded.as_ref().and_then(|moves| moves.feed(&self.places, at, feed))
        else {
            return;
        };
        let is_as_before =
            self.last_feed >= found - found.ldexp(EVEN) && self.last_feed <= found + found.ldexp(EVEN - 4);
        if !is_as_before {
            self.last_feed = found;
        }
        lower_around(samples, at, way, self.last_feed);
    }

    /// The longest step that cuts a corner at this distance by no more than the deviation δ; `None` if steps at full
    /// feed do.
    ///
    /// A setpoint is as far from the last one as the plan's step c is long. Over a turn by φ, the chord of length c
    /// that begins as far before the corner as it ends behind it leaves the corner by most: by `c/2 tan(φ/2)`. No chord
    /// leaves the corner by more than c, for it begins within c of the corner.
    fn step_over_corner(&self, at: R) -> Option<R> {
        let (deviation, (along, turn)) = (self.deviation?, self.turn_at(at)?);
        let (cosine, sine) = (R::norm(&along), R::norm(&turn));
        let (most, across) = (self.half_step + self.half_step, deviation.ldexp(1) * cosine);
        // Compares without a quotient, which would be large for a small turn.
        (deviation < most && across < most * sine).then(|| deviation.max(across / sine))
    }

    /// Limits the feed by the accelerations that turning needs; `step` is the longest step that other limits leave.
    /// Where breaks turn the path noticeably, the path keeps to its reserve of acceleration, as in a bend. On straight
    /// moves it may use all that the axes have.
    fn limit_turning(&self, limits: &TurningLimits<R>, at: R, step: R, samples: &mut Vec<ScannedSample<R>>) {
        // A corner that is cut has a feed of its own.
        let corner = self.deviation.and_then(|_| self.turn_at(at));
        let alone =
            corner.map_or_else(R::zero, |(along, turn)| limits.strain(&along, &turn.map(|x| x * step)));
        let most = alone.max(R::one());
        let found = self.first_too_long(at, step, most, |chord| limits.strain_over(chord));
        if let Some(step) = found {
            lower_around(samples, at, step, step / self.period);
        }
        let step = found.unwrap_or(step);
        let (Some(budget), Some(mut chord)) = (&limits.budget, Chord::new(&self.places, at)) else { return };
        chord.lengthen_to(step);
        if found.is_some() || limits.strain_over(&chord) > alone + R::one().ldexp(NOTICEABLE) {
            lower_acceleration_around(samples, at, step, reserve_over(budget, &chord));
        }
    }

    /// This half of a chord, or the last one if that is close enough: an even turn has one limit, not one for each
    /// break.
    fn as_before(&mut self, half: R) -> R {
        let before = self.last_half;
        let is_as_good = before >= half - half.ldexp(EVEN) && before <= half + half.ldexp(EVEN - 4);
        if !is_as_good {
            self.last_half = half;
        }
        self.last_half
    }

    /// Half of the shortest chord over the break at this distance for which `measure` exceeds `allowed`; `None` if that
    /// is not below `most`.
    fn first_too_long(
        &self,
        at: R,
        most: R,
        allowed: R,
        measure: impl Fn(&Chord<'_, R, D>) -> R,
    ) -> Option<R> {
        let mut chord = Chord::new(&self.places, at)?;
        let mut held = (R::zero(), R::zero());
        for _ in 0..MOST_LENGTHENINGS {
            let (half, _) = held;
            if !(half < most) {
                return None;
            }
            let half = chord.next_break().max(half + half.ldexp(LENGTHENING)).min(most);
            chord.lengthen_to(half);
            let found = measure(&chord);
            if found > allowed + allowed.ldexp(SLACK) {
                return Some(crossing(chord, held, (half, found), allowed, measure))
                    .filter(|half| *half > R::zero());
            }
            held = (half, found);
        }
        None
    }

    /// By how much the chord leaves the path at the break: the most over chords of this length with the break in other
    /// places.
    fn error(&self, chord: &Chord<'_, R, D>) -> R {
        let one_half = R::one().half();
        let middle = self.across(chord, one_half);
        if middle <= self.allowed - self.allowed.ldexp(NEAR) {
            return middle;
        }
        let off_middle = OFF_MIDDLE.iter().map(|sixteenths| R::from_ratio(*sixteenths, 16));
        off_middle.fold(middle, |most, share| most.max(self.across(chord, share)))
    }

    /// The distance of the break from a chord of this length that the break divides at this share.
    fn across(&self, chord: &Chord<'_, R, D>, share: R) -> R {
        let [before, behind] = chord.sides(share);
        let rest = R::one() - share;
        let offset: [R; D] = core::array::from_fn(|d| rest * before[d] - share * behind[d]);
        let length = R::norm(&offset);
        // An offset this short may be a rounding of distances along the path, which is no error of the chord.
        if length <= self.allowed { length } else { R::norm(&across(&offset, &sum(&before, &behind))) }
    }

    /// The sum and the difference of the unit tangents behind and before the break at this distance.
    fn turn_at(&self, at: R) -> Option<([R; D], [R; D])> {
        let first = self.places.partition_point(|place| place.distance < at);
        let beyond = self.places.partition_point(|place| place.distance <= at);
        let before = self.places.get(first)?.tangent;
        let behind = self.places.get(beyond.checked_sub(1)?)?.tangent;
        Some((sum(&behind, &before), difference(&behind, &before)))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::limit::track::{Track, arc, limit_along, range, worst_chord};
    use crate::test_paths::{self, Fixed, in_fixed, in_range, paper_limits, polyline};
    use crate::{EndFeeds, FeedLimit, ProfileKind, chord_feedrate, plan_with};
    use nurbs_core::NurbsBuf;
    use proptest::prelude::*;
    use real::Backend;

    /// E, mm.
    const ALLOWED: f64 = 5e-4;
    /// E with the slack, and with an allowance for chords that are not centred at a break and whose ends have different
    /// feeds.
    const WORST: f64 = ALLOWED * 1.02;

    #[test]
    fn a_circle_of_fine_moves_is_limited_as_a_circle() {
        // A chord is 0.063 to 0.49 mm long, a move 1/63 to a tenth of that. The fewer moves a chord has, the more its
        // first and last move matter: a chord over n breaks may be longer or shorter than the chord of the circle by
        // about 1/(2 n).
        for (radius, step, less) in [
            (1.0, 0.001, 5e-3),
            (10.0, 0.01, 5e-3),
            (10.0, 0.001, 5e-3),
            (5.0, 0.01, 0.015),
            (30.0, 0.05, 0.14),
        ] {
            let (points, limits) = (arc(radius, step, 6.0), paper_limits());
            let limit = limit_along(&points, &limits);
            let expected = chord_feedrate(radius, ALLOWED, 1.0);
            let (least, most) = range(&limit);
            assert!(least > (1.0 - less) * expected, "{radius}, {step}: {least} of {expected}");
            assert!(most < 1.005 * expected, "{radius}, {step}: {most} of {expected}");
            for kind in ProfileKind::ALL {
                let worst = worst_chord(&Track::of(&points), &limit, &limits, kind);
                assert!(worst <= WORST, "{radius}, {step}: {worst}");
            }
        }
    }

    /// With stops at 4E/(F T), each break of 10 µm moves along a radius of 1 mm would be a stop; with another junction
    /// it is passed.
    #[test]
    fn other_junctions_do_not_hide_what_breaks_do_together() {
        let points = arc(1.0, 0.01, 6.0);
        let with = |junction| KinematicLimits { junction, ..paper_limits() };
        for (junction, allowed) in [
            (Junction::Deviation(ALLOWED / 2.0), ALLOWED),
            (Junction::Deviation(2.0 * ALLOWED), 2.0 * ALLOWED),
        ] {
            let limit = limit_along(&points, &with(junction));
            let expected = chord_feedrate(1.0, allowed, 1.0);
            let (least, most) = range(&limit);
            assert!(
                least > 0.97 * expected && most < 1.005 * expected,
                "{junction:?}: {least} to {most}, {expected}"
            );
            let worst = worst_chord(&Track::of(&points), &limit, &with(junction), ProfileKind::Cubic);
            assert!(worst <= 1.01 * allowed, "{junction:?}: {worst}");
        }
        // Breaks that are below 4E/(F T), each within the velocity jump that is allowed.
        let limit = limit_along(&arc(10.0, 0.01, 1.0), &with(Junction::VelocityJump([1.0; 3])));
        let (least, most) = range(&limit);
        let expected = chord_feedrate(10.0, ALLOWED, 1.0);
        assert!(least > 0.99 * expected && most < 1.005 * expected, "{least} to {most}, {expected}");
    }

    /// Coordinates in whole nm, so that each break turns by up to 1e-3.
    #[test]
    fn a_straight_line_in_fine_moves_keeps_full_feed() {
        let rounded = |x: f64| (x * 1e6).round() / 1e6;
        let points: Vec<_> = (0..8000_u32)
            .map(|i| [0.36, 0.93].map(|e: f64| rounded(e.sin() * 1e-3 * f64::from(i))))
            .collect();
        let limit = limit_along(&points, &paper_limits());
        assert_eq!(range(&limit), (0.6, 0.6));
        let breaks = points.windows(3).map(|p| {
            let direction = |a: [f64; 2], b: [f64; 2]| (b[1] - a[1]).atan2(b[0] - a[0]);
            (direction(p[1], p[2]) - direction(p[0], p[1])).abs()
        });
        assert!(breaks.clone().filter(|turn| *turn > 5e-4).count() > 1000);
    }

    /// A wave as long as the step at full feed: a chord from crest to crest does not leave it.
    #[test]
    fn a_wave_as_long_as_a_step_does_not_hide() {
        let wave = |amplitude: f64| {
            let at = |i: u32| f64::from(i) * 0.01;
            let points: Vec<_> = (0..=3000)
                .map(|i| [at(i), amplitude * (core::f64::consts::TAU * at(i) / 0.6).cos()])
                .collect();
            let limit = limit_along(&points, &paper_limits());
            let worst = worst_chord(&Track::of(&points), &limit, &paper_limits(), ProfileKind::SCurve);
            assert!(worst <= WORST, "{amplitude}: {worst}");
            range(&limit)
        };
        // At a crest, h = a (1 - cos(π L/λ)).
        assert_eq!(wave(0.49 * ALLOWED), (0.6, 0.6));
        let (least, most) = wave(ALLOWED);
        assert!((least / 0.3 - 1.0).abs() < 0.02 && most < 0.34, "{least} to {most}");
    }

    #[test]
    fn a_spiral_is_limited_by_its_radius_everywhere() {
        // The radius falls along the path, ρ = 6 - s/5, down to 1 mm, and rises again.
        let (mut angle, mut points, mut radii) = (0.0_f64, vec![[0.0, 0.0]], Vec::new());
        for i in 0..=25_000_u32 {
            let radius = 1.0 + (f64::from(i) * 2e-3 - 25.0).abs() / 5.0;
            let last = points[points.len() - 1];
            points.push([last[0] + 2e-3 * angle.cos(), last[1] + 2e-3 * angle.sin()]);
            angle += 2e-3 / radius;
            radii.push(radius);
        }
        let limit = limit_along(&points, &paper_limits());
        for (i, radius) in radii.iter().enumerate().take(24_500).skip(500).step_by(100) {
            let (found, expected) = (limit.at(2e-3 * i as f64), chord_feedrate(*radius, ALLOWED, 1.0));
            // A chord of up to 0.15 mm meets radii that are up to 0.015 mm less.
            assert!((0.975..1.005).contains(&(found / expected)), "{i}: {found} of {expected}");
        }
        let worst = worst_chord(&Track::of(&points), &limit, &paper_limits(), ProfileKind::Cubic);
        assert!(worst <= WORST, "{worst}");
    }

    /// A quarter of a circle of 2 mm as a curve that goes on in moves of 2 µm, and moves that go on in such a curve.
    #[test]
    fn moves_that_go_on_from_an_arc_are_limited_as_it_is() {
        let half = 0.5_f64.sqrt();
        let quarter = NurbsBuf::try_new(
            2,
            vec![[0.0, -2.0], [2.0, -2.0], [2.0, 0.0]],
            vec![1.0, half, 1.0],
            vec![0., 0., 0., 1., 1., 1.],
        )
        .unwrap();
        let at = |i: u32| 1e-3 * f64::from(i);
        let moves: Vec<_> = (0..=1500).map(|i| [2.0 * at(i).cos(), 2.0 * at(i).sin()]).collect();
        let mut path = vec![quarter];
        path.extend(polyline(&moves));
        let limit = test_paths::limit_along(&path, &paper_limits());
        let (least, most) = range(&limit);
        let expected = chord_feedrate(2.0, ALLOWED, 1.0);
        assert!(least > 0.99 * expected && most < 1.005 * expected, "{least} to {most}, {expected}");
        let arc: Vec<_> = (0..1571).rev().map(|i| [2.0 * at(i).cos(), -2.0 * at(i).sin()]).collect();
        let track = Track::of(&[arc, moves[1..].to_vec()].concat());
        let worst = worst_chord(&track, &limit, &paper_limits(), ProfileKind::Cubic);
        assert!(worst <= WORST, "{worst}");
    }

    /// Two arcs of 0.5 mm in fine moves with 20 mm of straight line between them: no break lowers the limit of the
    /// line.
    #[test]
    fn beyond_half_a_chord_the_limit_is_what_it_was() {
        let mut points = arc(0.5, 1e-3, 1.0);
        let (end, angle) = (points[points.len() - 1], 1.0_f64);
        points.push([end[0] + 20.0 * angle.cos(), end[1] + 20.0 * angle.sin()]);
        let limit = limit_along(&points, &paper_limits());
        let (bend, chord) = (0.5, chord_feedrate(0.5, ALLOWED, 1.0));
        let found = [bend - chord, bend].map(|at| limit.at(at) / chord);
        assert!(found[0] < 1.005 && found[1] < 1.5, "{found:?}");
        // V² rises to the next sample, which is no farther than a step away.
        assert!(limit.at(bend + 0.2) > 0.3, "{}", limit.at(bend + 0.2));
        assert_eq!(limit.at(bend + chord + 0.6), 0.6);
    }

    /// No chord passes a break at a stop.
    #[test]
    fn a_chord_ends_at_a_stop() {
        let limits = paper_limits();
        // Two turns by 0.003, which one chord must not pass at full feed, with a stop between them.
        let turn = |angle: f64, length: f64| [length * angle.cos(), length * angle.sin()];
        let chain = |moves: &[[f64; 2]]| {
            let mut points = vec![[0.0, 0.0]];
            for step in moves {
                let last = points[points.len() - 1];
                points.push([last[0] + step[0], last[1] + step[1]]);
            }
            points
        };
        let points = chain(&[turn(0.0, 5.0), turn(0.003, 0.1), turn(0.003, 0.1), turn(0.006, 5.0)]);
        let path = polyline(&points);
        let curves: Vec<_> = path.iter().map(NurbsBuf::as_curve).collect();
        let along = |stops: &[usize]| FeedLimit::along_with_stops(&curves, &limits, stops).unwrap();
        let least = |limit: &FeedLimit<f64>| {
            limit.samples().iter().fold(f64::MAX, |least, sample| least.min(sample.lower.max(1e-9)))
        };
        // The chord begins L/2 - 0.05 before the first turn: 0.003 (L - 0.1)²/(2 L) = E, so L = 0.514.
        let joined = along(&[]);
        assert!((least(&joined) - 0.514).abs() < 0.003, "{}", least(&joined));
        let stopped = along(&[2]);
        let feeds: Vec<_> =
            stopped.samples().iter().map(|sample| sample.lower).filter(|feed| *feed < 0.6).collect();
        assert_eq!(feeds, [0.0]);
    }

    #[test]
    fn narrow_formats_see_fine_moves_too() {
        fn ratios<Q: Backend>(points: &[[f64; 2]], radius: f64) -> (f64, f64) {
            let curves: Vec<_> = polyline(points).iter().map(|curve| curve.convert::<Q>().unwrap()).collect();
            let views: Vec<_> = curves.iter().map(NurbsBuf::as_curve).collect();
            let limits = in_range::<Q>(&paper_limits());
            let limit = FeedLimit::along(&views, &limits).unwrap();
            assert!(plan_with(&limit, &limits, EndFeeds::default(), ProfileKind::Cubic).is_ok());
            let length = limit.length().to_f64();
            let at = |i: u32| limit.at(Q::from_f64(length * f64::from(i) / 1000.0).unwrap()).to_f64();
            let ratios = (100..=900).map(|i| at(i) / chord_feedrate(radius, ALLOWED, 1.0));
            ratios.fold((f64::MAX, 0.0), |(least, most), ratio| (least.min(ratio), most.max(ratio)))
        }
        let (least, most) = in_fixed("I32F32", || ratios::<Fixed>(&arc(10.0, 0.01, 1.0), 10.0));
        assert!(least > 0.98 && most < 1.01, "{least} to {most}");
        let (least, most) = ratios::<f32>(&arc(20.0, 0.04, 1.0), 20.0);
        assert!(least > 0.9 && most < 1.02, "{least} to {most}");
    }

    /// Moves much shorter than a step or about as long, whose turns are smaller than that of a stop, to one side or to
    /// both.
    fn random_path() -> impl Strategy<Value = Vec<[f64; 2]>> {
        let scale = prop_oneof![Just(0.002), Just(0.02), Just(0.1), Just(0.4)];
        let moves = prop::collection::vec((0.1..1.0_f64, -1.0..1.0_f64), 20..300);
        (scale, 0.0..1.0_f64, moves).prop_map(|(scale, bias, moves)| {
            let (mut angle, mut points) = (0.0_f64, vec![[0.0, 0.0]]);
            for (length, turn) in moves {
                let last = points[points.len() - 1];
                points.push([last[0] + scale * length * angle.cos(), last[1] + scale * length * angle.sin()]);
                angle += 3.3e-3 * (bias + (1.0 - bias) * turn);
            }
            points
        })
    }

    proptest! {
        #![proptest_config(ProptestConfig::with_cases(128))]

        #[test]
        fn no_chord_along_fine_moves_leaves_them_by_more_than_allowed(points in random_path()) {
            let limits = paper_limits();
            let limit = limit_along(&points, &limits);
            let worst = worst_chord(&Track::of(&points), &limit, &limits, ProfileKind::SCurve);
            prop_assert!(worst <= WORST, "{worst}");
        }
    }
}
