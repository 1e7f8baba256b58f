//! Affine maps: planes of entities, inserted blocks, and the drawing's unit.
//!
//! The points of a rational curve are means of its control points with shares that sum to 1. So an affine map of the
//! control points maps the curve, with no error but rounding: an arc that is scaled unevenly becomes an arc of an
//! ellipse.
//!
//! # Source
//! Autodesk, DXF Reference, "Arbitrary Axis Algorithm".

use crate::curve::Curve;
use crate::vector::{cross, sin_cos, unit};

/// The map `p ↦ origin + x axes[0] + y axes[1] + z axes[2]`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Affine {
    pub(crate) axes: [[f64; 3]; 3],
    pub(crate) origin: [f64; 3],
}

impl Affine {
    /// Multiplies each coordinate.
    pub(crate) fn scaling(factors: [f64; 3]) -> Self {
        let [x, y, z] = factors;
        Self { axes: [[x, 0.0, 0.0], [0.0, y, 0.0], [0.0, 0.0, z]], origin: [0.0; 3] }
    }

    /// Moves by a vector.
    pub(crate) fn moving(by: [f64; 3]) -> Self {
        Self { origin: by, ..Self::scaling([1.0; 3]) }
    }

    /// Turns about the z axis, counterclockwise.
    pub(crate) fn turning(angle: f64) -> Self {
        let (sin, cos) = sin_cos(angle);
        Self { axes: [[cos, sin, 0.0], [-sin, cos, 0.0], [0.0, 0.0, 1.0]], origin: [0.0; 3] }
    }

    /// Maps the coordinates of an entity whose plane has this normal to the drawing's; `None` if the normal has no
    /// direction.
    ///
    /// The x axis of the plane is the drawing's y axis × the normal if the normal is within 1/64 of the drawing's z
    /// axis, otherwise the drawing's z axis × the normal.
    pub(crate) fn of_plane(normal: [f64; 3]) -> Option<Self> {
        const NEAR: f64 = 1.0 / 64.0;
        let z = unit(normal)?;
        let across = if z[0].abs() < NEAR && z[1].abs() < NEAR { [0.0, 1.0, 0.0] } else { [0.0, 0.0, 1.0] };
        let x = unit(cross(across, z))?;
        Some(Self { axes: [x, cross(z, x), z], origin: [0.0; 3] })
    }

    /// The image of a point.
    pub(crate) fn point(&self, point: [f64; 3]) -> [f64; 3] {
        let turned = self.direction(point);
        std::array::from_fn(|axis| turned[axis] + self.origin[axis])
    }

    /// The image of a difference of points.
    pub(crate) fn direction(&self, [x, y, z]: [f64; 3]) -> [f64; 3] {
        std::array::from_fn(|axis| x * self.axes[0][axis] + y * self.axes[1][axis] + z * self.axes[2][axis])
    }

    /// The map that applies first the other map and then this one.
    pub(crate) fn after(&self, first: &Self) -> Self {
        Self { axes: first.axes.map(|axis| self.direction(axis)), origin: self.point(first.origin) }
    }

    /// Maps a curve.
    pub(crate) fn curve(&self, mut curve: Curve) -> Curve {
        curve.move_points(|point| *point = self.point(*point));
        curve
    }
}
