//! A curve as Bézier pieces, and a Bézier piece as chords.
//!
//! With positive weights a piece lies in the convex hull of its control points. If the corners of a hull are within a
//! tolerance of a segment, the whole hull is. So a piece whose control points are all near its chord is near its chord
//! everywhere.

use nurbs_core::{bezier_points, distance_to_segment};

use crate::curve::{Curve, MAX_COORDINATE_MM, MAX_WEIGHT};
use crate::vector::{difference, length};

/// A piece in homogeneous coordinates: each point times its weight, and the weight.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Bezier {
    points: Vec<[f64; 4]>,
}

/// The pieces of a curve that obeys every rule, one for each knot span. Neighbours share their end points to the last
/// bit, and the first and the last piece have the end points of the curve.
pub(crate) fn pieces(curve: &Curve) -> Vec<Bezier> {
    let degree = curve.degree();
    let mut pieces: Vec<Bezier> = Vec::new();
    for span in degree..curve.control_points_mm().len() {
        if curve.knots()[span] == curve.knots()[span + 1] {
            continue;
        }
        let mut piece = Bezier::of_span(curve, span);
        piece.points[0] = match pieces.last() {
            Some(before) => before.points[degree],
            None => homogeneous(curve, 0),
        };
        pieces.push(piece);
    }
    if let Some(last) = pieces.last_mut() {
        last.points[degree] = homogeneous(curve, curve.control_points_mm().len() - 1);
    }
    pieces
}

fn homogeneous(curve: &Curve, index: usize) -> [f64; 4] {
    let ([x, y, z], w) = (curve.control_points_mm()[index], curve.weights()[index]);
    [x * w, y * w, z * w, w]
}

impl Bezier {
    fn of_span(curve: &Curve, span: usize) -> Self {
        let first = span - curve.degree();
        let (a, b) = (curve.knots()[span], curve.knots()[span + 1]);
        let knots = &curve.knots()[first + 1..];
        let points: Vec<_> = (first..=span).map(|index| homogeneous(curve, index)).collect();
        Self { points: bezier_points(&points, knots, [a, b]) }
    }

    /// The weights, limited to the bounds of a curve's weights, which rounding may exceed.
    pub(crate) fn weights(&self) -> Vec<f64> {
        self.points.iter().map(|point| point[3].clamp(1.0 / MAX_WEIGHT, MAX_WEIGHT)).collect()
    }

    /// The control points, in mm, limited to the bounds of a curve's coordinates.
    pub(crate) fn points_mm(&self) -> Vec<[f64; 3]> {
        let bounded = |x: f64| x.clamp(-MAX_COORDINATE_MM, MAX_COORDINATE_MM);
        self.points.iter().map(|[x, y, z, w]| [x / w, y / w, z / w].map(bounded)).collect()
    }

    /// A bound in mm of the distance between points of the two pieces at the same share of the span. Let b_j and b'_j
    /// be the points, β_j and β'_j the weights, and r_j = β'_j/β_j. The distance is a mean of
    ///
    /// `(b_j - b'_j) + (1 - r_j) (b'_j - C')`, C' in the convex hull of the b'_k,
    ///
    /// for any common factor of the β'_j. Here the factor is the one for which r is as far above 1 as below.
    pub(crate) fn distance_mm(&self, other: &Self) -> f64 {
        let (points, others) = (self.points_mm(), other.points_mm());
        let ratios = || self.points.iter().zip(&other.points).map(|(one, other)| other[3] / one[3]);
        let (least, most) =
            ratios().fold((f64::INFINITY, 0.0_f64), |(least, most), r| (least.min(r), most.max(r)));
        let change = (most - least) / (most + least);
        let reach =
            |from: &[f64; 3]| others.iter().map(|to| length(difference(to, from))).fold(0.0, f64::max);
        let apart = points
            .iter()
            .zip(&others)
            .map(|(one, other)| length(difference(other, one)) + change * reach(other));
        apart.fold(0.0, f64::max)
    }

    /// The two pieces over the halves of the span.
    pub(crate) fn halves(&self) -> (Self, Self) {
        let degree = self.points.len() - 1;
        let (mut row, mut left, mut right) = (self.points.clone(), Vec::new(), Vec::new());
        for round in 0..=degree {
            left.push(row[0]);
            right.push(row[degree - round]);
            for k in 0..degree - round {
                row[k] = std::array::from_fn(|axis| 0.5 * row[k][axis] + 0.5 * row[k + 1][axis]);
            }
        }
        right.reverse();
        (Self { points: left }, Self { points: right })
    }

    /// Adds the ends of chords that leave the piece by no more than `tolerance_mm`; `None` if more than `most` halvings
    /// of the piece are needed.
    pub(crate) fn chords(&self, tolerance_mm: f64, most: u32, ends: &mut Vec<[f64; 3]>) -> Option<()> {
        let points = self.points_mm();
        let (first, last) = (points[0], points[points.len() - 1]);
        if points.iter().all(|point| distance_to_segment(point, &[first, last]) <= tolerance_mm) {
            ends.push(last);
            return Some(());
        }
        let most = most.checked_sub(1)?;
        let (left, right) = self.halves();
        left.chords(tolerance_mm, most, ends)?;
        right.chords(tolerance_mm, most, ends)
    }
}

#[cfg(test)]
mod tests {
    use nurbs_core::Evaluate;
    use proptest::prelude::*;

    use super::*;
    use crate::curve::Nurbs;
    use crate::read_part;

    fn paper_d() -> Curve {
        read_part("d.nc", include_str!("../../../data/seed-003.nc")).unwrap().curves.remove(0)
    }

    #[test]
    fn a_curve_of_one_span_is_its_own_piece() {
        let text = "[curve]\ndegree = 3\ncontrol_points_mm = [[0, 0], [1, 2], [3, 1], [4, 4]]\nweights = [1, 2, 4, 1]\nknots = [0, 0, 0, 0, 1, 1, 1, 1]\n";
        let curve = read_part("p.toml", text).unwrap().curves.remove(0);
        let pieces = pieces(&curve);
        assert_eq!(
            (pieces.len(), pieces[0].points_mm(), pieces[0].weights()),
            (1, curve.control_points_mm().to_vec(), curve.weights().to_vec())
        );
    }

    /// Evaluates by the Bernstein polynomials, not by de Boor's scheme.
    fn point(points: &[[f64; 4]], t: f64) -> [f64; 4] {
        let (degree, mut sum, mut binomial) = (points.len() - 1, [0.0; 4], 1.0);
        let power = |x: f64, exponent: usize| (0..exponent).fold(1.0, |product, _| product * x);
        for (j, point) in points.iter().enumerate() {
            let basis = binomial * power(t, j) * power(1.0 - t, degree - j);
            sum = std::array::from_fn(|axis| sum[axis] + basis * point[axis]);
            binomial *= (degree - j) as f64 / (j + 1) as f64;
        }
        sum
    }

    proptest! {
        /// A point is a mean with positive factors. With weights of any size its error is a few roundings of the
        /// largest coordinate. The knots and parameters here have no rounding error.
        #[test]
        fn weights_of_any_size_keep_the_points(
            corners in prop::collection::vec(([-100.0..100.0_f64, -100.0..100.0, -100.0..100.0], -9.0..9.0_f64), 4..9),
            degree in 1_usize..4,
            widths in prop::collection::vec(0_u16..2000, 9),
        ) {
            let (control_points_mm, exponents): (Vec<_>, Vec<_>) = corners.into_iter().unzip();
            let weights: Vec<_> = exponents.into_iter().map(|exponent| 10.0_f64.powf(exponent)).collect();
            let inner = widths[..control_points_mm.len() - degree - 1].iter().scan(1.0, |knot, width| {
                *knot += f64::from(*width);
                Some(*knot)
            });
            let mut knots = vec![0.0; degree + 1];
            knots.extend(inner);
            knots.extend(vec![20_000.0; degree + 1]);
            let curve = Curve::from(Nurbs { degree, dimension: 3, control_points_mm, weights, knots });
            let nurbs = curve.for_evaluation();
            prop_assume!(nurbs.is_ok());
            let nurbs = nurbs.unwrap();
            let spans = curve.knots().windows(2).filter(|span| span[0] < span[1]);
            for (piece, span) in pieces(&curve).iter().zip(spans) {
                for quarters in 0..=4 {
                    let t = f64::from(quarters) / 4.0;
                    let [x, y, z, w] = point(&piece.points, t);
                    let expected = nurbs.as_curve().point(span[0] + (span[1] - span[0]) * t);
                    for (found, expected) in [x / w, y / w, z / w].iter().zip(expected) {
                        prop_assert!((found - expected).abs() < 1e-12, "{found} for {expected} at {t} of {span:?}");
                    }
                }
            }
        }
    }

    #[test]
    fn pieces_join_and_keep_the_ends() {
        let curve = paper_d();
        let pieces = pieces(&curve);
        assert_eq!(pieces.len(), 7);
        for pair in pieces.windows(2) {
            assert_eq!(pair[0].points.last(), pair[1].points.first());
        }
        assert_eq!(pieces[0].points_mm()[0], curve.control_points_mm()[0]);
        assert_eq!(pieces[6].points_mm().last(), curve.control_points_mm().last());
    }

    /// At 200 parameters a span, every point of the curve is within the tolerance of the chords. For a tenth of the
    /// tolerance there are about √10 times as many chords.
    #[test]
    fn chords_keep_their_distance() {
        let pieces = pieces(&paper_d());
        let mut counts = Vec::new();
        for tolerance in [0.1, 0.01, 0.001] {
            let mut ends = vec![pieces[0].points_mm()[0]];
            for piece in &pieces {
                let before = ends.len() - 1;
                piece.chords(tolerance, 20, &mut ends).unwrap();
                for k in 0..=200 {
                    let [x, y, z, w] = point(&piece.points, f64::from(k) / 200.0);
                    let off = ends[before..].windows(2);
                    let off =
                        off.map(|chord| distance_to_segment(&[x / w, y / w, z / w], &[chord[0], chord[1]]));
                    let off = off.fold(f64::MAX, f64::min);
                    assert!(off <= tolerance, "{off} > {tolerance}");
                }
            }
            counts.push(ends.len());
        }
        assert!(counts[2] < 15 * counts[0] && counts[2] > 5 * counts[0], "{counts:?}");
    }

    #[test]
    fn what_cannot_be_reached_is_no_chord() {
        assert_eq!(pieces(&paper_d())[0].chords(1e-9, 3, &mut Vec::new()), None);
    }
}
