//! `tables`: the paths that the firmware runs, compiled for every number format and written as Rust constants.
//!
//! On a controller a compiled path is a table in flash. Here a host compiles it, as a tool would before the part
//! runs, and writes every number exactly, so that host and target compute with the same ones.

mod operations;
mod paths;

use std::fmt::Write;

use nurbs_core::{CompileError, NurbsBuf, PieceLimits, PiecesBuf, compile};
use real::{Backend, DoubleDouble, I3F29, I4F28, I4F60, Real};
use secant_interp::{
    ChordTolerance, Constant, PieceInterpolator, StepLengths, crossings, number_function, number_type,
};

pub use operations::{Operations, operations};
pub use paths::{Path, paths};

/// A piece is no longer than this, which suits 32-bit formats.
const PIECE_MM: f64 = 32.0;
/// Evaluations of a chord on one piece, at most.
const MAX_EVALUATIONS: u32 = 6;
/// The part of the full step from which the axes come to rest in one period.
const LANDING: f64 = 0.05;

/// All paths in the formats that the firmware runs them in, as the text of a Rust module.
///
/// # Errors
/// [`CompileError`] of the first path that does not fit a format.
pub fn source() -> Result<String, CompileError> {
    let mut text: String =
        [I3F29::name(), I4F28::name(), I4F60::name()].into_iter().filter_map(number_function).collect();
    for path in paths() {
        write_path::<f64>(&mut text, &path)?;
        write_path::<f32>(&mut text, &path)?;
        write_path::<I3F29>(&mut text, &path)?;
        write_path::<I4F28>(&mut text, &path)?;
        write_path::<I4F60>(&mut text, &path)?;
    }
    Ok(text)
}

fn write_path<R: Backend>(text: &mut String, path: &Path) -> Result<(), CompileError> {
    let number = number_type(R::name()).unwrap_or_default();
    with_run::<R, _>(path, |run| {
        let name = format!("{}_{}", path.name, R::name()).to_uppercase();
        let constant = Constant(run);
        let _ =
            writeln!(text, "pub(crate) static {name}: PieceInterpolator<'static, {number}, 2> = {constant};");
    })
}

/// Compiles the path for `R` and shows its run.
fn with_run<R: Backend, T>(
    path: &Path,
    show: impl FnOnce(&PieceInterpolator<'_, R, 2>) -> T,
) -> Result<T, CompileError> {
    let curves: Vec<_> = path.curves.iter().map(NurbsBuf::as_curve).collect();
    let limits = PieceLimits { length_mm: PIECE_MM, step_mm: path.feed_mm * (1.0 + LANDING) };
    let table: PiecesBuf<R, 2> = compile::<DoubleDouble, R, 2>(&curves, &limits)?;
    let pieces = table.as_pieces();
    let unit = 1.0_f64.ldexp(pieces.chord_exponent);
    let number = |value: f64| R::from_f64(value).unwrap_or_default();
    let stages = path.stages::<R>(unit);
    Ok(show(&PieceInterpolator {
        pieces,
        lengths: StepLengths { stages: &stages, crossings: &crossings(&stages) },
        // The tolerance of what `feedbits compile` writes.
        tolerance: ChordTolerance::for_fluctuation(None, MAX_EVALUATIONS),
        landing_step: number(LANDING * path.feed_mm * unit),
    }))
}
