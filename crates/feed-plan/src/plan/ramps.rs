//! Transitions from key to key, for the profiles that are chains of them.
//!
//! 1. *Passes*: a key point whose feed cannot be reached from the one before, or from which one cannot brake
//!    for the next, is no key point; the plan will pass it below its limit. One walk along the keys does
//!    both: a key too fast for its predecessor is dropped, and a key too slow for its predecessor drops that,
//!    and looks at the one before.
//! 2. *Between two keys*: the highest cruising feed for which the rising flank ends before the falling one
//!    starts.
//!
//! Source: the passes are those of paper C (Wang Haitao et al.), section 2; the cubic transitions those of paper A
//! (Wang Yunsen et al.), whose own procedure lets neighbouring transitions overlap and start too late to stay under a
//! limit that already falls.

use alloc::vec::Vec;

use real::Real;

use crate::limit::axis_budget::Allowance;
use crate::limit::sample::LimitSample;
use crate::plan::flank::{Arrival, Direction, Flank, LEVELS, LEVELS_BETWEEN_ENDS};
use crate::plan::key_points::{Key, cannot_move};
use crate::plan::ramp_shape::RampShape;
use crate::plan::stages::Stages;
use crate::{FeedLimit, PlanError};

/// Halvings of the range of cruising feeds until one is found that can be reached, and then to refine it.
const CRUISE_HALVINGS: usize = 40;
/// The cruising feed is within 2⁻¹⁴ of the highest possible.
const CRUISE_REFINEMENTS: usize = 14;

/// Transitions from key to key.
pub(crate) fn ramps<R: Real>(
    limit: &FeedLimit<R>,
    shape: &RampShape<R>,
    keys: &[Key<R>],
    stages: &mut Stages<'_, R>,
) -> Result<(), PlanError> {
    chain(limit, shape, &reachable(limit, shape, keys)?, stages)
}

/// Transitions between keys that can be reached from each other.
pub(crate) fn chain<R: Real>(
    limit: &FeedLimit<R>,
    shape: &RampShape<R>,
    keys: &[Key<R>],
    stages: &mut Stages<'_, R>,
) -> Result<(), PlanError> {
    for pair in keys.windows(2) {
        if let [from, to] = pair {
            between(limit, &shape.within(to.allowance), from, to, stages)?;
        }
    }
    Ok(())
}

/// The keys that can be reached from each other, in order.
pub(crate) fn reachable<R: Real>(
    limit: &FeedLimit<R>,
    shape: &RampShape<R>,
    keys: &[Key<R>],
) -> Result<Vec<Key<R>>, PlanError> {
    let mut kept: Vec<Key<R>> = Vec::with_capacity(keys.len());
    // Keys dropped as too fast lie on the rising side of the next summit: it begins at the last of them.
    let mut summit_from = 0;
    // What the axes leave on the way from the last key kept.
    let mut allowance = Allowance::unlimited();
    for (index, key) in keys.iter().enumerate() {
        allowance = allowance.min(limit.allowance(summit_from, key.point));
        let mut key = Key { summit: (summit_from, key.point), allowance, ..*key };
        summit_from = key.point;
        let mut is_kept = true;
        while let Some(previous) = kept.last() {
            let is_rising = previous.feed <= key.feed;
            let shape = &shape.within(key.allowance);
            let joined = if is_rising {
                can_join(limit, shape, Direction::Rising, previous, &key)
            } else {
                can_join(limit, shape, Direction::Falling, &key, previous)
            };
            if joined {
                break;
            }
            if is_rising {
                is_kept = false; // Too fast to be reached from there.
                break;
            }
            // Too fast to brake from: what was the way there becomes part of the way here.
            key.summit = previous.summit;
            key.allowance = key.allowance.min(previous.allowance);
            kept.pop();
            if kept.is_empty() {
                return Err(PlanError::StartFeedTooHigh);
            }
        }
        if is_kept {
            kept.push(key);
            allowance = Allowance::unlimited();
        } else if index + 1 == keys.len() {
            return Err(PlanError::EndFeedTooHigh);
        }
    }
    Ok(kept)
}

/// Whether the feed of the faster of two keys can be had on the way between them: from rest by a chain of
/// ramps, else even by a single one, as close to the fast key as can be.
fn can_join<R: Real>(
    limit: &FeedLimit<R>,
    shape: &RampShape<R>,
    direction: Direction,
    slow: &Key<R>,
    fast: &Key<R>,
) -> bool {
    if !(slow.feed < fast.feed) {
        return true;
    }
    if slow.feed > R::zero() {
        return shape.fits(limit, (slow.distance, slow.feed), (fast.distance, fast.feed));
    }
    let room = (fast.distance - slow.distance).abs();
    if !(shape.ramp(slow.feed, fast.feed).length() <= room) {
        return false; // No chain is shorter.
    }
    let mut flank = Flank::new(shape, limit, direction, (slow.point, slow.feed), fast.point);
    flank.raise_to(fast.feed, LEVELS_BETWEEN_ENDS);
    flank.arrival(fast.feed).is_some_and(|arrival| arrival.distance <= room)
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
    let mut rising = Flank::new(shape, limit, Direction::Rising, (from.point, from.feed), peak);
    let mut falling = Flank::new(shape, limit, Direction::Falling, (to.point, to.feed), peak);
    for flank in [&mut rising, &mut falling] {
        flank.raise_to(from.feed.max(to.feed), LEVELS_BETWEEN_ENDS);
        flank.raise_to(flank.top(), LEVELS);
    }
    let (up, down) = cruise(&rising, &falling, room).ok_or_else(|| cannot_move(limit, from))?;

    let mut at = R::zero();
    for ramp in rising.chain(&up) {
        let profile = shape.ramp(ramp.low, ramp.high);
        stages.constant(from.distance + at, ramp.start - at, ramp.low);
        stages.transition(from.distance + ramp.start, &profile);
        at = ramp.start + profile.length();
    }
    let mut chain = falling.chain(&down);
    let cruise_length = room - up.distance - down.distance;
    stages.constant(from.distance + at, cruise_length, up.feed);
    while let Some(ramp) = chain.pop() {
        let profile = shape.ramp(ramp.high, ramp.low);
        stages.transition(to.distance - ramp.start - profile.length(), &profile);
        let slower_until =
            chain.last().map_or_else(R::zero, |next| next.start + shape.ramp(next.low, next.high).length());
        stages.constant(to.distance - ramp.start, ramp.start - slower_until, ramp.low);
    }
    Ok(())
}

/// The limit point at which the limit is highest on the summit between two keys.
fn summit<R: Real>(limit: &FeedLimit<R>, from: &Key<R>, to: &Key<R>) -> usize {
    let height = |point: usize, sample: &LimitSample<R>| {
        if point == from.point {
            sample.lower_after
        } else if point == to.point {
            sample.lower_before
        } else {
            sample.lower
        }
    };
    let (begin, end) = to.summit;
    let candidates = limit.samples().iter().enumerate().take(end + 1).skip(begin);
    let highest =
        candidates.map(|(i, sample)| (i, height(i, sample))).reduce(|a, b| if b.1 > a.1 { b } else { a });
    highest.map_or(begin, |(i, _)| i)
}

/// The highest cruising feed that both flanks reach within the room between them.
fn cruise<R: Real>(
    rising: &Flank<'_, R>,
    falling: &Flank<'_, R>,
    room: R,
) -> Option<(Arrival<R>, Arrival<R>)> {
    // Room for the rounding of distances, so that a transition that just fits still does.
    let rounding = (room + R::one()) * R::resolution().ldexp(2);
    let if_it_fits = |(up, down): (Arrival<R>, Arrival<R>)| {
        let fits = up.feed > R::zero() && up.distance + down.distance <= room + rounding;
        fits.then_some((up, down))
    };
    let attempt = |feed: R| rising.arrival(feed).zip(falling.arrival(feed)).and_then(if_it_fits);
    let floor = rising.base().max(falling.base());
    let height = rising.top().min(falling.top()) - floor;
    // The chain that loses least may arrive too late; a single ramp then does not.
    let mut best =
        attempt(floor).or_else(|| rising.direct(floor).zip(falling.direct(floor)).and_then(if_it_fits));
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

#[cfg(test)]
mod tests {
    use crate::ProfileKind;
    use crate::plan::promises::kept;
    use crate::test_paths::{limit_through, paper_limits};

    #[test]
    fn many_minima_next_to_a_stop_are_passed_over_without_a_look_at_the_way() {
        // Each is too near for its feed. With the hull of the way to each, this would take minutes.
        let count = 200_000_u32;
        let near = (0..count).map(|i| (f64::from(i) * 1e-7, if i % 2 == 0 { 0.5 } else { 0.4 }));
        let far: Vec<_> = near.clone().map(|(distance, feed)| (100.0 - distance, feed)).collect();
        let points: Vec<_> = near.chain(far.into_iter().rev()).collect();
        kept(&limit_through(&points), &paper_limits(), ProfileKind::Cubic);
    }
}
