//! A curve as one polynomial a span: the fastest form where the numbers are `f64` and memory is not short.
//!
//! On the span from u_i to u_{i+1}, with t = (u - u_i)/(u_{i+1} - u_i) in [0, 1),
//!
//! `C(t) = O + N(t)/W(t)`, `N(t) = Σ_{k≥1} n_k t^k`, `W(t) = 1 + Σ_{k≥1} w_k t^k`,
//!
//! O is the point where the span begins. Coordinates are relative to O, so the distance from the origin of coordinates
//! costs no digits. By Horner's scheme a point takes p multiplications a coordinate instead of the p² of basis
//! functions. It takes one division if the curve is rational, and none if not. Derivatives come from the same chain
//! (Knuth, *The Art of Computer Programming* 2, section 4.6.4), and with weights by the rule for quotients,
//!
//! `C' = (N' - W' c)/W`, `C'' = (N'' - 2 W' C' - W'' c)/W`, `c = N/W`.
//!
//! The span of a parameter is looked up in a table of equal intervals of u, at least one a span. Only the knots of one
//! interval are searched. On even knots a look-up takes the same time for ten spans and for ten thousand, in any order
//! of the parameters: for a single knot the search has no branch. On knots that crowd together it is a binary search.

use alloc::vec::Vec;

use real::Backend;

use crate::polynomials::bezier::{Bezier, computed};
use crate::polynomials::polynomial::power_basis;
use crate::polynomials::span_table::SpanTable;
use crate::vector::{add, scaled};
use crate::{Derivatives, Differentiate, Evaluate, NurbsCurve};

/// A NURBS curve converted for fast evaluation: p + 1 rows of coefficients a span.
///
/// Memory for each control point of a long curve with single knots: `8 ((p + 1) D + 2)` bytes, 8 p more if the curve is
/// rational, and 15 bytes for the table of spans.
#[derive(Clone, Debug, PartialEq)]
pub struct PowerCurve<const D: usize> {
    degree: usize,
    /// For each span, side by side for the sake of caches: its begin, the reciprocal of its width, O, n_1 to n_p and,
    /// if rational, w_1 to w_p. After all spans, the end of the last one.
    spans: Vec<f64>,
    /// How many numbers a span has.
    stride: usize,
    is_plain_cubic: bool,
    count: usize,
    domain: (f64, f64),
    table: SpanTable,
}

/// One span, ready to be evaluated.
#[derive(Clone, Copy, Debug)]
struct PowerSpan<'a, const D: usize> {
    begin: f64,
    end: f64,
    reciprocal: f64,
    /// Twice the square of the reciprocal.
    twice_square: f64,
    coefficients: Coefficients<'a, D>,
    /// The numbers of the spans behind this one.
    onward: &'a [f64],
}

/// Rows and weights of a span. Cubics, the common case, have a length that the compiler knows, so that it unrolls their
/// chains: a third of the instructions less.
#[derive(Clone, Copy, Debug)]
enum Coefficients<'a, const D: usize> {
    Cubic(&'a [[f64; D]; 4]),
    RationalCubic(&'a [[f64; D]; 4], &'a [f64; 3]),
    Any(&'a [[f64; D]], &'a [f64]),
}

impl<'a, const D: usize> Coefficients<'a, D> {
    #[inline]
    fn new(rows: &'a [[f64; D]], weights: &'a [f64]) -> Self {
        match (rows.as_array(), weights.as_array()) {
            (Some(rows), Some(weights)) => Self::RationalCubic(rows, weights),
            _ => Self::Any(rows, weights),
        }
    }
}

impl<const D: usize> PowerSpan<'_, D> {
    /// A span that holds no parameter.
    const NOWHERE: Self = Self {
        begin: 0.0,
        end: 0.0,
        reciprocal: 0.0,
        twice_square: 0.0,
        coefficients: Coefficients::Any(&[], &[]),
        onward: &[],
    };

    // Inlined to the caller: a value returned through memory in parts and read as a whole makes the processor wait.
    #[inline(always)]
    fn point(&self, u: f64) -> [f64; D] {
        let t = (u - self.begin) * self.reciprocal;
        match self.coefficients {
            Coefficients::Cubic(rows) => point_at(rows, &[], t),
            Coefficients::RationalCubic(rows, weights) => point_at(rows, weights, t),
            Coefficients::Any(rows, weights) => point_at(rows, weights, t),
        }
    }

    #[inline(always)]
    fn derivatives(&self, u: f64) -> Derivatives<f64, D> {
        let t = (u - self.begin) * self.reciprocal;
        let rates = (self.reciprocal, self.twice_square);
        match self.coefficients {
            Coefficients::Cubic(rows) => derivatives_at::<true, D>(rows, &[], t, rates),
            Coefficients::RationalCubic(rows, weights) => derivatives_at::<true, D>(rows, weights, t, rates),
            Coefficients::Any(rows, weights) => derivatives_at::<false, D>(rows, weights, t, rates),
        }
    }
}

/// O + N(t)/W(t).
#[inline(always)]
fn point_at<const D: usize>(rows: &[[f64; D]], weights: &[f64], t: f64) -> [f64; D] {
    let [origin, rest @ ..] = rows else { return [0.0; D] };
    let [offset] = chains::<true, _, _>(rest, t);
    let factor = if weights.is_empty() {
        t
    } else {
        let [weight] = chains::<true, _, _>(weights.as_chunks::<1>().0, t);
        t / (weight[0] * t + 1.0)
    };
    times_plus(offset, factor, *origin)
}

/// The point, and C' and C'' by u, from dt/du and twice its square. KNOWN says that the compiler knows the number of
/// rows.
#[inline(always)]
fn derivatives_at<const KNOWN: bool, const D: usize>(
    rows: &[[f64; D]],
    weights: &[f64],
    t: f64,
    (rate, twice_square): (f64, f64),
) -> Derivatives<f64, D> {
    let [origin, rest @ ..] = rows else { return Derivatives::default() };
    let [mut offset, mut first, mut half_second] = expansion(chains::<KNOWN, _, _>(rest, t), t);
    if !weights.is_empty() {
        let weights = chains::<KNOWN, _, _>(weights.as_chunks::<1>().0, t);
        let [[weight], [rise], [half_turn]] = expansion(weights, t);
        let reciprocal = 1.0 / (weight + 1.0);
        let (rise, half_turn) = (rise * reciprocal, half_turn * reciprocal);
        for d in 0..D {
            offset[d] *= reciprocal;
            first[d] = first[d] * reciprocal - rise * offset[d];
            half_second[d] = half_second[d] * reciprocal - half_turn * offset[d] - rise * first[d];
        }
    }
    Derivatives {
        point: add(&offset, origin),
        first: scaled(&first, rate),
        second: scaled(&half_second, twice_square),
    }
}

/// q and its derivatives over 1, 1, 2, …, for `q(t) = Σ row_k t^k`; ASKED is how many of them.
///
/// A chain is 0 until its first number has come down to it. If the number of rows is KNOWN, each chain begins where its
/// first number does, which saves a fifth of the instructions. If not, the loop would have to test for it in each turn;
/// with more chains than one, that costs more than it saves.
#[inline(always)]
fn chains<const KNOWN: bool, const D: usize, const ASKED: usize>(
    rows: &[[f64; D]],
    t: f64,
) -> [[f64; D]; ASKED] {
    let mut chains = [[0.0; D]; ASKED];
    for (begun, row) in rows.iter().rev().enumerate() {
        for k in (0..ASKED).rev() {
            let more = if k == 0 { *row } else { chains[k - 1] };
            if !KNOWN || k < begun {
                chains[k] = times_plus(chains[k], t, more);
            } else if k == begun {
                chains[k] = more;
            }
        }
    }
    chains
}

/// `of · t + more`.
#[inline(always)]
fn times_plus<const D: usize>(of: [f64; D], t: f64, more: [f64; D]) -> [f64; D] {
    core::array::from_fn(|d| of[d] * t + more[d])
}

/// Turns q, q' and q''/2 into those of `t q`.
#[inline(always)]
fn expansion<const D: usize>([q, slope, bend]: [[f64; D]; 3], t: f64) -> [[f64; D]; 3] {
    [scaled(&q, t), times_plus(slope, t, q), times_plus(bend, t, slope)]
}

impl<const D: usize> PowerCurve<D> {
    /// Converts a curve; the coefficients are computed in `H` and rounded once.
    ///
    /// `H` must be a float, which the compiler checks. If `H` cannot hold a number of the curve, as `f32` cannot hold
    /// 1e300, the points of the spans with that number are NaN or infinite.
    ///
    /// ```compile_fail
    /// # use nurbs_core::{NurbsCurve, PowerCurve};
    /// let knots = [0.0, 0.0, 1.0, 1.0];
    /// let line = NurbsCurve::try_new_nonrational(1, &[[0.0], [200.0]], &knots).unwrap();
    /// PowerCurve::new::<real::I8F24>(&line); // holds numbers below 128
    /// ```
    #[must_use]
    pub fn new<H: Backend>(curve: &NurbsCurve<'_, f64, D>) -> Self {
        let knots = curve.knots().as_slice();
        let degree = curve.degree();
        let (mut begins, mut spans) = (Vec::with_capacity(curve.span_count()), Vec::new());
        for span in (degree..curve.control_points().len()).filter(|i| knots[*i] < knots[i + 1]) {
            let (begin, end) = (knots[span], knots[span + 1]);
            begins.push(begin);
            let bezier = Bezier::<H, D>::of_span(curve, span, computed(begin), computed(end));
            spans.extend([begin, 1.0 / (end - begin)]);
            push_span(&bezier, &mut spans);
        }
        let (domain, count) = (curve.domain(), begins.len());
        let stride = spans.len() / count;
        spans.push(domain.1);
        let table = SpanTable::new(&begins, domain);
        let is_plain_cubic = degree == 3 && curve.weights().is_none();
        Self { degree, spans, stride, is_plain_cubic, count, domain, table }
    }

    /// The degree p.
    #[must_use]
    pub fn degree(&self) -> usize {
        self.degree
    }

    /// A cursor for one parameter after another: fastest where each lies in the same span as the one before, or in the
    /// next span.
    #[must_use]
    pub fn cursor(&self) -> PowerCursor<'_, D> {
        PowerCursor { curve: self, span: self.span(0).unwrap_or(PowerSpan::NOWHERE) }
    }

    /// The points at these parameters, in any order. Each is the same as [`point`](Evaluate::point) gives. The number
    /// of points is the length of the shorter slice.
    ///
    /// The spans of some parameters are looked up before the first of them is evaluated, so that a processor waits for
    /// the memory of many spans at once. On curves that do not fit its first cache, scattered parameters take from two
    /// thirds to three quarters of the time that they take one by one.
    pub fn points(&self, parameters: &[f64], points: &mut [[f64; D]]) {
        const BLOCK: usize = 64;
        for (parameters, points) in parameters.chunks(BLOCK).zip(points.chunks_mut(BLOCK)) {
            let mut spans = [0; BLOCK];
            for (span, u) in spans.iter_mut().zip(parameters) {
                *span = self.index_of(*u);
            }
            for ((point, u), span) in points.iter_mut().zip(parameters).zip(spans) {
                *point = self.span(span).map_or([0.0; D], |span| span.point(*u));
            }
        }
    }

    /// Bytes of the tables.
    #[must_use]
    pub fn bytes(&self) -> usize {
        size_of_val(&*self.spans) + self.table.bytes()
    }

    /// Where a span begins; for the index behind the last span, where the last span ends.
    #[inline(always)]
    fn begin(&self, index: usize) -> f64 {
        self.spans.get(index * self.stride).copied().unwrap_or(self.domain.1)
    }

    #[inline(always)]
    fn span(&self, index: usize) -> Option<PowerSpan<'_, D>> {
        self.first_of(self.spans.get(index * self.stride..)?)
    }

    /// The first span of these numbers.
    #[inline(always)]
    fn first_of<'a>(&self, numbers: &'a [f64]) -> Option<PowerSpan<'a, D>> {
        let (own, onward) = numbers.split_at_checked(self.stride)?;
        let ([begin, reciprocal], rest) = own.split_first_chunk()?;
        let coefficients = match rest.as_chunks().0.first_chunk() {
            Some(rows) if self.is_plain_cubic => Coefficients::Cubic(rows),
            _ => {
                let (rows, weights) = rest.split_at_checked((self.degree + 1) * D)?;
                Coefficients::new(rows.as_chunks().0, weights)
            }
        };
        let (begin, end, reciprocal) = (*begin, *onward.first()?, *reciprocal);
        let twice_square = 2.0 * reciprocal * reciprocal;
        Some(PowerSpan { begin, end, reciprocal, twice_square, coefficients, onward })
    }

    /// The last span that does not begin after `u`, or the first.
    #[inline(always)]
    fn index_of(&self, u: f64) -> usize {
        let ([low, high], second) = self.table.around(u);
        if high - low > 1 {
            return self.search(u, low, high);
        }
        // One or two spans, which a processor would guess wrong as often as right: no branch.
        low + usize::from(second <= u)
    }

    #[inline(always)]
    fn span_of(&self, u: f64) -> Option<PowerSpan<'_, D>> {
        self.span(self.index_of(u))
    }

    /// The span that holds u, among the spans from `low` to `high`, by halving.
    #[cold]
    #[inline(never)]
    fn search(&self, u: f64, mut low: usize, mut high: usize) -> usize {
        while low < high {
            let middle = (low + high).div_ceil(2);
            if self.begin(middle) <= u { low = middle } else { high = middle - 1 }
        }
        low
    }
}

/// Appends O, n_1 … n_p and, if rational, w_1 … w_p, with weights over the first one.
fn push_span<H: Backend, const D: usize>(bezier: &Bezier<H, D>, numbers: &mut Vec<f64>) {
    let (start, unit) = (bezier.euclidean(0), bezier.weights[0]);
    let column =
        |d: usize| power_basis(&bezier.seen_from_start().map(|point| point[d] / unit).collect::<Vec<H>>());
    let columns: [Vec<H>; D] = core::array::from_fn(column);
    numbers.extend(start.map(|x| x.to_f64()));
    numbers
        .extend((1..bezier.points.len()).flat_map(|k| columns.each_ref().map(|column| column[k].to_f64())));
    if bezier.rational {
        let relative: Vec<H> = bezier.weights.iter().map(|w| *w / unit).collect();
        numbers.extend(power_basis(&relative).iter().skip(1).map(|w| w.to_f64()));
    }
}

impl<const D: usize> Evaluate<f64, D> for PowerCurve<D> {
    fn domain(&self) -> (f64, f64) {
        self.domain
    }

    /// The point `C(u)` by Horner's scheme.
    ///
    /// Accuracy: the coefficients of a span whose control points have the extent E sum up to at most `3^p E`. The error
    /// is at most `4 ε` times this sum plus ε times the largest coordinate. With weights from v to W in the span the
    /// error is `16 (W/v)²` times as large.
    #[inline]
    fn point(&self, u: f64) -> [f64; D] {
        self.span_of(u).map_or([0.0; D], |span| span.point(u))
    }

    fn span_count(&self) -> usize {
        self.count
    }

    fn span_bounds(&self, span: usize) -> (f64, f64) {
        let span = span.min(self.count - 1);
        (self.begin(span), self.begin(span + 1))
    }
}

impl<const D: usize> Differentiate<f64, D> for PowerCurve<D> {
    fn derivatives(&self, u: f64) -> Derivatives<f64, D> {
        self.span_of(u).map_or_else(Derivatives::default, |span| span.derivatives(u))
    }

    fn derivatives_in(&self, span: usize, u: f64) -> Derivatives<f64, D> {
        self.span(span.min(self.count - 1)).map_or_else(Derivatives::default, |span| span.derivatives(u))
    }

    fn is_line(&self, _: usize) -> bool {
        // Two rows and no weight.
        self.degree == 1 && self.stride == 2 + 2 * D
    }
}

/// Evaluates one curve at many parameters. It looks a span up only where neither the span before nor the next one holds
/// the parameter.
#[derive(Clone, Copy, Debug)]
pub struct PowerCursor<'a, const D: usize> {
    curve: &'a PowerCurve<D>,
    span: PowerSpan<'a, D>,
}

impl<const D: usize> PowerCursor<'_, D> {
    /// The point at u, bit for bit that of the curve's [`point`](Evaluate::point).
    #[inline]
    pub fn point(&mut self, u: f64) -> [f64; D] {
        self.seek(u);
        self.span.point(u)
    }

    /// Point and derivatives at u, bit for bit those of the curve's [`derivatives`](Differentiate::derivatives).
    #[inline]
    pub fn derivatives(&mut self, u: f64) -> Derivatives<f64, D> {
        self.seek(u);
        self.span.derivatives(u)
    }

    #[inline]
    fn seek(&mut self, u: f64) {
        if !(self.span.begin <= u && u < self.span.end) {
            self.leave(u);
        }
    }

    /// Moves to the span of `u`, which is not the present one.
    #[inline(never)] // Within the above it would make every evaluation save its registers.
    fn leave(&mut self, u: f64) {
        let next = self.curve.first_of(self.span.onward).filter(|next| next.begin <= u && u < next.end);
        if let Some(span) = next.or_else(|| self.curve.span_of(u)) {
            self.span = span;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::oracle::exactly;
    use crate::{NurbsBuf, generate, golden};
    use proptest::prelude::*;
    use real::DoubleDouble;

    fn converted<const D: usize>(curve: &NurbsBuf<f64, D>) -> PowerCurve<D> {
        PowerCurve::new::<DoubleDouble>(&curve.as_curve())
    }

    /// `3^p E`, and with weights `16 (W/v)²` times that; the largest coordinate; of all spans.
    fn sizes<const D: usize>(curve: &NurbsBuf<f64, D>) -> (f64, f64) {
        let coordinates = || curve.control_points().iter().flatten();
        let extent =
            coordinates().fold(f64::MIN, |m, x| m.max(*x)) - coordinates().fold(f64::MAX, |m, x| m.min(*x));
        let (v, w) = curve.weights().iter().fold((f64::MAX, 0.0_f64), |(v, w), x| (v.min(*x), w.max(*x)));
        let growth = if v < w { 16.0 * (w / v).powi(2) } else { 1.0 };
        let power = 3_f64.powi(i32::try_from(curve.degree()).unwrap());
        (power * extent * growth, coordinates().fold(0.0, |m: f64, x| m.max(x.abs())))
    }

    fn largest<const D: usize>(found: &[f64; D], exact: &[DoubleDouble; D]) -> f64 {
        found.iter().zip(exact).fold(0.0, |m, (x, e)| m.max((DoubleDouble::from(*x) - *e).value().abs()))
    }

    proptest! {
        #[test]
        fn points_are_as_accurate_as_said((curve, u) in generate::curve_and_parameter::<3>()) {
            let fast = converted(&curve);
            let (sum, coordinate) = sizes(&curve);
            let error = largest(&fast.point(u), &exactly(&curve).as_curve().point(u.into()));
            let bound = f64::EPSILON * (4.0 * sum + coordinate);
            prop_assert!(error <= bound, "u={u}: {error} > {bound}");
        }

        #[test]
        fn derivatives_are_those_of_the_curve((curve, span, t) in generate::curve_span_and_fraction::<2>()) {
            let fast = converted(&curve);
            let (a, b) = fast.span_bounds(span);
            prop_assert_eq!((a, b), curve.as_curve().span_bounds(span));
            let u = a + (b - a) * t;
            let found = fast.derivatives_in(span, u);
            let exact = exactly(&curve).as_curve().derivatives_in(span, u.into());
            let (sum, _) = sizes(&curve);
            let (w, v) = curve.weights().iter().fold((0.0_f64, f64::MAX), |(w, v), x| (w.max(*x), v.min(*x)));
            // Each differentiation magnifies by p over the width, and with weights by their ratio.
            let growth = 2.0 * curve.degree() as f64 / (b - a) * (w / v);
            let bound = 4.0 * f64::EPSILON * sum * growth;
            let errors = [largest(&found.first, &exact.first), largest(&found.second, &exact.second)];
            prop_assert!(errors[0] <= bound, "C'({u}): {} > {bound}", errors[0]);
            prop_assert!(errors[1] <= bound * growth, "C''({u}): {} > {}", errors[1], bound * growth);
        }

        /// Whatever lengths the slices have, and in any order.
        #[test]
        fn many_points_are_those_of_each(
            (curve, _) in generate::curve_and_parameter::<2>(),
            parameters in proptest::collection::vec(-0.25..1.25_f64, 0..200),
            room in 0..200_usize,
        ) {
            let fast = converted(&curve);
            let untouched = [f64::MAX; 2];
            let mut points = vec![untouched; room];
            fast.points(&parameters, &mut points);
            for (k, point) in points.iter().enumerate() {
                let expected = parameters.get(k).map_or(untouched, |u| fast.point(*u));
                prop_assert_eq!(*point, expected, "{} of {}", k, parameters.len());
            }
        }

        /// On knots that crowd and repeat, at knots and between them, in any order.
        #[test]
        fn the_span_is_that_of_the_knot_vector(
            (curve, _) in generate::curve_and_parameter::<2>(),
            parameters in proptest::collection::vec(-0.25..1.25_f64, 1..40),
        ) {
            let fast = converted(&curve);
            let mut cursor = fast.cursor();
            for u in parameters.iter().chain(curve.knots()) {
                let knots = curve.as_curve();
                let place = knots.knots().as_slice()[knots.knots().find_span(*u)];
                prop_assert_eq!(fast.span_of(*u).unwrap().begin, place, "u={}", u);
                prop_assert_eq!(cursor.point(*u), fast.point(*u));
                prop_assert_eq!(cursor.derivatives(*u), fast.derivatives(*u));
                prop_assert_eq!(fast.derivatives(*u).point.len(), 2);
            }
        }
    }

    #[test]
    fn what_is_not_a_number_gives_nothing_that_looks_like_one() {
        let fast = converted(&golden::seed_003());
        assert!(fast.point(f64::NAN).iter().all(|x| x.is_nan()));
        assert!(fast.cursor().derivatives(f64::NAN).first.iter().all(|x| x.is_nan()));
        assert!(fast.point(f64::INFINITY).iter().all(|x| !x.is_finite()));
    }

    #[test]
    fn a_long_curve_takes_the_memory_that_is_said() {
        let count = 4099_u32; // 4096 spans
        let points = (0..count).map(|i| [f64::from(i), f64::from(i % 7), f64::from(i % 5)]).collect();
        let inner = (1..4096).map(f64::from);
        let knots = [0.0; 4].into_iter().chain(inner).chain([4096.0; 4]).collect();
        let curve = NurbsBuf::try_new_nonrational(3, points, knots).unwrap();
        let bytes = converted(&curve).bytes();
        assert_eq!(bytes, 4096 * (8 * (4 * 3 + 2) + 15) + 8 + 12);
    }

    #[test]
    fn a_circle_keeps_its_radius() {
        let fast = converted(&golden::circle(10.0));
        for k in 0..=1000 {
            let [x, y] = fast.point(f64::from(k) / 1000.0);
            assert!((x.hypot(y) - 10.0).abs() < 2e-14, "{k}: {x} {y}");
        }
    }
}
