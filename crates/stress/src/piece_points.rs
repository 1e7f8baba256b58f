//! Points of compiled pieces, and a check that they lie on the curve.

use kernel_oracle::{PieceJudge, Violation, demand};
use nurbs_core::{Evaluate, NurbsBuf, ORIGIN_EXPONENT, PieceLimits, Pieces, PiecesBuf, compile_with_stops};
use real::{Backend, DoubleDouble, Real};

use crate::violation::Outcome;
use crate::{PlannedPath, RandomPath};

/// The limits with which the pieces of a path are cut: for steps at full feed plus a landing step.
pub(crate) fn piece_limits<const D: usize>(path: &RandomPath<D>) -> PieceLimits {
    PieceLimits { length_mm: path.piece_mm, step_mm: path.limits.feedrate + path.limits.acceleration }
}

/// The pieces of a path in `R`, with joints at these stops; or the reason why there are none.
pub(crate) fn compiled<R: Backend, const D: usize>(
    path: &RandomPath<D>,
    stops: &[(usize, f64)],
) -> Result<PiecesBuf<R, D>, String> {
    let curves: Vec<_> = path.curves.iter().map(NurbsBuf::as_curve).collect();
    compile_with_stops::<DoubleDouble, R, D>(&curves, &piece_limits(path), stops)
        .map_err(|error| error.to_string())
}

/// The judge of a planned path's pieces, with which every format is compared. They are exact to 1e-15 of a piece, and
/// [`check_pieces`] compares them with the curve.
pub(crate) fn judge<const D: usize>(planned: &PlannedPath<'_, D>) -> Result<PieceJudge<D>, String> {
    Ok(PieceJudge::of(compiled::<f64, D>(planned.path, &planned.stops())?))
}

/// Compares the pieces of `path` in `R` with de Boor's scheme in double-double, at `samples` places of each piece. They
/// must differ by no more than a few units of the format's resolution.
///
/// With r the resolution, a point P = N/W is a Horner chain of p coefficients, each rounded to r times the piece's
/// [`coordinate_size_mm`](PiecesBuf::coordinate_size_mm). W is such a chain too where the piece is rational. The errors
/// of both are divided by W; the reciprocal is off by r/2, which is multiplied by N = P W. Together that is at most
/// `(p + 2) (1 + |P|) (1 + (1 + |P|) W)/min(W, 1)` units. Half a unit of the largest `2^coordinate_exponent`, the unit
/// of the points, is added, and one unit of the origin, 2⁻³⁹ mm.
///
/// # Errors
/// The first point that differs by more.
pub fn check_pieces<R: Backend, const D: usize>(
    path: &RandomPath<D>,
    samples: u32,
) -> Result<Outcome<usize>, Violation> {
    let table = match compiled::<R, D>(path, &[]) {
        Ok(table) => table,
        Err(refusal) => return Ok(Outcome::Refused(refusal)),
    };
    let name = R::name().to_string();
    let exact: Vec<NurbsBuf<DoubleDouble, D>> =
        path.curves.iter().filter_map(|curve| curve.convert().ok()).collect();
    let pieces = table.as_pieces();
    let resolution = R::resolution().to_f64();
    let degree = pieces.degree as f64;
    let origin = 1.01_f64.ldexp(ORIGIN_EXPONENT);
    for (piece, (row, place)) in pieces.pieces.iter().zip(table.places()).enumerate() {
        let Some(curve) = exact.get(place.curve) else { continue };
        let (begin, end) =
            (DoubleDouble::new(place.begin.0, place.begin.1), DoubleDouble::new(place.end.0, place.end.1));
        let scale = table.coordinate_size_mm(piece).max(f64::MIN_POSITIVE);
        for sample in 0..=samples {
            let phase = (u64::MAX / u64::from(samples.max(1))).saturating_mul(u64::from(sample));
            // The format cuts the phase to its own digits, and the point belongs to the cut phase.
            let t = R::from_phase(phase, 0);
            let offset = pieces.offset(piece, t);
            let last = resolution * 1.0_f64.ldexp(pieces.coordinate_exponent);
            let weight = weight_at(&pieces, piece, t.to_f64());
            let (high, low) = t.to_f64_pair();
            let at = curve.as_curve().point(begin + (end - begin) * DoubleDouble::new(high, low));
            for d in 0..D {
                let (high, low) = offset[d].to_f64_pair();
                let offset = DoubleDouble::new(high, low).ldexp(pieces.coordinate_exponent);
                let (high, low) = (row.origin[d] >> 32, row.origin[d] & 0xffff_ffff);
                let base = DoubleDouble::new(
                    (high as f64).ldexp(32 + ORIGIN_EXPONENT),
                    (low as f64).ldexp(ORIGIN_EXPONENT),
                );
                let off = (base + offset - at[d]).value().abs();
                let size = 1.0 + (offset.value() / scale).abs();
                let units = (degree + 2.0) * size * (1.0 + size * weight) / weight.min(1.0);
                let bound = units * resolution * scale + 0.5 * last + origin;
                demand("a piece's point off the curve, mm", &name, piece, off, bound)?;
            }
        }
    }
    Ok(Outcome::Ran(pieces.pieces.len()))
}

/// W of a piece at t; 1 if it has none.
fn weight_at<R: Backend, const D: usize>(pieces: &Pieces<'_, R, D>, piece: usize, t: f64) -> f64 {
    let count = pieces.degree + 1;
    match pieces.weights.get(piece * count..(piece + 1) * count) {
        Some(weights) if pieces.is_rational() => {
            weights.iter().rev().fold(0.0, |sum, w| sum * t + w.to_f64())
        }
        _ => 1.0,
    }
}
