//! Where on the path each setpoint is, in the order of both.
//!
//! A place on the path never goes back. Of all such ways to follow the path, the one is looked for whose sum of d⁴ is least, over the
//! distances d of setpoints from their places and of vertices that are passed from the step in which they are passed. The fourth power makes
//! it nearly the way whose largest distance is least, the Fréchet distance, and goes on to tell places apart behind a place that was far
//! off. The largest distance on the way that is found is an upper bound of the Fréchet distance.
//!
//! The ways are followed side by side: for each segment the best way that is on it now. Those whose sum is above that of the best by more
//! than a bound are given up. Where the best is far off and the path comes near again further on, a way that skips what lies between begins
//! too; what it skips counts by its distance from where the log left the path.

use crate::part_path::{PartPath, distance, dot, foot, squared_distance};

/// Sums above that of the best way by more than this are given up, in mm⁴: a vertex that is 5 mm off. Where segments are so short that many ways
/// are left, less.
const GIVEN_UP: f64 = 625.0;
/// So many ways are led on without giving up more of them; a half of it, and fewer are given up again.
const ENOUGH_WAYS: usize = 48;
/// From here on the best way is far off, in mm, and a way that skips some of the path is looked for. Next at twice the distance.
const FAR_MM: f64 = 1.0;
/// A way that skips comes this much nearer.
const NEARER: f64 = 0.25;
/// Ways that skip, at a time, and in all.
const MOST_SKIPS: usize = 32;
const MOST_SEARCHES: u32 = 1000;
/// Ways at a time, at most: the best are kept.
const MOST_WAYS: usize = 4096;

/// A way to follow the path so far.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Way {
    pub(crate) segment: usize,
    /// The share of the segment that is passed.
    pub(crate) share: f64,
    /// The sum of d⁴, above that of the best way, in mm⁴.
    cost: f64,
    /// The square of the last distance, and of the largest so far.
    pub(crate) off_2: f64,
    pub(crate) largest_2: f64,
    /// The last part that was skipped, as its number from 1; 0 if there is none.
    skip: usize,
    /// Whether it began with a skip and was never the best.
    is_young: bool,
}

/// A part of the path that a way skips.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Skip {
    /// Segments: from one, to the one at which the way goes on.
    pub(crate) from: usize,
    pub(crate) to: usize,
    /// The largest distance of what is skipped from where the log left the path, in mm.
    pub(crate) off_mm: f64,
    /// The skip before it, as its number from 1.
    before: usize,
}

/// The ways to follow a path.
pub(crate) struct InOrder<'p> {
    path: &'p PartPath,
    /// Whether the log leaves rapid moves out, so that they are passed unseen.
    leaves_rapids_out: bool,
    ways: Vec<Way>,
    next: Vec<Way>,
    best: Way,
    skips: Vec<Skip>,
    searches: u32,
    /// Sums above that of the best way by more than this are given up now, in mm⁴.
    given_up: f64,
    /// From which distance on the next skip is looked for, in mm.
    far_mm: f64,
    /// Where the log was near the path last, and the segment there.
    near: ([f64; 3], usize),
    /// The square of the least distance of each vertex from the steps in which it may be passed.
    vertex_off_2: Vec<f32>,
}

impl<'p> InOrder<'p> {
    pub(crate) fn new(path: &'p PartPath, first: &[f64; 3], leaves_rapids_out: bool) -> Self {
        let off_2 = squared_distance(first, &path.vertices[0]);
        let best =
            Way { segment: 0, share: 0.0, cost: 0.0, off_2, largest_2: off_2, skip: 0, is_young: false };
        let mut vertex_off_2 = vec![f32::INFINITY; path.vertices.len()];
        vertex_off_2[0] = as_f32(off_2);
        let mut own = Self {
            path,
            leaves_rapids_out,
            ways: vec![best],
            next: Vec::new(),
            best,
            skips: Vec::new(),
            searches: 0,
            given_up: GIVEN_UP,
            far_mm: FAR_MM,
            near: (*first, 0),
            vertex_off_2,
        };
        // A log that begins behind the begin of the path.
        own.step(first, first, 0.0);
        own
    }

    /// Follows a step of the log. Where rows are missing in it, vertices within `free_mm` of the path may be passed unseen.
    pub(crate) fn step(&mut self, from: &[f64; 3], to: &[f64; 3], free_mm: f64) -> Way {
        let mut bound = self.given_up.max(16.0 * self.best.off_2.powi(2));
        loop {
            self.advance(from, to, free_mm, bound);
            if !self.next.is_empty() {
                break;
            }
            bound *= 256.0;
        }
        std::mem::swap(&mut self.ways, &mut self.next);
        if self.ways.len() > ENOUGH_WAYS {
            self.given_up *= 0.5;
        } else if self.ways.len() < ENOUGH_WAYS / 2 {
            self.given_up = GIVEN_UP.min(2.0 * self.given_up);
        }
        self.settle();
        let off_mm = self.best.off_2.sqrt();
        if off_mm <= NEARER * FAR_MM * 0.1 {
            self.near = (*to, self.best.segment);
            self.far_mm = FAR_MM;
        } else if off_mm > self.far_mm && self.searches < MOST_SEARCHES {
            self.far_mm = 2.0 * off_mm;
            self.searches += 1;
            self.look_for_skips(to);
        }
        self.best
    }

    /// Finds the next ways.
    fn advance(&mut self, from: &[f64; 3], to: &[f64; 3], free_mm: f64, bound: f64) {
        let step = Line::new([*from, *to]);
        self.next.clear();
        let last = self.path.segments.len() - 1;
        // The best way that comes to the begin of the segment in this step.
        let mut entering: Option<Way> = None;
        let (mut index, mut segment, mut free_left) =
            (0, self.ways.first().map_or(0, |way| way.segment), free_mm);
        loop {
            let on_it = self.ways.get(index).filter(|way| way.segment == segment).copied();
            index += usize::from(on_it.is_some());
            if on_it.is_none() && entering.is_none() {
                let Some(way) = self.ways.get(index) else { break };
                segment = way.segment;
                continue;
            }
            let ends = self.path.ends(segment);
            let stays = on_it.map(|way| at(way, foot(to, &ends, way.share), segment));
            let enters = entering.map(|way| at(way, foot(to, &ends, 0.0), segment));
            if let Some(way) = better(stays, enters).filter(|way| way.is_young || way.cost <= bound) {
                self.next.push(way);
            }
            if segment == last {
                break;
            }
            let leaving = better(on_it, entering);
            entering = leaving.and_then(|way| {
                let off_2 = step.off_2(&ends[1]);
                let seen = &mut self.vertex_off_2[segment + 1];
                *seen = seen.min(as_f32(off_2));
                if free_left > 0.0 && on_it.is_none() {
                    free_left -= distance(&ends[0], &ends[1]);
                }
                let is_unseen = free_left > 0.0 || self.leaves_rapids_out && !self.path.is_feed(segment);
                let counted_2 = if is_unseen { 0.0 } else { off_2 };
                let cost = way.cost + counted_2 * counted_2;
                let largest_2 = way.largest_2.max(counted_2);
                // A young way is led on only while it is on its segment.
                (cost <= bound).then_some(Way { cost, largest_2, ..way })
            });
            segment += 1;
        }
    }

    /// Measures the sums from the best one.
    fn settle(&mut self) {
        let Some(best) = self.ways.iter().copied().min_by(|one, other| one.cost.total_cmp(&other.cost))
        else {
            return;
        };
        for way in &mut self.ways {
            way.cost -= best.cost;
            way.is_young &= way.cost > 0.0;
        }
        self.best = Way { cost: 0.0, is_young: false, ..best };
        if self.ways.len() > MOST_WAYS {
            self.ways.sort_by(|one, other| one.cost.total_cmp(&other.cost));
            self.ways.truncate(MOST_WAYS / 2);
            self.ways.sort_by_key(|way| way.segment);
        }
    }

    /// Begins ways that skip a part of the path: to the first places behind, in order, that are much nearer than where the best is.
    fn look_for_skips(&mut self, to: &[f64; 3]) {
        let (left_at, from) = self.near;
        let (near_2, mut found) = (NEARER * NEARER * self.best.off_2, 0);
        let (mut skipped_2, mut lowest): (f64, Option<(usize, f64, f64)>) = (0.0, None);
        let count = self.path.segments.len();
        for segment in from + 1..=count {
            let here = (segment < count).then(|| foot(to, &self.path.ends(segment), 0.0));
            match (here, lowest) {
                (Some((share, off_2)), known)
                    if off_2 <= near_2 && known.is_none_or(|(.., least)| off_2 < least) =>
                {
                    lowest = Some((segment, share, off_2));
                }
                // The lowest place of a part that is near.
                (_, Some((place, share, off_2))) => {
                    self.begin_skip(from, place, (share, off_2), skipped_2);
                    lowest = None;
                    found += 1;
                }
                _ => {}
            }
            if found >= MOST_SKIPS / 2 {
                break;
            }
            if segment < count {
                skipped_2 = skipped_2.max(squared_distance(&self.path.vertices[segment], &left_at));
            }
        }
        self.ways.sort_by_key(|way| way.segment);
    }

    fn begin_skip(&mut self, from: usize, to: usize, (share, off_2): (f64, f64), skipped_2: f64) {
        let has = self.ways.iter().any(|way| way.segment == to);
        let young = self.ways.iter().filter(|way| way.is_young).count();
        if has || young >= MOST_SKIPS {
            return;
        }
        let before = self.best.skip;
        self.skips.push(Skip { from, to, off_mm: skipped_2.sqrt(), before });
        self.ways.push(Way {
            segment: to,
            share,
            cost: skipped_2 * skipped_2,
            off_2,
            largest_2: self.best.largest_2.min(1e300).max(skipped_2),
            skip: self.skips.len(),
            is_young: true,
        });
    }

    /// The way that was followed, at the end of the log: what is left of the path counts by its distance from there.
    pub(crate) fn finished(&self, last: &[f64; 3]) -> Followed {
        let rest = |way: &Way| {
            let left = self.path.vertices.get(way.segment + 1..).unwrap_or_default();
            left.iter().map(|vertex| squared_distance(vertex, last)).fold(0.0, f64::max)
        };
        let total = |way: &Way| way.cost + rest(way).powi(2);
        let way = self.ways.iter().copied().min_by(|one, other| total(one).total_cmp(&total(other)));
        let way = way.unwrap_or(self.best);
        let mut skips = Vec::new();
        let mut next = way.skip;
        while let Some(skip) = next.checked_sub(1).and_then(|index| self.skips.get(index)) {
            skips.push(*skip);
            next = skip.before;
        }
        skips.reverse();
        let is_skipped = |vertex: usize| skips.iter().any(|skip| skip.from < vertex && vertex <= skip.to);
        // Rapid moves, and corners at which they begin or end, are nowhere cut.
        let is_cut =
            |vertex: usize| self.path.is_feed(vertex) && (vertex == 0 || self.path.is_feed(vertex - 1));
        let passed = self.vertex_off_2.iter().enumerate().take(way.segment + 1);
        let seen = passed.filter(|(vertex, _)| !is_skipped(*vertex) && is_cut(*vertex));
        let mut cuts = vec![Cut::default(); self.path.tolerances.count()];
        for (vertex, off_2) in seen.filter(|(_, off_2)| off_2.is_finite()) {
            // The move before a corner says how far it may be cut.
            let segment = vertex.saturating_sub(1);
            let cut = &mut cuts[self.path.tolerance(segment)];
            let off_mm = f64::from(*off_2).sqrt();
            if off_mm > cut.off_mm {
                *cut = Cut { off_mm, segment };
            }
        }
        let of_skips = skips.iter().map(|skip| skip.off_mm).fold(0.0, f64::max);
        let from_path_mm = cuts.iter().map(|cut| cut.off_mm).fold(of_skips, f64::max);
        Followed { way, skips, from_path_mm, cuts }
    }
}

/// How a log followed the path.
pub(crate) struct Followed {
    pub(crate) way: Way,
    pub(crate) skips: Vec<Skip>,
    /// The largest distance of the path from the log, in mm.
    pub(crate) from_path_mm: f64,
    /// The same under each tolerance by its number, of what is not skipped.
    pub(crate) cuts: Vec<Cut>,
}

/// The farthest place of the path from the log.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Cut {
    pub(crate) off_mm: f64,
    /// The segment that ends there.
    pub(crate) segment: usize,
}

/// A step of the log, from which vertices of the path are off.
struct Line {
    from: [f64; 3],
    way: [f64; 3],
    /// 1 by the square of its length; 0 of one that goes nowhere.
    per_length_2: f64,
}

impl Line {
    fn new([from, to]: [[f64; 3]; 2]) -> Self {
        let length_2 = squared_distance(&from, &to);
        let per_length_2 = if length_2 > 0.0 { length_2.recip() } else { 0.0 };
        Self { from, way: std::array::from_fn(|axis| to[axis] - from[axis]), per_length_2 }
    }

    /// The square of the distance of a point.
    fn off_2(&self, point: &[f64; 3]) -> f64 {
        let off: [f64; 3] = std::array::from_fn(|axis| point[axis] - self.from[axis]);
        let share = (dot(&off, &self.way) * self.per_length_2).clamp(0.0, 1.0);
        let off: [f64; 3] = std::array::from_fn(|axis| off[axis] - share * self.way[axis]);
        dot(&off, &off)
    }
}

/// A way that comes to a place of a segment.
fn at(way: Way, (share, off_2): (f64, f64), segment: usize) -> Way {
    let cost = way.cost + off_2 * off_2;
    Way { segment, share, cost, off_2, largest_2: way.largest_2.max(off_2), ..way }
}

/// The way of the lesser sum.
fn better(one: Option<Way>, other: Option<Way>) -> Option<Way> {
    match (one, other) {
        (Some(one), Some(other)) if other.cost < one.cost => Some(other),
        (Some(one), _) => Some(one),
        (None, other) => other,
    }
}

#[allow(
    clippy::cast_possible_truncation,
    reason = "a figure of seven digits is enough, and a part has many vertices"
)]
fn as_f32(x: f64) -> f32 {
    x as f32
}
