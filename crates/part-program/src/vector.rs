//! A vector in space.

use std::f64::consts::FRAC_PI_2;

pub(crate) fn difference(to: &[f64; 3], from: &[f64; 3]) -> [f64; 3] {
    std::array::from_fn(|axis| to[axis] - from[axis])
}

pub(crate) fn dot(a: [f64; 3], b: [f64; 3]) -> f64 {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

pub(crate) fn cross(a: [f64; 3], b: [f64; 3]) -> [f64; 3] {
    [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]
}

pub(crate) fn length(v: [f64; 3]) -> f64 {
    v[0].hypot(v[1]).hypot(v[2])
}

/// The angle between two directions, in rad, from sine and cosine, so that small ones keep their digits.
pub(crate) fn angle(a: [f64; 3], b: [f64; 3]) -> f64 {
    length(cross(a, b)).atan2(dot(a, b))
}

/// A vector over its length; `None` if it has no direction.
pub(crate) fn unit(vector: [f64; 3]) -> Option<[f64; 3]> {
    let length = length(vector);
    (length > 0.0 && length.is_finite()).then(|| vector.map(|x| x / length))
}

/// Sine and cosine of an angle in rad. For a whole number of right angles they are exact, without the rounding of π.
pub(crate) fn sin_cos(angle: f64) -> (f64, f64) {
    let quarters = angle / FRAC_PI_2;
    let whole = quarters.round();
    let (sin, cos) = angle.sin_cos();
    if (quarters - whole).abs() <= 4.0 * f64::EPSILON * whole.abs().max(1.0) {
        (sin.round() + 0.0, cos.round() + 0.0)
    } else {
        (sin, cos)
    }
}
