//! The place for the rows of a section.

#[cfg(feature = "alloc")]
use alloc::{vec, vec::Vec};

use feed_plan::StageShape;
use nurbs_core::{Joint, Piece};
use real::FromWord;

use crate::step_lengths::LengthStage;
use crate::stream::bytes::Bytes;
use crate::stream::error::StreamError;
#[cfg(feature = "alloc")]
use crate::stream::header::StreamHeader;
use crate::stream::layout::{RowShape, SectionRows};
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
    /// A row to make an array of pieces with. No section has it.
    #[must_use]
    pub fn no_piece() -> Piece<R, D> {
        Piece {
            origin: [0; D],
            coordinate_exponent: 0,
            step_exponent: 0,
            range_exponent: 0,
            joint_ratio: 0,
            joint_exponent: 0,
            joint: Joint::Smooth,
            step_per_chord: [R::zero(); 2],
        }
    }

    /// A row to make an array of stages with. No section has it.
    #[must_use]
    pub fn no_stage() -> LengthStage<R> {
        LengthStage {
            duration: 0,
            reciprocal: 0,
            reciprocal_exponent: 0,
            period_share: R::zero(),
            feed: R::zero(),
            change: R::zero(),
            shape: StageShape::Cubic,
        }
    }

    /// As many rows as the section has.
    pub(crate) fn rows_of(
        &mut self,
        head: &SectionHead,
        shape: &RowShape,
    ) -> Result<SectionStorage<'_, R, D>, StreamError> {
        let (section, SectionRows { pieces, stages, .. }) = (head.number, head.rows());
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
            stages: first(self.stages, section, "stages", stages)?,
        })
    }

    /// Takes every row from the bytes of the section with this head; `None` if there are too few of them.
    pub(crate) fn fill(
        &mut self,
        bytes: &mut Bytes<'_>,
        shape: &RowShape,
        head: &SectionHead,
    ) -> Option<Result<(), StreamError>> {
        let none = |field, row| Some(Err(StreamError::SectionField { section: head.number, field, row }));
        let (mut numerators, mut weights) = (self.numerators.iter_mut(), self.weights.iter_mut());
        let SectionRows { pieces, straight, .. } = head.rows();
        let (mut curved, mut straight) = (pieces.saturating_sub(straight), straight);
        for (row, slot) in self.pieces.iter_mut().enumerate() {
            let (piece, is_straight) = match rows::piece(bytes, shape)? {
                Ok(found) => found,
                Err(field) => return none(field, row),
            };
            *slot = piece;
            // As many of either kind as the head says.
            let left = if is_straight { &mut straight } else { &mut curved };
            let Some(fewer) = left.checked_sub(1) else { return none("joint", row) };
            *left = fewer;
            let stored = if is_straight { 1 } else { shape.degree };
            for (k, numerator) in numerators.by_ref().take(shape.degree).enumerate() {
                *numerator = if k < stored { bytes.array(Bytes::number)? } else { [R::zero(); D] };
            }
            for (k, weight) in weights.by_ref().take(shape.weights()).enumerate() {
                *weight = match (is_straight, k) {
                    (false, _) => bytes.number()?,
                    (true, 0) => R::one(),
                    (true, _) => R::zero(),
                };
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

/// Rows that a host allocates once, for the largest sections of a stream.
#[cfg(feature = "alloc")]
#[derive(Clone, Debug)]
pub struct SectionBuf<R, const D: usize> {
    pieces: Vec<Piece<R, D>>,
    numerators: Vec<[R; D]>,
    weights: Vec<R>,
    stages: Vec<LengthStage<R>>,
}

#[cfg(feature = "alloc")]
impl<R: FromWord, const D: usize> SectionBuf<R, D> {
    /// Rows for every section of the stream with this header, of which `buffer` is the buffer for the largest section. So the
    /// host has said how much memory a stream may take, and rows take no more than some times that: a header may ask for any.
    ///
    /// # Errors
    /// [`StreamError::HeaderField`] for a section that is longer than the buffer, and for more rows than such a section holds.
    pub fn for_stream(header: &StreamHeader, buffer: &[u8]) -> Result<Self, StreamError> {
        let rows = |count: u32| usize::try_from(count).unwrap_or(usize::MAX);
        let shape = header.row_shape(R::BYTES);
        let straight = shape.straight_bytes().min(shape.piece_bytes());
        for (field, count, bytes) in [
            ("largest section", header.largest_bytes, 1),
            ("number of pieces", header.largest_pieces, straight),
            ("number of stages", header.largest_stages, shape.stage_bytes()),
        ] {
            if rows(count).checked_mul(bytes).is_none_or(|bytes| bytes > buffer.len()) {
                return Err(StreamError::HeaderField { field, found: count.into() });
            }
        }
        let pieces = rows(header.largest_pieces);
        Ok(Self {
            pieces: vec![SectionStorage::no_piece(); pieces],
            numerators: vec![[R::zero(); D]; pieces.saturating_mul(shape.degree)],
            weights: vec![R::zero(); pieces.saturating_mul(shape.weights())],
            stages: vec![SectionStorage::<R, D>::no_stage(); rows(header.largest_stages)],
        })
    }

    /// The rows, for a [`StreamReader`](crate::StreamReader).
    pub fn storage(&mut self) -> SectionStorage<'_, R, D> {
        let Self { pieces, numerators, weights, stages } = self;
        SectionStorage { pieces, numerators, weights, stages }
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

#[cfg(test)]
mod tests {
    use super::*;
    use real::I4F28;

    /// `docs/stream.md` says how many bytes rows take.
    #[test]
    fn rows_take_the_bytes_of_the_book() {
        assert_eq!((size_of::<Piece<I4F28, 2>>(), size_of::<Piece<I4F28, 3>>()), (32, 40));
        assert_eq!((size_of::<Piece<f64, 2>>(), size_of::<Piece<f64, 3>>()), (40, 48));
        assert_eq!((size_of::<LengthStage<f32>>(), size_of::<LengthStage<f64>>()), (40, 64));
    }
}
