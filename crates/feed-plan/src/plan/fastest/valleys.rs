//! Valleys: the jerk-free profile with arcs of jerk J through its touches.
//!
//! What rises from a touch with the acceleration θ rises no faster than the arc of jerk J, on to the acceleration A; the same holds
//! backwards in time. The least of several profiles with `j ≤ J` is such a profile. One pass forward and one backward carry feed and
//! acceleration along such an arc until it meets the jerk-free profile. A touch that an arc passes
//! below is none, if no other acceleration of the touch that the arc comes from helps.

use alloc::vec::Vec;

use real::Real;

use crate::plan::fastest::grid::Node;
use crate::plan::fastest::motion::time_over;
use crate::plan::fastest::touches::{Bend, Cells, Touch};

/// Passes forward and backward, at most.
const ROUNDS: usize = 5;
/// Of these, those after which a touch whose arc passes below another is given another acceleration.
const TURNS: usize = 3;

/// The profile at a node.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Carrier<R> {
    pub(crate) v: R,
    pub(crate) a: R,
    /// Jerk of the profile as it goes on in both directions from here.
    pub(crate) jerk_before: R,
    pub(crate) jerk_behind: R,
    pub(crate) is_touch: bool,
}

/// What a pass finds at a node.
#[derive(Clone, Copy)]
struct Reached<R> {
    v: R,
    a: R,
    /// The jerk of the arc that leads on from here; [`no_arc`] where none does.
    behind: R,
    /// The same for the arc that leads here.
    before: R,
    /// The node from which the last arc began.
    origin: u32,
}

/// The jerk of no arc: that of the profile is unknown there.
fn no_arc<R: Real>() -> R {
    R::max_value()
}

/// The nodes of a section with the bends at them, forwards or backwards in time.
struct Way<'a, R, const BACKWARD: bool> {
    nodes: &'a [Node<R>],
    cells: &'a Cells<R>,
    bends: &'a [Bend<R>],
}

impl<R: Real, const BACKWARD: bool> Way<'_, R, BACKWARD> {
    /// The number of the node that is passed as number `k`.
    fn node(&self, k: usize) -> usize {
        if BACKWARD { self.nodes.len() - 1 - k } else { k }
    }

    fn feed(&self, k: usize) -> R {
        self.nodes[self.node(k)].free
    }

    fn length_behind(&self, k: usize) -> R {
        (self.nodes[self.node(k + 1)].s - self.nodes[self.node(k)].s).abs()
    }

    fn bend(&self, k: usize) -> Bend<R> {
        let bend = self.bends[self.node(k)];
        if BACKWARD { mirrored(bend) } else { bend }
    }

    /// Acceleration of the jerk-free profile from a node to the next, and the time.
    fn cell(&self, k: usize) -> (R, R) {
        if !BACKWARD {
            return (self.cells.acceleration[k], self.cells.time[k]);
        }
        let cell = self.node(k + 1);
        (R::zero() - self.cells.acceleration[cell], self.cells.time[cell])
    }

    /// The acceleration at a node, exact where that changes linearly in time.
    fn acceleration_at(&self, k: usize) -> R {
        let last = self.cells.time.len();
        if k == 0 || k >= last {
            return last.checked_sub(1).map_or(R::zero(), |last| self.cell(k.min(last)).0);
        }
        let ((a, before), (b, behind)) = (self.cell(k - 1), self.cell(k));
        let sum = before + behind;
        if sum > R::zero() { a + (b - a) * (before / sum) } else { a }
    }
}

/// The least of the jerk-free profile and the arcs through its touches.
pub(crate) fn valleys<R: Real>(
    nodes: &[Node<R>],
    cells: &Cells<R>,
    mut bends: Vec<Bend<R>>,
    start: R,
    most: [R; 2],
) -> Vec<Carrier<R>> {
    let count = nodes.len();
    let mut round = 0;
    let (forward, backward) = loop {
        let forward = climb(&Way::<_, false> { nodes, cells, bends: &bends }, start, most);
        let is_turned = settle(&mut bends, nodes, &forward, Side::Behind, round < TURNS);
        let mut backward = climb(&Way::<_, true> { nodes, cells, bends: &bends }, R::zero(), most);
        backward.reverse();
        let is_changed = settle(&mut bends, nodes, &backward, Side::Before, round < TURNS);
        round += 1;
        if round == ROUNDS || !(is_turned || is_changed) {
            break (forward, backward);
        }
    };
    let way = Way::<_, false> { nodes, cells, bends: &bends };
    let mut carriers: Vec<_> = (0..count)
        .map(|k| {
            let (f, b) = (forward[k], backward[k]);
            let from_b = Reached { a: R::zero() - b.a, behind: b.before, before: b.behind, ..b };
            let (one, is_touch) = match bends[k] {
                Bend::Touch(touch) => {
                    (Reached { v: nodes[k].free, a: touch.theta, before: b.behind, ..f }, true)
                }
                // The end is passed without acceleration.
                _ if k == 0 || k + 1 == count => {
                    let a = if k == 0 { start } else { R::zero() };
                    (Reached { v: nodes[k].free, a, before: b.behind, ..f }, true)
                }
                _ if f.v < b.v || (f.v == b.v && f.before != no_arc() && b.behind == no_arc()) => (f, false),
                _ if b.v < f.v || b.behind != no_arc() || b.before != no_arc() => (from_b, false),
                _ => (Reached { a: way.acceleration_at(k), ..f }, false),
            };
            Carrier { v: one.v, a: one.a, jerk_before: one.before, jerk_behind: one.behind, is_touch }
        })
        .collect();
    along_the_limit(&mut carriers, nodes, most[1]);
    carriers
}

fn mirrored<R: Real>(bend: Bend<R>) -> Bend<R> {
    match bend {
        Bend::Touch(touch) => {
            let [low, high] = touch.between.map(|a| R::zero() - a);
            Bend::Touch(Touch { theta: R::zero() - touch.theta, between: [high, low] })
        }
        Bend::Before(theta) => Bend::Behind(R::zero() - theta),
        Bend::Behind(theta) => Bend::Before(R::zero() - theta),
        Bend::Mild => Bend::Mild,
    }
}

/// The side of a touch to which its arc leads.
#[derive(Clone, Copy)]
enum Side {
    Before,
    Behind,
}

/// Settles what becomes of touches that a pass is below: the touch from which the arc came gets an acceleration half way to what the
/// jerk-free profile has beside it, so that the arc is higher; where `turns` is false, or the arc came from no touch, the one that it
/// passes below is none. Whether anything is changed that this pass, or the other one, depends on.
fn settle<R: Real>(
    bends: &mut [Bend<R>],
    nodes: &[Node<R>],
    reached: &[Reached<R>],
    side: Side,
    turns: bool,
) -> bool {
    let mut is_changed = false;
    let mut last_turned = None;
    for k in 0..bends.len() {
        let (Bend::Touch(_), Some(here)) = (bends[k], reached.get(k)) else { continue };
        let (feed, origin) = (nodes[k].free, here.origin as usize);
        if !(here.v < feed - feed.ldexp(-30)) || last_turned == Some(origin) {
            continue;
        }
        let turned = match bends.get_mut(origin) {
            Some(Bend::Touch(touch)) if turns && origin != k => touch.turn(side),
            _ => false,
        };
        if turned {
            last_turned = Some(origin);
            is_changed = true;
        } else {
            bends[k] = Bend::Mild;
            is_changed |= matches!(side, Side::Before);
        }
    }
    is_changed
}

impl<R: Real> Touch<R> {
    /// Turns the acceleration towards that of the jerk-free profile on one side, unless it is there.
    fn turn(&mut self, side: Side) -> bool {
        let goal = match side {
            Side::Before => self.between[0],
            Side::Behind => self.between[1],
        };
        let turned = (self.theta + goal).half();
        let is_turned = turned != self.theta;
        self.theta = turned;
        is_turned
    }
}

/// One pass: from the begin with the acceleration `start`, and from each touch an arc until it meets the jerk-free profile.
fn climb<R: Real, const BACKWARD: bool>(
    way: &Way<'_, R, BACKWARD>,
    start: R,
    [acceleration, jerk]: [R; 2],
) -> Vec<Reached<R>> {
    let count = way.nodes.len();
    let mut reached = Vec::with_capacity(count);
    if count == 0 {
        return reached;
    }
    let origin_at = |k: usize| u32::try_from(way.node(k)).unwrap_or(u32::MAX);
    let mut here = Reached { v: way.feed(0), a: start, behind: jerk, before: no_arc(), origin: origin_at(0) };
    for k in 0..count {
        let is_free = here.v >= way.feed(k);
        if k > 0 {
            here.behind = match way.bend(k) {
                _ if !is_free => jerk,
                Bend::Touch(touch) => {
                    (here.a, here.origin) = (touch.theta, origin_at(k));
                    jerk
                }
                Bend::Behind(theta) => {
                    (here.a, here.origin) = (way.cell(k - 1).0.max(theta), origin_at(k));
                    jerk
                }
                _ => {
                    here.a = way.acceleration_at(k);
                    no_arc()
                }
            };
        }
        if k + 1 == count {
            reached.push(here);
            break;
        }
        let (to, origin) = (way.feed(k + 1), here.origin);
        let mut next = Reached { v: to, a: R::zero(), behind: no_arc(), before: no_arc(), origin };
        if here.behind != no_arc() {
            let (v, a, used) = step(way.length_behind(k), (here.v, here.a), acceleration, jerk);
            here.behind = used;
            if v < to {
                next = Reached { v, a, before: used, ..next };
            }
        }
        reached.push(here);
        here = next;
    }
    reached
}

/// Feed, acceleration and jerk over a length at the jerk J, or at what reaches A at its end.
fn step<R: Real>(length: R, (v, a): (R, R), acceleration: R, jerk: R) -> (R, R, R) {
    let saturated = || {
        // Δs = v h + h² (2a + A)/6.
        let sixth = (a + a + acceleration) * R::from_ratio(1, 6);
        let root = (v * v + (sixth * length).ldexp(2)).sqrt();
        let time = length.ldexp(1) / (v + root);
        let used = if time > R::zero() { (acceleration - a) / time } else { R::zero() };
        (v + time * (a + acceleration).half(), acceleration, used)
    };
    if a >= acceleration {
        return saturated();
    }
    let time = time_over(length, v, a, jerk);
    let end = a + jerk * time;
    if end > acceleration { saturated() } else { (v + time * (a + end).half(), end, jerk) }
}

/// The jerk where the profile follows the limit: by the accelerations of neighbouring nodes that do so too, at most half of J either
/// way, so that a cap can be told from it.
fn along_the_limit<R: Real>(carriers: &mut [Carrier<R>], nodes: &[Node<R>], jerk: R) {
    let most = jerk.half();
    let mut before: Option<R> = None;
    for k in 0..carriers.len() {
        let from = carriers[k];
        if from.jerk_before == no_arc() {
            carriers[k].jerk_before = before.unwrap_or(R::zero());
        }
        before = None;
        if from.jerk_behind != no_arc() {
            continue;
        }
        carriers[k].jerk_behind = R::zero();
        let Some(to) = carriers.get(k + 1).copied() else { break };
        let sum = from.v + to.v;
        if to.jerk_before == no_arc() && sum > R::zero() {
            let time = (nodes[k + 1].s - nodes[k].s).ldexp(1) / sum;
            let change = if time > R::zero() { (to.a - from.a) / time } else { R::zero() };
            let change = change.min(most).max(R::zero() - most);
            carriers[k].jerk_behind = change;
            before = Some(change);
        }
    }
}
