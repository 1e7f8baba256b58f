//! The shadowing wrapper: the same values, each beside its value in a better format.
//!
//! Comparisons compare the backend's values, so that the shadow takes the same branches. The distance between value and
//! shadow is then the rounding of everything before it, not the difference between two runs.

use crate::wrapper::{Wrapper, with_each, wrapper};
use crate::{Audit, Backend, Operation};

/// A number in `R` with its shadow in `S`. The shadow is the result of the same operations in `S`, on inputs and
/// constants in `S`.
///
/// Wherever a kernel names a [`signal`](crate::Real::signal), the distance between value and shadow is noted as the
/// [`max_error`](crate::SignalRange::max_error) of that name in the [`Audit`] of the thread. Around an
/// [`Audited`](crate::Audited) backend, one run gives both ranges and errors. Distances are computed in f64, to a few
/// units of the last place of the distance itself.
///
/// ```
/// use real::{Audit, Audited, Backend, I16F16, Real, Shadowed};
///
/// let (_, audit) = Audit::of(|| {
///     let x = Shadowed::<Audited<I16F16>>::from_f64(181.5).unwrap();
///     (x * x).signal("x²") // 32 942.25: beyond ±32 768
/// });
/// assert_eq!(audit.signals["x²"].overflows, 1);
/// assert_eq!(audit.signals["x²"].max_error, Some(65_536.0)); // it wrapped
/// ```
#[derive(Clone, Copy, Debug, Default)]
pub struct Shadowed<R, S = f64> {
    /// The backend's value, which kernels compute with, compare and hand on.
    pub value: R,
    /// The value in the better format.
    pub shadow: S,
}

impl<R: Backend, S: Backend> Shadowed<R, S> {
    /// A number with a shadow of its own: an input before it was rounded, say.
    #[must_use]
    pub fn new(value: R, shadow: S) -> Self {
        Self { value, shadow }
    }

    /// `|value - shadow|`; infinite if either is not finite.
    #[must_use]
    pub fn error(self) -> f64 {
        if !(self.value.is_finite() && self.shadow.is_finite()) {
            return f64::INFINITY;
        }
        let (value, shadow) = (self.value.to_f64_pair(), self.shadow.to_f64_pair());
        ((value.0 - shadow.0) + (value.1 - shadow.1)).abs()
    }
}

impl<R: Backend, S: Backend> Wrapper for Shadowed<R, S> {
    type Inner = R;

    fn inner(self) -> R {
        self.value
    }

    fn constant(value: R) -> Self {
        let (high, low) = value.to_f64_pair();
        Self::converted(high, low, value)
    }

    fn observe(operation: Operation, operands: &[Self], result: R) -> Self {
        Self { value: result, shadow: with_each(operands, |x| x.shadow, |x| operation.apply(x)) }
    }

    fn ratio(numerator: i32, denominator: i32, result: R) -> Self {
        Self { value: result, shadow: S::from_ratio(numerator, denominator) }
    }

    fn converted(high: f64, low: f64, result: R) -> Self {
        Self { value: result, shadow: S::from_f64_pair(high, low).unwrap_or_else(S::max_value) }
    }

    fn phase(phase: u64, exponent: i32, result: R) -> Self {
        Self { value: result, shadow: S::from_phase(phase, exponent) }
    }

    fn named(self, name: &'static str) -> Self {
        Audit::note_error(name, self.error());
        Self { value: self.value.signal(name), ..self }
    }
}

wrapper!(impl[R: Backend, S: Backend] Shadowed<R, S>);

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{Audited, I16F16, Real};
    use num_traits::{Bounded, One};
    #[cfg(feature = "reference")]
    use proptest::prelude::*;

    type Number = Shadowed<I16F16>;

    #[test]
    fn the_shadow_does_the_same_operations() {
        let third = Number::from_ratio(1, 3);
        assert_eq!(third.shadow, 1.0 / 3.0);
        let seven = Number::from_f64(7.0).unwrap();
        let results = [
            (third + seven, 1.0 / 3.0 + 7.0),
            (third - seven, 1.0 / 3.0 - 7.0),
            (-third, -1.0 / 3.0),
            (third * seven, 1.0 / 3.0 * 7.0),
            (third / seven, 1.0 / 3.0 / 7.0),
            (third.mul_add(seven, third), 1.0 / 3.0 * 7.0 + 1.0 / 3.0),
            (third.sqrt(), (1.0_f64 / 3.0).sqrt()),
            (third.ldexp(-4), 1.0 / 48.0),
            (Number::norm(&[third, seven]), f64::norm(&[1.0 / 3.0, 7.0])),
            (Number::sum_of_products([(third, seven); 3]), f64::sum_of_products([(1.0 / 3.0, 7.0); 3])),
            (Number::from_phase(3 << 62, 0), 0.75),
        ];
        for (i, (number, shadow)) in results.into_iter().enumerate() {
            assert_eq!(number.shadow, shadow, "result {i}");
            assert!(number.error() > 0.0 || number.value.to_f64() == shadow, "result {i}");
            assert!(number.error() < 8.0 * I16F16::resolution().to_f64(), "result {i}: {}", number.error());
        }
    }

    /// A third is wrong by a third of a unit of I16F16, which three times the value makes a whole one.
    #[test]
    fn the_largest_error_of_a_signal_is_recorded() {
        let (_, audit) = Audit::of(|| {
            let third = Number::from_ratio(1, 3).signal("x");
            let _ = (Number::one().signal("x"), (third + third + third).signal("y"));
            Number::one().signal("exact")
        });
        let error = |name| audit.signals[name].max_error.unwrap() / I16F16::resolution().to_f64();
        assert!((error("x") - 1.0 / 3.0).abs() < 1e-9, "{}", error("x"));
        assert!((error("y") - 1.0).abs() < 1e-9, "{}", error("y"));
        assert_eq!(error("exact"), 0.0);
    }

    #[test]
    fn one_run_gives_ranges_and_errors() {
        type Both = Shadowed<Audited<I16F16>>;
        let (_, audit) = Audit::of(|| {
            let x = Both::from_f64(200.0).unwrap().signal("x");
            (x * x).signal("x²")
        });
        assert_eq!((audit.overflows, audit.signals["x²"].overflows, audit.signals["x"].count), (1, 1, 1));
        assert_eq!((audit.signals["x"].max, audit.signals["x"].max_error), (200.0, Some(0.0)));
        assert_eq!(audit.signals["x²"].max_error, Some(65_536.0)); // 40 000 wrapped to -25 536
        let (_, plain) = Audit::of(|| Audited(I16F16::one()).signal("x"));
        assert_eq!(plain.signals["x"].max_error, None);
    }

    #[test]
    fn comparisons_follow_the_value() {
        let below = Number::new(I16F16::one(), 2.0);
        let above = Number::new(I16F16::from_ratio(3, 2), 1.0);
        assert!(below < above && below != above);
        assert_eq!(Real::max(below, above).shadow, 1.0);
        assert_eq!(below.to_phase(-1), 1 << 63);
    }

    #[test]
    fn what_is_not_finite_has_an_infinite_error() {
        let number: Shadowed<f32> = Shadowed::new(f32::MAX, 1.0);
        assert_eq!((number * number).error(), f64::INFINITY);
        assert_eq!(Shadowed::<f32>::max_value().error(), 0.0);
    }

    #[cfg(feature = "reference")]
    proptest! {
        /// Where f64 would see nothing: half a unit of I4F60.
        #[test]
        fn a_double_double_shadow_sees_the_last_bit_of_64(n in 1..1000_i32, d in 1001..2000_i32) {
            use crate::{DoubleDouble, I4F60};
            let number = Shadowed::<I4F60, DoubleDouble>::from_ratio(n, d);
            let units = number.error() / I4F60::resolution().to_f64();
            prop_assert!(units <= 0.5 + 1e-9, "{}", units);
            let remainder = (i128::from(n) << 60) % i128::from(d);
            let exact = remainder.min(i128::from(d) - remainder) as f64 / f64::from(d);
            prop_assert!((units - exact).abs() < 1e-9, "{} is not {}", units, exact);
        }
    }
}
