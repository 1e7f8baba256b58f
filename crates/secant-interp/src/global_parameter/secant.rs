//! The secant iteration for the next parameter, safeguarded.
//!
//! The root is ξ > u_i with `F(ξ) = |C(ξ) - C(u_i)| - L = 0`. The iteration of paper A, equation (5),
//!
//! `ξ_{k+1} = ξ_k - F(ξ_k)(ξ_k - ξ_{k-1})/(F(ξ_k) - F(ξ_{k-1}))`
//!
//! converges superlinearly near the root but has no safety of its own. F has a kink at u_i and a second root before it,
//! and two equal residuals divide by zero, as happens all the time in coarse formats. Here every residual also narrows
//! a bracket: F < 0 at its lower end (at first u_i, where F = -L), F ≥ 0 at its upper end. A trial outside the bracket
//! is replaced by the bracket's middle. Where the denominator vanishes, the secant through u_i takes its place. The
//! best trial so far is the result. So ξ never goes behind u_i, and the number of evaluations is at most
//! `max_iterations + 2`.

use real::Real;

/// When the iteration stops.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Tolerance<R> {
    /// ε: the largest change of the parameter in the last iteration.
    pub parameter: R,
    /// Δ: the largest feedrate fluctuation |F|/L. Both tolerances must be met.
    pub fluctuation: R,
    /// K: the iterations after which the best trial is taken as it is.
    pub max_iterations: u32,
}

/// How the iteration ended.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Outcome {
    /// Both tolerances are met.
    Converged,
    /// No further trial lies between the bracket's ends: the format's resolution is exhausted.
    ResolutionReached,
    /// K iterations were not enough.
    LimitReached,
}

/// The parameter found.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Root<R, P> {
    /// ξ, at least `from`.
    pub u: R,
    /// The point that `evaluate` returned with the residual.
    pub point: P,
    /// F(ξ).
    pub residual: R,
    /// How often `evaluate` was called.
    pub evaluations: u32,
    /// How the iteration ended.
    pub outcome: Outcome,
}

/// A trial parameter, its residual and its point.
#[derive(Clone, Copy)]
struct Trial<R, P> {
    u: R,
    residual: R,
    point: P,
}

/// The interval that holds the root.
struct Bracket<R> {
    lower: R,
    upper: Option<R>,
    ceiling: R,
}

impl<R: Real> Bracket<R> {
    fn narrow<P>(&mut self, trial: &Trial<R, P>) {
        if trial.residual < R::zero() {
            self.lower = self.lower.max(trial.u);
        } else {
            self.upper = Some(self.upper.map_or(trial.u, |upper| upper.min(trial.u)));
        }
    }

    /// `u` if it lies inside the bracket. Otherwise the bracket's middle, or, without an upper end, twice the distance
    /// from `origin`. In no case beyond the ceiling.
    fn admit(&self, u: R, origin: R) -> R {
        let beyond_upper = self.upper.is_some_and(|upper| u >= upper);
        let inside = if u > self.lower && !beyond_upper {
            u
        } else {
            match self.upper {
                Some(upper) => self.lower + (upper - self.lower).half(),
                None => self.lower + (self.lower - origin).max(R::resolution()),
            }
        };
        inside.min(self.ceiling)
    }
}

/// Solves `F(ξ) = 0` for `from ≤ ξ ≤ ceiling`, from the start values `older` and `newer`, of which the newer
/// should be the better one.
///
/// `evaluate(ξ)` gives `(F(ξ), C(ξ))`. Both start values must lie in the interval too. `step_length` is L, the unit of
/// the fluctuation. Where F < 0 in the whole interval the result is the ceiling.
pub fn solve<R: Real, P: Copy>(
    (from, ceiling): (R, R),
    (older, newer): (R, R),
    step_length: R,
    tolerance: &Tolerance<R>,
    mut evaluate: impl FnMut(R) -> (R, P),
) -> Root<R, P> {
    let mut evaluations = 0;
    let mut attempt = |u: R| {
        evaluations += 1;
        let (residual, point) = evaluate(u);
        Trial { u, residual: residual.signal("secant_residual"), point }
    };
    let mut bracket = Bracket { lower: from, upper: None, ceiling };
    let mut previous = attempt(older);
    bracket.narrow(&previous);
    let mut current = attempt(newer);
    bracket.narrow(&current);
    let mut best = nearer(previous, current);
    let allowed = tolerance.fluctuation * step_length;

    let mut outcome = Outcome::LimitReached;
    for _ in 0..tolerance.max_iterations {
        // Two equal trials have no secant. The secant through u_i, where F = -L, takes its place.
        let (mut run, mut rise) = (current.u - previous.u, current.residual - previous.residual);
        if run.is_zero() || rise.is_zero() {
            (run, rise) = (current.u - from, current.residual + step_length);
        }
        let slope_step = if rise.is_zero() { R::zero() } else { current.residual * (run / rise) };
        let next = bracket.admit(current.u - slope_step, from);
        if next == current.u || next <= bracket.lower {
            outcome =
                if best.residual.abs() <= allowed { Outcome::Converged } else { Outcome::ResolutionReached };
            break;
        }
        previous = current;
        current = attempt(next);
        bracket.narrow(&current);
        best = nearer(best, current);
        if (current.u - previous.u).abs() <= tolerance.parameter && current.residual.abs() <= allowed {
            outcome = Outcome::Converged;
            break;
        }
    }
    Root { u: best.u, point: best.point, residual: best.residual, evaluations, outcome }
}

/// The trial with the smaller residual; the second of two equal ones.
fn nearer<R: Real, P>(first: Trial<R, P>, second: Trial<R, P>) -> Trial<R, P> {
    if first.residual.abs() < second.residual.abs() { first } else { second }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;
    use real::{Backend, I16F16};

    const TIGHT: Tolerance<f64> = Tolerance { parameter: 1e-9, fluctuation: 1e-12, max_iterations: 20 };

    #[test]
    fn finds_the_root_of_a_smooth_residual() {
        let root = solve((1.0, 9.0), (1.8, 2.1), 1.0, &TIGHT, |u: f64| (u * u - 4.0, ()));
        assert_eq!(root.outcome, Outcome::Converged);
        assert!((root.u - 2.0).abs() < 1e-12, "{}", root.u);
    }

    #[test]
    fn equal_residuals_do_not_divide_by_zero() {
        let flat = |u: f64| (if u < 3.0 { -1.0 } else { 1.0 }, ());
        let root = solve((1.0, 9.0), (1.5, 2.0), 1.0, &TIGHT, flat);
        assert!(root.u > 1.0 && root.evaluations <= 22);
    }

    /// Where three increments are equal, as they often are in a coarse format, (6) and (7) give the same start value.
    /// The iteration once stopped there, with whatever residual that had.
    #[test]
    fn equal_start_values_are_no_end() {
        let root = solve((1.0, 9.0), (1.5, 1.5), 1.0, &TIGHT, |u: f64| (u * u - 4.0, ()));
        assert!((root.u - 2.0).abs() < 1e-9, "{root:?}");
    }

    #[test]
    fn the_root_behind_the_start_is_never_taken() {
        // |u - 1| - ½ has its other root at ½; a start value close to the kink aims there.
        let root = solve((1.0, 9.0), (1.02, 1.01), 0.5, &TIGHT, |u: f64| ((u - 1.0).abs() - 0.5, ()));
        assert!((root.u - 1.5).abs() < 1e-9, "{root:?}");
    }

    proptest! {
        /// Whatever the residual does, the result lies ahead and the evaluations are bounded.
        #[test]
        fn is_total(values in proptest::collection::vec(-1e3..1e3_f64, 12), a in 0.0..10.0, b in 0.0..10.0) {
            let mut call = 0;
            let wild = |_: I16F16| {
                call += 1;
                (I16F16::from_f64(values[call % values.len()]).unwrap(), ())
            };
            let fixed = |x: f64| I16F16::from_f64(x).unwrap();
            let tolerance = Tolerance {
                parameter: I16F16::resolution(), fluctuation: I16F16::resolution(), max_iterations: 5,
            };
            let root = solve((fixed(1.0), fixed(20.0)), (fixed(1.1 + a), fixed(1.1 + b)), fixed(0.5), &tolerance, wild);
            prop_assert!(root.u >= fixed(1.0) && root.evaluations <= 7);
        }
    }
}
