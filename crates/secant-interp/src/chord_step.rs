//! The step without loss: the parameter increment of a chord, on one compiled piece.
//!
//! Sought is the step η that makes the chord L long. The chord from the present point is `η q(η)/w(η)`, known
//! without cancellation (see [`Pieces`](nurbs_core::Pieces)); b is what has been travelled on pieces before this
//! one, in units of L, and 0 on the common path. The unknown is not η but the step per chord, `σ = η/L`, which is
//! of order one whatever the feed, and hardly changes from step to step. Its residual
//!
//! `f(σ) = |b w + σ q|² - w²`, `q = q̃_1 + x(q̃_2 + x q̃_3 + …)`, `w = 1 + x(ω̃_1 + …)`, `x = 2^-r σL`
//!
//! is of order one too, takes neither a root nor a division, and its precision relative to the chord does not
//! shrink with the step. With b = 0 the slope is `df/dσ = (2/σ)(1 + f + g)` with
//! `g = σ² q·(x q') - w (x w') + w² - 1`, the growth of the speed over the step; to second order in f and g the
//! correction is
//!
//! `σ ← σ - σ f/2 (1 - g + g² - ¾f)`,
//!
//! again without a division. It leaves an error of the order of |f| (|f| + |g|)³, so a second evaluation is owed only
//! when |f| is above a threshold that the wanted fluctuation sets.

use nurbs_core::Shifted;
use real::Real;

/// When the correction is repeated.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ChordTolerance<R> {
    /// The largest |f| whose one correction is enough.
    pub residual: R,
    /// K: evaluations of f in a period, at most.
    pub max_evaluations: u32,
}

/// A chord that is to be completed on a piece.
#[derive(Clone, Copy, Debug)]
pub struct Chord<'a, R, const D: usize> {
    /// The piece's polynomials about the point where the step on it begins.
    pub at: &'a Shifted<R, D>,
    /// p.
    pub degree: usize,
    /// Whether W is not 1.
    pub rational: bool,
    /// r: the polynomials go by the step over 2^r.
    pub range_exponent: i32,
    /// L, in chord units.
    pub length: R,
    /// b: what has been travelled on pieces before, over L; `None` on the common path.
    pub before: Option<[R; D]>,
    /// Least and greatest σ.
    pub range: [R; 2],
}

/// The values of one evaluation.
struct Evaluation<R> {
    residual: R,
    /// g, for b = 0; ½ df/dσ for b ≠ 0.
    slope: R,
}

impl<R: Real, const D: usize> Chord<'_, R, D> {
    /// Solves for σ from the start value `sigma`; returns it with the evaluations made.
    #[must_use]
    pub fn solve(&self, sigma: R, tolerance: &ChordTolerance<R>) -> (R, u32) {
        let mut sigma = self.clamp(sigma);
        let mut evaluations = 0;
        while evaluations < tolerance.max_evaluations.max(1) {
            evaluations += 1;
            let value = self.evaluate(sigma);
            let next = self.clamp(sigma - self.correction(sigma, &value));
            let unchanged = next == sigma;
            sigma = next;
            if value.residual.abs() <= tolerance.residual || unchanged {
                break;
            }
        }
        (sigma, evaluations)
    }

    #[inline]
    fn clamp(&self, sigma: R) -> R {
        sigma.max(self.range[0]).min(self.range[1]).signal("step_per_chord")
    }

    #[inline]
    fn correction(&self, sigma: R, value: &Evaluation<R>) -> R {
        let f = value.residual.max(-R::one()).min(R::one());
        if self.before.is_some() {
            // Only where a joint is crossed: one division.
            let bound = self.range[1].half();
            return (f.half() / value.slope).max(-bound).min(bound);
        }
        let g = value.slope;
        let factor = R::one() - g + g * g - f.half() - f.scale(-2);
        (sigma * f).half() * factor
    }

    #[inline]
    fn evaluate(&self, sigma: R) -> Evaluation<R> {
        let x = (sigma * self.length).signal("step").scale(-self.range_exponent);
        let mut chord = [R::zero(); D];
        let mut turn = [R::zero(); D];
        for c in self.at.chord[..self.degree].iter().rev() {
            for d in 0..D {
                turn[d] = turn[d].mul_add(x, chord[d]);
                chord[d] = chord[d].mul_add(x, c[d]).signal("chord_per_step");
            }
        }
        let turn = turn.map(|t| (t * x).signal("chord_turn"));
        let (weight, weight_turn) = if self.rational { self.weight(x) } else { (R::one(), R::zero()) };
        let direction = core::array::from_fn::<R, D, _>(|d| {
            let along = (sigma * chord[d]).signal("chord_direction");
            match self.before {
                Some(before) => before[d].mul_add(weight, along),
                None => along,
            }
        });
        let squares = direction.iter().map(|x| (*x, *x));
        let residual = R::sum_of_products(squares.chain([(-weight, weight)])).signal("chord_residual");
        let slope = match self.before {
            None => {
                let growth = (0..D).map(|d| (direction[d], sigma * turn[d]));
                let lightening = [(-weight, weight_turn), (weight, weight), (-R::one(), R::one())];
                R::sum_of_products(growth.chain(lightening))
            }
            Some(before) => {
                let rise = if self.rational { weight_turn / sigma } else { R::zero() };
                let growth = (0..D).map(|d| (direction[d], before[d].mul_add(rise, chord[d] + turn[d])));
                R::sum_of_products(growth.chain([(-weight, rise)]))
            }
        };
        Evaluation { residual, slope }
    }

    /// W and x W' at the trial step, over W at the present point.
    #[inline]
    fn weight(&self, x: R) -> (R, R) {
        let (mut value, mut turn) = (R::zero(), R::zero());
        for w in self.at.weight[..self.degree].iter().rev() {
            turn = turn.mul_add(x, value);
            value = value.mul_add(x, *w);
        }
        // value = ω̃_1 + ω̃_2 x + …, so W = 1 + x value and W' = value + x·(its derivative).
        (value.mul_add(x, R::one()), turn.mul_add(x, value) * x)
    }
}
