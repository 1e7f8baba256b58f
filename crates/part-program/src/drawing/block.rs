//! Blocks: entities that are drawn wherever an INSERT names them. Blocks may hold inserts, so a few lines may stand for
//! any number of curves; that number is limited.

use super::item::Item;
use crate::diagnostic::Report;
use crate::source::Span;

/// Curves, standstills and cells that inserts may draw, beyond one for each 40 bytes of the drawing: they must fit into memory.
const MAX_INSERTED: usize = 150_000;
/// Control points that inserts may draw, beyond one for each 16 bytes.
const MAX_INSERTED_POINTS: usize = 400_000;

/// The entities of a block.
pub(crate) struct Block<'t> {
    pub(super) base: [f64; 3],
    /// Its items. Those of entities on the layer of the insert have the names of these entities.
    pub(super) items: Vec<(Item<'t>, Option<&'t str>)>,
    /// Whether its entities are in another file.
    pub(super) is_external: bool,
}

/// What inserts have drawn so far.
#[derive(Default)]
pub(crate) struct Inserted {
    /// The names of the blocks that are being drawn, each within the one before.
    pub(super) open: Vec<String>,
    count: usize,
    points: usize,
    /// Whether the limit was exceeded, which is reported once.
    pub(super) is_full: bool,
}

impl Inserted {
    /// Counts the curves that are about to be drawn. Beyond the limit it returns `false`, and reports an error the
    /// first time.
    pub(super) fn take(&mut self, points: usize, span: Span, report: &mut Report<'_>) -> bool {
        self.count += 1;
        self.points += points;
        let text = report.source.text.len();
        let (curves, most) = (MAX_INSERTED + text / 40, MAX_INSERTED_POINTS + text / 16);
        if !self.is_full && (self.count > curves || self.points > most) {
            self.is_full = true;
            let expected = format!("at most {curves} curves with {most} control points in all");
            report.error(span, "the blocks that are inserted hold too many curves").expected(expected);
        }
        !self.is_full
    }
}
