//! The places of a drawing's layers, blocks and entities.

use std::collections::{HashMap, HashSet};

use super::groups::{Entity, Groups};
use crate::diagnostic::Report;
use crate::source::Span;

/// Places in a drawing. Names are in lower case, since a drawing's names have no case.
#[derive(Default)]
pub(crate) struct Layout {
    /// Layers that are frozen: nothing on them is seen, and no block that is inserted there.
    pub(super) frozen_layers: HashSet<String>,
    /// Layers that are off: a block that is inserted there is seen where its entities are on other layers.
    pub(super) off_layers: HashSet<String>,
    /// By name, the byte at which a block's entity BLOCK begins.
    pub(crate) blocks: HashMap<String, usize>,
    /// The bytes at which the first entities of sections ENTITIES begin.
    pub(crate) entities: Vec<usize>,
}

impl Layout {
    /// Looks through the whole drawing, and reports where the text is not a drawing.
    pub(crate) fn read(report: &mut Report<'_>) -> Self {
        let mut layout = Self::default();
        let mut groups = Groups::new(report.source.text, 0);
        // The name of a section follows its group 0; layers and blocks are read up to the next section.
        let (mut section, mut is_new, mut open): (&str, bool, Option<(Entity<'_>, usize)>) =
            ("", false, None);
        loop {
            let at = groups.at();
            let Some(group) = groups.next(Some(report)) else { break };
            if group.code == 0 {
                if let Some((entity, start)) = open.take() {
                    layout.note(&entity, start);
                }
                match (group.text, section) {
                    ("EOF", _) => return layout,
                    ("SECTION", _) => is_new = true,
                    ("ENDSEC", _) => section = "",
                    (name @ "LAYER", "TABLES") | (name @ "BLOCK", "BLOCKS") => {
                        open = Some((Entity::new(name, group.span), at));
                    }
                    _ => {}
                }
            } else if let Some((entity, _)) = &mut open {
                entity.groups.push(group);
            } else if is_new && group.code == 2 {
                (section, is_new) = (group.text, false);
                if section == "ENTITIES" {
                    layout.entities.push(groups.at());
                }
            }
        }
        if !report.has_errors() {
            let end = report.source.text.len();
            report.error(Span::new(end, end), "the drawing is cut off").expected("a group 0 with EOF");
        }
        layout
    }

    fn note(&mut self, entity: &Entity<'_>, start: usize) {
        let number = |code: i32| entity.text(code).and_then(|text| text.parse::<i32>().ok());
        let Some(name) = entity.text(2).map(str::to_lowercase) else { return };
        if entity.name == "BLOCK" {
            self.blocks.entry(name).or_insert(start);
            return;
        }
        if number(70).is_some_and(|flags| flags & 1 == 1) {
            self.frozen_layers.insert(name.clone());
        }
        if number(62).is_some_and(|colour| colour < 0) {
            self.off_layers.insert(name);
        }
    }
}
