//! One Bezier segment of a curve, by blossoming.
//!
//! The Bezier point j of degree p on [a, b] is the curve's polar form at p-j times a and j times b: p rounds of de
//! Boor's scheme, each with one of these arguments (Ramshaw, "Blossoms are polar forms", Computer Aided Geometric
//! Design 6, 1989). No knot is inserted, and the interval may be any part of a span.

use alloc::vec::Vec;

use real::{Backend, Real};

use crate::NurbsCurve;
use crate::vector::{over, scaled, sub};

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
        let mut bezier = Self {
            points: Vec::with_capacity(degree + 1),
            weights: Vec::with_capacity(degree + 1),
            rational: curve.weights().is_some(),
        };
        for ends in 0..=degree {
            let argument = |round: usize| if round < ends { end } else { begin };
            let blossom = |values: &mut Vec<H>| {
                for round in 0..degree {
                    for k in 0..degree - round {
                        let (low, high) = (knots[k + round], knots[k + degree]);
                        let part = (argument(round) - low) / (high - low);
                        values[k] = values[k] + (values[k + 1] - values[k]) * part;
                    }
                }
                values[0]
            };
            let coordinate = |d: usize| blossom(&mut points.iter().map(|p| p[d]).collect());
            bezier.points.push(core::array::from_fn(coordinate));
            bezier.weights.push(blossom(&mut weights.clone()));
        }
        bezier
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
