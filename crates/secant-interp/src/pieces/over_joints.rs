//! Steps over the joints of pieces.
//!
//! A step that leads past the end of its piece ends on another piece. Where the polynomial continues, only the end of
//! the step is converted to the next piece (`pass_joint`). At a knot another polynomial begins: the length up to the
//! knot is subtracted from the chord, and the remaining length is solved on the next piece, or on one behind it
//! (`find_across`). At a corner the remaining length is that of a chord of its own.

use nurbs_core::{Joint, Piece, Shifted};
use real::Real;

use crate::pieces::chord_step::{BEHIND_JOINT, ChordBefore, sum_within};
use crate::pieces::joint::{JointScale, Reached, Travelled, part_of_next};
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
        let travelled = self.travelled_at::<N, PLAIN>(state, row, step_to_end(state, row), length);
        self.cross::<N, PLAIN>(state, row, travelled, (length, step.evaluations))
    }

    /// What of a length is travelled by `step`, which leads to the end of the present piece.
    #[inline]
    pub(crate) fn travelled_at<const N: usize, const PLAIN: bool>(
        &self,
        state: &PieceState<R, D>,
        row: &Piece<R, D>,
        step: R,
        length: R,
    ) -> Travelled<R, D> {
        let part = (step / length).min(row.step_per_chord[1]);
        let chord = self.chord_on::<N, PLAIN>(row, row.whole(), &state.at, length);
        Travelled { before: ChordBefore::new(chord.over_length(step, part)), part }
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
        let (scale, range) = (JointScale::behind(row), &next.step_per_chord);
        *trend = trend.into_next(scale, range);
        Some(Reached { piece: step.piece + 1, phase, sigma: scale.convert(step.sigma, range), ..*step })
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
        for (piece, next) in self.pieces.pieces.iter().enumerate().skip(piece + 1) {
            let (scale, range) = (JointScale::behind(row), &next.step_per_chord);
            *trend = trend.into_next(scale, range);
            let is_corner = row.joint == Joint::Breaks;
            let is_reached = if is_corner {
                length = length * travelled.before.left;
                travelled = Travelled::nothing();
                length <= R::zero()
            } else {
                travelled.before.left <= R::zero()
            };
            travelled.part = scale.convert_part(travelled.part, range);
            if is_reached {
                return Reached { piece, phase: 0, sigma: trend.newest, evaluations };
            }
            let left = travelled.before.left;
            self.pieces.shift_to_begin::<N, PLAIN>(piece, at);
            let mut on_next = self.chord_on::<N, PLAIN>(next, next.whole(), at, length);
            if is_corner {
                *trend = Trend::steady(first_step_per_chord(&at.chord[0], &next.step_per_chord));
            } else {
                on_next.before = Some(travelled.before);
            }
            let guess = trend.next_part(left, &next.step_per_chord);
            let step = on_next.step(guess);
            let is_long = step >= on_next.whole;
            if is_long && let Some(beyond) = travelled.past(&on_next) {
                (row, travelled) = (next, beyond);
                continue;
            }
            let most = self.tolerance.max_evaluations.saturating_sub(evaluations).max(BEHIND_JOINT);
            let (sigma, count) = on_next.solve_within((guess, step), &self.tolerance, most);
            evaluations += count;
            let step = on_next.step(sigma);
            let beyond = if step < on_next.whole || is_long { None } else { travelled.past(&on_next) };
            let Some(beyond) = beyond else {
                let whole = sum_within(travelled.part, on_next.of_whole(sigma), next.step_per_chord[1]);
                let sigma = next.step_per_chord[0].max(whole);
                return Reached { piece, phase: next.part(step), sigma, evaluations };
            };
            (row, travelled) = (next, beyond);
        }
        Reached { piece: self.pieces.pieces.len(), phase: 0, sigma: trend.newest, evaluations }
    }
}

/// σ of a short chord from the begin of a piece, in its range: 1/|C'|, where the chord's first coefficient gives C'.
#[inline]
fn first_step_per_chord<R: Real, const D: usize>(chord: &[R; D], range: &[R; 2]) -> R {
    let speed = R::norm(chord);
    if speed > R::zero() { (R::one() / speed).max(range[0]).min(range[1]) } else { range[1] }
}

/// Whether σ is a root and not the end of its range. The range is that of one piece; over a joint, the mean step per
/// chord may lie beyond it.
#[inline]
fn is_inside<R: Real>(sigma: R, range: &[R; 2]) -> bool {
    range[0] < sigma && sigma < range[1]
}
