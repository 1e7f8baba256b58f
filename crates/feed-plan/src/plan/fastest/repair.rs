//! Repair: where an arc breaks a limit by more than others, the profile is made anew around it, a little lower.
//!
//! The jerk-free profile is lowered by the share by which the arc breaks a limit, and less and less beside it. What that changes
//! ends a few times A/J further on. So only the nodes around the arc are looked at, and the arcs from one joint before it to one
//! behind it are replaced, if the new ones are better.

use alloc::vec::Vec;

use real::Real;

use crate::plan::fastest::fit::{Arc, Bounds, Point, fit, worst};
use crate::plan::fastest::grid::{Node, scan};
use crate::plan::fastest::motion::State;
use crate::plan::fastest::profile::{states, timed};

/// Times A/J from the arc to the joints that stay, and from there to where the profile is begun.
const REACH: i32 = 3;
/// Arcs on each side of it, at least.
const LEAST: usize = 4;
/// Profiles that are tried.
const AGAIN: usize = 8;
/// Feeds are lowered by 2⁻⁷ at a time, at most.
const MOST: i32 = -7;

/// The arcs, the hard ones and their neighbours replaced where better ones are found.
pub(crate) fn repair<R: Real>(arcs: Vec<Arc<R>>, nodes: &[Node<R>], bounds: &Bounds<R>) -> Vec<Arc<R>> {
    let reach = bounds.acceleration / bounds.jerk * R::from_ratio(REACH, 1);
    let full = bounds.acceleration - bounds.acceleration.ldexp(-6);
    let mut done: Vec<Arc<R>> = Vec::with_capacity(arcs.len());
    let mut next = 0;
    while let Some(arc) = arcs.get(next) {
        if !arc.is_hard() {
            done.push(*arc);
            next += 1;
            continue;
        }
        // Where A is used up, a lower profile is lower as far as that lasts.
        let is_free = |point: &Point<R>| point.state.a.abs() < full;
        let begins = |other: &Arc<R>| is_free(&other.from) && arc.from.time - other.from.time >= reach;
        let ends = |other: &Arc<R>| is_free(&other.to) && other.to.time - arc.to.time >= reach;
        let before = done.len().saturating_sub(LEAST);
        let begin = done.iter().take(before + 1).rposition(begins).unwrap_or(0);
        let end = arcs.iter().skip(next + LEAST).position(ends);
        let end = end.map_or(arcs.len(), |end| next + LEAST + end + 1);
        let mut these = done.split_off(begin);
        these.extend(arcs.get(next..end).unwrap_or_default());
        done.extend(better(these, nodes, bounds, reach));
        next = end;
    }
    done
}

/// The best of some profiles between the ends of arcs.
fn better<R: Real>(arcs: Vec<Arc<R>>, nodes: &[Node<R>], bounds: &Bounds<R>, reach: R) -> Vec<Arc<R>> {
    let (Some(first), Some(last)) = (arcs.first(), arcs.last()) else { return arcs };
    let (from, to) = (first.from, last.to);
    // As far as a motion at these feeds gets, and further where it is faster.
    let fastest = arcs.iter().fold(R::zero(), |most, arc| most.max(arc.to.state.v));
    let beside = reach * fastest;
    let begin = nodes.partition_point(|node| node.s < from.state.s - beside).saturating_sub(1);
    let end = (nodes.partition_point(|node| node.s <= to.state.s + beside) + 1).min(nodes.len());
    let start = if begin == 0 { from.state.a } else { R::zero() };
    let mut nodes = nodes.get(begin..end).unwrap_or_default().to_vec();
    let mut best = arcs;
    let mut latest = best.clone();
    for _ in 0..AGAIN {
        if !latest.iter().any(Arc::is_hard) {
            break;
        }
        latest.iter().filter(|arc| arc.is_hard()).for_each(|arc| lower(&mut nodes, arc));
        let jerk_free: Vec<_> = nodes.iter().map(|node| (node.s, node.free)).collect();
        let jerk_free = scan(&jerk_free, bounds.acceleration);
        nodes.iter_mut().zip(jerk_free).for_each(|(node, free)| node.free = free);
        let inside = |state: &State<R>| state.s > from.state.s && state.s < to.state.s;
        let mut along = Vec::from([from.state]);
        along.extend(states(&nodes, start, bounds).into_iter().filter(inside));
        along.push(to.state);
        let Some(found) = timed(along, from.cell, bounds).and_then(|points| fit(&points, bounds)) else {
            break;
        };
        latest = found;
        if worst(&latest) < worst(&best) {
            best = latest.clone();
        }
    }
    best
}

/// Lowers the jerk-free profile along an arc that breaks a limit, and over its length on both sides less and less.
fn lower<R: Real>(nodes: &mut [Node<R>], arc: &Arc<R>) {
    let (from, to) = (arc.from.state.s, arc.to.state.s);
    let length = to - from;
    let first = nodes.partition_point(|node| node.s <= from - length);
    let behind = nodes.partition_point(|node| node.s < to + length);
    for node in nodes.iter_mut().take(behind).skip(first) {
        let off = (from - node.s).max(node.s - to).max(R::zero()) / length;
        node.free = node.free
            - node.free * (arc.broken + arc.broken.ldexp(-2)).min(R::one().ldexp(MOST)) * (R::one() - off);
    }
}
