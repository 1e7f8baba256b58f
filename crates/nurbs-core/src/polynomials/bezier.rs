//! One Bezier segment of a curve, by blossoming.

use alloc::vec::Vec;

use real::{Backend, Real};

use crate::NurbsCurve;
use crate::vector::{add, over, scaled, sub};

/// A homogeneous Bezier segment: points times weights, and weights.
pub(crate) struct Bezier<H, const D: usize> {
    pub(crate) points: Vec<[H; D]>,
    pub(crate) weights: Vec<H>,
    pub(crate) rational: bool,
}

/// `x` in the computing type, or NaN if the type cannot hold it, so that no result of it passes for geometry.
pub(crate) fn computed<H: Backend>(x: f64) -> H {
    const { assert!(H::IS_FLOATING, "curves are cut in a float: in fixed point their numbers do not fit") };
    H::from_f64(x).unwrap_or_else(|| H::zero() / H::zero())
}

/// The Bezier points of one polynomial piece of a B-spline of degree p on a part of its span.
///
/// `points` are the p + 1 control points that act on the span, and `knots` the 2p knots around it, p on each side. The part
/// [a, b] may be the whole span or any part of it. A rational curve gives points times weights, and weights. Every mean
/// has positive shares inside the span, so that a small weight keeps its digits beside a large one.
///
/// # Source
/// Point j is the polar form at p - j times a and j times b: p rounds of de Boor's scheme, each with one of these
/// arguments. No knot is inserted. Ramshaw, "Blossoms are polar forms", Computer Aided Geometric Design 6 (1989).
///
/// ```
/// // Degree 2, the knots 0, 0 before the span [0, 1] and 1, 2 behind it: the first half.
/// let half = nurbs_core::bezier_points(&[[0.0], [2.0], [4.0]], &[0.0, 0.0, 1.0, 2.0], [0.0, 0.5]);
/// assert_eq!(half, [[0.0], [1.0], [1.75]]);
/// ```
#[must_use]
pub fn bezier_points<H: Backend, const N: usize>(
    points: &[[H; N]],
    knots: &[H],
    [begin, end]: [H; 2],
) -> Vec<[H; N]> {
    let degree = points.len().saturating_sub(1);
    let polar_form = |ends: usize| {
        let mut row = points.to_vec();
        for round in 0..degree {
            let at = if round < ends { end } else { begin };
            for k in 0..degree - round {
                let (low, high) = (knots[k + round], knots[k + degree]);
                let shares = [high - at, at - low].map(|share| share / (high - low));
                row[k] = add(&scaled(&row[k], shares[0]), &scaled(&row[k + 1], shares[1]));
            }
        }
        row
    };
    (0..=degree).filter_map(|ends| polar_form(ends).first().copied()).collect()
}

impl<H: Backend, const D: usize> Bezier<H, D> {
    /// The part [begin, end] of a span, by blossoming. If `H` cannot hold a number of the span, the results are NaN.
    pub(crate) fn of_span(curve: &NurbsCurve<'_, f64, D>, span: usize, begin: H, end: H) -> Self {
        let degree = curve.degree();
        let first = span - degree;
        let weight = |i: usize| curve.weights().map_or(1.0, |weights| weights[i]);
        let weights: Vec<H> = (first..=span).map(|i| computed(weight(i))).collect();
        let points = (first..=span).zip(&weights);
        let points: Vec<[H; D]> =
            points.map(|(i, w)| curve.control_points()[i].map(|x| computed::<H>(x) * *w)).collect();
        let knots: Vec<H> =
            (0..2 * degree).map(|k| computed(curve.knots().as_slice()[first + 1 + k])).collect();
        let part = [begin, end];
        let of_weights = bezier_points(&weights.iter().map(|w| [*w]).collect::<Vec<_>>(), &knots, part);
        Self {
            points: bezier_points(&points, &knots, part),
            weights: of_weights.into_iter().map(|[w]| w).collect(),
            rational: curve.weights().is_some(),
        }
    }

    /// Whether every point and weight is finite.
    pub(crate) fn is_finite(&self) -> bool {
        self.points.iter().flatten().chain(&self.weights).all(|x| x.is_finite())
    }

    pub(crate) fn euclidean(&self, j: usize) -> [H; D] {
        over(&self.points[j], self.weights[j])
    }

    /// Length of the control polygon in mm; the arc is no longer than that.
    pub(crate) fn polygon_mm(&self) -> f64 {
        let leg = |j: usize| f64::norm(&sub(&self.euclidean(j), &self.euclidean(j - 1)).map(|x| x.to_f64()));
        (1..self.points.len()).map(leg).sum()
    }

    /// Whether no weight is more than `max_ratio` times another.
    pub(crate) fn has_even_weights(&self, max_ratio: f64) -> bool {
        let weights = self.weights.iter().map(|w| w.to_f64());
        let (light, heavy) = weights.fold((f64::MAX, 0.0_f64), |(l, h), w| (l.min(w), h.max(w)));
        heavy <= max_ratio * light
    }

    /// Points times weights about the first point, and weights, in f64. The differences are taken before the rounding:
    /// in a span of one ulp, only the differences tell points apart.
    pub(crate) fn relative(&self) -> Vec<([f64; D], f64)> {
        let points = self.seen_from_start().map(|point| point.map(|x| x.to_f64()));
        points.zip(self.weights.iter().map(|w| w.to_f64())).collect()
    }

    /// Points times weights about the first point: `w_j (P_j - P_0)`.
    pub(crate) fn seen_from_start(&self) -> impl Iterator<Item = [H; D]> {
        let start = self.euclidean(0);
        self.points.iter().zip(&self.weights).map(move |(p, w)| sub(p, &scaled(&start, *w)))
    }
}
