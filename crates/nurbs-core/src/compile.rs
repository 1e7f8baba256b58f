//! From a curve to compiled pieces, before real time: cutting, normalising, and proving that everything fits.
//!
//! All of it runs in a high precision `H`; each coefficient is rounded once, into the format.

use alloc::vec::Vec;

use real::{Backend, FormatName, Real};

use crate::bezier::Bezier;
use crate::local_piece::LocalPiece;
use crate::pieces::{Piece, Pieces};
use crate::ranges::{self, Scales, SignalBound, exponent_below, fraction_and_exponent, power_of_two};
use crate::{MAX_DEGREE, NurbsCurve};

/// How finely to cut.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PieceLimits {
    /// Longest piece, in mm. A 32-bit format resolves a step best with 32 to 64 mm.
    pub length_mm: f64,
    /// Longest chord that a period may want, in mm.
    pub step_mm: f64,
}

/// A path cannot be compiled for a format.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub enum CompileError {
    /// The limits are not positive and finite.
    LimitNotPositive {
        /// The limit.
        what: &'static str,
        /// Its value.
        value: f64,
    },
    /// C' vanishes, or all but does, inside or at the end of the piece that begins at `parameter`: no step per chord
    /// exists there.
    Cusp {
        /// Index of the curve in the path.
        curve: usize,
        /// Where the piece begins.
        parameter: f64,
    },
    /// A number of the real-time step does not fit the format.
    DoesNotFit {
        /// The signal, by the name that an audit gives it.
        signal: &'static str,
        /// Its proven bound.
        bound: f64,
        /// Integer bits, the sign included, that it needs.
        integer_bits: u32,
        /// The format.
        format: FormatName,
    },
    /// A coordinate lies beyond the ±2²⁴ mm of a piece's origin.
    OriginOutOfRange {
        /// Index of the curve in the path.
        curve: usize,
    },
}

impl core::fmt::Display for CompileError {
    fn fmt(&self, f: &mut core::fmt::Formatter<'_>) -> core::fmt::Result {
        match self {
            Self::LimitNotPositive { what, value } => {
                write!(f, "{what} must be positive and finite, not {value}")
            }
            Self::Cusp { curve, parameter } => {
                write!(f, "curve {curve} comes to a cusp near u = {parameter}: its derivative vanishes there")
            }
            Self::DoesNotFit { signal, bound, integer_bits, format } => {
                write!(
                    f,
                    "the signal `{signal}` reaches {bound:.4} and needs {integer_bits} integer bits; {format} has fewer"
                )
            }
            Self::OriginOutOfRange { curve } => write!(f, "curve {curve} lies beyond ±2^24 mm"),
        }
    }
}

impl core::error::Error for CompileError {}

/// Compiled pieces with their storage, and what a tool needs to read their results.
#[derive(Clone, Debug)]
pub struct PiecesBuf<R, const D: usize> {
    pieces: Vec<Piece<R, D>>,
    numerators: Vec<[R; D]>,
    weights: Vec<R>,
    degree: usize,
    coordinate_exponent: i32,
    chord_exponent: i32,
    range_exponent: i32,
    places: Vec<Place>,
    bounds: Vec<SignalBound>,
}

/// Where a piece lies on the path it was cut from.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Place {
    /// Index of the curve.
    pub curve: usize,
    /// The parameter at which the piece begins, as a sum of two floats.
    pub begin: (f64, f64),
    /// The parameter at which it ends.
    pub end: (f64, f64),
}

impl<R: Real, const D: usize> PiecesBuf<R, D> {
    /// The table that real time reads.
    #[must_use]
    pub fn as_pieces(&self) -> Pieces<'_, R, D> {
        Pieces {
            pieces: &self.pieces,
            numerators: &self.numerators,
            weights: &self.weights,
            degree: self.degree,
            coordinate_exponent: self.coordinate_exponent,
            chord_exponent: self.chord_exponent,
            range_exponent: self.range_exponent,
        }
    }

    /// Where each piece lies on the path.
    #[must_use]
    pub fn places(&self) -> &[Place] {
        &self.places
    }

    /// The proven bounds, a signal each.
    #[must_use]
    pub fn bounds(&self) -> &[SignalBound] {
        &self.bounds
    }
}

/// Longest chain of halvings of a span.
const MAX_HALVINGS: i32 = 16;

/// Largest ratio of the greatest to the least |C'| on a piece, and of weights: it keeps the solver's unknown within
/// a factor √1.5 of 1, which even two integer bits hold. A smaller ratio means more pieces.
const MAX_RATIO: f64 = 1.5;

/// Largest chord in its own scale. A step of a quarter of the longest then has the resolution that the step per chord,
/// which is about 1, has in any case; more would gain nothing.
const MAX_CHORD_RANGE: f64 = 4.0;

/// |C'| below this part of the piece's mean speed counts as a cusp.
const CUSP_RATIO: f64 = 1e-4;

/// Cuts `curves` into pieces and rounds them to the format `R`; everything before the rounding is computed in `H`.
///
/// # Errors
/// [`CompileError`], naming the curve, or the signal that does not fit.
pub fn compile<H: Backend, R: Backend, const D: usize>(
    curves: &[NurbsCurve<'_, f64, D>],
    limits: &PieceLimits,
) -> Result<PiecesBuf<R, D>, CompileError> {
    for (what, value) in [("the longest piece", limits.length_mm), ("the longest step", limits.step_mm)] {
        if !(value > 0.0 && value.is_finite()) {
            return Err(CompileError::LimitNotPositive { what, value });
        }
    }
    let mut local = Vec::new();
    for (index, curve) in curves.iter().enumerate() {
        cut::<H, D>(index, curve, limits, &mut local)?;
    }
    Table::new(&local, limits).rounded::<R>()
}

/// Cuts one curve, span by span, halving until a piece is short and even enough.
fn cut<H: Backend, const D: usize>(
    index: usize,
    curve: &NurbsCurve<'_, f64, D>,
    limits: &PieceLimits,
    out: &mut Vec<LocalPiece<H, D>>,
) -> Result<(), CompileError> {
    let high = |x: f64| H::from_f64(x).unwrap_or_else(H::zero);
    let knots = curve.knots().as_slice();
    for span in curve.degree()..curve.control_points().len() {
        if knots[span] >= knots[span + 1] {
            continue;
        }
        let mut rest = Vec::from([(high(knots[span]), high(knots[span + 1]), 0)]);
        while let Some((begin, end, halvings)) = rest.pop() {
            let bezier = Bezier::of_span(curve, span, begin, end);
            let even = bezier.is_even_enough(limits.length_mm, MAX_RATIO);
            if !even && halvings < MAX_HALVINGS {
                let middle = begin + (end - begin).half();
                rest.push((middle, end, halvings + 1));
                rest.push((begin, middle, halvings + 1));
                continue;
            }
            let place = Place { curve: index, begin: begin.to_f64_pair(), end: end.to_f64_pair() };
            let piece = LocalPiece::new(&bezier, place, (index, span), halvings)
                .ok_or(CompileError::OriginOutOfRange { curve: index })?;
            if piece.speed.least <= CUSP_RATIO * piece.speed.greatest {
                return Err(CompileError::Cusp { curve: index, parameter: place.begin.0 });
            }
            out.push(piece);
        }
    }
    Ok(())
}

/// The pieces with what is common to all.
struct Table<'a, H, const D: usize> {
    local: &'a [LocalPiece<H, D>],
    step_mm: f64,
    degree: usize,
    rational: bool,
}

impl<'a, H: Backend, const D: usize> Table<'a, H, D> {
    fn new(local: &'a [LocalPiece<H, D>], limits: &PieceLimits) -> Self {
        let degree = local.iter().map(|piece| piece.numerator.len()).max().unwrap_or(1);
        let rational = local.iter().any(|piece| piece.rational);
        Self { local, step_mm: limits.step_mm, degree: degree.min(MAX_DEGREE), rational }
    }

    /// Chooses the scales for `R`, proves the bounds, and rounds.
    fn rounded<R: Backend>(&self) -> Result<PiecesBuf<R, D>, CompileError> {
        // The chords use half of a fixed format's range; a float is content with numbers of order one.
        let fixed = matches!(R::name(), FormatName::Fixed { .. });
        let range = if fixed { R::max_value().to_f64() } else { 2.0 };
        let widest = self.local.iter().map(|p| p.coordinate_bound_mm()).fold(0.0, f64::max);
        let chord_range = (range / 2.0).min(MAX_CHORD_RANGE);
        let chord = exponent_below(chord_range / self.step_mm);
        let scales = Scales {
            coordinate: -exponent_below(range / widest),
            chord,
            range: exponent_below(chord_range),
            steps: self.local.iter().map(|p| p.speed.step_exponent(chord)).collect(),
        };
        let bounds = ranges::signal_bounds(self.local, &scales, self.step_mm);
        if fixed {
            ranges::refuse_what_does_not_fit::<R>(&bounds)?;
        }
        let round = |x: H| R::from_f64_pair(x.to_f64_pair().0, x.to_f64_pair().1).unwrap_or_else(R::zero);
        let mut table = PiecesBuf {
            pieces: Vec::with_capacity(self.local.len()),
            numerators: Vec::with_capacity(self.local.len() * self.degree),
            weights: Vec::new(),
            degree: self.degree,
            coordinate_exponent: scales.coordinate,
            chord_exponent: scales.chord,
            range_exponent: scales.range,
            places: self.local.iter().map(|piece| piece.place).collect(),
            bounds,
        };
        for (index, piece) in self.local.iter().enumerate() {
            for k in 0..self.degree {
                let row = piece.numerator.get(k).copied().unwrap_or([H::zero(); D]);
                table.numerators.push(row.map(|x| round(x.scale(-scales.coordinate))));
            }
            for k in (0..=self.degree).filter(|_| self.rational) {
                table.weights.push(round(piece.weight.get(k).copied().unwrap_or_else(H::zero)));
            }
            table.pieces.push(self.row(index, &scales));
        }
        Ok(table)
    }

    fn row<R: Backend>(&self, index: usize, scales: &Scales) -> Piece<R, D> {
        let piece = &self.local[index];
        let near = |x: f64| R::from_f64(x).unwrap_or_else(R::zero);
        let next = self.local.get(index + 1);
        // Pieces of one span are halves of halves of it: the ratio of their widths is a power of two, exactly.
        let continues = next.is_some_and(|next| next.span == piece.span);
        let (joint_ratio, joint_exponent) = match next {
            Some(next) => {
                let shift = scales.steps[index + 1] - scales.steps[index];
                let ratio = if continues {
                    power_of_two(piece.halvings_fewer_than(next))
                } else {
                    piece.speed.end / next.speed.begin
                };
                fraction_and_exponent(ratio * power_of_two(shift))
            }
            None => (0.5, 1),
        };
        Piece {
            origin: piece.origin,
            step_exponent: scales.steps[index],
            joint_ratio: near(joint_ratio),
            joint_exponent,
            continues,
            step_per_chord: piece.speed.step_per_chord(scales.chord - scales.steps[index]).map(near),
        }
    }
}
