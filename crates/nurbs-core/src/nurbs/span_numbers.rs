//! The numbers that shape a curve in one span, and the point that they give.

use real::Real;

use crate::KnotVector;
use crate::nurbs::basis::BasisRows;
use crate::nurbs::degree::{CUBIC, SCRATCH};
use crate::nurbs::knots::{LocalKnots, window};
use crate::vector::weighted_sum;

/// The numbers that shape a curve in the span at one knot index i.
#[derive(Clone, Copy)]
pub(crate) struct SpanNumbers<'a, R, const D: usize> {
    /// `u_{i-p+1} … u_{i+p}`.
    pub(crate) knots: LocalKnots<'a, R>,
    /// `P_{i-p} … P_i`.
    pub(crate) points: &'a [[R; D]],
    /// `w_{i-p} … w_i`, or `None` when all weights of the curve are equal.
    pub(crate) weights: Option<&'a [R]>,
}

impl<'a, R: Real, const D: usize> SpanNumbers<'a, R, D> {
    /// Those of the span at knot index `span`, out of a curve's.
    #[inline(always)]
    pub(crate) fn at(
        span: usize,
        knots: &KnotVector<'a, R>,
        points: &'a [[R; D]],
        weights: Option<&'a [R]>,
    ) -> Self {
        let active = span.saturating_sub(knots.degree())..span + 1;
        Self {
            knots: knots.around(span),
            points: points.get(active.clone()).unwrap_or_default(),
            weights: weights.map(|weights| weights.get(active).unwrap_or_default()),
        }
    }

    /// The same of a cubic; `None` of another degree. The compiler knows how many numbers there are, so that it leaves no
    /// loop over them.
    #[inline(always)]
    pub(crate) fn at_cubic(
        span: usize,
        knots: &KnotVector<'a, R>,
        points: &'a [[R; D]],
        weights: Option<&'a [R]>,
    ) -> Option<Self> {
        if knots.degree() != CUBIC {
            return None;
        }
        let first = span.checked_sub(CUBIC)?;
        let weights = match weights {
            Some(weights) => Some(window::<{ CUBIC + 1 }, _>(weights, first)?),
            None => None,
        };
        let points = window::<{ CUBIC + 1 }, _>(points, first)?;
        Some(Self { knots: knots.around_cubic(span)?, points, weights })
    }

    /// The point that these basis functions give.
    #[inline(always)] // For each degree that is compiled apart.
    pub(crate) fn point(&self, rows: BasisRows<R>) -> [R; D] {
        let mut basis = rows.degree_p;
        self.make_rational(&mut basis);
        weighted_sum(&basis, self.points)
    }

    /// Turns basis functions `N_i` into rational ones, `R_i = w_i N_i / Σ w_j N_j`, and returns the denominator.
    ///
    /// The weights multiply the functions, not the points. So every intermediate is no larger than the largest weight,
    /// whatever the coordinates are, and the only nonzero function at a clamped end is exactly 1.
    #[inline(always)]
    pub(crate) fn make_rational(&self, basis: &mut [R; SCRATCH]) -> R {
        let Some(weights) = self.weights else { return R::one() };
        let mut denominator = R::zero();
        for (function, weight) in basis.iter_mut().zip(weights) {
            *function = *function * *weight;
            denominator = denominator + *function;
        }
        for function in basis.iter_mut().take(weights.len()) {
            *function = *function / denominator;
        }
        denominator
    }
}
