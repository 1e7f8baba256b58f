//! DXF drawings: what they draw, in the order of the file, in millimetres.
//!
//! | entity | groups that are read |
//! |---|---|
//! | SPLINE | 71 degree, 40 knots, 41 weights, 10 20 30 control points; 72 and 73 are their numbers; 42 which knots are equal |
//! | SPLINE without control points | 11 21 31 points to pass through, 12 and 13 the tangents of its ends, 70 whether it is closed |
//! | LINE | 10 20 30 start, 11 21 31 end |
//! | ARC, CIRCLE | 10 20 30 centre, 40 radius, 50 and 51 first and last angle in degrees, counterclockwise |
//! | ELLIPSE | 10 20 30 centre, 11 21 31 from there to the end of the major axis, 40 the minor one's share of it, 41 and 42 first and last angle in rad |
//! | LWPOLYLINE | 10 20 vertices, 42 bulge of the segment that follows, 38 height, 70 whether it is closed |
//! | POLYLINE | 30 height, 70 whether it is closed, or in space; its entities VERTEX: 10 20 30, 42 bulge |
//! | INSERT | 2 block, 10 20 30 place, 41 42 43 scales, 50 angle in degrees, 70 and 71 columns and rows, 44 and 45 their distances |
//!
//! A plane is turned by its normal, 210 220 230. $INSUNITS gives the unit. A knot vector is made a clamped one, and a spline
//! that breaks is several curves.
//!
//! What is drawn on paper (67), what is invisible (60) or on a layer that is frozen (70, bit 1) or off (62 below 0), and
//! every other entity is left out, with one warning that counts them by kind.
//!
//! # Source
//! Autodesk, DXF Reference, chapters "ENTITIES section" and "Object coordinate systems".

mod affine;
pub(crate) mod binary;
mod clamp;
mod conic;
mod fit;
mod groups;
mod insert;
mod item;
mod layout;
mod left_out;
mod polyline;
mod spline;

use std::collections::HashMap;
use std::rc::Rc;

use crate::curve::Curve;
use crate::diagnostic::Report;
use crate::part::{Move, MoveKind, Part, Shape};
use crate::source::Span;
use crate::unit::INCH;
use affine::Affine;
use groups::{Entities, Entity, Groups};
use insert::{Block, Inserted};
use item::Item;
use layout::Layout;
use left_out::LeftOut;

/// Whether a text is a drawing: pairs of a group code and a value, the first of them `0` and `SECTION`.
pub(crate) fn is_drawing(text: &str) -> bool {
    let mut groups = Groups::new(text, 0);
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
    let layout = Layout::read(report);
    let mut drawing = Drawing {
        report,
        part,
        layout,
        blocks: HashMap::new(),
        inserted: Inserted::default(),
        left_out: LeftOut::default(),
        free_ends: LeftOut::default(),
    };
    drawing.entities(&Affine::scaling([unit; 3]));
    let Drawing { left_out, free_ends, .. } = drawing;
    if part.curves.is_empty() && !report.has_errors() {
        report
            .error(Span::default(), "the drawing holds no curve")
            .expected("an entity SPLINE, LINE, ARC, CIRCLE, ELLIPSE, LWPOLYLINE, POLYLINE or INSERT");
    }
    if let Some((span, words)) = left_out.words() {
        report.warning_beside_errors(span, format!("left out: {words}"));
    }
    if let Some((span, words)) = free_ends.words() {
        report
            .warning(
                span,
                format!("{words} by points alone, without tangents at the ends: read so that no curvature is there"),
            )
            .hint("CAD systems may draw it otherwise: convert it to control points where it was drawn");
    }
}

/// Millimetres of the drawing's unit; 1 once something is said about it.
fn unit(report: &mut Report<'_>) -> f64 {
    let mut groups = Groups::new(report.source.text, 0);
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
    layout: Layout,
    /// Those that were inserted, by name.
    blocks: HashMap<String, Rc<Block<'t>>>,
    inserted: Inserted,
    left_out: LeftOut,
    /// Splines whose ends the drawing leaves free.
    free_ends: LeftOut,
}

impl<'t> Drawing<'_, 't, '_> {
    /// Draws the entities of the drawing itself.
    fn entities(&mut self, map: &Affine) {
        let mut items = Vec::new();
        for start in std::mem::take(&mut self.layout.entities) {
            for entity in Entities::new(self.report.source.text, start) {
                self.read_entity(&entity, false, &mut items);
                for item in items.drain(..) {
                    self.draw(item, map);
                }
            }
        }
    }

    /// Adds what an entity draws to `items`, or counts it as left out.
    fn read_entity(&mut self, entity: &Entity<'t>, in_block: bool, items: &mut Vec<Item<'t>>) {
        let (name, span) = (entity.name, entity.span);
        match name {
            // They belong to an entity before them, hold templates of texts, or look at the drawing.
            "VERTEX" | "SEQEND" | "VIEWPORT" => return,
            "ATTDEF" if in_block => return,
            _ if self.is_hidden(entity, in_block) => {
                return self.left_out.add(&format!("hidden {name}"), span);
            }
            _ if entity.text(67) == Some("1") => return self.left_out.add(&format!("{name} on paper"), span),
            _ => {}
        }
        let report = &mut *self.report;
        match name {
            "SPLINE" => {
                if spline::read(entity, report, items) {
                    self.free_ends.add(name, span);
                }
            }
            "LINE" => read_line(entity, report, items),
            "ARC" | "CIRCLE" => conic::read_circle(entity, report, items),
            "ELLIPSE" => conic::read_ellipse(entity, report, items),
            "LWPOLYLINE" => polyline::read_light(entity, report, items),
            "POLYLINE" if polyline::is_mesh(entity, report) => self.left_out.add("POLYLINE of a mesh", span),
            "POLYLINE" => polyline::read(entity, report, items),
            "INSERT" => insert::read(entity, report, items),
            _ => self.left_out.add(name, span),
        }
    }

    /// Whether an entity is invisible, or its layer is. In a block the layer 0 is the one on which the block is inserted.
    fn is_hidden(&self, entity: &Entity<'t>, in_block: bool) -> bool {
        let layer = entity.text(8).filter(|layer| !in_block || *layer != "0");
        layer.is_some_and(|layer| self.layout.hidden_layers.contains(&layer.to_lowercase()))
            || entity.text(60) == Some("1")
    }

    /// Takes an item to the drawing's axes, in mm, and adds it to the part.
    fn draw(&mut self, item: Item<'t>, map: &Affine) {
        match item {
            Item::Curve { curve, shape, span } => {
                let (curve, shape) = conic::mapped(map, curve, shape);
                if curve.control_points_mm.windows(2).all(|pair| pair[0] == pair[1]) {
                    self.stand_still(span);
                } else {
                    self.push(curve, shape, span);
                }
            }
            Item::Standstill(span) => self.stand_still(span),
            Item::Insert(insert) => self.insert(&insert, map),
        }
    }

    fn stand_still(&mut self, span: Span) {
        self.part.standstills.push(self.report.source.line_number(span.start));
    }

    fn push(&mut self, curve: Curve, shape: Shape, span: Span) {
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
            block: 0,
        });
        self.part.curves.push(curve);
    }
}

/// Reads a LINE.
fn read_line<'t>(entity: &Entity<'t>, report: &mut Report<'_>, items: &mut Vec<Item<'t>>) {
    let (from, to) = (entity.points(report, 10), entity.points(report, 11));
    match (from.as_slice(), to.as_slice()) {
        // What is no number has been said.
        ([(from, _)], [(to, _)]) if from.iter().chain(to).any(|x| x.is_nan()) => {}
        ([(from, _)], [(to, _)]) => items.push(Item::straight(*from, *to, entity.span)),
        _ => {
            report
                .error(entity.span, "a LINE has two ends")
                .expected("groups 10, 20, 30 and 11, 21, 31, once each");
        }
    }
}
