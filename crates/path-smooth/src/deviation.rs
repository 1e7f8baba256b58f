//! The distance of one path from another. It is measured by sampling, on curves or on the fine straight moves of a
//! program as they read back, whatever made them.
//!
//! Nothing here depends on how a corner was smoothed. The module only knows between which moves a curve lies, so that a
//! distance is measured to the moves nearby and not to another outline that happens to pass there.

use nurbs_core::{CurveError, Evaluate, NurbsBuf, distance_to_segment, golden_section};
use part_program::Curve;

use crate::stretch::length;

/// Samples of a span that is not straight; the distance between two samples is refined.
const SAMPLES: u32 = 64;
/// Samples of a straight move, without its ends.
const STRAIGHT_SAMPLES: u32 = 8;
/// Golden sections of a refinement. Each leaves 0.618 of the range, all together 3e-8 of three sample widths. For a
/// point on the curve the error of the distance is of that order; for other points it is of second order.
const SECTIONS: usize = 36;
/// Sides of the polygon through the samples that are looked at together: those of which the box is farther off than another side are not.
const SIDES: usize = 8;
/// A curve is compared with this many moves before its own and this many after it.
const NEAR: usize = 3;

/// A curve to which distances are measured.
pub(crate) struct Track {
    curve: NurbsBuf<f64, 3>,
    /// Parameters and points.
    samples: Vec<(f64, [f64; 3])>,
    is_straight: bool,
    /// The box of the curve's control points, in which it lies.
    around: Box3,
    /// The boxes of each [`SIDES`] sides of the polygon through the samples.
    boxes: Vec<Box3>,
}

/// The least box with sides along the axes in which some points lie.
struct Box3 {
    low: [f64; 3],
    high: [f64; 3],
}

impl Box3 {
    fn around<'a>(points: impl Iterator<Item = &'a [f64; 3]> + Clone) -> Self {
        let over = |pick: fn(f64, f64) -> f64| {
            std::array::from_fn(|d| points.clone().map(|p| p[d]).reduce(pick).unwrap_or(0.0))
        };
        Self { low: over(f64::min), high: over(f64::max) }
    }

    /// The distance from a point to the nearest one inside.
    fn distance(&self, point: &[f64; 3]) -> f64 {
        let outside = |d: usize| (self.low[d] - point[d]).max(point[d] - self.high[d]).max(0.0);
        length(&std::array::from_fn(outside))
    }
}

impl Track {
    pub(crate) fn new(curve: &Curve) -> Result<Self, CurveError> {
        let nurbs = curve.for_evaluation()?;
        let is_straight = curve.degree() == 1 && curve.control_points_mm().len() == 2;
        let count = if is_straight { STRAIGHT_SAMPLES } else { SAMPLES };
        let evaluated = nurbs.as_curve();
        let mut samples = Vec::new();
        for span in 0..evaluated.span_count() {
            let (begin, end) = evaluated.span_bounds(span);
            for step in u32::from(span > 0)..=count {
                let share = f64::from(step) / f64::from(count);
                let u = begin * (1.0 - share) + end * share;
                samples.push((u, evaluated.point(u)));
            }
        }
        let around = Box3::around(curve.control_points_mm().iter());
        let points: Vec<_> = samples.iter().map(|(_, point)| *point).collect();
        let boxes = (0..points.len().saturating_sub(1)).step_by(SIDES);
        let boxes = boxes.map(|first| Box3::around(points.iter().skip(first).take(SIDES + 1))).collect();
        Ok(Self { curve: nurbs, samples, is_straight, around, boxes })
    }

    /// The distance from `point` to the curve, or `limit` if that is less.
    pub(crate) fn distance_below(&self, point: &[f64; 3], limit: f64) -> f64 {
        let Some((nearest, distance)) = self.nearest_side(point, limit) else { return limit };
        if self.is_straight {
            return distance.min(limit);
        }
        let at = |index: usize| self.samples[index.min(self.samples.len() - 1)].0;
        self.refined(point, at(nearest.saturating_sub(1)), at(nearest + 2)).min(limit)
    }

    /// Connects the samples to a polygon. Returns the polygon's side nearest to `point`, with its distance; `None` if
    /// the curve is not nearer than `limit`.
    fn nearest_side(&self, point: &[f64; 3], limit: f64) -> Option<(usize, f64)> {
        if self.around.distance(point) >= limit {
            return None;
        }
        let distances: Vec<f64> = self.boxes.iter().map(|sides| sides.distance(point)).collect();
        let first = (0..distances.len()).min_by(|a, b| distances[*a].total_cmp(&distances[*b]))?;
        let others = (0..distances.len()).filter(|other| *other != first);
        std::iter::once(first).chain(others).fold(None, |nearest, group| {
            let may_be_nearer = nearest.is_none_or(|(_, distance)| distances[group] <= distance);
            let sides = self.samples.windows(2).enumerate().skip(group * SIDES).take(SIDES);
            let sides = sides.filter(|_| may_be_nearer);
            let sides =
                sides.map(|(index, ends)| (index, distance_to_segment(point, &[ends[0].1, ends[1].1])));
            // Of equally near sides the first.
            sides.chain(nearest).min_by(|a, b| a.1.total_cmp(&b.1).then(a.0.cmp(&b.0)))
        })
    }

    /// The least distance over [from, to], both ends included.
    fn refined(&self, point: &[f64; 3], from: f64, to: f64) -> f64 {
        let curve = self.curve.as_curve();
        let distance = |u: f64| {
            let on = curve.point(u);
            length(&std::array::from_fn(|d| on[d] - point[d]))
        };
        let inside = golden_section((from, to), SECTIONS, distance, |distance| *distance);
        inside.found.min(distance(from)).min(distance(to))
    }
}

/// Two versions of a path. Each curve of the second belongs to a move of the first.
pub(crate) struct Paths<'p> {
    moves: Vec<Track>,
    curves: Vec<Track>,
    move_of: &'p [usize],
}

impl<'p> Paths<'p> {
    /// `move_of` must not decrease.
    pub(crate) fn new(moves: &[Curve], curves: &[Curve], move_of: &'p [usize]) -> Result<Self, CurveError> {
        let tracks = |curves: &[Curve]| curves.iter().map(Track::new).collect::<Result<_, _>>();
        Ok(Self { moves: tracks(moves)?, curves: tracks(curves)?, move_of })
    }

    /// Distance from a point of curve `curve` to the moves around its own.
    pub(crate) fn to_moves(&self, curve: usize, point: &[f64; 3]) -> f64 {
        let own = self.move_of.get(curve).copied().unwrap_or(0);
        let near = own.saturating_sub(NEAR)..(own + NEAR + 1).min(self.moves.len());
        least_distance(&self.moves[near], point)
    }

    /// Distance from a point of move `index` to the curves around it.
    pub(crate) fn to_curves(&self, index: usize, point: &[f64; 3]) -> f64 {
        let begin = self.move_of.partition_point(|own| own + NEAR < index);
        let end = self.move_of.partition_point(|own| *own <= index + NEAR);
        least_distance(&self.curves[begin..end], point)
    }

    /// Distance of a chord from the curves that it passes, from a point of curve `from` to one of curve `to`: the
    /// largest of the distances at its quarters.
    pub(crate) fn chord_to_curves(&self, (from, to): (usize, usize), ends: [&[f64; 3]; 2]) -> f64 {
        let passed = self.curves.get(from..=to).unwrap_or_default();
        let distance = |share: f64| {
            let point = std::array::from_fn(|d| ends[0][d] + share * (ends[1][d] - ends[0][d]));
            least_distance(passed, &point)
        };
        [0.25, 0.5, 0.75].into_iter().map(distance).fold(0.0, f64::max)
    }

    /// For each curve the largest distance of its points from the moves.
    pub(crate) fn of_curves(&self) -> Vec<f64> {
        let of = |(index, track): (usize, &Track)| {
            track.samples.iter().map(|(_, point)| self.to_moves(index, point)).fold(0.0, f64::max)
        };
        self.curves.iter().enumerate().map(of).collect()
    }

    /// The largest distance of the points of the moves from the curves.
    pub(crate) fn of_moves(&self) -> f64 {
        let of = |(index, track): (usize, &Track)| {
            track.samples.iter().map(|(_, point)| self.to_curves(index, point)).fold(0.0, f64::max)
        };
        self.moves.iter().enumerate().map(of).fold(0.0, f64::max)
    }
}

fn least_distance(tracks: &[Track], point: &[f64; 3]) -> f64 {
    // Straight tracks come first: they take little time, and most points lie on one.
    let kind = |straight: bool| tracks.iter().filter(move |track| track.is_straight == straight);
    kind(true).chain(kind(false)).fold(f64::INFINITY, |least, track| track.distance_below(point, least))
}

#[cfg(test)]
mod tests {
    use part_program::Nurbs;

    use super::*;

    fn line(a: [f64; 3], b: [f64; 3]) -> Curve {
        let (weights, knots) = (vec![1.0; 2], vec![0., 0., 1., 1.]);
        Nurbs { degree: 1, control_points_mm: vec![a, b], dimension: 2, weights, knots }.into()
    }

    #[test]
    fn distances_to_a_circle_and_a_line_are_known() {
        let program = "G1 X5 Y0 F60\nG3 X-5 Y0 I-5 J0\n";
        let part = part_program::read_part("p.nc", program).unwrap();
        let half = Track::new(part.curves.last().unwrap()).unwrap();
        for (point, expected) in [
            ([0.0, 0.0, 0.0], 5.0),
            ([3.0, 4.0, 0.0], 0.0),
            ([6.0, 8.0, 0.0], 5.0),
            ([0.3, 0.4, 2.0], 4.5_f64.hypot(2.0)),
            ([7.0, -1.0, 0.0], 5.0_f64.sqrt()),
        ] {
            let found = half.distance_below(&point, f64::INFINITY);
            assert!((found - expected).abs() < 1e-8, "{point:?}: {found}");
        }
        assert_eq!(half.distance_below(&[20.0, 0.0, 0.0], 3.0), 3.0);
        let side = Track::new(&line([0.0; 3], [10.0, 0.0, 0.0])).unwrap();
        assert_eq!(side.distance_below(&[4.0, 3.0, 4.0], 9.0), 5.0);
        assert_eq!(side.distance_below(&[13.0, 4.0, 0.0], 9.0), 5.0);
    }

    #[test]
    fn a_path_that_leaves_out_a_corner_is_found_out() {
        let moves = [line([0.0; 3], [10.0, 0.0, 0.0]), line([10.0, 0.0, 0.0], [10.0, 10.0, 0.0])];
        let short = [
            line([0.0; 3], [9.0, 0.0, 0.0]),
            line([9.0, 0.0, 0.0], [10.0, 1.0, 0.0]),
            line([10.0, 1.0, 0.0], [10.0, 10.0, 0.0]),
        ];
        let paths = Paths::new(&moves, &short, &[0, 0, 1]).unwrap();
        let off = paths.of_curves();
        assert!(off[0] == 0.0 && (off[1] - 0.5).abs() < 1e-12 && off[2] == 0.0, "{off:?}");
        // The corner itself is √½ from the short cut.
        assert!((paths.of_moves() - 0.5_f64.sqrt()).abs() < 1e-12);
    }

    #[test]
    fn the_chord_error_on_an_arc_is_its_sagitta() {
        // The error is far less than the sagitta of the samples, which are 2.8 degrees apart.
        let part = part_program::read_part("p.nc", "G1 X50 Y0 F60\nG3 X-50 Y0 I-50 J0\n").unwrap();
        let arc = part.curves.last().unwrap().clone();
        let paths = Paths::new(&part.curves, &[arc], &[1]).unwrap();
        let at = |angle: f64| [50.0 * angle.cos(), 50.0 * angle.sin(), 0.0];
        for begin in [0.0, 0.013, 1.3] {
            let found = paths.chord_to_curves((0, 0), [&at(begin), &at(begin + 0.01)]);
            let sagitta = 50.0 * (1.0 - 0.005_f64.cos());
            assert!((found - sagitta).abs() < 1e-7 * sagitta, "{found} for {sagitta}");
        }
    }
}
