//! The fastest plan with limited jerk, nearly.
//!
//! From rest to rest:
//!
//! | file | step |
//! |---|---|
//! | `grid` | nodes, and the jerk-free profile: as fast as the limit and A allow |
//! | `caps` | the largest profile below whose acceleration falls by no more than J |
//! | `touches` | where sharp bends of the limit are touched, and with which acceleration |
//! | `valleys` | the jerk-free profile with arcs of jerk J through the touches |
//! | `caps` again, `contacts` | the largest profile below that, its caps exactly tangent |
//! | `profile` | all of these: the states that a motion along the largest profile passes |
//! | `fit` | few pieces of constant jerk along it |
//! | `repair` | the profile anew, a little lower, around arcs that break a limit |
//! | `parts` | the way from rest to rest cut where one plan of it does not do, and S-curves where these are faster |
//!
//! What the pieces are above a limit, at most 2⁻¹³ or so, an even stretch of time takes back.

use alloc::vec::Vec;

use real::Real;

use crate::plan::fastest::fit::{Bounds, Fit, TOLERANCE, fit, shortest};
use crate::plan::fastest::grid::{Node, limit_points, nodes};
use crate::plan::fastest::profile::{states, timed};
use crate::plan::fastest::repair::repair;

/// Nodes per time A/J near corners.
const NODES: i32 = 8;

/// Largest acceleration and jerk along the path, and the interpolation period.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Most<R> {
    pub(crate) acceleration: R,
    pub(crate) jerk: R,
    pub(crate) period: R,
}

/// The time of the jerk-free profile, whose acceleration is constant between nodes.
fn jerk_free_time<R: Real>(nodes: &[Node<R>]) -> R {
    nodes.windows(2).fold(R::zero(), |time, pair| {
        let sum = pair[0].free + pair[1].free;
        if sum > R::zero() { time + (pair[1].s - pair[0].s).ldexp(1) / sum } else { time }
    })
}

/// Two points of a limit, the feeds there, and the acceleration at the begin; there is none at the end.
pub(crate) struct Ends<R> {
    pub(crate) points: [usize; 2],
    pub(crate) feeds: [R; 2],
    pub(crate) start: R,
}

/// The pieces between two points of a limit; `None` where none are found.
pub(crate) fn section<R: Real>(
    limit: &crate::FeedLimit<R>,
    ends: &Ends<R>,
    most: &Most<R>,
) -> Option<Fit<R>> {
    let &Ends { points, feeds, start } = ends;
    let step = (most.acceleration / most.jerk / R::from_ratio(NODES, 1)).max(most.period.ldexp(-2));
    let mut points = limit_points(limit, points, [most.period, step]);
    let (first, last) = (*points.first()?, *points.last()?);
    let is_slow = feeds[0] <= first.1 + first.1.ldexp(TOLERANCE);
    if points.iter().any(|point| !(point.1 > R::zero())) || points.len() < 2 || !is_slow {
        return None;
    }
    // The ends are passed at their feeds; beside them the limit holds.
    points.first_mut()?.1 = feeds[0];
    points.last_mut()?.1 = feeds[1].min(last.1);
    let nodes = nodes(&points, [first.1, last.1], most.acceleration, step);
    // Whoever is too fast to brake, or to have got so fast, is not on the profile.
    if nodes.first()?.free < points.first()?.1 || nodes.last()?.free < points.last()?.1 {
        return None;
    }
    let fastest = nodes.iter().fold(R::zero(), |most, node| most.max(node.free));
    let shortest = shortest(fastest, most.jerk);
    let mut squares: Vec<_> = points.iter().map(|(s, v)| (*s, *v * *v)).collect();
    squares.first_mut()?.1 = first.1 * first.1;
    squares.last_mut()?.1 = last.1 * last.1;
    let bounds = Bounds { squares, acceleration: most.acceleration, jerk: most.jerk, shortest };
    let states = states(&nodes, start, &bounds);
    let arcs = fit(&timed(states, 0, &bounds)?, &bounds)?;
    Some(Fit::of(&repair(arcs, &nodes, &bounds), jerk_free_time(&nodes)))
}
