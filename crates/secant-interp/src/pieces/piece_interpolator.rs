//! The real-time loop on compiled pieces: positions as (piece, phase), chords without loss.
//!
//! The decisions of a period, from top to bottom. The further right, the rarer:
//!
//! ```text
//! step ──────── has the plan a distance for this period? ─ no ──────────> landing: a landing step
//!   │
//! find_ahead ── is the guess in range and on this piece? ─ no ─────────> search ─┐   up to the end of the piece, or from a guess
//!   │                                                                           │   that is held to the range
//!   ├────────── is one evaluation enough? ─── no ──────> refine ─┐               │
//!   │                                                            ├─> travel <────┤   the end of the step on this piece
//! onward ────── does the step end on this piece? ─── no ─────────┴─> pass_end    ├─> cross   (over_joints.rs)
//!   │                                                                 │          │
//!   │                                                                 └──────────┘   the polynomial changes at the joint
//! shift_along: the polynomials about the new place        arrive: the same after all rare ways
//! ```

use nurbs_core::{Coefficients, MAX_DEGREE, Piece, Pieces, RightShifts, Shifted};
use real::Real;

use crate::pieces::chord_step::{Chord, ChordTolerance, Evaluation, difference_within, sum_within};
use crate::pieces::joint::Reached;
use crate::pieces::place::{after, is_on_piece, onward, place_of, step_to_end};
use crate::pieces::state::{CUBIC, Form, PieceSetpoint, PieceState};
use crate::pieces::trend::Trend;
use crate::step_lengths::{LengthCursor, PERIOD, StepLengths};

/// Pieces, schedule and tolerances: all values that stay the same during a run.
#[derive(Clone, Copy, Debug)]
pub struct PieceInterpolator<'a, R, const D: usize> {
    /// The path.
    pub pieces: Pieces<'a, R, D>,
    /// The distances to travel, one for each period, in the pieces' chord units.
    pub lengths: StepLengths<'a, R>,
    /// When the solver stops.
    pub tolerance: ChordTolerance<R>,
    /// The longest step from which the axes come to rest within one period, A·T², in chord units. The pieces must be
    /// compiled for steps that exceed the longest planned one by this
    /// ([`PieceLimits::step_mm`](nurbs_core::PieceLimits)).
    pub landing_step: R,
}

impl<R: Real, const D: usize> PieceInterpolator<'_, R, D> {
    /// Whether the end of the path has been commanded.
    #[must_use]
    pub fn is_at_end(&self, state: &PieceState<R, D>) -> bool {
        state.piece >= self.pieces.pieces.len()
    }

    /// The state at the start of the path.
    #[must_use]
    pub fn start(&self) -> PieceState<R, D> {
        let mut at = Shifted::default();
        self.pieces.shift_to_begin::<MAX_DEGREE, false>(0, &mut at);
        let first = self.pieces.pieces.first();
        let whole = first.map_or(R::one(), Piece::whole);
        let mut state = PieceState {
            cursor: LengthCursor::default(),
            piece: 0,
            phase: 0,
            whole,
            form: first.map_or(Form::Any, |row| Form::of(&self.pieces, row)),
            trend: Trend::steady(R::zero()),
            t: R::zero(),
            at,
        };
        if let Some(row) = first {
            state.trend = Trend::steady(self.first_step_per_chord(&state, row));
        }
        state
    }

    /// σ of the first chord. There is no history, so it is found from the middle of the piece's range, before the run,
    /// where evaluations do not count. Guesses from an arbitrary history would be off by most of the range.
    fn first_step_per_chord(&self, state: &PieceState<R, D>, row: &Piece<R, D>) -> R {
        let [low, high] = row.step_per_chord;
        let length =
            self.lengths.advance_by(&mut LengthCursor::default(), PERIOD).unwrap_or(self.landing_step);
        let tolerance = ChordTolerance { max_evaluations: u32::from(u8::MAX), ..self.tolerance };
        self.chord(row, &state.at, length).solve(low + (high - low).half(), &tolerance).0
    }

    /// The next setpoint; `None` once the end of the path has been commanded and the schedule is over.
    ///
    /// The position never goes back and never passes the end. As in [`Interpolator`](crate::Interpolator), a step that
    /// would reach the end lands on it. A run that rounding has brought there early stands on the end until its
    /// schedule is over. If rounding has left a part of the path behind the schedule's end, the run travels it in
    /// landing steps. In a format too coarse for the landing step, the step is doubled until it moves the position, so
    /// that every run ends. A step takes one re-expansion and at most `max_evaluations` evaluations, which the pieces
    /// share that it touches; each further piece takes up to two more once they are used up.
    ///
    /// A step over a corner, at which the tangent breaks, goes from corner to corner: the sum of these chords is the
    /// length. A chord may come out shorter than planned if the path turns over it by more than 60° without a corner:
    /// steps per chord are limited to a sixteenth above that of the piece's slowest point, and such a chord has an arc
    /// that is longer by more. Over joints it may if behind the last one the path turns by more than 48° from the chord
    /// up to there: the way that is left is then 1½ times as long as the length that is left, and in formats of two integer
    /// bits trials may not go so far.
    ///
    /// The function is compiled into its caller: where flash is short, call it from one place.
    #[inline(always)] // Called, it takes a tenth longer in fixed point: the state and the setpoint go through memory.
    pub fn step(&self, state: &mut PieceState<R, D>) -> Option<PieceSetpoint<R, D>> {
        let mut setpoint = PieceSetpoint::default();
        self.step_into(state, &mut setpoint).then_some(setpoint)
    }

    /// [`step`](Self::step) that writes the setpoint where the caller has it; false, and nothing is written, where that gives
    /// `None`. On a controller it saves a copy of the setpoint, a tenth of a step in floats.
    #[inline(always)] // As `step` is.
    pub fn step_into(&self, state: &mut PieceState<R, D>, setpoint: &mut PieceSetpoint<R, D>) -> bool {
        let Some((length, is_last)) = self.lengths.advance_or_end(&mut state.cursor) else {
            return self.step_behind_plan(state, setpoint);
        };
        match self.pieces.pieces.get(state.piece) {
            Some(row) => {
                let wanted = self.planned(length, is_last);
                self.follow(state, row, wanted, setpoint);
            }
            None => *setpoint = PieceSetpoint { length, ..self.hold(state) },
        }
        true
    }

    /// A step when the schedule is over: a landing step, unless the path is at its end too.
    #[cold]
    #[inline(never)]
    fn step_behind_plan(&self, state: &mut PieceState<R, D>, setpoint: &mut PieceSetpoint<R, D>) -> bool {
        let Some(row) = self.pieces.pieces.get(state.piece) else { return false };
        // In the form for every piece, of which one is enough where speed does not count.
        let wanted = self.landing(state, row);
        self.follow_on::<MAX_DEGREE, false>(state, (row, None), wanted, setpoint);
        true
    }

    /// The next setpoint, at a chord of this length, whatever the schedule says; `None` once the end of the path has
    /// been commanded. It is for a program that decides on the feed elsewhere: a planner of its own, a handwheel, a
    /// spindle that leads.
    ///
    /// `length` is in the pieces' chord units, 2^-λ mm ([`Pieces::chord_exponent`]), and no longer than the steps that
    /// the pieces were compiled for ([`PieceLimits::step_mm`](nurbs_core::PieceLimits)). With a longer one, numbers of
    /// fixed point may wrap, and the setpoint has no meaning. A length that is not above 0 gives the setpoint of the
    /// period before. A step that would pass the end of the path lands on it, and is the last one. The schedule stays
    /// where it is.
    ///
    /// As [`step`](Self::step), it is compiled into its caller.
    #[inline(always)] // As `step` is.
    pub fn step_by(&self, state: &mut PieceState<R, D>, length: R) -> Option<PieceSetpoint<R, D>> {
        let mut setpoint = PieceSetpoint::default();
        self.step_by_into(state, length, &mut setpoint).then_some(setpoint)
    }

    /// [`step_by`](Self::step_by) that writes the setpoint where the caller has it; false, and nothing is written, where that
    /// gives `None`. It saves the copies of the setpoint: on a PC a tenth of a step.
    #[inline(always)] // As `step` is.
    pub fn step_by_into(
        &self,
        state: &mut PieceState<R, D>,
        length: R,
        setpoint: &mut PieceSetpoint<R, D>,
    ) -> bool {
        let Some(row) = self.pieces.pieces.get(state.piece) else { return false };
        if length > R::zero() {
            self.follow(state, row, Wanted { length, reach: length }, setpoint);
        } else {
            *setpoint = self.hold(state);
        }
        true
    }

    /// The setpoint of the period before, for one in which nothing moves.
    #[cold]
    #[inline(never)]
    pub(crate) fn hold(&self, state: &PieceState<R, D>) -> PieceSetpoint<R, D> {
        let (piece, phase) = (state.piece, state.phase);
        let offset = self.pieces.in_common_units(piece.min(self.end().0), &state.at.offset);
        PieceSetpoint { piece, phase, offset, length: R::zero(), evaluations: 0 }
    }

    /// One period.
    #[inline(always)]
    fn follow(
        &self,
        state: &mut PieceState<R, D>,
        row: &Piece<R, D>,
        wanted: Wanted<R>,
        setpoint: &mut PieceSetpoint<R, D>,
    ) {
        // In a `const` the compiler knows, before it makes machine code, that numbers without forms of their own call none.
        if const { Form::are_compiled::<R>() } {
            match state.form {
                Form::LoweredCubic(shifts) => {
                    return self.follow_on::<CUBIC, true>(state, (row, Some(shifts)), wanted, setpoint);
                }
                // In floats nothing is scaled, so that this form is none of its own.
                Form::Cubic if !R::IS_FLOATING => {
                    return self.follow_on::<CUBIC, true>(state, (row, None), wanted, setpoint);
                }
                Form::RationalCubic(shifts) => {
                    return self.follow_on::<CUBIC, false>(state, (row, Some(shifts)), wanted, setpoint);
                }
                Form::Any | Form::Cubic => {}
            }
        }
        self.follow_on::<MAX_DEGREE, false>(state, (row, None), wanted, setpoint);
    }

    /// One period for rarer callers, compiled once.
    #[inline(never)]
    pub(crate) fn follow_aside(
        &self,
        state: &mut PieceState<R, D>,
        row: &Piece<R, D>,
        wanted: Wanted<R>,
    ) -> PieceSetpoint<R, D> {
        let mut setpoint = PieceSetpoint::default();
        self.follow(state, row, wanted, &mut setpoint);
        setpoint
    }

    /// A chord of the plan. In the schedule's last period the step reaches further by a landing step, so that it
    /// includes any part of the path that rounding has left.
    #[inline(always)]
    pub(crate) fn planned(&self, length: R, is_last: bool) -> Wanted<R> {
        let length = length.signal("chord_length");
        let reach = if is_last { sum_within(length, self.landing_step, R::max_value()) } else { length };
        Wanted { length, reach }
    }

    /// One period on pieces of degree N, or with [`MAX_DEGREE`] on pieces of any degree; if PLAIN, only on pieces
    /// without weights.
    #[inline(always)]
    fn follow_on<const N: usize, const PLAIN: bool>(
        &self,
        state: &mut PieceState<R, D>,
        (row, shifts): (&Piece<R, D>, Option<RightShifts>),
        Wanted { length, reach }: Wanted<R>,
        setpoint: &mut PieceSetpoint<R, D>,
    ) {
        let evaluations = match self.find_ahead::<N, PLAIN>(state, (row, shifts), reach) {
            Ok((sigma, coefficients)) => {
                let step = sigma * reach;
                if let Some((phase, t)) = onward(row, (state.phase, state.t), step) {
                    (state.phase, state.t) = (phase, t);
                    state.trend = state.trend.and(sigma);
                    let t = t.signal("parameter");
                    // Most fields are known before the point, and are written before it: they would wait for it in memory.
                    (setpoint.piece, setpoint.phase, setpoint.length) = (state.piece, phase, length);
                    setpoint.offset =
                        self.pieces.shift_along::<N, PLAIN>((row, shifts), &coefficients, t, &mut state.at);
                    setpoint.evaluations = 1;
                    return;
                }
                let step = Reached { piece: state.piece, phase: row.part(step), sigma, evaluations: 1 };
                self.pass_end_on::<N, PLAIN>(state, row, reach, &step)
            }
            Err(Some(value)) => self.refine::<N, PLAIN>(state, row, reach, value),
            Err(None) if PLAIN => self.search::<N, PLAIN>(state, row, reach),
            Err(None) => self.search::<MAX_DEGREE, false>(state, row, reach),
        };
        self.arrive::<N, PLAIN>(state, (length, evaluations), setpoint);
    }

    /// The last piece and its last parameter.
    #[cold]
    fn end(&self) -> (usize, R) {
        (self.pieces.pieces.len().saturating_sub(1), R::one())
    }

    /// The chord of a step after the schedule's end: the landing step, doubled until it moves even with the piece's least
    /// step per chord, which is no less than the format's resolution.
    #[cold]
    #[inline(never)]
    pub(crate) fn landing(&self, state: &PieceState<R, D>, row: &Piece<R, D>) -> Wanted<R> {
        let place = (state.phase, state.t);
        let moves = |length: R| onward(row, place, row.step_per_chord[0] * length) != Some(place);
        let mut length = self.landing_step.max(R::resolution());
        for _ in 0..u64::BITS {
            if moves(length) {
                break;
            }
            length = length + length;
        }
        let length = length.signal("chord_length");
        Wanted { length, reach: length }
    }

    /// σ of a common step, with the coefficients of the piece: on the present piece, if the guess and one correction are enough. If
    /// they are not, the evaluation of the guess. If the guess leads past the piece or back, or is out of range in fixed point, `None`
    /// instead of an evaluation.
    #[inline(always)]
    fn find_ahead<const N: usize, const PLAIN: bool>(
        &self,
        state: &PieceState<R, D>,
        (row, shifts): (&Piece<R, D>, Option<RightShifts>),
        length: R,
    ) -> Result<(R, Coefficients<'_, R, D>), Option<Evaluation<R>>> {
        let coefficients = self.pieces.coefficients::<N, PLAIN>(state.piece).ok_or(None)?;
        let Trend { newest, fall, .. } = state.trend;
        let guess = difference_within(newest, fall, &row.step_per_chord).ok_or(None)?;
        let step = guess * length;
        if !is_on_piece(state, row, step) {
            return Err(None);
        }
        let step = step.signal("step");
        let chord = self.chord_on::<N, PLAIN>(row, state.whole, &state.at, length);
        let x = match shifts {
            Some(shifts) if N < MAX_DEGREE => shifts.to_variable(step).signal("chord_variable"),
            _ => chord.variable(step),
        };
        chord.correct(guess, x, &self.tolerance).map(|sigma| (sigma, coefficients)).map_err(Some)
    }

    /// Finishes a step that was not a common one: the polynomials about the place where it arrived, and the setpoint.
    #[cold]
    #[inline(never)]
    fn arrive<const N: usize, const PLAIN: bool>(
        &self,
        state: &mut PieceState<R, D>,
        (length, evaluations): (R, u32),
        setpoint: &mut PieceSetpoint<R, D>,
    ) {
        let is_end = state.piece >= self.pieces.pieces.len();
        let (of, t) = if is_end {
            self.end()
        } else {
            let (phase, t) = place_of(state.phase);
            state.phase = phase;
            (state.piece, t)
        };
        state.t = t;
        let t = t.signal("parameter");
        let offset = match (self.pieces.pieces.get(of), self.pieces.coefficients::<N, PLAIN>(of)) {
            (Some(row), Some(coefficients)) => {
                let shifts = if is_end { None } else { state.form.right_shifts() };
                self.pieces.shift_along::<N, false>((row, shifts), &coefficients, t, &mut state.at)
            }
            _ => state.at.offset,
        };
        *setpoint = PieceSetpoint { piece: state.piece, phase: state.phase, offset, length, evaluations };
    }

    /// Makes a step whose guess is not in the range of its piece or leads past it. The guess may be wrong: the step passes
    /// the piece's end if that is nearer than the length. It is not if the longest step does not reach it. Returns the
    /// evaluations.
    #[cold]
    #[inline(never)]
    fn search<const N: usize, const PLAIN: bool>(
        &self,
        state: &mut PieceState<R, D>,
        row: &Piece<R, D>,
        length: R,
    ) -> u32 {
        let step = step_to_end(state, row);
        if step <= row.step_per_chord[1] * length {
            let travelled = self.travelled_at::<N, PLAIN>(state, row, step, length);
            if travelled.before.left > R::zero() {
                return self.cross::<N, PLAIN>(state, row, travelled, (length, 0));
            }
        }
        let guess = state.trend.next(&row.step_per_chord);
        let chord = self.chord_on::<N, PLAIN>(row, state.whole, &state.at, length);
        let found = chord.solve(guess, &self.tolerance);
        self.travel::<N, PLAIN>(state, row, length, found)
    }

    /// Makes a step on the present piece where the evaluation of the guess is not enough. Returns the evaluations.
    #[cold]
    #[inline(never)]
    fn refine<const N: usize, const PLAIN: bool>(
        &self,
        state: &mut PieceState<R, D>,
        row: &Piece<R, D>,
        length: R,
        value: Evaluation<R>,
    ) -> u32 {
        let guess = state.trend.newest - state.trend.fall;
        let chord = self.chord_on::<N, PLAIN>(row, state.whole, &state.at, length);
        let found = chord.refine(guess, value, &self.tolerance, self.tolerance.max_evaluations);
        self.travel::<N, PLAIN>(state, row, length, found)
    }

    /// Makes a step of this σ from the present piece, which took `evaluations` evaluations to find. Returns all
    /// evaluations.
    fn travel<const N: usize, const PLAIN: bool>(
        &self,
        state: &mut PieceState<R, D>,
        row: &Piece<R, D>,
        length: R,
        (sigma, evaluations): (R, u32),
    ) -> u32 {
        let part = row.part(sigma * length);
        if let Some(phase) = after(state.phase, part) {
            state.phase = phase;
            state.trend = state.trend.and(sigma).within(&row.step_per_chord);
            return evaluations;
        }
        let step = Reached { piece: state.piece, phase: part, sigma, evaluations };
        self.pass_end_on::<N, PLAIN>(state, row, length, &step)
    }

    /// [`pass_end`](Self::pass_end) in the form of a step. The joints of cubics with weights are passed in the form for every
    /// degree: a third form of what is so rare would take more flash than it is worth.
    #[inline(always)]
    fn pass_end_on<const N: usize, const PLAIN: bool>(
        &self,
        state: &mut PieceState<R, D>,
        row: &Piece<R, D>,
        length: R,
        step: &Reached<R>,
    ) -> u32 {
        if PLAIN {
            self.pass_end::<N, PLAIN>(state, row, length, step)
        } else {
            self.pass_end::<MAX_DEGREE, false>(state, row, length, step)
        }
    }

    /// The chord on a piece, from the point about which it was shifted, in the form for every degree.
    pub(crate) fn chord<'b>(&self, row: &Piece<R, D>, at: &'b Shifted<R, D>, length: R) -> Chord<'b, R, D> {
        self.chord_on(row, row.whole(), at, length)
    }

    /// The chord in the form for degree N, or for paths without weights; `whole` is the step over the whole piece.
    #[inline]
    pub(crate) fn chord_on<'b, const N: usize, const PLAIN: bool>(
        &self,
        row: &Piece<R, D>,
        whole: R,
        at: &'b Shifted<R, D>,
        length: R,
    ) -> Chord<'b, R, D, N, PLAIN> {
        Chord {
            at,
            degree: self.pieces.degree,
            // If the degree is known at compile time, so is this.
            rational: if N < MAX_DEGREE { !PLAIN } else { self.pieces.is_rational() },
            range_exponent: i32::from(row.range_exponent),
            whole,
            length,
            before: None,
            range: row.step_per_chord,
        }
    }
}

/// The chord of a period. The step is solved for `reach`, and ends where the path does if the path ends within it.
#[derive(Clone, Copy)]
pub(crate) struct Wanted<R> {
    pub(crate) length: R,
    pub(crate) reach: R,
}
