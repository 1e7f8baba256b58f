//! The common part of the wrappers: the backend inside does each operation, and the wrapper is shown it.
//!
//! A wrapper implements [`Wrapper`], which is called for each operation; the macro `wrapper!` makes a
//! [`Backend`](crate::Backend) of it. The operators belong to core, so that a blanket implementation is not possible.

use core::cmp::Ordering;
use core::fmt::Debug;

use crate::{Backend, Operation, Real};

/// A value of a backend, with the data that a wrapper keeps about it.
pub(crate) trait Wrapper: Copy + Debug + Default {
    /// The backend inside.
    type Inner: Backend;

    /// The backend's value.
    fn inner(self) -> Self::Inner;

    /// A number that comes from no operation, exactly as it is.
    fn constant(value: Self::Inner) -> Self;

    /// The backend has done `operation` on the values of `operands`.
    fn observe(operation: Operation, operands: &[Self], result: Self::Inner) -> Self;

    /// The backend has compared two values.
    fn compared(_left: Self, _right: Self, _outcome: Option<Ordering>) {}

    /// A kernel has learnt whether a comparison of two values holds: it may go one way or the other.
    fn decided(_left: Self, _right: Self, _holds: bool) {}

    /// `work` selects one of two values by a comparison, and goes no other way.
    fn selecting(work: impl FnOnce() -> Self) -> Self {
        work()
    }

    /// A number that depends on the format's width: the least or the greatest one, or a power of two that may not fit.
    fn bound(value: Self::Inner) -> Self {
        Self::constant(value)
    }

    /// The backend has rounded a constant.
    fn ratio(_numerator: i32, _denominator: i32, result: Self::Inner) -> Self {
        Self::constant(result)
    }

    /// The backend has rounded an input.
    fn converted(result: Self::Inner) -> Self {
        Self::constant(result)
    }

    /// The backend has made a number of a phase.
    fn phase(_phase: u64, _exponent: i32, result: Self::Inner) -> Self {
        Self::constant(result)
    }

    /// The backend has made a phase of a number.
    fn to_phase(_value: Self, _exponent: i32, _result: u64) {}

    /// A kernel has named a value.
    fn named(self, name: &'static str) -> Self {
        let _ = self.inner().signal(name);
        self
    }
}

/// Calls `act` with the operands of a sum of products, in the order a₀, b₀, a₁, b₁, …; up to 16 pairs need no heap.
pub(crate) fn with_operands<W: Wrapper, T>(
    pairs: impl IntoIterator<Item = (W, W)>,
    act: impl FnOnce(&[W]) -> T,
) -> T {
    let mut few = [[W::default(); 2]; 16];
    let mut many = Vec::new();
    let mut count = 0;
    for (a, b) in pairs {
        if let Some(place) = few.get_mut(count) {
            *place = [a, b];
        } else {
            keep_many(&mut many, &few, [a, b]);
        }
        count += 1;
    }
    act(if many.is_empty() { few[..count].as_flattened() } else { many.as_flattened() })
}

/// Puts a pair behind the few that have a place; compiled once, and not for each sum of products.
#[cold]
#[inline(never)]
fn keep_many<W: Copy>(many: &mut Vec<[W; 2]>, few: &[[W; 2]], pair: [W; 2]) {
    if many.is_empty() {
        many.extend_from_slice(few);
    }
    many.push(pair);
}

/// Makes a `Backend` of a `Wrapper`.
macro_rules! wrapper {
    (impl[$($generics:tt)*] $wrapper:ty) => {
        impl<$($generics)*> core::ops::Add for $wrapper {
            type Output = Self;
            #[inline]
            fn add(self, other: Self) -> Self {
                Self::observe(Operation::Add, &[self, other], self.inner() + other.inner())
            }
        }

        impl<$($generics)*> core::ops::Sub for $wrapper {
            type Output = Self;
            #[inline]
            fn sub(self, other: Self) -> Self {
                Self::observe(Operation::Sub, &[self, other], self.inner() - other.inner())
            }
        }

        impl<$($generics)*> core::ops::Mul for $wrapper {
            type Output = Self;
            #[inline]
            fn mul(self, other: Self) -> Self {
                Self::observe(Operation::Mul, &[self, other], self.inner() * other.inner())
            }
        }

        impl<$($generics)*> core::ops::Div for $wrapper {
            type Output = Self;
            #[inline]
            fn div(self, other: Self) -> Self {
                Self::observe(Operation::Div, &[self, other], self.inner() / other.inner())
            }
        }

        impl<$($generics)*> core::ops::Neg for $wrapper {
            type Output = Self;
            #[inline]
            fn neg(self) -> Self {
                Self::observe(Operation::Neg, &[self], -self.inner())
            }
        }

        impl<$($generics)*> PartialEq for $wrapper {
            fn eq(&self, other: &Self) -> bool {
                let holds = self.partial_cmp(other) == Some(core::cmp::Ordering::Equal);
                Self::decided(*self, *other, holds);
                holds
            }
        }

        impl<$($generics)*> PartialOrd for $wrapper {
            #[inline]
            fn partial_cmp(&self, other: &Self) -> Option<core::cmp::Ordering> {
                let outcome = self.inner().partial_cmp(&other.inner());
                Self::compared(*self, *other, outcome);
                outcome
            }

            #[inline]
            fn lt(&self, other: &Self) -> bool {
                let holds = self.partial_cmp(other).is_some_and(core::cmp::Ordering::is_lt);
                Self::decided(*self, *other, holds);
                holds
            }

            #[inline]
            fn le(&self, other: &Self) -> bool {
                let holds = self.partial_cmp(other).is_some_and(core::cmp::Ordering::is_le);
                Self::decided(*self, *other, holds);
                holds
            }

            #[inline]
            fn gt(&self, other: &Self) -> bool {
                let holds = self.partial_cmp(other).is_some_and(core::cmp::Ordering::is_gt);
                Self::decided(*self, *other, holds);
                holds
            }

            #[inline]
            fn ge(&self, other: &Self) -> bool {
                let holds = self.partial_cmp(other).is_some_and(core::cmp::Ordering::is_ge);
                Self::decided(*self, *other, holds);
                holds
            }
        }

        impl<$($generics)*> num_traits::Zero for $wrapper {
            fn zero() -> Self {
                Self::constant(num_traits::Zero::zero())
            }
            #[inline]
            fn is_zero(&self) -> bool {
                *self == Self::zero()
            }
        }

        impl<$($generics)*> num_traits::One for $wrapper {
            fn one() -> Self {
                Self::constant(num_traits::One::one())
            }
        }

        impl<$($generics)*> num_traits::Bounded for $wrapper {
            fn min_value() -> Self {
                Self::bound(num_traits::Bounded::min_value())
            }
            fn max_value() -> Self {
                Self::bound(num_traits::Bounded::max_value())
            }
        }

        impl<$($generics)*> crate::Real for $wrapper {
            const IS_FLOATING: bool = <Self as Wrapper>::Inner::IS_FLOATING;
            const ADDS_PLACES: bool = <Self as Wrapper>::Inner::ADDS_PLACES;

            fn resolution() -> Self {
                Self::constant(<Self as Wrapper>::Inner::resolution())
            }

            fn from_ratio(numerator: i32, denominator: i32) -> Self {
                Self::ratio(numerator, denominator, <Self as Wrapper>::Inner::from_ratio(numerator, denominator))
            }

            #[inline]
            fn mul_add(self, factor: Self, addend: Self) -> Self {
                let result = self.inner().mul_add(factor.inner(), addend.inner());
                Self::observe(Operation::MulAdd, &[self, factor, addend], result)
            }

            #[inline]
            fn sum_of_products(pairs: impl IntoIterator<Item = (Self, Self)>) -> Self {
                crate::wrapper::with_operands(pairs, |operands: &[Self]| {
                    let pairs = operands.chunks_exact(2).map(|pair| (pair[0].inner(), pair[1].inner()));
                    let result = <Self as Wrapper>::Inner::sum_of_products(pairs);
                    Self::observe(Operation::SumOfProducts, operands, result)
                })
            }

            #[inline]
            fn norm<const N: usize>(vector: &[Self; N]) -> Self {
                let result = <Self as Wrapper>::Inner::norm(&vector.map(Self::inner));
                Self::observe(Operation::Norm, vector, result)
            }

            #[inline]
            fn sqrt(self) -> Self {
                Self::observe(Operation::Sqrt, &[self], self.inner().sqrt())
            }

            #[inline]
            fn ldexp(self, exponent: i32) -> Self {
                Self::observe(Operation::Scale { exponent }, &[self], self.inner().ldexp(exponent))
            }

            #[inline]
            fn from_phase(phase: u64, exponent: i32) -> Self {
                Self::phase(phase, exponent, <Self as Wrapper>::Inner::from_phase(phase, exponent))
            }

            #[inline]
            fn fraction(phase: u64) -> Self {
                Self::phase(phase, 0, <Self as Wrapper>::Inner::fraction(phase))
            }

            fn power_of_two(exponent: i32) -> Self {
                Self::bound(<Self as Wrapper>::Inner::power_of_two(exponent))
            }

            #[inline]
            fn to_phase(self, exponent: i32) -> u64 {
                let result = self.inner().to_phase(exponent);
                <Self as Wrapper>::to_phase(self, exponent, result);
                result
            }

            fn place_to_phase(self) -> Option<u64> {
                let result = self.inner().place_to_phase();
                <Self as Wrapper>::to_phase(self, 0, result.unwrap_or(u64::MAX));
                result
            }

            fn is_part(self) -> bool {
                let one = <Self as num_traits::One>::one();
                Self::compared(self, one, self.inner().partial_cmp(&one.inner()));
                let holds = self.inner().is_part();
                Self::decided(self, one, holds);
                holds
            }

            #[inline]
            fn max(self, other: Self) -> Self {
                Self::selecting(|| if other > self { other } else { self })
            }

            #[inline]
            fn min(self, other: Self) -> Self {
                Self::selecting(|| if other < self { other } else { self })
            }

            #[inline]
            fn abs(self) -> Self {
                Self::selecting(|| if self < num_traits::Zero::zero() { -self } else { self })
            }

            fn is_finite(self) -> bool {
                self.inner().is_finite()
            }

            fn signal(self, name: &'static str) -> Self {
                self.named(name)
            }
        }

        impl<$($generics)*> Backend for $wrapper {
            fn name() -> crate::FormatName {
                <Self as Wrapper>::Inner::name()
            }

            fn from_f64_pair(high: f64, low: f64) -> Option<Self> {
                <Self as Wrapper>::Inner::from_f64_pair(high, low).map(Self::converted)
            }

            fn to_f64_pair(self) -> (f64, f64) {
                self.inner().to_f64_pair()
            }
        }
    };
}

pub(crate) use wrapper;
