//! The nodes of the spline: even in planned time, closer where the feed or its limit changes fast, and one at each knot and joint.

use alloc::vec::Vec;

use nurbs_core::Differentiate;
use real::Real;

use crate::axes::cube_root::cube_root;
use crate::axes::spline::Spline;
use crate::axes::way::Way;
use crate::limits::AXES;

/// Cells for each change of the feed, or of its limit, by a factor e.
const CELLS_PER_E: f64 = 12.0;
/// No more nodes than these: a longer way keeps the plan that it has.
const MOST_NODES: usize = 200_000;
/// How much farther from a rest each place of the first profile is.
const FARTHER: f64 = 1.25;

/// `v²` and its limit along a way.
pub(crate) struct Profile {
    points: Vec<Point>,
}

#[derive(Clone, Copy, Debug)]
struct Point {
    distance: f64,
    square: f64,
    limit: f64,
}

/// Nodes from one rest to the next, and which piece of the way each cell is on.
#[derive(Clone, Debug)]
pub(crate) struct Grid {
    pub(crate) nodes: Vec<f64>,
    pub(crate) pieces: Vec<usize>,
}

impl Profile {
    /// A rough one: below the limit, with acceleration limited both ways.
    pub(crate) fn rough<const D: usize, C: Differentiate<f64, D>>(way: &Way<'_, C>, cell_time: f64) -> Self {
        let mut places: Vec<f64> = way.geometry.limit().points().map(|point| point.distance).collect();
        let rest = rest_width(way, way.begin, cell_time).min(rest_width(way, way.end, cell_time));
        let mut away = rest.max(way.length() * 1e-9);
        while away < 0.5 * way.length() {
            places.extend([way.begin + away, way.end - away]);
            away *= FARTHER;
        }
        let mut profile = Self::at(way, places, |_| f64::MAX);
        let mut bounds = Vec::with_capacity(profile.points.len());
        for point in &mut profile.points {
            let bend = way.bend(point.distance);
            point.square = point.limit;
            for (i, axis) in way.limits.axes.iter().enumerate() {
                if let Some(most) = axis.acceleration.filter(|most| bend.k[i].abs() * point.square > *most) {
                    point.square = most / bend.k[i].abs();
                }
                let cube = |square: f64| square * Real::sqrt(square);
                if let Some(most) = axis.jerk.filter(|most| bend.c[i].abs() * cube(point.square) > *most) {
                    let feed = cube_root(most / bend.c[i].abs());
                    point.square = feed * feed;
                }
            }
            let from_rest = (point.distance - way.begin).min(way.end - point.distance);
            let jerk = way.jerk_along(&bend);
            let feed = cube_root(4.5 * jerk * from_rest * from_rest);
            point.square = point.square.min(feed * feed);
            bounds.push(way.acceleration_along(&bend));
        }
        profile.accelerate(&bounds);
        profile
    }

    /// That of a solution on a grid, in units of `square`, at its nodes, between them, and where the limit has points.
    pub(crate) fn of<C>(way: &Way<'_, C>, grid: &Grid, x: &[f64], square: f64) -> Self {
        let mut places: Vec<f64> = way.geometry.limit().points().map(|point| point.distance).collect();
        places.extend(grid.nodes.windows(2).flat_map(|pair| [pair[0], 0.5 * (pair[0] + pair[1])]));
        let spline = Spline::new(&grid.nodes, x);
        Self::at(way, places, |distance| spline.at(distance).0 * square)
    }

    fn at<C>(way: &Way<'_, C>, mut places: Vec<f64>, square: impl Fn(f64) -> f64) -> Self {
        places.retain(|place| *place > way.begin && *place < way.end);
        places.sort_by(f64::total_cmp);
        places.dedup();
        let point = |distance: f64| {
            let feed = way.feed(distance);
            Point { distance, square: square(distance), limit: feed * feed }
        };
        Self { points: places.into_iter().map(point).collect() }
    }

    /// Lowers it to where 0.7 of these accelerations lead from point to point.
    fn accelerate(&mut self, bounds: &[f64]) {
        let points = &mut self.points;
        let rise = |from: &Point, to: &Point, bound: f64| 1.4 * bound * (to.distance - from.distance).abs();
        for i in 1..points.len() {
            let most = points[i - 1].square + rise(&points[i - 1], &points[i], bounds[i].min(bounds[i - 1]));
            points[i].square = points[i].square.min(most);
        }
        for i in (1..points.len()).rev() {
            let most = points[i].square + rise(&points[i], &points[i - 1], bounds[i].min(bounds[i - 1]));
            points[i - 1].square = points[i - 1].square.min(most);
        }
    }

    /// `v²` at a distance, linear between points.
    pub(crate) fn square(&self, distance: f64) -> f64 {
        let next = self.points.partition_point(|point| point.distance < distance);
        let (to, from) = (self.points.get(next), next.checked_sub(1).and_then(|i| self.points.get(i)));
        match (from, to) {
            (Some(from), Some(to)) => {
                let share = (distance - from.distance) / (to.distance - from.distance);
                from.square + share * (to.square - from.square)
            }
            (Some(only), None) | (None, Some(only)) => only.square,
            (None, None) => 0.0,
        }
    }

    /// How many cells are wanted from the first point up to each.
    fn measure(&self, cell_time: f64, per_e: f64) -> Vec<f64> {
        let mut sum = 0.0;
        let mut measure = Vec::from([0.0]);
        for pair in self.points.windows(2) {
            let (from, to) = (pair[0], pair[1]);
            let [v, w] = [from, to].map(|point| Real::sqrt(point.square));
            let change = |a: f64, b: f64| if a + b > 0.0 { 2.0 * (a - b).abs() / (a + b) } else { 0.0 };
            // Half of the logarithm of the square.
            let by_limit = 0.5 * change(from.limit, to.limit);
            let time = 2.0 * (to.distance - from.distance) / (v + w).max(1e-300);
            sum += time / cell_time + per_e * (change(v, w) + by_limit);
            measure.push(sum);
        }
        measure
    }
}

impl Grid {
    /// Cells that take `cell_time` in the profile, or less; `None` if there are too few or too many.
    pub(crate) fn new<const D: usize, C: Differentiate<f64, D>>(
        way: &Way<'_, C>,
        profile: &Profile,
        cell_time: f64,
        coarser: f64,
    ) -> Option<Self> {
        let measure = profile.measure(cell_time, CELLS_PER_E / coarser);
        let wanted = |distance: f64| {
            let next = profile.points.partition_point(|point| point.distance < distance);
            let Some(before) = next.checked_sub(1) else { return 0.0 };
            match (profile.points.get(before..=next), measure.get(before..=next)) {
                (Some([from, to]), Some([low, high])) => {
                    low + (high - low) * (distance - from.distance) / (to.distance - from.distance)
                }
                _ => measure.last().copied().unwrap_or_default(),
            }
        };
        let place = |wanted: f64| {
            let next = measure.partition_point(|sum| *sum < wanted);
            let before = next.checked_sub(1)?;
            match (profile.points.get(before..=next), measure.get(before..=next)) {
                (Some([from, to]), Some([low, high])) if high > low => {
                    Some(from.distance + (to.distance - from.distance) * (wanted - low) / (high - low))
                }
                _ => None,
            }
        };
        let (first, last) = (way.pieces.first()?, way.pieces.last()?);
        let start =
            way.begin + rest_width(way, way.begin, cell_time).min(0.5 * (first.end.min(way.end) - way.begin));
        let end =
            way.end - rest_width(way, way.end, cell_time).min(0.5 * (way.end - last.begin.max(way.begin)));
        let (mut nodes, mut pieces) = (Vec::from([way.begin, start]), Vec::from([0]));
        for (index, piece) in way.pieces.iter().enumerate() {
            let (from, to) = (piece.begin.max(start), piece.end.min(end));
            if !(to > from) {
                continue;
            }
            let (low, high) = (wanted(from), wanted(to));
            let mut count = 1.0;
            while count < high - low {
                count += 1.0;
            }
            let mut number = 1.0;
            while number < count && nodes.len() < MOST_NODES {
                let node = place(low + (high - low) * number / count);
                if let Some(node) = node.filter(|node| *node > *nodes.last().unwrap_or(&to) && *node < to) {
                    nodes.push(node);
                    pieces.push(index);
                }
                number += 1.0;
            }
            nodes.push(to);
            pieces.push(index);
        }
        nodes.push(way.end);
        pieces.push(way.pieces.len() - 1);
        let increases = nodes.windows(2).all(|pair| pair[1] > pair[0]);
        (increases && nodes.len() > 6 && nodes.len() < MOST_NODES).then_some(Self { nodes, pieces })
    }
}

/// The distance from rest after `cell_time`, at the jerk that is allowed there: `j t³/6`.
fn rest_width<const D: usize, C: Differentiate<f64, D>>(way: &Way<'_, C>, rest: f64, cell_time: f64) -> f64 {
    let bend = way.bend(rest);
    let jerk = way.jerk_along(&bend);
    let width = jerk * cell_time * cell_time * cell_time / 6.0;
    // The curvature and its change leave less of the jerk: 3 k v a + c v³ with v = j t²/2, a = j t.
    let feed = 0.5 * jerk * cell_time * cell_time;
    let turning = (0..AXES).filter_map(|i| {
        let most = way.limits.axes[i].jerk?;
        let by_bend = 3.0 * bend.k[i].abs() * feed * jerk * cell_time + bend.c[i].abs() * feed * feed * feed;
        Some(most / (by_bend + most))
    });
    width * turning.fold(1.0, f64::min)
}
