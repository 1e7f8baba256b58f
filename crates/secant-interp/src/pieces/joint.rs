//! Values that a step carries over the joint of two pieces: steps per chord in the scale of the next piece, and the
//! length travelled so far.

use nurbs_core::Piece;
use real::Real;

use crate::pieces::chord_step::{Chord, ChordBefore, sum_within};
use crate::pieces::terms::vector;

/// The factor that takes steps per chord on one piece to the scale of the next.
#[derive(Clone, Copy)]
pub(crate) struct JointScale<R> {
    ratio: R,
    /// The factor is ratio · 2^exponent.
    exponent: i32,
}

impl<R: Real> JointScale<R> {
    /// That of the joint at the end of a piece.
    #[inline]
    pub(crate) fn behind<const D: usize>(row: &Piece<R, D>) -> Self {
        let (ratio, exponent) = (row.ratio_at_joint(), row.joint_exponent.into());
        if R::IS_FLOATING {
            Self { ratio: ratio.ldexp(exponent), exponent: 0 }
        } else {
            Self { ratio, exponent }
        }
    }

    /// Converts a step per chord, limited to the range of the next piece.
    #[inline]
    pub(crate) fn convert(&self, sigma: R, range: &[R; 2]) -> R {
        range[0].max(self.convert_part(sigma, range)).signal("step_per_chord")
    }

    /// Converts a part of a step per chord, limited to the greatest step per chord of the next piece.
    #[inline]
    pub(crate) fn convert_part(&self, part: R, [_, greatest]: &[R; 2]) -> R {
        let part = part * self.ratio;
        let part = if R::IS_FLOATING {
            part
        } else {
            // Compared in the smaller scale, because the part in the larger scale might not fit the format.
            let is_larger = self.exponent > 0;
            let small = if is_larger { part.min(greatest.ldexp(-self.exponent)) } else { part };
            small.ldexp(self.exponent)
        };
        part.min(*greatest).signal("joint_step_per_chord")
    }
}

/// Converts a part of one piece to a part of the next piece of the same span: the ratio of their widths is a power of
/// two. `None` if the part is longer than the next piece.
#[inline]
pub(crate) fn part_of_next<R: Real, const D: usize>(
    row: &Piece<R, D>,
    next: &Piece<R, D>,
    phase: u64,
) -> Option<u64> {
    // joint_ratio is ½, so that 2^(joint_exponent - 1) takes steps η = h 2^s to steps.
    let exponent =
        i32::from(row.joint_exponent) - 1 + i32::from(row.step_exponent) - i32::from(next.step_exponent);
    let distance = exponent.unsigned_abs();
    if exponent <= 0 {
        return Some(phase.checked_shr(distance).unwrap_or(0));
    }
    if phase.leading_zeros() < distance { None } else { Some(phase.checked_shl(distance).unwrap_or(0)) }
}

/// What a step over a joint has travelled up to there.
#[derive(Clone, Copy)]
pub(crate) struct Travelled<R, const D: usize> {
    /// The chord up to there.
    pub(crate) before: ChordBefore<R, D>,
    /// The step up to there, over the length of the whole chord, in the scale of one piece.
    pub(crate) part: R,
}

impl<R: Real, const D: usize> Travelled<R, D> {
    /// The values at the begin of a chord.
    #[inline]
    pub(crate) fn nothing() -> Self {
        Self { before: ChordBefore::nothing(), part: R::zero() }
    }

    /// The values at the end of the piece that the chord is on, in its scale; `None` if the whole length or more is travelled
    /// there.
    pub(crate) fn past<const N: usize, const PLAIN: bool>(
        &self,
        chord: &Chord<'_, R, D, N, PLAIN>,
    ) -> Option<Self> {
        let greatest = chord.range[1];
        let whole = (chord.whole / chord.length).min(greatest);
        let across = chord.over_length(chord.whole, whole);
        let before = &self.before.part;
        // In halves, because the sum may not fit the format before it is known to be short.
        let half: [R; D] = vector(|d| before[d].half() + across[d].half());
        let sum = || vector(|d| (before[d] + across[d]).signal("joint_travelled"));
        (R::norm(&half) < R::one().half())
            .then(|| Self { before: ChordBefore::new(sum()), part: sum_within(self.part, whole, greatest) })
    }
}

/// The position reached by a step, and σ there.
pub(crate) struct Reached<R> {
    pub(crate) piece: usize,
    pub(crate) phase: u64,
    pub(crate) sigma: R,
    pub(crate) evaluations: u32,
}
