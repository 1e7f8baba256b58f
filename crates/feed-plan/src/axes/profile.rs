//! `v²` along a way and the limit of it, and how many cells it is worth to be close to it.
//!
//! Where a way is straight and its limit level, and the feed is at that limit, nothing changes, however long it takes; where a curve is
//! passed so slowly that its bend takes little of any acceleration and jerk, hardly anything does. So a cell is a period long, or what
//! else is asked for, where something changes, and longer in proportion to the time from there, as long as the way turns little over it.

use alloc::vec::Vec;

use nurbs_core::Differentiate;
use real::Real;

use crate::axes::spline::Spline;
use crate::axes::way::Way;
use crate::cube_root::cube_root;
use crate::limits::AXES;

/// How much farther from a rest each place of the first profile is.
const FARTHER: f64 = 1.25;
/// How much farther from the ends of an even stretch each place between them is.
const DIVISION: f64 = 1.5;
/// By how much a cell grows for the time from where something changes.
const GROWTH: f64 = 0.25;
/// The most that is taken of any acceleration and jerk where hardly anything changes.
const CALM: f64 = 0.125;
/// The most that the way turns over a cell that is longer than asked for, radians.
const TURN: f64 = 0.05;
/// By how much more cells a change of the limit takes where cells are longer than asked for.
const CLOSER: f64 = 20.0;
/// Share of its limit that `v²` may be below it where the feed is at the limit.
const AT_LIMIT: f64 = 0.02;

/// `v²` and its limit along a way.
pub(crate) struct Profile {
    pub(crate) points: Vec<Point>,
}

#[derive(Clone, Copy, Debug)]
pub(crate) struct Point {
    pub(crate) distance: f64,
    square: f64,
    limit: f64,
    /// The limit of the stretch that leads there, squared, and its curvature, if that is calm.
    calm: Option<(f64, f64)>,
}

impl Profile {
    /// A rough one: below the limit, with acceleration limited both ways.
    pub(crate) fn rough<const D: usize, C: Differentiate<f64, D>>(way: &Way<'_, C>, cell_time: f64) -> Self {
        let mut places: Vec<f64> = limit_places(way).collect();
        let rest = rest_width(way, way.begin, cell_time).min(rest_width(way, way.end, cell_time));
        let mut away = rest.max(way.length() * 1e-9);
        while away < 0.5 * way.length() {
            places.extend([way.begin + away, way.end - away]);
            away *= FARTHER;
        }
        let mut profile = Self::at(way, places, cell_time, |_| f64::MAX);
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

    /// That of a solution on a grid with these nodes, in units of `square`, at the nodes, between them, and where the limit has points.
    pub(crate) fn of<const D: usize, C: Differentiate<f64, D>>(
        way: &Way<'_, C>,
        nodes: &[f64],
        x: &[f64],
        square: f64,
        cell_time: f64,
    ) -> Self {
        let between = nodes.windows(2).flat_map(|pair| [pair[0], 0.5 * (pair[0] + pair[1])]);
        let places = limit_places(way).chain(between).collect();
        let spline = Spline::new(nodes, x);
        Self::at(way, places, cell_time, |distance| spline.at(distance).0 * square)
    }

    fn at<const D: usize, C: Differentiate<f64, D>>(
        way: &Way<'_, C>,
        mut places: Vec<f64>,
        cell_time: f64,
        square: impl Fn(f64) -> f64,
    ) -> Self {
        places.retain(|place| *place > way.begin && *place < way.end);
        places.sort_by(f64::total_cmp);
        places.dedup();
        let mut points = Vec::with_capacity(places.len());
        let mut push = |distance: f64, calm: Option<(f64, f64)>| {
            let feed = way.feed(distance);
            let calm = calm.map(|(feed, curvature)| (feed * feed, curvature));
            points.push(Point { distance, square: square(distance), limit: feed * feed, calm });
        };
        for (i, place) in places.iter().enumerate() {
            let before = i.checked_sub(1).and_then(|before| places.get(before));
            let calm = before.and_then(|from| way.calm(*from, *place, CALM));
            if let (Some(from), Some((feed, _))) = (before, calm) {
                divisions(*from, *place, feed * cell_time).for_each(|place| push(place, calm));
            }
            push(*place, calm);
        }
        Self { points }
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
    pub(crate) fn measure(&self, cell_time: f64, per_e: f64) -> Vec<f64> {
        let apart = self.apart();
        let mut sum = 0.0;
        let mut measure = Vec::from([0.0]);
        for (pair, apart) in self.points.windows(2).zip(apart.windows(2)) {
            let (from, to) = (pair[0], pair[1]);
            let [v, w] = [from, to].map(|point| Real::sqrt(point.square));
            let change = |a: f64, b: f64| if a + b > 0.0 { 2.0 * (a - b).abs() / (a + b) } else { 0.0 };
            // Half of the logarithm of the square.
            let by_limit = 0.5 * change(from.limit, to.limit);
            let by_turn = to.calm.map_or(0.0, |(limit, curvature)| TURN / (curvature * Real::sqrt(limit)));
            let wider = (GROWTH * 0.5 * (apart[0] + apart[1])).min(by_turn);
            // A cell that is wider than asked for must not leap over a dip of the limit.
            let closer = if wider > cell_time { CLOSER } else { 1.0 };
            sum += duration(&from, &to) / (cell_time + wider) + per_e * (change(v, w) + closer * by_limit);
            measure.push(sum);
        }
        measure
    }

    /// The time from each point to the nearest stretch that is not at the limit of a calm way.
    fn apart(&self) -> Vec<f64> {
        let points = &self.points;
        let mut apart = alloc::vec![f64::MAX; points.len()];
        let is_calm = |from: &Point, to: &Point| {
            to.calm.is_some_and(|(limit, _)| from.square.min(to.square) >= (1.0 - AT_LIMIT) * limit)
        };
        let mut reach = |from: usize, to: usize| {
            let (a, b) = (from.min(to), from.max(to));
            if is_calm(&points[a], &points[b]) {
                apart[to] = apart[to].min(apart[from] + duration(&points[a], &points[b]));
            } else {
                (apart[from], apart[to]) = (0.0, 0.0);
            }
        };
        (1..points.len()).for_each(|i| reach(i - 1, i));
        (1..points.len()).rev().for_each(|i| reach(i, i - 1));
        apart
    }
}

/// The time between two points.
fn duration(from: &Point, to: &Point) -> f64 {
    let feeds = Real::sqrt(from.square) + Real::sqrt(to.square);
    2.0 * (to.distance - from.distance) / feeds.max(1e-300)
}

/// Where the limit has points along a way.
fn limit_places<'a, C>(way: &'a Way<'_, C>) -> impl Iterator<Item = f64> + 'a {
    way.geometry.limit().samples_between(way.begin, way.end).iter().map(|sample| sample.point.distance)
}

/// Places between two that are many cells of this width apart, further and further from both, in order.
fn divisions(from: f64, to: f64, cell: f64) -> impl Iterator<Item = f64> {
    let middle = 0.5 * (to - from);
    let far = move |place: &f64| Some(place * DIVISION);
    let steps = core::iter::successors(Some(2.0 * cell), far).take_while(move |far| *far < middle);
    let steps: Vec<f64> = steps.collect();
    let back: Vec<f64> = steps.iter().rev().map(|far| to - far).collect();
    steps.into_iter().map(move |far| from + far).chain(back)
}

/// The distance from rest after `cell_time`, at the jerk that is allowed there: `j t³/6`.
pub(crate) fn rest_width<const D: usize, C: Differentiate<f64, D>>(
    way: &Way<'_, C>,
    rest: f64,
    cell_time: f64,
) -> f64 {
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
