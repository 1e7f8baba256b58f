//! Steps over the joints of pieces.
//!
//! A step that leads past the end of its piece ends on another piece. Where the polynomial continues, only the end of
//! the step is converted to the next piece (`pass_joint`). At a knot another polynomial begins: the length up to the
//! knot is subtracted from the chord, and the remaining length is solved on the next piece, or on one behind it
//! (`find_across`). At a corner the remaining length is that of a chord of its own.

use nurbs_core::{Joint, Piece, Shifted};
use real::Real;

use crate::pieces::chord_step::{BEHIND_JOINT, Chord, within};
use crate::pieces::joint::{Reached, Travelled, into_next, part_into_next, part_of_next, past, sum_within};
use crate::pieces::piece_interpolator::PieceInterpolator;
use crate::pieces::place::step_to_end;
use crate::pieces::state::PieceState;
use crate::pieces::trend::Trend;

impl<R: Real, const D: usize> PieceInterpolator<'_, R, D> {
    /// Makes a step of a given phase that leads past the end of the piece. Returns the evaluations.
    #[cold]
    #[inline(never)]
    pub(crate) fn pass_end<const N: usize, const PLAIN: bool>(
        &self,
        state: &mut PieceState<R, D>,
        row: &Piece<R, D>,
        length: R,
        step: &Reached<R>,
    ) -> u32 {
        if let Some(reached) = self.pass_joint(state.phase, &mut state.trend, row, step) {
            return state.reach(&reached, &self.pieces);
        }
        let travelled = self.way_to_end::<N, PLAIN>(state, row, length);
        self.cross::<N, PLAIN>(state, row, travelled, (length, step.evaluations))
    }

    /// The part of a step up to the end of the present piece.
    #[inline]
    pub(crate) fn way_to_end<const N: usize, const PLAIN: bool>(
        &self,
        state: &PieceState<R, D>,
        row: &Piece<R, D>,
        length: R,
    ) -> Travelled<R, D> {
        let step = step_to_end(state, row);
        let way = self.chord_on::<N, PLAIN>(row, row.whole(), &state.at, length).over(step);
        Travelled::new(way.map(|x| x / length), step / length)
    }

    /// The place where a step of a given phase ends behind the end of a piece whose polynomial continues; the trend is
    /// converted to the scale of the next piece. `None` if another polynomial follows, or if the step was not found on
    /// this piece.
    #[inline]
    pub(crate) fn pass_joint(
        &self,
        phase: u64,
        trend: &mut Trend<R>,
        row: &Piece<R, D>,
        step: &Reached<R>,
    ) -> Option<Reached<R>> {
        let next = self.pieces.pieces.get(step.piece + 1)?;
        let is_found = is_inside(step.sigma, &row.step_per_chord) && step.phase < u64::MAX;
        if row.joint != Joint::Continues || !is_found {
            return None;
        }
        // The part of the step that exceeds `rest` lies beyond the end: no part of a step that leads to the last phase
        // does.
        let rest = phase.wrapping_neg(); // 2⁶⁴ - phase
        let phase = part_of_next(row, next, step.phase.saturating_sub(rest))?;
        *trend = trend.into_next(row, next);
        Some(Reached { piece: step.piece + 1, phase, sigma: into_next(row, next, step.sigma), ..*step })
    }

    /// Makes a step over one joint or more, with the length travelled up to the first, after so many evaluations. Returns all
    /// evaluations. The polynomials in `state` are then those of a piece that was passed.
    #[cold]
    #[inline(never)]
    pub(crate) fn cross<const N: usize, const PLAIN: bool>(
        &self,
        state: &mut PieceState<R, D>,
        row: &Piece<R, D>,
        travelled: Travelled<R, D>,
        length: (R, u32),
    ) -> u32 {
        let place = (state.piece, &mut state.at);
        let reached = self.find_across::<N, PLAIN>(place, &mut state.trend, row, travelled, length);
        let evaluations = state.reach(&reached, &self.pieces);
        if let Some(row) = self.pieces.pieces.get(state.piece) {
            state.trend = state.trend.within(&row.step_per_chord);
        }
        evaluations
    }

    /// The end of a step over joints. A piece that ends within the length is passed, and the remaining length is solved
    /// on the next. Behind a corner, where the tangent breaks, the remaining length is that of a chord that begins
    /// there. `evaluations` were made before.
    #[inline]
    fn find_across<const N: usize, const PLAIN: bool>(
        &self,
        (piece, at): (usize, &mut Shifted<R, D>),
        trend: &mut Trend<R>,
        row: &Piece<R, D>,
        mut travelled: Travelled<R, D>,
        (mut length, mut evaluations): (R, u32),
    ) -> Reached<R> {
        let mut row = row;
        let mut expected = trend.next(&row.step_per_chord);
        for (piece, next) in self.pieces.pieces.iter().enumerate().skip(piece + 1) {
            let greatest = next.step_per_chord[1];
            *trend = trend.into_next(row, next);
            expected = into_next(row, next, expected);
            if row.joint == Joint::Breaks {
                length = length * travelled.left;
                travelled = Travelled::nothing();
            }
            let Travelled { before, part, left } = travelled;
            let part = part_into_next(row, next, part.min(row.step_per_chord[1]));
            if left <= R::zero() || length <= R::zero() {
                return Reached { piece, phase: 0, sigma: trend.newest, evaluations };
            }
            self.pieces.shift_to_begin::<N, PLAIN>(piece, at);
            let mut on_next = self.chord_on::<N, PLAIN>(next, next.whole(), at, length);
            let guess = if row.joint == Joint::Breaks {
                expected = first_step_per_chord(&at.chord[0], &next.step_per_chord);
                *trend = Trend::steady(expected);
                expected
            } else {
                on_next = Chord { before: Some(before), range: [R::zero(), greatest], ..on_next };
                // The remaining part begins later than a whole chord and ends with it: σ has gone on by half of that
                // difference.
                let earlier = ((trend.newest - expected) * (R::one() - left)).half();
                (expected - within(earlier, expected, &next.step_per_chord)) * left
            };
            let is_long = guess * length >= on_next.whole;
            let whole = || sum_within(part, on_next.whole / length, greatest);
            if is_long && let Some(beyond) = past(&before, &on_next, length) {
                (row, travelled) = (next, Travelled::new(beyond, whole()));
                continue;
            }
            let most = self.tolerance.max_evaluations.saturating_sub(evaluations).max(BEHIND_JOINT);
            let (sigma, count) = on_next.solve_within(guess, &self.tolerance, most);
            evaluations += count;
            let step = sigma * length;
            let beyond = if step < on_next.whole || is_long { None } else { past(&before, &on_next, length) };
            let Some(beyond) = beyond else {
                let phase = next.part(step);
                let sigma = next.step_per_chord[0].max(sum_within(part, sigma, greatest));
                return Reached { piece, phase, sigma, evaluations };
            };
            (row, travelled) = (next, Travelled::new(beyond, whole()));
        }
        Reached { piece: self.pieces.pieces.len(), phase: 0, sigma: trend.newest, evaluations }
    }
}

/// σ of a short chord from the begin of a piece, in its range: 1/|C'|, where the chord's first coefficient gives C'.
fn first_step_per_chord<R: Real, const D: usize>(chord: &[R; D], range: &[R; 2]) -> R {
    let speed = R::norm(chord);
    if speed > R::zero() { (R::one() / speed).max(range[0]).min(range[1]) } else { range[1] }
}

/// Whether σ is a root and not the end of its range. The range is that of one piece; over a joint, the mean step per
/// chord may lie beyond it.
fn is_inside<R: Real>(sigma: R, range: &[R; 2]) -> bool {
    range[0] < sigma && sigma < range[1]
}
