//! Paths by name, with limits that suit them: the papers' curves, and what tests make others of.

use feed_plan::{Junction, KinematicLimits, ProfileKind};
use nurbs_core::NurbsBuf;

use crate::RandomPath;

/// Curves at a feed in mm a period, within limits that suit it.
#[must_use]
pub fn curves_at<const D: usize>(feedrate: f64, curves: Vec<NurbsBuf<f64, D>>) -> RandomPath<D> {
    let limits = KinematicLimits {
        interpolation_period: 1.0,
        feedrate,
        acceleration: feedrate / 15.0,
        jerk: feedrate / 60.0,
        chord_error: 5e-4,
        centripetal_acceleration: None,
        axes: Default::default(),
        junction: Default::default(),
    };
    RandomPath { curves, limits, profile: ProfileKind::Cubic, max_evaluations: 5, piece_mm: 32.0 }
}

/// Paper A's curve, seven points, 300 mm wide.
#[must_use]
pub fn paper_a() -> RandomPath<2> {
    let points = [[150, 150], [0, 0], [0, 300], [150, 150], [300, 0], [300, 300], [150, 150]];
    let points = points.map(|p| p.map(f64::from)).to_vec();
    curves_at(
        0.6,
        NurbsBuf::try_new_nonrational(3, points, clamped(3, &[0.25, 0.5, 0.75])).into_iter().collect(),
    )
}

/// The rational curve of ten points, in space.
#[must_use]
pub fn ten_points() -> RandomPath<3> {
    let x = [0.0, 10.0, 20.0, 30.0, 40.0, 50.0, 60.0, 65.0, 70.0, 80.0];
    let y = [15.0, 34.1, 10.1, 16.1, 0.9, 38.0, 2.9, 8.9, 26.1, 5.9];
    let points = x.into_iter().zip(y).map(|(x, y)| [x, y, 0.1 * x]).collect();
    let weights = vec![1.0, 2.0, 1.5, 1.0, 1.0, 2.0, 1.0, 1.0, 2.0, 1.0];
    let knots = clamped(3, &[0.1836, 0.2781, 0.3837, 0.5474, 0.7104, 0.8049]);
    curves_at(0.15, NurbsBuf::try_new(3, points, weights, knots).into_iter().collect())
}

/// Straight lines around a square, with a stop at each corner, and further on through a slight corner.
#[must_use]
pub fn lines() -> RandomPath<2> {
    curves_at(0.5, polyline(&[[0.0, 0.0], [40.0, 0.0], [40.0, 40.0], [0.0, 40.0], [-20.0, 41.0]]))
}

/// The path with corners that are passed within a hundredth of a millimetre.
#[must_use]
pub fn passing<const D: usize>(mut path: RandomPath<D>) -> RandomPath<D> {
    path.limits.junction = Junction::Deviation(0.01);
    path
}

/// Straight lines from corner to corner.
///
/// # Panics
/// If two corners that follow each other are no line.
#[must_use]
pub fn polyline<const D: usize>(corners: &[[f64; D]]) -> Vec<NurbsBuf<f64, D>> {
    corners.windows(2).map(|ends| bezier(ends, &[])).collect()
}

/// The Bézier curve of these points; all weights are 1 if none are given.
///
/// # Panics
/// If there is no such curve.
#[must_use]
pub fn bezier<const D: usize>(points: &[[f64; D]], weights: &[f64]) -> NurbsBuf<f64, D> {
    let degree = points.len() - 1;
    let weights = if weights.is_empty() { vec![1.0; points.len()] } else { weights.to_vec() };
    NurbsBuf::try_new(degree, points.to_vec(), weights, clamped(degree, &[])).expect("a curve")
}

/// The knot vector over [0, 1] with these inner knots.
fn clamped(degree: usize, inner: &[f64]) -> Vec<f64> {
    [&vec![0.0; degree + 1], inner, &vec![1.0; degree + 1]].concat()
}
