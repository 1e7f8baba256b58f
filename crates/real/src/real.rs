//! The trait that every kernel is written against.

use core::fmt::Debug;
use core::ops::{Div, Neg, Sub};

use num_traits::{Bounded, One, Zero};

use crate::FormatName;

/// A number that a kernel can compute with: a float, a fixed-point number, or a wrapper around either.
///
/// Addition, multiplication, the least and the greatest value come from num-traits (`Zero`, `One`,
/// `Bounded`), so those words mean here what they mean there. Every operation is total: it returns a value
/// for all operands, in every build, and never panics.
///
/// | operation | float | fixed point |
/// |---|---|---|
/// | `+` `-` negation | IEEE 754 | exact, then wrap |
/// | `*`, [`mul_add`](Real::mul_add), [`sum_of_products`](Real::sum_of_products), [`ldexp`](Real::ldexp) | IEEE 754, each step rounded | to nearest, ties up (toward +∞), once; then wrap |
/// | `/` | IEEE 754 | to nearest, ties away from zero; then saturate |
/// | [`sqrt`](Real::sqrt) | IEEE 754 | to nearest (a tie cannot be) |
/// | [`norm`](Real::norm) | each step rounded | to nearest (a tie cannot be), once; then saturate |
/// | [`from_ratio`](Real::from_ratio) | to nearest, ties to even | to nearest, ties away from zero; then saturate |
/// | [`from_f64`](Backend::from_f64), [`from_f64_pair`](Backend::from_f64_pair) | to nearest, ties to even | to nearest, ties to even; `None` out of range |
/// | [`from_phase`](Real::from_phase), [`to_phase`](Real::to_phase) | cut toward 0, saturate | cut toward 0, saturate |
/// | [`fraction`](Real::fraction) | the leading bits, to nearest, ties to even | cut toward 0, saturate |
/// | [`place_to_phase`](Real::place_to_phase) | to nearest, ties to even; `None` out of range | cut toward 0; `None` out of range |
/// | division by zero, also in `from_ratio` | infinity or NaN | the extreme with the sign of the numerator; `0/0` is 0 |
/// | root of a negative number | 0 | 0 |
///
/// Wrapping is what a controller's adder does. That no value ever needs to wrap is shown beforehand, by a
/// proven range or by an audited run (`Audited`); saturating each operation would cost several times
/// more and hide the fault.
pub trait Real:
    Copy
    + Debug
    + Default
    + PartialOrd
    + Zero
    + One
    + Bounded
    + Neg<Output = Self>
    + Sub<Output = Self>
    + Div<Output = Self>
{
    /// Whether kernels are also compiled in variants for common cases, beside the form that serves all cases. Wrappers,
    /// and numbers that imitate other formats, are not run for speed: variants would only cost them compile time.
    const IS_FOR_SPEED: bool = false;

    /// Whether a number carries its own exponent, so that no unit suits it better than another.
    const IS_FLOATING: bool = false;

    /// How an interpolator adds up its place on a piece, a number in [0, 1). If true, it adds numbers and derives the
    /// phase from the sum, whose last digit is far below any that a setpoint shows. If false, it adds phases.
    const ADDS_PLACES: bool = false;

    /// The most places of [`lowered`](Real::lowered) in fixed point; 0 where nothing is gained by it.
    const MOST_LOWERED: u32 = 0;

    /// The step between 1 and the next larger number: 2⁻²³ in `f32`, 2⁻ᶠ with f fraction bits.
    fn resolution() -> Self;

    /// The number nearest to `numerator / denominator`: how kernels write their constants.
    ///
    /// Domain: `denominator ≠ 0`, and the quotient fits the format. A quotient that does not fit saturates.
    fn from_ratio(numerator: i32, denominator: i32) -> Self;

    /// `self · factor + addend`.
    ///
    /// Fixed point rounds once. Floats round twice, as a controller without a fused instruction does: the
    /// result is then the same on every machine.
    fn mul_add(self, factor: Self, addend: Self) -> Self;

    /// `Σ aᵢ·bᵢ` over the pairs; 0 for none. Fixed point forms the sum in an accumulator of twice the width, which
    /// wraps, and rounds it once: the result is the exact sum, rounded and wrapped. Floats add the products in order.
    fn sum_of_products(pairs: impl IntoIterator<Item = (Self, Self)>) -> Self;

    /// Euclidean length `√(Σ vᵢ²)`; 0 for no components. No intermediate overflows: only a result too large for the
    /// format does, and it saturates (to infinity in a float). Fixed point rounds once.
    fn norm<const N: usize>(vector: &[Self; N]) -> Self;

    /// Square root, rounded to nearest; 0 for a negative argument.
    fn sqrt(self) -> Self;

    /// `self · 2^exponent`: a shift in fixed point, an exponent change in a float. Shifting right rounds to
    /// nearest, ties up; shifting left wraps. Domain: `|exponent| ≤ 126`.
    fn ldexp(self, exponent: i32) -> Self;

    /// The number `phase · 2^(exponent - 64)`, rounded toward 0; saturates. A phase is a fraction in [0, 1) held as a
    /// 64-bit integer. Its steps are equal, and so fine that sums of small increments lose nothing in any format.
    /// Domain: `|exponent| ≤ 64`.
    fn from_phase(phase: u64, exponent: i32) -> Self;

    /// The number `phase · 2⁻⁶⁴`, from 0 to 1, as a place on [0, 1]. It is off by up to half of its last digit and by
    /// 2⁻⁶⁴ in `f64`, 2⁻³² in `f32`: a float near 0 could be more precise. Machines convert integers in this way, so
    /// that it takes a third of the instructions of [`from_phase`](Real::from_phase). In fixed point it is the same as
    /// `from_phase`.
    #[inline]
    #[must_use]
    fn fraction(phase: u64) -> Self {
        Self::from_phase(phase, 0)
    }

    /// `fraction(product / 2^shift)`, for a quotient below 2⁶⁴ and a shift below 64: a format of few digits does not need all of the
    /// quotient.
    #[inline]
    #[must_use]
    fn fraction_of(product: u128, shift: u32) -> Self {
        Self::fraction(phase_of(product, shift))
    }

    /// The fraction `self · 2^exponent` as an integer: `⌊self · 2^(64 + exponent)⌋`, 0 for a negative number and
    /// 2⁶⁴ - 1 from 1 on. Domain: `|exponent| ≤ 64`.
    fn to_phase(self, exponent: i32) -> u64;

    /// The place `self` on [0, 1) as a phase, off by up to half the resolution; `None` if the rounded place is 1 or
    /// more. It is the inverse of [`fraction`](Real::fraction). In floats it takes a third of the instructions of
    /// [`to_phase`](Real::to_phase); in fixed point it is the same as `to_phase`. Domain: `self ≥ 0`.
    #[inline]
    #[must_use]
    fn place_to_phase(self) -> Option<u64> {
        Some(self.to_phase(0)).filter(|phase| *phase < u64::MAX)
    }

    /// Whether this is from 0 to 1, both included. In `f64` and `f32` it is one comparison, which -0 fails.
    #[inline]
    #[must_use]
    fn is_part(self) -> bool {
        Self::zero() <= self && self <= Self::one()
    }

    /// Whether this is a number: false only for the infinities and NaN of floats.
    fn is_finite(self) -> bool;

    /// `2^exponent`, or the greatest number if that is less. The result is meant as a bound that no value reaches, so
    /// that no audit counts an overflow here. Domain: `-64 ≤ exponent ≤ 63`.
    #[inline]
    #[must_use]
    fn power_of_two(exponent: i32) -> Self {
        Self::from_phase(1 << 63, exponent.saturating_add(1))
    }

    /// `self · 2^exponent`: converts from a compiled table's unit of coordinates to its unit of chords. A float's table
    /// has one unit for both, so a float returns itself.
    #[inline]
    #[must_use]
    fn rescaled(self, exponent: i32) -> Self {
        if Self::IS_FLOATING { self } else { self.ldexp(exponent) }
    }

    /// `rescaled(-places)`, to the right by a number of places that is known to be in range. Domain: from 1 to
    /// [`MOST_LOWERED`](Real::MOST_LOWERED) places in fixed point.
    #[inline]
    #[must_use]
    fn lowered(self, places: u8) -> Self {
        self.rescaled(-i32::from(places))
    }

    /// Names this value for a wrapper that observes it. Every other backend returns it unchanged, at no cost.
    #[inline]
    #[must_use]
    fn signal(self, _name: &'static str) -> Self {
        self
    }

    /// The larger of two numbers.
    #[inline]
    #[must_use]
    fn max(self, other: Self) -> Self {
        if other > self { other } else { self }
    }

    /// The smaller of two numbers.
    #[inline]
    #[must_use]
    fn min(self, other: Self) -> Self {
        if other < self { other } else { self }
    }

    /// `|self|`. In fixed point the least number has no opposite and stays as it is.
    #[inline]
    #[must_use]
    fn abs(self) -> Self {
        if self < Self::zero() { -self } else { self }
    }

    /// `self / 2`.
    #[inline]
    #[must_use]
    fn half(self) -> Self {
        self.ldexp(-1)
    }
}

/// `product / 2^shift`, for a quotient below 2⁶⁴ and a shift below 64: the compiler knows that it is, which saves half of the work.
#[inline]
#[allow(clippy::cast_possible_truncation, reason = "the quotient is below 2⁶⁴")]
pub(crate) fn phase_of(product: u128, shift: u32) -> u64 {
    (product >> (shift & 63)) as u64
}

/// `product / 2^(64 + shift)`, for a quotient below 2⁶⁴ and a shift below 64: its second half says nothing about it.
#[inline]
#[allow(clippy::cast_possible_truncation, reason = "the first half")]
pub(crate) fn leading_bits(product: u128, shift: u32) -> u64 {
    ((product >> 64) as u64) >> (shift & 63)
}

/// A [`Real`] with a name and with conversions from and to the floats that files hold. Tools need them; kernels do not.
pub trait Backend: Real + Send + Sync {
    /// The format's name, as in `f32` or `I16F16`.
    fn name() -> FormatName;

    /// The number nearest to `high + low`, ties to even; `None` when it is out of range or not a number.
    /// Two floats carry the 64 bits of the widest formats; `low` is at most half a unit of `high`'s last place.
    fn from_f64_pair(high: f64, low: f64) -> Option<Self>;

    /// The number nearest to `value`, ties to even; `None` when it is out of range or not a number.
    #[inline]
    fn from_f64(value: f64) -> Option<Self> {
        Self::from_f64_pair(value, 0.0)
    }

    /// The exact value, as a sum of two floats.
    fn to_f64_pair(self) -> (f64, f64);

    /// The float nearest to this number.
    #[inline]
    fn to_f64(self) -> f64 {
        self.to_f64_pair().0
    }

    /// The bits after the point, in fixed point; `None` for a float.
    #[inline]
    fn fraction_bits() -> Option<u32> {
        match Self::name() {
            FormatName::Fixed { fraction_bits, .. } | FormatName::Fraction { fraction_bits, .. } => {
                Some(fraction_bits)
            }
            FormatName::Float { .. } | FormatName::DoubleDouble => None,
        }
    }

    /// In fixed point the integer that stands for this number, which is `word · 2^-fraction_bits`; `None` for a float.
    #[inline]
    fn word(self) -> Option<i64> {
        None
    }
}
