//! The auditing wrapper: the same values, with overflows and underflows counted and the range of every named signal recorded.
//!
//! The wrapper hands on the backend's result unchanged. Beside it, it forms the exact result, in integers for fixed
//! point, and checks whether the two differ by more than rounding.

use crate::audit::thread_record::{note_division_by_zero, note_fate, note_signal};
use crate::audit::value::Value;
use crate::fate::Fate;
use crate::wrapper::{Wrapper, wrapper};
use crate::{Backend, Operation};

/// A backend under audit: computes exactly as `R` does, and counts in the [`Audit`](crate::Audit) of its thread.
#[derive(Clone, Copy, Debug, Default)]
pub struct Audited<R>(pub R);

impl<R: Backend> Wrapper for Audited<R> {
    type Inner = R;

    fn inner(self) -> R {
        self.0
    }

    fn constant(value: R) -> Self {
        Self(value)
    }

    #[inline(always)] // Into each operation, which is then known.
    fn observe(operation: Operation, operands: &[Self], result: R) -> Self {
        if operation == Operation::Div && operands[1].0.is_zero() {
            note_division_by_zero();
        } else if !R::IS_FLOATING {
            let (x, fraction_bits) = (|i: usize| units(operands[i].0), || R::fraction_bits().unwrap_or(0));
            note_fate(Fate::in_fixed_point(operation, (x, operands.len()), units(result), fraction_bits));
        } else {
            note_fate(Fate::in_float(operation, (|i: usize| operands[i].0, operands.len()), result));
        }
        Self(result)
    }

    fn ratio(numerator: i32, denominator: i32, result: R) -> Self {
        if denominator == 0 {
            note_division_by_zero();
        } else if let Some(fraction_bits) = R::fraction_bits() {
            let x = |i: usize| if i == 0 { numerator.into() } else { denominator.into() };
            note_fate(Fate::in_fixed_point(Operation::Div, (x, 2), units(result), || fraction_bits));
        }
        Self(result)
    }

    fn phase(phase: u64, exponent: i32, result: R) -> Self {
        if let Some(fraction_bits) = R::fraction_bits() {
            // In units: phase · 2^(exponent - 64 + f), of which the integer part has 126 bits at most.
            let shift = exponent.clamp(-64, 64) - 64 + fraction_bits.cast_signed();
            let (phase, result) = (i128::from(phase), units(result));
            if shift < 0 {
                note_fate(Fate::of(result, phase, 1 << shift.unsigned_abs().min(100)));
            } else {
                note_fate(Fate::of(result, phase << shift, 1));
            }
        }
        Self(result)
    }

    #[inline]
    fn named(self, name: &'static str) -> Self {
        let value = match (self.0.word(), R::fraction_bits()) {
            (Some(word), Some(fraction_bits)) => Value::Word(word, fraction_bits),
            _ => {
                let (high, low) = self.0.to_f64_pair();
                Value::Floats(high, low)
            }
        };
        note_signal(name, value);
        Self(self.0.signal(name))
    }
}

wrapper!(impl[R: Backend] Audited<R>);

/// A number of a backend in fixed point, in units of its resolution.
#[inline]
fn units<R: Backend>(number: R) -> i128 {
    number.word().unwrap_or(0).into()
}

#[cfg(test)]
pub(crate) mod examples {
    use super::Audited;
    use crate::{Backend, I16F16};

    pub(crate) fn audited(value: f64) -> Audited<I16F16> {
        Audited::from_f64(value).expect("the value fits")
    }
}

#[cfg(test)]
mod tests {
    use super::examples::audited;
    use super::*;
    use crate::{Audit, I4F4, I4F60, I16F16, Real};
    use num_traits::Bounded;

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
    fn a_float_overflow_is_an_infinity() {
        let (_, audit) = Audit::of(|| Audited(1e30_f32) * Audited(1e30_f32));
        assert_eq!(audit.overflows, 1);
    }

    /// Every pair of I4F4: an overflow is counted where the rounded exact result is outside the range, an underflow where
    /// zero stands for something else. Quotients saturate: clipped by less than a unit they are as good as rounded.
    #[test]
    fn events_are_counted_exactly() {
        let check = |what: &str, operation: &dyn Fn() -> Audited<I4F4>, exact_16ths: f64, clip: f64| {
            let (result, audit) = Audit::of(operation);
            let overflow = exact_16ths < -128.0 - clip || exact_16ths >= 127.0 + clip;
            let underflow = !overflow && exact_16ths != 0.0 && result.0.to_bits() == 0;
            assert_eq!((audit.overflows, audit.underflows), (overflow.into(), underflow.into()), "{what}");
        };
        for (a, b) in (i8::MIN..=i8::MAX).flat_map(|a| (i8::MIN..=i8::MAX).map(move |b| (a, b))) {
            let [x, y] = [a, b].map(|bits| Audited(I4F4::from_bits(bits)));
            let [a, b] = [a, b].map(f64::from);
            check("+", &|| x + y, a + b, 0.5);
            check("-", &|| x - y, a - b, 0.5);
            check("*", &|| x * y, a * b / 16.0, 0.5);
            check("mul_add", &|| x.mul_add(y, y), a * b / 16.0 + b, 0.5);
            check("sum", &|| Real::sum_of_products([(x, y), (x, x)]), (a * b + a * a) / 16.0, 0.5);
            if b != 0.0 {
                // -129 is one unit off, +128 too.
                let exact = a / b * 16.0;
                check("/", &|| x / y, if exact <= -129.0 { -200.0 } else { exact.max(-128.0) }, 1.0);
            }
            check("norm", &|| Real::norm(&[x, y]), a.hypot(b), 1.0);
            if b == 0.0 {
                check("-", &|| -x, -a, 0.5);
                check("√", &|| x.sqrt(), (a.max(0.0) * 16.0).sqrt(), 0.5);
                for exponent in -126..=126 {
                    check("ldexp", &|| x.ldexp(exponent), a * 2.0_f64.powi(exponent), 0.5);
                }
            }
        }
        for (n, d) in (-200..200).flat_map(|n| (1..40).map(move |d| (n, d))) {
            let exact = f64::from(n) / f64::from(d) * 16.0;
            let exact = if exact <= -129.0 { -200.0 } else { exact.max(-128.0) };
            check("ratio", &|| Audited::from_ratio(n, d), exact, 1.0);
        }
        for (phase, exponent) in
            [0, 1, 3 << 58, 1 << 62, u64::MAX << 11].into_iter().flat_map(|p| (-64..=64).map(move |e| (p, e)))
        {
            let exact = phase as f64 * 2.0_f64.powi(exponent - 60);
            check("phase", &|| Audited::from_phase(phase, exponent), exact, 1.0);
        }
    }

    /// The widest words: products of 128 bits, sums of them beyond, values that f64 rounds.
    #[test]
    fn events_are_counted_exactly_in_64_bits() {
        let number = |bits: i64| Audited(I4F60::from_bits(bits));
        let events = |operation: &dyn Fn() -> Audited<I4F60>| {
            let (_, audit) = Audit::of(operation);
            (audit.overflows, audit.underflows)
        };
        let (least, greatest, one) = (number(i64::MIN), number(i64::MAX), number(1 << 60));
        assert_eq!(events(&|| greatest + number(1)), (1, 0));
        assert_eq!(events(&|| greatest - number(1)), (0, 0));
        assert_eq!(events(&|| greatest * one), (0, 0));
        assert_eq!(events(&|| greatest.mul_add(one, number(1))), (1, 0));
        assert_eq!(events(&|| greatest / one), (0, 0));
        assert_eq!(events(&|| least / -one), (1, 0));
        assert_eq!(events(&|| -least), (1, 0));
        assert_eq!(events(&|| Real::sum_of_products([(least, least); 5])), (1, 0));
        assert_eq!(
            events(&|| Real::sum_of_products([(greatest, one), (number(1), one), (number(-1), one)])),
            (0, 0)
        );
        assert_eq!(events(&|| number(1 << 30).mul_add(number(1 << 29), number(0))), (0, 0)); // half a unit goes up
        assert_eq!(events(&|| number(1 << 30).mul_add(number(1 << 28), number(0))), (0, 1));
        assert_eq!(events(&|| Real::norm(&[least; 20])), (1, 0));
        assert_eq!(number(-1).ldexp(63).0, least.0);
        assert_eq!(events(&|| number(-1).ldexp(63)), (0, 0));
        for (x, exponent) in [(number(1), 63), (least, 63), (number(-1), 64), (least, i32::MAX)] {
            assert_eq!(events(&|| x.ldexp(exponent)), (1, 0), "{x:?} by 2^{exponent}");
        }
    }

    #[test]
    fn a_saturating_format_overflows_like_a_wrapping_one() {
        use crate::{Overflow, Rounding, RuntimeFixed, RuntimeFormat};
        for overflow in [Overflow::Wrap, Overflow::Saturate] {
            let format = RuntimeFormat::with_any_point(8, 10, Rounding::Floor, overflow).unwrap();
            let (_, audit) = format.run::<0, _>(|| {
                let x = Audited(RuntimeFixed::<0>::max_value());
                Audit::of(|| (x + x, x * x)) // 127·127/1024 = 15.75 units
            });
            assert_eq!(audit.overflows, 1);
        }
    }

    #[test]
    fn floats_underflow_to_zero() {
        let tiny = Audited(1e-30_f32);
        let events = |operation: &dyn Fn() -> Audited<f32>| {
            let (_, audit) = Audit::of(operation);
            (audit.overflows, audit.underflows)
        };
        assert_eq!(events(&|| tiny * tiny), (0, 1));
        assert_eq!(events(&|| tiny / Audited(1e30)), (0, 1));
        assert_eq!(events(&|| tiny.ldexp(-126)), (0, 1));
        assert_eq!(events(&|| tiny.mul_add(tiny, Audited(0.0))), (0, 1));
        assert_eq!(events(&|| Real::sum_of_products([(tiny, tiny), (tiny, Audited(0.0))])), (0, 1));
        assert_eq!(events(&|| Real::sum_of_products([(tiny, Audited(1.0)), (tiny, Audited(-1.0))])), (0, 0));
        assert_eq!(events(&|| tiny - tiny), (0, 0));
        assert_eq!(events(&|| Audited(0.0) * tiny), (0, 0));
        assert_eq!(events(&|| tiny.mul_add(Audited(1.0), -tiny)), (0, 0));
        assert_eq!(events(&|| Audited(1.0) / (Audited(1e30) * Audited(1e30))), (1, 0)); // 1/∞ is exactly 0
    }

    #[test]
    fn no_value_is_changed() {
        let numbers = |x: i32, y: i32| [I16F16::from_bits(x), I16F16::from_bits(y)];
        let mut random = 1_i32;
        for _ in 0..10_000 {
            random = random.wrapping_mul(1_103_515_245).wrapping_add(12_345);
            let [x, y] = numbers(random, random.rotate_left(11) >> (random & 15));
            let [a, b] = [x, y].map(Audited);
            let audited = [a + b, a - b, -a, a * b, a / b, a.mul_add(b, a), a.sqrt(), a.ldexp(random % 20)];
            assert_eq!(
                audited.map(|r| r.0),
                [x + y, x - y, -x, x * y, x / y, x.mul_add(y, x), x.sqrt(), x.ldexp(random % 20)]
            );
            assert_eq!(Real::norm(&[a, b]).0, Real::norm(&[x, y]));
            let terms = 1 + (random & 31).unsigned_abs() as usize; // also more than the stack holds
            let sum = Audited::sum_of_products(std::iter::repeat_n((a, b), terms));
            assert_eq!(sum.0, I16F16::sum_of_products(std::iter::repeat_n((x, y), terms)));
            assert_eq!((a < b, a == b, a.to_phase(-9)), (x < y, x == y, x.to_phase(-9)));
        }
    }
}
