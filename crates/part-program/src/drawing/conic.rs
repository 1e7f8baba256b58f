//! ARC, CIRCLE and ELLIPSE, and the arcs of polylines, as rational curves of degree 2.
//!
//! An ellipse is `C(θ) = M + cos θ a + sin θ b` with two vectors a and b; for a circle they are perpendicular and
//! equally long. The span about θ with the half angle h is the conic with the control points `C(θ - h)`, `M + (cos θ a
//! + sin θ b) / cos h`, `C(θ + h)` and the weights (1, cos h, 1): it is the affine image of an arc of the unit circle.

use std::f64::consts::{FRAC_PI_2, TAU};

use domains::shown;

use super::affine::{Affine, sin_cos, unit};
use super::groups::Entity;
use super::item::Item;
use crate::curve::{Curve, Nurbs};
use crate::diagnostic::Report;
use crate::moves::Shape;
use crate::vector::{cross, difference, length};

/// An arc of less than this share of a turn is a full turn: the share is the rounding of 360°.
const NO_TURN: f64 = 1e-9;
/// The same share for an arc whose two angles are written as different numbers, such as 0 and 6.283186.
const NO_TURN_AS_WRITTEN: f64 = 1e-6;

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
fn conic(points: Vec<[f64; 3]>, weights: Vec<f64>) -> Curve {
    let spans = u8::try_from(points.len() / 2).unwrap_or(u8::MAX);
    let mut knots = vec![0.0];
    knots.extend((0..=spans).flat_map(|i| [f64::from(i) / f64::from(spans); 2]));
    knots.push(1.0);
    let dimension = Nurbs::dimension_of(&points);
    Nurbs { degree: 2, control_points_mm: points, dimension, weights, knots }.into()
}

/// The arc of a polyline from one point to another in their plane. Its bulge b is the tangent of a quarter of the angle
/// turned, counterclockwise positive: with the chord (x, y) the centre is `(1 - b²)/4b (-y, x)` from its middle, and the tangents of
/// a short arc meet `b/(1 - b²) (y, -x)` from it.
pub(crate) fn bulged(from: [f64; 3], to: [f64; 3], bulge: f64) -> Curve {
    let chord = difference(&to, &from);
    let beside_middle = |share: f64| {
        let left = [-chord[1] * share, chord[0] * share, 0.0];
        std::array::from_fn::<f64, 3, _>(|axis| f64::midpoint(from[axis], to[axis]) + left[axis])
    };
    let square = bulge * bulge;
    let half_cos = (1.0 - square) / (1.0 + square);
    if half_cos >= std::f64::consts::FRAC_1_SQRT_2 {
        // With a bulge of 0 the centre is at infinity.
        let meet = beside_middle(-bulge / (1.0 - square));
        return conic(vec![from, meet, to], vec![1.0, half_cos, 1.0]);
    }
    let centre = beside_middle((1.0 / bulge - bulge) / 4.0);
    let [x, y, _] = difference(&from, &centre);
    let circle = Ellipse { centre, major: [x, y, 0.0], minor: [-y, x, 0.0] };
    let mut curve = circle.arc(0.0, 4.0 * bulge.atan());
    let points = curve.control_points_mm_mut();
    let last = points.len() - 1;
    (points[0], points[last]) = (from, to);
    curve
}

/// Whether a conic is an arc of a circle: the half chord of a span is the cosine of its half angle times each tangent.
pub(crate) fn is_circular(curve: &Curve) -> bool {
    let ([from, meet, to, ..], [_, cos, ..]) = (curve.control_points_mm(), curve.weights()) else {
        return false;
    };
    let (first, last) = (length(difference(meet, from)), length(difference(to, meet)));
    let half_chord = length(difference(to, from)) / 2.0;
    [first, last].iter().all(|leg| (leg * cos - half_chord).abs() <= 1e-9 * half_chord)
}

/// The angle from `first` to `last`, counterclockwise, where `full` is a full turn. Equal angles give a full turn.
fn sweep(first: f64, last: f64, full: f64) -> f64 {
    let between = last - first;
    let sweep = between.rem_euclid(full);
    let none = if between.abs() > full / 2.0 { NO_TURN_AS_WRITTEN } else { NO_TURN };
    if sweep <= none * full || sweep >= full { full } else { sweep }
}

/// Reads an ARC or a CIRCLE.
pub(crate) fn read_circle<'t>(entity: &Entity<'t>, report: &mut Report<'_>, items: &mut Vec<Item<'t>>) {
    let plane = entity.plane(report);
    let centre = entity.point(report, 10, "centre");
    let radius = entity.needed(report, 40, "radius");
    let angles = match entity.name {
        "CIRCLE" => Some((0.0, 360.0)),
        _ => {
            let first = entity.needed(report, 50, "first angle");
            first.zip(entity.needed(report, 51, "last angle"))
        }
    };
    let (Some(plane), Some(centre), Some(radius), Some((first, last))) = (plane, centre, radius, angles)
    else {
        return;
    };
    if radius <= 0.0 {
        report.error(entity.span, format!("the radius is {}", shown(radius))).expected("a radius above 0");
        return;
    }
    let circle = Ellipse { centre, major: [radius, 0.0, 0.0], minor: [0.0, radius, 0.0] };
    let sweep = sweep(first, last, 360.0);
    let curve = circle.arc(first.rem_euclid(360.0).to_radians(), sweep.to_radians());
    items.push(Item::Curve { curve: plane.curve(curve), shape: Shape::Arc, span: entity.span });
}

/// Reads an ELLIPSE. Its points are in the drawing's coordinates, whatever its plane.
pub(crate) fn read_ellipse<'t>(entity: &Entity<'t>, report: &mut Report<'_>, items: &mut Vec<Item<'t>>) {
    let plane = entity.plane(report);
    let (centre, major) = (entity.point(report, 10, "centre"), entity.point(report, 11, "major axis"));
    let ratio = entity.needed(report, 40, "ratio of its axes");
    let first = entity.number(report, 41).unwrap_or(0.0);
    let last = entity.number(report, 42).unwrap_or(TAU);
    let (Some(plane), Some(centre), Some(major), Some(ratio)) = (plane, centre, major, ratio) else { return };
    if first.is_nan() || last.is_nan() {
        // The number has been reported as invalid.
        return;
    }
    let Some(normal) = unit(plane.axes[2]).filter(|_| ratio > 0.0 && length(major) > 0.0) else {
        let message =
            format!("the axes of this ELLIPSE are {} long and {} of it", shown(length(major)), shown(ratio));
        report.error(entity.span, message).expected("axes with a length");
        return;
    };
    let minor = cross(normal, major).map(|x| x * ratio);
    let curve = Ellipse { centre, major, minor }.arc(first, sweep(first, last, TAU));
    let shape = if is_circular(&curve) { Shape::Arc } else { Shape::Nurbs };
    items.push(Item::Curve { curve, shape, span: entity.span });
}

/// A curve that an inserted block maps: a circular arc may become another conic.
pub(crate) fn mapped(map: &Affine, curve: Curve, shape: Shape) -> (Curve, Shape) {
    let curve = map.curve(curve);
    let shape = if shape == Shape::Arc && !is_circular(&curve) { Shape::Nurbs } else { shape };
    (curve, shape)
}
