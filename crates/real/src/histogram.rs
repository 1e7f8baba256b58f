//! How large the values of a signal were, by powers of two: which bits of a format they use.

/// Counts of values by the position of their leading bit.
///
/// Bin e counts the values with `2^e ≤ |v| < 2^(e+1)`. In a format of i integer and f fraction bits, bins from i - 1 on
/// are beyond the range and bins below -f beneath the resolution. Zeros have no bin.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Histogram {
    /// The exponent of the first count.
    first: i32,
    /// The counts of neighbouring bins; the first and the last are not zero.
    counts: Vec<u64>,
}

impl Histogram {
    /// Counts the value `high + low`, unless it is zero, infinite or NaN.
    pub fn include(&mut self, value: (f64, f64)) {
        self.include_times(value, 1);
    }

    /// Counts a value so many times.
    pub(crate) fn include_times(&mut self, (high, low): (f64, f64), times: u64) {
        if high != 0.0 && high.is_finite() {
            // Rounding to `high` may have gone up to a power of two that the value does not reach.
            let above =
                low != 0.0 && (low < 0.0) != (high < 0.0) && high.abs().to_bits().trailing_zeros() >= 52;
            *self.bin(exponent(high) - i32::from(above)) += times;
        }
    }

    /// Adds to the count of a bin.
    pub(crate) fn add(&mut self, exponent: i32, count: u64) {
        if count > 0 {
            *self.bin(exponent) += count;
        }
    }

    /// The count of a bin that is about to be raised.
    fn bin(&mut self, exponent: i32) -> &mut u64 {
        if self.counts.is_empty() {
            self.first = exponent;
        }
        if let Ok(below @ 1..) = usize::try_from(self.first - exponent) {
            self.counts.splice(..0, std::iter::repeat_n(0, below));
            self.first = exponent;
        }
        let index = usize::try_from(exponent - self.first).unwrap_or(0);
        if index >= self.counts.len() {
            self.counts.resize(index + 1, 0);
        }
        &mut self.counts[index]
    }

    /// Adds the counts of another histogram.
    pub fn join(&mut self, other: &Self) {
        for (exponent, count) in other.bins() {
            self.add(exponent, count);
        }
    }

    /// How many values had the leading bit at `2^exponent`.
    #[must_use]
    pub fn count(&self, exponent: i32) -> u64 {
        let index = exponent.checked_sub(self.first).and_then(|index| usize::try_from(index).ok());
        index.and_then(|index| self.counts.get(index)).copied().unwrap_or(0)
    }

    /// The bins that are not empty, `(exponent, count)`, from small to large.
    pub fn bins(&self) -> impl Iterator<Item = (i32, u64)> {
        (self.first..).zip(self.counts.iter().copied()).filter(|(_, count)| *count > 0)
    }
}

/// `⌊log₂|x|⌋` of a number that is not zero.
fn exponent(x: f64) -> i32 {
    let bits = x.abs().to_bits();
    match i32::try_from(bits >> 52).unwrap_or(0) {
        // Subnormal: the leading bit of the digits, bit 0 standing for 2^-1074.
        0 => 63 - bits.leading_zeros().cast_signed() - 1074,
        biased => biased - 1023,
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    fn bin(pair: (f64, f64)) -> Vec<(i32, u64)> {
        let mut histogram = Histogram::default();
        histogram.include(pair);
        histogram.bins().collect()
    }

    #[test]
    fn powers_of_two_begin_their_bins() {
        for e in -1074..=1023 {
            let power = if e < -1022 { f64::from_bits(1 << (e + 1074)) } else { 2.0_f64.powi(e) };
            assert_eq!((bin((power, 0.0)), bin((-power, 0.0))), (vec![(e, 1)], vec![(e, 1)]));
            if e > -1074 {
                assert_eq!(bin((power.next_down(), 0.0)), [(e - 1, 1)]);
            }
        }
    }

    /// 2^63 - 1 is 2^63 as a float, but its leading bit stands for 2^62.
    #[test]
    fn both_parts_of_a_pair_count() {
        assert_eq!(bin((2.0_f64.powi(63), -1.0)), [(62, 1)]);
        assert_eq!(bin((-2.0_f64.powi(63), 1.0)), [(62, 1)]);
        assert_eq!(bin((2.0_f64.powi(63), 1.0)), [(63, 1)]);
        assert_eq!(bin((3.0 * 2.0_f64.powi(62), -1.0)), [(63, 1)]);
    }

    #[test]
    fn what_has_no_leading_bit_is_not_counted() {
        assert!([0.0, -0.0, f64::NAN, f64::INFINITY].iter().all(|x| bin((*x, 0.0)).is_empty()));
    }

    proptest! {
        #[test]
        fn values_in_any_order_are_counted(exponents in prop::collection::vec(-70..70_i32, 0..50)) {
            let (mut histogram, mut expected) = (Histogram::default(), std::collections::BTreeMap::new());
            for exponent in exponents {
                histogram.include((-2.0_f64.powi(exponent), 0.0));
                *expected.entry(exponent).or_insert(0) += 1;
            }
            for exponent in -71..71 {
                prop_assert_eq!(histogram.count(exponent), expected.get(&exponent).copied().unwrap_or(0));
            }
            prop_assert!(histogram.bins().eq(expected));
        }

        #[test]
        fn a_bin_holds_its_values(x in prop::num::f64::NORMAL) {
            let (e, _) = bin((x, 0.0))[0];
            prop_assert!(2.0_f64.powi(e) <= x.abs() && (e == 1023 || x.abs() < 2.0_f64.powi(e + 1)));
        }
    }
}
