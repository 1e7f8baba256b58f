//! `paper-figures`: what do papers A to D print, and what comes out here?
//!
//! [`paper_figures`] computes every figure of the four papers anew: a [`Row`] for each number, with what is printed, the
//! setting behind ours and the reason where they differ, and a picture for each of the papers' plots. The papers are those
//! of `docs/papers.md`.
//!
//! | paper | numbers and pictures | where |
//! |---|---|---|
//! | A | table 1, equation (7), figures 5 to 15 | `paper_a` |
//! | B | lines and arcs (8), (9), tangents and joints (3), (5), corners | `paper_b` |
//! | C | equations (2), (9), (10), (12), figures 8 to 11 | `paper_c`, `adaptive_feed` |
//! | D | knots (5), (6), following error, table 2, the error of fine moves against that of the NURBS | `paper_d`, [`contour_table`] |

mod adaptive_feed;
mod contour_table;
mod error;
mod figures;
mod judged;
mod paper_a;
mod paper_b;
mod paper_c;
mod paper_d;
mod papers_data;
mod row;

pub use contour_table::{ContourRow, contour_table};
pub use error::PaperError;
pub use figures::PaperFigures;
pub use row::{Printed, Row};

/// Computes the figures of all papers, in some seconds.
///
/// # Errors
/// [`PaperError`] names what cannot be computed.
pub fn paper_figures() -> Result<PaperFigures, PaperError> {
    let mut all = PaperFigures::default();
    for one in [paper_a::figures()?, paper_b::figures()?, paper_c::figures()?, paper_d::figures()?] {
        all.add(one);
    }
    Ok(all)
}

#[cfg(test)]
mod tests;
