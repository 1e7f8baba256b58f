//! The feeds of a plan in chords: lowered by what the chords fall short, so that feed and acceleration stay continuous.
//!
//! Each stage falls short by a length of its own. If its feeds were lowered by that length alone, they would not meet
//! those of its neighbours. Where the chord error is some micrometres, such a step of feed within a period is a jerk of
//! several times the limit. So the feed V is lowered by a correction c that is a continuous function of time. Over a
//! *change* of feed, from V_s to V_e and from no acceleration to none, the correction goes from c_s to c_e along the
//! same shape:
//!
//! `V - c = V_s - c_s + (1 - k) (V - V_s)`, `k = (c_e - c_s)/(V_e - V_s)`,
//!
//! which has the acceleration and the jerk of V, times `1 - k`. Acceleration and jerk rise where k is negative: where
//! the correction falls while the feed rises, as out of a bend. There the correction may fall by 2⁻¹² of the rise of
//! the feed. Where the feed is constant the correction may change along a cubic, with no more acceleration and jerk
//! than the changes of feed beside it have.
//!
//! The corrections between two stops, where they are 0, are found in three steps:
//!
//! 1. *Joints*: each part of the path, a change of feed or a constant one, gives each of its two joints half of its
//!    shortfall. The correction at a joint is the length that the joint was given, over its share of the time of the two
//!    parts beside it. That share is half where the parts are symmetric in time; else it is the mean of g for the joint at a part's
//!    end and 1 minus that mean for the joint at its begin. Over a constant feed the correction is constant. The length by which a run
//!    would pass the stop is given to the joint from which the feed falls to the stop.
//! 2. *Level*: where the correction changes by more than it may over a part, the excess moves to the joint on the other
//!    side. So the sum stays the same, and the run leaves its plan only nearby.
//! 3. *Cut*: sweeps leave a small excess. Of all corrections that change by no more than they may, the largest one
//!    below and the least one above are mixed so that the sum is right. The conditions are linear, so the mixture keeps
//!    them.

use alloc::vec::Vec;

use real::Real;

use crate::chords::stretch::{Lowered, Stretch, is_under_way};
use crate::{FeedLimit, FeedPiece, ScheduleBuf, Stage, StageShape};

/// Acceleration and jerk of a change of feed may rise by 2⁻¹² of themselves: the least that the stretch to whole
/// periods leaves ([`SLOWER`](crate::plan::whole_periods::SLOWER)). With no room at all, the shortfall of a tight bend
/// was spread so far that a run reached the bend 11 steps late, at 2.1 E. With a hundred times as much room, the chord
/// errors of 240 random splines were the same.
const ROOM: i32 = -12;
/// Number of periods at each end of a constant feed over which the correction may change. If a feed is constant for
/// more than three times as long, it stays constant in between.
const BEND: i32 = 32;
/// Sweeps back and forth. Most plans take two; an excess that is left after sixteen is cut.
const SWEEPS: usize = 16;

impl<R: Real> ScheduleBuf<R> {
    /// The plan for setpoints whose chords, not arcs, have the planned lengths.
    ///
    /// The chords of each stage are shorter than their arcs by what `shortfalls` says ([`FeedLimit::shortfalls`]). An
    /// interpolator that makes each chord as long as the plan's arc would be ahead of the plan by that much. It would
    /// pass the next bend at the feed of the straight before or behind it. So this function lowers the feed and keeps
    /// the times: from stop to stop the length is less by the sum of the shortfalls. Feed and acceleration stay
    /// continuous wherever they were. Acceleration and jerk rise by no more than the stretch to whole periods left of
    /// their limits.
    ///
    /// The price is that the run leaves its plan near a joint at which the shortfall changes. It does so by a share of
    /// the change of the shortfall over a transition; over a tight bend, by half of the bend's shortfall. A stage of
    /// constant feed may become three stages, of which the outer two lead to other feeds.
    ///
    /// `limit` is the limit that the plan was made under: it says where on the path such a stage is divided.
    #[must_use]
    pub fn shortened(self, limit: &FeedLimit<R>, shortfalls: &[R]) -> Self {
        let period = self.interpolation_period;
        self.by_sections(shortfalls, |stages, shortfalls| {
            shortened(limit, &Stretch::of(stages, shortfalls), R::zero(), period)
        })
    }
}

/// Shortens the stages of a stretch, each by its shortfall, and by `at_the_end` more where the last change of feed
/// begins to brake to the stop. The starts of the stages are left as they are.
pub(crate) fn shortened<R: Real>(
    limit: &FeedLimit<R>,
    stretch: &Stretch<'_, R>,
    at_the_end: R,
    period: R,
) -> Vec<Stage<R>> {
    let &Stretch { stages, shortfalls, begin, count } = stretch;
    let mut parts = parts(stages, shortfalls, period);
    part_way(&mut parts, stages, shortfalls, count);
    let mut joints = joints(&parts, begin);
    if let Some(last) = joints.iter_mut().rev().find(|joint| joint.is_free() && joint.most > R::zero()) {
        last.correction = last.correction + at_the_end / last.time;
    }
    level(&mut joints, &parts);
    cut(&mut joints, &parts);
    let mut short = Vec::with_capacity(count);
    for (part, ends) in parts.iter().zip(joints.windows(2)).take_while(|(part, _)| part.first < count) {
        let Some(whole) = stages.get(part.first..part.behind.min(count)) else { continue };
        let ends = [ends[0].correction, ends[1].correction];
        let ends = if part.is_cut_at(count) { part.wherever_it_ends(ends) } else { ends };
        match (part.is_constant(), whole) {
            (true, [stage]) => part.lower_constant(stage, ends, limit, &mut short),
            _ => short.extend(whole.iter().map(|stage| part.lowered(stage, ends))),
        }
    }
    short
}

/// A change of feed, a constant feed, or one end or the middle of a constant feed.
#[derive(Clone, Copy)]
struct Part<R> {
    /// Indices of its stages: the first, and the one behind the last.
    first: usize,
    behind: usize,
    /// Time from the begin of the first stage to the begin of the part.
    begin: R,
    duration: R,
    feeds: [R; 2],
    /// The share of the time with which the correction at its end counts for its length: a half where it is symmetric in time.
    late: R,
    shortfall: R,
    /// By how much the correction may rise, and by how much it may fall, over the part.
    rise: R,
    fall: R,
}

impl<R: Real> Part<R> {
    fn is_constant(&self) -> bool {
        self.feeds[0] == self.feeds[1]
    }

    /// Whether stages up to `count` end within it.
    fn is_cut_at(&self, count: usize) -> bool {
        self.first < count && count < self.behind
    }

    fn rises_from_motion(&self) -> bool {
        R::zero() < self.feeds[0] && self.feeds[0] < self.feeds[1]
    }

    /// Corrections that do for a change of feed of which later stages may make a longer one. If the feed falls it may
    /// fall to rest, so the correction is in proportion to it.
    fn wherever_it_ends(&self, [begin, end]: [R; 2]) -> [R; 2] {
        let [from, to] = self.feeds;
        [begin, if to < from { begin * (to / from) } else { end }]
    }

    /// One stage of a change of feed, with its feeds lowered by corrections that go from `begin` to `end` over the
    /// change.
    fn lowered(&self, stage: &Stage<R>, [begin, end]: [R; 2]) -> Stage<R> {
        let [from, to] = self.feeds;
        let change = to - from;
        let k = if change.is_zero() { R::zero() } else { (end - begin) / change };
        let lowered = |feed: R| if feed == to { feed - end } else { feed - begin - (feed - from) * k };
        let off = begin * stage.duration + (stage.length - from * stage.duration) * k;
        Stage {
            length: stage.length - off,
            start_feed: lowered(stage.start_feed),
            end_feed: lowered(stage.end_feed),
            ..*stage
        }
    }

    /// Appends this part of a stage of constant feed, or lengthens the last of the shortened stages by it.
    fn lower_constant(
        &self,
        stage: &Stage<R>,
        [begin, end]: [R; 2],
        limit: &FeedLimit<R>,
        short: &mut Vec<Stage<R>>,
    ) {
        let feed = self.feeds[0];
        let (start_feed, end_feed) = (feed - begin, feed - end);
        let length = (start_feed + end_feed).half() * self.duration;
        let here = (stage.curve_end, stage.u_end);
        let is_rest = self.begin > R::zero();
        if let Some(last) = short.last_mut().filter(|_| is_rest) {
            if start_feed == end_feed && last.start_feed == end_feed && last.end_feed == end_feed {
                last.length = last.length + length;
                last.duration = last.duration + self.duration;
                (last.curve_end, last.u_end) = here;
                return;
            }
            (last.curve_end, last.u_end) = limit.parameter_at(stage.start + feed * self.begin);
        }
        let begins = short.last().filter(|_| is_rest).map(|last| (last.curve_end, last.u_end));
        let (curve_start, u_start) = begins.unwrap_or((stage.curve_start, stage.u_start));
        let shape = if start_feed == end_feed { stage.shape } else { StageShape::Cubic };
        let duration = self.duration;
        short.push(Stage { length, start_feed, end_feed, duration, shape, curve_start, u_start, ..*stage });
    }
}

/// The parts of a path between two stops, and by how much the correction may change over each.
fn parts<R: Real>(stages: &[Stage<R>], shortfalls: &[R], period: R) -> Vec<Part<R>> {
    let mut parts: Vec<Part<R>> = Vec::with_capacity(stages.len());
    let bend = period * R::from_ratio(BEND, 1);
    let mut first = 0;
    for change in stages.split_inclusive(|stage| !is_under_way(stage)) {
        let (Some(begins), Some(ends)) = (change.first(), change.last()) else { continue };
        let behind = first + change.len();
        let duration = change.iter().fold(R::zero(), |sum, stage| sum + stage.duration);
        let shortfall = shortfalls.iter().take(behind).skip(first);
        let shortfall = shortfall.fold(R::zero(), |sum, part| sum + part.max(R::zero()));
        let feeds = [begins.start_feed, ends.end_feed];
        let (most, least) = ((feeds[1] - feeds[0]).abs(), (feeds[1] - feeds[0]).abs().ldexp(ROOM));
        let (rise, fall) = if feeds[1] > feeds[0] { (most, least) } else { (least, most) };
        let late = late(change, duration, feeds);
        let part = Part { first, behind, begin: R::zero(), duration, feeds, late, shortfall, rise, fall };
        let middle = duration - bend - bend;
        if part.is_constant() && change.len() == 1 && middle > bend {
            let of = |begin, duration| Part {
                begin,
                duration,
                shortfall: shortfall * (duration / part.duration),
                ..part
            };
            parts.extend([of(R::zero(), bend), of(bend, middle), of(duration - bend, bend)]);
        } else {
            parts.push(part);
        }
        first = behind;
    }
    let changes: Vec<_> =
        parts.iter().map(|part| (!part.is_constant()).then(|| peaks(part, stages))).collect();
    for (index, part) in parts.iter_mut().enumerate().filter(|(_, part)| part.is_constant()) {
        let (before, behind) = changes.split_at(index.min(changes.len()));
        let (before, after) =
            (before.iter().rev().find_map(|peaks| *peaks), behind.iter().find_map(|peaks| *peaks));
        let [a, b] = [before.or(after), after.or(before)].map(|peaks| peaks.unwrap_or([R::zero(); 2]));
        let (acceleration, jerk) = (a[0].min(b[0]), a[1].min(b[1]));
        let by_acceleration = acceleration * part.duration / StageShape::<R>::Cubic.peak_slope();
        let by_jerk = jerk * part.duration * part.duration / StageShape::<R>::Cubic.peak_bend();
        // In less than a period the correction could hardly change.
        let most = if part.duration < period { R::zero() } else { by_acceleration.min(by_jerk) };
        (part.rise, part.fall) = (most, most);
    }
    parts
}

/// Holds the correction back over a rise of feed of which later stages may make a longer one: it rises by no more than the
/// mean share by which chords fall short. With twice that, runs were behind their plan at the stop, which cannot be made
/// up for; with nothing at all, a run through windows of one rise each never corrected itself.
fn part_way<R: Real>(parts: &mut [Part<R>], stages: &[Stage<R>], shortfalls: &[R], count: usize) {
    let length = stages.iter().fold(R::zero(), |sum, stage| sum + stage.length);
    let shortfall = shortfalls.iter().fold(R::zero(), |sum, part| sum + part.max(R::zero()));
    for part in parts.iter_mut().filter(|part| part.is_cut_at(count) && part.rises_from_motion()) {
        part.rise = part.rise * (shortfall / length).min(R::one().ldexp(ROOM));
        part.fall = R::zero();
    }
}

/// The mean of g over a change of feed. Over a chain of stages of constant jerk that need not be a half.
fn late<R: Real>(stages: &[Stage<R>], duration: R, [from, to]: [R; 2]) -> R {
    let half = R::one().half();
    let is_symmetric = !stages.iter().any(|stage| matches!(stage.shape, StageShape::Bent(_)))
        && stages.iter().map(|stage| stage.duration).eq(stages.iter().rev().map(|stage| stage.duration));
    let change = (to - from) * duration;
    if is_symmetric || change.is_zero() {
        return half;
    }
    let above = stages.iter().fold(R::zero(), |sum, stage| sum + (stage.length - from * stage.duration));
    (above / change).max(R::zero()).min(R::one())
}

/// The largest acceleration and jerk of a part's stages.
fn peaks<R: Real>(part: &Part<R>, stages: &[Stage<R>]) -> [R; 2] {
    let pieces = stages.get(part.first..part.behind).unwrap_or_default().iter().map(Stage::piece);
    let larger = |[a, j]: [R; 2], piece: FeedPiece<R>| {
        [a.max(piece.peak_acceleration().abs()), j.max(piece.peak_jerk().abs())]
    };
    pieces.fold([R::zero(); 2], larger)
}

/// The place where two parts meet, where the first begins, or where the last ends.
#[derive(Clone, Copy)]
struct Joint<R> {
    /// The feed is lowered by this much there.
    correction: R,
    /// The largest correction: half of the feed.
    most: R,
    /// The share of the time of the parts beside it for which the correction counts: half of it where they are symmetric.
    time: R,
    /// Whether the correction is that of final stages.
    is_fixed: bool,
}

impl<R: Real> Joint<R> {
    fn is_free(&self) -> bool {
        !self.is_fixed && self.time > R::zero()
    }
}

/// The joints, each with the length that its parts give it, divided by its time. Behind final stages the first joint is fixed, and
/// so is the second if the feed is changing there.
fn joints<R: Real>(parts: &[Part<R>], begin: Option<Lowered<R>>) -> Vec<Joint<R>> {
    let first = parts.first().map(|part| part.feeds[0]);
    let feeds = first.into_iter().chain(parts.iter().map(|part| part.feeds[1]));
    // `correction` holds a length until it is divided by the time.
    let new = |feed: R| Joint { correction: R::zero(), most: feed.half(), time: R::zero(), is_fixed: false };
    let mut joints: Vec<_> = feeds.map(new).collect();
    for (index, part) in parts.iter().enumerate() {
        let Some([a, b]) = joints.get_mut(index..index + 2) else { continue };
        let half = part.shortfall.half();
        let (to_a, to_b) = match (a.most > R::zero(), b.most > R::zero()) {
            (false, true) => (R::zero(), part.shortfall),
            (true, false) => (part.shortfall, R::zero()),
            _ => (half, part.shortfall - half),
        };
        let late = part.duration * part.late;
        (a.correction, a.time) = (a.correction + to_a, a.time + (part.duration - late));
        (b.correction, b.time) = (b.correction + to_b, b.time + late);
    }
    if let Some((begin, first)) = begin.zip(parts.first()) {
        fix(&mut joints, first, &begin);
    }
    // All joints of a constant feed have the same correction.
    let mut rest = joints.as_mut_slice();
    let mut parts = parts.iter();
    while !rest.is_empty() {
        let count = 1 + parts.by_ref().take_while(|part| part.is_constant()).count();
        let (these, others) = rest.split_at_mut(count.min(rest.len()));
        let free = || these.iter().filter(|joint| !joint.is_fixed);
        let sum = |of: fn(&Joint<R>) -> R| free().fold(R::zero(), |sum, joint| sum + of(joint));
        let (given, time) = (sum(|joint| joint.correction), sum(|joint| joint.time));
        let correction = if time > R::zero() { given / time } else { R::zero() };
        these.iter_mut().filter(|joint| !joint.is_fixed).for_each(|joint| joint.correction = correction);
        rest = others;
    }
    joints
}

/// Fixes the joints up to the end of a change of feed that final stages began, or the first one. What they were given is
/// left to the first joint that is free, with the length by which the run is ahead of its plan.
fn fix<R: Real>(joints: &mut [Joint<R>], first: &Part<R>, begin: &Lowered<R>) {
    let change = first.feeds[1] - first.feeds[0];
    let behind = begin.slope.map(|slope| begin.correction + slope * change);
    let mut due = begin.ahead;
    for (joint, correction) in joints.iter_mut().zip([Some(begin.correction), behind].into_iter().flatten()) {
        due = due + joint.correction - correction * joint.time;
        (joint.correction, joint.is_fixed) = (correction, true);
    }
    if let Some(next) = joints.iter_mut().find(|joint| joint.is_free()) {
        next.correction = next.correction + due;
    }
}

/// Where a correction changes by too much over a part, moves the excess to the other end of the part. Where a
/// correction is too large at a joint, moves the excess to the next joint.
fn level<R: Real>(joints: &mut [Joint<R>], parts: &[Part<R>]) {
    for _ in 0..SWEEPS {
        let mut is_level = true;
        let mut over = |(index, part): (usize, &Part<R>), is_forwards: bool| {
            let Some([a, b]) = joints.get_mut(index..index + 2) else { return };
            let change = b.correction - a.correction;
            let excess = change - change.max(R::zero() - part.fall).min(part.rise);
            if !excess.is_zero() && !b.is_fixed {
                let time = a.time + b.time;
                let share = if time > R::zero() { b.time / time } else { R::one().half() };
                let to_a = if a.is_fixed { R::zero() } else { excess * share };
                (a.correction, b.correction) = (a.correction + to_a, b.correction - (excess - to_a));
                is_level = false;
            }
            let (from, to) = if is_forwards { (a, b) } else { (b, a) };
            if from.correction > from.most && !from.is_fixed && to.is_free() {
                to.correction = to.correction + (from.correction - from.most) * (from.time / to.time);
                from.correction = from.most;
                is_level = false;
            }
        };
        parts.iter().enumerate().for_each(|part| over(part, true));
        parts.iter().enumerate().rev().for_each(|part| over(part, false));
        if is_level {
            return;
        }
    }
}

/// The corrections, each twice: none below 0 or above its most, and behind a fixed one none that cannot be reached from
/// it.
fn allowed<R: Real>(joints: &[Joint<R>], parts: &[Part<R>]) -> Vec<[R; 2]> {
    let mut within: Option<[R; 2]> = None;
    let mut before = parts.iter();
    let of_joint = |(index, joint): (usize, &Joint<R>)| {
        let part = if index > 0 { before.next() } else { None };
        within = within.zip(part).map(|([low, high], part)| [low - part.fall, high + part.rise]);
        let mut correction = joint.correction;
        if joint.is_fixed {
            within = Some([correction; 2]);
        } else {
            if let Some([low, high]) = within {
                correction = correction.max(low).min(high);
            }
            correction = correction.min(joint.most).max(R::zero());
        }
        [correction; 2]
    };
    joints.iter().enumerate().map(of_joint).collect()
}

/// Replaces the corrections by a mixture. Of all corrections that change by no more than they may, it mixes the largest
/// one below the given ones with the least one above.
fn cut<R: Real>(joints: &mut [Joint<R>], parts: &[Part<R>]) {
    let mut bounds = allowed(joints, parts);
    let mut narrow = |(index, part): (usize, &Part<R>)| {
        let Some([[low_a, high_a], [low_b, high_b]]) = bounds.get_mut(index..index + 2) else { return };
        (*low_a, *low_b) = ((*low_a).min(*low_b + part.fall), (*low_b).min(*low_a + part.rise));
        (*high_a, *high_b) = ((*high_a).max(*high_b - part.rise), (*high_b).max(*high_a - part.fall));
    };
    parts.iter().enumerate().for_each(&mut narrow);
    parts.iter().enumerate().rev().for_each(&mut narrow);
    // Where both bounds are equal there is nothing to mix: each stretch between such joints has a sum of its own.
    let mut due = R::zero();
    let mut rest = &mut *joints;
    let mut bounds = bounds.as_slice();
    while !rest.is_empty() {
        let differ = bounds.iter().take_while(|[low, high]| low < high).count();
        let (these, others) = rest.split_at_mut(differ.max(1).min(rest.len()));
        let (between, behind) = bounds.split_at(these.len().min(bounds.len()));
        let mut most = R::zero();
        for (joint, [low, high]) in these.iter().zip(between) {
            due = due + (joint.correction - *low) * joint.time;
            most = most + (*high - *low) * joint.time;
        }
        let share = if most > R::zero() { (due / most).max(R::zero()).min(R::one()) } else { R::zero() };
        for (joint, [low, high]) in these.iter_mut().zip(between).filter(|(joint, _)| !joint.is_fixed) {
            joint.correction = *low + (*high - *low) * share;
        }
        due = due - most * share;
        (rest, bounds) = (others, behind);
    }
    // A difference by rounding over a constant feed would be a large jerk if the part is short.
    for (index, part) in parts.iter().enumerate().filter(|(_, part)| part.is_constant()) {
        let Some([a, b]) = joints.get_mut(index..index + 2) else { continue };
        if (b.correction - a.correction).abs() <= part.feeds[0] * R::resolution().ldexp(2) {
            b.correction = a.correction;
        }
    }
}

#[cfg(test)]
mod tests {
    use nurbs_core::NurbsBuf;
    use proptest::prelude::*;
    use proptest::test_runner::TestCaseError;

    use crate::chords::stretch::Stretch;
    use crate::schedule::stage::examples::stages;
    use crate::test_paths::{in_periods, jerk_over_periods, limit_through};
    use crate::{EndFeeds, FeedLimit, KinematicLimits, ProfileKind, ScheduleBuf, Stage, plan_with};

    /// The share by which peaks may rise, with an allowance for rounding.
    const ROOM: f64 = 1.0 + 1.0 / 4096.0 + 1e-9;

    /// Checks a shortened plan. Feeds and accelerations of neighbours meet. Times stay the same, and so do the places
    /// of stops. The lengths between stops are less by the shortfalls.
    fn assert_smooth(
        arcs: &ScheduleBuf<f64>,
        short: &ScheduleBuf<f64>,
        shortfalls: &[f64],
    ) -> Result<(), TestCaseError> {
        let (mut feed, mut acceleration, mut start, mut before) = (0.0, 0.0, 0.0, 0.0_f64);
        let most = |of: fn(&Stage<f64>) -> f64| arcs.stages().iter().map(of).fold(0.0, f64::max);
        let accelerations = most(|stage| stage.piece().peak_acceleration().abs());
        let jerks = most(|stage| stage.piece().peak_jerk().abs());
        for stage in short.stages() {
            prop_assert!((stage.start_feed - feed).abs() < 1e-14, "{stage:?} behind {feed}");
            // A feed is rounded, and over a stage of a millionth of a period that rounding is a jerk.
            let rounding = 8.0 * f64::EPSILON * stage.start_feed.max(stage.end_feed) / stage.duration;
            let begins = (stage.acceleration_at(0.0) - acceleration).abs();
            prop_assert!(
                begins <= 1e-9 * accelerations + rounding.max(before),
                "{stage:?} behind {acceleration}"
            );
            prop_assert!((stage.start - start).abs() < 1e-11 && stage.start_feed.min(stage.end_feed) >= 0.0);
            let length = stage.piece().length();
            prop_assert!((stage.length - length).abs() < 1e-10 * (1.0 + length), "{stage:?}: {length}");
            let piece = stage.piece();
            prop_assert!(piece.peak_acceleration().abs() <= accelerations * ROOM + rounding, "{stage:?}");
            prop_assert!(
                piece.peak_jerk().abs() <= jerks * ROOM + rounding / stage.duration,
                "{stage:?} {jerks}"
            );
            before = rounding;
            (feed, acceleration) = (stage.end_feed, stage.acceleration_at(stage.duration));
            start = stage.start + stage.length;
        }
        prop_assert_eq!(feed, 0.0);
        let lengths = |plan: &ScheduleBuf<f64>| -> Vec<f64> {
            let sections = plan.stages.split_inclusive(|stage| stage.end_feed == 0.0);
            sections.map(|stages| stages.iter().map(|stage| stage.length).sum()).collect()
        };
        let (before, after) = (lengths(arcs), lengths(short));
        prop_assert_eq!(before.len(), after.len());
        let mut rest = shortfalls;
        let sections = arcs.stages.split_inclusive(|stage| stage.end_feed == 0.0);
        for ((section, before), after) in sections.zip(before).zip(after) {
            let (these, others) = rest.split_at(section.len());
            let sum: f64 = these.iter().sum();
            prop_assert!((before - after - sum).abs() < 1e-11 * (1.0 + before), "{before} {after} {sum}");
            rest = others;
        }
        let (time, whole) = (short.as_schedule().duration(), arcs.as_schedule().duration());
        prop_assert!((time - whole).abs() < 1e-12 * whole);
        Ok(())
    }

    /// A spline that winds through points, more tightly at first.
    fn spline() -> impl Strategy<Value = NurbsBuf<f64, 2>> {
        let strides = prop::collection::vec((-0.3..0.7_f64, -0.5..0.5_f64), 6..30);
        (2..5_usize, 4.0..60.0_f64, strides).prop_map(|(degree, scale, strides)| {
            let (mut at, half) = ([0.0; 2], strides.len() / 2);
            let points = strides.iter().enumerate().map(|(index, (x, y))| {
                let scale = if index < half { scale } else { 3.0 * scale };
                at = [at[0] + scale * x, at[1] + scale * y];
                at
            });
            let points: Vec<_> = points.collect();
            let last = (points.len() - degree) as f64;
            let inner = (1..points.len() - degree).map(|knot| knot as f64);
            let ends = |knot| std::iter::repeat_n(knot, degree + 1);
            let knots = ends(0.0).chain(inner).chain(ends(last)).collect();
            NurbsBuf::try_new_nonrational(degree, points, knots).unwrap()
        })
    }

    #[test]
    fn a_shortened_plan_keeps_its_times_and_its_feeds_meet() {
        let plan = ScheduleBuf { stages: stages().to_vec(), interpolation_period: 1.0, periods: 4 };
        let limit = limit_through(&[(0.0, 1.0), (2.475, 1.0)]);
        let shortened = |shortfalls: &[f64]| {
            let short = plan.clone().shortened(&limit, shortfalls);
            assert!((short.as_schedule().duration() - plan.as_schedule().duration()).abs() < 1e-15);
            let (mut start, mut feed) = (0.0, 0.0);
            for stage in short.stages() {
                assert!((stage.start - start).abs() < 1e-15, "{stage:?}");
                assert_eq!(stage.start_feed, feed);
                let mean = f64::midpoint(stage.start_feed, stage.end_feed);
                assert!((mean * stage.duration - stage.length).abs() < 1e-15, "{stage:?}");
                (start, feed) = (start + stage.length, stage.end_feed);
            }
            plan.as_schedule().length() - short.as_schedule().length()
        };
        // 0.3 is more than the second stage has.
        for shortfalls in [[0.01, 0.0, 0.02], [0.0, 0.3, 0.0], [0.2, 0.0, 0.0]] {
            let sum: f64 = shortfalls.iter().sum();
            let less = shortened(&shortfalls);
            assert!((less - sum).abs() < 1e-15, "{shortfalls:?}: {less}");
        }
        // A negative shortfall counts as 0, and so does a missing one.
        assert!((shortened(&[-1.0, 0.02, 0.0]) - 0.02).abs() < 1e-15);
        assert_eq!(plan.clone().shortened(&limit, &[]), plan);
        // No more than half of the path is taken off.
        assert!((shortened(&[2.0, 2.0, 2.0]) - 2.475 / 2.0).abs() < 1e-15);
    }

    /// The run lands on each stop: shortfalls before the stop do not shorten the path behind it.
    #[test]
    fn a_stop_divides_what_is_shortened() {
        let [up, cruise, down] = stages();
        let land = Stage { start_feed: 1.0, end_feed: 0.0, length: 0.55, ..down };
        let stages = vec![up, cruise, land, Stage { start: 2.2, ..up }, Stage { start: 3.45, ..land }];
        let plan = ScheduleBuf { stages, interpolation_period: 1.0, periods: 8 };
        let limit = limit_through(&[(0.0, 1.0), (4.0, 1.0)]);
        let short = plan.clone().shortened(&limit, &[0.1, 0.0, 0.0, 0.0, 0.02]);
        let length = |stages: &[Stage<f64>]| stages.iter().map(|stage| stage.length).sum::<f64>();
        for (range, less) in [(0..3, 0.1), (3..5, 0.02)] {
            let [whole, less_long] = [&plan, &short].map(|plan| length(&plan.stages()[range.clone()]));
            assert!((whole - less_long - less).abs() < 1e-15, "{range:?}: {whole} {less_long}");
        }
        assert_eq!((short.stages()[2].end_feed, short.stages()[3].start_feed), (0.0, 0.0));
    }

    proptest! {
        #![proptest_config(ProptestConfig::with_cases(48))]

        /// When each stage was shortened for itself, a step of feed between two stages was a jerk of up to 15 times the
        /// limit.
        #[test]
        fn a_plan_in_chords_keeps_the_jerk_at_any_chord_error(
            curve in spline(), period in 1e-3..5e-3_f64, feedrate in 50.0..300.0_f64, acceleration in 500.0..4500.0_f64,
            jerk in 1e4..1e5_f64, exponent in -4.0..-1.0_f64,
        ) {
            let limits = in_periods(period, feedrate, acceleration, jerk, 10.0_f64.powf(exponent));
            let Ok(limit) = FeedLimit::along(&[curve.as_curve()], &limits) else { return Ok(()) };
            for kind in ProfileKind::ALL {
                let Ok(arcs) = plan_with(&limit, &limits, EndFeeds::default(), kind) else { continue };
                let shortfalls = limit.shortfalls(&[curve.as_curve()], &arcs.as_schedule());
                let short = arcs.clone().shortened(&limit, &shortfalls);
                assert_smooth(&arcs, &short, &shortfalls)?;
                let found = jerk_over_periods(&short.as_schedule());
                prop_assert!(found <= limits.jerk * (1.0 + 1e-9), "{kind:?}: {found} of {}", limits.jerk);
            }
        }
    }

    proptest! {
        #![proptest_config(ProptestConfig::with_cases(400))]

        #[test]
        fn whatever_falls_short_is_taken_off_without_a_step(
            rows in prop::collection::vec((0.01..30.0_f64, 0.02..1.0_f64, prop::bool::weighted(0.1)), 2..40),
            shares in prop::collection::vec(prop_oneof![Just(0.0), 0.0..0.01_f64, 0.0..0.3_f64], 200),
            jerk in 1e-5..0.1_f64, end in 0.0..0.1_f64,
        ) {
            let (mut distance, mut rests) = (0.0, true);
            let points: Vec<_> = rows.into_iter().enumerate().map(|(index, (stride, feedrate, stops))| {
                distance += if index > 0 { stride } else { 0.0 };
                rests = stops && !rests;
                (distance, if rests { 0.0 } else { feedrate })
            }).collect();
            let limits = KinematicLimits { jerk, ..in_periods(3e-3, 200.0, 5000.0, 4e5, 5e-4) };
            let limit = limit_through(&points);
            for kind in ProfileKind::ALL {
                let Ok(arcs) = plan_with(&limit, &limits, EndFeeds::default(), kind) else { continue };
                let shares = shares.iter().cycle();
                let mut shortfalls: Vec<_> = arcs.stages().iter().zip(shares).map(|(stage, share)| stage.length * share).collect();
                assert_smooth(&arcs, &arcs.clone().shortened(&limit, &shortfalls), &shortfalls)?;
                let at_the_end = |stages: &[Stage<f64>]| stages[stages.len() - 1].length * end;
                let short = arcs.clone().by_sections(&shortfalls, |stages, these| {
                    super::shortened(&limit, &Stretch::of(stages, these), at_the_end(stages), 1.0)
                });
                let mut behind = 0;
                for section in arcs.stages.split_inclusive(|stage| stage.end_feed == 0.0) {
                    behind += section.len();
                    shortfalls[behind - 1] += at_the_end(section);
                }
                assert_smooth(&arcs, &short, &shortfalls)?;
            }
        }
    }
}
