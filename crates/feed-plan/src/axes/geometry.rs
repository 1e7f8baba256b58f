//! How the path turns, axis by axis, at a distance along it.
//!
//! With the unit tangent e, the curvature vector `k = de/ds` and `c = dk/ds`, an axis moves with
//!
//! ```text
//! velocity  e v        acceleration  e a + k v²        jerk  e j + 3 k v a + c v³
//! ```
//!
//! The path is cut into pieces at knots and joints, where c, and k at a step of curvature, have two values: each piece has its own.
//! c is the derivative with respect to u of the polynomial of degree 4 through k at five parameters, over `|C'|`. They
//! lie around u, and at the ends of a span within it.
//!
//! Where the slope of second order differs much from that of fourth, as in a bend that is narrow against the span, they are brought closer.
//!
//! Error: with the five δ apart, 2⁻¹¹ of a span or less, that of rounding is about `2⁻⁵³ k/δ`, that of the polynomial `δ⁴/30` of the
//! fifth derivative of k; see the tests.

use alloc::vec::Vec;

use nurbs_core::{Differentiate, Frenet};

use crate::FeedLimit;
use crate::limits::AXES;

/// Times that the five parameters are brought four times as close.
const NARROWINGS: usize = 8;
/// They are close enough where slopes of second and fourth order differ by this share.
const CLOSE: f64 = 1e-3;
/// Distance of the five parameters at first, as a share of the span.
const APART: f64 = 1.0 / 2048.0;

/// Tangent, curvature vector and its derivative, axis by axis; those of an axis that the path has not are 0.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(crate) struct Bend {
    pub(crate) e: [f64; AXES],
    pub(crate) k: [f64; AXES],
    pub(crate) c: [f64; AXES],
}

/// A stretch within one span of one curve.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Piece {
    pub(crate) begin: f64,
    pub(crate) end: f64,
    curve: usize,
    span: usize,
    parameters: (f64, f64),
    /// Whether it is straight, so that only e is not 0, and the same everywhere.
    pub(crate) is_line: bool,
}

/// Curves with the arc lengths of their spans.
pub(crate) struct Geometry<'a, C> {
    curves: &'a [C],
    limit: &'a FeedLimit<f64>,
    pieces: Vec<Piece>,
}

impl<'a, C> Geometry<'a, C> {
    /// `None` when the limit was not made along these curves.
    pub(crate) fn new<const D: usize>(curves: &'a [C], limit: &'a FeedLimit<f64>) -> Option<Self>
    where
        C: Differentiate<f64, D>,
    {
        let mut points = limit.points();
        let mut pieces: Vec<Piece> = Vec::new();
        for (curve, shape) in curves.iter().enumerate() {
            for span in 0..shape.span_count() {
                let parameters = shape.span_bounds(span);
                let begin = pieces.last().map_or(0.0, |last| last.end);
                let end = points.find(|point| point.curve == curve && point.u >= parameters.1)?.distance;
                pieces.push(Piece { begin, end, curve, span, parameters, is_line: shape.is_line(span) });
            }
        }
        Some(Self { curves, limit, pieces })
    }

    pub(crate) fn limit(&self) -> &'a FeedLimit<f64> {
        self.limit
    }

    /// The pieces with a length that lie between two distances.
    pub(crate) fn pieces_between(&self, from: f64, to: f64) -> &[Piece] {
        let first = self.pieces.partition_point(|piece| piece.end <= from);
        let behind = self.pieces.partition_point(|piece| piece.begin < to);
        self.pieces.get(first..behind).unwrap_or_default()
    }

    /// How the path turns at a distance, as the end of `piece` if that is where it is.
    pub(crate) fn bend<const D: usize>(&self, piece: &Piece, distance: f64) -> Bend
    where
        C: Differentiate<f64, D>,
    {
        let (low, high) = piece.parameters;
        if piece.is_line {
            let along = self.curves.get(piece.curve).map(|shape| shape.derivatives_in(piece.span, low));
            let e = along.map_or([0.0; AXES], |along| axes_of(&Frenet::of(&along).tangent));
            return Bend { e, ..Bend::default() };
        }
        let (curve, u) = self.limit.parameter_at(distance);
        let u = match curve == piece.curve {
            true => u.clamp(low.min(high), high.max(low)),
            false if distance - piece.begin < piece.end - distance => low,
            false => high,
        };
        let Some(shape) = self.curves.get(piece.curve) else { return Bend::default() };
        bend_at(shape, piece.span, (low, high), u)
    }
}

/// How a span of a curve turns at a parameter.
fn bend_at<const D: usize, C: Differentiate<f64, D>>(
    shape: &C,
    span: usize,
    (low, high): (f64, f64),
    u: f64,
) -> Bend {
    let frenet = |u: f64| Frenet::of(&shape.derivatives_in(span, u));
    let curvature = |u: f64| axes_of(&frenet(u).curvature_vector().unwrap_or([0.0; D]));
    let here = frenet(u);
    let k = axes_of(&here.curvature_vector().unwrap_or([0.0; D]));
    let mut apart = (high - low) * APART;
    let mut c = [0.0; AXES];
    for narrowing in 0..=NARROWINGS {
        let centre = u.clamp(low + 2.0 * apart, high - 2.0 * apart);
        let five = [-2.0, -1.0, 0.0, 1.0, 2.0].map(|place| curvature(centre + place * apart));
        let weights = slope_weights((u - centre) / apart);
        c = core::array::from_fn(|i| {
            weights.iter().zip(&five).fold(0.0, |sum, (weight, k)| sum + weight * k[i])
        });
        // At the centre the slope is (8 (k₁ - k₋₁) - (k₂ - k₋₂))/12; what it has beyond (k₁ - k₋₁)/2 falls as the square.
        let beyond = |i: usize| (2.0 * (five[3][i] - five[1][i]) - (five[4][i] - five[0][i])).abs() / 12.0;
        let largest = |of: &dyn Fn(usize) -> f64| (0..AXES).fold(0.0_f64, |most, i| most.max(of(i)));
        let rounding = largest(&|i| k[i].abs()) * 1e-13;
        if largest(&beyond) <= largest(&|i| c[i].abs()) * CLOSE + rounding || narrowing == NARROWINGS {
            break;
        }
        apart *= 0.25;
    }
    let per_length = if here.speed > 0.0 { 1.0 / (apart * here.speed) } else { 0.0 };
    Bend { e: axes_of(&here.tangent), k, c: c.map(|c| c * per_length) }
}

/// What the values at -2, -1, 0, 1 and 2 count for in the slope at t of the polynomial through them.
fn slope_weights(t: f64) -> [f64; 5] {
    let (cube, square) = (4.0 * t * t * t, 3.0 * t * t);
    [
        (cube - 2.0 * square - 2.0 * t + 2.0) / 24.0,
        (square + 8.0 * t - 4.0 - cube) / 6.0,
        (cube - 10.0 * t) / 4.0,
        (8.0 * t + 4.0 - square - cube) / 6.0,
        (cube + 2.0 * square - 2.0 * t - 2.0) / 24.0,
    ]
}

fn axes_of<const D: usize>(vector: &[f64; D]) -> [f64; AXES] {
    core::array::from_fn(|i| vector.get(i).copied().unwrap_or_default())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::test_paths::{circle, limit_along, paper_limits, seed_000, seed_003};
    use nurbs_core::{Evaluate, NurbsBuf};

    fn with_geometry(
        curve: &NurbsBuf<f64, 2>,
        check: impl Fn(&Geometry<'_, nurbs_core::NurbsCurve<'_, f64, 2>>),
    ) {
        let limit = limit_along(core::slice::from_ref(curve), &paper_limits());
        let curves = [curve.as_curve()];
        check(&Geometry::new(&curves, &limit).unwrap());
    }

    #[test]
    fn a_circle_turns_as_it_should_up_to_both_ends_of_each_span() {
        with_geometry(&circle(10.0), |geometry| {
            let pieces = geometry.pieces_between(0.0, 1e9);
            assert_eq!(pieces.len(), 4);
            for piece in pieces {
                for i in 0..=20 {
                    let s = piece.begin + (piece.end - piece.begin) * f64::from(i) / 20.0;
                    let bend = geometry.bend(piece, s);
                    let (sine, cosine) = (s / 10.0).sin_cos();
                    let expected = Bend {
                        e: [-sine, cosine, 0.0],
                        k: [-cosine / 10.0, -sine / 10.0, 0.0],
                        c: [sine / 100.0, -cosine / 100.0, 0.0],
                    };
                    for axis in 0..2 {
                        // The parameter at a distance is interpolated.
                        assert!((bend.e[axis] - expected.e[axis]).abs() < 1e-7, "{s}: {bend:?} {expected:?}");
                        assert!((bend.k[axis] - expected.k[axis]).abs() < 1e-8, "{s}: {bend:?} {expected:?}");
                        assert!((bend.c[axis] - expected.c[axis]).abs() < 1e-9, "{s}: {bend:?} {expected:?}");
                    }
                }
            }
        });
    }

    /// Against differences ten times as close, of second order.
    #[test]
    fn the_change_of_curvature_is_that_of_neighbours() {
        for curve in [seed_000(), seed_003()] {
            let shape = curve.as_curve();
            for span in 0..shape.span_count() {
                let (low, high) = shape.span_bounds(span);
                for i in 1..200 {
                    let u = low + (high - low) * f64::from(i) / 200.0;
                    let at = |u: f64| Frenet::of(&shape.derivatives_in(span, u));
                    let step = (high - low) * 1e-5;
                    let (before, after) =
                        (at(u - step).curvature_vector().unwrap(), at(u + step).curvature_vector().unwrap());
                    let found = bend_at(&shape, span, (low, high), u);
                    let most = found.c[0].hypot(found.c[1]);
                    for axis in 0..2 {
                        let expected = (after[axis] - before[axis]) / (2.0 * step * at(u).speed);
                        assert!(
                            (found.c[axis] - expected).abs() <= 1e-5 * most + 1e-9,
                            "{u}: {found:?} {expected}"
                        );
                    }
                }
            }
        }
    }

    #[test]
    fn the_slope_of_a_polynomial_of_degree_four_is_exact_anywhere() {
        for t in [-2.0, -1.3, 0.0, 0.4, 2.0_f64] {
            let value = |x: f64| 1.0 + x - 2.0 * x * x + 0.5 * x.powi(3) - 0.25 * x.powi(4);
            let slope = 1.0 - 4.0 * t + 1.5 * t * t - t.powi(3);
            let found: f64 =
                (-2..=2).zip(slope_weights(t)).map(|(x, weight)| weight * value(f64::from(x))).sum();
            assert!((found - slope).abs() < 1e-13, "{t}: {found} {slope}");
        }
    }

    #[test]
    fn a_limit_without_curves_has_no_geometry() {
        let limit = crate::test_paths::limit_through(&[(0.0, 0.5), (10.0, 0.5)]);
        let curve = seed_003();
        assert!(Geometry::new(&[curve.as_curve()], &limit).is_none_or(|g| g.pieces.len() > 1));
    }
}
