//! Contour error: the distance of the table from the curve, not from the setpoint of the same instant.
//!
//! A table that lags but stays on the curve cuts a good part. So each position is compared with the *nearest point* of
//! the path, its foot point:
//!
//! 1. The path is cut into cells, each so short that it bends little: no cell leaves its chord by more than 2 % of the
//!    chord's length.
//! 2. Along a run the foot point is searched near the last one: within an arc length of [`REACH`] times the largest
//!    distance that the triangle inequality allows. So the search does not jump to another branch where a path crosses
//!    itself, and it does get round a corner.
//! 3. Among the cells there, those whose chord is too far away are left out. In the others the foot point is the root
//!    of `g(u) = (C(u) - X)·C'(u)`. Newton's method finds it between bounds; where Newton fails, the interval is
//!    halved.
//! 4. A distance larger than the triangle inequality allows, `d_before + |X - X_before|`, proves that the nearest point
//!    was missed. Then the whole path is searched.
//!
//! The contour error is measured from the table to the path only. If the table never comes to a part of the path, for
//! example to the tip of a movement out and back on one line, this is not a contour error. If the table does not follow
//! at all, [`Arrival`](crate::Arrival) says so.

use nurbs_core::{Differentiate, Evaluate, distance_to_segment, nearest_on_segment};
use real::Real;

use crate::{ErrorSize, ServoError};

/// The arc length in which the next foot point is searched, in multiples of the largest possible distance. At a corner
/// of interior angle φ a foot point jumps by `2d/tan(φ/2)`: 16 serves corners down to 15°.
const REACH: f64 = 16.0;

/// A cell leaves its chord by at most this part of the chord's length: it turns by no more than about 10°.
const LARGEST_SAG: f64 = 0.02;

/// Finds the foot points of positions along a run. `curves` are followed in their order, as one path.
#[derive(Clone, Debug)]
pub struct ContourTracker<'a, C, const D: usize> {
    curves: &'a [C],
    cells: Vec<Cell<D>>,
    last: Foot,
    last_cell: usize,
    position: [f64; D],
}

/// The point of a path that is nearest to a position.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Foot {
    /// Index of the curve.
    pub curve: usize,
    /// Parameter on it.
    pub u: f64,
    /// Distance of the position from that point, in mm: the contour error.
    pub distance: f64,
}

/// A short stretch of a curve, within one span.
#[derive(Clone, Copy, Debug)]
struct Cell<const D: usize> {
    curve: usize,
    span: usize,
    /// Parameters of its ends.
    bounds: [f64; 2],
    /// Its ends.
    ends: [[f64; D]; 2],
    /// Length of its chord, in mm.
    chord: f64,
    /// The most by which it may leave its chord, in mm.
    sag: f64,
}

impl<'a, C: Differentiate<f64, D>, const D: usize> ContourTracker<'a, C, D> {
    /// A tracker at the start of the path.
    ///
    /// # Errors
    /// [`ServoError::PathEmpty`] if there is no curve, or one that has no length.
    pub fn try_new(curves: &'a [C]) -> Result<Self, ServoError> {
        let mut cells = Vec::new();
        for (index, curve) in curves.iter().enumerate() {
            let before = cells.len();
            for span in 0..curve.span_count() {
                add_span(curve, index, span, &mut cells);
            }
            if !cells[before..].iter().any(|cell: &Cell<D>| cell.chord > 0.0) {
                return Err(ServoError::PathEmpty);
            }
        }
        let first = cells.first().ok_or(ServoError::PathEmpty)?;
        let last = Foot { curve: first.curve, u: first.bounds[0], distance: 0.0 };
        let position = first.ends[0];
        Ok(Self { curves, cells, last, last_cell: 0, position })
    }

    /// The foot point of the next position of the run (mm).
    pub fn follow(&mut self, position: [f64; D]) -> Foot {
        // 1e-9 mm for the rounding of distances.
        let farthest = self.last.distance + distance(&position, &self.position) + 1e-9;
        let near = self.cells_within(REACH * farthest);
        let mut found = self.nearest_in(near, &position);
        if found.1.distance > farthest {
            found = self.nearest_in(0..self.cells.len(), &position);
        }
        (self.last_cell, self.last) = found;
        self.position = position;
        self.last
    }

    /// The cells up to an arc length `reach` from the last foot point's.
    fn cells_within(&self, reach: f64) -> core::ops::Range<usize> {
        let (before, after) = self.cells.split_at(self.last_cell);
        let count = |cells: &mut dyn Iterator<Item = &Cell<D>>| {
            let mut length = 0.0;
            cells
                .take_while(|cell| {
                    let within = length <= reach;
                    length += cell.chord;
                    within
                })
                .count()
        };
        // The foot point's own cell counts with no length, because the foot may be at either end.
        let back = count(&mut before.iter().rev());
        let ahead = count(&mut after.iter().skip(1));
        self.last_cell - back..(self.last_cell + 1 + ahead).min(self.cells.len())
    }

    fn nearest_in(&self, range: core::ops::Range<usize>, position: &[f64; D]) -> (usize, Foot) {
        let begin = range.start;
        let cells = &self.cells[range];
        let mut best =
            (begin, Foot { curve: cells[0].curve, u: cells[0].bounds[0], distance: f64::INFINITY });
        for (index, cell) in cells.iter().enumerate() {
            for (end, &u) in cell.ends.iter().zip(&cell.bounds) {
                let distance = distance(end, position);
                if distance < best.1.distance {
                    best = (begin + index, Foot { curve: cell.curve, u, distance });
                }
            }
        }
        for (index, cell) in cells.iter().enumerate() {
            if cell.distance_to_chord(position) - cell.sag <= best.1.distance {
                let foot = cell.foot(&self.curves[cell.curve], position);
                if foot.distance < best.1.distance {
                    best = (begin + index, foot);
                }
            }
        }
        best
    }
}

/// Contour error of a whole run: the largest and the root mean square of the distances of `positions` (mm) from the
/// path.
///
/// # Errors
/// [`ServoError::PathEmpty`].
pub fn contour_error<C: Differentiate<f64, D>, const D: usize>(
    curves: &[C],
    positions: impl IntoIterator<Item = [f64; D]>,
) -> Result<ErrorSize, ServoError> {
    let mut tracker = ContourTracker::try_new(curves)?;
    Ok(ErrorSize::of(positions.into_iter().map(|position| tracker.follow(position).distance)))
}

/// Cuts one span into cells.
fn add_span<C: Differentiate<f64, D>, const D: usize>(
    curve: &C,
    index: usize,
    span: usize,
    cells: &mut Vec<Cell<D>>,
) {
    /// Cells of a span before their bend is measured, so that no bend hides between samples.
    const FIRST_CUT: u32 = 16;
    let (from, to) = Evaluate::span_bounds(curve, span);
    let at = |part: u32| match part {
        FIRST_CUT => to,
        _ => from + (to - from) * f64::from(part) / f64::from(FIRST_CUT),
    };
    for part in 0..FIRST_CUT {
        add_cells(curve, (index, span), [at(part), at(part + 1)], 0, cells);
    }
}

/// Adds `bounds` as one cell, or halves it until it bends little enough.
fn add_cells<C: Differentiate<f64, D>, const D: usize>(
    curve: &C,
    place: (usize, usize),
    bounds: [f64; 2],
    depth: u32,
    cells: &mut Vec<Cell<D>>,
) {
    /// A cusp stays sharp however often it is halved; after so many halvings a cell is 1e-5 of a span.
    const DEEPEST: u32 = 12;
    let (curve_index, span) = place;
    let point = |part: f64| curve.derivatives_in(span, bounds[0] + (bounds[1] - bounds[0]) * part).point;
    let ends = [point(0.0), point(1.0)];
    let chord = distance(&ends[0], &ends[1]);
    let off = [0.25, 0.5, 0.75].map(|part| distance_to_segment(&point(part), &ends));
    let largest = off.into_iter().fold(0.0, f64::max);
    // Three samples of a shallow arch find all but a tenth of its height; a margin of one half is safe.
    let sag = 1.5 * largest;
    if largest > LARGEST_SAG * chord && depth < DEEPEST {
        let middle = bounds[0] + (bounds[1] - bounds[0]) / 2.0;
        add_cells(curve, place, [bounds[0], middle], depth + 1, cells);
        add_cells(curve, place, [middle, bounds[1]], depth + 1, cells);
    } else {
        cells.push(Cell { curve: curve_index, span, bounds, ends, chord, sag });
    }
}

impl<const D: usize> Cell<D> {
    fn distance_to_chord(&self, position: &[f64; D]) -> f64 {
        distance_to_segment(position, &self.ends)
    }

    /// The root of g between the ends. Without a root, the end towards which g points.
    fn foot<C: Differentiate<f64, D>>(&self, curve: &C, position: &[f64; D]) -> Foot {
        /// So many halvings alone would find a root to 2⁻⁵⁰ of the cell.
        const MOST: u32 = 50;
        let [mut low, mut high] = self.bounds;
        let (mut low_tried, mut high_tried) = (false, false);
        let mut u = low + (high - low) * nearest_on_segment(position, &self.ends);
        let mut foot = Foot { curve: self.curve, u, distance: f64::INFINITY };
        for _ in 0..MOST {
            let d = curve.derivatives_in(self.span, u);
            let arm: [f64; D] = core::array::from_fn(|i| d.point[i] - position[i]);
            foot = Foot { curve: self.curve, u, distance: f64::norm(&arm) };
            let slope = dot(&arm, &d.first);
            if slope > 0.0 {
                (high, high_tried) = (u, true);
            } else {
                (low, low_tried) = (u, true);
            }
            let speed_squared = dot(&d.first, &d.first);
            let newton = (u - slope / (speed_squared + dot(&arm, &d.second))).clamp(low, high);
            let tried = (newton == low && low_tried) || (newton == high && high_tried);
            let next = if tried || newton.is_nan() { low + (high - low) / 2.0 } else { newton };
            // A step of 1e-10 mm along the curve changes the distance by no more than that.
            if low >= high || (next - u).abs() * speed_squared.sqrt() <= 1e-10 {
                break;
            }
            u = next;
        }
        foot
    }
}

fn dot<const D: usize>(a: &[f64; D], b: &[f64; D]) -> f64 {
    f64::sum_of_products(a.iter().copied().zip(b.iter().copied()))
}

pub(crate) fn distance<const D: usize>(a: &[f64; D], b: &[f64; D]) -> f64 {
    f64::norm(&core::array::from_fn::<_, D, _>(|i| a[i] - b[i]))
}

#[cfg(test)]
mod tests {
    use super::*;
    use nurbs_core::golden::{circle, seed_000, seed_003};
    use proptest::prelude::*;

    /// The unit vector across the curve at `u`, and the point there.
    fn across(curve: &nurbs_core::NurbsCurve<'_, f64, 2>, u: f64) -> ([f64; 2], [f64; 2]) {
        let d = curve.derivatives(u);
        let speed = f64::norm(&d.first);
        (d.point, [-d.first[1] / speed, d.first[0] / speed])
    }

    #[test]
    fn points_beside_a_curve_are_as_far_as_they_were_put() {
        // The smallest radius of paper A's curve is 24.757 mm: within it the foot point of C + d·n is C, at distance |d|.
        let curve = seed_000();
        let curves = [curve.as_curve()];
        for offset in [0.0, 1e-6, -1e-3, 0.5, -5.0] {
            let mut tracker = ContourTracker::try_new(&curves).unwrap();
            for k in 0..=2000 {
                let u = f64::from(k) / 2000.0;
                let (point, normal) = across(&curves[0], u);
                let foot = tracker.follow([0, 1].map(|i| point[i] + offset * normal[i]));
                assert!((foot.distance - offset.abs()).abs() < 1e-9, "u={u}: {foot:?} for {offset}");
                assert!((foot.u - u).abs() < 1e-9, "u={u}: {foot:?}");
            }
        }
    }

    #[test]
    fn lag_along_the_curve_is_no_contour_error() {
        let curve = seed_003();
        let curves = [curve.as_curve()];
        let behind = (0..=5000).map(|k| curves[0].point((f64::from(k) / 5000.0 - 0.02).max(0.0)));
        let size = contour_error(&curves, behind).unwrap();
        assert!(size.max < 1e-9, "{size:?}");
    }

    #[test]
    fn a_crossing_does_not_catch_the_foot_point() {
        // Paper A's curve passes (150, 150) at u = 0, 0.5 and 1. A tool 0.2 mm off the first pass, going out and on, must
        // still be judged by the branch it is on.
        let curve = seed_000();
        let curves = [curve.as_curve()];
        let mut tracker = ContourTracker::try_new(&curves).unwrap();
        let mut before = 0.0;
        for k in 0..=4000 {
            let u = f64::from(k) / 4000.0;
            let (point, normal) = across(&curves[0], u);
            let foot = tracker.follow([0, 1].map(|i| point[i] + 0.2 * normal[i]));
            assert!(foot.u >= before - 1e-9 && foot.u - before < 1e-3, "u={u}: {foot:?}");
            before = foot.u;
        }
    }

    #[test]
    fn a_tool_that_rounds_a_corner_is_measured_on_both_sides() {
        // A right angle at (10, 0), cut on an arc of 1 mm: the arc is 1 - 1/√2 from... each leg at its middle, for
        // the nearest leg is as far as the arc's point is below it: 1 - sin 45°.
        let leg = |from: [f64; 2], to: [f64; 2]| {
            nurbs_core::NurbsBuf::try_new_nonrational(1, vec![from, to], vec![0.0, 0.0, 1.0, 1.0]).unwrap()
        };
        let legs = [leg([0.0, 0.0], [10.0, 0.0]), leg([10.0, 0.0], [10.0, 10.0])];
        let curves = legs.each_ref().map(|leg| leg.as_curve());
        let straight = (0..900).map(|k| [f64::from(k) / 100.0, 0.0]);
        let arc = (0..=100).map(|k| {
            let angle = std::f64::consts::FRAC_PI_2 * f64::from(k) / 100.0;
            [9.0 + angle.sin(), 1.0 - angle.cos()]
        });
        let up = (100..1000).map(|k| [10.0, f64::from(k) / 100.0]);
        let mut tracker = ContourTracker::try_new(&curves).unwrap();
        let feet: Vec<Foot> = straight.chain(arc).chain(up).map(|x| tracker.follow(x)).collect();
        let largest = feet.iter().map(|foot| foot.distance).fold(0.0, f64::max);
        assert!((largest - (1.0 - 0.5_f64.sqrt())).abs() < 1e-9, "{largest}");
        assert!(feet.last().is_some_and(|foot| foot.curve == 1 && foot.distance < 1e-12));
    }

    #[test]
    fn a_hairpin_of_twenty_degrees_is_left_behind() {
        let tip = [100.0, 0.0];
        let (sin, cos) = 20.0_f64.to_radians().sin_cos();
        let back = [100.0 - 50.0 * cos, 50.0 * sin];
        let points = vec![[0.0, 0.0], tip, back];
        let path =
            nurbs_core::NurbsBuf::try_new_nonrational(1, points, vec![0.0, 0.0, 0.5, 1.0, 1.0]).unwrap();
        let curves = [path.as_curve()];
        // The tool turns 1 mm before the tip.
        let out = (0..=99).map(|k| [f64::from(k), 0.0]);
        let home = (5..=50).map(|k| [100.0 - f64::from(k) * cos, f64::from(k) * sin]);
        let mut tracker = ContourTracker::try_new(&curves).unwrap();
        let last = out.chain(home).map(|x| tracker.follow(x)).last().unwrap();
        assert!(last.distance < 1e-9 && last.u > 0.99, "{last:?}");
    }

    #[test]
    fn a_jump_is_searched_for_on_the_whole_path() {
        // From the start of the circle to near its opposite side in one step: the local search, wide as it is here,
        // may fail; the distance must not.
        let circle = circle(10.0);
        let curves = [circle.as_curve()];
        let mut tracker = ContourTracker::try_new(&curves).unwrap();
        for position in [[10.0, 0.0], [-10.5, 0.1], [9.0, 0.2], [0.3, -9.9], [0.0, 0.1]] {
            let expected = (10.0 - f64::norm(&position)).abs();
            let found = tracker.follow(position).distance;
            assert!((found - expected).abs() < 1e-9, "{position:?}: {found} {expected}");
        }
    }

    #[test]
    fn a_path_without_length_is_refused() {
        let none: [nurbs_core::NurbsCurve<'_, f64, 2>; 0] = [];
        assert_eq!(ContourTracker::try_new(&none).unwrap_err(), ServoError::PathEmpty);
    }

    proptest! {
        /// Against a search by brute force: no sample of the curve is nearer, and for a position on a walk along the
        /// curve some sample is as near.
        #[test]
        fn no_point_of_the_curve_is_nearer(offsets in prop::collection::vec(-2.0..2.0_f64, 40)) {
            let curve = seed_003();
            let curves = [curve.as_curve()];
            let samples: Vec<[f64; 2]> =
                (0..=20_000).map(|k| curves[0].point(f64::from(k) / 20_000.0)).collect();
            let mut tracker = ContourTracker::try_new(&curves).unwrap();
            let count = offsets.len() as f64;
            for (k, offset) in offsets.into_iter().enumerate() {
                let (point, normal) = across(&curves[0], k as f64 / count);
                let position = [0, 1].map(|i| point[i] + offset * normal[i]);
                let found = tracker.follow(position).distance;
                let nearest = samples.iter().map(|p| distance(p, &position)).fold(f64::INFINITY, f64::min);
                prop_assert!(found <= nearest + 1e-9, "{position:?}: {found} {nearest}");
                prop_assert!(found >= nearest - 1e-2, "{position:?}: {found} {nearest}");
            }
        }
    }
}
