//! The real-time loop on compiled pieces: positions as (piece, phase), chords without loss.

use nurbs_core::{MAX_DEGREE, Piece, Pieces, Shifted};
use real::Real;

use crate::chord_step::{Chord, ChordTolerance};
use crate::step_lengths::{LengthCursor, StepLengths};

/// One setpoint on a path of pieces.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PieceSetpoint<R, const D: usize> {
    /// Index of the piece; the number of pieces at the end of the path.
    pub piece: usize,
    /// The local parameter, in units of 2⁻⁶⁴.
    pub phase: u64,
    /// The point as an offset from the piece's origin, in coordinate units. At the end of the path it belongs to
    /// the last piece.
    pub offset: [R; D],
    /// The chord that was wanted, in chord units.
    pub length: R,
    /// Evaluations of the chord in this period.
    pub evaluations: u32,
}

/// Pieces, schedule and tolerances: what does not change during a run.
#[derive(Clone, Copy, Debug)]
pub struct PieceInterpolator<'a, R, const D: usize> {
    /// The path.
    pub pieces: Pieces<'a, R, D>,
    /// The distances to travel, a period each, in the pieces' chord units.
    pub lengths: StepLengths<'a, R>,
    /// When the solver stops.
    pub tolerance: ChordTolerance<R>,
    /// The longest step from which the axes come to rest within one period, A·T², in chord units.
    pub landing_step: R,
}

/// What changes from period to period.
#[derive(Clone, Copy, Debug)]
pub struct PieceState<R, const D: usize> {
    cursor: LengthCursor,
    piece: usize,
    phase: u64,
    /// σ of the last three steps, newest first, in the scale of `piece`.
    sigma: [R; 3],
}

impl<R: Real, const D: usize> PieceState<R, D> {
    /// Where the schedule stands.
    #[must_use]
    pub fn cursor(&self) -> &LengthCursor {
        &self.cursor
    }
}

/// A step, or a step per chord, of one piece in the scale of the next.
fn into_next<R: Real, const D: usize>(row: &Piece<R, D>, x: R) -> R {
    (x * row.joint_ratio).scale(row.joint_exponent)
}

/// The step η over a whole piece, 2^s; saturates, where no step comes near it.
fn whole<R: Real>(step_exponent: i32) -> R {
    R::from_phase(1 << 63, step_exponent + 1)
}

/// The position reached by a step, and σ there.
struct Reached<R> {
    piece: usize,
    phase: u64,
    sigma: R,
    evaluations: u32,
}

impl<R: Real, const D: usize> PieceInterpolator<'_, R, D> {
    /// The state at the start of the path.
    #[must_use]
    pub fn start(&self) -> PieceState<R, D> {
        PieceState { cursor: LengthCursor::default(), piece: 0, phase: 0, sigma: [R::zero(); 3] }
    }

    /// The next setpoint; `None` once the end of the path has been commanded.
    ///
    /// The position never goes back and never passes the end. As in [`Interpolator`](crate::Interpolator), a step
    /// that would reach the end lands on it, and a rest that rounding has left after the schedule's end is
    /// travelled in landing steps. On one piece a step takes one re-expansion and at most `max_evaluations`
    /// evaluations, and each further piece that it touches takes the same again.
    pub fn step(&self, state: &mut PieceState<R, D>) -> Option<PieceSetpoint<R, D>> {
        if state.piece >= self.pieces.pieces.len() {
            return None;
        }
        let planned = self.lengths.advance(&mut state.cursor);
        let length = planned.unwrap_or(self.landing_step).signal("chord_length");
        let is_last = planned.is_none() || self.lengths.is_over(&state.cursor);
        let reach = if is_last { length + self.landing_step } else { length };

        let at = self.pieces.shifted(state.piece, R::from_phase(state.phase, 0));
        let reached = self.travel(state, &at, reach);
        let [newest, middle, _] = state.sigma;
        state.sigma = [reached.sigma, newest, middle];
        (state.piece, state.phase) = (reached.piece, reached.phase);
        let last = self.pieces.pieces.len().saturating_sub(1);
        let offset = if state.piece > last {
            self.pieces.offset(last, R::one())
        } else {
            self.pieces.offset(state.piece, R::from_phase(state.phase, 0))
        };
        Some(PieceSetpoint {
            piece: state.piece,
            phase: state.phase,
            offset,
            length,
            evaluations: reached.evaluations,
        })
    }

    /// The chord on the present piece, and where it reaches past its end on the next ones.
    fn travel(&self, state: &mut PieceState<R, D>, at: &Shifted<R, D>, length: R) -> Reached<R> {
        let row = &self.pieces.pieces[state.piece];
        let guess = self.predict(state);
        let rest = state.phase.wrapping_neg(); // 2⁶⁴ - phase; 0 stands for a whole piece
        let to_end =
            if rest == 0 { whole(row.step_exponent) } else { R::from_phase(rest, row.step_exponent) };
        let chord = self.chord(at, length, None, row.step_per_chord);
        let mut evaluations = 0;
        // A guess well past a knot is not worth an evaluation on this piece.
        if row.continues || guess * length - to_end <= to_end.scale(-4) {
            let (sigma, count) = chord.solve(guess, &self.tolerance);
            evaluations = count;
            let step = sigma * length;
            if let Some(phase) = state.phase.checked_add(step.to_phase(-row.step_exponent)) {
                return Reached { piece: state.piece, phase, sigma, evaluations };
            }
            if let (true, Some(next)) = (row.continues, self.pieces.pieces.get(state.piece + 1)) {
                let phase = into_next(row, step - to_end).to_phase(-next.step_exponent);
                if phase < u64::MAX {
                    state.sigma = state.sigma.map(|x| into_next(row, x));
                    return Reached {
                        piece: state.piece + 1,
                        phase,
                        sigma: into_next(row, sigma),
                        evaluations,
                    };
                }
            }
        }
        self.cross(state, at, to_end, length, evaluations)
    }

    /// A step over one or more joints: the chord to the end of each piece, then the rest on the last.
    fn cross(
        &self,
        state: &mut PieceState<R, D>,
        at: &Shifted<R, D>,
        to_end: R,
        length: R,
        mut evaluations: u32,
    ) -> Reached<R> {
        let mut travelled = self.chord_of(at, to_end);
        let mut step_here = to_end;
        let mut piece = state.piece;
        loop {
            let row = &self.pieces.pieces[piece];
            piece += 1;
            let Some(next_row) = self.pieces.pieces.get(piece) else {
                return Reached { piece, phase: 0, sigma: state.sigma[0], evaluations: evaluations + 1 };
            };
            state.sigma = state.sigma.map(|x| into_next(row, x));
            step_here = into_next(row, step_here);

            let before = travelled.map(|x| x / length);
            let left = (R::one() - R::norm(&before)).max(R::zero());
            let next_at = self.pieces.shifted(piece, R::zero());
            let range = [R::zero(), next_row.step_per_chord[1]];
            let chord = self.chord(&next_at, length, Some(before), range);
            let (sigma, count) = chord.solve(state.sigma[0] * left, &self.tolerance);
            evaluations += count;
            let step = sigma * length;
            let whole = whole(next_row.step_exponent);
            if step < whole {
                let over_both = (step_here + step) / length;
                return Reached {
                    piece,
                    phase: step.to_phase(-next_row.step_exponent),
                    sigma: over_both,
                    evaluations,
                };
            }
            let across = self.chord_of(&next_at, whole);
            for d in 0..D {
                travelled[d] = travelled[d] + across[d];
            }
            step_here = step_here + whole;
        }
    }

    /// The chord over the step η, in chord units.
    fn chord_of(&self, at: &Shifted<R, D>, step: R) -> [R; D] {
        let x = step.scale(-self.pieces.range_exponent);
        let mut chord = [R::zero(); D];
        for c in at.chord[..self.pieces.degree].iter().rev() {
            chord = core::array::from_fn(|d| chord[d].mul_add(x, c[d]));
        }
        let chord = chord.map(|c| c * step);
        if !self.pieces.is_rational() {
            return chord;
        }
        let weight =
            at.weight[..self.pieces.degree].iter().rev().fold(R::zero(), |sum, w| sum.mul_add(x, *w));
        let weight = weight.mul_add(x, R::one());
        chord.map(|c| c / weight)
    }

    fn chord<'b>(
        &self,
        at: &'b Shifted<R, D>,
        length: R,
        before: Option<[R; D]>,
        range: [R; 2],
    ) -> Chord<'b, R, D> {
        let (degree, rational) = (self.pieces.degree.min(MAX_DEGREE), self.pieces.is_rational());
        Chord { at, degree, rational, range_exponent: self.pieces.range_exponent, length, before, range }
    }

    /// `3σ_i - 3σ_{i-1} + σ_{i-2}`; at the start, for want of a history, the middle of the piece's range.
    fn predict(&self, state: &mut PieceState<R, D>) -> R {
        if state.sigma[0].is_zero() {
            let [low, high] = self.pieces.pieces[state.piece].step_per_chord;
            state.sigma = [low + (high - low).half(); 3];
        }
        let [a, b, c] = state.sigma;
        let (newer, older) = (a - b, b - c);
        a + newer + newer - older
    }
}
