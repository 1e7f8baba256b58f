//! Arc length `s = ∫ |C'(u)| du` and its inverse.
//!
//! The integral is taken span by span, because |C'| is smooth only inside a span. On a panel [a, b] the five-point rule
//! of Gauss and Legendre samples the speed. Where the rule on the panel and the rule on its two halves disagree, the
//! halves become panels.
//!
//! The error of the rule falls as the tenth power of a small panel's width: halving divides the error by about 1000,
//! and the disagreement is about 1000 times the error left. Where the speed peaks within a fraction of a panel, this
//! does not hold yet, and the two results may agree by accident. So a panel is accepted only if it agrees, and the
//! panel of which it is a half agreed too, both to a sixteenth of the tolerance.
//!
//! The curve may turn back between the end of a panel and the nearest place at which the rules sample. The speed is
//! then smooth at all samples, and the rules agree. So C' is taken at both ends of a panel that would be accepted. If
//! C' turns by more than a right angle from an end to the nearest sample, the panel is halved all the same.

use real::Real;

use crate::vector::{add, sub};
use crate::{Differentiate, GaussLegendre};

/// Panels waiting at once; a span can be halved once less.
///
/// The last panels, 2⁻³¹ of a span wide, are below the resolution of 32-bit formats. They matter in `f64` only next to
/// a cusp, where the error shrinks by 4 with each halving.
const MAX_DEPTH: usize = 32;

/// Panels of a span that are looked at before halving stops, with 10 evaluations each. A cusp resolved to 1e-12 takes
/// fewer than 100.
const MAX_PANELS: usize = 2048;

/// Iterations of [`parameter_at`]; Newton needs 2 to 8, and 100 let bisection alone exhaust 50 bits.
const MAX_ITERATIONS: u32 = 100;

/// An arc length and an estimate of its error.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ArcLength<R> {
    /// The length s, in the unit of the control points.
    pub length: R,
    /// The sum of the disagreements of the accepted panels. The error of a smooth curve's length is far smaller, down
    /// to rounding.
    pub estimated_error: R,
}

/// How a search for a parameter ended.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum ParameterSearch<R> {
    /// The arc length up to `parameter` is within the tolerance of the given length.
    Converged {
        /// The parameter found.
        parameter: R,
        /// Iterations used.
        iterations: u32,
    },
    /// The format's parameters are too coarse for the tolerance, or the curve is shorter than the given length.
    LimitReached {
        /// The best parameter.
        parameter: R,
        /// The given length less the arc length up to `parameter`.
        residual: R,
    },
}

impl<R: Copy> ParameterSearch<R> {
    /// The parameter found, converged or not.
    #[must_use]
    pub fn parameter(&self) -> R {
        match *self {
            Self::Converged { parameter, .. } | Self::LimitReached { parameter, .. } => parameter,
        }
    }
}

/// Arc length between the parameters `from` and `to`, whichever comes first, to within `tolerance`.
///
/// A parameter outside the domain counts as the nearer end. A panel is not halved for a disagreement within 8 units of
/// the last place of its length, so that a tolerance below rounding costs no more than rounding allows.
///
/// Accuracy with tolerance 0, over the curves of the papers and a circle: relative 3e-15 in `f64`, 5e-7 in `f32`, 3e-10
/// in `I32F32`; on a circle of radius 10, 2e-5 in `I16F16`.
/// Work: at most 2048 panels a span, and at most 32 more that still wait when halving stops. A panel takes 10
/// derivatives, and an accepted one up to two more at its ends.
/// Range: |C'| and the length must fit the format, with a few of their last places to spare.
pub fn arc_length<R: Real, const D: usize>(
    curve: &impl Differentiate<R, D>,
    from: R,
    to: R,
    tolerance: R,
) -> ArcLength<R> {
    let rule = GaussLegendre::new();
    let (start, end) = (from.min(to), from.max(to));
    let mut total = ArcLength { length: R::zero(), estimated_error: R::zero() };
    for span in first_span_after(curve, start)..curve.span_count() {
        let (a, b) = curve.span_bounds(span);
        let (a, b) = (a.max(start), b.min(end));
        if a < b {
            total = total.plus(rule.adaptive(curve, span, a, b, tolerance));
        } else if end <= a {
            break;
        }
    }
    total
}

/// The first span that ends behind a parameter, by bisection; the number of spans if none does.
fn first_span_after<R: Real, const D: usize>(curve: &impl Differentiate<R, D>, u: R) -> usize {
    let (mut first, mut end) = (0, curve.span_count());
    while first < end {
        let middle = first + (end - first) / 2;
        if curve.span_bounds(middle).1 > u {
            end = middle;
        } else {
            first = middle + 1;
        }
    }
    first
}

/// The parameter u at which the arc length from `from` is `length`: the inverse of [`arc_length`].
///
/// Newton's iteration `u ← u - (s(u) - length)/|C'(u)|`, kept inside a bracket that shrinks with each trial. A step
/// bisects the bracket instead if it would leave it, or if the step before did not halve the residual. At most 100
/// iterations. A `from` outside the domain counts as the nearer end; a `length` of 0 or less gives `from`.
///
/// Accuracy: where it converges, `tolerance` plus the error of [`arc_length`], in arc length.
/// [`ParameterSearch::LimitReached`] says that the curve ends first (the parameter is then its end) or that no
/// parameter of the format is within `tolerance`.
pub fn parameter_at<R: Real, const D: usize>(
    curve: &impl Differentiate<R, D>,
    from: R,
    length: R,
    tolerance: R,
) -> ParameterSearch<R> {
    let (first, last) = curve.domain();
    let from = from.max(first).min(last);
    if length <= R::zero() {
        return finished(from, length, tolerance, 0);
    }
    let rule = GaussLegendre::new();
    let mut remaining = length;
    for span in 0..curve.span_count() {
        let (a, b) = curve.span_bounds(span);
        let a = a.max(from);
        if a < b {
            let whole = rule.adaptive(curve, span, a, b, tolerance).length;
            if remaining <= whole {
                return find_in_span(&rule, curve, span, (a, b), remaining, whole, tolerance);
            }
            remaining = remaining - whole;
        }
    }
    finished(last, remaining, tolerance, 0)
}

/// The search within one span. The arc length `whole` over its `bracket` is at least `length`.
fn find_in_span<R: Real, const D: usize>(
    rule: &GaussLegendre<R>,
    curve: &impl Differentiate<R, D>,
    span: usize,
    bracket: (R, R),
    length: R,
    whole: R,
    tolerance: R,
) -> ParameterSearch<R> {
    let start = bracket.0;
    let (mut low, mut high) = bracket;
    let mut u = (high - low).mul_add(length / whole, low).min(high); // as if the speed were constant
    let mut best = (u, R::max_value());
    for iteration in 1..=MAX_ITERATIONS {
        let residual = length - rule.adaptive(curve, span, start, u, tolerance).length;
        if residual.abs() <= tolerance {
            return ParameterSearch::Converged { parameter: u, iterations: iteration };
        }
        let halved = residual.abs() <= best.1.abs().half();
        if residual.abs() < best.1.abs() {
            best = (u, residual);
        }
        if residual > R::zero() {
            low = u;
        } else {
            high = u;
        }
        let newton = u + residual / R::norm(&curve.derivatives_in(span, u).first);
        let middle = low + (high - low).half();
        u = if halved && low < newton && newton < high { newton } else { middle };
        if !(low < u && u < high) {
            break; // neighbours: the format has no parameter between them
        }
    }
    finished(best.0, best.1, tolerance, MAX_ITERATIONS)
}

fn finished<R: Real>(parameter: R, residual: R, tolerance: R, iterations: u32) -> ParameterSearch<R> {
    if residual.abs() <= tolerance {
        ParameterSearch::Converged { parameter, iterations }
    } else {
        ParameterSearch::LimitReached { parameter, residual }
    }
}

impl<R: Real> ArcLength<R> {
    fn plus(self, other: Self) -> Self {
        Self {
            length: self.length + other.length,
            estimated_error: self.estimated_error + other.estimated_error,
        }
    }
}

/// A part of a span with the rule's value on it.
#[derive(Clone, Copy)]
struct Panel<R> {
    start: R,
    end: R,
    length: R,
    /// Whether the panel of which this one is a half agreed with its halves.
    agreed_before: bool,
}

impl<R: Real> GaussLegendre<R> {
    /// The panel [start, end] of a span, mean speed times width, and C' at its first and last place.
    fn panel<const D: usize>(
        &self,
        curve: &impl Differentiate<R, D>,
        span: usize,
        start: R,
        end: R,
    ) -> (Panel<R>, [[R; D]; 2]) {
        let width = end - start;
        let rates = self.points.map(|x| curve.derivatives_in(span, x.mul_add(width, start)).first);
        let [first, .., last] = rates;
        let speeds = rates.map(|rate| R::norm(&rate));
        // Relative to the middle speed: the mean of a constant speed is then exact, however the weights were rounded.
        let mean_speed = speeds[2] + self.mean(&speeds.map(|speed| speed - speeds[2]));
        (Panel { start, end, length: mean_speed * width, agreed_before: false }, [first, last])
    }

    /// The length of [start, end] within one span, with panels halved where needed.
    fn adaptive<const D: usize>(
        &self,
        curve: &impl Differentiate<R, D>,
        span: usize,
        start: R,
        end: R,
        tolerance: R,
    ) -> ArcLength<R> {
        let mut total = ArcLength { length: R::zero(), estimated_error: R::zero() };
        let share = tolerance.ldexp(-4);
        let (first, _) = self.panel(curve, span, start, end);
        // C' at the begin of the next panel, if the panel before ended there.
        let mut entry = None;
        let mut waiting = [first; MAX_DEPTH];
        let mut count = 1;
        for panels_done in 0.. {
            count -= 1;
            let Panel { start, end, length, agreed_before } = waiting[count];
            let middle = start + (end - start).half();
            let (left, [first, _]) = self.panel(curve, span, start, middle);
            let (right, [_, last]) = self.panel(curve, span, middle, end);
            let halves = left.length + right.length;
            let disagreement = (halves - length).abs();
            let rounding = (halves * R::resolution()).ldexp(3).max(R::resolution());
            let agrees = disagreement <= share.max(rounding);
            let accepted = disagreement <= rounding || (agrees && agreed_before);
            let can_split =
                count + 2 <= MAX_DEPTH && panels_done < MAX_PANELS && start < middle && middle < end;
            let at = |u: R| curve.derivatives_in(span, u).first;
            // A panel shorter than its share of the tolerance cannot have a larger error.
            let is_looked_at = can_split && accepted && halves > share;
            let ends = is_looked_at.then(|| (entry.unwrap_or_else(|| at(start)), at(end)));
            let turns_back =
                ends.is_some_and(|(begin, end)| is_reversed(&begin, &first) || is_reversed(&last, &end));
            if can_split && (!accepted || turns_back) {
                entry = ends.map(|(begin, _)| begin).or(entry);
                waiting[count] = Panel { agreed_before: agrees, ..right };
                waiting[count + 1] = Panel { agreed_before: agrees, ..left };
                count += 2;
            } else {
                entry = ends.map(|(_, end)| end);
                total = total.plus(ArcLength { length: halves, estimated_error: disagreement });
            }
            if count == 0 {
                break;
            }
        }
        total
    }
}

/// Whether two vectors are more than a right angle apart: `|a + b| < |a - b|`. The vectors are halved, so that sum and
/// difference are no larger than they are.
fn is_reversed<R: Real, const D: usize>(a: &[R; D], b: &[R; D]) -> bool {
    let [a, b] = [a, b].map(|v| v.map(R::half));
    R::norm(&add(&a, &b)) < R::norm(&sub(&a, &b))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{Derivatives, Evaluate, NurbsBuf, generate, golden};
    use proptest::prelude::*;
    use real::{Backend, I16F16, I32F32};
    use std::cell::Cell;

    const SEED_000: f64 = 834.706_924_931_909;
    const SEED_003: f64 = 134.006_017_053_295;
    const CIRCLE: f64 = 62.831_853_071_795_9;

    fn whole<Q: Backend>(curve: &NurbsBuf<f64, 2>, tolerance: f64) -> ArcLength<f64> {
        let curve = curve.convert::<Q>().unwrap();
        let (first, last) = curve.as_curve().domain();
        let found = arc_length(&curve.as_curve(), first, last, Q::from_f64(tolerance).unwrap());
        ArcLength { length: found.length.to_f64(), estimated_error: found.estimated_error.to_f64() }
    }

    #[test]
    fn lengths_of_the_papers_curves() {
        let (plain, rational, circle) = (golden::seed_000(), golden::seed_003(), golden::circle(10.0));
        for (name, found, expected, relative) in [
            ("seed 000 f64", whole::<f64>(&plain, 0.0), SEED_000, 3e-15),
            ("seed 003 f64", whole::<f64>(&rational, 0.0), SEED_003, 3e-15),
            ("circle f64", whole::<f64>(&circle, 0.0), CIRCLE, 3e-15),
            ("seed 000 f32", whole::<f32>(&plain, 0.0), SEED_000, 5e-7),
            ("seed 003 f32", whole::<f32>(&rational, 0.0), SEED_003, 5e-7),
            ("circle f32", whole::<f32>(&circle, 0.0), CIRCLE, 5e-7),
            ("seed 000 I32F32", whole::<I32F32>(&plain, 0.0), SEED_000, 3e-10),
            ("seed 003 I32F32", whole::<I32F32>(&rational, 0.0), SEED_003, 3e-10),
            ("circle I32F32", whole::<I32F32>(&circle, 0.0), CIRCLE, 3e-10),
            ("circle I16F16", whole::<I16F16>(&circle, 0.0), CIRCLE, 2e-5),
        ] {
            let error = (found.length / expected - 1.0).abs();
            assert!(found.estimated_error <= 1e-6 * expected, "{name}: estimated {}", found.estimated_error);
            assert!(error <= relative, "{name}: {} is off by {error:e}", found.length);
        }
    }

    proptest! {
        #![proptest_config(ProptestConfig::with_cases(64))]
        #[test]
        fn lengths_add_up((curve, u) in generate::curve_and_parameter::<3>(), tolerance in 1e-9..1e-3) {
            let curve = curve.as_curve();
            let (first, last) = curve.domain();
            let length = |a, b| arc_length(&curve, a, b, tolerance);
            let (all, before, after) = (length(first, last), length(first, u), length(u, last));
            prop_assert_eq!(length(u, first), before);
            let error = (before.length + after.length - all.length).abs();
            prop_assert!(error <= tolerance + 1e-11, "{error} > {tolerance}");
            let chord = f64::norm(&[0, 1, 2].map(|k| curve.point(u)[k] - curve.point(first)[k]));
            prop_assert!(before.length >= chord - tolerance - 1e-11);
        }

        #[test]
        fn the_parameter_found_has_the_length_wanted(
            (curve, from) in generate::curve_and_parameter::<2>(), part in 0.0..1.0
        ) {
            let curve = curve.as_curve();
            let (_, last) = curve.domain();
            let tolerance = 1e-8;
            let wanted = arc_length(&curve, from, last, tolerance).length * part;
            let search = parameter_at(&curve, from, wanted, tolerance);
            let parameter = search.parameter();
            // Where the curve is fast, two neighbouring parameters are further apart than the tolerance.
            let step = f64::norm(&curve.derivatives(parameter).first) * f64::EPSILON;
            if let ParameterSearch::LimitReached { residual, .. } = search {
                prop_assert!(residual.abs() <= 4.0 * step, "{residual}: a step is {step}");
            }
            let found = arc_length(&curve, from, parameter, tolerance).length;
            prop_assert!((found - wanted).abs() <= 3.0 * tolerance + 4.0 * step, "{found} for {wanted}");
        }
    }

    #[test]
    fn newton_needs_few_iterations() {
        let curve = golden::seed_000();
        let mut most = 0;
        for k in 1..100 {
            let wanted = SEED_000 * f64::from(k) / 100.0;
            match parameter_at(&curve.as_curve(), 0.0, wanted, 1e-9) {
                ParameterSearch::Converged { iterations, .. } => most = most.max(iterations),
                other => panic!("k={k}: {other:?}"),
            }
        }
        assert!(most <= 8, "{most}");
    }

    #[test]
    fn the_inverse_says_when_it_cannot() {
        let line = NurbsBuf::try_new_nonrational(1, vec![[0.0], [100.0]], vec![0.0, 0.0, 1.0, 1.0]).unwrap();
        let at = |length, tolerance| parameter_at(&line.as_curve(), 0.25, length, tolerance);
        assert!(matches!(at(50.0, 1e-12), ParameterSearch::Converged { iterations: 1, .. }));
        assert!((at(50.0, 1e-12).parameter() - 0.75).abs() <= 1e-14);
        let ParameterSearch::LimitReached { parameter, residual } = at(80.0, 1e-9) else {
            panic!("only 75 mm are left");
        };
        assert!(parameter == 1.0 && (residual - 5.0).abs() < 1e-12, "{parameter}, {residual}");
        assert!((at(75.0, 1e-12).parameter() - 1.0).abs() <= 1e-14);
        assert_eq!(at(0.0, 0.0), ParameterSearch::Converged { parameter: 0.25, iterations: 0 });
        assert_eq!(at(-1.0, 1e-9), ParameterSearch::LimitReached { parameter: 0.25, residual: -1.0 });

        // 100 mm over parameters in steps of 2⁻¹⁶ are steps of 1.5e-3 mm.
        let coarse = line.convert::<I16F16>().unwrap();
        let third = I16F16::from_ratio(100, 3);
        let ParameterSearch::LimitReached { parameter, residual } =
            parameter_at(&coarse.as_curve(), I16F16::from_ratio(0, 1), third, I16F16::from_ratio(0, 1))
        else {
            panic!("a third of 100 mm is no multiple of the step");
        };
        assert_eq!(parameter, I16F16::from_ratio(1, 3));
        assert!(residual.abs() <= I16F16::from_ratio(8, 10_000), "{residual:?}");
    }

    #[test]
    fn parameters_outside_the_domain_are_its_ends() {
        let curve = golden::circle(10.0);
        let curve = curve.as_curve();
        let (all, more) = (arc_length(&curve, 0.0, 1.0, 1e-9), arc_length(&curve, -5.0, 7.0, 1e-9));
        assert_eq!(all, more);
        assert_eq!(arc_length(&curve, 2.0, 3.0, 1e-9).length, 0.0);
        assert_eq!(parameter_at(&curve, 9.0, 0.0, 0.0).parameter(), 1.0);
    }

    /// A span whose speed is `speed(u)`, counting its evaluations.
    struct Counting<F> {
        speed: F,
        evaluations: Cell<usize>,
    }

    impl<F: Fn(f64) -> f64> Evaluate<f64, 1> for Counting<F> {
        fn domain(&self) -> (f64, f64) {
            (0.0, 1.0)
        }
        fn point(&self, _u: f64) -> [f64; 1] {
            [0.0]
        }
        fn span_count(&self) -> usize {
            1
        }
        fn span_bounds(&self, _span: usize) -> (f64, f64) {
            (0.0, 1.0)
        }
    }

    impl<F: Fn(f64) -> f64> Differentiate<f64, 1> for Counting<F> {
        fn derivatives(&self, u: f64) -> Derivatives<f64, 1> {
            self.derivatives_in(0, u)
        }
        fn derivatives_in(&self, _span: usize, u: f64) -> Derivatives<f64, 1> {
            self.evaluations.set(self.evaluations.get() + 1);
            Derivatives { point: [0.0], first: [(self.speed)(u)], second: [0.0] }
        }
    }

    #[test]
    fn a_cusp_is_resolved_and_costs_little() {
        let curve = Counting { speed: |u| u - 1.0 / 3.0, evaluations: Cell::new(0) };
        let found = arc_length(&curve, 0.0, 1.0, 1e-12);
        let expected = (1.0 / 9.0 + 4.0 / 9.0) / 2.0;
        assert!((found.length - expected).abs() <= 1e-12, "{found:?}");
        assert!(curve.evaluations.get() <= 1000, "{}", curve.evaluations.get());
    }

    /// All five places saw a speed that rises evenly: 0.98 came out, and a parameter that had converged at the wrong place.
    #[test]
    fn a_reversal_next_to_an_end_is_seen() {
        // (u - c)², and 1 - c from the other end.
        for c in [0.01_f64, 1e-3, 0.04, 0.99, 0.505, 0.123] {
            let points = vec![[c * c], [c * c - c], [(1.0 - c) * (1.0 - c)]];
            let curve = NurbsBuf::try_new_nonrational(2, points, vec![0., 0., 0., 1., 1., 1.]).unwrap();
            let exact = c * c + (1.0 - c) * (1.0 - c);
            let found = arc_length(&curve.as_curve(), 0.0, 1.0, 1e-12);
            assert!((found.length - exact).abs() <= 1e-12, "{c}: {found:?} for {exact}");
            let half = c * c + 0.25 * (1.0 - c) * (1.0 - c);
            let search = parameter_at(&curve.as_curve(), 0.0, half, 1e-12);
            let expected = c + 0.5 * (1.0 - c);
            assert!((search.parameter() - expected).abs() <= 1e-11, "{c}: {search:?} for {expected}");
        }
    }

    #[test]
    fn the_ends_of_a_smooth_span_cost_two_derivatives() {
        let curve = Counting { speed: |_| 3.0, evaluations: Cell::new(0) };
        assert_eq!(arc_length(&curve, 0.0, 1.0, 1e-12).length, 3.0);
        assert_eq!(curve.evaluations.get(), 17);
    }

    #[test]
    fn work_is_bounded_on_a_speed_that_is_noise() {
        let curve = Counting { speed: |u: f64| (u * 1e9).sin(), evaluations: Cell::new(0) };
        let found = arc_length(&curve, 0.0, 1.0, 0.0);
        assert!(found.estimated_error > 1e-3, "{found:?}");
        let bound = 5 + 12 * (MAX_PANELS + MAX_DEPTH); // those waiting when halving stops are still finished
        assert!(curve.evaluations.get() <= bound, "{} > {bound}", curve.evaluations.get());
    }
}
