//! An ellipse in space, and its arcs as rational curves of degree 2.
//!
//! An ellipse is `C(θ) = M + cos θ a + sin θ b` with two vectors a and b; for a circle they are perpendicular and
//! equally long. The span about θ with the half angle h is the conic with the control points `C(θ - h)`, `M + (cos θ a
//! + sin θ b) / cos h`, `C(θ + h)` and the weights (1, cos h, 1): it is the affine image of an arc of the unit circle.

use std::f64::consts::{FRAC_PI_2, TAU};

use crate::curve::{Curve, Nurbs};
use crate::vector::sin_cos;

/// An ellipse in space.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Ellipse {
    pub(crate) centre: [f64; 3],
    /// From the centre to the point at the angle 0.
    pub(crate) major: [f64; 3],
    /// From the centre to the point at a right angle.
    pub(crate) minor: [f64; 3],
}

impl Ellipse {
    /// The point at an angle, with the distance from the centre multiplied by `reach`.
    fn point(&self, angle: f64, reach: f64) -> [f64; 3] {
        let (sin, cos) = sin_cos(angle);
        std::array::from_fn(|axis| {
            self.centre[axis] + reach * (cos * self.major[axis] + sin * self.minor[axis])
        })
    }

    /// The arc that begins at an angle, in rad, in spans of at most a right angle. `sweep` is at most a full turn.
    pub(crate) fn arc(&self, first: f64, sweep: f64) -> Curve {
        // Rounding may leave a quarter turn a hair above a right angle; it stays one span.
        let count = (sweep.abs() / FRAC_PI_2 - 1e-9).ceil().clamp(1.0, 4.0);
        let half = sweep / (2.0 * count);
        #[allow(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "1 to 4")]
        let spans = count as u8;
        let mut points: Vec<_> = (0..=2 * spans)
            .map(|j| {
                let reach = if j % 2 == 0 { 1.0 } else { 1.0 / half.cos() };
                self.point(first + f64::from(j) * half, reach)
            })
            .collect();
        if sweep.abs() == TAU {
            points[2 * usize::from(spans)] = points[0];
        }
        let weights = (0..points.len()).map(|j| if j % 2 == 0 { 1.0 } else { half.cos() }).collect();
        conic(points, weights)
    }
}

/// The curve of degree 2 whose spans have three points each.
pub(crate) fn conic(points: Vec<[f64; 3]>, weights: Vec<f64>) -> Curve {
    let spans = u8::try_from(points.len() / 2).unwrap_or(u8::MAX);
    let mut knots = vec![0.0];
    knots.extend((0..=spans).flat_map(|i| [f64::from(i) / f64::from(spans); 2]));
    knots.push(1.0);
    let dimension = Nurbs::dimension_of(&points);
    Nurbs { degree: 2, control_points_mm: points, dimension, weights, knots }.into()
}
