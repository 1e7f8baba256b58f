//! Siemens' arcs: through a point, tangent to the move before, and by the angle that they turn.
//!
//! `CIP X Y Z I1= J1= K1=` passes the point that I1, J1 and K1 give, in any plane of space. `CT X Y` begins in the direction
//! in which the move before ends, in the plane in force. `G2 X Y AR=` and `G2 I J AR=` turn by an angle of more than 0°
//! and less than 360°, with the end or the centre given.
//!
//! # Source
//! SINUMERIK 840D sl / 828D, Programming Manual Fundamentals, "Circular interpolation".

use std::f64::consts::TAU;

use domains::shown;

use crate::arc::{ArcMove, Circle, Plane};
use crate::curve::Curve;
use crate::ellipse::Ellipse;
use crate::gcode::block::Block;
use crate::gcode::reader::Reader;
use crate::gcode::word::{Key, Word};
use crate::joint::is_joined;
use crate::moves::{MoveKind, Shape};
use crate::vector::{cross, difference, dot, length, unit};

/// A sine below which two directions are one.
const STRAIGHT: f64 = 1e-9;

/// What an arc with an angle has besides: the radius, the centre, and whether its end is written.
pub(crate) type BesideAngle = (Option<Word>, Option<[f64; 2]>, bool);

impl Reader<'_, '_, '_> {
    /// CIP.
    pub(crate) fn through_point(&mut self, block: &mut Block<'_>, inverse_feed: Option<f64>) {
        let span = block.span;
        let middle = [0, 1, 2].map(|axis| block.take(Key::Middle(axis)).map(|word| word.value));
        let is_known = self.start_is_known(self.modal.plane, span);
        let middle = Some(middle).filter(|middle| *middle != [None; 3]);
        let Some(middle) = middle.map(|middle| self.modal.target(self.modal.here(), middle)) else {
            self.report.error(span, "CIP without its point in between").expected("I1=, J1= or K1=");
            self.pass_over(block);
            return;
        };
        let Some((start, end)) = self.ends(block).filter(|_| is_known) else { return };
        let Some((curve, length)) = arc_through([start, middle, end]) else {
            self.report
                .error(span, "start, middle and end of this arc are on one line")
                .expected("three places on a circle");
            return;
        };
        let feed = self.feedrate(length, inverse_feed, span);
        if let Some(fault) = curve.faults().first() {
            self.report.error(span, fault.to_string()).expected(fault.expected());
            return;
        }
        self.push(curve, MoveKind::Feed, Shape::Arc, feed, self.place(span));
    }

    /// CT.
    pub(crate) fn tangent(&mut self, block: &mut Block<'_>, inverse_feed: Option<f64>) {
        let (span, plane) = (block.span, self.modal.plane);
        let [first, second, _] = plane.axes();
        let is_known = self.start_is_known(plane, span) && self.may_turn(plane, span);
        let Some((start, end)) = self.ends(block).filter(|_| is_known) else { return };
        let direction = self.direction_before(start).map(|way| [way[first], way[second]]);
        let Some([x, y]) = direction.filter(|[x, y]| x.hypot(*y) > STRAIGHT) else {
            self.report
                .error(span, "CT behind no move whose direction it could go on with")
                .expected("a move in the plane before it");
            return;
        };
        let (x, y) = (x / x.hypot(y), y / x.hypot(y));
        let (along, across) = (end[first] - start[first], end[second] - start[second]);
        let (ahead, aside) = (x * along + y * across, x * across - y * along);
        let chord = along.hypot(across);
        if aside.abs() <= STRAIGHT * chord {
            if ahead > 0.0 {
                self.push_line([start, end], MoveKind::Feed, inverse_feed, span);
            } else {
                self.report
                    .error(span, "the end of CT is straight behind its start")
                    .expected("an end that an arc reaches which begins along the move before");
            }
            return;
        }
        // The chord d of an arc that begins along t has the signed radius d²/(2 t×d), on the left of t.
        let radius = chord * chord / (2.0 * aside);
        let centre = [start[first] - radius * y, start[second] + radius * x];
        let arc = ArcMove::new(plane, aside < 0.0, [start, end], Circle::Centre(centre));
        match arc.curve() {
            Ok((curve, length)) => {
                let feed = self.feedrate(length, inverse_feed, span);
                self.push(curve, MoveKind::Feed, Shape::Arc, feed, self.place(span));
            }
            Err(fault) => self.refuse_arc(fault, span),
        }
    }

    /// The unit vector along the end of the last move, if it ends here.
    fn direction_before(&self, here: [f64; 3]) -> Option<[f64; 3]> {
        let points = self.part.curves.last().filter(|_| self.goes_on)?.control_points_mm();
        let (end, before) = points.split_last().filter(|(end, _)| is_joined(end, &here))?;
        let from = before.iter().rev().find(|point| *point != end)?;
        unit(difference(end, from))
    }

    /// The circle of an arc that turns by an angle.
    pub(crate) fn by_angle(
        &mut self,
        angle: Option<Word>,
        (radius, centre, names_end): BesideAngle,
        [start, end]: [[f64; 3]; 2],
    ) -> Option<Circle> {
        let angle = angle?;
        let [first, second, _] = self.modal.plane.axes();
        if !(angle.value > 0.0 && angle.value < 360.0) {
            let message = format!("an arc that turns by {}°", shown(angle.value));
            self.report.error(angle.span, message).expected("AR= of more than 0 and less than 360");
            return None;
        }
        match (radius, centre, names_end) {
            (None, Some(centre), false) => Some(Circle::Centre(centre)),
            (None, None, true) => {
                let chord = (end[first] - start[first]).hypot(end[second] - start[second]);
                let radius = chord / 2.0 / (angle.value / 2.0).to_radians().sin();
                Some(Circle::Radius(if angle.value > 180.0 { -radius } else { radius }))
            }
            _ => {
                self.report
                    .error(angle.span, "an arc by its angle has its end, or its centre")
                    .expected("AR= with X and Y, or with I and J");
                None
            }
        }
    }

    /// Turns the tool's place about a centre, in degrees, counterclockwise positive.
    pub(crate) fn turn_to(&mut self, start: [f64; 3], centre: [f64; 2], angle: f64) -> [f64; 3] {
        let [first, second, _] = self.modal.plane.axes();
        let (sin, cos) = angle.to_radians().sin_cos();
        let (x, y) = (start[first] - centre[0], start[second] - centre[1]);
        let mut end = self.modal.here();
        (end[first], end[second]) = (centre[0] + x * cos - y * sin, centre[1] + x * sin + y * cos);
        for axis in [first, second] {
            self.modal.position[axis] = Some(end[axis]);
        }
        end
    }

    /// Reports an arc in a plane that an offset turns against the part's.
    pub(crate) fn may_turn(&mut self, plane: Plane, span: crate::source::Span) -> bool {
        let is_turned = plane != Plane::Xy && self.modal.turned([1.0, 0.0, 0.0])[1] != 0.0;
        if is_turned {
            self.report
                .error(span, "an arc in another plane than G17, while an offset turns the coordinates against the part")
                .expected("the offset that turns before the first move");
        }
        !is_turned
    }
}

/// The arc through three places and its length, in mm; `None` if they are on one line.
fn arc_through([start, middle, end]: [[f64; 3]; 3]) -> Option<(Curve, f64)> {
    let (a, b) = (difference(&middle, &start), difference(&end, &start));
    let normal = cross(a, b);
    let twice = 2.0 * dot(normal, normal);
    if length(normal) <= STRAIGHT * length(a) * length(b) {
        return None;
    }
    let (across, along) = (cross(normal, a), cross(b, normal));
    let to_centre: [f64; 3] =
        std::array::from_fn(|axis| (dot(b, b) * across[axis] + dot(a, a) * along[axis]) / twice);
    let centre: [f64; 3] = std::array::from_fn(|axis| start[axis] + to_centre[axis]);
    let major = difference(&start, &centre);
    let minor = cross(unit(normal)?, major);
    let way = difference(&end, &centre);
    let sweep = dot(way, minor).atan2(dot(way, major)).rem_euclid(TAU);
    let mut curve = Ellipse { centre, major, minor }.arc(0.0, sweep);
    if let [first, .., last] = curve.control_points_mm_mut() {
        (*first, *last) = (start, end);
    }
    Some((curve, length(major) * sweep))
}
