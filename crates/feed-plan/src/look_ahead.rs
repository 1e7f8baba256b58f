//! The look-ahead: from a feed limit to a schedule.
//!
//! 1. *Key points*: the two ends, and every local minimum of the limit, stops among them.
//! 2. *Passes*: a key point whose feed cannot be reached from the one before, or from which one cannot brake for the
//!    next, is no key point; the plan will pass it below its limit. One walk along the keys does both: a key too fast for
//!    its predecessor is dropped, and a key too slow for its predecessor drops that, and looks at the one before.
//! 3. *Between two keys*: the highest cruising feed for which the rising flank ends before the falling one starts.
//! 4. *Whole periods*: the plan is stretched in time, by less than one period, to a whole number of them.
//!
//! Source: the passes are those of Wang H. et al., section 2; the transitions those of Wang Y. et al., whose own
//! procedure lets neighbouring transitions overlap and start too late to stay under a limit that already falls.

use alloc::vec::Vec;

use real::Real;

use crate::flank::{Arrival, Direction, Flank, RampShape};
use crate::{CubicProfile, FeedLimit, KinematicLimits, PlanError, ScheduleBuf, Stage};

/// Minima less deep than 2⁻⁸ of the limit are no key points: a constant limit, sampled, is full of them. The plan
/// still respects them.
const SIGNIFICANT: i32 = -8;
/// Halvings of the range of cruising feeds until one is found that can be reached, and then to refine it.
const CRUISE_HALVINGS: usize = 40;
/// The cruising feed is within 2⁻¹⁴ of the highest possible.
const CRUISE_REFINEMENTS: usize = 14;

/// Feeds at the two ends of the path; at rest by default.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct EndFeeds<R> {
    /// Feed at the start.
    pub start: R,
    /// Feed at the end.
    pub end: R,
}

/// A schedule along the path: under the limit everywhere, within acceleration and jerk, as fast as a chain of cubic
/// transitions between a few levels of feed is.
///
/// The feed is continuous and so is the acceleration, which is zero at both ends of each stage. The whole takes a whole number of
/// interpolation periods: it is slowed down evenly by the part of a period that it takes to get there, so the end
/// feeds are a little below those asked for, unless at rest.
///
/// Units: those of `limits`, which must be those that `limit` was made with. Of the limits, only acceleration, jerk and
/// interpolation period are used here; the others are in the limit curve.
/// Accuracy: in f64 the plan keeps its limits to rounding, 10⁻¹² relative; in other formats to a few units of their
/// resolution in each quantity.
///
/// # Errors
/// [`PlanError::NotPositive`] and [`PlanError::Negative`] for limits and end feeds that are none;
/// [`PlanError::StartFeedTooHigh`] and [`PlanError::EndFeedTooHigh`] for end feeds that the limit or the acceleration do not
/// allow; [`PlanError::CannotMove`] where the limit is zero over a stretch, or too low for the format;
/// [`PlanError::DurationOverflows`] when the periods cannot be counted.
pub fn plan<R: Real>(
    limit: &FeedLimit<R>,
    limits: &KinematicLimits<R>,
    ends: EndFeeds<R>,
) -> Result<ScheduleBuf<R>, PlanError> {
    limits.validate()?;
    let shape = RampShape::new(limits);
    let keys = reachable(limit, &shape, &key_points(limit, ends)?)?;
    let mut stages = Stages { limit, stages: Vec::new() };
    for pair in keys.windows(2) {
        if let [from, to] = pair {
            between(limit, &shape, from, to, &mut stages)?;
        }
    }
    let mut stages = stages.with_parameters();
    let periods = stretch(&mut stages, limits.interpolation_period)?;
    Ok(ScheduleBuf { stages, interpolation_period: limits.interpolation_period, periods })
}

/// A limit point that the plan passes with zero acceleration.
#[derive(Clone, Copy, Debug)]
struct Key<R> {
    point: usize,
    distance: R,
    feed: R,
    /// The limit points between which the feed is highest on the way from the key before.
    summit: (usize, usize),
}

/// The ends and the significant minima of the limit.
fn key_points<R: Real>(limit: &FeedLimit<R>, ends: EndFeeds<R>) -> Result<Vec<Key<R>>, PlanError> {
    let (points, nodes) = (limit.points(), limit.nodes());
    let last = nodes.len().saturating_sub(1);
    let key = |point: usize, feed: R| {
        let distance = points.get(point).map_or_else(R::zero, |p| p.distance);
        Key { point, distance, feed, summit: (point, point) }
    };
    let start = end_feed(limit, 0, ("start feed", ends.start), PlanError::StartFeedTooHigh)?;
    let mut keys = Vec::from([key(0, start)]);
    let (mut is_falling, mut extreme) = (true, 0);
    for (i, node) in nodes.iter().enumerate() {
        let Some(reference) = nodes.get(extreme).map(|node| node.lower) else { break };
        let significance = reference.scale(SIGNIFICANT);
        let is_beyond = if is_falling { node.lower < reference } else { node.lower > reference };
        if is_beyond {
            extreme = i;
        } else if is_falling && node.lower > reference + significance + significance {
            if extreme > 0 {
                keys.push(key(extreme, reference));
            }
            (is_falling, extreme) = (false, i);
        } else if !is_falling && node.lower < reference - significance {
            (is_falling, extreme) = (true, i);
        }
    }
    if is_falling && extreme > 0 && extreme < last {
        keys.extend(nodes.get(extreme).map(|node| key(extreme, node.lower)));
    }
    let end = end_feed(limit, last, ("end feed", ends.end), PlanError::EndFeedTooHigh)?;
    keys.push(key(last, end));
    Ok(keys)
}

/// A feed asked for at an end of the path, as far as the planner's lower limit allows.
fn end_feed<R: Real>(
    limit: &FeedLimit<R>,
    point: usize,
    (what, feed): (&'static str, R),
    too_high: PlanError,
) -> Result<R, PlanError> {
    let (Some(at), Some(node)) = (limit.points().get(point), limit.nodes().get(point)) else {
        return Err(PlanError::PathEmpty);
    };
    if !(feed >= R::zero()) {
        return Err(PlanError::Negative { what });
    }
    if feed > at.feedrate { Err(too_high) } else { Ok(feed.min(node.lower)) }
}

/// The keys that can be reached from each other, in order.
fn reachable<R: Real>(
    limit: &FeedLimit<R>,
    shape: &RampShape<R>,
    keys: &[Key<R>],
) -> Result<Vec<Key<R>>, PlanError> {
    let mut kept: Vec<Key<R>> = Vec::with_capacity(keys.len());
    // Keys dropped as too fast lie on the rising side of the next summit: it begins at the last of them.
    let mut summit_from = 0;
    for (index, key) in keys.iter().enumerate() {
        let mut key = Key { summit: (summit_from, key.point), ..*key };
        summit_from = key.point;
        let mut is_kept = true;
        while let Some(previous) = kept.last() {
            let (from, to) = ((previous.distance, previous.feed), (key.distance, key.feed));
            let is_rising = from.1 <= to.1;
            let (slow, fast) = if is_rising { (from, to) } else { (to, from) };
            if shape.fits(limit, slow, fast) {
                break;
            }
            if is_rising {
                is_kept = false; // Too fast to be reached from there.
                break;
            }
            // Too fast to brake from: what was the way there becomes part of the way here.
            key.summit = previous.summit;
            kept.pop();
            if kept.is_empty() {
                return Err(PlanError::StartFeedTooHigh);
            }
        }
        if is_kept {
            kept.push(key);
        } else if index + 1 == keys.len() {
            return Err(PlanError::EndFeedTooHigh);
        }
    }
    Ok(kept)
}

/// The way from one key to the next: a rising flank, a cruise, a falling flank.
fn between<R: Real>(
    limit: &FeedLimit<R>,
    shape: &RampShape<R>,
    from: &Key<R>,
    to: &Key<R>,
    stages: &mut Stages<'_, R>,
) -> Result<(), PlanError> {
    let room = to.distance - from.distance;
    if !(room > R::zero()) {
        return Ok(());
    }
    let peak = summit(limit, from, to);
    let rising = Flank::new(shape, limit, Direction::Rising, (from.point, from.feed), peak);
    let falling = Flank::new(shape, limit, Direction::Falling, (to.point, to.feed), peak);
    let (up, down) = cruise(&rising, &falling, room).ok_or(PlanError::CannotMove { index: from.point })?;

    let mut at = R::zero();
    for ramp in rising.chain(&up) {
        let profile = shape.ramp(ramp.low, ramp.high);
        stages.constant(from.distance + at, ramp.start - at, ramp.low);
        stages.push(from.distance + ramp.start, &profile, ramp.low, ramp.high);
        at = ramp.start + profile.length();
    }
    let mut chain = falling.chain(&down);
    let cruise_length = room - up.distance - down.distance;
    stages.constant(from.distance + at, cruise_length, up.feed);
    while let Some(ramp) = chain.pop() {
        let profile = shape.ramp(ramp.high, ramp.low);
        stages.push(to.distance - ramp.start - profile.length(), &profile, ramp.high, ramp.low);
        let slower_until =
            chain.last().map_or_else(R::zero, |next| next.start + shape.ramp(next.low, next.high).length());
        stages.constant(to.distance - ramp.start, ramp.start - slower_until, ramp.low);
    }
    Ok(())
}

/// The limit point at which the limit is highest on the summit between two keys.
fn summit<R: Real>(limit: &FeedLimit<R>, from: &Key<R>, to: &Key<R>) -> usize {
    let height = |point: usize, node: &crate::feed_limit::Node<R>| {
        if point == from.point {
            node.after
        } else if point == to.point {
            node.before
        } else {
            node.lower
        }
    };
    let (begin, end) = to.summit;
    let candidates = limit.nodes().iter().enumerate().take(end + 1).skip(begin);
    let highest =
        candidates.map(|(i, node)| (i, height(i, node))).reduce(|a, b| if b.1 > a.1 { b } else { a });
    highest.map_or(begin, |(i, _)| i)
}

/// The highest cruising feed that both flanks reach within the room between them.
fn cruise<R: Real>(
    rising: &Flank<'_, R>,
    falling: &Flank<'_, R>,
    room: R,
) -> Option<(Arrival<R>, Arrival<R>)> {
    // Room for the rounding of distances, so that a transition that just fits still does.
    let rounding = (room + R::one()) * R::resolution().scale(2);
    let attempt = |feed: R| {
        let (up, down) = (rising.arrival(feed)?, falling.arrival(feed)?);
        let fits = feed > R::zero() && up.distance + down.distance <= room + rounding;
        fits.then_some((up, down))
    };
    let floor = rising.base().max(falling.base());
    let height = rising.top().min(falling.top()) - floor;
    let mut best = attempt(floor);
    if !(height > R::zero()) {
        return best;
    }
    let mut share = R::one();
    for halving in 0..CRUISE_HALVINGS {
        if let Some(found) = attempt(floor + height * share) {
            best = Some(found);
            if halving == 0 {
                return best;
            }
            break;
        }
        share = share.half();
    }
    // Found at `share`, not at twice that.
    let (mut low, mut high) = (floor + height * share, floor + height * (share + share));
    for _ in 0..CRUISE_REFINEMENTS {
        let middle = low + (high - low).half();
        match attempt(middle) {
            Some(found) => (best, low) = (Some(found), middle),
            None => high = middle,
        }
    }
    best
}

/// The stages as they are put together.
struct Stages<'l, R> {
    limit: &'l FeedLimit<R>,
    stages: Vec<Stage<R>>,
}

impl<R: Real> Stages<'_, R> {
    /// A stretch of constant feed, joined to the last stage if that is at the same; nothing if it has no length.
    fn constant(&mut self, start: R, length: R, feed: R) {
        if !(length > R::zero() && feed > R::zero()) {
            return;
        }
        let duration = length / feed;
        match self.stages.last_mut() {
            Some(last) if last.start_feed == feed && last.end_feed == feed => {
                last.length = last.length + length;
                last.duration = last.duration + duration;
            }
            _ => self.push(start, &CubicProfile::lasting(feed, feed, duration), feed, feed),
        }
    }

    fn push(&mut self, start: R, profile: &CubicProfile<R>, start_feed: R, end_feed: R) {
        let (length, duration) = (profile.length(), profile.duration());
        let (curve, u) = (0, R::zero());
        self.stages.push(Stage {
            start,
            length,
            start_feed,
            end_feed,
            duration,
            curve_start: curve,
            u_start: u,
            curve_end: curve,
            u_end: u,
        });
    }

    /// The finished stages, with the parameters that they start and end at.
    fn with_parameters(mut self) -> Vec<Stage<R>> {
        for stage in &mut self.stages {
            (stage.curve_start, stage.u_start) = self.limit.parameter_at(stage.start);
            (stage.curve_end, stage.u_end) = self.limit.parameter_at(stage.start + stage.length);
        }
        self.stages
    }
}

/// Slows the stages down evenly so that together they take a whole number of periods, which is returned.
fn stretch<R: Real>(stages: &mut [Stage<R>], period: R) -> Result<u32, PlanError> {
    let duration = stages.iter().fold(R::zero(), |sum, stage| sum + stage.duration);
    let in_order = stages.iter().all(|stage| stage.duration > R::zero() && stage.duration <= duration);
    let (periods, rounded) =
        round_up(duration / period).filter(|_| in_order).ok_or(PlanError::DurationOverflows)?;
    let factor = rounded * period / duration;
    for stage in stages {
        stage.duration = stage.duration * factor;
        stage.start_feed = stage.start_feed / factor;
        stage.end_feed = stage.end_feed / factor;
    }
    Ok(periods)
}

/// The least whole number not below `value`, as an integer and as a number; `None` beyond what either can hold.
fn round_up<R: Real>(value: R) -> Option<(u32, R)> {
    if !(value > R::zero() && value < R::max_value().half()) {
        return None;
    }
    let mut power = R::one();
    let mut bit = 1_u32;
    while power <= value {
        bit = bit.checked_mul(2)?;
        power = power + power;
    }
    let (mut count, mut whole) = (0_u32, R::zero());
    while bit > 0 {
        if whole + power <= value {
            whole = whole + power;
            count += bit;
        }
        power = power.half();
        bit /= 2;
    }
    if whole < value { Some((count.checked_add(1)?, whole + R::one())) } else { Some((count, whole)) }
}
