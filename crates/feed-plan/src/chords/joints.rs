//! The joints between the parts of a path, and by how much the feed is lowered at each.
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

use crate::chords::parts::Part;
use crate::chords::stretch::Lowered;

/// Sweeps back and forth. Most plans take two; an excess that is left after sixteen is cut.
const SWEEPS: usize = 16;

/// The place where two parts meet, where the first begins, or where the last ends.
#[derive(Clone, Copy)]
pub(super) struct Joint<R> {
    /// The feed is lowered by this much there.
    pub(super) correction: R,
    /// The largest correction: half of the feed.
    pub(super) most: R,
    /// The share of the time of the parts beside it for which the correction counts: half of it where they are symmetric.
    pub(super) time: R,
    /// Whether the correction is that of final stages.
    is_fixed: bool,
}

impl<R: Real> Joint<R> {
    pub(super) fn is_free(&self) -> bool {
        !self.is_fixed && self.time > R::zero()
    }
}

/// The joints, each with the length that its parts give it, divided by its time. Behind final stages the first joint is fixed, and
/// so is the second if the feed is changing there.
pub(super) fn joints<R: Real>(parts: &[Part<R>], begin: Option<Lowered<R>>) -> Vec<Joint<R>> {
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
pub(super) fn level<R: Real>(joints: &mut [Joint<R>], parts: &[Part<R>]) {
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
pub(super) fn cut<R: Real>(joints: &mut [Joint<R>], parts: &[Part<R>]) {
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
