//! The step of a run on pieces, compiled once for a format.

use real::Real;
use secant_interp::{PieceInterpolator, PieceSetpoint, PieceState};

/// A step, which a kernel compiles into its caller: here the caller is this function alone, for all who check steps.
#[inline(never)]
pub(crate) fn next_setpoint<R: Real, const D: usize>(
    run: &PieceInterpolator<'_, R, D>,
    state: &mut PieceState<R, D>,
) -> Option<PieceSetpoint<R, D>> {
    run.step(state)
}
