//! Reads the entities of a drawing, and adds their curves to the part.

use std::collections::{HashMap, HashSet};
use std::rc::Rc;

use super::affine::Affine;
use super::block::{Block, Inserted};
use super::groups::{Entities, Entity, INSERTS_LAYER};
use super::item::Item;
use super::layout::Layout;
use super::{conic, insert, polyline, spline};
use crate::curve::Curve;
use crate::diagnostic::Report;
use crate::kinds::Kinds;
use crate::moves::{Move, MoveKind, Shape};
use crate::part::Part;
use crate::source::Span;

/// A drawing that is being read.
pub(super) struct Reader<'r, 't, 'p> {
    pub(super) report: &'r mut Report<'t>,
    pub(super) part: &'p mut Part,
    pub(super) layout: Layout,
    /// The blocks inserted so far, by name.
    pub(super) blocks: HashMap<String, Rc<Block<'t>>>,
    pub(super) inserted: Inserted,
    pub(super) left_out: Kinds,
    /// The number of splines whose ends the drawing leaves free.
    pub(super) free_ends: Kinds,
}

impl<'r, 't, 'p> Reader<'r, 't, 'p> {
    pub(super) fn new(report: &'r mut Report<'t>, part: &'p mut Part, layout: Layout) -> Self {
        Self {
            report,
            part,
            layout,
            blocks: HashMap::new(),
            inserted: Inserted::default(),
            left_out: Kinds::default(),
            free_ends: Kinds::default(),
        }
    }

    /// Draws the entities that are not in a block.
    pub(super) fn entities(&mut self, map: &Affine) {
        let mut items = Vec::new();
        let is_off = self.is_off(INSERTS_LAYER);
        for start in std::mem::take(&mut self.layout.entities) {
            for entity in Entities::new(self.report.source.text, start) {
                self.read_entity(&entity, false, &mut items);
                for item in items.drain(..) {
                    self.draw(item, map, is_off);
                }
            }
        }
    }

    /// Adds the items of an entity to `items`, or counts the entity as left out.
    pub(super) fn read_entity(&mut self, entity: &Entity<'t>, in_block: bool, items: &mut Vec<Item<'t>>) {
        let (name, span) = (entity.name, entity.span);
        match name {
            // These belong to an entity before them, hold templates of texts, or define a view of the drawing.
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
            "INSERT" => items.extend(insert::read(entity, report).map(Item::Insert)),
            _ => self.left_out.add(name, span),
        }
    }

    /// Whether an entity is invisible, or its layer is. Of an INSERT on a layer that is off the block decides, and in a
    /// block layer 0 means the layer on which the block is inserted.
    fn is_hidden(&self, entity: &Entity<'t>, in_block: bool) -> bool {
        let layer = entity.layer();
        let is_on_its_own = !(in_block && layer == INSERTS_LAYER);
        let is_in = |layers: &HashSet<String>| is_on_its_own && layers.contains(&layer.to_lowercase());
        is_in(&self.layout.frozen_layers)
            || entity.name != "INSERT" && is_in(&self.layout.off_layers)
            || entity.text(60) == Some("1")
    }

    /// Whether a layer is off.
    pub(super) fn is_off(&self, layer: &str) -> bool {
        self.layout.off_layers.contains(&layer.to_lowercase())
    }

    /// Maps an item to the drawing's axes, in mm, and adds it to the part; `is_off` says whether the layer is off that
    /// layer 0 stands for.
    pub(super) fn draw(&mut self, item: Item<'t>, map: &Affine, is_off: bool) {
        match item {
            Item::Curve { curve, shape, span } => {
                let (curve, shape) = conic::mapped(map, curve, shape);
                if curve.control_points_mm().windows(2).all(|pair| pair[0] == pair[1]) {
                    self.stand_still(span);
                } else {
                    self.push(curve, shape, span);
                }
            }
            Item::Standstill(span) => self.stand_still(span),
            Item::Insert(insert) => self.insert(&insert, map, is_off),
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
        // A value that is not a number has been reported.
        ([(from, _)], [(to, _)]) if from.iter().chain(to).any(|x| x.is_nan()) => {}
        ([(from, _)], [(to, _)]) => items.push(Item::straight(*from, *to, entity.span)),
        _ => {
            report
                .error(entity.span, "a LINE has two ends")
                .expected("groups 10, 20, 30 and 11, 21, 31, once each");
        }
    }
}
