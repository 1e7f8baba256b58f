//! From a curve to compiled pieces, before real time.

use real::Backend;

use crate::pieces::cut_path::CutPath;
use crate::{CompileError, NurbsCurve, PieceLimits, PiecesBuf};

/// Cuts `curves` into pieces and rounds them to the format `R`; everything before the rounding is computed in `H`.
///
/// `H` must be a float, which the compiler checks: in fixed point the numbers of a curve do not fit.
///
/// ```compile_fail
/// # use nurbs_core::{NurbsCurve, PieceLimits, compile};
/// let line = NurbsCurve::try_new_nonrational(1, &[[0.0], [200.0]], &[0.0, 0.0, 1.0, 1.0]).unwrap();
/// let _ = compile::<real::I4F28, f64, 1>(&[line], &PieceLimits { length_mm: 32.0, step_mm: 0.2 });
/// ```
///
/// # Errors
/// [`CompileError`], naming the curve, or the signal that does not fit. If `H` cannot hold a number of a curve, as
/// `f32` cannot hold 1e300, the error is [`CompileError::SpeedOutOfRange`].
pub fn compile<H: Backend, R: Backend, const D: usize>(
    curves: &[NurbsCurve<'_, f64, D>],
    limits: &PieceLimits,
) -> Result<PiecesBuf<R, D>, CompileError> {
    compile_with_stops::<H, R, D>(curves, limits, &[])
}

/// [`compile`] with a joint at each of `stops`, so that a run can land there: a plan also rests in bends inside a span
/// that are all but cusps. A stop is the index of a curve and a parameter; stops come in order. A stop outside its
/// curve's domain, or on no curve of the path, makes no joint.
///
/// # Errors
/// As [`compile`]; [`CompileError::StopOutOfOrder`].
pub fn compile_with_stops<H: Backend, R: Backend, const D: usize>(
    curves: &[NurbsCurve<'_, f64, D>],
    limits: &PieceLimits,
    stops: &[(usize, f64)],
) -> Result<PiecesBuf<R, D>, CompileError> {
    CutPath::<H, D>::new(curves, limits, stops)?.rounded()
}
