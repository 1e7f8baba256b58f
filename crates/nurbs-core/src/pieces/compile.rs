//! From a curve to compiled pieces, before real time: cutting, normalising, and proving that everything fits.
//!
//! All of it runs in a high precision `H`; each coefficient is rounded once, into the format.

use alloc::vec::Vec;

use real::{Backend, FormatName, Real};

use crate::pieces::cut::{Cut, cut};
use crate::pieces::local_piece::LocalPiece;
use crate::pieces::ranges;
use crate::pieces::scales::{Scales, exponent_below, power_of_two};
use crate::pieces::speed::MAX_STEP_EXPONENT;
use crate::{CompileError, Joint, MAX_DEGREE, NurbsCurve, Piece, PieceLimits, PiecesBuf, Place};

/// Largest chord in its own scale. With it, a step of a quarter of the longest is resolved as finely as the step per
/// chord, which is about 1. A larger range would gain nothing.
const MAX_CHORD_RANGE: f64 = 4.0;

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
    for (what, value) in [("the longest piece", limits.length_mm), ("the longest step", limits.step_mm)] {
        if !(value > 0.0 && value.is_finite()) {
            return Err(CompileError::LimitNotPositive { what, value });
        }
    }
    let mut before = (0, f64::NEG_INFINITY);
    for (index, stop) in stops.iter().enumerate() {
        let is_in_order = before <= *stop; // false for NaN
        if !is_in_order {
            return Err(CompileError::StopOutOfOrder { index });
        }
        before = *stop;
    }
    let mut local = Cut { pieces: Vec::new(), still: Vec::new() };
    for (index, curve) in curves.iter().enumerate() {
        let first = stops.partition_point(|stop| stop.0 < index);
        let stops = stops.iter().skip(first).take_while(|stop| stop.0 == index).map(|stop| stop.1);
        cut::<H, D>((index, curve), limits, stops, &mut local)?;
    }
    match local.still.first() {
        Some(place) if local.pieces.is_empty() => {
            Err(CompileError::Cusp { curve: place.curve, parameter: place.begin.0 })
        }
        _ => rounded::<H, R, D>(local, limits.step_mm),
    }
}

/// Chooses the scales for `R`, proves the bounds, and rounds.
fn rounded<H: Backend, R: Backend, const D: usize>(
    Cut { pieces: local, still }: Cut<H, D>,
    step_mm: f64,
) -> Result<PiecesBuf<R, D>, CompileError> {
    let degree = local.iter().map(|piece| piece.numerator.len()).max().unwrap_or(1).min(MAX_DEGREE);
    let rational = local.iter().any(|piece| piece.rational);
    let local = scaled::<H, R, D>(local, step_mm);
    let fixed = matches!(R::name(), FormatName::Fixed { .. });
    let resolution = if fixed { R::resolution().to_f64() } else { 0.0 };
    let bounds = ranges::signal_bounds(&local, rational, step_mm, (resolution, R::max_value().to_f64()));
    if fixed {
        ranges::refuse_what_does_not_fit::<R>(&bounds)?;
    }
    let mut table = PiecesBuf {
        pieces: Vec::with_capacity(local.len()),
        numerators: Vec::with_capacity(local.len() * degree),
        weights: Vec::new(),
        degree,
        coordinate_exponent: local.iter().map(|(_, scales)| scales.coordinate).max().unwrap_or(0),
        chord_exponent: local.first().map_or(0, |(_, scales)| scales.chord),
        places: local.iter().map(|(piece, _)| piece.place).collect(),
        still,
        bounds,
        step_mm,
    };
    let round = |x: H| R::from_f64_pair(x.to_f64_pair().0, x.to_f64_pair().1);
    for (index, (piece, scales)) in local.iter().enumerate() {
        let Place { curve, begin, .. } = piece.place;
        let out_of_range = CompileError::SpeedOutOfRange { curve, parameter: begin.0 };
        for k in 0..degree {
            let power = piece.numerator.get(k).copied().unwrap_or([H::zero(); D]);
            let mut rounded = [R::zero(); D];
            for (to, x) in rounded.iter_mut().zip(power) {
                *to = round(x.ldexp(-scales.coordinate)).ok_or(out_of_range)?;
            }
            table.numerators.push(rounded);
        }
        for k in (0..=degree).filter(|_| rational) {
            let weight = piece.weight.get(k).copied().unwrap_or_else(H::zero);
            table.weights.push(round(weight).ok_or(out_of_range)?);
        }
        let row = row(piece, scales, local.get(index + 1));
        // A step per chord that a float rounds to zero, or cannot hold, would stop a run for good.
        if !row.step_per_chord.iter().all(|sigma: &R| *sigma > R::zero() && sigma.is_finite()) {
            return Err(out_of_range);
        }
        table.pieces.push(row);
    }
    Ok(table)
}

/// Joins the scales to the pieces.
fn scaled<H: Backend, R: Backend, const D: usize>(
    local: Vec<LocalPiece<H, D>>,
    step_mm: f64,
) -> Vec<(LocalPiece<H, D>, Scales)> {
    // The chords use half of a fixed format's range. In a float, numbers of order one do as well as any.
    let fixed = matches!(R::name(), FormatName::Fixed { .. });
    let range = if fixed { R::max_value().to_f64() } else { 2.0 };
    let chord_range = (range / 2.0).min(MAX_CHORD_RANGE);
    let mut chord = exponent_below(chord_range / step_mm);
    if R::IS_FLOATING {
        chord = chord.clamp(-MAX_STEP_EXPONENT, MAX_STEP_EXPONENT); // -λ then has a place in a row.
    }
    let scales = |piece: &LocalPiece<H, D>| {
        if R::IS_FLOATING {
            return Scales { coordinate: -chord, chord, step: 0, range: 0 };
        }
        let step = piece.speed.step_exponent(chord);
        let coordinate = (-exponent_below(range / piece.coordinate_bound_mm())).clamp(-120, 120);
        let scales = Scales { coordinate, chord, step, range: step };
        let longest = piece.step_per_chord(&scales)[1] * step_mm * power_of_two(chord);
        // The roundings of the higher coefficients reach the chord times x and x²: at most a half and a quarter of a unit.
        let range = exponent_below(longest) + 2;
        Scales { range: range.min(step), ..scales }
    };
    local
        .into_iter()
        .map(|piece| {
            let scales = scales(&piece);
            (piece, scales)
        })
        .collect()
}

/// An exponent as a row holds it. An exponent that is cut off here lies beyond every format.
fn small(exponent: i32) -> i8 {
    i8::try_from(exponent.clamp(-126, 126)).unwrap_or(0)
}

/// A fraction in [½, 1) in units of 2⁻¹⁶, rounded to nearest.
#[allow(
    clippy::cast_possible_truncation,
    clippy::cast_sign_loss,
    reason = "the cast saturates, and no fraction is negative"
)]
fn sixteen_bits(fraction: f64) -> u16 {
    (fraction.ldexp(16) + 0.5) as u16
}

fn row<H: Backend, R: Backend, const D: usize>(
    piece: &LocalPiece<H, D>,
    scales: &Scales,
    next: Option<&(LocalPiece<H, D>, Scales)>,
) -> Piece<R, D> {
    let near = |x: f64| R::from_f64(x).unwrap_or_else(R::zero);
    // In fixed point a step per chord that is rounded to zero would stop a run for good.
    let least = if R::IS_FLOATING { R::zero() } else { R::resolution() };
    let (joint_ratio, joint_exponent) =
        next.map_or((0.5, 1), |(next, next_scales)| piece.joint(scales, next, next_scales));
    Piece {
        origin: piece.origin,
        coordinate_exponent: small(scales.coordinate),
        step_exponent: small(scales.step),
        range_exponent: small(scales.range),
        joint_ratio: sixteen_bits(joint_ratio),
        joint_exponent: small(joint_exponent),
        joint: next.map_or(Joint::Smooth, |(next, _)| piece.joint_to(next)),
        step_per_chord: piece.step_per_chord(scales).map(|sigma| near(sigma).max(least)),
    }
}
