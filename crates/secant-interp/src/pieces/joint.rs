//! Values that a step carries over the joint of two pieces: steps per chord in the scale of the next piece, and the
//! length travelled so far.

use nurbs_core::Piece;
use real::Real;

use crate::pieces::chord_step::{Chord, ChordBefore, sum_within};

/// Converts a step per chord on one piece to the scale of the next, limited to the range of the next.
pub(crate) fn into_next<R: Real, const D: usize>(row: &Piece<R, D>, next: &Piece<R, D>, sigma: R) -> R {
    next.step_per_chord[0].max(part_into_next(row, next, sigma)).signal("step_per_chord")
}

/// Converts a part of a step per chord to the scale of the next piece, limited to the greatest step per chord there.
pub(crate) fn part_into_next<R: Real, const D: usize>(row: &Piece<R, D>, next: &Piece<R, D>, part: R) -> R {
    let greatest = next.step_per_chord[1];
    let exponent = i32::from(row.joint_exponent);
    let part = part * row.ratio_at_joint();
    // Compared in the smaller scale, because the part in the larger scale might not fit a format without exponents.
    let small = if !R::IS_FLOATING && exponent > 0 { part.min(greatest.ldexp(-exponent)) } else { part };
    small.ldexp(exponent).min(greatest).signal("joint_step_per_chord")
}

/// Converts a part of one piece to a part of the next piece of the same span: the ratio of their widths is a power of
/// two. `None` if the part is longer than the next piece.
pub(crate) fn part_of_next<R: Real, const D: usize>(
    row: &Piece<R, D>,
    next: &Piece<R, D>,
    phase: u64,
) -> Option<u64> {
    // joint_ratio is ½, so that 2^(joint_exponent - 1) takes steps η = h 2^s to steps.
    let [joint, step, onward] = [row.joint_exponent, row.step_exponent, next.step_exponent].map(i32::from);
    let exponent = joint - 1 + step - onward;
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
        let half: [R; D] = core::array::from_fn(|d| before[d].half() + across[d].half());
        let sum = || core::array::from_fn(|d| (before[d] + across[d]).signal("joint_travelled"));
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
