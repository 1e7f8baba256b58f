//! The nodes at which a section is looked at, from one rest to the next.
//!
//! Between two limit points the square of the limit is linear in the distance, and so are the squares of the feeds that A lets be
//! reached from one and braked for at the other. The least of the three lines is f², the *jerk-free* profile. Nodes lie at the limit
//! points, at the corners of f² and, away from the limit, beside such parts, and where the limit is level or bends, between them: no
//! more than a share of the time A/J apart near the corners and further apart away from them. Elsewhere along the limit more of them
//! would follow the steps of its acceleration at the limit points.

use alloc::vec::Vec;

use real::Real;

use crate::FeedLimit;
use crate::limit::sample::{LimitSample, interpolate};

/// Nodes in one stretch between corners of f, at most, from each side.
const MOST: usize = 400;

/// The limit is nearly the same at two points where it differs by no more than this share, as a power of two.
const LEVEL: i32 = -10;

/// The jerk-free profile bends where its acceleration changes by more than this share of A, as a power of two.
const BEND: i32 = -3;

/// A place of the section.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Node<R> {
    /// Distance from the path's start.
    pub(crate) s: R,
    /// The limit; between two nodes its square is linear.
    pub(crate) limit: R,
    /// The jerk-free feed, at most the limit.
    pub(crate) free: R,
}

/// The limit at a distance: what holds before and behind it, and the least of all there.
#[derive(Clone, Copy)]
struct Place<R> {
    s: R,
    before: R,
    least: R,
    behind: R,
    /// Whether the way to it bends.
    bends: bool,
}

impl<R: Real> Place<R> {
    /// The place of a sample; at an end of the section only what holds inside counts.
    fn of(sample: &LimitSample<R>, is_first: bool, is_last: bool) -> Self {
        let (before, behind) = (sample.lower_before, sample.lower_after);
        let least = match (is_first, is_last) {
            (true, _) => behind,
            (_, true) => before,
            _ => sample.lower.min(before).min(behind),
        };
        Self { s: sample.point.distance, before, least, behind, bends: sample.bends }
    }

    /// The places at a jump as one.
    fn and(self, behind: &Self) -> Self {
        Self { least: self.least.min(behind.least), behind: behind.behind, ..self }
    }

    /// Points on the straight way to the next place: a period from a jump at either end.
    fn beside_jumps(&self, next: &Self, period: R) -> [Option<(R, R)>; 2] {
        let (from, to) = ((self.s, self.behind), (next.s, next.before));
        let quarter = (next.s - self.s).ldexp(-2);
        let at = |s: R| (s, interpolate(from, to, s));
        let near = |v: R| (v * period).min(quarter);
        [
            (self.behind > self.least).then(|| at(self.s + near(self.behind))),
            (next.before > next.least).then(|| at(next.s - near(next.before))),
        ]
    }
}

/// Distance and limit of the samples from `first` to `last`; at both ends what holds inside. At a jump it is the less of both sides,
/// and on a straight way what holds beside the jump from a `period` away on. Where a straight way has a level limit, there are no points
/// between its ends, and where a curve has one, none within four periods of the one before, or within the time between nodes near corners,
/// if that is less.
pub(crate) fn limit_points<R: Real>(
    limit: &FeedLimit<R>,
    [first, last]: [usize; 2],
    [period, step]: [R; 2],
) -> Vec<(R, R)> {
    let near = step.min(period.ldexp(2));
    let samples = limit.samples().get(first..=last).unwrap_or_default();
    let places = (first..).zip(samples).map(|(k, sample)| Place::of(sample, k == first, k == last));
    let mut places = places.peekable();
    let mut points: Vec<(R, R)> = Vec::new();
    let mut is_level = false;
    let mut add = |s: R, v: R, bends: bool| {
        let goes_on = points.last().is_some_and(|point| point.1 == v);
        let is_near =
            |points: &[(R, R)]| points.iter().rev().nth(1).is_some_and(|begin| s - begin.0 <= v * near);
        let replaces = goes_on && is_level && (!bends || is_near(&points));
        match points.last_mut().filter(|_| replaces) {
            Some(point) => point.0 = s,
            None => points.push((s, v)),
        }
        is_level = goes_on;
    };
    let mut before: Option<Place<R>> = None;
    while let Some(mut here) = places.next() {
        while let Some(same) = places.next_if(|next| !(next.s > here.s)) {
            here = here.and(&same);
        }
        if let Some(before) = before.filter(|_| !here.bends) {
            let beside = before.beside_jumps(&here, period);
            beside.into_iter().flatten().for_each(|(s, v)| add(s, v, false));
        }
        add(here.s, here.least, here.bends);
        before = Some(here);
    }
    points
}

/// The greatest values below the given ones of which none is above its neighbour by more than A allows: `v₁² ≤ v₀² + 2 A Δs`.
pub(crate) fn scan<R: Real>(points: &[(R, R)], acceleration: R) -> Vec<R> {
    let mut free: Vec<R> = points.iter().map(|point| point.1).collect();
    let reach = |from: R, to: R, length: R| {
        let rise = (acceleration * length).ldexp(1);
        // √ is spared where it would change nothing.
        if to > from && to * to > from * from + rise { (from * from + rise).sqrt().min(to) } else { to }
    };
    for k in 1..free.len() {
        free[k] = reach(free[k - 1], free[k], points[k].0 - points[k - 1].0);
    }
    for k in (1..free.len()).rev() {
        free[k - 1] = reach(free[k], free[k - 1], points[k].0 - points[k - 1].0);
    }
    free
}

/// The nodes of a section; `step` is the time between nodes near corners.
pub(crate) fn nodes<R: Real>(points: &[(R, R)], beside: [R; 2], acceleration: R, step: R) -> Vec<Node<R>> {
    let free = scan(points, acceleration);
    let mut nodes = Vec::with_capacity(points.len() + points.len());
    let last = points.len().saturating_sub(1);
    let begin = |k: usize| {
        let limit = if k == 0 {
            beside[0]
        } else if k == last {
            beside[1]
        } else {
            points[k].1
        };
        Node { s: points[k].0, limit, free: free[k] }
    };
    let mut parts: Vec<Part<R>> = Vec::with_capacity(points.len());
    for k in 0..last {
        let (from, to) = (begin(k), begin(k + 1));
        let mut before = from;
        for corner in corners(&from, &to, acceleration).into_iter().flatten().chain([to]) {
            parts.push(Part { a: before, b: corner, cell: (from, to) });
            before = corner;
        }
    }
    for (k, part) in parts.iter().enumerate() {
        let [before, behind] = [k.checked_sub(1).and_then(|k| parts.get(k)), parts.get(k + 1)];
        let beside = || [before, behind].into_iter().flatten();
        let is_beside = beside().any(|other| !other.is_on_limit());
        let bends = || beside().any(|other| (other.slope() - part.slope()).abs() > acceleration.ldexp(BEND));
        if !part.is_on_limit() || is_beside || part.is_long(step) && (part.is_level() || bends()) {
            divide(part, step, &mut nodes);
        } else {
            add(&mut nodes, part.a);
        }
    }
    nodes.extend(points.len().checked_sub(1).map(begin));
    nodes
}

/// The way between two corners of f, which lies between two limit points.
struct Part<R> {
    a: Node<R>,
    b: Node<R>,
    cell: (Node<R>, Node<R>),
}

impl<R: Real> Part<R> {
    fn is_on_limit(&self) -> bool {
        self.a.free == self.a.limit && self.b.free == self.b.limit
    }

    /// Whether it lasts longer than nodes are apart.
    fn is_long(&self, step: R) -> bool {
        self.b.s - self.a.s > (self.a.free + self.b.free) * step
    }

    fn is_level(&self) -> bool {
        let (from, to) = (self.cell.0.limit, self.cell.1.limit);
        (from - to).abs() <= from.ldexp(LEVEL)
    }

    /// The acceleration of the jerk-free profile.
    fn slope(&self) -> R {
        let length = self.b.s - self.a.s;
        let rise = self.b.free * self.b.free - self.a.free * self.a.free;
        if length > R::zero() { rise.half() / length } else { R::zero() }
    }
}

/// The limit between two limit points.
fn limit_at<R: Real>(from: &Node<R>, to: &Node<R>, s: R) -> R {
    interpolate((from.s, from.limit), (to.s, to.limit), s)
}

/// Where the least of the three lines of f² changes between two limit points.
fn corners<R: Real>(from: &Node<R>, to: &Node<R>, acceleration: R) -> [Option<Node<R>>; 2] {
    let length = to.s - from.s;
    let square = |v: R| v * v;
    let (rise, slack) = ((acceleration * length).ldexp(1), R::one().ldexp(-16));
    let (b0, b1) = (square(from.limit), square(to.limit));
    let (f0, f1) = (square(from.free), square(to.free));
    // As shares of the length: where the line of a side meets the limit, or both lines meet.
    let meets = |f: R, b: R, towards: R| {
        let closing = rise - towards;
        if closing > R::zero() { ((b - f) / closing).max(R::zero()) } else { R::one() }
    };
    let up = meets(f0, b0, b1 - b0);
    let down = meets(f1, b1, b0 - b1);
    let node = |x: R| {
        let s = from.s + length * x;
        let limit = limit_at(from, to, s);
        let reach = |f: R, x: R| (f + rise * x).sqrt();
        Node { s, limit, free: limit.min(reach(f0, x)).min(reach(f1, R::one() - x)) }
    };
    let inside = |x: R| (x > slack && x < R::one() - slack).then(|| node(x));
    if up + down < R::one() {
        [inside(up), inside(R::one() - down)]
    } else {
        let peak = if rise > R::zero() { (R::one() + (f1 - f0) / rise).half() } else { R::zero() };
        [inside(peak), None]
    }
}

/// Nodes within a part, in which the acceleration is constant: so the feed is linear in time.
fn divide<R: Real>(Part { a, b, cell }: &Part<R>, step: R, nodes: &mut Vec<Node<R>>) {
    add(nodes, *a);
    let (length, sum) = (b.s - a.s, a.free + b.free);
    if !(length > R::zero() && sum > R::zero()) {
        return;
    }
    let duration = length.ldexp(1) / sum;
    let half = duration.half();
    // Times from each end, with gaps that grow by an eighth; mirrored, so that the middle is the widest.
    let mut times = Vec::new();
    let (mut time, mut gap) = (step, step);
    while time < half - gap.half() && times.len() < MOST {
        times.push(time);
        gap = gap + gap.ldexp(-3);
        time = time + gap;
    }
    let middle = (duration > step + step.half()).then_some(half);
    let forward = times.iter().copied();
    let backward = times.iter().rev().map(|time| duration - *time);
    for time in forward.chain(middle).chain(backward) {
        let x = time / duration;
        let free = a.free + (b.free - a.free) * x;
        let s = a.s + (a.free + free).half() * time;
        if s < b.s {
            let limit = limit_at(&cell.0, &cell.1, s);
            add(nodes, Node { s, limit, free: free.min(limit) });
        }
    }
}

/// Puts a node behind the others, if it lies there.
fn add<R: Real>(nodes: &mut Vec<Node<R>>, node: Node<R>) {
    if nodes.last().is_none_or(|last| node.s > last.s) {
        nodes.push(node);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::test_paths::limit_through;

    /// A corner that is passed slowly, at one point between two moves, once lowered the limit of both moves as far as their other ends.
    #[test]
    fn a_level_way_has_points_at_its_ends_and_a_period_from_a_jump() {
        let feeds =
            [(0.0, 0.6), (10.0, 0.6), (20.0, 0.6), (20.0, 0.1), (20.0, 0.6), (30.0, 0.6), (40.0, 0.6)];
        let expected = [(0.0, 0.6), (19.4, 0.6), (20.0, 0.1), (20.6, 0.6), (40.0, 0.6)];
        assert_eq!(limit_points(&limit_through(&feeds), [0, 6], [1.0; 2]), expected);
        // On a move of two periods, a quarter of it.
        let feeds = [(0.0, 0.6), (0.0, 0.1), (1.2, 0.1), (1.2, 0.6), (2.4, 0.6)];
        let expected = [(0.0, 0.1), (1.2, 0.1), (1.5, 0.6), (2.4, 0.6)];
        assert_eq!(limit_points(&limit_through(&feeds), [0, 4], [1.0; 2]), expected);
    }
}
