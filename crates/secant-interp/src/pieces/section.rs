//! A path and its plan from one rest to the next, which make one run.
//!
//! A section of the plan rests at a joint of two pieces. The run of the section takes the pieces up to there and the
//! section's stages. It lands on the rest as on the end of a path, and the next run begins there, on time.

#[cfg(feature = "alloc")]
use alloc::vec::Vec;
use core::ops::Range;

use real::Real;

use crate::PieceInterpolator;

/// Pieces and stages of a section.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Section {
    /// The pieces between the rests.
    pub pieces: Range<usize>,
    /// The stages from rest to rest.
    pub stages: Range<usize>,
}

/// The sections of a path of `pieces` pieces, in order. For each section of its plan, `ends` has the number of stages
/// up to its end, and the number of the piece that begins where it rests. A section without such a joint, or with a
/// joint not behind the one before, is joined to the next.
#[cfg(feature = "alloc")]
pub(crate) fn sections(ends: &[(usize, Option<usize>)], pieces: usize) -> Vec<Section> {
    let (mut found, mut piece, mut stage) = (Vec::new(), 0, 0);
    for (index, (stages, joint)) in ends.iter().enumerate() {
        let joint = joint.filter(|joint| piece < *joint && *joint < pieces);
        let is_last = index + 1 == ends.len();
        if is_last || joint.is_some() {
            let end = if is_last { pieces } else { joint.unwrap_or(pieces) };
            found.push(Section { pieces: piece..end, stages: stage..*stages });
            (piece, stage) = (end, *stages);
        }
    }
    found
}

impl<'a, R: Real, const D: usize> PieceInterpolator<'a, R, D> {
    /// The run of one section, which ends on the stop. The piece numbers of setpoints count from the section's first
    /// piece.
    #[must_use]
    pub fn on(&self, section: &Section) -> PieceInterpolator<'a, R, D> {
        PieceInterpolator {
            pieces: self.pieces.part(section.pieces.clone()),
            lengths: self.lengths.part(&section.stages),
            ..*self
        }
    }
}

#[cfg(all(test, feature = "alloc"))]
mod tests {
    use super::*;

    fn of(ends: &[(usize, Option<usize>)], pieces: usize) -> Vec<(Range<usize>, Range<usize>)> {
        sections(ends, pieces).into_iter().map(|one| (one.pieces, one.stages)).collect()
    }

    #[test]
    fn each_rest_ends_a_section_and_the_last_one_the_path() {
        assert_eq!(of(&[(3, Some(9))], 9), [(0..9, 0..3)]);
        assert_eq!(of(&[(1, None)], 1), [(0..1, 0..1)]);
        assert_eq!(of(&[], 4), []);
        assert_eq!(
            of(&[(2, Some(2)), (5, Some(5)), (7, Some(7))], 7),
            [(0..2, 0..2), (2..5, 2..5), (5..7, 5..7)]
        );
    }

    #[test]
    fn a_rest_that_is_no_joint_or_goes_back_ends_nothing() {
        assert_eq!(
            of(&[(2, Some(3)), (3, Some(1)), (4, None), (5, Some(99))], 6),
            [(0..3, 0..2), (3..6, 2..5)]
        );
        assert_eq!(of(&[(1, Some(0)), (2, Some(4))], 4), [(0..4, 0..2)]);
    }
}
