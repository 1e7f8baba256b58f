//! The counting wrapper: the same values, with the operations counted by kind.

use std::cell::Cell;
use std::cmp::Ordering;

use crate::wrapper::{Wrapper, wrapper};
use crate::{Backend, Operation};

/// How many operations of each kind [`OperationCounts::of`] has seen.
///
/// Constants (`zero`, `from_ratio`, …) are compiled in and count nothing. `half` counts as a `scale`; `max` and `min` are a
/// comparison; `abs` is a comparison and, below zero, a `neg`.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct OperationCounts {
    /// `a + b`.
    pub add: u64,
    /// `a - b`.
    pub sub: u64,
    /// `-a`.
    pub neg: u64,
    /// `a * b`.
    pub mul: u64,
    /// `a * b + c`.
    pub mul_add: u64,
    /// Sums of products.
    pub sum_of_products: u64,
    /// Products in sums of products.
    pub sum_of_products_terms: u64,
    /// `a / b`.
    pub div: u64,
    /// Square roots.
    pub sqrt: u64,
    /// Norms.
    pub norm: u64,
    /// Squares in norms.
    pub norm_terms: u64,
    /// Multiplications by powers of two.
    pub scale: u64,
    /// Comparisons, also those with zero.
    pub compare: u64,
    /// Conversions from and to phases and from floats.
    pub convert: u64,
}

thread_local! {
    static COUNTS: Cell<OperationCounts> = const {
        Cell::new(OperationCounts {
            add: 0,
            sub: 0,
            neg: 0,
            mul: 0,
            mul_add: 0,
            sum_of_products: 0,
            sum_of_products_terms: 0,
            div: 0,
            sqrt: 0,
            norm: 0,
            norm_terms: 0,
            scale: 0,
            compare: 0,
            convert: 0,
        })
    };
}

impl OperationCounts {
    /// Runs `work`. Returns its result, and the operations that the [`Counted`] numbers of this thread did meanwhile.
    ///
    /// An inner call keeps a count of its own, which the outer call does not see.
    pub fn of<T>(work: impl FnOnce() -> T) -> (T, OperationCounts) {
        let outer = COUNTS.take();
        let result = work();
        (result, COUNTS.replace(outer))
    }

    /// Operations of all kinds. A sum of products and a norm are one each.
    #[must_use]
    pub const fn total(&self) -> u64 {
        self.add
            + self.sub
            + self.neg
            + self.mul
            + self.mul_add
            + self.sum_of_products
            + self.div
            + self.sqrt
            + self.norm
            + self.scale
            + self.compare
            + self.convert
    }

    /// Products: of `mul` and `mul_add`, and the terms of sums and norms.
    #[must_use]
    pub const fn products(&self) -> u64 {
        self.mul + self.mul_add + self.sum_of_products_terms + self.norm_terms
    }

    /// Counts one operation that has `operands` operands.
    pub(crate) fn count(&mut self, operation: Operation, operands: usize) {
        let operands = operands as u64;
        match operation {
            Operation::Add => self.add += 1,
            Operation::Sub => self.sub += 1,
            Operation::Neg => self.neg += 1,
            Operation::Mul => self.mul += 1,
            Operation::MulAdd => self.mul_add += 1,
            Operation::SumOfProducts => {
                self.sum_of_products += 1;
                self.sum_of_products_terms += operands / 2;
            }
            Operation::Div => self.div += 1,
            Operation::Sqrt => self.sqrt += 1,
            Operation::Norm => {
                self.norm += 1;
                self.norm_terms += operands;
            }
            Operation::Scale { .. } => self.scale += 1,
        }
    }

    fn note(change: impl FnOnce(&mut OperationCounts)) {
        let mut counts = COUNTS.get();
        change(&mut counts);
        COUNTS.set(counts);
    }
}

/// A backend that counts: computes exactly as `R` does, and counts in the [`OperationCounts`] of its thread.
#[derive(Clone, Copy, Debug, Default)]
pub struct Counted<R>(pub R);

impl<R: Backend> Wrapper for Counted<R> {
    type Inner = R;

    fn inner(self) -> R {
        self.0
    }

    fn constant(value: R) -> Self {
        Self(value)
    }

    fn observe(operation: Operation, operands: &[Self], result: R) -> Self {
        OperationCounts::note(|counts| counts.count(operation, operands.len()));
        Self(result)
    }

    fn compared(_left: Self, _right: Self, _outcome: Option<Ordering>) {
        OperationCounts::note(|counts| counts.compare += 1);
    }

    fn converted(result: R) -> Self {
        OperationCounts::note(|counts| counts.convert += 1);
        Self(result)
    }

    fn phase(_phase: u64, _exponent: i32, result: R) -> Self {
        OperationCounts::note(|counts| counts.convert += 1);
        Self(result)
    }

    fn to_phase(_value: Self, _exponent: i32, _result: u64) {
        OperationCounts::note(|counts| counts.convert += 1);
    }
}

wrapper!(impl[R: Backend] Counted<R>);

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{I16F16, Real};
    use num_traits::{One, Zero};

    type Number = Counted<I16F16>;

    #[test]
    fn every_kind_is_counted_once() {
        let (x, y) = (Number::from_ratio(3, 2), Number::from_ratio(5, 2));
        let ((), counts) = OperationCounts::of(|| {
            let _ = (x + y, x - y, -x, x * y, x.mul_add(y, x), x / y, x.sqrt(), x.half());
            let _ = Number::sum_of_products([(x, y), (y, x), (x, x)]);
            let _ = Number::norm(&[x, y]);
            let _ = (x < y, x == y, x.is_zero());
            let _ = (Number::from_f64(1.0), Number::from_phase(1 << 63, 0), x.to_phase(0), x.to_f64());
        });
        let expected = OperationCounts {
            add: 1,
            sub: 1,
            neg: 1,
            mul: 1,
            mul_add: 1,
            sum_of_products: 1,
            sum_of_products_terms: 3,
            div: 1,
            sqrt: 1,
            norm: 1,
            norm_terms: 2,
            scale: 1,
            compare: 3,
            convert: 3,
        };
        assert_eq!(counts, expected);
        assert_eq!((counts.total(), counts.products()), (16, 7));
    }

    #[test]
    fn constants_count_nothing_and_provided_methods_what_they_do() {
        let (_, counts) = OperationCounts::of(|| (Number::zero(), Number::one(), Number::from_ratio(1, 3)));
        assert_eq!(counts, OperationCounts::default());
        let x = Number::from_ratio(-1, 2);
        let (_, counts) = OperationCounts::of(|| (x.abs(), Real::max(x, x), Real::min(x, x)));
        assert_eq!(counts, OperationCounts { compare: 3, neg: 1, ..OperationCounts::default() });
    }

    #[test]
    fn counts_nest() {
        let x = Number::from_ratio(1, 2);
        let (inner, outer) = OperationCounts::of(|| {
            let _ = x + x;
            OperationCounts::of(|| x * x).1
        });
        assert_eq!(inner, OperationCounts { mul: 1, ..OperationCounts::default() });
        assert_eq!(outer, OperationCounts { add: 1, ..OperationCounts::default() });
    }
}
