//! From a parameter to its span, by a table of equal intervals of u, of which there is at least one a span.
//!
//! The search is among the knots of one interval, so that on even knots it takes the same time for ten spans and for ten
//! thousand, in whatever order they are asked for.

use alloc::vec::Vec;

/// From a parameter to the spans in question.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct SpanTable {
    /// u₀, and the number of the last interval over u_end - u₀.
    scale: (f64, f64),
    /// The last interval.
    last: f64,
    /// All intervals, and once more what is behind them.
    intervals: Vec<Interval>,
}

/// What an interval of u knows of the spans. Both numbers lie side by side and are read at once: they say which span is asked for
/// before any number of a span is read.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Interval {
    /// The last span that begins in an earlier interval.
    before: u32,
    /// Where the next one begins: in bytes, so that twelve are enough for both.
    next: [u8; 8],
}

impl SpanTable {
    pub(crate) fn new(begins: &[f64], (first, end): (f64, f64)) -> Self {
        // A quarter more than spans: of knots that are not quite even, two would share an interval, and have to be searched. So
        // would two of few spans, by chance.
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

    /// The interval of `u`; it never falls as u rises. It is the integer nearest to the place of u between the ends: the
    /// last digits of the sum with 2⁵² are that integer.
    #[inline(always)]
    #[allow(clippy::cast_possible_truncation, reason = "an interval has 31 bits at most")]
    fn interval(&self, u: f64) -> usize {
        let x = (u - self.scale.0) * self.scale.1;
        // What is no number goes to 0.
        let x = if x > 0.0 { x } else { 0.0 };
        let x = if x < self.last { x } else { self.last };
        (x + 4_503_599_627_370_496.0).to_bits() as u32 as usize
    }

    /// The first and the last span in question for `u`, and where the one behind the first begins: NaN if that is the curve's last.
    #[inline(always)]
    pub(crate) fn around(&self, u: f64) -> ([usize; 2], f64) {
        let rest = self.intervals.get(self.interval(u)..).and_then(|rest| rest.first_chunk::<2>());
        rest.map_or(([0; 2], f64::NAN), |pair| {
            (pair.map(|interval| interval.before as usize), f64::from_ne_bytes(pair[0].next))
        })
    }

    /// Bytes that it takes.
    pub(crate) fn bytes(&self) -> usize {
        size_of_val(&*self.intervals)
    }
}
