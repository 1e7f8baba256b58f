//! `tables`: the paths that the firmware runs, compiled for every number format and written as Rust constants.
//!
//! On a controller a compiled path is a table in flash. Here a host compiles it, as a tool would before the part
//! runs, and writes every number exactly, so that host and target compute with the same ones.

mod operations;
mod paths;

use std::fmt::Write;

use nurbs_core::{CompileError, NurbsBuf, PieceLimits, PiecesBuf, compile};
use real::{Backend, DoubleDouble, I3F29, I4F28, I4F60, Real};
use secant_interp::{ChordTolerance, PieceInterpolator, StepLengths};

pub use operations::{Operations, operations};
pub use paths::{Path, paths};

/// A piece is no longer than this, which suits 32-bit formats.
const PIECE_MM: f64 = 32.0;
/// The largest residual whose one correction is enough, for a feedrate fluctuation of 1e-9; a coarse format takes
/// four units of its resolution instead.
const RESIDUAL: f64 = 3e-5;
/// Evaluations of a chord on one piece, at most.
const MAX_EVALUATIONS: u32 = 6;
/// The part of the full step from which the axes come to rest in one period.
const LANDING: f64 = 0.05;

/// All paths in the formats that the firmware runs them in, as the text of a Rust module.
///
/// # Errors
/// [`CompileError`] of the first path that does not fit a format.
pub fn source() -> Result<String, CompileError> {
    let mut text = String::new();
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
    let format = R::name().to_string();
    with_run::<R, _>(path, |interpolator| {
        let _ = writeln!(
            text,
            "pub(crate) static {}_{}: PieceInterpolator<'static, {format}, 2> = {};",
            path.name.to_uppercase(),
            format.to_uppercase(),
            expression(&format!("{interpolator:?}"), &format),
        );
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
    let unit = 1.0_f64.scale(pieces.chord_exponent);
    let number = |value: f64| R::from_f64(value).unwrap_or_default();
    Ok(show(&PieceInterpolator {
        pieces,
        lengths: StepLengths { stages: &path.stages::<R>(unit) },
        tolerance: ChordTolerance {
            residual: number(RESIDUAL).max(R::resolution().scale(2)),
            max_evaluations: MAX_EVALUATIONS,
        },
        landing_step: number(LANDING * path.feed_mm * unit),
    }))
}

/// Turns the `Debug` form of plain data into a Rust expression of the same value.
///
/// Structures, arrays and floats already are one; floats are printed with the digits that tell them apart. Slices want
/// a `&`, and a fixed-point number, printed in the same way, its type.
fn expression(debug: &str, format: &str) -> String {
    let mut text = debug.to_owned();
    for slice in ["pieces", "numerators", "weights", "stages"] {
        text = text.replace(&format!("{slice}: ["), &format!("{slice}: &["));
    }
    let mut parts = text.split("FixedPoint(");
    let mut text = parts.next().unwrap_or_default().to_owned();
    for part in parts {
        let (digits, rest) = part.split_once(')').unwrap_or((part, ""));
        let _ = write!(text, "FixedPoint(fixed::types::{format}::lit(\"{digits}\")){rest}");
    }
    text
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The tables are exact because every number comes back from its digits.
    #[test]
    fn fixed_point_numbers_come_back_from_their_digits() {
        let mut bits = 1_u64;
        for _ in 0..100_000 {
            bits = bits.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
            let long = fixed::types::I4F60::from_bits(bits.cast_signed());
            assert_eq!(format!("{long:?}").parse(), Ok(long));
            let short = fixed::types::I4F28::from_bits((bits.cast_signed() >> 32) as i32);
            assert_eq!(format!("{short:?}").parse(), Ok(short));
        }
    }

    #[test]
    fn an_expression_is_rust() {
        let debug =
            "Pieces { pieces: [Piece { origin: [1, -2], joint_ratio: FixedPoint(-0.5) }], weights: [] }";
        let rust = "Pieces { pieces: &[Piece { origin: [1, -2], \
                    joint_ratio: FixedPoint(fixed::types::I4F28::lit(\"-0.5\")) }], weights: &[] }";
        assert_eq!(expression(debug, "I4F28"), rust);
    }
}
