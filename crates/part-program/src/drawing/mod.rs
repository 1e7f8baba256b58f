//! DXF drawings: SPLINE, LINE, ARC, CIRCLE and LWPOLYLINE, in the order of the file, in millimetres.
//!
//! | entity | groups that are read |
//! |---|---|
//! | SPLINE | 71 degree, 40 knots, 41 weights, 10 20 30 control points; 72 and 73 are their numbers |
//! | LINE | 10 20 30 start, 11 21 31 end |
//! | ARC, CIRCLE | 10 20 30 centre, 40 radius, 50 and 51 first and last angle in degrees, counterclockwise |
//! | LWPOLYLINE | 10 20 vertices, 42 bulge of the segment that follows, 38 height, 70 whether it is closed |
//!
//! What is drawn on paper (67), what is invisible (60) or on a layer that is frozen (70, bit 1) or off (62 below 0), and
//! every other entity is left out, with a warning that counts it. $INSUNITS gives the
//! unit. A plane that is turned over (210 220 230 = 0 0 -1) is turned back; others are refused.
//!
//! # Source
//! Autodesk, DXF Reference, chapters "ENTITIES section" and "Object coordinate systems".

mod groups;

use std::collections::{BTreeMap, HashSet};

use crate::arc::{ArcFault, ArcMove, Circle, Plane};
use crate::curve::Curve;
use crate::diagnostic::Report;
use crate::part::{Move, MoveKind, Part, Shape};
use crate::source::Span;
use crate::spline_blocks::SplineBlocks;
use crate::unit::INCH;
use groups::{Entity, Groups};

/// Whether a text is a drawing: pairs of a group code and a value, the first of them `0` and `SECTION`.
pub(crate) fn is_drawing(text: &str) -> bool {
    let mut groups = Groups::new(text);
    loop {
        match groups.next(None) {
            Some(comment) if comment.code == 999 => {}
            first => return first.is_some_and(|first| first.code == 0 && first.text == "SECTION"),
        }
    }
}

/// Reads a drawing into `part`.
pub(crate) fn read(report: &mut Report<'_>, part: &mut Part) {
    let unit = unit(report);
    let mut drawing =
        Drawing { report, part, unit, hidden_layers: HashSet::new(), left_out: BTreeMap::new() };
    drawing.sections();
    let left_out = std::mem::take(&mut drawing.left_out);
    for (name, (count, first)) in left_out {
        report.warning(first, format!("{count} × {name} left out: not read as a path"));
    }
    if part.curves.is_empty() && !report.has_errors() {
        report
            .error(Span::default(), "the drawing holds no curve")
            .expected("an entity SPLINE, LINE, ARC, CIRCLE or LWPOLYLINE");
    }
}

/// Millimetres of the drawing's unit; 1 once something is said about it.
fn unit(report: &mut Report<'_>) -> f64 {
    let mut groups = Groups::new(report.source.text);
    while let Some(group) = groups.next(None) {
        if (group.code, group.text) == (0, "ENDSEC") {
            break;
        }
        if (group.code, group.text) != (9, "$INSUNITS") {
            continue;
        }
        let Some(value) = groups.next(None) else { break };
        return match value.text {
            "1" => INCH,
            "2" => 12.0 * INCH,
            "4" => 1.0,
            "5" => 10.0,
            "6" => 1000.0,
            "0" => no_unit(report, value.span),
            other => {
                report
                    .error(value.span, format!("the drawing is in the unit {other}"))
                    .expected("1 inches, 2 feet, 4 millimetres, 5 centimetres or 6 metres");
                1.0
            }
        };
    }
    no_unit(report, Span::default())
}

fn no_unit(report: &mut Report<'_>, span: Span) -> f64 {
    report.warning(span, "the drawing names no unit: its numbers are taken as millimetres");
    1.0
}

struct Drawing<'r, 't, 'p> {
    report: &'r mut Report<'t>,
    part: &'p mut Part,
    unit: f64,
    /// Names of the layers that are frozen or off, in lower case: a drawing's names have no case.
    hidden_layers: HashSet<String>,
    /// By name, how many, and where the first is.
    left_out: BTreeMap<String, (usize, Span)>,
}

impl<'t> Drawing<'_, 't, '_> {
    /// Reads to the end of the file: layers where the section TABLES is, entities where ENTITIES is, nothing elsewhere.
    fn sections(&mut self) {
        let mut groups = Groups::new(self.report.source.text);
        let (mut section, mut entity): (&str, Option<Entity<'t>>) = ("", None);
        let mut is_new = false;
        while let Some(group) = groups.next(Some(self.report)) {
            if group.code == 0 {
                match entity.take() {
                    Some(layer) if section == "TABLES" => self.layer(&layer),
                    Some(entity) => self.entity(&entity),
                    None => {}
                }
                match group.text {
                    "EOF" => return,
                    "SECTION" => is_new = true,
                    "ENDSEC" => section = "",
                    name if section == "ENTITIES" || (section == "TABLES" && name == "LAYER") => {
                        entity = Some(Entity { name, span: group.span, groups: Vec::new() });
                    }
                    _ => {}
                }
            } else if let Some(entity) = &mut entity {
                entity.groups.push(group);
            } else if is_new && group.code == 2 {
                (section, is_new) = (group.text, false);
            }
        }
        if !self.report.has_errors() {
            let end = self.report.source.text.len();
            self.report.error(Span::new(end, end), "the drawing is cut off").expected("a group 0 with EOF");
        }
    }

    fn layer(&mut self, layer: &Entity<'t>) {
        let number = |code: i32| layer.text(code).and_then(|text| text.parse::<i32>().ok());
        let is_frozen = number(70).is_some_and(|flags| flags & 1 == 1);
        let is_off = number(62).is_some_and(|colour| colour < 0);
        if let Some(name) = layer.text(2).filter(|_| is_frozen || is_off) {
            self.hidden_layers.insert(name.to_lowercase());
        }
    }

    fn entity(&mut self, entity: &Entity<'t>) {
        let on_paper = entity.text(67) == Some("1");
        let on_hidden_layer =
            entity.text(8).is_some_and(|layer| self.hidden_layers.contains(&layer.to_lowercase()));
        let is_hidden = on_hidden_layer || entity.text(60) == Some("1");
        match entity.name {
            // They belong to an entity that was left out itself.
            "VERTEX" | "SEQEND" | "ATTRIB" if is_hidden => {}
            name if is_hidden => self.leave_out(&format!("hidden {name}"), entity.span),
            name if on_paper => self.leave_out(&format!("{name} on paper"), entity.span),
            "SPLINE" => self.spline(entity),
            "LINE" => self.line(entity),
            "ARC" | "CIRCLE" => self.arc(entity),
            "LWPOLYLINE" => self.polyline(entity),
            // These belong to the entity before them.
            "VERTEX" | "SEQEND" | "ATTRIB" => {}
            name => self.leave_out(name, entity.span),
        }
    }

    fn leave_out(&mut self, name: &str, span: Span) {
        self.left_out.entry(name.chars().take(40).collect()).or_insert((0, span)).0 += 1;
    }

    fn scaled(&self, point: [f64; 3]) -> [f64; 3] {
        point.map(|x| x * self.unit)
    }

    fn spline(&mut self, entity: &Entity<'t>) {
        let points = entity.points(self.report, 10);
        if points.is_empty() {
            self.report
                .error(entity.span, "this SPLINE has no control points")
                .expected("groups 10, 20 and 30")
                .hint("a spline by fit points alone is not one curve but a family: convert it where it was drawn");
            return;
        }
        let weights = entity.numbers(self.report, 41);
        let knots = entity.numbers(self.report, 40);
        for (code, what, found) in [(72, "knots", knots.len()), (73, "control points", points.len())] {
            #[allow(clippy::cast_precision_loss, reason = "a drawing has fewer than 2⁵³ of anything")]
            let found = found as f64;
            if let Some(stated) = entity.number(self.report, code).filter(|stated| *stated != found) {
                self.report
                    .error(
                        entity.span,
                        format!("this SPLINE has {found} {what} and says that it has {stated}"),
                    )
                    .expected(format!("group {code} to be their number"));
            }
        }
        let Some(degree) = entity.needed(self.report, 71, "degree") else { return };
        let numbers = points.iter().flat_map(|(point, _)| point);
        if numbers.chain(weights.iter().chain(&knots).map(|(number, _)| number)).any(|number| number.is_nan())
        {
            // It has been said to be none.
            return;
        }
        let mut blocks = SplineBlocks { start: entity.span, knots, ..SplineBlocks::default() };
        blocks.weights = match weights.is_empty() {
            true => points.iter().map(|(_, span)| (1.0, *span)).collect(),
            false => weights,
        };
        blocks.points = points.into_iter().map(|(point, span)| (self.scaled(point), span)).collect();
        #[allow(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "255 is no degree either")]
        let degree = if degree.fract() == 0.0 { degree.clamp(0.0, 255.0) as usize } else { 0 };
        if let Some(curve) = blocks.finish(degree, self.report, |_| None) {
            self.push(curve, Shape::Nurbs, entity.span);
        }
    }

    fn line(&mut self, entity: &Entity<'t>) {
        let (from, to) = (entity.points(self.report, 10), entity.points(self.report, 11));
        match (from.as_slice(), to.as_slice()) {
            ([(from, _)], [(to, _)]) => self.straight(self.scaled(*from), self.scaled(*to), entity.span),
            _ => {
                self.report
                    .error(entity.span, "a LINE has two ends")
                    .expected("groups 10, 20, 30 and 11, 21, 31, once each");
            }
        }
    }

    fn straight(&mut self, from: [f64; 3], to: [f64; 3], span: Span) {
        if from == to {
            self.part.standstills.push(self.report.source.line_number(span.start));
        } else {
            self.push(Curve::line(from, to), Shape::Line, span);
        }
    }

    fn arc(&mut self, entity: &Entity<'t>) {
        let Some(turned_over) = self.plane(entity) else { return };
        let centre = entity.points(self.report, 10);
        let &[(centre, _)] = centre.as_slice() else {
            let message = format!("this {} has {} centres", entity.name, centre.len());
            self.report.error(entity.span, message).expected("groups 10, 20 and 30 once");
            return;
        };
        let Some(radius) = entity.needed(self.report, 40, "radius") else { return };
        let angles = match entity.name {
            "CIRCLE" => Some((0.0, 0.0)),
            _ => entity.needed(self.report, 50, "first angle").zip(entity.needed(
                self.report,
                51,
                "last angle",
            )),
        };
        let Some((first, last)) = angles else { return };
        if radius <= 0.0 {
            self.report.error(entity.span, format!("the radius is {radius}")).expected("a radius above 0");
            return;
        }
        let (centre, radius) = (self.scaled(centre), radius * self.unit);
        let at = |degrees: f64| {
            let (sin, cos) = degrees.rem_euclid(360.0).to_radians().sin_cos();
            [centre[0] + radius * cos, centre[1] + radius * sin, centre[2]]
        };
        let circle = Circle::Centre([centre[0], centre[1]]);
        self.round(at(first), at(last), circle, false, turned_over, entity.span);
    }

    fn polyline(&mut self, entity: &Entity<'t>) {
        let Some(turned_over) = self.plane(entity) else { return };
        let height = entity.number(self.report, 38).unwrap_or(0.0);
        let closed = entity.number(self.report, 70).unwrap_or(0.0).rem_euclid(2.0) >= 1.0;
        let points = entity.points(self.report, 10);
        // A bulge follows the vertex it belongs to.
        let mut bulges = Vec::with_capacity(points.len());
        for group in &entity.groups {
            match group.code {
                10 => bulges.push(0.0),
                42 => match (bulges.last_mut(), group.text.parse::<f64>()) {
                    (Some(bulge), Ok(value)) if value.is_finite() => *bulge = value,
                    _ => {
                        self.report
                            .error(group.span, "this bulge is none")
                            .expected("a number after the vertex it belongs to");
                    }
                },
                _ => {}
            }
        }
        let vertices: Vec<_> = points.iter().map(|([x, y, _], _)| self.scaled([*x, *y, height])).collect();
        let next = vertices.iter().skip(1).chain(vertices.first().filter(|_| closed && vertices.len() > 1));
        for (index, (from, to)) in vertices.iter().zip(next).enumerate() {
            self.segment(*from, *to, bulges[index], turned_over, points[index].1);
        }
        if vertices.len() < 2 {
            self.report.error(entity.span, "this LWPOLYLINE has no length").expected("two vertices or more");
        }
    }

    /// A segment of a polyline. Its bulge b is the tangent of a quarter of the angle turned, counterclockwise positive,
    /// so that with the chord c the radius is `c (1 + b²) / 4b`.
    fn segment(&mut self, from: [f64; 3], to: [f64; 3], bulge: f64, turned_over: bool, span: Span) {
        if bulge == 0.0 || from == to {
            return self.straight(turn(from, turned_over), turn(to, turned_over), span);
        }
        let chord = (to[0] - from[0]).hypot(to[1] - from[1]);
        let radius = chord * (1.0 + bulge * bulge) / (4.0 * bulge.abs());
        let circle = Circle::Radius(if bulge.abs() > 1.0 { -radius } else { radius });
        self.round(from, to, circle, bulge < 0.0, turned_over, span);
    }

    fn round(
        &mut self,
        start: [f64; 3],
        end: [f64; 3],
        circle: Circle,
        clockwise: bool,
        turned_over: bool,
        span: Span,
    ) {
        let is_number = start.iter().chain(&end).all(|x| x.is_finite());
        let curve = ArcMove { plane: Plane::Xy, clockwise, start, end, circle }.curve();
        match curve {
            // What is no number has been said.
            _ if !is_number => {}
            Ok((mut curve, _)) => {
                for point in &mut curve.control_points_mm {
                    *point = turn(*point, turned_over);
                }
                self.push(curve, Shape::Arc, span);
            }
            Err(ArcFault::NoRadius) => {
                self.report.error(span, "the radius is lost in rounding").expected("a larger one");
            }
            Err(_) => {
                self.report.error(span, "this is no arc").expected("an angle that numbers resolve");
            }
        }
    }

    /// Whether the plane of an entity is turned over; `None` when it is another one.
    fn plane(&mut self, entity: &Entity<'t>) -> Option<bool> {
        let normal = [(210, 0.0), (220, 0.0), (230, 1.0)]
            .map(|(code, default)| entity.number(self.report, code).unwrap_or(default));
        match normal {
            [0.0, 0.0, z] if z > 0.0 => Some(false),
            [0.0, 0.0, z] if z < 0.0 => Some(true),
            _ => {
                self.report
                    .error(entity.span, format!("the plane of this {} is inclined", entity.name))
                    .expected("the groups 210, 220 and 230 to be 0, 0 and 1");
                None
            }
        }
    }

    fn push(&mut self, curve: Curve, shape: Shape, span: Span) {
        if curve.control_points_mm.iter().flatten().any(|x| x.is_nan()) {
            // Its number has been said to be none.
            return;
        }
        for fault in curve.faults() {
            self.report.error(span, fault.to_string()).expected(fault.expected());
        }
        let line = self.report.source.line_number(span.start);
        self.part.moves.push(Move {
            kind: MoveKind::Feed,
            shape,
            feedrate_mm_per_s: None,
            exact_stop: false,
            line,
        });
        self.part.curves.push(curve);
    }
}

/// A point of a plane whose normal points down, in the drawing's axes: such a plane has its x axis the other way.
fn turn(point: [f64; 3], turned_over: bool) -> [f64; 3] {
    if turned_over { [-point[0], point[1], -point[2]] } else { point }
}
