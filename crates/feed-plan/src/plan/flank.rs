//! One flank of a plan: the way from a slow point up to cruising feed, under a limit.
//!
//! A ramp starts with zero acceleration, so it starts slowly; where the limit rises steadily, a single ramp must wait
//! until it has room for its steep middle and then wastes the room above its foot. A chain of smaller ramps follows the
//! limit closer, and costs time in each joint, where the acceleration returns to zero. Dynamic programming finds the
//! levels of feed between the ramps.
//!
//! All distances here are measured from the slow point toward the fast one. A falling flank is the mirror
//! image: the same chain, measured backward from the slow point at its end.

use alloc::vec::Vec;

use real::Real;

use crate::limit::sample::distance_at_feed;
use crate::plan::ramp_shape::{PARTS, RampShape};
use crate::{FeedLimit, Transition};

/// Levels above the slow point's feed. Twice as many save 0.2 to 0.7 % of time on the papers' curves, for nearly twice
/// as many stages and three times the work.
pub(crate) const LEVELS: i32 = 16;
/// Levels between the slow point's feed and the feed at the other end of the flank, if that is higher.
pub(crate) const LEVELS_BETWEEN_ENDS: i32 = 4;
/// An extra level is added only if it saves eight times what its ramp costs. With half of that, plans through short
/// windows are up to 0.3 % faster on paths of many arcs; with twice as much they are up to 1 % slower. From 8 on, the
/// plans of the papers' curves need no extra level.
const WORTH: i32 = 8;
/// A ramp may begin at this many levels below its end, the nearest ones. So the work grows with the flank, not with its
/// square. No ramp that pays passes over nearly as many levels.
const NEAREST: usize = 96;
/// How often the range between two levels is divided, at most: this bounds the work.
const DEEPEST: usize = 24;
/// Feeds down to 2⁻³² of the first level are tried for the first ramp from rest.
const HALVINGS: usize = 32;

/// How a chain of ramps reaches a level of feed.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Arrival<R> {
    /// The level.
    pub(crate) feed: R,
    /// The earliest distance at which the chain arrives there.
    pub(crate) distance: R,
    /// Time lost until then, compared with travelling the same distance at this level. It stays the same however long
    /// the level is then held. The dynamic programme depends on this.
    loss: R,
    /// Index of the level that the last ramp starts from, and the distance at which it starts.
    last_ramp: Option<(usize, R)>,
}

/// One ramp of a chain.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Ramp<R> {
    /// Distance at which it starts.
    pub(crate) start: R,
    pub(crate) low: R,
    pub(crate) high: R,
}

/// The flank above one slow point.
#[derive(Clone, Debug)]
pub(crate) struct Flank<'s, R> {
    shape: &'s RampShape<R>,
    /// The limit, lowered to a function that never falls.
    hull: Vec<HullPoint<R>>,
    levels: Vec<Arrival<R>>,
}

impl<'s, R: Real> Flank<'s, R> {
    /// The flank from limit point `slow`, passed at `feed`, to limit point `peak`. If `peak` comes before `slow`, the
    /// flank falls.
    pub(crate) fn new(
        shape: &'s RampShape<R>,
        limit: &FeedLimit<R>,
        direction: Direction,
        (slow, feed): (usize, R),
        peak: usize,
    ) -> Self {
        let base = Arrival { feed, distance: R::zero(), loss: R::zero(), last_ramp: None };
        Self { shape, hull: hull(limit, direction, slow, peak), levels: Vec::from([base]) }
    }

    /// Adds `count` levels, up to `feed`.
    pub(crate) fn raise_to(&mut self, feed: R, count: i32) {
        let from = self.levels.last().map_or(feed, |level| level.feed);
        if !(from < feed) {
            return;
        }
        for k in 1..count {
            // Squares of the shares: the levels are dense just above the minimum of the limit, where the limit is flat.
            let share = R::from_ratio(k, count);
            let target = from + (feed - from) * (share * share);
            if k == 1 {
                self.double(from, target.half());
            }
            self.fill_below(target);
            let level = self.arrival(target);
            if k == 1 && level.is_none() {
                self.leave_rest(target);
            }
            self.levels.extend(level.or_else(|| self.arrival(target)));
        }
        self.fill_below(feed);
        let level = self.arrival(feed);
        self.levels.extend(level);
    }

    /// Adds the levels below `target` at which the limit stays so long that an extra ramp pays, from the lowest up.
    /// Arcs that follow each other make a staircase of the limit. With a fixed number of levels the plan falls short of
    /// its treads, the more so the more treads there are.
    fn fill_below(&mut self, target: R) {
        let Some(mut low) = self.levels.last().map(|level| level.feed) else { return };
        let mut targets = Vec::from([target]);
        while let Some(&high) = targets.last() {
            let terrace = if targets.len() < DEEPEST { self.terrace(low, high) } else { None };
            targets.extend(terrace);
            if terrace.is_none() {
                targets.pop();
                if !targets.is_empty() {
                    let level = self.arrival(high);
                    self.levels.extend(level);
                    low = high;
                }
            }
        }
    }

    /// The feed v of the limit that saves most time between level a and level b, if it saves enough for an extra ramp.
    /// The limit allows v from s(v) on, and b from s(b) on. Between these, v saves `(s(b) - s(v)) (1/a - 1/v)` against
    /// a.
    fn terrace(&self, low: R, high: R) -> Option<R> {
        if !(low > R::zero() && high > low) {
            return None;
        }
        let [first, next] = [low, high].map(|feed| self.hull.partition_point(|point| point.feed <= feed));
        let end = self.distance_with(high, self.hull.partition_point(|point| point.feed < high))?;
        let saved = |point: &HullPoint<R>| (end - point.distance) * ((point.feed - low) / point.feed) / low;
        let between = self.hull.get(first..next)?.iter().filter(|point| point.feed < high);
        let (gain, feed) =
            between.map(|point| (saved(point), point.feed)).reduce(|a, b| if b.0 > a.0 { b } else { a })?;
        let lost = |from: R, to: R| {
            let ramp = self.shape.ramp(from, to);
            ramp.duration() - ramp.length() / high
        };
        (gain > (lost(low, feed) + lost(feed, high) - lost(low, high)) * R::from_ratio(WORTH, 1))
            .then_some(feed)
    }

    /// Adds levels below `target`, each twice the one before. The lowest is the highest that a ramp from rest can reach
    /// at once: at rest the plan cannot wait for room, and where the limit is low over more than the first ramp no
    /// higher level can be reached.
    fn leave_rest(&mut self, target: R) {
        if self.levels.len() > 1 || self.base() > R::zero() {
            return;
        }
        let halves = core::iter::successors(Some(target.half()), |feed| Some(feed.half()));
        let Some(first) = halves.take(HALVINGS).find_map(|feed| self.arrival(feed)) else { return };
        self.levels.push(first);
        self.double(first.feed, target);
    }

    /// Adds levels below `target`, each twice the one before. With no level between a very slow point and `target` the
    /// plan would keep the slow feed until the limit has room for the whole ramp.
    fn double(&mut self, from: R, target: R) {
        if !(from > R::zero()) {
            return;
        }
        let doubles = core::iter::successors(Some(from + from), |feed| Some(*feed + *feed));
        for feed in doubles.take(HALVINGS).take_while(|feed| *feed < target) {
            let level = self.arrival(feed);
            self.levels.extend(level);
        }
    }

    /// The feed at the slow point.
    pub(crate) fn base(&self) -> R {
        self.levels.first().map_or_else(R::zero, |base| base.feed)
    }

    /// The highest feed that the limit allows anywhere on the flank.
    pub(crate) fn top(&self) -> R {
        self.hull.last().map_or_else(R::zero, |point| point.feed)
    }

    /// The chain that reaches `feed` with the least loss; `None` when the limit is nowhere as high.
    pub(crate) fn arrival(&self, feed: R) -> Option<Arrival<R>> {
        if let Some(base) = self.levels.first().filter(|base| base.feed == feed) {
            return Some(*base);
        }
        let (mut best, mut narrowest) = (None, PARTS / 2);
        // The nearest levels usually lose least, and their loss soon rules out the others.
        let below = self.levels.iter().enumerate().rev().filter(|(_, level)| level.feed < feed);
        for (index, level) in below.take(NEAREST) {
            let bound = best.map_or_else(R::max_value, |best: Arrival<R>| best.loss);
            best = self.arrival_from(index, level, feed, bound, &mut narrowest).or(best);
        }
        best
    }

    /// A single ramp from the slow point to `feed`.
    pub(crate) fn direct(&self, feed: R) -> Option<Arrival<R>> {
        let base = self.levels.first()?;
        if base.feed == feed { Some(*base) } else { self.arrival_from(0, base, feed, R::max_value(), &mut 0) }
    }

    /// Arrival at `feed` by one ramp from a lower level, if it loses less than `bound`. `narrowest` is the part of a
    /// ramp for which the limit leaves least room, on this ramp or on the one tried before from another level.
    fn arrival_from(
        &self,
        index: usize,
        level: &Arrival<R>,
        feed: R,
        bound: R,
        narrowest: &mut usize,
    ) -> Option<Arrival<R>> {
        let ramp = self.shape.ramp(level.feed, feed);
        let loss_from = |start: R| {
            let waiting = if start > R::zero() { start / level.feed - start / feed } else { R::zero() };
            level.loss + waiting + ramp.duration() - ramp.length() / feed
        };
        if !(loss_from(level.distance) < bound) {
            return None; // Waiting for room would only add to it.
        }
        let latest = if bound < R::max_value() {
            latest_start((level.feed, feed), bound - loss_from(R::zero()))
        } else {
            bound
        };
        let start = self.earliest_start(level.feed, feed, ramp, latest, narrowest)?.max(level.distance);
        if start > R::zero() && !(level.feed > R::zero()) {
            return None; // Standing still leads nowhere.
        }
        let (loss, distance) = (loss_from(start), start + ramp.length());
        let is_number = loss >= level.loss && distance >= start;
        (is_number && loss < bound).then_some(Arrival {
            feed,
            distance,
            loss,
            last_ramp: Some((index, start)),
        })
    }

    /// The least distance at which a ramp can start and stay under the limit; `None` when it is beyond `latest`. The
    /// part `narrowest` is tested first.
    fn earliest_start(
        &self,
        low: R,
        high: R,
        ramp: Transition<R>,
        latest: R,
        narrowest: &mut usize,
    ) -> Option<R> {
        if let Some(part) = self.shape.parts.get(*narrowest) {
            let (travelled, feed) = part.step(low, high, &ramp);
            let next = self.hull.partition_point(|point| point.feed < feed);
            if self.distance_with(feed, next)? - travelled > latest {
                return None;
            }
        }
        let mut start = R::zero();
        let mut next = self.hull.partition_point(|point| point.feed < low);
        for (index, (travelled, feed)) in self.shape.staircase(low, high, ramp).enumerate() {
            // The feeds of the staircase rise, so the place in the hull only moves forward.
            while self.hull.get(next).is_some_and(|point| point.feed < feed) {
                next += 1;
            }
            let room = self.distance_with(feed, next)? - travelled;
            if room > start {
                (start, *narrowest) = (room, index);
                if start > latest {
                    return None;
                }
            }
        }
        Some(start)
    }

    /// The distance from which on the limit is at least `feed`; `next` is the first point of the hull whose feed is.
    fn distance_with(&self, feed: R, next: usize) -> Option<R> {
        let to = self.hull.get(next)?;
        let Some(from) = next.checked_sub(1).and_then(|i| self.hull.get(i)) else {
            return Some(R::zero());
        };
        let beyond = (feed - from.feed) * (feed + from.feed) * from.distance_per_square;
        Some((from.distance + beyond).min(to.distance))
    }

    /// The ramps that lead to an arrival, the first one first.
    pub(crate) fn chain(&self, arrival: &Arrival<R>) -> Vec<Ramp<R>> {
        let mut ramps = Vec::new();
        let mut at = *arrival;
        while let Some((index, start)) = at.last_ramp {
            let Some(&from) = self.levels.get(index) else { break };
            ramps.push(Ramp { start, low: from.feed, high: at.feed });
            at = from; // Its index is lower: a level is reached from those before it.
        }
        ramps.reverse();
        ramps
    }
}

/// The distance s that may be travelled at the lower of two feeds, in place of the higher one, at a loss of `spare`:
/// `s/low - s/high = spare`. It is increased by far more than rounding may take away.
fn latest_start<R: Real>((low, high): (R, R), spare: R) -> R {
    let latest = spare * low / ((high - low) / high);
    let above = latest + latest.ldexp(-6) + R::resolution().ldexp(6);
    // A distance that does not fit the format is no limit.
    if above >= latest { above } else { R::max_value() }
}

/// Whether the feed rises or falls along the path.
#[derive(Clone, Copy, Debug)]
pub(crate) enum Direction {
    /// The slow point comes first.
    Rising,
    /// The slow point comes last.
    Falling,
}

/// A point of the hull: up to the next one, V² is linear in the distance.
#[derive(Clone, Copy, Debug)]
struct HullPoint<R> {
    distance: R,
    feed: R,
    /// `ds/d(V²)` up to the next point.
    distance_per_square: R,
}

/// The highest function under the limit that never falls from the slow point to the peak. Distances count from the slow
/// point.
fn hull<R: Real>(limit: &FeedLimit<R>, direction: Direction, slow: usize, peak: usize) -> Vec<HullPoint<R>> {
    let Some(foot) = limit.samples().get(slow) else { return Vec::new() };
    let mut hull = Descent { origin: foot.point.distance, points: Vec::new() };
    let at_foot = match direction {
        Direction::Rising => {
            for i in (slow..peak).rev() {
                hull.pass(limit, i + 1);
                limit.cell(i).into_iter().for_each(|(near, far)| hull.descend(near, far));
            }
            foot.lower_after
        }
        Direction::Falling => {
            for i in peak..slow {
                hull.pass(limit, i);
                limit.cell(i).into_iter().for_each(|(far, near)| hull.descend(near, far));
            }
            foot.lower_before
        }
    };
    hull.push(R::zero(), hull.least(at_foot));
    hull.points.reverse();
    hull.points
}

/// The hull as it is built, from the peak down to the slow point.
struct Descent<R> {
    origin: R,
    points: Vec<HullPoint<R>>,
}

impl<R: Real> Descent<R> {
    fn least(&self, otherwise: R) -> R {
        self.points.last().map_or(otherwise, |point| point.feed)
    }

    /// Follows the limit from the far end of a stretch to the near one as far as it falls.
    fn descend(&mut self, near: (R, R), far: (R, R)) {
        let local = |(distance, feed): (R, R)| ((distance - self.origin).abs(), feed);
        let (near, far) = (local(near), local(far));
        if self.points.is_empty() || far.1 < self.least(far.1) {
            self.push(far.0, far.1);
        }
        let least = self.least(far.1);
        if near.1 < least {
            self.push(distance_at_feed(near, far, least), least);
            self.push(near.0, near.1);
        }
    }

    /// Passes a point; the hull jumps down if the limit there holds at the point alone.
    fn pass(&mut self, limit: &FeedLimit<R>, point: usize) {
        let Some(single) = limit.samples().get(point).filter(|sample| sample.is_single) else { return };
        let distance = (single.point.distance - self.origin).abs();
        match self.points.last().map(|last| last.feed) {
            Some(least) if single.lower < least => {
                self.push(distance, least);
                self.push(distance, single.lower);
            }
            // At the peak itself, the limit on the side of the flank counts.
            _ => {}
        }
    }

    fn push(&mut self, distance: R, feed: R) {
        let slope = |next: &HullPoint<R>| {
            let rise = (next.feed - feed) * (next.feed + feed);
            if rise > R::zero() { (next.distance - distance) / rise } else { R::zero() }
        };
        let distance_per_square = self.points.last().map_or_else(R::zero, slope);
        self.points.push(HullPoint { distance, feed, distance_per_square });
    }
}

#[cfg(test)]
mod tests {
    use nurbs_core::NurbsBuf;

    use crate::plan::promises::kept;
    use crate::test_paths::{in_periods, limit_through, paper_limits};
    use crate::{EndFeeds, FeedLimit, ProfileKind, jerk_free_duration, plan_with};

    /// A path that begins in a tight bend: its limit is below 2⁻⁸ of the feedrate over more than the first ramp, and the plan crept
    /// to the other end at that feed.
    #[test]
    fn a_path_that_begins_in_a_tight_bend_is_not_crept_along() {
        for (y, feedrate) in
            [(0.5, 10.0), (0.5, 100.0), (0.5, 1000.0), (2.236, 400.0), (2.236, 410.0), (0.05, 100.0)]
        {
            let forwards = vec![[0.0, 0.0], [0.0, y], [200.0, y]];
            let backwards = forwards.iter().rev().copied().collect();
            for points in [forwards, backwards] {
                let knots = vec![0.0, 0.0, 0.0, 1.0, 1.0, 1.0];
                let curve = NurbsBuf::try_new_nonrational(2, points, knots).unwrap();
                let limits = in_periods(4e-3, feedrate, 5000.0, 4e5, 1e-4);
                let limit = FeedLimit::along(&[curve.as_curve()], &limits).unwrap();
                for kind in ProfileKind::ALL {
                    let plan = plan_with(&limit, &limits, EndFeeds::default(), kind).unwrap();
                    let (duration, bound) = (
                        plan.as_schedule().duration(),
                        jerk_free_duration(&limit, &limits, EndFeeds::default()),
                    );
                    assert!(
                        duration < 1.25 * bound + 30.0,
                        "{y} {feedrate} {kind:?}: {duration} for {bound}"
                    );
                }
            }
        }
    }

    /// The lowest level lay at 1/256 of the feed: up to where its ramp had room, the plan crept at the slow point's feed, and took
    /// twenty times as long.
    #[test]
    fn a_very_slow_point_is_left_as_the_limit_rises() {
        // V doubles where the distance does so 1.5 times, as beside a bend whose radius the axes' jerk limits.
        let side = |i: i32| (10.0 * 2.0_f64.powf(-1.5 * f64::from(i)), 0.6 * 0.5_f64.powi(i));
        let rising: Vec<_> = (0..20).map(side).collect();
        let falling = rising.iter().map(|&(away, feedrate)| (10.0 - away, feedrate));
        let points: Vec<_> =
            falling.chain(rising.iter().rev().map(|(away, feed)| (10.0 + away, *feed))).collect();
        let limit = limit_through(&points);
        let bound = jerk_free_duration(&limit, &paper_limits(), EndFeeds::default());
        for kind in ProfileKind::ALL {
            let plan = kept(&limit, &paper_limits(), kind);
            let over = plan.as_schedule().duration() / bound;
            assert!(over < 1.3, "{kind:?}: {over}");
        }
    }
}
