//! What an audit shows of a run as a whole: whether its numbers fit, and how many integer bits they need.

use crate::Real;

/// The numbers that a run lost, and the range of all its named signals together.
///
/// It takes less time than an [`Audit`](crate::Audit), which keeps each signal by its name.
///
/// ```
/// use real::{Audited, Backend, Extremes, I8F24, Real};
///
/// let x = Audited::<I8F24>::from_f64(-9.5).unwrap();
/// let (_, found) = Extremes::of(|| x.signal("x"));
/// assert_eq!((found.min, found.max, found.integer_bits_needed()), (-9.5, -9.5, 5));
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Extremes {
    /// As [`Audit::overflows`](crate::Audit::overflows).
    pub overflows: u64,
    /// As [`Audit::divisions_by_zero`](crate::Audit::divisions_by_zero).
    pub divisions_by_zero: u64,
    /// Least value of any signal; cut toward zero if it has more bits than an f64, infinite if no signal was named.
    pub min: f64,
    /// Greatest value of any signal; cut in the same way, and minus infinity if no signal was named.
    pub max: f64,
}

impl Default for Extremes {
    fn default() -> Self {
        Self { overflows: 0, divisions_by_zero: 0, min: f64::INFINITY, max: f64::NEG_INFINITY }
    }
}

impl Extremes {
    /// Adds what another part of the same run met.
    pub fn join(&mut self, other: Self) {
        self.overflows += other.overflows;
        self.divisions_by_zero += other.divisions_by_zero;
        self.include(other.min, other.max);
    }

    pub(crate) fn include(&mut self, min: f64, max: f64) {
        (self.min, self.max) = (self.min.min(min), self.max.max(max));
    }

    /// Integer bits, the sign included, that the signal with the largest values needs: a value v fits n of them when
    /// -2^(n-1) ≤ v < 2^(n-1). It is 1 if no signal was named, and 129 if a value needs more than 128.
    #[must_use]
    pub fn integer_bits_needed(&self) -> u32 {
        let fits = |bits: &i32| {
            let bound = 1.0_f64.ldexp(bits - 1);
            self.min >= -bound && self.max < bound
        };
        (1..=128).find(fits).unwrap_or(129).unsigned_abs()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::audit::audited::examples::audited;
    use crate::{Audit, Audited, Backend, I4F4, I4F60, I16F16};
    use num_traits::Zero;
    use proptest::prelude::*;

    /// Signals, products that overflow or do not, and quotients, of numbers one after the other. What is not finite comes too.
    fn met<R: Backend>(numbers: &[(usize, f64)]) {
        let numbers = numbers.iter().filter_map(|(name, x)| Some((*name, Audited::<R>::from_f64(*x)?)));
        let _ = numbers.fold(Audited::<R>::zero(), |last, (name, x)| {
            let _ = (x * last).signal(["a", "b", "c"][name]);
            (x / last).signal(["c", "d", "a"][name])
        });
    }

    fn extremes_are_those_of_the_audit<R: Backend>(numbers: &[(usize, f64)]) -> Extremes {
        let ((), audit) = Audit::of(|| met::<R>(numbers));
        let ((), extremes) = Extremes::of(|| met::<R>(numbers));
        assert_eq!(extremes, Extremes::from(&audit));
        let widest = audit.signals.values().map(|range| {
            let held = |n: &i32| range.min >= -(2.0_f64.powi(n - 1)) && range.max < 2.0_f64.powi(n - 1);
            (1..=128).find(held).unwrap_or(129)
        });
        let expected = (audit.overflows, audit.divisions_by_zero, widest.max().unwrap_or(1).unsigned_abs());
        assert_eq!(
            (extremes.overflows, extremes.divisions_by_zero, extremes.integer_bits_needed()),
            expected
        );
        let (first, second) = numbers.split_at(numbers.len() / 2);
        let ((_, mut joined), (_, other)) =
            (Extremes::of(|| met::<R>(first)), Extremes::of(|| met::<R>(second)));
        let ((_, mut parts), (_, rest)) = (Audit::of(|| met::<R>(first)), Audit::of(|| met::<R>(second)));
        joined.join(other);
        parts.join(rest);
        assert_eq!(joined, Extremes::from(&parts));
        extremes
    }

    #[test]
    fn extremes_of_nothing_are_those_of_an_empty_audit() {
        assert_eq!(extremes_are_those_of_the_audit::<I16F16>(&[]), Extremes::default());
        assert_eq!(Extremes::default().integer_bits_needed(), 1);
    }

    #[test]
    fn extremes_count_what_overflows_and_what_does_not() {
        let quiet = extremes_are_those_of_the_audit::<I16F16>(&[(0, 2.0), (1, -3.0)]);
        assert_eq!((quiet.overflows, quiet.divisions_by_zero), (1, 1)); // 2/0 is an overflow too
        let lost = extremes_are_those_of_the_audit::<I4F4>(&[(0, 7.0), (1, 0.25), (2, -6.0), (0, 7.5)]);
        assert!(lost.overflows > 0);
        assert!(extremes_are_those_of_the_audit::<f32>(&[(0, 1e30), (1, 1e-30), (2, 1e30)]).overflows > 0);
    }

    #[test]
    fn a_record_within_extremes_is_kept_apart() {
        let (inner, outer) = Extremes::of(|| Audit::of(|| audited(300.0) * audited(300.0)).1);
        assert_eq!((inner.overflows, outer.overflows), (1, 0));
    }

    proptest! {
        #[test]
        fn extremes_are_those_of_any_audit(
            numbers in proptest::collection::vec((0..3_usize, prop_oneof![Just(0.0), -8.0..8.0, -1e4..1e4, Just(1e30)]), 0..30),
        ) {
            extremes_are_those_of_the_audit::<I4F4>(&numbers);
            extremes_are_those_of_the_audit::<I16F16>(&numbers);
            extremes_are_those_of_the_audit::<I4F60>(&numbers);
            extremes_are_those_of_the_audit::<f32>(&numbers);
            extremes_are_those_of_the_audit::<f64>(&numbers);
        }
    }
}
