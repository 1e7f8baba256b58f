//! A path cut into pieces in high precision, which all formats have in common, and its rounding to one of them: the scales, the proof
//! that everything fits, and the rows.

use alloc::vec::Vec;
use core::ops::Range;

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

/// A path cut into pieces in a high precision `H`, to be rounded to one format after another: cutting takes most of the time of
/// [`compile_with_stops`](crate::compile_with_stops), and does not depend on the format.
///
/// ```
/// use nurbs_core::{CutPath, NurbsCurve, PieceLimits, compile};
/// use real::{DoubleDouble, I4F28};
///
/// let curves = [NurbsCurve::try_new_nonrational(1, &[[0.0], [200.0]], &[0.0, 0.0, 1.0, 1.0])?];
/// let limits = PieceLimits { length_mm: 32.0, step_mm: 0.2 };
/// let cut = CutPath::<DoubleDouble, 1>::new(&curves, &limits, &[])?;
/// let (narrow, wide) = (cut.rounded::<I4F28>()?, cut.rounded::<f64>()?);
/// assert_eq!(narrow.places(), wide.places());
/// assert_eq!(narrow.as_pieces().pieces, compile::<DoubleDouble, I4F28, 1>(&curves, &limits)?.as_pieces().pieces);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub struct CutPath<H, const D: usize> {
    cut: Cut<H, D>,
    degree: usize,
    rational: bool,
    /// The largest number in coordinate units over all pieces, in mm.
    coordinate_mm: f64,
    step_mm: f64,
}

impl<H: Backend, const D: usize> CutPath<H, D> {
    /// Cuts `curves` into pieces, with a joint at each of `stops`, as [`compile_with_stops`](crate::compile_with_stops) says.
    ///
    /// # Errors
    /// As there, but for what a format cannot hold.
    pub fn new(
        curves: &[NurbsCurve<'_, f64, D>],
        limits: &PieceLimits,
        stops: &[(usize, f64)],
    ) -> Result<Self, CompileError> {
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
        if let Some(place) = local.still.first().filter(|_| local.pieces.is_empty()) {
            return Err(CompileError::Cusp { curve: place.curve, parameter: place.begin.0 });
        }
        let pieces = || local.pieces.iter();
        Ok(Self {
            degree: pieces().map(|piece| piece.numerator.len()).max().unwrap_or(1).min(MAX_DEGREE),
            rational: pieces().any(|piece| piece.rational),
            coordinate_mm: pieces().map(|piece| piece.extents.coordinate_mm()).fold(0.0, f64::max),
            step_mm: limits.step_mm,
            cut: local,
        })
    }

    /// The exponent of the unit in which the format `R` gives all positions, in mm: [`Pieces::coordinate_exponent`](crate::Pieces).
    #[must_use]
    pub fn coordinate_exponent<R: Backend>(&self) -> i32 {
        Scaling::of::<R>(self.step_mm).coordinate_exponent(self.coordinate_mm)
    }

    /// The pieces in the format `R`: chooses the scales, proves the bounds, and rounds.
    ///
    /// # Errors
    /// [`CompileError`], naming the signal that does not fit `R`, or the curve whose speed does not.
    pub fn rounded<R: Backend>(&self) -> Result<PiecesBuf<R, D>, CompileError> {
        self.rounded_part(0..self.cut.pieces.len())
    }

    /// The pieces of this range alone, with the numbers that they have in the table of all: to try a format on a part of the path. Nothing
    /// is proven of the other pieces, and a format that refuses the part refuses the path.
    ///
    /// # Errors
    /// As [`rounded`](Self::rounded).
    pub fn rounded_part<R: Backend>(&self, pieces: Range<usize>) -> Result<PiecesBuf<R, D>, CompileError> {
        let scaling = Scaling::of::<R>(self.step_mm);
        let with_scales = |piece| (piece, scaling.of_piece(piece));
        let behind = self.cut.pieces.get(pieces.end).map(with_scales);
        let local: Vec<_> = self.cut.pieces.get(pieces).unwrap_or_default().iter().map(with_scales).collect();
        let Self { degree, rational, step_mm, .. } = *self;
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
            coordinate_exponent: scaling.coordinate_exponent(self.coordinate_mm),
            chord_exponent: scaling.chord,
            places: local.iter().map(|(piece, _)| piece.place).collect(),
            still: self.cut.still.clone(),
            bounds,
            step_mm,
        };
        for (index, (piece, scales)) in local.iter().enumerate() {
            let Place { curve, begin, .. } = piece.place;
            let out_of_range = CompileError::SpeedOutOfRange { curve, parameter: begin.0 };
            add_coefficients(&mut table, piece, scales, rational).ok_or(out_of_range)?;
            let row = row(piece, scales, local.get(index + 1).or(behind.as_ref()));
            // A step per chord that a float rounds to zero, or cannot hold, would stop a run for good.
            if !row.step_per_chord.iter().all(|sigma: &R| *sigma > R::zero() && sigma.is_finite()) {
                return Err(out_of_range);
            }
            table.pieces.push(row);
        }
        Ok(table)
    }
}

/// Rounds the coefficients of a piece; `None` where one is beyond the range of `R`.
fn add_coefficients<H: Backend, R: Backend, const D: usize>(
    table: &mut PiecesBuf<R, D>,
    piece: &LocalPiece<H, D>,
    scales: &Scales,
    rational: bool,
) -> Option<()> {
    let round = |x: H| R::from_f64_pair(x.to_f64_pair().0, x.to_f64_pair().1);
    for k in 0..table.degree {
        let power = piece.numerator.get(k).copied().unwrap_or([H::zero(); D]);
        let mut rounded = [R::zero(); D];
        for (to, x) in rounded.iter_mut().zip(power) {
            *to = round(x.ldexp(-scales.coordinate))?;
        }
        table.numerators.push(rounded);
    }
    for k in (0..=table.degree).filter(|_| rational) {
        let weight = piece.weight.get(k).copied().unwrap_or_else(H::zero);
        table.weights.push(round(weight)?);
    }
    Some(())
}

/// How a format scales the pieces of a path.
struct Scaling {
    is_floating: bool,
    /// The greatest number of a fixed-point format; in a float, numbers of order one do as well as any.
    range: f64,
    /// Chords are in units of 2^-chord mm.
    chord: i32,
    step_mm: f64,
}

impl Scaling {
    fn of<R: Backend>(step_mm: f64) -> Self {
        // The chords use half of a fixed format's range.
        let fixed = matches!(R::name(), FormatName::Fixed { .. });
        let range = if fixed { R::max_value().to_f64() } else { 2.0 };
        let chord_range = (range / 2.0).min(MAX_CHORD_RANGE);
        let mut chord = exponent_below(chord_range / step_mm);
        if R::IS_FLOATING {
            chord = chord.clamp(-MAX_STEP_EXPONENT, MAX_STEP_EXPONENT); // -λ then has a place in a row.
        }
        Self { is_floating: R::IS_FLOATING, range, chord, step_mm }
    }

    /// The exponent of the unit of coordinates of which none is above `largest_mm`.
    fn coordinate_exponent(&self, largest_mm: f64) -> i32 {
        if self.is_floating {
            return -self.chord;
        }
        (-exponent_below(self.range / largest_mm)).clamp(-120, 120)
    }

    fn of_piece<H: Backend, const D: usize>(&self, piece: &LocalPiece<H, D>) -> Scales {
        let (chord, coordinate) = (self.chord, self.coordinate_exponent(piece.extents.coordinate_mm()));
        if self.is_floating {
            return Scales { coordinate, chord, step: 0, range: 0 };
        }
        let step = piece.speed.step_exponent(chord);
        let scales = Scales { coordinate, chord, step, range: step };
        let longest = piece.step_per_chord(&scales)[1] * self.step_mm * power_of_two(chord);
        // The roundings of the higher coefficients reach the chord times x and x²: at most a half and a quarter of a unit.
        let range = exponent_below(longest) + 2;
        Scales { range: range.min(step), ..scales }
    }
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
    next: Option<&(&LocalPiece<H, D>, Scales)>,
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
