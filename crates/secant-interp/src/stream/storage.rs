//! The place for the rows of a section.

use nurbs_core::Piece;
use real::FromWord;

use crate::step_lengths::LengthStage;
use crate::stream::bytes::Bytes;
use crate::stream::error::StreamError;
use crate::stream::layout::RowShape;
use crate::stream::rows;
use crate::stream::section_head::SectionHead;

/// The place for the rows of a section. A section of m pieces of degree p takes m rows of `pieces`, m p of `numerators`, and
/// m (p + 1) of `weights` if the path has weights. The header says how many pieces and stages the largest sections have.
#[derive(Debug)]
pub struct SectionStorage<'a, R, const D: usize> {
    /// Rows of pieces.
    pub pieces: &'a mut [Piece<R, D>],
    /// Coefficients of their numerators.
    pub numerators: &'a mut [[R; D]],
    /// Coefficients of their weights.
    pub weights: &'a mut [R],
    /// Stages.
    pub stages: &'a mut [LengthStage<R>],
}

impl<R: FromWord, const D: usize> SectionStorage<'_, R, D> {
    /// As many rows as the section has.
    pub(crate) fn rows_of(
        &mut self,
        head: &SectionHead,
        shape: &RowShape,
    ) -> Result<SectionStorage<'_, R, D>, StreamError> {
        let (section, pieces) = (head.number, head.piece_count());
        Ok(SectionStorage {
            pieces: first(self.pieces, section, "pieces", pieces)?,
            numerators: first(
                self.numerators,
                section,
                "coefficients of numerators",
                pieces.saturating_mul(shape.degree),
            )?,
            weights: first(
                self.weights,
                section,
                "coefficients of weights",
                pieces.saturating_mul(shape.weights()),
            )?,
            stages: first(self.stages, section, "stages", head.stage_count())?,
        })
    }

    /// Takes every row from the bytes of a section; `None` if there are too few of them.
    pub(crate) fn fill(
        &mut self,
        bytes: &mut Bytes<'_>,
        shape: &RowShape,
        section: u32,
    ) -> Option<Result<(), StreamError>> {
        let none = |field, row| Some(Err(StreamError::SectionField { section, field, row }));
        let (mut numerators, mut weights) = (self.numerators.iter_mut(), self.weights.iter_mut());
        for (row, slot) in self.pieces.iter_mut().enumerate() {
            match rows::piece(bytes)? {
                Ok(piece) => *slot = piece,
                Err(field) => return none(field, row),
            }
            for numerator in numerators.by_ref().take(shape.degree) {
                *numerator = bytes.array(Bytes::number)?;
            }
            for weight in weights.by_ref().take(shape.weights()) {
                *weight = bytes.number()?;
            }
        }
        for (row, slot) in self.stages.iter_mut().enumerate() {
            match rows::stage(bytes)? {
                Ok(stage) => *slot = stage,
                Err(field) => return none(field, row),
            }
        }
        Some(Ok(()))
    }
}

/// The first rows of a storage.
fn first<'r, T>(
    storage: &'r mut [T],
    section: u32,
    rows: &'static str,
    needed: usize,
) -> Result<&'r mut [T], StreamError> {
    let room = storage.len();
    storage.get_mut(..needed).ok_or(StreamError::NoRoom { section, rows, needed, room })
}
