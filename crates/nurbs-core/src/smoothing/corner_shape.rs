//! The shape of a corner's segment: the shape factor λ, and the lengths of the two end derivatives.
//!
//! Let the direction turn by φ from `t_1` to `t_2`, and let the lengths of the end derivatives be `m_1 d` and `m_2 d`.
//! A cut is then `P = B + d (a t_1 + b t_2)` with `a = m_1 H_10 - H_00` and `b = 1 - H_00 + m_2 H_11`. A loop is the
//! same without H_00 and the 1. For d = 1 the corner's error and greatest curvature are
//!
//! `e = max(min |P - B|, max distance of P from the moves)` for a cut, `e = max |P - B|` for a loop,
//! `κ = max |a' b'' - b' a''| sin φ / (a'² + b'² + 2 a' b' cos φ)^(3/2)`,
//!
//! and a corner of the size d has the error `e d` and the least radius `d/κ`. With ε allowed and a room of at most
//! d_max, `d = min(ε/e, d_max)`, so the least radius is greatest where
//!
//! `κ max(e/ε, 1/d_max)`
//!
//! is least. The feed in a bend follows from its radius: `√(a ρ)` by the centripetal acceleration a, and by the chord
//! error too it rises with ρ. So the greatest least radius gives the highest feed at the slowest place of the corner.
//!
//! **What λ gains.** λ moves the segment along `λ (S² - S³)(2m/π - 1)(t_1 + t_2)` where `m_1 = m_2 = m`: along the
//! corner's tangent only. With equal lengths λ = 1 is the best at every angle. With different lengths the segment
//! can spread its curvature, and a λ near -1 is the best of corners up to 75°: for the same error its least radius is larger by 13 %
//! at 30° and by 6 % at 60°. At 90° the best segment is a quarter circle, which λ does not change.

use alloc::vec::Vec;

use real::{Real, Trigonometric};

use crate::CornerStyle;
use crate::nelder_mead::nelder_mead;

/// The largest |λ| of a corner: up to it the basis fits every format (see [`trig_basis`](crate::trig_basis)).
pub const MOST_CORNER_LAMBDA: f64 = 2.0;

/// Samples at which curvature and error are compared.
const SAMPLES: u32 = 96;
/// Steps of each search. With twice as many the least radius changes by less than 0.1 %.
const STEPS: usize = 70;
/// Edge of the simplex at the start of a search.
const WIDTH: f64 = 0.15;

/// The shape factor λ of corners.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum CornerLambda {
    /// One λ for all corners, from -2 to 2. With 1, the default, segments are symmetric, and both end derivatives have
    /// the length of a table. With any other λ, the lengths are those of the greatest least radius.
    Given(f64),
    /// For each corner the λ and the lengths that give the greatest least radius.
    Auto,
}

impl CornerLambda {
    /// Whether a given λ is from -2 to 2.
    #[must_use]
    pub fn is_in_range(&self) -> bool {
        match self {
            Self::Given(lambda) => lambda.abs() <= MOST_CORNER_LAMBDA,
            Self::Auto => true,
        }
    }
}

impl Default for CornerLambda {
    fn default() -> Self {
        Self::Given(1.0)
    }
}

/// The shape of one corner's segment.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct CornerShape {
    pub(crate) lambda: f64,
    /// Lengths of the end derivatives over the distance d of a cut; those of a loop have only a ratio.
    pub(crate) reaches: [f64; 2],
}

impl CornerShape {
    /// λ = 1 and end derivatives of equal length.
    pub(crate) fn symmetric(reach: f64) -> Self {
        Self { lambda: 1.0, reaches: [reach; 2] }
    }

    /// The best shape for a corner. `symmetric` is the shape for λ = 1, from which the search starts, and `half` are
    /// sine and cosine of φ/2. The error in units of d may be `error_allowed`; if it is `None`, d follows from the error.
    pub(crate) fn best(
        lambda: CornerLambda,
        style: CornerStyle,
        half: (f64, f64),
        symmetric: Self,
        error_allowed: Option<f64>,
    ) -> Self {
        let bend = Bend::new(style, half);
        let cost = |shape: Self| {
            let in_range = shape.lambda.abs() <= MOST_CORNER_LAMBDA && shape.reaches.iter().all(|m| *m > 0.0);
            if !in_range {
                return f64::INFINITY;
            }
            let (curvature, error) = bend.measure(&shape);
            curvature * error_allowed.map_or(error, |allowed| (error / allowed).max(1.0))
        };
        let [reach, _] = symmetric.reaches;
        let of_loop = |lambda, share: f64| Self { lambda, reaches: [reach, reach * share] };
        let found = match (lambda, style) {
            (CornerLambda::Given(1.0), _) => return symmetric,
            (CornerLambda::Given(lambda), CornerStyle::Cut) => {
                let of = |[m1, m2]: &[f64; 2]| Self { lambda, reaches: [*m1, *m2] };
                [[reach, reach], [0.8 * reach, reach]].map(|start| searched(start, of, cost))
            }
            (CornerLambda::Given(lambda), CornerStyle::Loop) => [[1.0], [0.8]]
                .map(|start| searched(start, |[share]: &[f64; 1]| of_loop(lambda, *share), cost)),
            (CornerLambda::Auto, CornerStyle::Cut) => {
                let of = |[lambda, m1, m2]: &[f64; 3]| Self { lambda: *lambda, reaches: [*m1, *m2] };
                [[1.0, reach, reach], [-0.6, 0.75 * reach, 0.95 * reach]]
                    .map(|start| searched(start, of, cost))
            }
            (CornerLambda::Auto, CornerStyle::Loop) => [[1.0, 1.0], [1.7, 1.2]]
                .map(|start| searched(start, |[lambda, share]: &[f64; 2]| of_loop(*lambda, *share), cost)),
        };
        let [a, b] = found;
        if b.1 < a.1 { b.0 } else { a.0 }
    }

    /// The error of a cut of d = 1.
    pub(crate) fn error(&self, half: (f64, f64)) -> f64 {
        Bend::new(CornerStyle::Cut, half).measure(self).1
    }
}

/// The best shape that a search finds, and its cost. It starts twice: the second search begins where the first one
/// ends, since a simplex may become flat beside an edge of the cost.
fn searched<const N: usize>(
    start: [f64; N],
    of: impl Fn(&[f64; N]) -> CornerShape,
    cost: impl Fn(CornerShape) -> f64,
) -> (CornerShape, f64) {
    let (first, _) = nelder_mead(start, WIDTH, STEPS, |x| cost(of(x)));
    let (place, value) = nelder_mead(first, -WIDTH / 2.0, STEPS / 2, |x| cost(of(x)));
    (of(&place), value)
}

/// A corner in units of its size d, sampled.
struct Bend {
    is_loop: bool,
    sine: f64,
    cosine: f64,
    /// sin(πu/2) and cos(πu/2) at each sample.
    samples: Vec<(f64, f64)>,
}

impl Bend {
    /// A corner that turns by φ, from sine and cosine of φ/2.
    fn new(style: CornerStyle, (sine, cosine): (f64, f64)) -> Self {
        let at = |step: u32| f64::sin_cos_quarter(f64::from(step) / f64::from(SAMPLES));
        Self {
            is_loop: style == CornerStyle::Loop,
            sine: 2.0 * sine * cosine,
            cosine: (cosine - sine) * (cosine + sine),
            samples: (0..=SAMPLES).map(at).collect(),
        }
    }

    /// Greatest curvature and error.
    fn measure(&self, shape: &CornerShape) -> (f64, f64) {
        let (mut curvature, mut nearest, mut farthest, mut off) = (0.0_f64, f64::INFINITY, 0.0_f64, 0.0_f64);
        for &(s, c) in &self.samples {
            let [[a, b], first, second] = self.coordinates(shape, s, c);
            let square = first[0] * first[0] + first[1] * first[1] + 2.0 * first[0] * first[1] * self.cosine;
            let bend = (first[0] * second[1] - first[1] * second[0]).abs() * self.sine;
            let distance = Real::sqrt((a * a + b * b + 2.0 * a * b * self.cosine).max(0.0));
            curvature = curvature.max(bend / (square * Real::sqrt(square)));
            (nearest, farthest) = (nearest.min(distance), farthest.max(distance));
            // The incoming move ends in the corner, and the outgoing one begins there.
            let before = if a + b * self.cosine <= 0.0 { b.abs() * self.sine } else { distance };
            let after = if b + a * self.cosine >= 0.0 { a.abs() * self.sine } else { distance };
            off = off.max(before.min(after));
        }
        (curvature, if self.is_loop { farthest } else { nearest.max(off) })
    }

    /// a and b of a point, and their first and second derivatives, from sine and cosine of πu/2.
    fn coordinates(&self, shape: &CornerShape, s: f64, c: f64) -> [[f64; 2]; 3] {
        let (lambda, [m1, m2], half_pi) = (shape.lambda, shape.reaches, f64::half_pi());
        let g = lambda * (2.0 - 3.0 * s) - 3.0 * c;
        let m = (c * c - s * s) * g + 3.0 * (c * s * (s - lambda * c));
        let h00 = c * c * c + lambda * (s * s * (1.0 - s));
        let hermite = [
            [h00, (s - 1.0 + h00) / half_pi, (h00 - c) / half_pi],
            [half_pi * (c * s * g), c * (1.0 + s * g), s * (1.0 + c * g)],
            [half_pi * half_pi * m, half_pi * (m - s), half_pi * (m + c)],
        ];
        let mut found = hermite.map(|[h00, h10, h11]| {
            let along = if self.is_loop { 0.0 } else { h00 };
            [m1 * h10 - along, m2 * h11 - along]
        });
        if !self.is_loop {
            found[0][1] += 1.0;
        }
        found
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::smoothing::corner_segment::cut_tangent;

    fn half(degrees: f64) -> (f64, f64) {
        (degrees.to_radians() / 2.0).sin_cos()
    }

    fn cut(lambda: CornerLambda, degrees: f64, allowed: Option<f64>) -> (CornerShape, f64, f64) {
        let symmetric = CornerShape::symmetric(cut_tangent(half(degrees).1));
        let shape = CornerShape::best(lambda, CornerStyle::Cut, half(degrees), symmetric, allowed);
        let (curvature, error) = Bend::new(CornerStyle::Cut, half(degrees)).measure(&shape);
        (shape, curvature, error)
    }

    /// The formulas of the module against the segment itself, with derivatives by differences.
    #[test]
    fn curvature_and_error_are_those_of_the_segment() {
        use crate::{Differentiate, Evaluate, TrigSegment, curvature};
        let (sine, cosine) = 60.0_f64.to_radians().sin_cos();
        for (lambda, m1, m2) in [(1.0, 1.8, 1.8), (-0.9, 1.4, 1.8), (2.0, 0.5, 1.1)] {
            let shape = CornerShape { lambda, reaches: [m1, m2] };
            let (q0, q1) = ([-1.0, 0.0], [cosine, sine]);
            let segment =
                TrigSegment::between([q0, q1], [[m1, 0.0], [m2 * cosine, m2 * sine]], lambda).unwrap();
            let places = (0..=SAMPLES).map(|i| f64::from(i) / f64::from(SAMPLES));
            let most = places.clone().map(|u| curvature(&segment.derivatives(u))).fold(0.0, f64::max);
            let near = places.map(|u| segment.point(u)).map(|p| p[0].hypot(p[1])).fold(9.0, f64::min);
            let (found, error) = Bend::new(CornerStyle::Cut, half(60.0)).measure(&shape);
            assert!((found / most - 1.0).abs() < 1e-12, "{lambda}: {found} {most}");
            assert!(
                error >= near - 1e-14 && (lambda < 0.0 || error < near + 1e-14),
                "{lambda}: {error} {near}"
            );
        }
    }

    /// Two independent figures: no curve that keeps the error ε at φ, or begins at the distance d, has a larger least
    /// radius than the circle tangent to both moves, `ε/(1/cos(φ/2) - 1)` and `d/tan(φ/2)`. At 90° the segment is that circle.
    #[test]
    fn the_best_lambda_comes_near_the_circle() {
        for (degrees, before, after) in [
            (10.0_f64, 1.191, 1.06),
            (30.0, 1.18, 1.055),
            (60.0, 1.11, 1.055),
            (90.0, 1.006, 1.001),
            (120.0, 1.035, 1.033),
            (150.0, 1.082, 1.080),
        ] {
            let by_error = 1.0 / half(degrees).1 - 1.0;
            let tangent = (degrees.to_radians() / 2.0).tan();
            let products = [CornerLambda::default(), CornerLambda::Auto].map(|lambda| {
                let (_, curvature, error) = cut(lambda, degrees, None);
                curvature * error / by_error
            });
            assert!(products[0] <= before && products[0] > before - 0.02, "{degrees}: {products:?}");
            assert!(products[1] <= after && products[1] > 0.999, "{degrees}: {products:?}");
            // With room for d = 1 only, and a tolerance that does not bind.
            let (_, curvature, _) = cut(CornerLambda::Auto, degrees, Some(10.0));
            assert!((0.999..=1.15).contains(&(curvature / tangent)), "{degrees}: {}", curvature / tangent);
        }
    }

    /// An exhaustive search on a grid, which shares nothing with the simplex.
    #[test]
    fn no_shape_of_a_grid_is_better() {
        for degrees in [20.0, 75.0, 140.0] {
            let (best, curvature, error) = cut(CornerLambda::Auto, degrees, None);
            let bend = Bend::new(CornerStyle::Cut, half(degrees));
            let steps = |from: f64, by: f64, count: i32| (0..=count).map(move |i| from + by * f64::from(i));
            let mut least = f64::INFINITY;
            for lambda in steps(-2.0, 0.25, 16) {
                for m1 in steps(0.2, 0.1, 20) {
                    for m2 in steps(0.2, 0.1, 20) {
                        let (k, e) = bend.measure(&CornerShape { lambda, reaches: [m1, m2] });
                        least = least.min(k * e);
                    }
                }
            }
            assert!(curvature * error <= least, "{degrees}: {best:?} {} {least}", curvature * error);
        }
    }

    #[test]
    fn a_given_lambda_is_kept_and_auto_is_at_least_as_good() {
        for degrees in [15.0, 60.0, 130.0] {
            let auto = cut(CornerLambda::Auto, degrees, None);
            for lambda in [-2.0, 0.0, 0.5, 2.0] {
                let (shape, curvature, error) = cut(CornerLambda::Given(lambda), degrees, None);
                assert_eq!(shape.lambda, lambda);
                assert!(auto.1 * auto.2 <= curvature * error * 1.002, "{degrees} {lambda}: {auto:?}");
            }
        }
    }

    #[test]
    fn a_loop_is_at_least_as_good_as_with_lambda_1() {
        for degrees in [30.0, 90.0, 150.0] {
            let bend = Bend::new(CornerStyle::Loop, half(degrees));
            let symmetric = CornerShape::symmetric(1.0);
            let product = |shape| {
                let (curvature, error) = bend.measure(&shape);
                curvature * error
            };
            let auto =
                CornerShape::best(CornerLambda::Auto, CornerStyle::Loop, half(degrees), symmetric, None);
            assert!(product(auto) <= product(symmetric), "{degrees}: {auto:?}");
        }
    }
}
