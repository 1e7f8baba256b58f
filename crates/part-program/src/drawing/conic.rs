//! ARC, CIRCLE and ELLIPSE, and the arcs of polylines, as rational curves of degree 2.

use std::f64::consts::TAU;

use domains::shown;

use super::affine::Affine;
use super::groups::Entity;
use super::item::Item;
use crate::curve::Curve;
use crate::diagnostic::Report;
use crate::ellipse::{Ellipse, conic};
use crate::moves::Shape;
use crate::vector::{cross, difference, length, unit};

/// An arc of less than this share of a turn is a full turn: the share is the rounding of 360°.
const NO_TURN: f64 = 1e-9;
/// The same share for an arc whose two angles are written as different numbers, such as 0 and 6.283186.
const NO_TURN_AS_WRITTEN: f64 = 1e-6;

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
