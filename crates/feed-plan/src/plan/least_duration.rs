//! What no plan beats, with the jerk limited too.
//!
//! All motions here keep `|a| ≤ A`, `|j| ≤ J` and the limit, and rest without acceleration wherever they rest. `b = v²` over the
//! distance has `b' = 2a` and `b'' = 2j/√b`.
//!
//! 1. *Caps*. Between two nodes no motion is faster than the arc of jerk -J through upper bounds of its feeds there: where it were, up
//!    to the places where both are equal, `b'' ≥ -2J/√b` would be at least the arc's, so that the difference of both b, zero at
//!    the ends, would be convex and so not positive. The times of these arcs are a bound, whichever nodes are taken: the fewest that
//!    [`caps`] finds give the largest.
//! 2. *From rest*. No motion u that rests at a place is faster behind it than the motion M with jerk J, then acceleration A. Let M start
//!    later so that both are at a place at the same time, and w be u's distance less M's from M's start on. `w''' ≤ 0`, so w' is concave;
//!    `w ≥ 0` and `w' ≥ 0` at first. Were u faster at that place, `w' > 0` at the end, `w' ≥ 0` throughout, and `w = 0` at the end would make it
//!    zero. Where M has the acceleration A, nothing gains on it over the same distance. Before a rest the same holds in reverse.
//! 3. *Windows*. The path falls into windows with a place p in each. Of motions u with an acceleration of at most θ at p none is sooner
//!    anywhere behind p than M: from the bound of 2 at p and θ with jerk J, no further than A, then an arc of jerk -J onto the profile P
//!    of 1 and 2 that it touches, then along P. While M's jerk is J, it leads in a, v and s at every time. On the arc u's a less M's
//!    only grows. Where u came level with M, it would be no slower and its a no less, so that b, whose `b''` is no less than M's there,
//!    would be above P where M touches P. Behind that u is no faster than P. So the time behind p is at least M's for θ, that
//!    before p M's in reverse for -θ, and the sum, θ being somewhere between -A and A, is at least the least one. It is
//!    taken over intervals of θ, each with M's times for its two ends; the interval with the least is halved a number of times. Where M would start above P, the time along P is the bound.

use alloc::vec::Vec;

use real::Real;

use crate::plan::fastest::caps::{Contact, caps};
use crate::plan::fastest::motion::time_over;
use crate::plan::lower_bound::{LimitInterval, intervals};
use crate::{EndFeeds, FeedLimit, KinematicLimits};

/// Nodes per time A/J.
const NODES: i32 = 16;
/// Nodes in one stretch between limit points, at most, from each side.
const MOST: usize = 100;
/// Halvings of intervals of θ between the accelerations of P before and behind p, always where the bound is least.
const HALVINGS: usize = 12;
/// Windows are divided within caps over so many nodes at least.
const CAP: usize = 2;
/// Places of a window that are tried: each gives a bound, and the largest holds.
const PLACES: usize = 3;
/// Contacts without a bend within one bend of P, at most.
const FLAT: usize = 3;
/// Rounds in which neighbouring windows are joined.
const MERGES: usize = 6;

/// A lower bound of the duration of any motion under the limit with `|a| ≤ A` and `|j| ≤ J` that begins and ends at these feeds, or
/// at the limit where that is lower, without acceleration where it rests.
///
/// At least [`jerk_free_duration`](crate::jerk_free_duration), but for rounding: on the published curves within 0.3 % of the
/// fastest motion that is known, and within 3 % with a jerk so low that no feed is held. The limit points are taken as there, so the
/// value is a lower bound to within the sampling of the limit. What the axes leave of acceleration and jerk is not counted. A limit that is zero over a stretch gives the greatest
/// number of the format. Time: in proportion to the limit points and to the duration in times A/J.
#[must_use]
pub fn least_duration<R: Real>(limit: &FeedLimit<R>, limits: &KinematicLimits<R>, ends: EndFeeds<R>) -> R {
    let most = Most { acceleration: limits.acceleration, jerk: limits.jerk };
    let nodes = nodes(&intervals(limit.samples()), limits, ends);
    by_sections(&nodes, |section| of_section(section, &most))
        .max(crate::jerk_free_duration(limit, limits, ends))
}

/// A way between two rests, of which the bound is sought.
pub(crate) struct BoundedWay<R> {
    nodes: Vec<Node<R>>,
    most: Most<R>,
}

impl<R: Real> BoundedWay<R> {
    /// The way between two distances at both of which it rests; rounding may have moved them.
    pub(crate) fn between(limit: &FeedLimit<R>, limits: &KinematicLimits<R>, (begin, end): (R, R)) -> Self {
        let most = Most { acceleration: limits.acceleration, jerk: limits.jerk };
        let nodes = nodes(&intervals(limit.samples_between(begin, end)), limits, EndFeeds::default());
        Self { nodes, most }
    }

    /// The bound of 1 and 2 alone: the least time where the way from rest and to rest leads to a level limit, by one walk along the nodes.
    pub(crate) fn rough_duration(&self) -> R {
        let most = &self.most;
        by_sections(&self.nodes, |section| Some(time_below(&from_rest_to_rest(section, most)?, most.jerk)))
    }

    /// The bound of 1 to 3.
    pub(crate) fn least_duration(&self) -> R {
        by_sections(&self.nodes, |section| of_section(section, &self.most))
    }
}

/// The sum of the bounds of the ways from rest to rest; the greatest number of the format if one has none.
fn by_sections<R: Real>(nodes: &[Node<R>], bound: impl Fn(&[Node<R>]) -> Option<R>) -> R {
    let mut duration = R::zero();
    let mut first = 0;
    while first + 1 < nodes.len() {
        let is_rest = |node: &Node<R>| !(node.v > R::zero());
        let behind = nodes.iter().skip(first + 1).position(is_rest);
        let last = behind.map_or(nodes.len() - 1, |behind| first + 1 + behind);
        match bound(nodes.get(first..=last).unwrap_or_default()) {
            Some(time) => duration = duration + time,
            None => return R::max_value(),
        }
        first = last;
    }
    duration
}

#[derive(Clone, Copy)]
struct Most<R> {
    acceleration: R,
    jerk: R,
}

/// A place on the path, the most that the feed can be there, and the least time to it from the first node at the limit alone.
#[derive(Clone, Copy)]
struct Node<R> {
    s: R,
    v: R,
    t: R,
}

/// The jerk-free feeds at the limit points and between them.
fn nodes<R: Real>(
    intervals: &[LimitInterval<R>],
    limits: &KinematicLimits<R>,
    ends: EndFeeds<R>,
) -> Vec<Node<R>> {
    let acceleration = limits.acceleration;
    let at_end = |feed: R, inside: Option<R>| (feed * feed).min(inside.unwrap_or(R::zero()));
    let first = at_end(ends.start, intervals.first().map(|first| first.inside[0]));
    let last = at_end(ends.end, intervals.last().map(|last| last.inside[1]));
    let mut squares = Vec::from([first]);
    squares.extend(intervals.iter().map(|interval| interval.allowed_end));
    if let Some(end) = squares.last_mut() {
        *end = end.min(last);
    }
    let rise = |k: usize| intervals[k].rise(limits);
    for k in 0..intervals.len() {
        squares[k + 1] = squares[k + 1].min(squares[k] + rise(k));
    }
    for k in (0..intervals.len()).rev() {
        squares[k] = squares[k].min(squares[k + 1] + rise(k));
    }
    let step = acceleration / limits.jerk / R::from_ratio(NODES, 1);
    let step = step.max(limits.interpolation_period.ldexp(-2));
    let mut nodes = Vec::from([Node { s: R::zero(), v: squares[0].sqrt(), t: R::zero() }]);
    let mut begin = R::zero();
    for (interval, ends) in intervals.iter().zip(squares.windows(2)) {
        let length = interval.length;
        let [b0, b1] = [ends[0], ends[1]];
        let limit = |x: R| interval.inside[0] + (interval.inside[1] - interval.inside[0]) * (x / length);
        let at = |x: R| {
            let reach = |b: R, x: R| b + (acceleration * x).ldexp(1);
            limit(x).min(reach(b0, x)).min(reach(b1, length - x)).sqrt()
        };
        let from = |feed: R| gaps(feed, acceleration, step, length.half());
        let (up, down) = (from(b0.sqrt()), from(b1.sqrt()));
        let inner = up.iter().copied().chain([length.half()]).chain(down.iter().rev().map(|x| length - *x));
        // V² is linear, so the limit is highest at one end.
        let highest = |x: [R; 2]| limit(x[0]).max(limit(x[1])).sqrt();
        let (mut before, mut time) = (R::zero(), nodes.last().map_or(R::zero(), |last| last.t));
        for x in inner.chain([length]) {
            let v = if x == length { b1.sqrt() } else { at(x) };
            let (s, most) = (begin + x, highest([before, x]));
            if most > R::zero() {
                time = time + (x - before) / most;
            }
            before = x;
            match nodes.last_mut() {
                Some(last) if !(s > last.s) => last.v = last.v.min(v),
                _ => nodes.push(Node { s, v, t: time }),
            }
        }
        begin = begin + length;
    }
    nodes
}

/// Distances from an end of a stretch, up to its half: a step of time apart at first, then further and further.
fn gaps<R: Real>(feed: R, acceleration: R, step: R, half: R) -> Vec<R> {
    let mut places = Vec::new();
    let mut gap = step * (feed + (acceleration * step).half());
    let mut place = gap;
    while place < half && gap > R::zero() && places.len() < MOST {
        places.push(place);
        gap = gap + gap.ldexp(-2);
        place = place + gap;
    }
    places
}

/// The feeds between two rests, or ends in motion, lowered to what jerk and acceleration allow from a rest and to one.
fn from_rest_to_rest<R: Real>(nodes: &[Node<R>], most: &Most<R>) -> Option<Vec<Node<R>>> {
    let (first, last) = (nodes.first()?, nodes.last()?);
    if nodes.len() < 3 && !(first.v + last.v > R::zero()) {
        return None;
    }
    let mut bounds = nodes.to_vec();
    if first.v.is_zero() {
        lower_from_rest(&mut bounds, most);
    }
    if last.v.is_zero() {
        mirror(&mut bounds);
        lower_from_rest(&mut bounds, most);
        mirror(&mut bounds);
    }
    Some(bounds)
}

/// The bound between two rests.
fn of_section<R: Real>(nodes: &[Node<R>], most: &Most<R>) -> Option<R> {
    let (first, last) = (nodes.first()?, nodes.last()?);
    // The profile P at all nodes, once the caps are followed.
    let mut profile = from_rest_to_rest(nodes, most)?;
    let contacts = caps(profile.len(), |k| (profile[k].s, profile[k].v), most.jerk);
    // A rest is a place of its own, whose θ is zero.
    let at_rest = |node: usize| Touch { node, ends: [R::zero(); 2], jump: R::max_value() };
    let end = profile.len() - 1;
    let (mut begin, mut places) = (0, Vec::new());
    let mut bends = bends(&contacts, most.jerk).into_iter().peekable();
    places.extend(first.v.is_zero().then(|| at_rest(0)));
    let mut windows: Vec<Window<R>> = Vec::new();
    for pair in contacts.windows(2) {
        let (from, to) = (&pair[0], &pair[1]);
        follow(&mut profile, [from.node, to.node], from.departure, most.jerk);
        if let Some(place) = bends.next_if(|place| place.node == from.node) {
            add(&mut places, place);
        }
        if to.node >= from.node + CAP && from.node >= begin && !places.is_empty() {
            let middle = from.node.midpoint(to.node);
            windows.push(Window::new([begin, middle], core::mem::take(&mut places)));
            begin = middle;
        }
    }
    // Between the last place and a rest at the end the window is divided where the feed is highest.
    if let Some(place) = places.last().filter(|_| last.v.is_zero()).map(|place| place.node) {
        let highest =
            (place..end).fold(place, |best, k| if profile[k].v > profile[best].v { k } else { best });
        windows.push(Window::new([begin, highest], core::mem::take(&mut places)));
        begin = highest;
    }
    places.extend(last.v.is_zero().then(|| at_rest(end)));
    windows.push(Window::new([begin, end], places));
    for _ in 0..MERGES {
        let count = windows.len();
        windows = merged(&profile, windows, most);
        if windows.len() == count {
            break;
        }
    }
    Some(windows.iter_mut().fold(R::zero(), |sum, window| sum + window.bound(&profile, most)))
}

/// Nodes from one to another, the places there that are tried, the bound of the time if it is known, and whether the window before is
/// known to be better alone.
struct Window<R> {
    nodes: [usize; 2],
    places: Vec<Touch<R>>,
    time: Option<R>,
    stays: bool,
}

impl<R: Real> Window<R> {
    const fn new(nodes: [usize; 2], places: Vec<Touch<R>>) -> Self {
        Self { nodes, places, time: None, stays: false }
    }

    fn bound(&mut self, profile: &[Node<R>], most: &Most<R>) -> R {
        let Self { nodes, places, time, .. } = self;
        *time.get_or_insert_with(|| of_window(profile, *nodes, places, most))
    }
}

/// Neighbouring windows as one wherever that is the better bound: at a low jerk one place governs a long way. No window is joined
/// twice in a round, and no two are tried twice, so that a node is looked at a number of times that does not grow with the path.
fn merged<R: Real>(profile: &[Node<R>], windows: Vec<Window<R>>, most: &Most<R>) -> Vec<Window<R>> {
    let mut merged: Vec<Window<R>> = Vec::with_capacity(windows.len());
    let mut is_joined = true;
    for mut window in windows {
        let Some(before) = merged.last_mut().filter(|_| !is_joined && !window.stays) else {
            window.stays &= !is_joined;
            is_joined = false;
            merged.push(window);
            continue;
        };
        let mut places = before.places.clone();
        window.places.iter().for_each(|place| add(&mut places, *place));
        let mut both = Window::new([before.nodes[0], window.nodes[1]], places);
        let apart = before.bound(profile, most) + window.bound(profile, most);
        is_joined = both.bound(profile, most) > apart;
        if is_joined {
            *before = both;
        } else {
            window.stays = true;
            merged.push(window);
        }
    }
    merged
}

/// A bend of P: a node at which P touches its upper bounds, its accelerations before and behind the bend, and what they differ by.
#[derive(Clone, Copy)]
struct Touch<R> {
    node: usize,
    ends: [R; 2],
    jump: R,
}

/// The bends of P, each at one of its contacts: a bend is a run of contacts in which the acceleration rises faster than J. No motion
/// follows it, and the accelerations at its ends are those between which θ is looked for.
fn bends<R: Real>(contacts: &[Contact<R>], jerk: R) -> Vec<Touch<R>> {
    let mut bends = Vec::new();
    let last = contacts.len().saturating_sub(1);
    let mut first = 1;
    while first < last {
        // Where V² is a line between limit points, contacts at which nothing bends lie between those where it does.
        let (mut end, mut gain, mut k) = (first, R::zero(), first + 1);
        while k < last && k <= end + FLAT {
            gain = gain + contacts[k].departure - contacts[k - 1].departure - jerk * contacts[k].time;
            if gain > R::zero() {
                (end, gain) = (k, R::zero());
            }
            k += 1;
        }
        let run = &contacts[first..=end];
        let ends = [run[0].arrival, contacts[end].departure];
        let middle = (ends[0] + ends[1]).half();
        let at = run.iter().find(|contact| contact.departure >= middle).unwrap_or(&run[0]);
        bends.push(Touch { node: at.node, ends, jump: ends[1] - ends[0] });
        first = end + 1;
    }
    bends
}

/// Keeps the places where the acceleration of P rises most.
fn add<R: Real>(places: &mut Vec<Touch<R>>, place: Touch<R>) {
    if places.len() < PLACES {
        places.push(place);
    } else if let Some(least) = (0..places.len())
        .min_by(|a, b| places[*a].jump.partial_cmp(&places[*b].jump).unwrap_or(core::cmp::Ordering::Equal))
        && places[least].jump < place.jump
    {
        places[least] = place;
    }
}

/// Reverses the way.
fn mirror<R: Real>(nodes: &mut [Node<R>]) {
    nodes.reverse();
    for node in nodes {
        (node.s, node.t) = (R::zero() - node.s, R::zero() - node.t);
    }
}

/// Puts the feeds of an arc of jerk -J between two nodes; those at both are there.
fn follow<R: Real>(profile: &mut [Node<R>], [from, to]: [usize; 2], departure: R, jerk: R) {
    let Node { s: s0, v: v0, .. } = profile[from];
    let mut time = R::zero();
    for node in profile.iter_mut().take(to).skip(from + 1) {
        let Node { s, v: bound, .. } = *node;
        // Newton's method from the node before.
        let down = R::zero() - jerk;
        for _ in 0..6 {
            let v = v0 + time * (departure + (down * time).half());
            let off = s - s0 - time * (v0 + time * (departure.half() + down * time * R::from_ratio(1, 6)));
            if v > R::zero() {
                time = time + off / v;
            } else {
                time = (off.abs() / jerk).sqrt();
            }
        }
        let v = v0 + time * (departure + (down * time).half());
        node.v = if v > R::zero() { v.min(bound) } else { bound };
    }
}

/// Feeds at nodes lowered to those of the motion from the first node with an acceleration θ at jerk J, no further than A, and times
/// there that are at most those of that motion. Between A's being reached and the node behind it, the motion is no faster than either
/// alone. They end where it lowers nothing more: it is above the feeds there, which rise by no more than A. `None` where it comes to
/// rest.
fn lowered_by_arc<R: Real>(nodes: &[Node<R>], theta: R, most: &Most<R>) -> Option<Vec<(R, R)>> {
    let &Node { mut s, mut v, .. } = nodes.first()?;
    let mut now = R::zero();
    let mut lowered = Vec::from([(v, now)]);
    let mut a = theta.min(most.acceleration);
    if a < R::zero() && a * a >= (most.jerk * v).ldexp(1) {
        return None;
    }
    for node in nodes.iter().skip(1) {
        let length = node.s - s;
        let by_acceleration = (v * v + (most.acceleration * length).ldexp(1)).sqrt();
        if a < most.acceleration {
            let time = time_over(length, v, a, most.jerk);
            let next = v + time * (a + (most.jerk * time).half());
            a = a + most.jerk * time;
            now = now + time;
            v = if a >= most.acceleration { next.min(by_acceleration) } else { next };
            a = a.min(most.acceleration);
        } else {
            now = now + (by_acceleration - v) / most.acceleration;
            v = by_acceleration;
        }
        lowered.push((node.v.min(v), now));
        s = node.s;
        if a >= most.acceleration && v >= node.v {
            break;
        }
    }
    Some(lowered)
}

/// Lowers feeds to those of the motion from rest at the first node.
fn lower_from_rest<R: Real>(nodes: &mut [Node<R>], most: &Most<R>) {
    let lowered = lowered_by_arc(nodes, R::zero(), most).unwrap_or_default();
    nodes.iter_mut().zip(lowered).for_each(|(node, (feed, _))| node.v = feed);
}

/// The least time of the arc that ends at a contact: between far nodes it is above the limit, at which the motion takes longer.
fn time_to<R: Real>(nodes: &[Node<R>], contacts: &[Contact<R>], k: usize) -> R {
    let Some(before) = k.checked_sub(1).map(|before| contacts[before].node) else { return contacts[k].time };
    contacts[k].time.max(nodes[contacts[k].node].t - nodes[before].t)
}

/// Nodes on one side of a place, from there on, and the places where the arcs below them touch, with the times of the arcs behind.
struct Side<'a, R> {
    nodes: &'a [Node<R>],
    touches: Vec<(usize, R)>,
}

impl<'a, R: Real> Side<'a, R> {
    fn new(nodes: &'a [Node<R>], jerk: R) -> Self {
        let (mut touches, mut behind) = (Vec::new(), R::zero());
        let contacts = caps(nodes.len(), |k| (nodes[k].s, nodes[k].v), jerk);
        for (k, contact) in contacts.iter().enumerate().rev() {
            touches.push((contact.node, behind));
            behind = behind + time_to(nodes, &contacts, k);
        }
        touches.reverse();
        Self { nodes, touches }
    }

    /// The time of the arcs below all of them.
    fn time(&self) -> R {
        self.touches.first().map_or(R::zero(), |touch| touch.1)
    }

    /// The least time of motions along P with at most the acceleration θ at the first node: up to some node that of the motion at
    /// jerk J, which leads any, and that of arcs behind it. From the first touch on that the motion does not lower, the arcs are those
    /// of P.
    fn time_from(&self, theta: R, most: &Most<R>) -> R {
        let Some(lowered) = lowered_by_arc(self.nodes, theta, most) else { return R::max_value().half() };
        let unchanged = self.touches.iter().find(|touch| touch.0 >= lowered.len());
        let last = self.nodes.len().saturating_sub(1);
        let (end, mut behind) = unchanged.copied().unwrap_or((last, R::zero()));
        let at = |k: usize| (self.nodes[k].s, lowered.get(k).map_or(self.nodes[k].v, |lowered| lowered.0));
        let mut least = R::zero();
        let contacts = caps(end + 1, at, most.jerk);
        for (k, contact) in contacts.iter().enumerate().rev() {
            if let Some((_, time)) = lowered.get(contact.node) {
                least = least.max(*time + behind);
            }
            behind = behind + time_to(self.nodes, &contacts, k);
        }
        least
    }
}

/// The time of the arcs below feeds.
fn time_below<R: Real>(nodes: &[Node<R>], jerk: R) -> R {
    Side::new(nodes, jerk).time()
}

/// The largest bound of a window that one of the places gives.
fn of_window<R: Real>(
    profile: &[Node<R>],
    [begin, end]: [usize; 2],
    places: &[Touch<R>],
    most: &Most<R>,
) -> R {
    let whole = time_below(&profile[begin..=end], most.jerk);
    let of = |place: &Touch<R>| {
        let node = place.node.max(begin).min(end);
        let mut before = profile[begin..=node].to_vec();
        mirror(&mut before);
        by_place(&before, &profile[node..=end], place.ends, most)
    };
    places.iter().map(of).fold(whole, R::max)
}

/// The least time of a window, over all accelerations at p; the nodes before p in reverse.
fn by_place<R: Real>(
    before: &[Node<R>],
    behind: &[Node<R>],
    [arrival, departure]: [R; 2],
    most: &Most<R>,
) -> R {
    let sides = [before, behind].map(|nodes| Side::new(nodes, most.jerk));
    let along = [0, 1].map(|k: usize| {
        let rests = sides[k].nodes.first().is_some_and(|first| first.v.is_zero());
        if rests { sides[k].time_from(R::zero(), most) } else { sides[k].time() }
    });
    let whole = along[0] + along[1];
    if !(departure > arrival) || before.len() < 2 || behind.len() < 2 {
        return whole;
    }
    // Below the first θ only what is before p is free, above the last only what is behind.
    let at = |theta: R| Theta {
        theta,
        before: sides[0].time_from(R::zero() - theta, most).max(along[0]),
        behind: sides[1].time_from(theta, most).max(along[1]),
    };
    let free = |theta: R| Theta { theta, before: along[0], behind: along[1] };
    let mut thetas = Vec::from([free(arrival), at(arrival), at(departure), free(departure)]);
    for _ in 0..HALVINGS {
        let least = least_interval(&thetas);
        let ends = [thetas[least].theta, thetas[least + 1].theta];
        if !(ends[1] > ends[0]) {
            break;
        }
        thetas.insert(least + 1, at((ends[0] + ends[1]).half()));
    }
    let least = least_interval(&thetas);
    (thetas[least].before + thetas[least + 1].behind).max(whole)
}

/// An acceleration θ at p, the least time before p of motions with no less, and the least time behind p of motions with no more.
struct Theta<R> {
    theta: R,
    before: R,
    behind: R,
}

/// The interval from a θ to the next in which the least time is least: no motion is faster.
fn least_interval<R: Real>(thetas: &[Theta<R>]) -> usize {
    let time = |k: usize| thetas[k].before + thetas[k + 1].behind;
    (1..thetas.len() - 1).fold(0, |least, k| if time(k) < time(least) { k } else { least })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::plan::fastest::published::{case, cases};
    use crate::test_paths::{limit_through, paper_limits};
    use crate::{ProfileKind, jerk_free_duration, plan_with};
    use proptest::prelude::*;

    #[test]
    fn published_curves_are_bounded_within_half_a_percent_of_the_optimum() {
        for row in cases() {
            let (limit, limits, _) = case(row);
            let (name, t, a, j, optimum) = row;
            let share = |bound: f64| 100.0 * (bound * t / optimum - 1.0);
            let bound = share(least_duration(&limit, &limits, EndFeeds::default()));
            let free = share(jerk_free_duration(&limit, &limits, EndFeeds::default()));
            println!("{name}, T {t}, A {a}, J {j}: {bound:.3} %, without jerk {free:.3} %");
            // Where J is so low that the whole path is one coming and going, windows are cut where they have not ended.
            let least = if j < 1e4 { -3.0 } else { -0.3 };
            assert!(bound > least && bound < 0.02 && bound >= free, "{row:?}: {bound} %");
        }
    }

    /// From rest to rest where nothing but A and J binds: `t = 4 ∛(L/(2J))`.
    #[test]
    fn a_short_line_is_bounded_by_its_own_time() {
        let (limit, limits) = (limit_through(&[(0.0, 0.6), (0.05, 0.6)]), paper_limits());
        let exact = 4.0 * (0.05 / (2.0 * limits.jerk)).cbrt();
        let bound = least_duration(&limit, &limits, EndFeeds::default());
        assert!(bound <= exact * (1.0 + 1e-12) && bound > 0.99 * exact, "{bound} {exact}");
    }

    /// `t = L/V + 2√(V/J)` from rest to rest where A is not reached, whether the limit has a point each period or one at each end.
    #[test]
    fn a_long_line_is_bounded_by_its_own_time() {
        let limits = KinematicLimits { jerk: 0.0005, ..paper_limits() };
        let (feed, length) = (0.6, 400.0);
        let exact = length / feed + 2.0 * (feed / limits.jerk).sqrt();
        for points in [2, 3, 700] {
            let at = |k: i32| (length * f64::from(k) / f64::from(points - 1), feed);
            let limit = limit_through(&(0..points).map(at).collect::<Vec<_>>());
            let bound = least_duration(&limit, &limits, EndFeeds::default());
            assert!(bound <= exact && bound > 0.999 * exact, "{points}: {bound} {exact}");
        }
    }

    proptest! {
        #![proptest_config(ProptestConfig::with_cases(300))]

        #[test]
        fn no_plan_is_faster(
            rows in prop::collection::vec((0.01..8.0_f64, 0.02..0.6_f64, prop::bool::weighted(0.05)), 2..40),
            exponent in -5.0..-1.0_f64,
        ) {
            let mut distance = 0.0;
            let mut rests = true;
            let points: Vec<_> = rows.into_iter().map(|(stride, feed, stops)| {
                distance += stride;
                rests = stops && !rests;
                (distance, if rests { 0.0 } else { feed })
            }).collect();
            let points: Vec<_> = points.iter().map(|(s, v)| (s - points[0].0, *v)).collect();
            let limits = KinematicLimits { jerk: 10.0_f64.powf(exponent), ..paper_limits() };
            let limit = limit_through(&points);
            let bound = least_duration(&limit, &limits, EndFeeds::default());
            for kind in ProfileKind::ALL {
                let plan = plan_with(&limit, &limits, EndFeeds::default(), kind).map_err(|error| TestCaseError::fail(error.to_string()))?;
                let duration = plan.as_schedule().duration();
                prop_assert!(duration >= bound * (1.0 - 1e-9), "{kind:?}: {duration} {bound}");
            }
        }
    }
}
