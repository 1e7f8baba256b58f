//! Proven ranges: a bound for every named signal of a real-time step on compiled pieces.
//!
//! What depends on t is a polynomial on [0, 1] and bounded by its Bernstein coefficients; W lies between its least and
//! its greatest one. What the solver tries is clamped to the row's `step_per_chord`, and a chord is no longer than the
//! longest step, so the sums in x are bounded term by term.

use alloc::vec::Vec;

use real::{Backend, Real};

use crate::compile::CompileError;
use crate::local_piece::LocalPiece;

/// The proven bound of a signal of the real-time step.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SignalBound {
    /// The signal, by the name that an audit gives it.
    pub signal: &'static str,
    /// No value of it is larger in magnitude, but for a few units of the format's resolution.
    pub bound: f64,
}

/// The powers of two of a table: of coordinates, of chords, and of each piece's step.
pub(crate) struct Scales {
    pub(crate) coordinate: i32,
    pub(crate) chord: i32,
    pub(crate) range: i32,
    pub(crate) steps: Vec<i32>,
}

/// The bounds over all pieces, a signal each.
#[derive(Default)]
struct Bounds(Vec<SignalBound>);

impl Bounds {
    fn raise(&mut self, signal: &'static str, bound: f64) {
        match self.0.iter_mut().find(|known| known.signal == signal) {
            Some(known) => known.bound = known.bound.max(bound),
            None => self.0.push(SignalBound { signal, bound }),
        }
    }
}

/// The bound of every named signal of a step whose chord is at most `step_mm`.
pub(crate) fn signal_bounds<H: Backend, const D: usize>(
    local: &[LocalPiece<H, D>],
    scales: &Scales,
    step_mm: f64,
) -> Vec<SignalBound> {
    let mut bounds = Bounds::default();
    let longest_chord = step_mm * power_of_two(scales.chord);
    let coordinate = power_of_two(-scales.coordinate);
    bounds.raise("chord_length", longest_chord);
    for (piece, &step) in local.iter().zip(&scales.steps) {
        bounds.raise("shifted_coefficient", piece.largest_shifted_mm() * coordinate);
        bounds.raise("offset", piece.offset_bound_mm() * coordinate);
        if piece.rational {
            bounds.raise("weight", piece.largest_weight());
            bounds.raise("weight_reciprocal", 1.0 / piece.weight_range.0);
        }
        let [_, sigma] = piece.speed.step_per_chord(scales.chord - step);
        let eta = sigma * longest_chord;
        let x = eta * power_of_two(-scales.range);
        bounds.raise("step_per_chord", sigma);
        bounds.raise("step", eta);
        let (mut slope, mut turn, mut weight) = ([0.0; D], [0.0; D], 0.0_f64);
        for (k, (c, w)) in (1..).zip(piece.chord_bounds_mm().iter().zip(piece.weight_bounds())) {
            let unit = power_of_two(scales.chord - scales.range + k * (scales.range - step));
            for d in 0..D {
                bounds.raise("chord_coefficient", c[d] * unit);
                slope[d] += c[d] * unit * x.powi(k - 1);
                turn[d] += f64::from(k - 1) * c[d] * unit * x.powi(k - 1);
            }
            weight += w * power_of_two(k * (scales.range - step)) * x.powi(k);
        }
        let largest = |vector: &[f64; D]| vector.iter().copied().fold(0.0, f64::max);
        bounds.raise("chord_per_step", largest(&slope));
        bounds.raise("chord_direction", sigma * largest(&slope));
        bounds.raise("chord_turn", largest(&turn));
        // f = |…|² - w², one rounding: both terms of it only ever meet in the wide accumulator.
        let (lightest, heaviest) = ((1.0 - weight).max(0.0), 1.0 + weight);
        let longest = (sigma * f64::norm(&slope)).powi(2);
        bounds.raise("chord_residual", (longest - lightest.powi(2)).max(heaviest.powi(2)));
    }
    bounds.0
}

/// The first signal whose bound the format cannot hold.
pub(crate) fn refuse_what_does_not_fit<R: Backend>(bounds: &[SignalBound]) -> Result<(), CompileError> {
    let range = R::max_value().to_f64();
    match bounds.iter().find(|b| b.bound > range || b.bound.is_nan()) {
        None => Ok(()),
        Some(&SignalBound { signal, bound }) => {
            let integer_bits = (exponent_below(bound) + 2).max(1).unsigned_abs();
            Err(CompileError::DoesNotFit { signal, bound, integer_bits, format: R::name() })
        }
    }
}

pub(crate) fn power_of_two(exponent: i32) -> f64 {
    1.0_f64.scale(exponent)
}

/// The largest e with `2^e ≤ x`, for positive x.
pub(crate) fn exponent_below(x: f64) -> i32 {
    let biased = (x.to_bits() >> 52) & 0x7ff;
    i32::try_from(biased).unwrap_or(0) - 1023
}

/// `x = fraction · 2^exponent` with the fraction in [½, 1); a ratio that is no number counts as 1.
pub(crate) fn fraction_and_exponent(x: f64) -> (f64, i32) {
    if !(x > 0.0 && x.is_finite()) {
        return (0.5, 1);
    }
    let exponent = exponent_below(x) + 1;
    (x.scale(-exponent), exponent)
}
