//! The steps of a run, compiled once for each format: a kernel's step is compiled into its caller, so that a call of it in every test
//! would be as many copies of the largest function there is.

use real::Real;
use secant_interp::{PieceInterpolator, PieceSetpoint, PieceState};

#[inline(never)]
pub(crate) fn step<R: Real, const D: usize>(
    run: &PieceInterpolator<'_, R, D>,
    state: &mut PieceState<R, D>,
) -> Option<PieceSetpoint<R, D>> {
    run.step(state)
}

#[inline(never)]
pub(crate) fn step_by<R: Real, const D: usize>(
    run: &PieceInterpolator<'_, R, D>,
    state: &mut PieceState<R, D>,
    length: R,
) -> Option<PieceSetpoint<R, D>> {
    run.step_by(state, length)
}

#[inline(never)]
pub(crate) fn step_by_into<R: Real, const D: usize>(
    run: &PieceInterpolator<'_, R, D>,
    state: &mut PieceState<R, D>,
    length: R,
    setpoint: &mut PieceSetpoint<R, D>,
) -> bool {
    run.step_by_into(state, length, setpoint)
}
