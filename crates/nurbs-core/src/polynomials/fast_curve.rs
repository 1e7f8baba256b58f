//! A curve in the form that is evaluated fastest, where that form is accurate.

use alloc::boxed::Box;

use crate::vector::{add, scaled, sub};
use crate::{Derivatives, Differentiate, Evaluate, NurbsCurve, PowerCurve};

/// The most that polynomials may lose, in units of a coordinate's last place. Where they may lose more, basis functions
/// are used.
const MOST_LOSS: f64 = 32768.0;

/// The curve on which a planner runs in f64. It has one polynomial a span, which takes a third to a tenth of the work
/// of basis functions. It has basis functions where the polynomials of [`PowerCurve`] may lose more than 2¹⁵ units, for
/// example where the weights of a cubic differ more than eightfold.
#[derive(Clone, Debug)]
pub enum FastCurve<'a, const D: usize> {
    /// One polynomial of degree 1 in all. A program has millions of them, so it owns nothing.
    Line(FastLine<'a, D>),
    /// One polynomial a span.
    Polynomials(Box<PowerCurve<D>>),
    /// Basis functions.
    Basis(Box<NurbsCurve<'a, f64, D>>),
}

/// The straight line `A + t (B - A)`, `t = (u - u₀)/(u₁ - u₀)`: what [`PowerCurve`] makes of it, bit by bit.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FastLine<'a, const D: usize> {
    ends: &'a [[f64; D]; 2],
    knots: &'a [f64; 4],
}

impl<'a, const D: usize> FastLine<'a, D> {
    /// The form of a curve that is one line; `None` for any other.
    fn of(curve: &NurbsCurve<'a, f64, D>) -> Option<Self> {
        let line =
            Self { ends: curve.control_points().as_array()?, knots: curve.knots().as_slice().as_array()? };
        (curve.degree() == 1 && curve.weights().is_none()).then_some(line)
    }

    fn reciprocal(&self) -> f64 {
        let (first, last) = self.domain();
        1.0 / (last - first)
    }

    fn way(&self) -> [f64; D] {
        sub(&self.ends[1], &self.ends[0])
    }
}

impl<const D: usize> Evaluate<f64, D> for FastLine<'_, D> {
    fn domain(&self) -> (f64, f64) {
        (self.knots[0], self.knots[3])
    }

    fn point(&self, u: f64) -> [f64; D] {
        add(&scaled(&self.way(), (u - self.knots[0]) * self.reciprocal()), &self.ends[0])
    }

    fn span_count(&self) -> usize {
        1
    }

    fn span_bounds(&self, _: usize) -> (f64, f64) {
        self.domain()
    }
}

impl<const D: usize> Differentiate<f64, D> for FastLine<'_, D> {
    fn derivatives(&self, u: f64) -> Derivatives<f64, D> {
        Derivatives { point: self.point(u), first: scaled(&self.way(), self.reciprocal()), second: [0.0; D] }
    }

    fn derivatives_in(&self, _: usize, u: f64) -> Derivatives<f64, D> {
        self.derivatives(u)
    }

    fn is_line(&self, _: usize) -> bool {
        true
    }
}

impl<'a, const D: usize> FastCurve<'a, D> {
    /// The form for this curve.
    #[must_use]
    pub fn of(curve: NurbsCurve<'a, f64, D>) -> Self {
        if let Some(line) = FastLine::of(&curve) {
            Self::Line(line)
        } else if loss(&curve) <= MOST_LOSS {
            Self::Polynomials(Box::new(PowerCurve::new::<f64>(&curve)))
        } else {
            Self::Basis(Box::new(curve))
        }
    }
}

/// The loss in units of the last place: `3^p`, times `16 (W/v)²` with weights from v to W. See [`PowerCurve`]'s points.
fn loss<const D: usize>(curve: &NurbsCurve<'_, f64, D>) -> f64 {
    let power = (0..curve.degree()).fold(1.0, |power, _| 3.0 * power);
    let Some(weights) = curve.weights() else { return power };
    let (least, most) =
        weights.iter().fold((f64::MAX, 0.0_f64), |(least, most), w| (least.min(*w), most.max(*w)));
    16.0 * power * (most / least) * (most / least)
}

/// Runs the same expression on either form.
macro_rules! on_form {
    ($self:expr, $curve:ident => $answer:expr) => {
        match $self {
            FastCurve::Line($curve) => $answer,
            FastCurve::Polynomials($curve) => $answer,
            FastCurve::Basis($curve) => $answer,
        }
    };
}

impl<const D: usize> Evaluate<f64, D> for FastCurve<'_, D> {
    fn domain(&self) -> (f64, f64) {
        on_form!(self, curve => curve.domain())
    }

    #[inline]
    fn point(&self, u: f64) -> [f64; D] {
        on_form!(self, curve => curve.point(u))
    }

    fn span_count(&self) -> usize {
        on_form!(self, curve => curve.span_count())
    }

    fn span_bounds(&self, span: usize) -> (f64, f64) {
        on_form!(self, curve => curve.span_bounds(span))
    }
}

impl<const D: usize> Differentiate<f64, D> for FastCurve<'_, D> {
    fn derivatives(&self, u: f64) -> Derivatives<f64, D> {
        on_form!(self, curve => curve.derivatives(u))
    }

    fn derivatives_in(&self, span: usize, u: f64) -> Derivatives<f64, D> {
        on_form!(self, curve => curve.derivatives_in(span, u))
    }

    fn is_line(&self, span: usize) -> bool {
        on_form!(self, curve => curve.is_line(span))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{NurbsBuf, generate, golden};
    use proptest::prelude::*;

    fn is_polynomial<const D: usize>(curve: &NurbsBuf<f64, D>) -> bool {
        matches!(FastCurve::of(curve.as_curve()), FastCurve::Polynomials(_))
    }

    #[test]
    fn basis_functions_serve_where_polynomials_lose_too_much() {
        let curve = golden::seed_003();
        assert!(
            is_polynomial(&golden::seed_000())
                && is_polynomial(&curve)
                && is_polynomial(&golden::circle(1.0))
        );
        let weighted = |most: f64| {
            let mut weights = curve.weights().to_vec();
            weights.fill(1.0);
            weights[4] = most;
            let (points, knots) = (curve.control_points().to_vec(), curve.knots().to_vec());
            NurbsBuf::try_new(curve.degree(), points, weights, knots).unwrap()
        };
        assert!(is_polynomial(&weighted(8.0)) && !is_polynomial(&weighted(9.0)));
        assert!(!is_polynomial(&weighted(1e-6)));
    }

    #[test]
    fn a_line_is_what_polynomials_make_of_it() {
        let ends = vec![[3.1, -7.3], [1234.567, 0.1]];
        let line = NurbsBuf::try_new_nonrational(1, ends, vec![0.5, 0.5, 2.2, 2.2]).unwrap();
        let (fast, power) = (FastCurve::of(line.as_curve()), PowerCurve::new::<f64>(&line.as_curve()));
        assert!(matches!(fast, FastCurve::Line(_)) && fast.is_line(0));
        assert_eq!((fast.domain(), fast.span_bounds(0)), (power.domain(), power.span_bounds(0)));
        for u in (0..=100).map(|i| 0.5 + 1.7 * f64::from(i) / 100.0) {
            assert_eq!(fast.derivatives(u), power.derivatives(u));
            assert_eq!(
                (fast.point(u), fast.derivatives_in(0, u)),
                (power.point(u), power.derivatives_in(0, u))
            );
        }
    }

    proptest! {
        /// Spans, points and derivatives are those of the curve, within what the form may lose.
        #[test]
        fn both_forms_are_the_curve((curve, span, t) in generate::curve_span_and_fraction::<2>()) {
            let (curve, fast) = (curve.as_curve(), FastCurve::of(curve.as_curve()));
            prop_assert_eq!((fast.domain(), fast.span_count()), (curve.domain(), curve.span_count()));
            let (a, b) = curve.span_bounds(span);
            prop_assert_eq!(fast.span_bounds(span), (a, b));
            let u = a + (b - a) * t;
            let (found, exact) = (fast.derivatives_in(span, u), curve.derivatives_in(span, u));
            let (looked_up, point) = (fast.derivatives(u), fast.point(u));
            // 1000 mm of extent; each differentiation magnifies by p over the width and the ratio of weights.
            let bound = 4.0 * f64::EPSILON * 1000.0 * (MOST_LOSS + 1.0);
            let growth = 2.0 * curve.degree() as f64 / (b - a) * 100.0;
            let off = |found: &[f64; 2], exact: &[f64; 2]| (found[0] - exact[0]).abs().max((found[1] - exact[1]).abs());
            for point in [found.point, looked_up.point, point] {
                prop_assert!(off(&point, &exact.point) <= bound);
            }
            prop_assert!(off(&found.first, &exact.first) <= bound * growth);
            prop_assert!(off(&found.second, &exact.second) <= bound * growth * growth);
        }
    }
}
