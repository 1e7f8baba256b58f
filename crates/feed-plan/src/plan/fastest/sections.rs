//! A fastest plan, section by section.

use alloc::vec::Vec;

use real::Real;

use crate::plan::fastest::fastest::{Most, section};
use crate::plan::fastest::fit::{Fit, Piece, rounding};
use crate::plan::fastest::motion::State;
use crate::{FeedLimit, KinematicLimits, Stage, StageShape};

/// A section that would have to be stretched by more than 2⁻⁶ is one of S-curves.
const MOST_STRETCHED: i32 = -6;
/// One that has to be by more than 2⁻⁹ is compared with S-curves.
const CLOSE: i32 = -9;
/// A section that begins in motion is planned with a feed there that is lower by 2⁻¹⁰: the stretch lowers it further, and what goes
/// before it does not change.
const LOWER: i32 = -10;

/// Stages of a section, and whether they are hardly slower than what they were made of.
pub(crate) struct Quick<R> {
    pub(crate) stages: Vec<Stage<R>>,
    pub(crate) is_close: bool,
}

/// The stages between two points of the limit, with these feeds there, along the fastest profile; `None` where none is found.
pub(crate) fn quickly<R: Real>(
    limit: &FeedLimit<R>,
    limits: &KinematicLimits<R>,
    [first, last]: [usize; 2],
    feeds: [R; 2],
) -> Option<Quick<R>> {
    let left = limit.allowance(first, last);
    let most = Most {
        acceleration: limits.acceleration.min(left.acceleration),
        jerk: limits.jerk.min(left.jerk),
        period: limits.interpolation_period,
    };
    let begin = limit.samples().get(first)?.point.distance;
    let lead = if feeds[0] > R::zero() { lead_in(feeds[0], &most) } else { R::zero() };
    let planned = [feeds[0] - feeds[0].ldexp(LOWER), feeds[1]];
    let Fit { pieces, stretch, .. } = section(limit, [first, last], begin + lead, planned, &most)?;
    let slower = R::one() + stretch + rounding();
    let mut stages = Vec::with_capacity(pieces.len() + 2);
    if feeds[0] > R::zero() {
        let to = pieces.first()?.from.v / slower;
        // It was planned to be stretched by as much at most.
        if !(to >= feeds[0] - feeds[0].ldexp(LOWER + 1)) {
            return None;
        }
        stages.extend(leading(begin, lead, [feeds[0], to]));
    } else if !(stretch <= R::one().ldexp(MOST_STRETCHED)) {
        return None;
    }
    for piece in &pieces {
        for part in monotone(piece).into_iter().flatten() {
            stages.push(stage(&part, slower));
        }
    }
    Some(Quick { stages, is_close: stretch <= R::one().ldexp(CLOSE) })
}

/// The way in which a feed falls by 2⁻⁹ of itself at most, within half of J: two pieces of the time τ with `ΔV = J τ²/2`.
fn lead_in<R: Real>(feed: R, most: &Most<R>) -> R {
    let fall = feed.ldexp(LOWER + 1);
    let time = (fall.ldexp(1) / most.jerk).sqrt().max(fall.ldexp(1) / most.acceleration);
    (feed * time).ldexp(1)
}

/// Two stages over a length, without acceleration at their ends.
fn leading<R: Real>(begin: R, length: R, [from, to]: [R; 2]) -> [Stage<R>; 2] {
    let duration = length / (from + to);
    let middle = (from + to).half();
    let sixth = (from - to) * duration * R::from_ratio(1, 6);
    // Over the first half the feed is higher than its mean by a sixth of what it falls by.
    let first = (from + middle).half() * duration + sixth.half();
    let half = |start: R, length: R, start_feed: R, end_feed: R, shape| Stage {
        start,
        length,
        start_feed,
        end_feed,
        duration,
        shape,
        curve_start: 0,
        u_start: R::zero(),
        curve_end: 0,
        u_end: R::zero(),
    };
    [
        half(begin, first, from, middle, StageShape::Onset),
        half(begin + first, length - first, middle, to, StageShape::Easing),
    ]
}

/// A piece, or its parts before and behind the instant at which its acceleration is zero.
fn monotone<R: Real>(piece: &Piece<R>) -> [Option<Piece<R>>; 2] {
    let Some(time) = piece.turn() else { return [Some(*piece), None] };
    let middle = State { a: R::zero(), ..piece.from.after(time, piece.jerk()) };
    let before = Piece { from: piece.from, to: middle, time };
    [Some(before), Some(Piece { from: middle, to: piece.to, time: piece.time - time })]
}

/// A piece as a stage, its time longer by this factor.
fn stage<R: Real>(piece: &Piece<R>, slower: R) -> Stage<R> {
    let (a, b) = (piece.from.a, piece.to.a);
    let shape = if a.is_zero() && b.is_zero() || a == b {
        StageShape::Steady
    } else if a.is_zero() {
        StageShape::Onset
    } else if b.is_zero() {
        StageShape::Easing
    } else {
        StageShape::Bent(((a - b) / (a + b)).max(R::zero() - R::one()).min(R::one()))
    };
    let duration = piece.time * slower;
    let (start_feed, end_feed) = (piece.from.v / slower, piece.to.v / slower);
    Stage {
        start: piece.from.s,
        length: piece.to.s - piece.from.s,
        start_feed,
        end_feed,
        duration,
        shape,
        curve_start: 0,
        u_start: R::zero(),
        curve_end: 0,
        u_end: R::zero(),
    }
}
