//! Fixed point of any width up to 64 bits, chosen at run time: what a search for the narrowest format runs in.
//!
//! The format is not in the value but in thread-local storage, one slot a type parameter, so that a value is as small
//! as an `i64` and a kernel needs no further argument. With [`Rounding::Nearest`] and [`Overflow::Wrap`] every
//! operation gives the same bits as [`FixedPoint`](crate::FixedPoint) in the formats that both have.

use std::cell::Cell;
use std::ops::{Add, Div, Mul, Neg, Sub};

use num_traits::{Bounded, One, Zero};

use crate::word::Word;
use crate::{Backend, FormatName, Real};

/// What happens to the bits that a result has too many of.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Rounding {
    /// To the nearest number; ties up in products and shifts, away from zero in quotients, as `FixedPoint` does.
    Nearest,
    /// To the nearest number, ties to even.
    NearestEven,
    /// Toward -∞: dropping the bits.
    Floor,
    /// Toward zero.
    TowardZero,
}

/// What happens to a sum or product that does not fit. Quotients, roots and norms saturate in any case.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Overflow {
    /// The high bits are lost.
    Wrap,
    /// The nearest extreme is taken.
    Saturate,
}

/// A fixed-point format.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct RuntimeFormat {
    width: u32,
    fraction_bits: u32,
    rounding: Rounding,
    overflow: Overflow,
}

impl RuntimeFormat {
    /// The format with `width` bits in all, the sign included, of which `fraction_bits` follow the point.
    ///
    /// `None` unless `3 ≤ width ≤ 64` and at least two bits are left of the point, so that 1 can be held.
    #[must_use]
    pub const fn new(width: u32, fraction_bits: u32, rounding: Rounding, overflow: Overflow) -> Option<Self> {
        if width < 3 || width > 64 || fraction_bits + 2 > width {
            return None;
        }
        Some(Self { width, fraction_bits, rounding, overflow })
    }

    /// The format of this name, as in `I5F13`, with the rounding and wrapping of `FixedPoint`.
    #[must_use]
    pub fn named(name: &str) -> Option<Self> {
        let (integer_bits, fraction_bits) = name.strip_prefix('I')?.split_once('F')?;
        let fraction_bits = fraction_bits.parse().ok()?;
        let width = integer_bits.parse::<u32>().ok()?.checked_add(fraction_bits)?;
        Self::new(width, fraction_bits, Rounding::Nearest, Overflow::Wrap)
    }

    /// The format's name.
    #[must_use]
    pub const fn name(&self) -> FormatName {
        FormatName::Fixed { integer_bits: self.width - self.fraction_bits, fraction_bits: self.fraction_bits }
    }

    /// Runs `work`, in which [`RuntimeFixed<SLOT>`] on this thread has this format.
    pub fn run<const SLOT: usize, T>(self, work: impl FnOnce() -> T) -> T {
        let outer = FORMATS.with(|formats| formats[SLOT % SLOTS].replace(self));
        let result = work();
        FORMATS.with(|formats| formats[SLOT % SLOTS].set(outer));
        result
    }

    fn least(&self) -> i128 {
        -(1 << (self.width - 1))
    }

    fn greatest(&self) -> i128 {
        (1 << (self.width - 1)) - 1
    }

    fn fit(&self, wide: i128) -> i64 {
        match self.overflow {
            Overflow::Saturate => self.saturate(wide),
            Overflow::Wrap => {
                let unused = 128 - self.width;
                narrow(wide << unused >> unused)
            }
        }
    }

    fn saturate(&self, wide: i128) -> i64 {
        narrow(wide.clamp(self.least(), self.greatest()))
    }

    /// Drops `shift` bits, `shift ≤ 126`.
    fn shift_right(&self, wide: i128, shift: u32) -> i128 {
        if shift == 0 {
            return wide;
        }
        let floor = wide >> shift;
        let dropped = wide - (floor << shift);
        let half = 1_i128 << (shift - 1);
        let up = match self.rounding {
            Rounding::Nearest => dropped >= half,
            Rounding::NearestEven => dropped > half || (dropped == half && floor & 1 == 1),
            Rounding::Floor => false,
            Rounding::TowardZero => floor < 0 && dropped != 0,
        };
        floor + i128::from(up)
    }

    fn quotient(&self, numerator: i128, denominator: i128) -> i128 {
        let (quotient, remainder) = (numerator / denominator, numerator % denominator);
        let sign = if (numerator < 0) == (denominator < 0) { 1 } else { -1 };
        let twice = remainder.unsigned_abs().saturating_mul(2);
        let away = match self.rounding {
            Rounding::Nearest => twice >= denominator.unsigned_abs(),
            Rounding::NearestEven => {
                twice > denominator.unsigned_abs()
                    || (twice == denominator.unsigned_abs() && quotient & 1 != 0)
            }
            Rounding::Floor => sign < 0 && remainder != 0,
            Rounding::TowardZero => false,
        };
        if away { quotient + sign } else { quotient }
    }

    /// `√square` for a square below 2¹²⁸.
    fn root(&self, square: u128) -> i128 {
        let floor = square.isqrt();
        let nearest = matches!(self.rounding, Rounding::Nearest | Rounding::NearestEven);
        let root = floor + u128::from(nearest && square - floor * floor > floor);
        i128::try_from(root).unwrap_or(i128::MAX)
    }
}

fn narrow(x: i128) -> i64 {
    i64::try_from(x).unwrap_or(0) // at most 64 bits: it fits
}

/// Number of formats that can be in force at once.
const SLOTS: usize = 4;

thread_local! {
    static FORMATS: [Cell<RuntimeFormat>; SLOTS] = const {
        [const {
            Cell::new(RuntimeFormat {
                width: 32,
                fraction_bits: 16,
                rounding: Rounding::Nearest,
                overflow: Overflow::Wrap,
            })
        }; SLOTS]
    };
}

/// A number in the format that [`RuntimeFormat::run`] has put in force for `SLOT`, 0 to 3; I16F16 outside of it.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct RuntimeFixed<const SLOT: usize>(i64);

impl<const SLOT: usize> RuntimeFixed<SLOT> {
    fn format() -> RuntimeFormat {
        FORMATS.with(|formats| formats[SLOT % SLOTS].get())
    }

    /// The number as an integer, in units of the format's resolution.
    #[must_use]
    pub const fn to_bits(self) -> i64 {
        self.0
    }

    fn wide(self) -> i128 {
        i128::from(self.0)
    }
}

impl<const SLOT: usize> Add for RuntimeFixed<SLOT> {
    type Output = Self;
    fn add(self, other: Self) -> Self {
        Self(Self::format().fit(self.wide() + other.wide()))
    }
}

impl<const SLOT: usize> Sub for RuntimeFixed<SLOT> {
    type Output = Self;
    fn sub(self, other: Self) -> Self {
        Self(Self::format().fit(self.wide() - other.wide()))
    }
}

impl<const SLOT: usize> Neg for RuntimeFixed<SLOT> {
    type Output = Self;
    fn neg(self) -> Self {
        Self(Self::format().fit(-self.wide()))
    }
}

impl<const SLOT: usize> Mul for RuntimeFixed<SLOT> {
    type Output = Self;
    fn mul(self, other: Self) -> Self {
        let format = Self::format();
        Self(format.fit(format.shift_right(self.wide() * other.wide(), format.fraction_bits)))
    }
}

impl<const SLOT: usize> Div for RuntimeFixed<SLOT> {
    type Output = Self;
    fn div(self, other: Self) -> Self {
        let format = Self::format();
        if other.0 == 0 {
            return match self.0.signum() {
                1 => Self::max_value(),
                -1 => Self::min_value(),
                _ => Self(0),
            };
        }
        Self(format.saturate(format.quotient(self.wide() << format.fraction_bits, other.wide())))
    }
}

impl<const SLOT: usize> Zero for RuntimeFixed<SLOT> {
    fn zero() -> Self {
        Self(0)
    }
    fn is_zero(&self) -> bool {
        self.0 == 0
    }
}

impl<const SLOT: usize> One for RuntimeFixed<SLOT> {
    fn one() -> Self {
        Self(1 << Self::format().fraction_bits)
    }
}

impl<const SLOT: usize> Bounded for RuntimeFixed<SLOT> {
    fn min_value() -> Self {
        Self(narrow(Self::format().least()))
    }
    fn max_value() -> Self {
        Self(narrow(Self::format().greatest()))
    }
}

impl<const SLOT: usize> Real for RuntimeFixed<SLOT> {
    fn resolution() -> Self {
        Self(1)
    }

    fn from_ratio(numerator: i32, denominator: i32) -> Self {
        if denominator == 0 {
            return Self(0);
        }
        let nearest = RuntimeFormat { rounding: Rounding::Nearest, ..Self::format() };
        let numerator = i128::from(numerator) << nearest.fraction_bits;
        Self(nearest.saturate(nearest.quotient(numerator, i128::from(denominator))))
    }

    fn mul_add(self, factor: Self, addend: Self) -> Self {
        let format = Self::format();
        let sum = (self.wide() * factor.wide()).wrapping_add(addend.wide() << format.fraction_bits);
        Self(format.fit(format.shift_right(sum, format.fraction_bits)))
    }

    fn sum_of_products(pairs: impl IntoIterator<Item = (Self, Self)>) -> Self {
        let format = Self::format();
        let sum = pairs.into_iter().fold(0_i128, |sum, (a, b)| sum.wrapping_add(a.wide() * b.wide()));
        Self(format.fit(format.shift_right(sum, format.fraction_bits)))
    }

    fn norm<const N: usize>(vector: &[Self; N]) -> Self {
        let format = Self::format();
        let squares = vector.iter().map(|v| v.wide().unsigned_abs().pow(2));
        Self(format.saturate(format.root(squares.fold(0, u128::saturating_add))))
    }

    fn sqrt(self) -> Self {
        let format = Self::format();
        let Ok(bits) = u128::try_from(self.0) else { return Self(0) };
        Self(format.saturate(format.root(bits << format.fraction_bits)))
    }

    fn scale(self, exponent: i32) -> Self {
        let format = Self::format();
        let shift = exponent.unsigned_abs();
        if exponent < 0 {
            return Self(if shift <= format.width {
                format.fit(format.shift_right(self.wide(), shift))
            } else {
                0
            });
        }
        // What is shifted out beyond 128 bits would be lost to a saturating format too.
        match format.overflow {
            Overflow::Wrap if shift >= format.width => Self(0),
            Overflow::Saturate if shift >= 64 => Self(format.saturate(self.wide().signum() << 100)),
            _ => Self(format.fit(self.wide() << shift.min(63))),
        }
    }

    fn from_phase(phase: u64, exponent: i32) -> Self {
        let format = Self::format();
        let shift = 64 - exponent.clamp(-64, 64) - format.fraction_bits.cast_signed();
        let distance = shift.unsigned_abs();
        let wide = if shift >= 0 {
            u128::from(phase).checked_shr(distance).unwrap_or(0)
        } else {
            u128::from(phase) << distance.min(63)
        };
        Self(format.saturate(i128::try_from(wide).unwrap_or(i128::MAX)))
    }

    fn to_phase(self, exponent: i32) -> u64 {
        let Ok(bits) = u128::try_from(self.0) else { return 0 };
        let shift = 64 + exponent.clamp(-64, 64) - Self::format().fraction_bits.cast_signed();
        let distance = shift.unsigned_abs();
        let wide = if shift < 0 {
            bits >> distance
        } else if bits != 0 && distance > bits.leading_zeros() {
            u128::MAX
        } else {
            bits.checked_shl(distance).unwrap_or(0)
        };
        u64::try_from(wide).unwrap_or(u64::MAX)
    }

    fn is_finite(self) -> bool {
        true
    }
}

impl<const SLOT: usize> Backend for RuntimeFixed<SLOT> {
    fn name() -> FormatName {
        Self::format().name()
    }

    fn from_f64_pair(high: f64, low: f64) -> Option<Self> {
        let format = Self::format();
        let exponent = format.fraction_bits.cast_signed();
        let bits = i64::nearest(high.scale(exponent), low.scale(exponent))?;
        (format.least()..=format.greatest()).contains(&i128::from(bits)).then_some(Self(bits))
    }

    fn to_f64_pair(self) -> (f64, f64) {
        let (high, low) = self.0.split();
        let exponent = -Self::format().fraction_bits.cast_signed();
        (high.scale(exponent), low.scale(exponent))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::FixedPoint;
    use fixed::traits::FixedSigned;
    use proptest::prelude::*;

    type Runtime = RuntimeFixed<0>;

    #[allow(clippy::cast_possible_truncation, reason = "both parts are whole numbers below 2^64")]
    fn bits<R: Backend>(x: R, fraction_bits: u32) -> i64 {
        let (high, low) = x.to_f64_pair();
        let units = |part: f64| part.scale(fraction_bits.cast_signed()) as i128;
        i64::try_from(units(high) + units(low)).unwrap()
    }

    /// Every operation on words of random bits gives the same bits as the format's own type.
    fn agrees<F: FixedSigned>(words: [i64; 3], exponent: i32, ratio: (i32, i32), phase: u64)
    where
        F::Bits: Word + TryFrom<i64>,
    {
        let (width, fraction) = (F::INT_NBITS + F::FRAC_NBITS, F::FRAC_NBITS);
        let words = words.map(|w| w << (64 - width) >> (64 - width));
        let format = RuntimeFormat::new(width, fraction, Rounding::Nearest, Overflow::Wrap).unwrap();
        let [a, b, c] = words.map(|w| FixedPoint(F::from_bits(F::Bits::try_from(w).ok().unwrap())));
        format.run::<0, ()>(|| {
            let [x, y, z] = words.map(RuntimeFixed::<0>);
            let same = |what: &str, fixed: FixedPoint<F>, runtime: Runtime| {
                assert_eq!(bits(fixed, fraction), runtime.0, "{what} of {words:?} in {}", format.name());
            };
            same("sum", a + b, x + y);
            same("difference", a - b, x - y);
            same("opposite", -a, -x);
            same("product", a * b, x * y);
            same("quotient", a / b, x / y);
            same("mul_add", a.mul_add(b, c), x.mul_add(y, z));
            same(
                "sum of products",
                Real::sum_of_products([(a, b), (b, c)]),
                Real::sum_of_products([(x, y), (y, z)]),
            );
            same("norm", Real::norm(&[a, b, c]), Real::norm(&[x, y, z]));
            same("root", a.sqrt(), x.sqrt());
            same("scale", a.scale(exponent), x.scale(exponent));
            same("ratio", Real::from_ratio(ratio.0, ratio.1), Real::from_ratio(ratio.0, ratio.1));
            same("from phase", Real::from_phase(phase, exponent), Real::from_phase(phase, exponent));
            same("one", FixedPoint::one(), Runtime::one());
            same("resolution", FixedPoint::resolution(), Runtime::resolution());
            same("least", FixedPoint::min_value(), Runtime::min_value());
            assert_eq!(a.to_phase(exponent), x.to_phase(exponent), "to phase");
            assert_eq!(a < b, x < y);
        });
    }

    fn word() -> impl Strategy<Value = i64> {
        let edge = prop::sample::select(vec![
            0,
            1,
            -1,
            i64::MAX,
            i64::MIN,
            i64::MAX - 1,
            1 << 31,
            1 << 15,
            0x7fff_ffff,
        ]);
        prop_oneof![any::<i64>(), any::<i32>().prop_map(i64::from), any::<i8>().prop_map(i64::from), edge]
    }

    proptest! {
        #[test]
        fn is_bit_exact_with_the_fixed_types(
            words in [word(), word(), word()], exponent in -63..63, n in any::<i32>(), d in any::<i32>(), phase in any::<u64>(),
        ) {
            agrees::<fixed::types::I4F4>(words, exponent, (n, d), phase);
            agrees::<fixed::types::I8F8>(words, exponent, (n, d), phase);
            agrees::<fixed::types::I16F16>(words, exponent, (n, d), phase);
            agrees::<fixed::types::I8F24>(words, exponent, (n, d), phase);
            agrees::<fixed::types::I4F28>(words, exponent, (n, d), phase);
            agrees::<fixed::types::I2F30>(words, exponent, (n, d), phase);
            agrees::<fixed::types::I32F32>(words, exponent, (n, d), phase);
            agrees::<fixed::types::I4F60>(words, exponent, (n, d), phase);
        }

        /// Rounding toward -∞, wrapping or saturating, is what the `fixed` crate's own products do.
        #[test]
        fn floor_is_the_fixed_crates_product(a in any::<i32>(), b in any::<i32>()) {
            let (x, y) = (fixed::types::I8F24::from_bits(a), fixed::types::I8F24::from_bits(b));
            for (overflow, expected) in
                [(Overflow::Wrap, x.wrapping_mul(y)), (Overflow::Saturate, x.saturating_mul(y))]
            {
                let format = RuntimeFormat::new(32, 24, Rounding::Floor, overflow).unwrap();
                let product = format.run::<1, i64>(|| (RuntimeFixed::<1>(a.into()) * RuntimeFixed::<1>(b.into())).0);
                prop_assert_eq!(product, i64::from(expected.to_bits()));
            }
        }
    }

    #[test]
    fn rounding_modes_differ_on_a_tie() {
        let product = |rounding, a: i64| {
            let format = RuntimeFormat::new(8, 2, rounding, Overflow::Wrap).unwrap();
            format.run::<2, i64>(|| (RuntimeFixed::<2>(a) * RuntimeFixed::<2>(2)).0) // a/4 · 1/2, in quarters: a/2
        };
        use Rounding::{Floor, Nearest, NearestEven, TowardZero};
        assert_eq!([Nearest, NearestEven, Floor, TowardZero].map(|r| product(r, 5)), [3, 2, 2, 2]);
        assert_eq!([Nearest, NearestEven, Floor, TowardZero].map(|r| product(r, -5)), [-2, -2, -3, -2]);
    }

    #[test]
    fn formats_have_bounds_and_names() {
        let new = |width, fraction| RuntimeFormat::new(width, fraction, Rounding::Nearest, Overflow::Wrap);
        assert_eq!((new(65, 10), new(2, 0), new(20, 19)), (None, None, None));
        assert_eq!(new(18, 13).map(|f| f.name().to_string()).as_deref(), Some("I5F13"));
        assert_eq!(RuntimeFormat::named("I5F13"), new(18, 13));
        assert_eq!(
            (RuntimeFormat::named("I1F31"), RuntimeFormat::named("f32"), RuntimeFormat::named("I99F9")),
            (None, None, None)
        );
    }
}
