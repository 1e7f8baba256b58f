//! Places on a piece: a phase of 64 bits, and the same place as a number t from 0 to 1.

use nurbs_core::{Joint, Piece};
use real::Real;

use crate::pieces::state::PieceState;

/// The step to the end of the present piece.
#[inline]
pub(crate) fn step_to_end<R: Real, const D: usize>(state: &PieceState<R, D>, row: &Piece<R, D>) -> R {
    let rest = state.phase.wrapping_neg(); // 2⁶⁴ - phase; 0 stands for a whole piece
    if rest == 0 { row.whole() } else { R::from_phase(rest, i32::from(row.step_exponent)) }
}

/// The phase at the end of a step on its piece; `None` past the end. Steps of a whole piece and more are saturated:
/// from the piece's begin on, they end at the last phase.
#[inline]
pub(crate) fn after(phase: u64, step: u64) -> Option<u64> {
    (step < !phase).then(|| phase.wrapping_add(step))
}

/// The place of a phase, as phase and as number. Where numbers are added up, the phase has only the digits of the
/// number: a phase with more digits could lie ahead of the place that a short step leads to.
#[inline]
pub(crate) fn place_of<R: Real>(phase: u64) -> (u64, R) {
    let t = R::fraction(phase);
    let digits = if R::ADDS_PLACES { t.place_to_phase() } else { None };
    (digits.unwrap_or(phase), t)
}

/// The place on a piece at the end of a step, as phase and as number; `None` past the end.
#[inline(always)]
pub(crate) fn onward<R: Real, const D: usize>(
    row: &Piece<R, D>,
    (phase, t): (u64, R),
    step: R,
) -> Option<(u64, R)> {
    if R::ADDS_PLACES {
        let t = t + step;
        return Some((t.place_to_phase()?, t));
    }
    let phase = after(phase, row.part(step))?;
    Some((phase, R::fraction(phase)))
}

/// Whether a step of `guessed` is worth an evaluation on the present piece. It is not if it reaches past a knot by more
/// than the usual error of a guess, or past the whole piece, or back, as only a float can.
#[inline]
pub(crate) fn is_on_piece<R: Real, const D: usize>(
    state: &PieceState<R, D>,
    row: &Piece<R, D>,
    guessed: R,
) -> bool {
    let is_part = if R::IS_FLOATING { guessed.is_part() } else { guessed <= state.whole };
    is_part && (row.joint == Joint::Continues || !leads_past_end(state, row, guessed))
}

/// Whether a step of `guessed` reaches past the end of the present piece by more than the usual error of a guess, 2⁻⁸
/// of the way to the end.
#[inline]
fn leads_past_end<R: Real, const D: usize>(state: &PieceState<R, D>, row: &Piece<R, D>, guessed: R) -> bool {
    if R::IS_FLOATING {
        let rest = R::one() - state.t;
        return guessed > rest + rest.ldexp(-8);
    }
    let rest = state.phase.wrapping_neg().wrapping_sub(1); // 2⁶⁴ - 1 - phase
    row.part(guessed).saturating_sub(rest) > rest / 256
}
