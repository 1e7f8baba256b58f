//! INSERT: a block, scaled, turned and moved, once or in rows and columns.
//!
//! A point p of a block with the base point b goes to `plane · (place + turn · (cell + scale · (p - b)))`, the cell being its column and
//! its row times their distances. Blocks hold inserts, so that few lines may stand for any number of curves: how deep and how many
//! is bounded.

use std::rc::Rc;

use super::Drawing;
use super::affine::Affine;
use super::groups::{Entities, Entity};
use super::item::Item;
use crate::diagnostic::Report;
use crate::source::Span;

/// Blocks within blocks.
const MAX_DEPTH: usize = 32;
/// Curves, standstills and cells that inserts may draw.
const MAX_INSERTED: usize = 1_000_000;
/// Control points that inserts may draw.
const MAX_INSERTED_POINTS: usize = 4_000_000;

/// Bit of group 70 of a BLOCK that stands for another file.
const EXTERNAL: u32 = 4;

/// An INSERT.
#[derive(Clone, Debug)]
pub(crate) struct Insert<'t> {
    name: &'t str,
    /// From behind the scale to the drawing, without the cell.
    turn: Affine,
    scale: [f64; 3],
    /// Columns and rows.
    counts: [u32; 2],
    distances: [f64; 2],
    span: Span,
}

/// The entities of a block.
pub(crate) struct Block<'t> {
    base: [f64; 3],
    items: Vec<Item<'t>>,
    /// Whether its entities are in another file.
    is_external: bool,
}

/// What inserts have drawn so far.
#[derive(Default)]
pub(crate) struct Inserted {
    /// The blocks that are being drawn, one in the other.
    open: Vec<String>,
    count: usize,
    points: usize,
    /// Whether too much has been asked for, which is said once.
    is_full: bool,
}

impl Inserted {
    /// Counts what is about to be drawn; `false`, and an error the first time, once it is too much.
    fn take(&mut self, points: usize, span: Span, report: &mut Report<'_>) -> bool {
        self.count += 1;
        self.points += points;
        if !self.is_full && (self.count > MAX_INSERTED || self.points > MAX_INSERTED_POINTS) {
            self.is_full = true;
            let expected =
                format!("at most {MAX_INSERTED} curves with {MAX_INSERTED_POINTS} control points in all");
            report.error(span, "the blocks that are inserted hold too many curves").expected(expected);
        }
        !self.is_full
    }
}

/// Reads an INSERT.
pub(crate) fn read<'t>(entity: &Entity<'t>, report: &mut Report<'_>, items: &mut Vec<Item<'t>>) {
    let plane = entity.plane(report);
    let place = entity.point(report, 10, "place");
    let mut number = |code, default| entity.number(report, code).unwrap_or(default);
    let scale = [41, 42, 43].map(|code| number(code, 1.0));
    let angle = number(50, 0.0);
    let distances = [44, 45].map(|code| number(code, 0.0));
    let counts = [70, 71].map(|code| entity.flags(report, code).max(1));
    let Some(name) = entity.text(2) else {
        report.error(entity.span, "this INSERT names no block").expected("a group 2");
        return;
    };
    let (Some(plane), Some(place)) = (plane, place) else { return };
    if scale.iter().chain(&distances).chain([&angle]).any(|x| x.is_nan()) {
        // It has been said to be none.
        return;
    }
    let turn = Affine::turning(angle.rem_euclid(360.0).to_radians());
    let turn = plane.after(&Affine::moving(place)).after(&turn);
    items.push(Item::Insert(Insert { name, turn, scale, counts, distances, span: entity.span }));
}

impl Insert<'_> {
    /// The maps from the block to where it is inserted, row after row.
    fn maps(&self, base: [f64; 3]) -> impl Iterator<Item = Affine> {
        let inner = Affine::scaling(self.scale).after(&Affine::moving(base.map(|x| -x)));
        let [columns, rows] = self.counts;
        (0..rows).flat_map(move |row| (0..columns).map(move |column| [column, row])).map(move |cell| {
            let [x, y] = [0, 1].map(|axis: usize| f64::from(cell[axis]) * self.distances[axis]);
            self.turn.after(&Affine::moving([x, y, 0.0])).after(&inner)
        })
    }
}

impl<'t> Drawing<'_, 't, '_> {
    /// Draws a block where it is inserted.
    pub(crate) fn insert(&mut self, insert: &Insert<'t>, map: &Affine) {
        let name = insert.name.to_lowercase();
        if self.inserted.is_full || !self.may_open(&name, insert) {
            return;
        }
        let Some(block) = self.block(&name) else {
            self.left_out.add("INSERT of a block that is not there", insert.span);
            return;
        };
        if block.is_external {
            self.left_out.add("INSERT of another drawing", insert.span);
            return;
        }
        self.inserted.open.push(name);
        'cells: for cell in insert.maps(block.base) {
            let cell = map.after(&cell);
            if !self.inserted.take(0, insert.span, self.report) {
                break;
            }
            for item in &block.items {
                if !self.inserted.take(item.point_count(), insert.span, self.report) {
                    break 'cells;
                }
                self.draw(item.clone(), &cell);
            }
        }
        self.inserted.open.pop();
    }

    /// Whether a block may be drawn within those that are being drawn; what is said is said once.
    fn may_open(&mut self, name: &str, insert: &Insert<'t>) -> bool {
        let open = &self.inserted.open;
        let shown: String = insert.name.chars().take(40).collect();
        let message = if open.iter().any(|outer| outer == name) {
            format!("the block {shown} is inserted into itself")
        } else if open.len() >= MAX_DEPTH {
            format!("the block {shown} is inserted {} blocks deep", MAX_DEPTH + 1)
        } else {
            return true;
        };
        self.inserted.is_full = true;
        self.report
            .error(insert.span, message)
            .expected(format!("at most {MAX_DEPTH} blocks within each other"));
        false
    }

    /// A block, read when it is first inserted: what is wrong with one that nobody inserts does not matter.
    fn block(&mut self, name: &str) -> Option<Rc<Block<'t>>> {
        if let Some(block) = self.blocks.get(name) {
            return Some(Rc::clone(block));
        }
        let mut entities = Entities::new(self.report.source.text, *self.layout.blocks.get(name)?);
        let header = entities.next()?;
        let base = if header.text(10).is_some() { header.point(self.report, 10, "base point") } else { None };
        let is_external = header.flags(self.report, 70) & EXTERNAL != 0;
        let mut items = Vec::new();
        for entity in entities {
            self.read_entity(&entity, true, &mut items);
        }
        let block = Rc::new(Block { base: base.unwrap_or_default(), items, is_external });
        self.blocks.insert(name.to_owned(), Rc::clone(&block));
        Some(block)
    }
}
