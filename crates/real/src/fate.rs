//! How a result in a number format differs from the exact one.

use crate::{Operation, Real};

/// How a result differs from the exact one.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Fate {
    /// It is the exact one, rounded.
    Rounded,
    /// It is zero, and the exact one is not.
    Vanished,
    /// It is not the exact one.
    Overflowed,
}

impl Fate {
    /// `result·unit` against `exact`, on a common scale where `unit > 0`.
    #[inline]
    pub(crate) fn of(result: i128, exact: i128, unit: i128) -> Self {
        Self::of_scaled((result, result * unit), exact, unit)
    }

    /// [`of`](Self::of) for a unit of 2^fraction_bits, by a shift.
    #[inline]
    fn of_product(result: i128, exact: i128, fraction_bits: u32) -> Self {
        Self::of_scaled((result, result << fraction_bits), exact, 1 << fraction_bits)
    }

    #[inline]
    fn of_scaled((result, scaled): (i128, i128), exact: i128, unit: i128) -> Self {
        match scaled.checked_sub(exact) {
            Some(distance) if -unit < distance && distance < unit => {
                if result == 0 && exact != 0 {
                    Self::Vanished
                } else {
                    Self::Rounded
                }
            }
            _ => Self::Overflowed,
        }
    }

    /// A result in fixed point, all numbers in units of the resolution `2^-fraction_bits`. No division by zero.
    /// `x(i)` is operand number i of `count`.
    #[inline(always)] // Into each operation, which is then known.
    pub(crate) fn in_fixed_point(
        operation: Operation,
        (x, count): (impl Fn(usize) -> i128, usize),
        result: i128,
        fraction_bits: impl Fn() -> u32,
    ) -> Self {
        match operation {
            Operation::Add => Self::of(result, x(0) + x(1), 1),
            Operation::Sub => Self::of(result, x(0) - x(1), 1),
            Operation::Neg => Self::of(result, -x(0), 1),
            Operation::Mul => Self::of_product(result, x(0) * x(1), fraction_bits()),
            Operation::MulAdd => {
                let fraction_bits = fraction_bits();
                Self::of_product(result, x(0) * x(1) + (x(2) << fraction_bits), fraction_bits)
            }
            Operation::SumOfProducts => {
                // The sum may leave 128 bits and come back: every carry is counted.
                let products = (0..count / 2).map(|pair| x(2 * pair) * x(2 * pair + 1));
                let (sum, carries) = products.fold((0_i128, 0_i64), |(sum, carries), product| {
                    let (sum, carry) = sum.overflowing_add(product);
                    (sum, carries + i64::from(carry) * if product < 0 { -1 } else { 1 })
                });
                if carries == 0 { Self::of_product(result, sum, fraction_bits()) } else { Self::Overflowed }
            }
            Operation::Div => Self::of(result * x(1).signum(), x(0) << fraction_bits(), x(1).abs()),
            Operation::Sqrt => Self::of_root(result, x(0).max(0).unsigned_abs() << fraction_bits()),
            Operation::Norm => {
                let squares = (0..count).map(|i| x(i).unsigned_abs().pow(2));
                Self::of_root(result, squares.fold(0, u128::saturating_add))
            }
            Operation::Scale { exponent } => match exponent.unsigned_abs() {
                shift if exponent < 0 => Self::of(result, x(0), 1 << shift.min(100)),
                // -1 by 2^63 is the least word.
                shift if shift <= 63 => Self::of(result, x(0) << shift, 1),
                _ => Self::of(i128::from(x(0) != 0), 0, 1), // nothing but zero fits
            },
        }
    }

    /// `result` against `√square`: a root can only be too small.
    fn of_root(result: i128, square: u128) -> Self {
        let next = result.unsigned_abs() + 1;
        if next * next <= square { Self::Overflowed } else { Self::Rounded }
    }

    /// A result in a float; `x` as for fixed point. No division by zero.
    #[inline(always)]
    pub(crate) fn in_float<R: Real>(
        operation: Operation,
        (x, count): (impl Fn(usize) -> R, usize),
        result: R,
    ) -> Self {
        if !result.is_finite() {
            return Self::Overflowed;
        }
        if !result.is_zero() {
            return Self::Rounded;
        }
        let vanishes = |a: R, b: R| !a.is_zero() && !b.is_zero();
        let vanished = match operation {
            Operation::Mul => vanishes(x(0), x(1)),
            Operation::MulAdd => x(2).is_zero() && vanishes(x(0), x(1)),
            Operation::SumOfProducts => {
                let mut products = (0..count / 2).map(|pair| (x(2 * pair), x(2 * pair + 1)));
                products.clone().all(|(a, b)| (a * b).is_zero()) && products.any(|(a, b)| vanishes(a, b))
            }
            Operation::Div => !x(0).is_zero() && x(1).is_finite(),
            Operation::Scale { .. } => !x(0).is_zero(),
            _ => false,
        };
        if vanished { Self::Vanished } else { Self::Rounded }
    }
}
