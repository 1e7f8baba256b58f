//! A fastest plan, section by section.

use alloc::vec::Vec;

use real::Real;

use crate::plan::fastest::fastest::{Most, section};
use crate::plan::fastest::fit::{Fit, Piece, rounding};
use crate::plan::fastest::motion::State;
use crate::{FeedLimit, KinematicLimits, Stage, StageShape};

/// A section that would have to be stretched by more than 2⁻⁶ is one of S-curves.
const MOST_STRETCHED: i32 = -6;
/// What begins in motion is stretched by as much as what goes before it, so the states of both are the same: by what all but the worst
/// arcs need.
const IN_MOTION: i32 = -11;

/// The stages between two points of the limit, with these feeds there, along the fastest profile; `None` where none is found. With a
/// `start`, which is the acceleration at the begin, another section can go on from any joint.
pub(crate) fn quickly<R: Real>(
    limit: &FeedLimit<R>,
    limits: &KinematicLimits<R>,
    [first, last]: [usize; 2],
    feeds: [R; 2],
    start: Option<R>,
) -> Option<Vec<Stage<R>>> {
    let left = limit.allowance(first, last);
    let most = Most {
        acceleration: limits.acceleration.min(left.acceleration),
        jerk: limits.jerk.min(left.jerk),
        period: limits.interpolation_period,
    };
    let in_motion = R::one() + R::one().ldexp(IN_MOTION) + rounding();
    let start_feed = feeds[0] * in_motion;
    let acceleration = start.unwrap_or(R::zero()) * in_motion * in_motion;
    let Fit { pieces, stretch } = section(limit, [first, last], [start_feed, feeds[1]], acceleration, &most)?;
    let stretched = R::one() + stretch + rounding();
    let (begins_in_motion, is_window) = (feeds[0] > R::zero(), start.is_some());
    if stretch > R::one().ldexp(MOST_STRETCHED) || (begins_in_motion && stretched > in_motion) {
        return None;
    }
    let slower = if begins_in_motion || is_window { stretched.max(in_motion) } else { stretched };
    let parts = pieces.iter().flat_map(|piece| monotone(piece).into_iter().flatten());
    Some(parts.map(|part| stage(&part, slower)).collect())
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
