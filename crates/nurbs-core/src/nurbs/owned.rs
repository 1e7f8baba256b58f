//! Curves that own their numbers.

use alloc::boxed::Box;
use alloc::vec::Vec;

use real::{Backend, Real};

use crate::{CurveError, KnotVector, NurbsCurve, Quantity};

/// A NURBS curve that owns its numbers; [`as_curve`](Self::as_curve) lends them for evaluation.
#[derive(Clone, Debug, PartialEq)]
pub struct NurbsBuf<R, const D: usize>(Numbers<R, D>);

#[derive(Clone, Debug, PartialEq)]
enum Numbers<R, const D: usize> {
    /// Those of a straight move, of which a program has millions: they take no heap.
    Line {
        control_points: [[R; D]; 2],
        weights: [R; 2],
        knots: [R; 4],
    },
    Any(Box<AnyNumbers<R, D>>),
}

#[derive(Clone, Debug, PartialEq)]
struct AnyNumbers<R, const D: usize> {
    degree: usize,
    control_points: Vec<[R; D]>,
    weights: Vec<R>,
    knots: Vec<R>,
    span_count: usize,
    /// The knot index of each span, if an inner knot is repeated.
    spans: Vec<usize>,
    rational: bool,
}

impl<R: Real, const D: usize> NurbsBuf<R, D> {
    /// The curve of `degree` p with control points `P_0 … P_n`, one weight each and knots `u_0 … u_{n+p+1}`.
    ///
    /// # Errors
    /// Those of [`NurbsCurve::try_new`].
    pub fn try_new(
        degree: usize,
        control_points: Vec<[R; D]>,
        weights: Vec<R>,
        knots: Vec<R>,
    ) -> Result<Self, CurveError> {
        let curve = NurbsCurve::try_new(degree, &control_points, &weights, &knots)?;
        let (span_count, rational) = (curve.knots.span_count(), curve.weights.is_some());
        let spans = curve.knots.repeated_spans();
        let line = (control_points.as_array(), weights.as_array(), knots.as_array());
        Ok(Self(match line {
            (Some(points), Some(weights), Some(knots)) if degree == 1 && !rational => {
                Numbers::Line { control_points: *points, weights: *weights, knots: *knots }
            }
            _ => Numbers::Any(Box::new(AnyNumbers {
                degree,
                control_points,
                weights,
                knots,
                span_count,
                spans,
                rational,
            })),
        }))
    }

    /// The curve whose weights are all 1.
    ///
    /// # Errors
    /// Those of [`NurbsCurve::try_new_nonrational`].
    pub fn try_new_nonrational(
        degree: usize,
        control_points: Vec<[R; D]>,
        knots: Vec<R>,
    ) -> Result<Self, CurveError> {
        let weights = alloc::vec![R::one(); control_points.len()];
        Self::try_new(degree, control_points, weights, knots)
    }

    /// The curve, borrowed; no check is repeated.
    #[must_use]
    pub fn as_curve(&self) -> NurbsCurve<'_, R, D> {
        let (span_count, spans, rational) = match &self.0 {
            Numbers::Line { .. } => (1, &[][..], false),
            Numbers::Any(any) => (any.span_count, &*any.spans, any.rational),
        };
        NurbsCurve {
            knots: KnotVector::from_valid(self.degree(), self.knots(), span_count, spans),
            control_points: self.control_points(),
            weights: rational.then_some(self.weights()),
        }
    }

    /// The degree p.
    #[must_use]
    pub fn degree(&self) -> usize {
        match &self.0 {
            Numbers::Line { .. } => 1,
            Numbers::Any(any) => any.degree,
        }
    }

    /// The control points `P_0 … P_n`, not multiplied by their weights.
    #[must_use]
    pub fn control_points(&self) -> &[[R; D]] {
        match &self.0 {
            Numbers::Line { control_points, .. } => control_points,
            Numbers::Any(any) => &any.control_points,
        }
    }

    /// The weights `w_0 … w_n`, also when they are all equal.
    #[must_use]
    pub fn weights(&self) -> &[R] {
        match &self.0 {
            Numbers::Line { weights, .. } => weights,
            Numbers::Any(any) => &any.weights,
        }
    }

    /// The knots `u_0 … u_{n+p+1}`.
    #[must_use]
    pub fn knots(&self) -> &[R] {
        match &self.0 {
            Numbers::Line { knots, .. } => knots,
            Numbers::Any(any) => &any.knots,
        }
    }
}

impl<const D: usize> NurbsBuf<f64, D> {
    /// The curve with every number rounded to the nearest of another format.
    ///
    /// Knots that become equal make their span vanish. This moves the curve by no more than the rounding of its
    /// numbers.
    ///
    /// # Errors
    /// [`CurveError::OutOfRange`] names the first number that does not fit, or the first weight that would become 0.
    /// [`CurveError::KnotsMerge`] names knots that become equal and whose multiplicity then exceeds the degree.
    /// [`CurveError::DomainTooWide`] and [`CurveError::ExtentTooWide`] say which difference does not fit.
    pub fn convert<Q: Backend>(&self) -> Result<NurbsBuf<Q, D>, CurveError> {
        let scalars = |what, numbers: &[f64]| -> Result<Vec<Q>, CurveError> {
            let number =
                |(index, x): (usize, &f64)| Q::from_f64(*x).ok_or(CurveError::OutOfRange { what, index });
            numbers.iter().enumerate().map(number).collect()
        };
        let knots = scalars(Quantity::Knot, self.knots())?;
        let weights = scalars(Quantity::Weight, self.weights())?;
        let mut control_points = Vec::with_capacity(self.control_points().len());
        for (index, point) in self.control_points().iter().enumerate() {
            let mut rounded = [Q::zero(); D];
            for (to, from) in rounded.iter_mut().zip(point) {
                *to = Q::from_f64(*from)
                    .ok_or(CurveError::OutOfRange { what: Quantity::ControlPoint, index })?;
            }
            control_points.push(rounded);
        }
        let merged = merged_knots(&knots, self.degree());
        NurbsBuf::try_new(self.degree(), control_points, weights, knots).map_err(|error| match error {
            CurveError::WeightNotPositive { index } => {
                CurveError::OutOfRange { what: Quantity::Weight, index }
            }
            CurveError::EmptyDomain
            | CurveError::NotClamped { .. }
            | CurveError::MultiplicityTooHigh { .. } => merged.unwrap_or(error),
            other => other,
        })
    }
}

/// The first run of equal knots that is longer than is allowed at its place.
fn merged_knots<R: Real>(knots: &[R], degree: usize) -> Option<CurveError> {
    let mut index = 0;
    for equal in knots.chunk_by(|a, b| a == b) {
        let multiplicity = equal.len();
        let at_an_end = index == 0 || index + multiplicity == knots.len();
        if multiplicity > degree + usize::from(at_an_end) {
            return Some(CurveError::KnotsMerge { index, multiplicity });
        }
        index += multiplicity;
    }
    None
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{Differentiate, Evaluate, golden};
    use alloc::vec;
    use real::{I4F4, I8F24, I16F16};

    fn curve(degree: usize, inner: &[f64], weight: f64) -> NurbsBuf<f64, 1> {
        let count = degree + 1 + inner.len();
        let knots = [&vec![0.0; degree + 1], inner, &vec![1.0; degree + 1]].concat();
        let points = (0..count).map(|i| [i as f64 / 2.0]).collect();
        let mut weights = vec![1.0; count];
        weights[1] = weight;
        NurbsBuf::try_new(degree, points, weights, knots).unwrap()
    }

    #[test]
    fn a_number_that_does_not_fit_is_named() {
        let far = golden::seed_000();
        assert_eq!(
            far.convert::<I8F24>().unwrap_err(),
            CurveError::OutOfRange { what: Quantity::ControlPoint, index: 0 }
        );
        assert_eq!(
            curve(2, &[], 1e-6).convert::<I16F16>().unwrap_err(),
            CurveError::OutOfRange { what: Quantity::Weight, index: 1 }
        );
        assert_eq!(
            curve(2, &[], 9.0).convert::<I4F4>().unwrap_err(),
            CurveError::OutOfRange { what: Quantity::Weight, index: 1 }
        );
        let late = NurbsBuf::try_new_nonrational(1, vec![[0.0], [1.0]], vec![0.0, 0.0, 9.0, 9.0]).unwrap();
        assert_eq!(
            late.convert::<I4F4>().unwrap_err(),
            CurveError::OutOfRange { what: Quantity::Knot, index: 2 }
        );
    }

    #[test]
    fn a_span_that_rounds_to_nothing_vanishes() {
        // I4F4 has steps of 1/16: 0.5 and 0.51 become one knot of multiplicity 2.
        let fine = curve(2, &[0.5, 0.51], 1.0);
        let coarse = fine.convert::<I4F4>().unwrap();
        assert_eq!((fine.as_curve().span_count(), coarse.as_curve().span_count()), (3, 2));
        let half = I4F4::from_ratio(1, 2);
        assert_eq!(coarse.as_curve().knots().multiplicity(half), 2);
        // A knot of multiplicity p is a control point of the curve, here P_2 = 1.
        assert_eq!(coarse.as_curve().point(half).map(I4F4::to_f64), [1.0]);
        assert!(coarse.as_curve().derivatives(half).first[0] > I4F4::from_ratio(1, 1));
    }

    #[test]
    fn knots_that_merge_beyond_the_degree_are_named() {
        assert_eq!(
            curve(2, &[0.5, 0.505, 0.51], 1.0).convert::<I4F4>().unwrap_err(),
            CurveError::KnotsMerge { index: 3, multiplicity: 3 }
        );
        assert_eq!(
            curve(2, &[0.01], 1.0).convert::<I4F4>().unwrap_err(),
            CurveError::KnotsMerge { index: 0, multiplicity: 4 }
        );
        assert_eq!(
            curve(2, &[0.5, 0.99], 1.0).convert::<I4F4>().unwrap_err(),
            CurveError::KnotsMerge { index: 4, multiplicity: 4 }
        );
        let short = NurbsBuf::try_new_nonrational(1, vec![[0.0], [1.0]], vec![0.0, 0.0, 0.01, 0.01]).unwrap();
        assert_eq!(
            short.convert::<I4F4>().unwrap_err(),
            CurveError::KnotsMerge { index: 0, multiplicity: 4 }
        );
    }

    #[test]
    fn a_conversion_to_the_same_format_changes_nothing() {
        let curve = golden::seed_003();
        assert_eq!(curve.convert::<f64>().unwrap(), curve);
        assert!(curve.as_curve().weights().is_some());
        assert!(golden::seed_000().as_curve().weights().is_none());
    }
}
