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
//! | `fit` | few pieces of constant jerk along it |
//!
//! What the pieces are above a limit, at most 2⁻¹³ or so, an even stretch of time takes back. Where the search fails, the
//! section is one of S-curves.

use alloc::vec::Vec;

use real::Real;

use crate::plan::fastest::caps::caps;
use crate::plan::fastest::contacts::{Cap, Profile};
use crate::plan::fastest::fit::{Bounds, Fit, Point, fit, shortest, time_between};
use crate::plan::fastest::grid::{Node, limit_points, nodes, scan};
use crate::plan::fastest::motion::State;
use crate::plan::fastest::touches::{Cells, bends};
use crate::plan::fastest::valleys::valleys;

/// Nodes per time A/J near corners.
const NODES: i32 = 8;
/// States on a cap that the motion may pass.
const ON_CAP: i32 = 8;
/// Profiles a little lower that are tried where one was hard to follow.
const AGAIN: usize = 3;

/// Largest acceleration and jerk along the path, and the interpolation period.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Most<R> {
    pub(crate) acceleration: R,
    pub(crate) jerk: R,
    pub(crate) period: R,
}

/// The pieces between two points of a limit, from the distance `begin` behind the first of them on, with these feeds at their ends
/// and no acceleration; `None` where none are found.
pub(crate) fn section<R: Real>(
    limit: &crate::FeedLimit<R>,
    ends: [usize; 2],
    begin: R,
    feeds: [R; 2],
    most: &Most<R>,
) -> Option<Fit<R>> {
    let mut points = limit_points(limit, ends, begin);
    let (first, last) = (*points.first()?, *points.last()?);
    if points.iter().any(|point| !(point.1 > R::zero())) || points.len() < 2 {
        return None;
    }
    // The ends are passed at their feeds; beside them the limit holds.
    points.first_mut()?.1 = feeds[0].min(first.1);
    points.last_mut()?.1 = feeds[1].min(last.1);
    let step = (most.acceleration / most.jerk / R::from_ratio(NODES, 1)).max(most.period.ldexp(-2));
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
    let mut best = fit(&profile(&nodes, most, &bounds)?, &bounds)?;
    let mut lowered = nodes.clone();
    for _ in 0..AGAIN {
        if best.worst.is_empty() {
            break;
        }
        lower(&mut lowered, &best.worst, most.acceleration);
        match profile(&lowered, most, &bounds).and_then(|points| fit(&points, &bounds)) {
            Some(other) if other.duration() < best.duration() => best = other,
            _ => break,
        }
    }
    Some(best)
}

/// Lowers the jerk-free profile where arcs along it broke a limit.
fn lower<R: Real>(nodes: &mut [Node<R>], worst: &[([R; 2], R)], acceleration: R) {
    for &([from, to], broken) in worst {
        let share = R::one() - broken;
        let first = nodes.partition_point(|node| node.s <= from).saturating_sub(1);
        let behind = nodes.partition_point(|node| node.s < to) + 1;
        for node in nodes.iter_mut().take(behind).skip(first) {
            node.free = node.free * share;
        }
    }
    let points: Vec<_> = nodes.iter().map(|node| (node.s, node.free)).collect();
    let free = scan(&points, acceleration);
    nodes.iter_mut().zip(free).for_each(|(node, free)| node.free = free);
}

/// The profile of a section, and the states along it.
fn profile<R: Real>(nodes: &[Node<R>], most: &Most<R>, bounds: &Bounds<R>) -> Option<Vec<Point<R>>> {
    let (acceleration, jerk) = (most.acceleration, most.jerk);
    let places: Vec<R> = nodes.iter().map(|node| node.s).collect();
    let feeds: Vec<R> = nodes.iter().map(|node| node.free).collect();
    let cells = Cells::new(nodes.len(), |k| (places[k], feeds[k]));
    let contacts = caps(nodes.len(), |k| (places[k], feeds[k]), jerk);
    let mut bends = bends(&feeds, &cells, &contacts, acceleration, jerk);
    let carriers = valleys(&places, &feeds, &mut bends, acceleration, jerk);
    let contacts = caps(nodes.len(), |k| (places[k], carriers[k].v), jerk);
    let profile = Profile { places, carriers, jerk };
    let mut states: Vec<State<R>> = Vec::with_capacity(nodes.len());
    states.push(profile.state(0));
    let mut fixed = 1;
    for pair in contacts.windows(2) {
        let (from, to) = (pair[0].node, pair[1].node);
        let (a0, a1) = (profile.carriers[from].a, profile.carriers[to].a);
        let falls = a1 - a0 < R::zero() - jerk * pair[1].time * R::from_ratio(7, 10);
        let behind = |states: &[State<R>], s: R| states.last().is_none_or(|last| s > last.s);
        let cap = if to > from + 1 || falls { profile.cap([from, to], pair[1].time) } else { None };
        match cap {
            Some(cap) => add_cap(&mut states, &mut fixed, &cap, jerk),
            None => {
                let state = profile.state(to);
                if behind(&states, state.s) {
                    states.push(state);
                }
            }
        }
    }
    let end = profile.state(profile.places.len() - 1);
    while states.len() > 1 && states.last().is_some_and(|last| last.s >= end.s) {
        states.pop();
    }
    states.push(end);
    points(&mut states, bounds)
}

/// Puts a cap behind the states that are before it. Where it begins before the cap in front of it has ended, there is no tangent
/// between them, and the states nearest to both are left out.
fn add_cap<R: Real>(states: &mut Vec<State<R>>, fixed: &mut usize, cap: &Cap<R>, jerk: R) {
    while states.len() > *fixed && states.last().is_some_and(|last| last.s >= cap.from.s) {
        states.pop();
    }
    let overlaps = states.last().is_some_and(|last| last.s >= cap.from.s);
    while overlaps && states.len() > 1 && states.last().is_some_and(|last| last.s >= cap.from.s) {
        states.pop();
    }
    let part = cap.time * R::from_ratio(1, ON_CAP);
    for k in 0..=ON_CAP {
        let state = cap.from.after(part * R::from_ratio(k, 1), R::zero() - jerk);
        if states.last().is_none_or(|last| state.s > last.s) {
            states.push(state);
        }
    }
    *fixed = states.len();
}

/// The states with their times and nodes: those that are further apart than the shortest arc, and without acceleration where it is
/// that for less.
fn points<R: Real>(states: &mut [State<R>], bounds: &Bounds<R>) -> Option<Vec<Point<R>>> {
    let mut points: Vec<Point<R>> = Vec::with_capacity(states.len());
    let (gap, level) = (bounds.shortest.ldexp(1), (bounds.shortest * bounds.jerk).ldexp(1));
    let (squares, mut cell) = (&bounds.squares, 0);
    let last = states.len().checked_sub(1)?;
    for (k, state) in states.iter_mut().enumerate() {
        if state.a.abs() < level {
            state.a = R::zero();
        }
        let mut time = R::zero();
        while let Some(before) = points.last() {
            let between = time_between(&before.state, state)?;
            time = before.time + between;
            if between >= gap || points.len() == 1 {
                break;
            }
            if k < last {
                time = R::max_value();
                break;
            }
            points.pop();
        }
        if !(time < R::max_value()) {
            continue;
        }
        while squares.get(cell + 1).is_some_and(|next| next.0 <= state.s) && cell + 2 < squares.len() {
            cell += 1;
        }
        points.push(Point { state: *state, time, cell });
    }
    Some(points)
}
