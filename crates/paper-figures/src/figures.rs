//! The figures of one paper, or of all.

use format_report::Figure;

use crate::row::Row;

/// Numbers and pictures.
#[derive(Clone, Debug, Default)]
pub struct PaperFigures {
    /// The numbers, paper by paper, in the order in which they are printed.
    pub rows: Vec<Row>,
    /// The pictures, named `a-06-feed` and so on.
    pub pictures: Vec<Figure>,
}

impl PaperFigures {
    /// Appends those of another paper.
    pub(crate) fn add(&mut self, mut other: Self) {
        self.rows.append(&mut other.rows);
        self.pictures.append(&mut other.pictures);
    }
}
