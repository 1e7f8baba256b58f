//! Periods of a straight move that differ only in where they are.
//!
//! At constant feed on a straight piece, a step that was made like the one before it finds the same σ from the same numbers. What
//! changes is the place t, and the point there, `t n_1`. So a tool that asks for the range of every number, and not for the numbers one
//! by one, needs the first and the last of such periods: those of all between them are the same, or lie between theirs.

use nurbs_core::MAX_DEGREE;
use real::Real;

use crate::pieces::piece_interpolator::PieceInterpolator;
use crate::pieces::state::{PieceSetpoint, PieceState};
use crate::pieces::trend::Trend;
use crate::step_lengths::PERIOD;

/// What the next step depends on, beside its place on the piece and the time in its stage.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Course<R> {
    stage: usize,
    piece: usize,
    trend: Trend<R>,
}

impl<R: Real, const D: usize> PieceState<R, D> {
    /// The course of the next step.
    #[must_use]
    pub fn course(&self) -> Course<R> {
        Course { stage: self.cursor.stage, piece: self.piece, trend: self.trend }
    }
}

impl<R: Real, const D: usize> PieceInterpolator<'_, R, D> {
    /// Passes periods that differ from the last one only in where they are, `most` at most, and returns how many. `before` is
    /// `state.course()` before the last [`step`](Self::step), `setpoint` what that step gave, and `state` the state behind it.
    ///
    /// Every number of a period that is passed either is that of the last one, or grows or falls from period to period up to the
    /// next step, which is not passed; this holds where no number wraps, as compiling proves. The state is the one that so many
    /// calls of [`step`](Self::step) leave, bit for bit. Nothing is passed where the feed changes, on a bent piece, or near a piece's
    /// end. In floats whose places are sums, it takes an addition for each period; otherwise it takes as long however many are passed.
    pub fn skip_alike(
        &self,
        state: &mut PieceState<R, D>,
        before: &Course<R>,
        setpoint: &PieceSetpoint<R, D>,
        most: u64,
    ) -> u64 {
        let is_same = setpoint.evaluations == 1 && state.course() == *before;
        let (Some(row), Some(stage), true) = (
            self.pieces.pieces.get(state.piece),
            self.lengths.stages.get(state.cursor.stage).filter(|stage| stage.change.is_zero()),
            is_same,
        ) else {
            return 0;
        };
        if !self.pieces.is_straight(state.piece) {
            return 0;
        }
        // All that end in the middle of the stage, without the last: it is made.
        let rest = stage.duration.saturating_sub(state.cursor.time.wrapping_add(1));
        let most = most.min((rest / PERIOD).saturating_sub(1));
        let step = state.trend.newest * stage.feed;
        let passed = if R::ADDS_PLACES {
            add_steps(state, step, most)
        } else {
            add_parts(state, row.part(step), most)
        };
        state.cursor.time = state.cursor.time.wrapping_add(passed.wrapping_mul(PERIOD));
        if passed > 0 {
            self.pieces.shift_to::<MAX_DEGREE, false>(state.piece, state.t, &mut state.at);
        }
        passed
    }
}

/// Steps that are left before the end of a piece: a step that may pass it is made.
const LEFT: i32 = 4;

/// Adds a step to the place again and again, as each period does.
fn add_steps<R: Real, const D: usize>(state: &mut PieceState<R, D>, step: R, most: u64) -> u64 {
    let last = R::one() - R::from_ratio(LEFT, 1) * step;
    let (mut t, mut passed) = (state.t, 0);
    while passed < most && t < last {
        t = t + step;
        passed += 1;
    }
    match t.place_to_phase() {
        Some(phase) if passed > 0 => (state.phase, state.t) = (phase, t),
        _ => passed = 0,
    }
    passed
}

/// Adds a step, as a part of the piece, to the phase so many times. 2⁻¹⁶ of the piece are left too: there a float's place may be at the
/// end before its phase is.
fn add_parts<R: Real, const D: usize>(state: &mut PieceState<R, D>, part: u64, most: u64) -> u64 {
    const END: u64 = 1 << 48;
    let steps = (!state.phase).saturating_sub(END).checked_div(part).unwrap_or(0);
    let passed = most.min(steps.saturating_sub(u64::from(LEFT.unsigned_abs())));
    if passed > 0 {
        state.phase = state.phase.wrapping_add(passed.wrapping_mul(part));
        state.t = R::fraction(state.phase);
    }
    passed
}
