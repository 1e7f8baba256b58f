//! INSERT: a block, scaled, turned and moved, once or in rows and columns.
//!
//! A point p of a block with the base point b goes to `plane · (place + turn · (cell + scale · (p - b)))`. The cell is
//! the column and the row times their distances.

use super::affine::Affine;
use super::groups::Entity;
use crate::diagnostic::Report;
use crate::source::Span;

/// An INSERT.
#[derive(Clone, Debug)]
pub(crate) struct Insert<'t> {
    pub(super) name: &'t str,
    pub(super) layer: &'t str,
    /// The map from the scaled block to the drawing, without the cell.
    turn: Affine,
    scale: [f64; 3],
    /// Columns and rows.
    counts: [u32; 2],
    distances: [f64; 2],
    pub(super) span: Span,
}

/// Reads an INSERT; `None` after an error was reported.
pub(crate) fn read<'t>(entity: &Entity<'t>, report: &mut Report<'_>) -> Option<Insert<'t>> {
    let plane = entity.plane(report);
    let place = entity.point(report, 10, "place");
    let mut number = |code, default| entity.number(report, code).unwrap_or(default);
    let scale = [41, 42, 43].map(|code| number(code, 1.0));
    let angle = number(50, 0.0);
    let distances = [44, 45].map(|code| number(code, 0.0));
    let counts = [70, 71].map(|code| entity.flags(report, code).max(1));
    let Some(name) = entity.text(2) else {
        report.error(entity.span, "this INSERT names no block").expected("a group 2");
        return None;
    };
    let (Some(plane), Some(place)) = (plane, place) else { return None };
    if scale.iter().chain(&distances).chain([&angle]).any(|x| x.is_nan()) {
        // The number has been reported as invalid.
        return None;
    }
    let turn = Affine::turning(angle.rem_euclid(360.0).to_radians());
    let turn = plane.after(&Affine::moving(place)).after(&turn);
    Some(Insert { name, layer: entity.layer(), turn, scale, counts, distances, span: entity.span })
}

impl Insert<'_> {
    /// The maps from the block to its places, row after row.
    pub(super) fn maps(&self, base: [f64; 3]) -> impl Iterator<Item = Affine> {
        let inner = Affine::scaling(self.scale).after(&Affine::moving(base.map(|x| -x)));
        let [columns, rows] = self.counts;
        (0..rows).flat_map(move |row| (0..columns).map(move |column| [column, row])).map(move |cell| {
            let [x, y] = [0, 1].map(|axis: usize| f64::from(cell[axis]) * self.distances[axis]);
            self.turn.after(&Affine::moving([x, y, 0.0])).after(&inner)
        })
    }
}
