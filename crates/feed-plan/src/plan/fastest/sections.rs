//! A section of a plan that is made window by window: other sections can go on from any joint of its stages.

use alloc::vec::Vec;

use real::Real;

use crate::plan::fastest::fastest::{Ends, Most, section};
use crate::plan::fastest::fit::{Fit, Piece, rounding};
use crate::plan::fastest::motion::State;
use crate::{FeedLimit, KinematicLimits, Stage, StageShape};

/// What begins in motion is stretched by as much as what goes before it, so the states of both are the same: by what all but the worst
/// arcs need.
const IN_MOTION: i32 = -11;
/// A section that begins at rest is not stretched by more than 2⁻⁶.
const MOST_STRETCHED: i32 = -6;

/// The stages between two points of the limit, with these feeds there, along the fastest profile, and with the acceleration `start`
/// at the begin; `None` where none is found.
pub(crate) fn in_window<R: Real>(
    limit: &FeedLimit<R>,
    limits: &KinematicLimits<R>,
    points: [usize; 2],
    feeds: [R; 2],
    start: R,
) -> Option<Vec<Stage<R>>> {
    let left = limit.allowance(points[0], points[1]);
    let most = Most {
        acceleration: limits.acceleration.min(left.acceleration),
        jerk: limits.jerk.min(left.jerk),
        period: limits.interpolation_period,
    };
    let in_motion = R::one() + R::one().ldexp(IN_MOTION) + rounding();
    let ends = Ends { points, feeds: [feeds[0] * in_motion, feeds[1]], start: start * in_motion * in_motion };
    let Fit { pieces, stretch, .. } = section(limit, &ends, &most)?;
    let stretched = R::one() + stretch + rounding();
    let begins_in_motion = feeds[0] > R::zero();
    if stretch > R::one().ldexp(MOST_STRETCHED) || (begins_in_motion && stretched > in_motion) {
        return None;
    }
    let slower = stretched.max(in_motion);
    let parts = pieces.iter().flat_map(|piece| monotone(piece).into_iter().flatten());
    Some(parts.map(|part| stage(&part).slowed(slower)).collect())
}

/// A piece, or its parts before and behind the instant at which its acceleration is zero.
pub(crate) fn monotone<R: Real>(piece: &Piece<R>) -> [Option<Piece<R>>; 2] {
    let Some(time) = piece.turn() else { return [Some(*piece), None] };
    let middle = State { a: R::zero(), ..piece.from.after(time, piece.jerk()) };
    let before = Piece { from: piece.from, to: middle, time };
    [Some(before), Some(Piece { from: middle, to: piece.to, time: piece.time - time })]
}

/// A piece as a stage.
pub(crate) fn stage<R: Real>(piece: &Piece<R>) -> Stage<R> {
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
    Stage {
        start: piece.from.s,
        length: piece.to.s - piece.from.s,
        start_feed: piece.from.v,
        end_feed: piece.to.v,
        duration: piece.time,
        shape,
        curve_start: 0,
        u_start: R::zero(),
        curve_end: 0,
        u_end: R::zero(),
    }
}
