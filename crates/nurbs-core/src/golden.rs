//! Curves with known figures, for tests: those of the papers, and a circle.

use crate::{CurveError, NurbsBuf};

/// The curve of `data/seed-000.toml`. Length 834.706924931909.
#[must_use]
pub fn seed_000() -> NurbsBuf<f64, 2> {
    let points = [[150., 150.], [0., 0.], [0., 300.], [150., 150.], [300., 0.], [300., 300.], [150., 150.]];
    let knots = [0., 0., 0., 0., 0.25, 0.5, 0.75, 1., 1., 1., 1.];
    valid(NurbsBuf::try_new_nonrational(3, points.to_vec(), knots.to_vec()))
}

/// The curve of `data/seed-003.nc`. Length 134.006017053295.
#[must_use]
pub fn seed_003() -> NurbsBuf<f64, 2> {
    let points = [
        [0.0, 15.0],
        [10.0, 34.1],
        [20.0, 10.1],
        [30.0, 16.1],
        [40.0, 0.9],
        [50.0, 38.0],
        [60.0, 2.9],
        [65.0, 8.9],
        [70.0, 26.1],
        [80.0, 5.9],
    ];
    let weights = [1.0, 2.0, 1.5, 1.0, 1.0, 2.0, 1.0, 1.0, 2.0, 1.0];
    let knots = [0.0, 0.0, 0.0, 0.0, 0.1836, 0.2781, 0.3837, 0.5474, 0.7104, 0.8049, 1.0, 1.0, 1.0, 1.0];
    valid(NurbsBuf::try_new(3, points.to_vec(), weights.to_vec(), knots.to_vec()))
}

/// A full circle about the origin: four quarters of degree 2, The NURBS Book example 7.2.
///
/// # Panics
/// If the radius is 0, infinite or NaN.
#[must_use]
pub fn circle(radius: f64) -> NurbsBuf<f64, 2> {
    let (r, h) = (radius, core::f64::consts::FRAC_1_SQRT_2);
    let points = [[r, 0.], [r, r], [0., r], [-r, r], [-r, 0.], [-r, -r], [0., -r], [r, -r], [r, 0.]];
    let weights = [1., h, 1., h, 1., h, 1., h, 1.];
    let knots = [0., 0., 0., 0.25, 0.25, 0.5, 0.5, 0.75, 0.75, 1., 1., 1.];
    valid(NurbsBuf::try_new(2, points.to_vec(), weights.to_vec(), knots.to_vec()))
}

fn valid(curve: Result<NurbsBuf<f64, 2>, CurveError>) -> NurbsBuf<f64, 2> {
    curve.unwrap_or_else(|error| panic!("{error}"))
}
