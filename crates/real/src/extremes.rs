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
