//! Points of compiled pieces, and a check that they lie on the curve.

use nurbs_core::{
    Evaluate, Joint, NurbsBuf, ORIGIN_EXPONENT, PieceLimits, Pieces, PiecesBuf, compile_with_stops,
};
use real::{Backend, DoubleDouble, Real};

use crate::violation::{Outcome, Violation, demand};
use crate::{PlannedPath, RandomPath};

/// Part of a piece over which its direction is measured.
const TANGENT: f64 = 1e-6;

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

/// The same pieces in f64, with which every format is compared. They are exact to 1e-15 of a piece, and
/// [`check_pieces`] compares them with the curve.
pub(crate) struct Judge<const D: usize> {
    table: PiecesBuf<f64, D>,
}

impl<const D: usize> Judge<D> {
    pub(crate) fn new(planned: &PlannedPath<'_, D>) -> Result<Self, String> {
        Ok(Self { table: compiled::<f64, D>(planned.path, &planned.stops())? })
    }

    /// Number of pieces.
    pub(crate) fn len(&self) -> usize {
        self.table.places().len()
    }

    /// The point at the fraction `t` of `piece`, relative to the origin of the piece `about`, in mm. Past the last
    /// piece it is the end of the path.
    pub(crate) fn point(&self, piece: usize, t: f64, about: usize) -> [f64; D] {
        let last = self.len().saturating_sub(1);
        let (piece, t) = if piece > last { (last, 1.0) } else { (piece, t) };
        let pieces = self.table.as_pieces();
        let offset = pieces.offset(piece, t);
        let (from, to) = (pieces.pieces[about.min(last)].origin, pieces.pieces[piece].origin);
        core::array::from_fn(|d| {
            let origin = (to[d] - from[d]) as f64;
            origin.ldexp(ORIGIN_EXPONENT) + offset[d].ldexp(pieces.coordinate_exponent)
        })
    }

    /// The length of a step between two positions: the sum of the chords from corner to corner.
    pub(crate) fn step_length(&self, from: (usize, f64), to: (usize, f64)) -> f64 {
        let chord = |[begin, end]: [(usize, f64); 2]| {
            let (a, b) = (self.point(begin.0, begin.1, from.0), self.point(end.0, end.1, from.0));
            f64::norm(&core::array::from_fn::<_, D, _>(|d| b[d] - a[d]))
        };
        self.legs(from, to).map(chord).sum()
    }

    /// The ends of the chords that a step makes: from corner to corner.
    fn legs(&self, from: (usize, f64), to: (usize, f64)) -> impl Iterator<Item = [(usize, f64); 2]> {
        let pieces = self.table.as_pieces().pieces;
        let corners =
            (from.0..to.0).filter(|piece| pieces.get(*piece).is_some_and(|row| row.joint == Joint::Breaks));
        let mut begin = from;
        corners.map(Some).chain([None]).map(move |corner| {
            let end = corner.map_or(to, |piece| (piece, 1.0));
            [std::mem::replace(&mut begin, (end.0 + 1, 0.0)), end]
        })
    }

    /// Cosines of two turns between two positions: the sharpest turn at any joint, and the largest turn on any chord
    /// from its first direction.
    pub(crate) fn turns(&self, from: (usize, f64), to: (usize, f64)) -> (f64, f64) {
        let on_leg = |[begin, end]: [(usize, f64); 2]| self.turns_on_chord(begin, end);
        let least = |a: (f64, f64), b: (f64, f64)| (a.0.min(b.0), a.1.min(b.1));
        let (smooth, in_all) = self.legs(from, to).map(on_leg).fold((1.0, 1.0), least);
        let has_corner = self.legs(from, to).count() > 1;
        (if has_corner { -1.0 } else { smooth }, in_all)
    }

    /// The turns along a chord without a corner: at the joints, at the end, and halfway to it on the last piece.
    fn turns_on_chord(&self, (from, begin): (usize, f64), (to, end): (usize, f64)) -> (f64, f64) {
        let last = self.len().saturating_sub(1);
        let (from, to, end) = if to > last { (from.min(last), last, 1.0) } else { (from, to, end) };
        let direction = |piece: usize, begin: f64, end: f64| {
            let (a, b) = (self.point(piece, begin, piece), self.point(piece, end, piece));
            let way: [f64; D] = core::array::from_fn(|d| b[d] - a[d]);
            let length = f64::norm(&way);
            way.map(|x| x / length)
        };
        let cosine = |a: &[f64; D], b: &[f64; D]| (0..D).map(|d| a[d] * b[d]).sum::<f64>();
        let near = |t: f64| (t - TANGENT).max(0.0);
        let first = direction(from, near(begin), near(begin) + TANGENT);
        let halfway = if from == to { f64::midpoint(begin, end) } else { end / 2.0 };
        let late = [halfway, end].map(|t| direction(to, near(t), near(t) + TANGENT));
        let (mut at_joint, mut in_all) = (1.0_f64, cosine(&first, &late[0]).min(cosine(&first, &late[1])));
        for piece in from..to {
            let (before, after) = (direction(piece, 1.0 - TANGENT, 1.0), direction(piece + 1, 0.0, TANGENT));
            at_joint = at_joint.min(cosine(&before, &after));
            in_all = in_all.min(cosine(&first, &before)).min(cosine(&first, &after));
        }
        (at_joint, in_all)
    }

    /// Largest distance of the path from the chord between two positions, in mm. The path is sampled at three places of
    /// each piece and at the joints. Each position comes with its point, relative to the origin of the first position's
    /// piece.
    pub(crate) fn chord_error(
        &self,
        (from, start): ((usize, f64), &[f64; D]),
        (to, end): ((usize, f64), &[f64; D]),
    ) -> f64 {
        let chord: [f64; D] = core::array::from_fn(|d| end[d] - start[d]);
        let length = f64::norm(&chord);
        let distance = |at: [f64; D]| {
            let arm: [f64; D] = core::array::from_fn(|d| at[d] - start[d]);
            if length <= 0.0 {
                return f64::norm(&arm);
            }
            let along = f64::sum_of_products((0..D).map(|d| (arm[d], chord[d]))) / length;
            let along = along.max(0.0).min(length) / length;
            f64::norm(&core::array::from_fn::<_, D, _>(|d| arm[d] - along * chord[d]))
        };
        self.between(from, to).map(distance).fold(0.0, f64::max)
    }

    /// Length of the path between two positions, in mm, by the same samples.
    pub(crate) fn way(&self, from: (usize, f64), to: (usize, f64)) -> f64 {
        let end = self.point(to.0, to.1, from.0);
        let mut last = self.point(from.0, from.1, from.0);
        let mut way = 0.0;
        for at in self.between(from, to).chain([end]) {
            way += f64::norm(&core::array::from_fn::<_, D, _>(|d| at[d] - last[d]));
            last = at;
        }
        way
    }

    /// Points between two positions, at three places of each piece and at the joints, relative to the origin of the
    /// first position's piece.
    fn between(&self, from: (usize, f64), to: (usize, f64)) -> impl Iterator<Item = [f64; D]> {
        let last = to.0.min(self.len().saturating_sub(1));
        (from.0..=last).flat_map(move |piece| {
            let begin = if piece == from.0 { from.1 } else { 0.0 };
            let end = if piece == to.0 { to.1 } else { 1.0 };
            let places: &[f64] = if piece == to.0 { &[0.25, 0.5, 0.75] } else { &[0.25, 0.5, 0.75, 1.0] };
            places.iter().map(move |share| self.point(piece, begin + (end - begin) * share, from.0))
        })
    }
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
