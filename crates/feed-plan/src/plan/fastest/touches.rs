//! Touches: where the profile passes a sharp bend of the limit, and with which acceleration.
//!
//! A bend of the jerk-free profile is *sharp* where its acceleration rises faster than J. No motion follows it: the profile touches it
//! at one node and leaves it on both sides along arcs of jerk J. Which acceleration θ it has there is the one freedom of a plan. The caps
//! below the jerk-free profile arrive there with a⁻ and depart with a⁺; `θ = 0.3 (a⁻ + a⁺)` at a minimum of the feed and
//! `0.45 (a⁻ + a⁺)` on a flank came closest to the optimum over the published curves. It lies between the accelerations of the jerk-free
//! profile on both sides, and `|θ| ≤ 0.9 √(2 J v)`, so that no arc of jerk J comes to rest beside the touch.

use alloc::vec::Vec;

use real::Real;

use crate::plan::fastest::caps::Contact;
use crate::plan::fastest::grid::Node;

/// A bend goes on if it does within this share of the time A/J, as a power of two.
const REACH: i32 = -2;

/// How a node takes part in a sharp bend.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum Bend<R> {
    /// None there, or one that the profile reaches along an arc that comes from its touch.
    Mild,
    /// The profile touches it there.
    Touch(Touch<R>),
    /// Sharp, before or behind the touch of the bend, and the acceleration there.
    Before(R),
    Behind(R),
}

/// The acceleration at a touch, and those that the jerk-free profile has before and behind it, between which it lies.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Touch<R> {
    pub(crate) theta: R,
    pub(crate) between: [R; 2],
}

/// Accelerations of the jerk-free profile, and times, from each node to the next.
pub(crate) struct Cells<R> {
    pub(crate) acceleration: Vec<R>,
    pub(crate) time: Vec<R>,
}

impl<R: Real> Cells<R> {
    pub(crate) fn new(nodes: &[Node<R>]) -> Self {
        let count = nodes.len();
        let mut cells = Self { acceleration: Vec::with_capacity(count), time: Vec::with_capacity(count) };
        for pair in nodes.windows(2) {
            let (from, to) = (&pair[0], &pair[1]);
            let sum = from.free + to.free;
            let time = if sum > R::zero() { (to.s - from.s).ldexp(1) / sum } else { R::zero() };
            let rise = to.free - from.free;
            cells.acceleration.push(if time > R::zero() { rise / time } else { R::zero() });
            cells.time.push(time);
        }
        cells
    }

    fn is_sharp(&self, k: usize, jerk: R) -> bool {
        if k == 0 || k >= self.time.len() {
            return false;
        }
        let rise = self.acceleration[k] - self.acceleration[k - 1];
        rise > jerk * (self.time[k] + self.time[k - 1]).half()
    }
}

/// The bend at each node.
pub(crate) fn bends<R: Real>(
    nodes: &[Node<R>],
    cells: &Cells<R>,
    contacts: &[Contact<R>],
    acceleration: R,
    jerk: R,
) -> Vec<Bend<R>> {
    let mut bends: Vec<Bend<R>> = nodes.iter().map(|_| Bend::Mild).collect();
    let mut contacts = contacts.iter().peekable();
    let reach = (acceleration / jerk).ldexp(REACH);
    let mut k = 0;
    while k < nodes.len() {
        if !cells.is_sharp(k, jerk) {
            k += 1;
            continue;
        }
        let (first, last) = (k, end_of_run(cells, k, jerk, reach));
        while contacts.next_if(|contact| contact.node < first).is_some() {}
        let mut touched = None;
        while let Some(contact) = contacts.next_if(|contact| contact.node <= last) {
            let (_, arrival, _, _) = touched.unwrap_or((contact.node, contact.arrival, R::zero(), 0));
            touched = Some((first, arrival, contact.departure, contact.node));
        }
        let touch = touched.map(|(_, arrival, departure, _)| {
            let theta = wanted(arrival, departure);
            let place = (first..last).find(|k| cells.acceleration[*k] >= theta).unwrap_or(last);
            let most = (jerk * nodes[place].free).ldexp(1).sqrt() * R::from_ratio(9, 10);
            let most = most.min(acceleration);
            let most = |a: R| a.min(most).max(R::zero() - most);
            let between = [cells.acceleration[place - 1], cells.acceleration[place]];
            let theta = most(theta.max(between[0]).min(between[1]));
            (place, Touch { theta, between: between.map(most) })
        });
        for (k, bend) in bends.iter_mut().enumerate().take(last + 1).skip(first) {
            *bend = match touch {
                Some((place, touch)) if k == place => Bend::Touch(touch),
                Some((place, touch)) if k > place => Bend::Behind(touch.theta),
                Some((_, touch)) => Bend::Before(touch.theta),
                // The caps pass below it, and mostly so does what comes of them.
                None => Bend::Behind(cells.acceleration[first - 1]),
            };
        }
        k = last + 1;
    }
    bends
}

fn wanted<R: Real>(arrival: R, departure: R) -> R {
    let is_minimum = arrival < R::zero() && departure > R::zero();
    (arrival + departure) * R::from_ratio(if is_minimum { 6 } else { 9 }, 20)
}

/// The last node of the sharp bend that begins at a node: the last one up to which the acceleration has risen by more than J allows.
/// Between limit points, and between two minima beside each other, it rises slower for a while, no longer than `reach`.
fn end_of_run<R: Real>(cells: &Cells<R>, first: usize, jerk: R, reach: R) -> usize {
    let mut last = first;
    let mut gap = R::zero();
    for k in first + 1..cells.time.len() {
        gap = gap + cells.time[k - 1];
        if gap > reach {
            break;
        }
        if cells.acceleration[k] - cells.acceleration[last] > jerk * gap {
            (last, gap) = (k, R::zero());
        }
    }
    last
}
