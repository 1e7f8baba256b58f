//! The C functions for products with σ and x: a factor that is surely below 2 takes a cheaper one.

use nurbs_core::Piece;
use real::Backend;
use secant_interp::PieceInterpolator;

/// The C function for a product with σ, and with x.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Factors {
    pub(crate) sigma: &'static str,
    pub(crate) x: &'static str,
}

/// A bound of what is below 2, less than it by more than what roundings add.
const BELOW_TWO: f64 = 1.99;

impl Factors {
    pub(crate) fn of<R: Backend, const D: usize>(run: &PieceInterpolator<'_, R, D>) -> Self {
        let longest = longest_chord(run);
        let sigma = |row: &Piece<R, D>| row.step_per_chord[1].to_f64();
        // x = σL 2^-r; a step that is cut to its piece is shorter.
        let x = |row: &Piece<R, D>| (sigma(row) * longest) * f64::from(-i32::from(row.range_exponent)).exp2();
        let by = |bound: &dyn Fn(&Piece<R, D>) -> f64| {
            if run.pieces.pieces.iter().all(|row| bound(row) < BELOW_TWO) { "mul_by" } else { "mul" }
        };
        Self { sigma: by(&sigma), x: by(&x) }
    }
}

/// The longest chord of a run: the plan's highest feed, and the landing step by which the last one reaches further.
fn longest_chord<R: Backend, const D: usize>(run: &PieceInterpolator<'_, R, D>) -> f64 {
    let ends = run.lengths.stages.iter().flat_map(|stage| {
        let feed = stage.feed.to_f64();
        [feed, feed + stage.change.to_f64()]
    });
    ends.fold(0.0, f64::max) + run.landing_step.to_f64()
}
