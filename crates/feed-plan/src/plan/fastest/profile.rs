//! The profile below a jerk-free one, as states along it.

use alloc::vec::Vec;

use real::Real;

use crate::plan::fastest::caps::caps;
use crate::plan::fastest::contacts::{Cap, Profile};
use crate::plan::fastest::fit::{Bounds, Point, time_between};
use crate::plan::fastest::grid::Node;
use crate::plan::fastest::motion::State;
use crate::plan::fastest::touches::{Cells, bends};
use crate::plan::fastest::valleys::valleys;

/// States on a cap that the motion may pass.
const ON_CAP: i32 = 8;

/// The states along the profile between the first and the last node, the first with the
/// acceleration `start`, the last without.
pub(crate) fn states<R: Real>(nodes: &[Node<R>], start: R, acceleration: R, jerk: R) -> Vec<State<R>> {
    let places: Vec<R> = nodes.iter().map(|node| node.s).collect();
    let feeds: Vec<R> = nodes.iter().map(|node| node.free).collect();
    let cells = Cells::new(nodes.len(), |k| (places[k], feeds[k]));
    let contacts = caps(nodes.len(), |k| (places[k], feeds[k]), jerk);
    let mut bends = bends(&feeds, &cells, &contacts, acceleration, jerk);
    let carriers = valleys(&places, &feeds, &mut bends, start, [acceleration, jerk]);
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
    states
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

/// The states with their times, and the limit points before them from `cell` on: those that are further apart than the shortest arc,
/// and without acceleration where it is that for less. The first and the last stay.
pub(crate) fn timed<R: Real>(
    mut states: Vec<State<R>>,
    mut cell: usize,
    bounds: &Bounds<R>,
) -> Option<Vec<Point<R>>> {
    let mut points: Vec<Point<R>> = Vec::with_capacity(states.len());
    let (gap, level) = (bounds.shortest.ldexp(1), (bounds.shortest * bounds.jerk).ldexp(1));
    let squares = &bounds.squares;
    let last = states.len().checked_sub(1)?;
    for (k, state) in states.iter_mut().enumerate() {
        if k > 0 && k < last && state.a.abs() < level {
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
