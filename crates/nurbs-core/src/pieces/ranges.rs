//! Proven ranges: a bound for every named signal of a real-time step on compiled pieces.
//!
//! A signal that depends on t is a polynomial on [0, 1], and its Bernstein coefficients bound it; W lies between its
//! least and its greatest one. The solver clamps its trials to the row's `step_per_chord`, and a chord is no longer
//! than the longest step, so the sums in x are bounded term by term. Every other number of a step is one of these
//! signals, or a difference of two of them that is no larger.

use alloc::vec::Vec;

use real::{Backend, Real};

use crate::CompileError;
use crate::pieces::local_piece::LocalPiece;
use crate::pieces::scales::{Scales, exponent_below, power_of_two};

/// The proven bound of a signal of the real-time step.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SignalBound {
    /// The signal, by the name that an audit gives it.
    pub signal: &'static str,
    /// In fixed point no value of the signal exceeds this in magnitude by more than a few units of the resolution. In a
    /// float a trial that the solver rejects may exceed it; a float has the range for that.
    pub bound: f64,
}

/// The bounds over all pieces, one for each signal.
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

/// The bound of every named signal of a step whose chord is at most `step_mm`, where numbers are rounded to
/// multiples of `resolution`, and at most `greatest`.
pub(crate) fn signal_bounds<H: Backend, const D: usize>(
    local: &[(&LocalPiece<H, D>, Scales)],
    rational: bool,
    step_mm: f64,
    (resolution, greatest): (f64, f64),
) -> Vec<SignalBound> {
    let mut bounds = Bounds::default();
    bounds.raise("parameter", 1.0);
    for (piece, scales) in local {
        // The p rounded sweeps of the shift add up to 2^p units; the few roundings elsewhere add as much again.
        let rounding = resolution * power_of_two(i32::try_from(piece.numerator.len()).unwrap_or(0) + 1);
        let coordinate = power_of_two(-scales.coordinate);
        let shifted = piece.extents.shifted_mm * coordinate + rounding;
        bounds.raise("coefficient", shifted);
        bounds.raise("shifted_coefficient", shifted);
        bounds.raise("offset", piece.extents.offset_mm * coordinate + rounding);
        if rational {
            // Weights are shifted as coordinates are, in units of their own.
            let weight = piece.extents.weight + rounding;
            bounds.raise("shifted_coefficient", weight);
            bounds.raise("weight", weight);
            bounds
                .raise("weight_reciprocal", 1.0 / (piece.weight_range.0 - rounding).max(rounding) + rounding);
        }
        raise_chord_bounds(&mut bounds, piece, scales, rational, step_mm, (rounding, greatest));
    }
    for pair in local.windows(2) {
        let [(piece, scales), (next, next_scales)] = pair else { continue };
        let [_, sigma] = next.step_per_chord(next_scales);
        let (_, exponent) = piece.joint(scales, next, next_scales);
        // The greatest step per chord is compared in the smaller scale, and rounded there.
        bounds.raise("joint_step_per_chord", sigma + resolution * power_of_two(exponent.max(0)));
    }
    bounds.0
}

/// The signals of one chord on one piece.
fn raise_chord_bounds<H: Backend, const D: usize>(
    bounds: &mut Bounds,
    piece: &LocalPiece<H, D>,
    scales: &Scales,
    rational: bool,
    step_mm: f64,
    (rounding, greatest): (f64, f64),
) {
    let longest_chord = step_mm * power_of_two(scales.chord);
    let [least, sigma] = piece.step_per_chord(scales);
    let eta = sigma * longest_chord;
    let x = scales.greatest_variable();
    bounds.raise("chord_length", longest_chord);
    bounds.raise("step_per_chord", sigma);
    bounds.raise("step_per_chord_fall", 3.0 * (sigma - least));
    bounds.raise("step", eta);
    bounds.raise("chord_variable", x);

    // Horner's scheme for q and x q', and for (W - 1)/x and its derivative: every partial sum counts.
    let (mut chord, mut turn, mut weight, mut weight_turn) = (0.0_f64, 0.0, 0.0, 0.0);
    let (chords, weights) = (&piece.extents.chords_mm, &piece.extents.weights);
    let mut power = i32::try_from(chords.len()).unwrap_or(0) * (scales.range - scales.step);
    for (c, w) in chords.iter().zip(weights).rev() {
        let to_chord_units = power_of_two(scales.chord - scales.range + power);
        let gain = power_of_two((scales.coordinate + scales.chord - scales.range + power).max(0));
        let c = c * to_chord_units + rounding * gain;
        bounds.raise("chord_coefficient", c);
        (turn, chord) = (turn * x + chord, chord * x + c);
        bounds.raise("chord_per_step", chord);
        bounds.raise("chord_turn", turn);
        if rational {
            bounds.raise("weight_coefficient", *w + rounding);
            let w = w * power_of_two(power) + rounding;
            (weight_turn, weight) = (weight_turn * x + weight, weight * x + w);
            bounds.raise("chord_weight", weight.max(weight_turn).max(w));
        }
        power -= scales.range - scales.step; // h^k = x^k 2^(k (r - s))
    }
    let (lightest, heaviest) = ((1.0 - weight * x).max(0.0), 1.0 + weight * x);
    let slope = weight + weight_turn * x;
    turn *= x;
    if rational {
        bounds.raise("chord_weight", heaviest.max(slope));
    }
    let direction = sigma * chord;
    bounds.raise("chord_turn", turn.max(sigma * turn));
    bounds.raise("chord_direction", direction);
    // f = |…|² - w², rounded once: the two squares meet only in the wide accumulator. So do the terms of g.
    let residual = direction * direction - lightest * lightest;
    bounds.raise("chord_residual", residual.max(heaviest * heaviest));
    let growth = direction * sigma * turn + heaviest * slope * x;
    bounds.raise("chord_growth", growth + (heaviest * heaviest - 1.0).max(1.0 - lightest * lightest));
    // Over a joint, W is divided out. The step begins at t = 0 and stays on the piece, on which W lies between its least and greatest
    // Bernstein weight. A trial τ may be 1½ σ, but the step over the whole length is not: with l = 1 - |b|, the whole chord e is at
    // most 1 - l + the shorter one of l a and σ q, which is greatest at l = ⅔, and so is the sum of its product with a and that of b.
    // The product of b and a is not counted below 0.
    let lightest = piece.weight_range.0 / piece.weight_range.1;
    let across = chord / lightest;
    let pull = (turn + across * slope * x) / lightest;
    let trial = (1.5 * sigma).min(greatest);
    let (along, half) = (sigma * across, 0.5 * trial * across); // σ q and ½a
    let whole = 0.5 * (along + 1.0 / 3.0).max(1.0);
    bounds.raise("joint_step_per_chord", trial);
    bounds.raise("joint_pull", across.max(pull).max(0.5 * trial * pull));
    bounds.raise("joint_direction", whole.max(half));
    bounds.raise("joint_residual", half.max(half * (0.5 * along + 1.0 / 3.0)).max(0.5 + 0.5 * half));
    let turn = if rational { 0.5 * Real::sqrt(D as f64) } else { 0.5 * trial * pull }; // its coordinates are cut where W is not 1
    let lengthening = (0.5 * along * half).max(0.5 * half + 0.25); // ¼ (l |a|² - l)
    bounds.raise("joint_growth", lengthening.max(whole * turn + 0.5 * lengthening));
    // A chord across the whole piece in its units, and over the length of the chord that it is a part of.
    let longest = eta.min(power_of_two(scales.step));
    bounds.raise("chord_travelled", chord * longest.max(sigma));
    bounds.raise("joint_travelled", 1.0 + 2.0 * rounding); // no more is ever added up
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
