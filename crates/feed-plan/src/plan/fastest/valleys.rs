//! Valleys: the jerk-free profile with arcs of jerk J through its touches.
//!
//! What rises from a touch with the acceleration θ rises no faster than the arc of jerk J, on to the acceleration A; the same holds
//! backwards in time. The least of several profiles with `j ≤ J` is such a profile. One pass forward and one backward carry feed and
//! acceleration along such an arc until it meets the jerk-free profile. A touch that an arc passes
//! below is none, if no other acceleration of the touch that the arc comes from helps.

use alloc::vec::Vec;

use real::Real;

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
    /// Whether an arc leads on from here, and with which jerk.
    behind: Option<R>,
    /// The same for the arc that leads here.
    before: Option<R>,
    /// The node from which the last arc began.
    origin: usize,
}

/// The least of the jerk-free profile and the arcs through its touches.
pub(crate) fn valleys<R: Real>(
    places: &[R],
    feeds: &[R],
    cells: &Cells<R>,
    mut bends: Vec<Bend<R>>,
    start: R,
    [acceleration, jerk]: [R; 2],
) -> Vec<Carrier<R>> {
    let count = feeds.len();
    let reversed_places: Vec<R> = places.iter().rev().map(|s| R::zero() - *s).collect();
    let reversed_feeds: Vec<R> = feeds.iter().rev().copied().collect();
    let backward_cells = Cells::new(count, |k| (reversed_places[k], reversed_feeds[k]));
    let (mut forward, mut backward) = (Vec::new(), Vec::new());
    for round in 0..ROUNDS {
        forward = climb(places, feeds, cells, &bends, start, [acceleration, jerk]);
        let is_turned = settle(&mut bends, feeds, &forward, Side::Behind, round < TURNS);
        let reversed: Vec<_> = bends.iter().rev().map(|bend| mirrored(*bend)).collect();
        let (rest, most) = (R::zero(), [acceleration, jerk]);
        backward = climb(&reversed_places, &reversed_feeds, &backward_cells, &reversed, rest, most);
        backward.reverse();
        backward.iter_mut().for_each(|reached| reached.origin = count - 1 - reached.origin);
        let is_changed = settle(&mut bends, feeds, &backward, Side::Before, round < TURNS);
        if !(is_turned || is_changed) {
            break;
        }
    }
    drop((reversed_places, reversed_feeds, backward_cells));
    let mut carriers: Vec<_> = (0..count)
        .map(|k| {
            let (f, b) = (forward[k], backward[k]);
            let from_b = Reached { a: R::zero() - b.a, behind: b.before, before: b.behind, ..b };
            let (one, is_touch) = match bends[k] {
                Bend::Touch(touch) => {
                    let both = Reached {
                        v: feeds[k],
                        a: touch.theta,
                        behind: f.behind,
                        before: b.behind,
                        origin: k,
                    };
                    (both, true)
                }
                // The end is passed without acceleration.
                _ if k == 0 || k + 1 == count => {
                    let a = if k == 0 { start } else { R::zero() };
                    (Reached { v: feeds[k], a, behind: f.behind, before: b.behind, origin: k }, true)
                }
                _ if f.v < b.v || (f.v == b.v && f.before.is_some() && b.behind.is_none()) => (f, false),
                _ if b.v < f.v || b.behind.or(b.before).is_some() => (from_b, false),
                _ => (Reached { a: cells.at_node(k), ..f }, false),
            };
            let unknown = R::max_value();
            let jerk_before = one.before.unwrap_or(unknown);
            Carrier { v: one.v, a: one.a, jerk_before, jerk_behind: one.behind.unwrap_or(unknown), is_touch }
        })
        .collect();
    along_the_limit(&mut carriers, places, jerk);
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
    feeds: &[R],
    reached: &[Reached<R>],
    side: Side,
    turns: bool,
) -> bool {
    let mut is_changed = false;
    let mut last_turned = None;
    for k in 0..bends.len() {
        let (Bend::Touch(_), Some(here)) = (bends[k], reached.get(k)) else { continue };
        if !(here.v < feeds[k] - feeds[k].ldexp(-30)) || last_turned == Some(here.origin) {
            continue;
        }
        let turned = match bends.get_mut(here.origin) {
            Some(Bend::Touch(touch)) if turns && here.origin != k => touch.turn(side),
            _ => false,
        };
        if turned {
            last_turned = Some(here.origin);
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
fn climb<R: Real>(
    places: &[R],
    feeds: &[R],
    cells: &Cells<R>,
    bends: &[Bend<R>],
    start: R,
    [acceleration, jerk]: [R; 2],
) -> Vec<Reached<R>> {
    let mut reached = Vec::with_capacity(feeds.len());
    let Some(first) = feeds.first() else { return reached };
    let mut here = Reached { v: *first, a: start, behind: Some(jerk), before: None, origin: 0 };
    for k in 0..feeds.len() {
        let is_free = here.v >= feeds[k];
        if k > 0 {
            here.behind = match bends[k] {
                _ if !is_free => Some(jerk),
                Bend::Touch(touch) => {
                    (here.a, here.origin) = (touch.theta, k);
                    Some(jerk)
                }
                Bend::Behind(theta) => {
                    (here.a, here.origin) = (cells.acceleration[k - 1].max(theta), k);
                    Some(jerk)
                }
                _ => {
                    here.a = cells.at_node(k);
                    None
                }
            };
        }
        let Some(to) = feeds.get(k + 1) else {
            reached.push(here);
            break;
        };
        let length = places[k + 1] - places[k];
        let origin = here.origin;
        let mut next = Reached { v: *to, a: R::zero(), behind: None, before: None, origin };
        if here.behind.is_some() {
            let (v, a, used) = step(length, (here.v, here.a), acceleration, jerk);
            here.behind = Some(used);
            if v < *to {
                next = Reached { v, a, behind: None, before: Some(used), origin };
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
fn along_the_limit<R: Real>(carriers: &mut [Carrier<R>], places: &[R], jerk: R) {
    let unknown = R::max_value();
    let most = jerk.half();
    let mut before: Option<R> = None;
    for k in 0..carriers.len() {
        let from = carriers[k];
        if from.jerk_before == unknown {
            carriers[k].jerk_before = before.unwrap_or(R::zero());
        }
        before = None;
        if from.jerk_behind != unknown {
            continue;
        }
        carriers[k].jerk_behind = R::zero();
        let Some(to) = carriers.get(k + 1).copied() else { break };
        let sum = from.v + to.v;
        if to.jerk_before == unknown && sum > R::zero() {
            let time = (places[k + 1] - places[k]).ldexp(1) / sum;
            let change = if time > R::zero() { (to.a - from.a) / time } else { R::zero() };
            let change = change.min(most).max(R::zero() - most);
            carriers[k].jerk_behind = change;
            before = Some(change);
        }
    }
}
