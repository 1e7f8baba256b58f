//! A point in space, in mm.

pub(crate) type Point = [f64; 3];

/// The distance of two points.
pub(crate) fn distance(p: Point, q: Point) -> f64 {
    (p[0] - q[0]).hypot(p[1] - q[1]).hypot(p[2] - q[2])
}
