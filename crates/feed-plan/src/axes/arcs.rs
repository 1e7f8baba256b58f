//! From the spline to stages of constant jerk.
//!
//! Between two nodes with feed and acceleration v₀, a₀ and v₁, a₁ at a distance Δs, two pieces of equal time meet all of them:
//!
//! ```text
//! h = 2Δs/(v̄ + √(v̄² + (a₀ - a₁) Δs/3))        j = (a₁ - a₀)/h ± 4 (Δv - h (a₀ + a₁)/2)/h²
//! ```
//!
//! v̄ the mean of both feeds, Δv their difference. From each node on, the longest such arc is taken that leaves the limits by no more
//! than a tolerance and loses next to no time; from a node to the next it is taken in any case. A piece in which the acceleration
//! passes 0 is cut there, for a stage has one of one sign.

use alloc::vec::Vec;

use real::Real;

use crate::axes::geometry::Bend;
use crate::axes::grid::Grid;
use crate::axes::rows::Place;
use crate::axes::spline::cells;
use crate::axes::way::{Motion, Way};
use crate::{FeedPiece, StageShape};

/// A stretch in time of this share, beyond 1, would mend what an arc may take too much.
const TOLERANCE: f64 = 1e-4;
/// Share of the time that an arc may take more than the spline.
const SLOWER: f64 = 1e-4;
/// Cells in one arc.
const LONGEST: usize = 512;
/// Times at which an arc is looked at in each cell.
const LOOKS: usize = 2;

/// Feed and acceleration at a node.
#[derive(Clone, Copy, Debug)]
struct Node {
    distance: f64,
    feed: f64,
    acceleration: f64,
    /// Time since the first node.
    time: f64,
}

/// A time of constant jerk.
#[derive(Clone, Copy, Debug)]
struct Part {
    feed: f64,
    acceleration: f64,
    jerk: f64,
    time: f64,
}

/// The pieces of a solution, in units of mm and of the limits' time; `None` where an arc does not exist.
pub(crate) fn pieces<C>(
    way: &Way<'_, C>,
    grid: &Grid,
    places: &[Place],
    x: &[f64],
    unit: f64,
) -> Option<Vec<FeedPiece<f64>>> {
    let nodes = nodes(grid, x, unit)?;
    let (first, last) = (nodes.first()?, nodes.last()?);
    let rest = |node: &Node, width: f64| 3.0 * width / node.feed;
    let mut pieces = Vec::new();
    let at_rest = FeedPiece { shape: StageShape::Onset, start_feed: 0.0, end_feed: first.feed, duration: 0.0 };
    pieces.push(FeedPiece { duration: rest(first, first.distance - way.begin), ..at_rest });
    let arcs = Arcs { way, grid, places, nodes: &nodes };
    let mut from = 0;
    while from + 1 < nodes.len() {
        let (to, parts) = arcs.longest(from)?;
        append(&mut pieces, &parts, nodes.get(to)?);
        from = to;
    }
    let to_rest = FeedPiece { shape: StageShape::Easing, start_feed: last.feed, end_feed: 0.0, duration: 0.0 };
    pieces.push(FeedPiece { duration: rest(last, way.end - last.distance), ..to_rest });
    Some(pieces)
}

/// The nodes that touch no rest.
fn nodes(grid: &Grid, x: &[f64], unit: f64) -> Option<Vec<Node>> {
    let square = unit * unit;
    let mut nodes = Vec::with_capacity(grid.nodes.len());
    let node = |distance: f64, b: f64, a: f64, time: f64| {
        (b > 0.0).then(|| Node { distance, feed: Real::sqrt(b) * unit, acceleration: a * square, time })
    };
    let mut time = 0.0;
    let mut last = None;
    for (cell, distance) in cells(&grid.nodes).zip(grid.nodes.get(1..)?) {
        nodes.push(node(*distance, cell.value(0.0).of(x), cell.acceleration(0.0).of(x), time)?);
        let inverse = |share: f64| 1.0 / (Real::sqrt(cell.value(share).of(x)) * unit);
        time += cell.width * (inverse(0.0) + 4.0 * inverse(0.5) + inverse(1.0)) / 6.0;
        last = Some(cell);
    }
    let (cell, distance) = (last?, grid.nodes.get(grid.nodes.len().checked_sub(2)?)?);
    nodes.push(node(*distance, cell.value(1.0).of(x), cell.acceleration(1.0).of(x), time)?);
    Some(nodes)
}

struct Arcs<'a, 'w, C> {
    way: &'a Way<'w, C>,
    grid: &'a Grid,
    places: &'a [Place],
    nodes: &'a [Node],
}

impl<C> Arcs<'_, '_, C> {
    /// The longest arc from a node that is good, and where it ends.
    fn longest(&self, from: usize) -> Option<(usize, [Part; 2])> {
        let most = (self.nodes.len() - 1 - from).min(LONGEST);
        let mut best = (1, self.arc(from, 1)?);
        let mut refused = most + 1;
        let mut count = 2;
        while count < refused && best.0 < most {
            match self.arc(from, count.min(most)).filter(|arc| self.is_good(from, count.min(most), arc)) {
                Some(arc) => {
                    best = (count.min(most), arc);
                    count *= 2;
                }
                None => refused = count,
            }
        }
        while refused > best.0 + 1 {
            let count = (refused + best.0) / 2;
            match self.arc(from, count).filter(|arc| self.is_good(from, count, arc)) {
                Some(arc) => best = (count, arc),
                None => refused = count,
            }
        }
        Some((from + best.0, best.1))
    }

    fn arc(&self, from: usize, count: usize) -> Option<[Part; 2]> {
        let (from, to) = (self.nodes.get(from)?, self.nodes.get(from + count)?);
        let length = to.distance - from.distance;
        let mean = 0.5 * (from.feed + to.feed);
        let root = Real::sqrt(mean.mul_add(mean, (from.acceleration - to.acceleration) * length / 3.0));
        let time = 2.0 * length / (mean + root);
        let rise = to.feed - from.feed - 0.5 * time * (from.acceleration + to.acceleration);
        let (even, odd) = ((to.acceleration - from.acceleration) / time, 4.0 * rise / (time * time));
        let half = 0.5 * time;
        let first = Part { feed: from.feed, acceleration: from.acceleration, jerk: even + odd, time: half };
        let acceleration = from.acceleration + first.jerk * half;
        let feed = from.feed + half * (from.acceleration + 0.5 * first.jerk * half);
        let second = Part { feed, acceleration, jerk: even - odd, time: half };
        (time > 0.0 && time < f64::MAX && feed > 0.0).then_some([first, second])
    }

    /// Whether an arc over this many cells keeps the limits and loses no time.
    fn is_good(&self, from: usize, count: usize, arc: &[Part; 2]) -> bool {
        let (Some(begin), Some(end)) = (self.nodes.get(from), self.nodes.get(from + count)) else {
            return false;
        };
        if arc[0].time + arc[1].time > (end.time - begin.time) * (1.0 + SLOWER) {
            return false;
        }
        let looks = (count * LOOKS).div_ceil(2).max(2);
        let (mut distance, mut cell) = (begin.distance, from + 1);
        for part in arc {
            for look in 0..=looks {
                let time = part.time * look as f64 / looks as f64;
                let motion = part.motion(distance, time);
                while cell < from + count && self.grid.nodes.get(cell + 1).is_some_and(|end| *end < motion.distance) {
                    cell += 1;
                }
                if !self.is_within(cell, &motion) {
                    return false;
                }
            }
            distance = part.motion(distance, part.time).distance;
        }
        true
    }

    fn is_within(&self, cell: usize, motion: &Motion) -> bool {
        let (Some(place), Some([from, to])) = (self.places.get(cell), self.grid.nodes.get(cell..cell + 2)) else {
            return false;
        };
        let share = ((motion.distance - from) / (to - from)).clamp(0.0, 1.0);
        let between = |a: f64, b: f64, x: f64| a + (b - a) * x;
        let (half, x) = if share < 0.5 { (0, 2.0 * share) } else { (1, 2.0 * share - 1.0) };
        let (low, high) = (&place.bends[half], &place.bends[half + 1]);
        let vector = |a: &[f64; 3], b: &[f64; 3]| core::array::from_fn(|i| between(a[i], b[i], x));
        let bend =
            Bend { e: vector(&low.e, &high.e), k: vector(&low.k, &high.k), c: vector(&low.c, &high.c) };
        let quarter = [0.25, 0.5, 0.75].iter().filter(|edge| share >= **edge).count();
        let x = 4.0 * share - quarter as f64;
        let feed = between(place.feeds[quarter], place.feeds[quarter + 1], x);
        motion.feed > 0.0 && self.way.strain(motion, &bend, feed).stretch() <= 1.0 + TOLERANCE
    }
}

impl Part {
    fn motion(&self, from: f64, time: f64) -> Motion {
        let &Self { feed, acceleration, jerk, .. } = self;
        let travelled = time * (feed + time * (0.5 * acceleration + time * jerk / 6.0));
        Motion {
            distance: from + travelled,
            feed: feed + time * (acceleration + 0.5 * jerk * time),
            acceleration: acceleration + jerk * time,
            jerk,
        }
    }

    /// The same, cut where the acceleration passes 0.
    fn of_one_sign(self) -> [Option<Self>; 2] {
        let end = self.acceleration + self.jerk * self.time;
        let zero = -self.acceleration / self.jerk;
        if !(self.acceleration * end < 0.0 && zero > 0.0 && zero < self.time) {
            return [Some(self), None];
        }
        let motion = self.motion(0.0, zero);
        let before = Self { time: zero, ..self };
        let after = Self { feed: motion.feed, acceleration: 0.0, time: self.time - zero, ..self };
        [Some(before), Some(after)]
    }
}

/// Appends the pieces of an arc that ends at a node.
fn append(pieces: &mut Vec<FeedPiece<f64>>, arc: &[Part; 2], end: &Node) {
    let parts: Vec<Part> = arc.iter().flat_map(|part| part.of_one_sign()).flatten().collect();
    for (i, part) in parts.iter().enumerate() {
        let to = part.motion(0.0, part.time);
        let end_feed = parts.get(i + 1).map_or(end.feed, |next| next.feed);
        let sum = part.acceleration + to.acceleration;
        let bent = (part.acceleration - to.acceleration) / sum;
        let shape = match sum.abs() > 0.0 {
            true if bent >= 1.0 => StageShape::Easing,
            true if bent <= -1.0 => StageShape::Onset,
            true => StageShape::Bent(bent),
            false => StageShape::Steady,
        };
        pieces.push(FeedPiece { shape, start_feed: part.feed, end_feed, duration: part.time });
    }
}
