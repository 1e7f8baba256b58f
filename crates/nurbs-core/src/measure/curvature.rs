//! Curvature `κ = |C' × C''| / |C'|³` and its inverse, the radius `ρ`.
//!
//! The printed formula needs the cube of a speed: 1e10 where the curve is 1 m long, beyond any 32-bit fixed-point
//! format. With the unit tangent `T = C' / |C'|`,
//!
//! `κ = |C''⊥| / |C'| / |C'|`, where `C''⊥ = C'' - (T·C'') T` is the part of C'' across the curve,
//!
//! and no intermediate is larger than C''. C''⊥ is as long as `T × C''`, and is defined in any number of dimensions.

use real::Real;

use crate::Derivatives;
use crate::vector::{dot, over, sub};

/// Speed, tangent and bend of a curve at a point: the work common to them is done once.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Frenet<R, const D: usize> {
    /// `|C'|`.
    pub speed: R,
    /// The unit tangent T; 0 where `C' = 0`.
    pub tangent: [R; D],
    /// `C''⊥`.
    across: [R; D],
}

impl<R: Real, const D: usize> Frenet<R, D> {
    /// From the derivatives at a point.
    #[must_use]
    pub fn of(derivatives: &Derivatives<R, D>) -> Self {
        let speed = R::norm(&derivatives.first);
        let divisor = if speed.is_zero() { R::one() } else { speed };
        let tangent = over(&derivatives.first, divisor);
        let along = dot(&tangent, &derivatives.second);
        let across = sub(&derivatives.second, &tangent.map(|x| along * x));
        Self { speed, tangent, across }
    }

    /// See [`curvature()`].
    #[must_use]
    pub fn curvature(&self) -> R {
        if self.speed.is_zero() { R::max_value() } else { R::norm(&self.across) / self.speed / self.speed }
    }

    /// See [`curvature_vector`].
    #[must_use]
    pub fn curvature_vector(&self) -> Option<[R; D]> {
        (self.speed > R::zero()).then(|| self.across.map(|x| x / self.speed / self.speed))
    }

    /// See [`radius`].
    #[must_use]
    pub fn radius(&self) -> R {
        if self.speed.is_zero() {
            return R::zero();
        }
        let turning = R::norm(&self.across) / self.speed;
        if turning.is_zero() { R::max_value() } else { (self.speed / turning).min(R::max_value()) }
    }
}

/// Curvature κ, in 1/mm for points in mm; 0 on a straight line.
///
/// At `C' = 0`, which is a cusp or coincident control points, there is no curvature; the result is that of the sharpest
/// bend, `R::max_value()`.
///
/// Accuracy on a circle of radius 10: absolute 5e-16 in `f64`, 2e-7 in `f32`, 1e-9 in `I32F32`, 5e-5 in
/// `I16F16`.
/// Where `C''` is almost parallel to the tangent the error is a unit of `|C''|/|C'|²`.
#[must_use]
pub fn curvature<R: Real, const D: usize>(derivatives: &Derivatives<R, D>) -> R {
    Frenet::of(derivatives).curvature()
}

/// The curvature vector `dT/ds = C''⊥ / |C'|²`, in 1/mm for points in mm. Its length is κ, and it points to the centre
/// of the bend. `None` where `C' = 0`.
///
/// Accuracy: that of [`curvature()`] for each component.
#[must_use]
pub fn curvature_vector<R: Real, const D: usize>(derivatives: &Derivatives<R, D>) -> Option<[R; D]> {
    Frenet::of(derivatives).curvature_vector()
}

/// Radius of curvature ρ = 1/κ, in mm for points in mm; `R::max_value()` on a straight line, 0 where `C' = 0`.
///
/// Computed as `|C'| / (|C''⊥| / |C'|)`: in fixed point a large radius has digits that a small curvature has lost.
///
/// Accuracy on a circle of radius 10: relative 3e-15 in `f64`, 2e-6 in `f32`, 1e-9 in `I32F32`, 5e-5 in
/// `I16F16`.
#[must_use]
pub fn radius<R: Real, const D: usize>(derivatives: &Derivatives<R, D>) -> R {
    Frenet::of(derivatives).radius()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{Differentiate, generate, golden};
    use proptest::prelude::*;
    use real::{Backend, I16F16, I32F32};

    #[test]
    fn the_curvature_vector_points_to_the_centre() {
        let circle = golden::circle(10.0);
        for k in 0..=1000 {
            let d = circle.as_curve().derivatives(f64::from(k) / 1000.0);
            let vector = curvature_vector(&d).unwrap();
            // The centre is the origin: dT/ds = -C/r².
            let off = [vector[0] + d.point[0] / 100.0, vector[1] + d.point[1] / 100.0];
            assert!(f64::norm(&off) < 1e-15, "{vector:?} at {:?}", d.point);
            assert!((f64::norm(&vector) - curvature(&d)).abs() < 1e-16);
        }
        let still = Derivatives { point: [0.0; 2], first: [0.0; 2], second: [1.0; 2] };
        assert_eq!(curvature_vector(&still), None);
    }

    /// Worst relative error of the radius and absolute error of the curvature on a circle of radius 10.
    fn on_a_circle<Q: Backend>() -> (f64, f64) {
        let circle = golden::circle(10.0).convert::<Q>().unwrap();
        let errors = (0..=1000).map(|k| {
            let d = circle.as_curve().derivatives(Q::from_ratio(k, 1000));
            ((radius(&d).to_f64() / 10.0 - 1.0).abs(), (curvature(&d).to_f64() - 0.1).abs())
        });
        errors.fold((0.0, 0.0), |worst, e| (worst.0.max(e.0), worst.1.max(e.1)))
    }

    #[test]
    fn a_circle_has_one_radius() {
        for (name, (radius, curvature), bounds) in [
            ("f64", on_a_circle::<f64>(), (3e-15, 5e-16)),
            ("f32", on_a_circle::<f32>(), (2e-6, 2e-7)),
            ("I32F32", on_a_circle::<I32F32>(), (1e-9, 1e-9)),
            ("I16F16", on_a_circle::<I16F16>(), (5e-5, 5e-5)),
        ] {
            assert!(
                radius <= bounds.0 && curvature <= bounds.1,
                "{name}: {radius:e}, {curvature:e} > {bounds:?}"
            );
        }
    }

    #[test]
    fn the_sharpest_bend_of_seed_000() {
        let curve = golden::seed_000();
        let d = curve.as_curve().derivatives(0.303);
        assert!((radius(&d) - 24.757).abs() < 1e-3, "{}", radius(&d));
    }

    #[test]
    fn a_helix_bends_in_three_dimensions() {
        // (cos t, sin t, t): κ = 1/2.
        let d = Derivatives { point: [1.0, 0.0, 0.0], first: [0.0, 1.0, 1.0], second: [-1.0, 0.0, 0.0] };
        assert!((curvature(&d) - 0.5).abs() <= f64::EPSILON, "{}", curvature(&d));
        assert!((radius(&d) - 2.0).abs() <= 4.0 * f64::EPSILON, "{}", radius(&d));
    }

    #[test]
    fn straight_lines_and_points_have_the_documented_values() {
        let derivatives = |first, second| Derivatives { point: [0.0_f64; 2], first, second };
        let line = derivatives([2.0, 0.0], [5.0, 0.0]);
        assert_eq!((curvature(&line), radius(&line)), (0.0, f64::MAX));
        let cusp = derivatives([0.0, 0.0], [5.0, 0.0]);
        assert_eq!((curvature(&cusp), radius(&cusp)), (f64::MAX, 0.0));
        let nearly = derivatives([1e200, 0.0], [0.0, 1e-100]);
        assert_eq!((curvature(&nearly), radius(&nearly)), (0.0, f64::MAX));
    }

    proptest! {
        #[test]
        fn the_textbook_formula_gives_the_same(first in [-1e3..1e3, -1e3..1e3, -1e3..1e3],
                                               second in [-1e3..1e3, -1e3..1e3, -1e3..1e3]) {
            let d = Derivatives { point: [0.0; 3], first, second };
            let cross: [f64; 3] = core::array::from_fn(|k| {
                let (a, b) = ((k + 1) % 3, (k + 2) % 3);
                first[a] * second[b] - first[b] * second[a]
            });
            let expected = f64::norm(&cross) / f64::norm(&first).powi(3);
            let scale = f64::norm(&second) / f64::norm(&first).powi(2);
            let error = (curvature(&d) - expected).abs();
            prop_assert!(error <= 16.0 * f64::EPSILON * scale, "{error}");
        }

        #[test]
        fn radius_is_the_inverse_of_curvature((curve, u) in generate::curve_and_parameter::<2>()) {
            let d = curve.as_curve().derivatives(u);
            let (kappa, rho) = (curvature(&d), radius(&d));
            let straight = kappa == 0.0 && rho == f64::MAX;
            prop_assert!(straight || (kappa * rho - 1.0).abs() <= 8.0 * f64::EPSILON, "{kappa} · {rho}");
        }
    }
}
