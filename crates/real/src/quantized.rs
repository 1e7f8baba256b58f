//! Registers of different widths: every named signal is rounded to a format of its own.
//!
//! In hardware each register has its own word length, and an operator takes whatever lengths its registers have.
//! [`Quantized`] computes in f64, whose 53 bits are more than any register it is used for. It rounds wherever a kernel
//! names a [`signal`](crate::Real::signal). So a kernel runs in mixed formats without a change.

use std::cell::RefCell;
use std::ops::{Add, Div, Mul, Neg, Sub};

use num_traits::{Bounded, One, Zero};

use crate::{Backend, FormatName, Real, Rounding};

/// An f64 whose named signals are rounded to the registers that [`Quantized::run`] is given.
#[derive(Clone, Copy, Debug, Default, PartialEq, PartialOrd)]
pub struct Quantized(f64);

/// How signals are rounded, and the name and the fraction bits of each register.
type Registers = (Rounding, Vec<(&'static str, i32)>);

thread_local! {
    static REGISTERS: RefCell<Registers> = const { RefCell::new((Rounding::Nearest, Vec::new())) };
}

impl Quantized {
    /// Runs `work` with these registers on this thread. A register is a signal's name and its fraction bits. All round
    /// in one way; to nearest, ties go up. Signals without a register are not rounded. After the call, also after a
    /// panic, the former registers are in force again.
    pub fn run<T>(rounding: Rounding, registers: &[(&'static str, i32)], work: impl FnOnce() -> T) -> T {
        struct Restore(Registers);
        impl Drop for Restore {
            fn drop(&mut self) {
                REGISTERS.set(std::mem::take(&mut self.0));
            }
        }
        let _restore = Restore(REGISTERS.replace((rounding, registers.to_vec())));
        work()
    }

    fn rounded(self, rounding: Rounding, fraction_bits: i32) -> Self {
        let units = self.0.ldexp(fraction_bits);
        let whole = match rounding {
            // `(units + 0.5).floor()` would round twice, because the sum rounds.
            Rounding::Nearest => units.floor() + if units - units.floor() >= 0.5 { 1.0 } else { 0.0 },
            Rounding::NearestEven => units.round_ties_even(),
            Rounding::Floor => units.floor(),
            Rounding::TowardZero => units.trunc(),
        };
        Self(whole.ldexp(-fraction_bits))
    }
}

impl Add for Quantized {
    type Output = Self;
    fn add(self, other: Self) -> Self {
        Self(self.0 + other.0)
    }
}

impl Sub for Quantized {
    type Output = Self;
    fn sub(self, other: Self) -> Self {
        Self(self.0 - other.0)
    }
}

impl Mul for Quantized {
    type Output = Self;
    fn mul(self, other: Self) -> Self {
        Self(self.0 * other.0)
    }
}

impl Div for Quantized {
    type Output = Self;
    fn div(self, other: Self) -> Self {
        Self(self.0 / other.0)
    }
}

impl Neg for Quantized {
    type Output = Self;
    fn neg(self) -> Self {
        Self(-self.0)
    }
}

impl Zero for Quantized {
    fn zero() -> Self {
        Self(0.0)
    }
    fn is_zero(&self) -> bool {
        self.0 == 0.0
    }
}

impl One for Quantized {
    fn one() -> Self {
        Self(1.0)
    }
}

impl Bounded for Quantized {
    fn min_value() -> Self {
        Self(f64::MIN)
    }
    fn max_value() -> Self {
        Self(f64::MAX)
    }
}

impl Real for Quantized {
    fn resolution() -> Self {
        Self(f64::EPSILON)
    }

    fn from_ratio(numerator: i32, denominator: i32) -> Self {
        Self(f64::from_ratio(numerator, denominator))
    }

    fn mul_add(self, factor: Self, addend: Self) -> Self {
        Self(Real::mul_add(self.0, factor.0, addend.0))
    }

    fn sum_of_products(pairs: impl IntoIterator<Item = (Self, Self)>) -> Self {
        Self(f64::sum_of_products(pairs.into_iter().map(|(a, b)| (a.0, b.0))))
    }

    fn norm<const N: usize>(vector: &[Self; N]) -> Self {
        Self(f64::norm(&vector.map(|v| v.0)))
    }

    fn sqrt(self) -> Self {
        Self(Real::sqrt(self.0))
    }

    fn ldexp(self, exponent: i32) -> Self {
        Self(self.0.ldexp(exponent))
    }

    fn from_phase(phase: u64, exponent: i32) -> Self {
        Self(f64::from_phase(phase, exponent))
    }

    fn fraction(phase: u64) -> Self {
        Self(f64::fraction(phase))
    }

    fn to_phase(self, exponent: i32) -> u64 {
        self.0.to_phase(exponent)
    }

    fn is_finite(self) -> bool {
        self.0.is_finite()
    }

    fn signal(self, name: &'static str) -> Self {
        REGISTERS.with_borrow(|(rounding, all)| {
            let register = all.iter().find(|(known, _)| *known == name);
            register.map_or(self, |(_, fraction_bits)| self.rounded(*rounding, *fraction_bits))
        })
    }
}

impl Backend for Quantized {
    fn name() -> FormatName {
        FormatName::Float { bits: 64 }
    }

    fn from_f64_pair(high: f64, low: f64) -> Option<Self> {
        f64::from_f64_pair(high, low).map(Self)
    }

    fn to_f64_pair(self) -> (f64, f64) {
        (self.0, 0.0)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::I8F24;

    #[test]
    fn a_named_signal_is_rounded_to_its_register_and_no_other() {
        Quantized::run(Rounding::Nearest, &[("coarse", 4)], || {
            let third = Quantized(1.0 / 3.0);
            assert_eq!(third.signal("coarse"), Quantized(5.0 / 16.0));
            assert_eq!(third.signal("fine"), third);
            assert_eq!(Quantized(3.0 / 32.0).signal("coarse"), Quantized(2.0 / 16.0)); // a tie goes up
        });
        assert_eq!(Quantized(1.0 / 3.0).signal("coarse"), Quantized(1.0 / 3.0));
    }

    /// Of -1.5, -0.3, 0.5 and 2.5.
    #[test]
    fn registers_are_rounded_in_each_way() {
        for (rounding, expected) in [
            (Rounding::Nearest, [-1.0, 0.0, 1.0, 3.0]),
            (Rounding::NearestEven, [-2.0, 0.0, 0.0, 2.0]),
            (Rounding::Floor, [-2.0, -1.0, 0.0, 2.0]),
            (Rounding::TowardZero, [-1.0, 0.0, 0.0, 2.0]),
        ] {
            let found = Quantized::run(rounding, &[("whole", 0)], || {
                [-1.5, -0.3, 0.5, 2.5].map(|x| Quantized(x).signal("whole").0)
            });
            assert_eq!(found, expected, "{rounding:?}");
        }
    }

    #[test]
    fn it_is_rounded_once_and_registers_end_with_their_run() {
        let panicked = std::panic::catch_unwind(|| {
            Quantized::run(Rounding::Nearest, &[("whole", 0), ("wide", 52)], || {
                assert_eq!(Quantized(0.5_f64.next_down()).signal("whole"), Quantized(0.0));
                assert_eq!(Quantized(-0.5).signal("whole"), Quantized(0.0));
                // An odd number of units beyond 2⁵².
                let odd = Quantized(1.0 + f64::EPSILON);
                assert_eq!(odd.signal("wide"), odd);
                panic!("in a run");
            })
        });
        assert!(panicked.is_err());
        assert_eq!(Quantized(0.3).signal("whole"), Quantized(0.3));
    }

    /// With every result named and 24 fraction bits, it is the fixed-point format.
    #[test]
    fn with_one_width_for_all_it_is_a_fixed_point_format() {
        Quantized::run(Rounding::Nearest, &[("x", 24)], || {
            let (mut x, mut y) = (Quantized(0.7).signal("x"), I8F24::from_f64(0.7).unwrap());
            for i in 1..200 {
                let factor = f64::from(i).recip() + 0.9;
                x = (x * Quantized(factor).signal("x")).signal("x");
                y = y * I8F24::from_f64(factor).unwrap();
                assert_eq!(x.to_f64(), y.to_f64(), "step {i}");
            }
        });
    }
}
