//! The bounding box of curves.
//!
//! The polygon of the control points encloses a curve, and may be much larger than it. If the polygon of a Bézier piece
//! reaches beyond the known extent of the curve, the piece is halved. Each halving brings the polygon four times as
//! near to the curve, and nearly all halves are then inside.

use crate::bezier::{self, Bezier};
use crate::curve::Curve;

/// Distance of the bounds from the curves, as a share of the extent of the control points.
const ACCURACY: f64 = 1e-9;
/// Most halvings of one piece. Each yields at least a bit, and a number has 53.
const MAX_HALVINGS: u32 = 60;

/// Least and greatest coordinates of curves that obey every rule, in mm; `None` without curves.
///
/// They are coordinates of points of the curves. Each is inside of the exact bound by at most 1e-9 of the greatest
/// extent of the control points along an axis.
#[must_use]
pub fn bounding_box_mm<'c>(
    curves: impl IntoIterator<Item = &'c Curve, IntoIter: Clone>,
) -> Option<([f64; 3], [f64; 3])> {
    let curves = curves.into_iter();
    let mut points = curves.clone().flat_map(|curve| curve.control_points_mm());
    let polygon = points.next().map(|first| points.fold(Bounds::of(*first), Bounds::with))?;
    let extent = (0..3).map(|axis| polygon.most[axis] - polygon.least[axis]).fold(0.0, f64::max);
    let mut ends = curves.clone().flat_map(|curve| {
        let points = curve.control_points_mm();
        points.first().into_iter().chain(points.last())
    });
    let mut seen = ends.next().map(|first| ends.fold(Bounds::of(*first), Bounds::with))?;
    for curve in curves {
        if curve.degree() == 1 {
            seen = curve.control_points_mm().iter().fold(seen, Bounds::with);
        } else if seen.is_left_by(curve.control_points_mm(), ACCURACY * extent) {
            for piece in bezier::pieces(curve) {
                seen.widen(&piece, ACCURACY * extent, MAX_HALVINGS);
            }
        }
    }
    Some((seen.least, seen.most))
}

#[derive(Clone, Copy)]
struct Bounds {
    least: [f64; 3],
    most: [f64; 3],
}

impl Bounds {
    fn of(point: [f64; 3]) -> Self {
        Self { least: point, most: point }
    }

    fn with(self, point: &[f64; 3]) -> Self {
        Self {
            least: std::array::from_fn(|axis| self.least[axis].min(point[axis])),
            most: std::array::from_fn(|axis| self.most[axis].max(point[axis])),
        }
    }

    /// Whether one of the points is further outside than `tolerance`.
    fn is_left_by(&self, points: &[[f64; 3]], tolerance: f64) -> bool {
        let leaves = |point: &[f64; 3]| {
            (0..3).any(|axis| {
                point[axis] < self.least[axis] - tolerance || point[axis] > self.most[axis] + tolerance
            })
        };
        points.iter().any(leaves)
    }

    /// Extends the bounds by a piece; parts that are outside by no more than `tolerance` are left out.
    fn widen(&mut self, piece: &Bezier, tolerance: f64, most_halvings: u32) {
        let points = piece.points_mm();
        *self = [points.first(), points.last()].into_iter().flatten().fold(*self, Self::with);
        let Some(rest) = most_halvings.checked_sub(1).filter(|_| self.is_left_by(&points, tolerance)) else {
            return;
        };
        let (left, right) = piece.halves();
        self.widen(&left, tolerance, rest);
        self.widen(&right, tolerance, rest);
    }
}

#[cfg(test)]
mod tests {
    use nurbs_core::{Differentiate, Evaluate};
    use proptest::prelude::*;

    use super::*;
    use crate::curve::Nurbs;
    use crate::read_part;

    #[test]
    fn a_circle_and_a_parabola_have_the_bounds_of_their_formulas() {
        // An eighth of the turn on from the axes, the control points of the circle are √2 radii away.
        let circle = read_part("p.nc", "G0 X3 Y3\nG3 X3 Y3 I-3 J-3\n").unwrap();
        let (least, most) = bounding_box_mm(&circle.curves).unwrap();
        let radius = 3.0 * 2.0_f64.sqrt();
        for axis in 0..2 {
            assert!(
                (least[axis] + radius).abs() < 2e-8 && (most[axis] - radius).abs() < 2e-8,
                "{least:?} {most:?}"
            );
        }
        // y = x (4 - x) has its vertex at (2, 4), and its inner control point at (2, 8).
        let parabola =
            "[curve]\ndegree = 2\ncontrol_points_mm = [[0, 0], [2, 8], [4, 0]]\nknots = [0, 0, 0, 1, 1, 1]\n";
        let parabola = read_part("p.toml", parabola).unwrap();
        let (least, most) = bounding_box_mm(&parabola.curves).unwrap();
        assert_eq!((least, most), ([0.0; 3], [4.0, 4.0, 0.0]));
        assert_eq!(bounding_box_mm(&[]), None);
    }

    /// The bounds of paper A's curve; its control points are between 0 and 300.
    #[test]
    fn the_curve_of_paper_a_is_smaller_than_its_polygon() {
        let part = read_part("a.toml", include_str!("../../../data/seed-000.toml")).unwrap();
        let (least, most) = bounding_box_mm(&part.curves).unwrap();
        assert!((least[0] - 12.606).abs() < 5e-4 && (most[0] - 287.394).abs() < 5e-4, "{least:?} {most:?}");
        assert!((least[0] + most[0] - 300.0).abs() < 1e-6, "{least:?} {most:?}: symmetric");
    }

    proptest! {
        /// No point of the curve is outside, and one is at each bound.
        #[test]
        fn the_bounds_are_those_of_the_points(
            points in prop::collection::vec([-10.0..10.0_f64, -10.0..10.0_f64, -3.0..3.0_f64], 4..8),
            weights in prop::collection::vec(0.2..5.0_f64, 8),
            degree in 1_usize..4,
        ) {
            let spans = points.len() - degree;
            let knots = crate::spline_blocks::uniform_knots(points.len(), degree).collect::<Vec<_>>();
            let weights = weights[..points.len()].to_vec();
            let curve = Curve::from(Nurbs { degree, control_points_mm: points, dimension: 3, weights, knots });
            let (least, most) = bounding_box_mm([&curve]).unwrap();
            let nurbs = curve.for_evaluation().unwrap();
            let nurbs = nurbs.as_curve();
            let mut seen = ([f64::MAX; 3], [f64::MIN; 3]);
            for step in 0..=2000 {
                for span in 0..spans {
                    let (from, to) = nurbs.span_bounds(span);
                    let point = nurbs.derivatives_in(span, from + (to - from) * f64::from(step) / 2000.0).point;
                    for (axis, x) in point.into_iter().enumerate() {
                        seen.0[axis] = seen.0[axis].min(x);
                        seen.1[axis] = seen.1[axis].max(x);
                    }
                }
            }
            // An extremum is beyond the nearest of 2000 samples a span by up to |C''| / 8 / 2000², and the second
            // derivative by the share of a span is far below 6e4 here.
            for axis in 0..3 {
                let (low, high) = (seen.0[axis] - least[axis], most[axis] - seen.1[axis]);
                prop_assert!((-3e-8..2e-3).contains(&low), "{low}");
                prop_assert!((-3e-8..2e-3).contains(&high), "{high}");
            }
        }
    }
}
