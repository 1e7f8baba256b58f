//! The profile below a jerk-free one, as states along it.

use alloc::vec::Vec;

use real::Real;

use crate::plan::fastest::caps::caps;
use crate::plan::fastest::contacts::{Cap, Profile};
use crate::plan::fastest::fit::{Bounds, Point, time_between};
use crate::plan::fastest::grid::Node;
use crate::plan::fastest::motion::State;
use crate::plan::fastest::touches::{Cells, bends};
use crate::plan::fastest::valleys::{Carrier, valleys};

/// States on a cap that the motion may pass.
const ON_CAP: i32 = 8;
/// A state hardly has an acceleration that is less than 2⁻⁴ of the limit.
const HARDLY_ANY: i32 = -4;

/// The states along the profile between the first and the last node, the first with the
/// acceleration `start`, the last without.
pub(crate) fn states<R: Real>(nodes: &[Node<R>], start: R, bounds: &Bounds<R>) -> Vec<State<R>> {
    let (acceleration, jerk, gap) = (bounds.acceleration, bounds.jerk, bounds.gap());
    let cells = Cells::new(nodes);
    let bends =
        bends(nodes, &cells, &caps(nodes.len(), |k| (nodes[k].s, nodes[k].free), jerk), acceleration, jerk);
    let carriers = valleys(nodes, &cells, bends, start, [acceleration, jerk]);
    drop(cells);
    let contacts = caps(nodes.len(), |k| (nodes[k].s, carriers[k].v), jerk);
    let profile = Profile { nodes, carriers, jerk };
    let mut states: Vec<State<R>> = Vec::with_capacity(nodes.len());
    states.push(profile.state(0));
    let mut fixed = 1;
    for pair in contacts.windows(2) {
        let (from, to) = (pair[0].node, pair[1].node);
        let (here, there) = (&profile.carriers[from], &profile.carriers[to]);
        let falls = there.a - here.a < R::zero() - jerk * pair[1].time * R::from_ratio(7, 10)
            || falls_by(here, there, pair[1].time) > jerk + jerk.ldexp(-6);
        let cap = if to > from + 1 || falls { profile.cap([from, to], pair[1].time) } else { None };
        if let Some(cap) = cap {
            add_cap(&mut states, &mut fixed, &cap, bounds);
        }
        // A cap may end before the node.
        let state = profile.state(to);
        if states.last().is_none_or(|last| state.s > last.s + gap * last.v) {
            states.push(state);
        }
    }
    let end = profile.state(nodes.len() - 1);
    while states.len() > 1 && states.last().is_some_and(|last| last.s >= end.s) {
        states.pop();
    }
    states.push(end);
    states
}

/// The most by which the acceleration falls in a unit of time between two nodes, if it changes evenly over each half of the way.
fn falls_by<R: Real>(from: &Carrier<R>, to: &Carrier<R>, time: R) -> R {
    if !(time > R::zero()) {
        return R::zero();
    }
    let middle = ((to.v - from.v) / time).ldexp(1) - (from.a + to.a).half();
    (from.a - middle).max(middle - to.a) / time.half()
}

/// Puts a cap behind the states that are before it, and not too near to its begin. Where it begins before the cap in front of it has
/// ended, there is no tangent between them, and the states nearest to both are left out.
fn add_cap<R: Real>(states: &mut Vec<State<R>>, fixed: &mut usize, cap: &Cap<R>, bounds: &Bounds<R>) {
    let near = cap.from.s - bounds.gap() * cap.from.v;
    while states.len() > *fixed && states.last().is_some_and(|last| last.s > near) {
        states.pop();
    }
    let overlaps = states.last().is_some_and(|last| last.s >= cap.from.s);
    while overlaps && states.len() > 1 && states.last().is_some_and(|last| last.s >= cap.from.s) {
        states.pop();
    }
    let part = cap.time * R::from_ratio(1, ON_CAP);
    for k in 0..=ON_CAP {
        let state = cap.from.after(part * R::from_ratio(k, 1), R::zero() - bounds.jerk);
        if states.last().is_none_or(|last| state.s > last.s) {
            states.push(state);
        }
    }
    *fixed = states.len();
}

/// The states with their times, and the limit points before them from `cell` on: those that are further apart than the shortest arc,
/// and without acceleration where it is that for less, or hardly has any. The first and the last stay.
pub(crate) fn timed<R: Real>(
    mut states: Vec<State<R>>,
    mut cell: usize,
    bounds: &Bounds<R>,
) -> Option<Vec<Point<R>>> {
    let mut points: Vec<Point<R>> = Vec::with_capacity(states.len());
    let gap = bounds.gap();
    let level = (gap * bounds.jerk).min(bounds.acceleration.ldexp(HARDLY_ANY));
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
