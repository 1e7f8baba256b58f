//! Paths of the kinds whose C differs.

use stress::{RandomPath, bezier, curves_at, passing, polyline};

pub(crate) use stress::{lines, paper_a, ten_points};

/// A curve of degree 5 in the plane.
pub(crate) fn quintic() -> RandomPath<2> {
    let points: Vec<_> = (0..6).map(|i| [0.3 * f64::from(i), 0.2 * f64::from(i * i % 5)]).collect();
    curves_at(0.02, vec![bezier(&points, &[])])
}

/// Straight lines in space whose corners are passed.
pub(crate) fn corners() -> RandomPath<3> {
    let corners = [[0.0, 0.0, 0.0], [1.0, 0.0, 0.5], [2.0, 0.1, 1.0], [2.0, 1.0, 1.0]];
    passing(curves_at(0.02, polyline(&corners)))
}
