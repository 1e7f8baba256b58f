//! The powers of two by which the numbers of a piece are scaled to order one.

use real::Real;

/// The powers of two of one piece.
#[derive(Clone, Copy)]
pub(crate) struct Scales {
    /// Coordinates are in units of 2^coordinate mm.
    pub(crate) coordinate: i32,
    /// Chords are in units of 2^-chord mm; the same for all pieces.
    pub(crate) chord: i32,
    /// 2^step is the step over the whole piece.
    pub(crate) step: i32,
    /// The polynomials take x, the step over 2^range. `range` is at most `step`.
    pub(crate) range: i32,
}

impl Scales {
    /// The x that no chord exceeds: ½ as the range is chosen, or the whole piece if that is not so long.
    pub(crate) fn greatest_variable(&self) -> f64 {
        if self.range == self.step { 1.0 } else { 0.5 }
    }
}

pub(crate) fn power_of_two(exponent: i32) -> f64 {
    1.0_f64.ldexp(exponent)
}

/// The largest e with `2^e ≤ x`, for positive x.
pub(crate) fn exponent_below(x: f64) -> i32 {
    let biased = (x.to_bits() >> 52) & 0x7ff;
    i32::try_from(biased).unwrap_or(0) - 1023
}

/// `x = fraction · 2^exponent` with the fraction in [½, 1). An x that is NaN, infinite or not above 0 counts as 1.
pub(crate) fn fraction_and_exponent(x: f64) -> (f64, i32) {
    if !(x > 0.0 && x.is_finite()) {
        return (0.5, 1);
    }
    let exponent = exponent_below(x) + 1;
    (x.ldexp(-exponent), exponent)
}
