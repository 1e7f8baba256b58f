//! Fixed point of any width up to 64 bits, chosen at run time: a search for the narrowest format runs in it.
//!
//! A value does not carry its format. Thread-local storage holds the format, in one slot for each type parameter, so
//! that a value is as small as an `i64` and a kernel needs no further argument. With [`Rounding::Nearest`] and
//! [`Overflow::Wrap`] every operation gives the same bits as [`FixedPoint`](crate::FixedPoint), in the formats that
//! both have.

use std::cell::Cell;
use std::ops::{Add, Div, Mul, Neg, Sub};

use num_traits::{Bounded, One, Zero};

use crate::division::{divide_u64, divide_u128};
use crate::word::Word;
use crate::{Backend, Datapath, FormatName, Overflow, Real, Rounding, square_root};

/// A fixed-point format.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct RuntimeFormat {
    // Four bytes in all: each operation asks for its format, and gets it in a register.
    width: u8,
    fraction_bits: u8,
    datapath: Datapath,
}

impl RuntimeFormat {
    /// The format with `width` bits in all, the sign included, of which `fraction_bits` follow the point.
    ///
    /// `None` unless `3 ≤ width ≤ 64` and at least two bits are left of the point, so that 1 can be held.
    #[must_use]
    pub const fn new(width: u32, fraction_bits: u32, rounding: Rounding, overflow: Overflow) -> Option<Self> {
        if width < 3 || width > 64 || fraction_bits > width - 2 {
            return None;
        }
        Some(Self::packed(width, fraction_bits, Datapath { rounding, overflow }))
    }

    #[allow(clippy::cast_possible_truncation, reason = "both are at most 64")]
    const fn packed(width: u32, fraction_bits: u32, datapath: Datapath) -> Self {
        Self { width: width as u8, fraction_bits: fraction_bits as u8, datapath }
    }

    /// The format of this name, as in `I5F13` or `I5F13-floor-sat`: see [`FormatName::named`].
    #[must_use]
    pub fn named(name: &str) -> Option<Self> {
        Self::of(FormatName::named(name)?)
    }

    /// The format that has this name; `None` unless it is one of fixed point that [`new`](Self::new) makes.
    #[must_use]
    pub const fn of(name: FormatName) -> Option<Self> {
        match name {
            FormatName::Fixed { fraction_bits, datapath: Datapath { rounding, overflow }, .. } => {
                Self::new(name.bits(), fraction_bits, rounding, overflow)
            }
            _ => None,
        }
    }

    /// The format with `width` bits in all, the sign included, whose resolution is `2^-fraction_bits`.
    ///
    /// `None` unless `2 ≤ width ≤ 64` and `fraction_bits ≤ 62`. The point may lie left of all digits. Where 1 does not
    /// fit the format, `one` gives the greatest number.
    #[must_use]
    pub const fn with_any_point(
        width: u32,
        fraction_bits: u32,
        rounding: Rounding,
        overflow: Overflow,
    ) -> Option<Self> {
        if width < 2 || width > 64 || fraction_bits > 62 {
            return None;
        }
        Some(Self::packed(width, fraction_bits, Datapath { rounding, overflow }))
    }

    /// The format's name.
    #[must_use]
    pub const fn name(&self) -> FormatName {
        match self.width().checked_sub(self.fraction_bits()) {
            Some(integer_bits) => {
                let (fraction_bits, datapath) = (self.fraction_bits(), self.datapath);
                FormatName::Fixed { integer_bits, fraction_bits, datapath }
            }
            None => FormatName::Fraction { bits: self.width(), fraction_bits: self.fraction_bits() },
        }
    }

    /// Width in bits, the sign included.
    #[must_use]
    #[inline]
    pub const fn width(&self) -> u32 {
        self.width as u32
    }

    /// Bits after the point: the resolution is `2^-fraction_bits`.
    #[must_use]
    #[inline]
    pub const fn fraction_bits(&self) -> u32 {
        self.fraction_bits as u32
    }

    /// How results are rounded.
    #[must_use]
    pub const fn rounding(&self) -> Rounding {
        self.datapath.rounding
    }

    /// Whether sums and products that do not fit wrap or saturate.
    #[must_use]
    pub const fn overflow(&self) -> Overflow {
        self.datapath.overflow
    }

    /// Runs `work`. Meanwhile [`RuntimeFixed<SLOT>`] has this format on this thread. After the call, also after a
    /// panic, the slot has its former format again: calls may be nested.
    pub fn run<const SLOT: usize, T>(self, work: impl FnOnce() -> T) -> T {
        struct Restore<const SLOT: usize>(RuntimeFormat);
        impl<const SLOT: usize> Drop for Restore<SLOT> {
            fn drop(&mut self) {
                FORMATS.with(|formats| formats[SLOT].set(self.0));
            }
        }
        const { assert!(SLOT < SLOTS, "slots are numbered from 0 to 7") };
        let _restore = Restore::<SLOT>(FORMATS.with(|formats| formats[SLOT].replace(self)));
        work()
    }

    #[inline]
    fn least(self) -> i64 {
        i64::MIN >> (64 - self.width())
    }

    #[inline]
    fn greatest(self) -> i64 {
        i64::MAX >> (64 - self.width())
    }

    #[inline]
    #[allow(clippy::cast_possible_truncation, reason = "the bits that wrapping loses")]
    fn fit(self, wide: i128) -> i64 {
        match self.datapath.overflow {
            Overflow::Saturate => self.saturate(wide),
            Overflow::Wrap => self.wrapped(wide as i64),
        }
    }

    /// The number of the format that has the same last bits.
    #[inline]
    fn wrapped(self, bits: i64) -> i64 {
        let unused = 64 - self.width();
        (bits << unused) >> unused
    }

    /// A product or a sum of products as a number: rounded to its last place, and fitted.
    #[inline]
    #[allow(clippy::cast_possible_truncation, reason = "the bits that wrapping loses")]
    fn rounded(self, wide: i128) -> i64 {
        if !matches!(self.datapath, Datapath { rounding: Rounding::Nearest, overflow: Overflow::Wrap }) {
            return self.fit(self.shift_right(wide, self.fraction_bits()));
        }
        // The bits that are left lie within 64 above the last place; the one below it says whether to round up.
        let dropped = self.fraction_bits() & 63;
        let up = ((wide as i64) << 1 >> dropped) & 1;
        self.wrapped(((wide >> dropped) as i64).wrapping_add(up))
    }

    #[inline]
    #[allow(clippy::cast_possible_truncation, reason = "clamped to 64 bits")]
    fn saturate(self, wide: i128) -> i64 {
        wide.clamp(self.least().into(), self.greatest().into()) as i64
    }

    /// Drops `shift` bits, `shift ≤ 126`.
    #[inline]
    fn shift_right(self, wide: i128, shift: u32) -> i128 {
        if shift == 0 {
            return wide;
        }
        let floor = wide >> shift;
        let first_dropped = (wide >> (shift - 1)) & 1;
        floor
            + match self.datapath.rounding {
                Rounding::Nearest => first_dropped,
                // It is a tie if the first dropped bit is the last bit that is set.
                Rounding::NearestEven => {
                    first_dropped & i128::from(floor & 1 == 1 || wide.trailing_zeros() != shift - 1)
                }
                Rounding::Floor => 0,
                Rounding::TowardZero => i128::from(floor < 0 && floor << shift != wide),
            }
    }

    /// `(±numerator) / divisor`, saturated. Over zero, the extreme with the sign of the numerator; `0/0` is 0.
    #[inline]
    fn quotient(self, numerator: u128, divisor: u64, negative: bool) -> i64 {
        let extreme = if negative { self.least() } else { self.greatest() };
        let (quotient, rest) = match (u64::try_from(numerator), u128::from(divisor)) {
            (Ok(0), _) => return 0,
            (Ok(n), d) if n >> 32 < divisor && d >> 32 == 0 => {
                let (q, r) = divide_u64(n, divisor);
                (u128::from(q), u128::from(r))
            }
            (_, d) if numerator >> 64 < d => divide_u128(numerator, d),
            _ => return extreme, // does not fit, or is over zero
        };
        let left = u128::from(divisor) - rest;
        let away = match self.datapath.rounding {
            Rounding::Nearest => rest >= left,
            Rounding::NearestEven => rest > left || (rest == left && quotient & 1 == 1),
            Rounding::Floor => negative && rest != 0,
            Rounding::TowardZero => false,
        };
        let magnitude = i128::try_from(quotient + u128::from(away)).unwrap_or(i128::MAX);
        self.saturate(if negative { -magnitude } else { magnitude })
    }

    /// `√square`, saturated.
    #[inline]
    fn root(self, square: u128) -> i64 {
        let nearest = matches!(self.datapath.rounding, Rounding::Nearest | Rounding::NearestEven);
        let root: u128 = match (u64::try_from(square), nearest) {
            (Ok(square), true) => square_root::u64::nearest(square).into(),
            (Ok(square), false) => square_root::u64::floor(square).into(),
            (Err(_), true) => square_root::u128::nearest(square),
            (Err(_), false) => square_root::u128::floor(square).into(),
        };
        self.saturate(i128::try_from(root).unwrap_or(i128::MAX))
    }
}

/// Number of formats that can be in force at once.
const SLOTS: usize = 8;

/// The formats that the slots of a thread have, to be taken along to another thread.
#[derive(Clone, Copy, Debug)]
pub struct RuntimeFormats([RuntimeFormat; SLOTS]);

impl RuntimeFormats {
    /// Those of this thread.
    #[must_use]
    pub fn of_this_thread() -> Self {
        Self(FORMATS.with(|formats| core::array::from_fn(|slot| formats[slot].get())))
    }

    /// Gives the slots of this thread these formats.
    pub fn set(&self) {
        FORMATS.with(|formats| formats.iter().zip(&self.0).for_each(|(slot, format)| slot.set(*format)));
    }
}

thread_local! {
    static FORMATS: [Cell<RuntimeFormat>; SLOTS] = const {
        [const {
            Cell::new(RuntimeFormat {
                width: 32,
                fraction_bits: 16,
                datapath: Datapath { rounding: Rounding::Nearest, overflow: Overflow::Wrap },
            })
        }; SLOTS]
    };
}

/// The format that a slot of this thread has. It is compiled once and not for each slot: thread-local storage is quick to
/// reach only within the crate that has it.
#[inline(never)]
fn in_force(slot: usize) -> RuntimeFormat {
    // Callers assert that the slot is one of these. The remainder shows it to the compiler, so that nothing can panic here.
    FORMATS.with(|formats| formats[slot % SLOTS].get())
}

/// A number in the format that [`RuntimeFormat::run`] has put in force for `SLOT`, 0 to 7; outside of such a call, in
/// I16F16.
///
/// The value is an integer in units of the resolution, and means nothing in another format: make and use a number
/// within one call. Signals of different formats take different slots.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct RuntimeFixed<const SLOT: usize>(i64);

impl<const SLOT: usize> RuntimeFixed<SLOT> {
    #[inline]
    fn format() -> RuntimeFormat {
        const { assert!(SLOT < SLOTS, "slots are numbered from 0 to 7") };
        in_force(SLOT)
    }

    /// The number of `bits` units of the resolution. A number that does not fit the format wraps or saturates.
    #[must_use]
    pub fn from_bits(bits: i64) -> Self {
        Self(Self::format().fit(bits.into()))
    }

    /// The number as an integer, in units of the format's resolution.
    #[must_use]
    pub const fn to_bits(self) -> i64 {
        self.0
    }

    #[inline]
    fn wide(self) -> i128 {
        i128::from(self.0)
    }
}

impl<const SLOT: usize> Add for RuntimeFixed<SLOT> {
    type Output = Self;
    #[inline]
    fn add(self, other: Self) -> Self {
        Self(Self::format().fit(self.wide() + other.wide()))
    }
}

impl<const SLOT: usize> Sub for RuntimeFixed<SLOT> {
    type Output = Self;
    #[inline]
    fn sub(self, other: Self) -> Self {
        Self(Self::format().fit(self.wide() - other.wide()))
    }
}

impl<const SLOT: usize> Neg for RuntimeFixed<SLOT> {
    type Output = Self;
    #[inline]
    fn neg(self) -> Self {
        Self(Self::format().fit(-self.wide()))
    }
}

impl<const SLOT: usize> Mul for RuntimeFixed<SLOT> {
    type Output = Self;
    #[inline]
    fn mul(self, other: Self) -> Self {
        let format = Self::format();
        Self(format.rounded(self.wide() * other.wide()))
    }
}

impl<const SLOT: usize> Div for RuntimeFixed<SLOT> {
    type Output = Self;
    #[inline]
    fn div(self, other: Self) -> Self {
        let format = Self::format();
        let numerator = u128::from(self.0.unsigned_abs()) << format.fraction_bits();
        Self(format.quotient(numerator, other.0.unsigned_abs(), (self.0 < 0) != (other.0 < 0)))
    }
}

impl<const SLOT: usize> Zero for RuntimeFixed<SLOT> {
    #[inline]
    fn zero() -> Self {
        Self(0)
    }
    #[inline]
    fn is_zero(&self) -> bool {
        self.0 == 0
    }
}

impl<const SLOT: usize> One for RuntimeFixed<SLOT> {
    #[inline]
    fn one() -> Self {
        let format = Self::format();
        Self(format.saturate(1 << format.fraction_bits()))
    }
}

impl<const SLOT: usize> Bounded for RuntimeFixed<SLOT> {
    #[inline]
    fn min_value() -> Self {
        Self(Self::format().least())
    }
    #[inline]
    fn max_value() -> Self {
        Self(Self::format().greatest())
    }
}

impl<const SLOT: usize> Real for RuntimeFixed<SLOT> {
    #[inline]
    fn resolution() -> Self {
        Self(1)
    }

    fn from_ratio(numerator: i32, denominator: i32) -> Self {
        let format = Self::format();
        let datapath = Datapath { rounding: Rounding::Nearest, ..format.datapath };
        let nearest = RuntimeFormat { datapath, ..format };
        let magnitude = u128::from(numerator.unsigned_abs()) << nearest.fraction_bits();
        let negative = (numerator < 0) != (denominator < 0);
        Self(nearest.quotient(magnitude, denominator.unsigned_abs().into(), negative))
    }

    #[inline]
    fn mul_add(self, factor: Self, addend: Self) -> Self {
        let format = Self::format();
        let sum = self.wide() * factor.wide() + (addend.wide() << format.fraction_bits()); // below 2^127
        Self(format.rounded(sum))
    }

    #[inline]
    fn sum_of_products(pairs: impl IntoIterator<Item = (Self, Self)>) -> Self {
        let format = Self::format();
        let products = pairs.into_iter().map(|(a, b)| a.wide() * b.wide());
        let sum = match format.datapath.overflow {
            Overflow::Wrap => products.fold(0, i128::wrapping_add),
            // The sum may leave 128 bits and come back, so its high part is kept separately.
            Overflow::Saturate => {
                let (low, carries) = products.fold((0_i128, 0_i64), |(low, carries), product| {
                    let (low, overflowed) = low.overflowing_add(product);
                    (low, carries + i64::from(overflowed) * if product < 0 { -1 } else { 1 })
                });
                match carries {
                    0 => low,
                    1.. => return Self::max_value(),
                    _ => return Self::min_value(),
                }
            }
        };
        Self(format.rounded(sum))
    }

    #[inline]
    fn norm<const N: usize>(vector: &[Self; N]) -> Self {
        let squares = vector.iter().map(|v| u128::from(v.0.unsigned_abs()).pow(2));
        Self(Self::format().root(squares.fold(0, u128::saturating_add)))
    }

    #[inline]
    fn sqrt(self) -> Self {
        let format = Self::format();
        Self(format.root(u128::from(self.0.max(0).unsigned_abs()) << format.fraction_bits()))
    }

    #[inline]
    fn ldexp(self, exponent: i32) -> Self {
        let format = Self::format();
        let shift = exponent.unsigned_abs();
        Self(match format.datapath.overflow {
            _ if exponent < 0 => format.fit(format.shift_right(self.wide(), shift.min(126))),
            Overflow::Wrap if shift >= format.width() => 0,
            // Beyond 2^64 every number but zero saturates.
            Overflow::Saturate => format.saturate(self.wide() << shift.min(63) << u32::from(shift > 63)),
            Overflow::Wrap => format.fit(self.wide() << shift),
        })
    }

    #[inline]
    fn from_phase(phase: u64, exponent: i32) -> Self {
        let format = Self::format();
        let shift = 64 - exponent.clamp(-64, 64) - format.fraction_bits().cast_signed();
        let distance = shift.unsigned_abs();
        let wide = if shift >= 0 {
            u128::from(phase).checked_shr(distance).unwrap_or(0)
        } else {
            u128::from(phase) << distance.min(63)
        };
        Self(format.saturate(i128::try_from(wide).unwrap_or(i128::MAX)))
    }

    #[inline]
    fn to_phase(self, exponent: i32) -> u64 {
        let Ok(bits) = u128::try_from(self.0) else { return 0 };
        let shift = 64 + exponent.clamp(-64, 64) - Self::format().fraction_bits().cast_signed();
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

    #[inline]
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
        let exponent = format.fraction_bits().cast_signed();
        let bits = i64::nearest(high.ldexp(exponent), low.ldexp(exponent))?;
        (format.least()..=format.greatest()).contains(&bits).then_some(Self(bits))
    }

    #[inline]
    fn to_f64_pair(self) -> (f64, f64) {
        let (high, low) = self.0.split();
        let exponent = -Self::format().fraction_bits().cast_signed();
        (high.ldexp(exponent), low.ldexp(exponent))
    }

    #[inline]
    fn fraction_bits() -> Option<u32> {
        Some(Self::format().fraction_bits())
    }

    #[inline]
    fn word(self) -> Option<i64> {
        Some(self.0)
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
        let units = |part: f64| part.ldexp(fraction_bits.cast_signed()) as i128;
        i64::try_from(units(high) + units(low)).unwrap()
    }

    /// Every operation on words of random bits gives the same bits as the format's own type.
    fn agrees<F: FixedSigned + Send + Sync>(words: [i64; 3], exponent: i32, ratio: (i32, i32), phase: u64)
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
            same("ldexp", a.ldexp(exponent), x.ldexp(exponent));
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
        assert_eq!((new(32, u32::MAX), new(64, u32::MAX - 1)), (None, None)); // the sum with 2 wraps
        assert_eq!(new(18, 13).map(|f| f.name().to_string()).as_deref(), Some("I5F13"));
        assert_eq!(RuntimeFormat::named("I5F13"), new(18, 13));
        assert_eq!(
            (RuntimeFormat::named("I1F31"), RuntimeFormat::named("f32"), RuntimeFormat::named("I99F9")),
            (None, None, None)
        );
    }
}
