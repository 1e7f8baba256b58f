//! One row of the table of compiled pieces.

use real::Real;

/// The unit of origins is 2^this mm. 2⁻³⁹ mm is 1.8e-12 mm, far below the resolution of a drive. With 64 bits it has a
/// range of ±2²⁴ mm, which is 16 km.
pub const ORIGIN_EXPONENT: i32 = -39;

/// How the path goes on at the end of a piece.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Joint {
    /// The next piece is a further part of the same polynomial: a step passes the joint as if it were not there.
    Continues,
    /// Another polynomial follows in the same direction, or none: a step over the joint is one straight chord.
    Smooth,
    /// The tangent breaks ([`tangent_breaks`](crate::tangent_breaks)): the part of a step that is left at the corner
    /// goes on behind it, as a chord of its own.
    Breaks,
}

/// One row of the table: 32 bytes in a 32-bit format in the plane, 48 in a 64-bit one in space.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Piece<R, const D: usize> {
    /// O in units of 2^[`ORIGIN_EXPONENT`] mm: the local offset is added to it.
    pub origin: [i64; D],
    /// e: this piece's coefficients are in units of 2^e mm, so that a short piece has as many significant bits as a
    /// long one. A float has the same bits in any unit: its tables have e = -λ and s = r = 0, so that nothing is
    /// scaled. A step relies on this.
    pub coordinate_exponent: i8,
    /// s: the solver's step is `η = h·2^s`, which is about as long as the chord in its own scale. At most 60 in
    /// magnitude.
    pub step_exponent: i8,
    /// r: the polynomials take `x = η·2^-r`, which is of order one, so that the roundings of their coefficients are not
    /// magnified. Chords and steps reach up to 2^r, to use the format's integer bits. On a piece shorter than that, x =
    /// 1 is the whole piece.
    pub range_exponent: i8,
    /// |C'| at the end of this piece over |C'| at the start of the next, in the solver's scales: it converts a step per
    /// chord on this piece to one on the next. A fraction from ½ to 1 in units of 2⁻¹⁶, times `2^joint_exponent`. The
    /// search for a chord only starts with it. Where the next piece continues this one, the fraction is exactly ½.
    pub joint_ratio: u16,
    /// Power of two that belongs to `joint_ratio`.
    pub joint_exponent: i8,
    /// How the path goes on at the piece's end.
    pub joint: Joint,
    /// Least and greatest step per chord, in the solver's scale. A trial is clamped to them, and the proof of the
    /// ranges rests on them.
    pub step_per_chord: [R; 2],
}

impl<R: Real, const D: usize> Piece<R, D> {
    /// 2^s, the step over the whole piece; the format's greatest number where 2^s does not fit, because no step comes
    /// near it in that case.
    #[inline]
    #[must_use]
    pub fn whole(&self) -> R {
        if R::IS_FLOATING { R::one() } else { R::power_of_two(self.step_exponent.into()) }
    }

    /// [`joint_ratio`](Self::joint_ratio) as a number, below 1.
    #[inline]
    #[must_use]
    pub fn ratio_at_joint(&self) -> R {
        R::fraction(u64::from(self.joint_ratio) << 48)
    }

    /// r - s: by how much the exponent of each power of h exceeds that of the power before.
    #[inline]
    pub(crate) fn per_power(&self) -> i32 {
        i32::from(self.range_exponent) - i32::from(self.step_exponent)
    }

    /// A step as a fraction of the piece, in units of 2⁻⁶⁴; saturates.
    #[inline]
    #[must_use]
    pub fn part(&self, step: R) -> u64 {
        step.to_phase(if R::IS_FLOATING { 0 } else { -i32::from(self.step_exponent) })
    }
}
