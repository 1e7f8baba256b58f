//! Caps: the largest profile below given feeds whose acceleration falls by no more than the jerk J.
//!
//! With `b = v²`, a jerk of -J at least reads `b'' ≥ -2 J/√b`. The greater of two such profiles is such a profile, and two arcs of jerk
//! -J through a point cross nowhere else: so the largest one touches the given feeds at some nodes and goes from one to the next
//! along an arc, as the convex hull of points does along lines. A stack finds them: a node is taken off it where the arc from the
//! node before would arrive with more acceleration than the arc to the new node departs with.

use alloc::vec::Vec;

use real::Real;

use crate::plan::fastest::motion::time_of_cap;

/// A node where the profile touches the given feeds.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Contact<R> {
    pub(crate) node: usize,
    /// The acceleration at the end of the arc before.
    pub(crate) arrival: R,
    /// The acceleration at the begin of the arc behind.
    pub(crate) departure: R,
    /// The time of the arc before.
    pub(crate) time: R,
}

/// The contacts of the profile below the feeds `at(k)` = (distance, feed) for k below `count`.
pub(crate) fn caps<R: Real>(count: usize, at: impl Fn(usize) -> (R, R), jerk: R) -> Vec<Contact<R>> {
    let mut stack: Vec<Contact<R>> = Vec::with_capacity(count);
    for node in 0..count {
        let (s, v) = at(node);
        let mut arrival = R::zero();
        let mut time = R::zero();
        while let Some(top) = stack.last_mut() {
            let (begin, feed) = at(top.node);
            time = time_of_cap(s - begin, [feed, v], jerk);
            let (mean, half) = if time > R::zero() {
                ((v - feed) / time, (jerk * time).half())
            } else {
                (R::zero(), R::zero())
            };
            let departure = mean + half;
            if top.node > 0 && departure <= top.arrival {
                stack.pop();
                continue;
            }
            top.departure = departure;
            arrival = mean - half;
            break;
        }
        stack.push(Contact { node, arrival, departure: arrival, time });
    }
    stack
}
