//! From a parameter to its span, by a table of equal intervals of u, at least one interval a span.
//!
//! Only the knots of one interval are searched. On even knots a look-up takes the same time for ten spans and for ten
//! thousand, in any order of the parameters.

use alloc::vec::Vec;

/// A table that finds the spans that may hold a parameter.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct SpanTable {
    /// u₀, and the number of the last interval over u_end - u₀.
    scale: (f64, f64),
    /// The last interval.
    last: f64,
    /// All intervals, and one more for the end of the curve.
    intervals: Vec<Interval>,
}

/// The spans near an interval of u. Both numbers lie side by side and are read at once: they decide on the span before
/// any number of a span is read.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Interval {
    /// The last span that begins in an earlier interval.
    before: u32,
    /// Where the next span begins: in bytes, so that twelve are enough for both numbers.
    next: [u8; 8],
}

impl SpanTable {
    pub(crate) fn new(begins: &[f64], (first, end): (f64, f64)) -> Self {
        // A quarter more intervals than spans: on knots that are not quite even, two knots would share an interval and
        // take a search. At least 16, because two of few knots may share one by chance.
        let count = u32::try_from((begins.len() + begins.len() / 4).max(16)).unwrap_or(u32::MAX);
        let last = count.min(1 << 31) - 1;
        let scale = (first, f64::from(last) / (end - first));
        let mut table = Self { scale, last: f64::from(last), intervals: Vec::new() };
        let of_begins: Vec<usize> = begins[1..].iter().map(|u| table.interval(*u)).collect();
        let interval = |interval| {
            let before = of_begins.partition_point(|of| *of < interval);
            let next = begins.get(before + 1).copied().unwrap_or(f64::NAN).to_ne_bytes();
            Interval { before: u32::try_from(before).unwrap_or(u32::MAX), next }
        };
        table.intervals = (0..=last as usize + 1).map(interval).collect();
        table
    }

    /// The interval of `u`, which never falls as u rises. It is the integer nearest to the place of u between the ends.
    /// The last digits of that place plus 2⁵² are this integer.
    #[inline(always)]
    #[allow(clippy::cast_possible_truncation, reason = "an interval has 31 bits at most")]
    fn interval(&self, u: f64) -> usize {
        let x = (u - self.scale.0) * self.scale.1;
        // NaN becomes 0.
        let x = if x > 0.0 { x } else { 0.0 };
        let x = if x < self.last { x } else { self.last };
        (x + 4_503_599_627_370_496.0).to_bits() as u32 as usize
    }

    /// The first and the last span that may hold `u`, and where the span behind the first begins; NaN if the first is
    /// the curve's last.
    #[inline(always)]
    pub(crate) fn around(&self, u: f64) -> ([usize; 2], f64) {
        let rest = self.intervals.get(self.interval(u)..).and_then(|rest| rest.first_chunk::<2>());
        rest.map_or(([0; 2], f64::NAN), |pair| {
            (pair.map(|interval| interval.before as usize), f64::from_ne_bytes(pair[0].next))
        })
    }

    /// Bytes of the table.
    pub(crate) fn bytes(&self) -> usize {
        size_of_val(&*self.intervals)
    }
}
