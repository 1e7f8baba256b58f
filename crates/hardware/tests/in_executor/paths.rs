//! Paths of the kinds whose C differs.

use feed_plan::{Junction, KinematicLimits, ProfileKind};
use nurbs_core::NurbsBuf;
use stress::RandomPath;

/// Curves at a feed in mm a period, within limits that suit it.
pub(crate) fn at<const D: usize>(feedrate: f64, curves: Vec<NurbsBuf<f64, D>>) -> RandomPath<D> {
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
pub(crate) fn paper_a() -> RandomPath<2> {
    let points = [[150, 150], [0, 0], [0, 300], [150, 150], [300, 0], [300, 300], [150, 150]];
    let points = points.map(|p| p.map(f64::from)).to_vec();
    at(0.6, NurbsBuf::try_new_nonrational(3, points, clamped(3, &[0.25, 0.5, 0.75])).into_iter().collect())
}

/// The rational curve of ten points, in space.
pub(crate) fn ten_points() -> RandomPath<3> {
    let x = [0.0, 10.0, 20.0, 30.0, 40.0, 50.0, 60.0, 65.0, 70.0, 80.0];
    let y = [15.0, 34.1, 10.1, 16.1, 0.9, 38.0, 2.9, 8.9, 26.1, 5.9];
    let points = x.into_iter().zip(y).map(|(x, y)| [x, y, 0.1 * x]).collect();
    let weights = vec![1.0, 2.0, 1.5, 1.0, 1.0, 2.0, 1.0, 1.0, 2.0, 1.0];
    let knots = clamped(3, &[0.1836, 0.2781, 0.3837, 0.5474, 0.7104, 0.8049]);
    at(0.15, NurbsBuf::try_new(3, points, weights, knots).into_iter().collect())
}

/// A curve of degree 5 in the plane.
pub(crate) fn quintic() -> RandomPath<2> {
    let points: Vec<_> = (0..6).map(|i| [0.3 * f64::from(i), 0.2 * f64::from(i * i % 5)]).collect();
    at(0.02, NurbsBuf::try_new_nonrational(5, points, clamped(5, &[])).into_iter().collect())
}

/// Straight lines with a stop at each corner: a section each.
pub(crate) fn lines() -> RandomPath<2> {
    at(0.5, polyline(&[[0.0, 0.0], [40.0, 0.0], [40.0, 40.0], [0.0, 40.0], [-20.0, 41.0]]))
}

/// Straight lines in space whose corners are passed within a hundredth of a millimetre.
pub(crate) fn corners() -> RandomPath<3> {
    let mut path = at(0.02, polyline(&[[0.0, 0.0, 0.0], [1.0, 0.0, 0.5], [2.0, 0.1, 1.0], [2.0, 1.0, 1.0]]));
    path.limits.junction = Junction::Deviation(0.01);
    path
}

fn polyline<const D: usize>(corners: &[[f64; D]]) -> Vec<NurbsBuf<f64, D>> {
    let line =
        |ends: &[[f64; D]]| NurbsBuf::try_new_nonrational(1, ends.to_vec(), clamped(1, &[])).expect("a line");
    corners.windows(2).map(line).collect()
}

/// The knot vector over [0, 1] with these inner knots.
fn clamped(degree: usize, inner: &[f64]) -> Vec<f64> {
    [&vec![0.0; degree + 1], inner, &vec![1.0; degree + 1]].concat()
}
