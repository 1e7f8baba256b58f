//! Draws blocks where they are inserted, and blocks within blocks down to a limited depth.

use std::rc::Rc;

use super::affine::Affine;
use super::block::Block;
use super::groups::{Entities, INSERTS_LAYER};
use super::insert::Insert;
use super::reader::Reader;

/// The largest depth of blocks within blocks.
const MAX_DEPTH: usize = 32;

/// Bit of group 70 of a BLOCK that stands for another file.
const EXTERNAL: u32 = 4;

impl<'t> Reader<'_, 't, '_> {
    /// Draws a block where it is inserted; `outer_is_off` says whether the layer is off that layer 0 stands for there.
    pub(crate) fn insert(&mut self, insert: &Insert<'t>, map: &Affine, outer_is_off: bool) {
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
        let is_off = if insert.layer == INSERTS_LAYER { outer_is_off } else { self.is_off(insert.layer) };
        'cells: for cell in insert.maps(block.base) {
            let cell = map.after(&cell);
            if !self.inserted.take(0, insert.span, self.report) {
                break;
            }
            for (item, on_inserts_layer) in &block.items {
                if !self.inserted.take(item.point_count(), insert.span, self.report) {
                    break 'cells;
                }
                match on_inserts_layer.filter(|_| is_off) {
                    Some(name) => self.left_out.add(&format!("hidden {name}"), insert.span),
                    None => self.draw(item.clone(), &cell, is_off),
                }
            }
        }
        self.inserted.open.pop();
    }

    /// Whether a block may be drawn within those that are being drawn. A refusal is reported once.
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

    /// A block, read when it is first inserted: errors in a block that is never inserted do not matter.
    fn block(&mut self, name: &str) -> Option<Rc<Block<'t>>> {
        if let Some(block) = self.blocks.get(name) {
            return Some(Rc::clone(block));
        }
        let mut entities = Entities::new(self.report.source.text, *self.layout.blocks.get(name)?);
        let header = entities.next()?;
        let base = if header.text(10).is_some() { header.point(self.report, 10, "base point") } else { None };
        let is_external = header.flags(self.report, 70) & EXTERNAL != 0;
        let (mut items, mut of_entity) = (Vec::new(), Vec::new());
        for entity in entities {
            let name = entity.name;
            let follows = (entity.layer() == INSERTS_LAYER && name != "INSERT").then_some(name);
            self.read_entity(&entity, true, &mut of_entity);
            items.extend(of_entity.drain(..).map(|item| (item, follows)));
        }
        let block = Rc::new(Block { base: base.unwrap_or_default(), items, is_external });
        self.blocks.insert(name.to_owned(), Rc::clone(&block));
        Some(block)
    }
}
