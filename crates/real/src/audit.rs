//! The auditing wrapper: the same values, with overflows counted and the range of every named signal recorded.
//!
//! Each operation is done twice: by the backend, whose result is handed on unchanged, and in `f64`, whose
//! result tells whether the exact one lies within the backend's range. The records live in thread-local
//! storage, so that a value stays as small as the backend's own and a kernel needs no extra argument.

use std::cell::RefCell;
use std::collections::BTreeMap;
use std::ops::{Add, Div, Mul, Neg, Sub};

use num_traits::{Bounded, One, Zero};

use crate::{Backend, FormatName, Real};

/// What happened while [`Audit::of`] watched.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Audit {
    /// Results too large for the format: they wrapped, saturated, or became infinite or NaN.
    pub overflows: u64,
    /// Divisions by zero.
    pub divisions_by_zero: u64,
    /// The range of each named signal.
    pub signals: BTreeMap<&'static str, SignalRange>,
}

/// The values that a named signal took.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SignalRange {
    /// Least value.
    pub min: f64,
    /// Greatest value.
    pub max: f64,
    /// Smallest magnitude that is not zero; infinite if every value was zero.
    pub min_magnitude: f64,
    /// How many values.
    pub count: u64,
}

impl SignalRange {
    fn include(&mut self, value: f64) {
        self.min = self.min.min(value);
        self.max = self.max.max(value);
        if value != 0.0 {
            self.min_magnitude = self.min_magnitude.min(value.abs());
        }
        self.count += 1;
    }
}

impl Default for SignalRange {
    fn default() -> Self {
        Self { min: f64::INFINITY, max: f64::NEG_INFINITY, min_magnitude: f64::INFINITY, count: 0 }
    }
}

thread_local! {
    static AUDIT: RefCell<Audit> = RefCell::default();
}

impl Audit {
    /// Runs `work` and returns its result with what its [`Audited`] numbers met on this thread.
    pub fn of<T>(work: impl FnOnce() -> T) -> (T, Audit) {
        let outer = AUDIT.with(RefCell::take);
        let result = work();
        (result, AUDIT.with(|audit| audit.replace(outer)))
    }

    /// Integer bits, the sign included, that the largest named signal needs; 1 if none was recorded.
    #[must_use]
    pub fn integer_bits_needed(&self) -> u32 {
        let bits = |range: &SignalRange| {
            // A value v fits n integer bits when -2^(n-1) <= v < 2^(n-1).
            (1..=128).find(|n| {
                let bound = 1.0_f64.scale(n - 1);
                range.min >= -bound && range.max < bound
            })
        };
        let widest = self.signals.values().map(|range| bits(range).unwrap_or(129)).max().unwrap_or(1);
        widest.unsigned_abs()
    }

    fn note(change: impl FnOnce(&mut Audit)) {
        AUDIT.with(|audit| change(&mut audit.borrow_mut()));
    }
}

/// A backend under audit: computes exactly as `R` does, and counts in the [`Audit`] of its thread.
#[derive(Clone, Copy, Debug, Default, PartialEq, PartialOrd)]
pub struct Audited<R>(pub R);

impl<R: Backend> Audited<R> {
    /// Hands on `result`, noting whether the exact value lies outside the format.
    fn checked(result: R, exact: f64) -> Self {
        let range = R::min_value().to_f64()..=R::max_value().to_f64();
        if !result.is_finite() || !range.contains(&exact) {
            Audit::note(|audit| audit.overflows += 1);
        }
        Self(result)
    }
}

impl<R: Backend> Add for Audited<R> {
    type Output = Self;
    fn add(self, other: Self) -> Self {
        Self::checked(self.0 + other.0, self.0.to_f64() + other.0.to_f64())
    }
}

impl<R: Backend> Sub for Audited<R> {
    type Output = Self;
    fn sub(self, other: Self) -> Self {
        Self::checked(self.0 - other.0, self.0.to_f64() - other.0.to_f64())
    }
}

impl<R: Backend> Mul for Audited<R> {
    type Output = Self;
    fn mul(self, other: Self) -> Self {
        Self::checked(self.0 * other.0, self.0.to_f64() * other.0.to_f64())
    }
}

impl<R: Backend> Div for Audited<R> {
    type Output = Self;
    fn div(self, other: Self) -> Self {
        if other.0.is_zero() {
            Audit::note(|audit| audit.divisions_by_zero += 1);
            return Self(self.0 / other.0);
        }
        Self::checked(self.0 / other.0, self.0.to_f64() / other.0.to_f64())
    }
}

impl<R: Backend> Neg for Audited<R> {
    type Output = Self;
    fn neg(self) -> Self {
        Self::checked(-self.0, -self.0.to_f64())
    }
}

impl<R: Backend> Zero for Audited<R> {
    fn zero() -> Self {
        Self(R::zero())
    }
    fn is_zero(&self) -> bool {
        self.0.is_zero()
    }
}

impl<R: Backend> One for Audited<R> {
    fn one() -> Self {
        Self(R::one())
    }
}

impl<R: Backend> Bounded for Audited<R> {
    fn min_value() -> Self {
        Self(R::min_value())
    }
    fn max_value() -> Self {
        Self(R::max_value())
    }
}

impl<R: Backend> Real for Audited<R> {
    fn resolution() -> Self {
        Self(R::resolution())
    }

    fn from_ratio(numerator: i32, denominator: i32) -> Self {
        Self::checked(R::from_ratio(numerator, denominator), f64::from_ratio(numerator, denominator))
    }

    fn mul_add(self, factor: Self, addend: Self) -> Self {
        let exact = self.0.to_f64() * factor.0.to_f64() + addend.0.to_f64();
        Self::checked(self.0.mul_add(factor.0, addend.0), exact)
    }

    fn sum_of_products(pairs: impl IntoIterator<Item = (Self, Self)>) -> Self {
        let mut exact = 0.0;
        let sum = R::sum_of_products(pairs.into_iter().map(|(a, b)| {
            exact += a.0.to_f64() * b.0.to_f64();
            (a.0, b.0)
        }));
        Self::checked(sum, exact)
    }

    fn norm<const N: usize>(vector: &[Self; N]) -> Self {
        Self::checked(R::norm(&vector.map(|v| v.0)), f64::norm(&vector.map(|v| v.0.to_f64())))
    }

    fn sqrt(self) -> Self {
        Self(self.0.sqrt())
    }

    fn scale(self, exponent: i32) -> Self {
        Self::checked(self.0.scale(exponent), self.0.to_f64().scale(exponent))
    }

    fn from_phase(phase: u64, exponent: i32) -> Self {
        Self(R::from_phase(phase, exponent))
    }

    fn to_phase(self, exponent: i32) -> u64 {
        self.0.to_phase(exponent)
    }

    fn is_finite(self) -> bool {
        self.0.is_finite()
    }

    fn signal(self, name: &'static str) -> Self {
        Audit::note(|audit| audit.signals.entry(name).or_default().include(self.0.to_f64()));
        self
    }
}

impl<R: Backend> Backend for Audited<R> {
    fn name() -> FormatName {
        R::name()
    }

    fn from_f64_pair(high: f64, low: f64) -> Option<Self> {
        R::from_f64_pair(high, low).map(Self)
    }

    fn to_f64_pair(self) -> (f64, f64) {
        self.0.to_f64_pair()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::I16F16;

    fn audited(value: f64) -> Audited<I16F16> {
        Audited::from_f64(value).expect("the value fits")
    }

    #[test]
    fn an_overflow_is_counted_and_the_value_is_the_backends_own() {
        let (product, audit) = Audit::of(|| audited(300.0) * audited(300.0));
        assert_eq!(product.0, audited(300.0).0 * audited(300.0).0);
        assert_eq!((audit.overflows, audit.divisions_by_zero), (1, 0));
        let ((), quiet) = Audit::of(|| {
            let _ = audited(100.0) * audited(300.0);
        });
        assert_eq!(quiet.overflows, 0);
    }

    #[test]
    fn a_division_by_zero_is_counted() {
        let (_, audit) = Audit::of(|| audited(1.0) / audited(0.0));
        assert_eq!(audit.divisions_by_zero, 1);
    }

    #[test]
    fn signals_have_ranges_and_integer_bits() {
        let ((), audit) = Audit::of(|| {
            for value in [-8.0, 0.0, 0.25, 7.5] {
                let _ = audited(value).signal("x");
            }
        });
        let x = audit.signals["x"];
        assert_eq!((x.min, x.max, x.min_magnitude, x.count), (-8.0, 7.5, 0.25, 4));
        assert_eq!(audit.integer_bits_needed(), 4); // -8 fits 4 bits with the sign, +8 would not
    }

    #[test]
    fn a_float_overflow_is_an_infinity() {
        let (_, audit) = Audit::of(|| Audited(1e30_f32) * Audited(1e30_f32));
        assert_eq!(audit.overflows, 1);
    }

    #[test]
    fn audits_nest() {
        let (inner, outer) = Audit::of(|| Audit::of(|| audited(300.0) * audited(300.0)).1);
        assert_eq!((inner.overflows, outer.overflows), (1, 0));
    }
}
