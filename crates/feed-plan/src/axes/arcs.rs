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
use crate::axes::rows::WayCell;
use crate::axes::spline::{Cell, cells};
use crate::axes::way::{Motion, Way};
use crate::{FeedPiece, StageShape};

/// A stretch in time of this share, beyond 1, would mend what an arc may take too much.
const TOLERANCE: f64 = 1e-4;
/// Share of the time that an arc may take more than the spline.
const SLOWER: f64 = 1e-4;
/// Cells in one arc.
const LONGEST: usize = 512;
/// Parts that a cell is divided into, where an arc over it takes more of the limits than the spline does.
const PARTS: [usize; 3] = [2, 4, 8];
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
    places: &[WayCell],
    x: &[f64],
    unit: f64,
) -> Option<Vec<FeedPiece<f64>>> {
    let cells: Vec<Cell> = cells(&grid.nodes).collect();
    let nodes = nodes(grid, &cells, x, unit)?;
    let (first, last) = (nodes.first()?, nodes.last()?);
    let rest = |node: &Node, width: f64| 3.0 * width / node.feed;
    let mut pieces = Vec::new();
    let at_rest =
        FeedPiece { shape: StageShape::Onset, start_feed: 0.0, end_feed: first.feed, duration: 0.0 };
    pieces.push(FeedPiece { duration: rest(first, first.distance - way.begin), ..at_rest });
    let arcs = Arcs { way, grid, places, nodes: &nodes, cells: &cells, x, unit };
    let mut from = 0;
    while from + 1 < nodes.len() {
        let (count, arc) = arcs.longest(from)?;
        let to = from + count;
        if count > 1 || arcs.is_good(from, 1, &arc) {
            append(&mut pieces, &arc, nodes.get(to)?);
        } else {
            arcs.divide(from, &mut pieces)?;
        }
        from = to;
    }
    let to_rest =
        FeedPiece { shape: StageShape::Easing, start_feed: last.feed, end_feed: 0.0, duration: 0.0 };
    pieces.push(FeedPiece { duration: rest(last, way.end - last.distance), ..to_rest });
    Some(pieces)
}

/// The nodes that touch no rest.
fn nodes(grid: &Grid, cells: &[Cell], x: &[f64], unit: f64) -> Option<Vec<Node>> {
    let mut nodes = Vec::with_capacity(grid.nodes.len());
    let mut time = 0.0;
    for (cell, distance) in cells.iter().zip(grid.nodes.get(1..)?) {
        nodes.push(Node { time, ..Node::on(cell, 0.0, *distance, x, unit)? });
        let inverse = |share: f64| 1.0 / (Real::sqrt(cell.value(share).of(x)) * unit);
        time += cell.width * (inverse(0.0) + 4.0 * inverse(0.5) + inverse(1.0)) / 6.0;
    }
    let (cell, distance) = (cells.last()?, grid.nodes.get(grid.nodes.len().checked_sub(2)?)?);
    nodes.push(Node { time, ..Node::on(cell, 1.0, *distance, x, unit)? });
    Some(nodes)
}

impl Node {
    /// At a share of a cell that begins at `distance`, or ends there if the share is 1. Its time is not known.
    fn on(cell: &Cell, share: f64, distance: f64, x: &[f64], unit: f64) -> Option<Self> {
        let (b, a) = (cell.value(share).of(x), cell.acceleration(share).of(x));
        (b > 0.0).then(|| Self {
            distance,
            feed: Real::sqrt(b) * unit,
            acceleration: a * unit * unit,
            time: 0.0,
        })
    }
}

struct Arcs<'a, 'w, C> {
    way: &'a Way<'w, C>,
    grid: &'a Grid,
    places: &'a [WayCell],
    nodes: &'a [Node],
    cells: &'a [Cell],
    x: &'a [f64],
    unit: f64,
}

impl<C> Arcs<'_, '_, C> {
    /// The longest arc from a node that is good, or that to the next node, and over how many cells.
    fn longest(&self, from: usize) -> Option<(usize, [Part; 2])> {
        let within =
            (from + 1..self.nodes.len() - 1).take(LONGEST - 1).take_while(|node| !self.jumps(*node)).count();
        let most = within + 1;
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
        Some(best)
    }

    /// Whether the curvature or its change jumps at a node, by more than an arc may leave the limits.
    fn jumps(&self, node: usize) -> bool {
        let (Some(before), Some(after)) = (self.places.get(node), self.places.get(node + 1)) else {
            return false;
        };
        let (low, high) = (&before.bends[2], &after.bends[0]);
        let still = Bend {
            k: core::array::from_fn(|i| high.k[i] - low.k[i]),
            c: core::array::from_fn(|i| high.c[i] - low.c[i]),
            ..Bend::default()
        };
        let feed = before.feeds[4];
        let motion = Motion { distance: 0.0, feed, acceleration: self.way.limits.acceleration, jerk: 0.0 };
        self.way.strain(&Motion { acceleration: 0.0, ..motion }, &still, f64::MAX).jerk > TOLERANCE
            || self.way.strain(&motion, &still, f64::MAX).jerk > TOLERANCE
    }

    fn arc(&self, from: usize, count: usize) -> Option<[Part; 2]> {
        Part::between(self.nodes.get(from)?, self.nodes.get(from + count)?)
    }

    /// Appends as many arcs over the cell behind a node as are good, or the most of [`PARTS`].
    fn divide(&self, from: usize, pieces: &mut Vec<FeedPiece<f64>>) -> Option<()> {
        let (begin, end, cell) = (self.nodes.get(from)?, self.nodes.get(from + 1)?, self.cells.get(from)?);
        for count in PARTS {
            let node = |i: usize| {
                let share = i as f64 / count as f64;
                match i {
                    0 => Some(*begin),
                    _ if i == count => Some(*end),
                    _ => Node::on(cell, share, begin.distance + share * cell.width, self.x, self.unit),
                }
            };
            let nodes: Vec<Node> = (0..=count).map(node).collect::<Option<_>>()?;
            let arcs: Vec<[Part; 2]> =
                nodes.windows(2).map(|pair| Part::between(&pair[0], &pair[1])).collect::<Option<_>>()?;
            let mut pairs = nodes.iter().zip(&arcs);
            if PARTS.last() == Some(&count)
                || pairs.all(|(node, arc)| self.is_kept(from, 1, node.distance, arc))
            {
                for (arc, node) in arcs.iter().zip(nodes.get(1..)?) {
                    append(pieces, arc, node);
                }
                return Some(());
            }
        }
        None
    }

    /// Whether an arc over this many cells keeps the limits and loses no time.
    fn is_good(&self, from: usize, count: usize, arc: &[Part; 2]) -> bool {
        let (Some(begin), Some(end)) = (self.nodes.get(from), self.nodes.get(from + count)) else {
            return false;
        };
        arc[0].time + arc[1].time <= (end.time - begin.time) * (1.0 + SLOWER)
            && self.is_kept(from, count, begin.distance, arc)
    }

    /// Whether an arc that begins at a distance keeps the limits, on these cells.
    fn is_kept(&self, from: usize, count: usize, begin: f64, arc: &[Part; 2]) -> bool {
        let looks = (count * LOOKS).div_ceil(2).max(2);
        let (mut distance, mut cell) = (begin, from + 1);
        for part in arc {
            for look in 0..=looks {
                let time = part.time * look as f64 / looks as f64;
                let motion = part.motion(distance, time);
                while cell < from + count
                    && self.grid.nodes.get(cell + 1).is_some_and(|end| *end < motion.distance)
                {
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
        let (Some(place), Some([from, to])) = (self.places.get(cell), self.grid.nodes.get(cell..cell + 2))
        else {
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
        motion.feed > 0.0 && self.way.strain(motion, &bend, feed).is_within(1.0 + TOLERANCE)
    }
}

impl Part {
    /// The two parts that lead from one node to another.
    fn between(from: &Node, to: &Node) -> Option<[Self; 2]> {
        let length = to.distance - from.distance;
        let mean = 0.5 * (from.feed + to.feed);
        let root = Real::sqrt(mean.mul_add(mean, (from.acceleration - to.acceleration) * length / 3.0));
        let time = 2.0 * length / (mean + root);
        let rise = to.feed - from.feed - 0.5 * time * (from.acceleration + to.acceleration);
        let (even, odd) = ((to.acceleration - from.acceleration) / time, 4.0 * rise / (time * time));
        let half = 0.5 * time;
        let first = Self { feed: from.feed, acceleration: from.acceleration, jerk: even + odd, time: half };
        let acceleration = from.acceleration + first.jerk * half;
        let feed = from.feed + half * (from.acceleration + 0.5 * first.jerk * half);
        let second = Self { feed, acceleration, jerk: even - odd, time: half };
        (time > 0.0 && time < f64::MAX && feed > 0.0).then_some([first, second])
    }

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
        // The end of a part is the begin of the next one, not what its motion computes: a rounding instead of 0 would join a
        // fall of the feed and the rise behind it.
        let (end_feed, acceleration) =
            parts.get(i + 1).map_or((end.feed, end.acceleration), |next| (next.feed, next.acceleration));
        let sum = part.acceleration + acceleration;
        let bent = (part.acceleration - acceleration) / sum;
        let shape = match sum.abs() > 0.0 {
            true if bent >= 1.0 => StageShape::Easing,
            true if bent <= -1.0 => StageShape::Onset,
            true => StageShape::Bent(bent),
            false => StageShape::Steady,
        };
        pieces.push(FeedPiece { shape, start_feed: part.feed, end_feed, duration: part.time });
    }
}
