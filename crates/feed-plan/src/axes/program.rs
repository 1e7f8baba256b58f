//! The program: the least time under rows of limits, by an interior point.
//!
//! With the unknowns x of the [spline](crate::axes::spline), each row says `w·x ≤ r`, where r is 1 or, for a jerk, `1/√(p·x)`; the
//! time is a sum of `q/√(p·x)`. `1/√` is convex: so is the time, and the tangent of a jerk's right side lies below it, which makes
//! a step that keeps the linear rows keep the true ones.
//!
//! Slacks s and multipliers λ, both positive; G the rows' slopes. Each iteration solves, twice with the same factors, for the step of
//!
//! ```text
//! ∇f + Gᵀλ = 0        w·x - r + s = 0        s λ = σμ
//! ```
//!
//! after elimination of s and λ: `(H + Gᵀ (λ/s) G) Δx = -(∇f + Gᵀλ) + Gᵀ ((rc - λ rp)/s)`, pentadiagonal, H that of the time
//! alone. The first solution has σ = 0, and says which σ the second takes: Mehrotra's predictor and corrector.
//!
//! # Source
//! Mehrotra S., "On the implementation of a primal-dual interior point method", SIAM J. Optim. 2 (1992); Nocedal J., Wright S.,
//! *Numerical Optimization*, 19.3. The jerk rows' own curvature is left out of H, where it would be negative.

use alloc::vec::Vec;

use real::Real;

use crate::axes::pentadiagonal::Pentadiagonal;
use crate::axes::spline::Functional;
use crate::cube_root::cube_root;

/// Steps end this far from where the first slack or multiplier would vanish.
const TO_THE_BOUNDARY: f64 = 0.995;
/// The gap is not made less than this share of what is left of the slope: multipliers that have all but vanished do not come back.
const WEIGHT_OF_SLOPE: f64 = 0.3;
/// Share of its right side that a row's left side has at most in a first guess.
const ROOM: f64 = 0.9;
/// The factor by which a first guess is slowed at most.
const SLOWEST: f64 = 2.0;
/// The gap tells how short the time may become where rows are broken by no more than this.
const SEEN: f64 = 1e-3;
/// No value of b falls below this share of what it was in one step.
const LEAST_SHARE: f64 = 0.5;

/// `w·x ≤ 1`, or, if there is a p, `w·x ≤ 1/√(p·x)`.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Row {
    pub(crate) w: Functional,
    pub(crate) p: Option<[f64; 3]>,
}

/// One term `weight/√b` of the time.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Term {
    pub(crate) b: Functional,
    pub(crate) weight: f64,
}

/// The program.
pub(crate) struct Program {
    pub(crate) terms: Vec<Term>,
    pub(crate) rows: Vec<Row>,
}

/// When to stop.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Stop {
    /// The time is this near to the least, as a ratio.
    pub(crate) gap: f64,
    pub(crate) iterations: u32,
    /// None is sought that takes as long as this: the iterations end where the gap shows that the least time is no shorter.
    pub(crate) below: f64,
}

/// A solution.
#[derive(Clone, Debug)]
pub(crate) struct Solution {
    pub(crate) x: Vec<f64>,
    pub(crate) iterations: u32,
}

/// What the iterations change, row by row.
struct State {
    x: Vec<f64>,
    slack: Vec<f64>,
    multiplier: Vec<f64>,
    /// The slope of each row.
    slope: Vec<[f64; 3]>,
    /// `w·x - r + s`.
    residual: Vec<f64>,
}

/// A step.
struct Step {
    x: Vec<f64>,
    slack: Vec<f64>,
    multiplier: Vec<f64>,
}

impl Program {
    /// The solution found from a first guess, all of whose b are positive, with a gap of this share of the time; `None` if it is not
    /// reached within the iterations, or takes too long.
    pub(crate) fn solve(&self, guess: Vec<f64>, gap: f64, stop: Stop) -> Option<Solution> {
        let mut state = self.start(self.slowed(guess), gap)?;
        let count = self.rows.len().max(1) as f64;
        let mut matrix = Pentadiagonal::zeros(state.x.len());
        for iterations in 0..=stop.iterations {
            let time = self.time(&state.x);
            let mean = dot(&state.slack, &state.multiplier) / count;
            let infeasible = state.residual.iter().fold(0.0_f64, |most, residual| most.max(residual.abs()));
            if !(time < f64::MAX && mean < f64::MAX && infeasible < f64::MAX) {
                return None;
            }
            let slope = self.slope(&state);
            let off = slope.iter().zip(&state.x).fold(0.0, |sum, (slope, x)| sum + (slope * x).abs());
            if mean * count <= stop.gap * time && infeasible <= stop.gap && off <= 10.0 * stop.gap * time {
                return (time < stop.below).then_some(Solution { x: state.x, iterations });
            }
            if infeasible <= SEEN && time - mean * count - off >= stop.below {
                return None;
            }
            self.assemble(&mut matrix, &state);
            if !matrix.factor() {
                return None;
            }
            let affine = self.step(&matrix, &state, &slope, |_| 0.0);
            let (primal, dual) =
                (self.reach(&state, &affine, 1.0), reach(&state.multiplier, &affine.multiplier, 1.0));
            let mean_after = (0..state.slack.len()).fold(0.0, |sum, i| {
                sum + (state.slack[i] + primal * affine.slack[i])
                    * (state.multiplier[i] + dual * affine.multiplier[i])
            }) / count;
            let ratio = (mean_after / mean).clamp(0.0, 1.0);
            let centred = (ratio * ratio * ratio * mean).max(WEIGHT_OF_SLOPE * off.min(time) / count);
            let step =
                self.step(&matrix, &state, &slope, |i| centred - affine.slack[i] * affine.multiplier[i]);
            self.take(&mut state, &step);
        }
        None
    }

    /// The time of a solution.
    pub(crate) fn time(&self, x: &[f64]) -> f64 {
        self.terms.iter().fold(0.0, |sum, term| sum + term.weight / Real::sqrt(term.b.of(x)))
    }

    /// A guess slowed evenly, `b/η²`, until no row is above [`ROOM`], but by no more than [`SLOWEST`].
    fn slowed(&self, mut x: Vec<f64>) -> Vec<f64> {
        let mut factor = 1.0_f64;
        for row in &self.rows {
            let value = row.w.of(&x) / ROOM;
            factor = factor.max(match row.p {
                None => Real::sqrt(value.max(0.0)),
                Some(weights) => {
                    let taken = value * Real::sqrt(Functional { weights, ..row.w }.of(&x).max(0.0));
                    if taken > factor * factor * factor { cube_root(taken) } else { factor }
                }
            });
        }
        let factor = factor.min(SLOWEST);
        x.iter_mut().for_each(|x| *x /= factor * factor);
        x
    }

    fn start(&self, x: Vec<f64>, gap: f64) -> Option<State> {
        let rows = self.rows.len();
        let empty = || alloc::vec![0.0; rows];
        let (slack, multiplier, residual) = (empty(), empty(), empty());
        let mut state = State { x, slack, multiplier, slope: alloc::vec![[0.0; 3]; rows], residual };
        if self.terms.iter().any(|term| !(term.b.of(&state.x) > 0.0)) {
            return None;
        }
        self.look(&mut state);
        let each = gap * self.time(&state.x) / rows.max(1) as f64;
        for i in 0..rows {
            state.slack[i] = (-state.residual[i]).max(gap.min(0.1));
            state.multiplier[i] = each / state.slack[i];
            state.residual[i] += state.slack[i];
        }
        Some(state)
    }

    /// The rows' values and slopes at x.
    fn look(&self, state: &mut State) {
        for (i, row) in self.rows.iter().enumerate() {
            let value = row.w.of(&state.x);
            (state.slope[i], state.residual[i]) = match row.p {
                None => (row.w.weights, value - 1.0 + state.slack[i]),
                Some(weights) => {
                    let b = Functional { weights, ..row.w }.of(&state.x);
                    let most = 1.0 / Real::sqrt(b);
                    let bend = 0.5 * most / b;
                    let slope = core::array::from_fn(|k| row.w.weights[k] + bend * weights[k]);
                    (slope, value - most + state.slack[i])
                }
            };
        }
    }

    /// `∇f + Gᵀλ`.
    fn slope(&self, state: &State) -> Vec<f64> {
        let mut slope = alloc::vec![0.0; state.x.len()];
        for term in &self.terms {
            let b = term.b.of(&state.x);
            add(&mut slope, term.b.first, &term.b.weights, -0.5 * term.weight / (b * Real::sqrt(b)));
        }
        for (i, row) in self.rows.iter().enumerate() {
            add(&mut slope, row.w.first, &state.slope[i], state.multiplier[i]);
        }
        slope
    }

    /// `H + Gᵀ (λ/s) G`.
    fn assemble(&self, matrix: &mut Pentadiagonal, state: &State) {
        matrix.clear();
        for term in &self.terms {
            let b = term.b.of(&state.x);
            matrix.add_square(term.b.first, &term.b.weights, 0.75 * term.weight / (b * b * Real::sqrt(b)));
        }
        for (i, row) in self.rows.iter().enumerate() {
            matrix.add_square(row.w.first, &state.slope[i], state.multiplier[i] / state.slack[i]);
        }
    }

    /// The step to `s λ` = what `aim` says of each row.
    fn step(&self, matrix: &Pentadiagonal, state: &State, slope: &[f64], aim: impl Fn(usize) -> f64) -> Step {
        let rows = self.rows.len();
        let mut x: Vec<f64> = slope.iter().map(|slope| -slope).collect();
        let mut multiplier = alloc::vec![0.0; rows];
        for (i, row) in self.rows.iter().enumerate() {
            let (slack, factor) = (state.slack[i], state.multiplier[i]);
            multiplier[i] = slack * factor - aim(i);
            add(&mut x, row.w.first, &state.slope[i], (multiplier[i] - factor * state.residual[i]) / slack);
        }
        matrix.solve(&mut x);
        let mut slack = alloc::vec![0.0; rows];
        for (i, row) in self.rows.iter().enumerate() {
            let along = Functional { weights: state.slope[i], ..row.w }.of(&x);
            slack[i] = -state.residual[i] - along;
            multiplier[i] = -(multiplier[i] + state.multiplier[i] * slack[i]) / state.slack[i];
        }
        Step { x, slack, multiplier }
    }

    /// The share of a step that keeps slacks and every b positive.
    fn reach(&self, state: &State, step: &Step, share: f64) -> f64 {
        let by_slacks = reach(&state.slack, &step.slack, share);
        self.terms.iter().fold(by_slacks, |reach, term| {
            let (b, change) = (term.b.of(&state.x), term.b.of(&step.x));
            if change < 0.0 { reach.min((1.0 - LEAST_SHARE) * b / -change) } else { reach }
        })
    }

    fn take(&self, state: &mut State, step: &Step) {
        let primal = self.reach(state, step, TO_THE_BOUNDARY);
        let dual = reach(&state.multiplier, &step.multiplier, TO_THE_BOUNDARY);
        advance(&mut state.x, &step.x, primal);
        advance(&mut state.slack, &step.slack, primal);
        advance(&mut state.multiplier, &step.multiplier, dual);
        self.look(state);
        // A tangent lies below its curve: what the row has left beyond the linear step is slack.
        for (slack, residual) in state.slack.iter_mut().zip(&mut state.residual) {
            if *residual < 0.0 {
                *slack -= *residual;
                *residual = 0.0;
            }
        }
    }
}

/// The share up to 1 of a step that takes no value below `1 - share` of itself.
fn reach(values: &[f64], steps: &[f64], share: f64) -> f64 {
    values.iter().zip(steps).fold(
        1.0,
        |reach: f64, (value, step)| {
            if *step < 0.0 { reach.min(share * value / -step) } else { reach }
        },
    )
}

fn advance(values: &mut [f64], steps: &[f64], share: f64) {
    for (value, step) in values.iter_mut().zip(steps) {
        *value += share * step;
    }
}

fn add(sum: &mut [f64], first: usize, weights: &[f64; 3], scale: f64) {
    let [u, v, w] = weights;
    if let Some([x, y, z, ..]) = sum.get_mut(first..) {
        *x += scale * u;
        *y += scale * v;
        *z += scale * w;
    }
}

fn dot(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).fold(0.0, |sum, (a, b)| sum + a * b)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Three unknowns that are b themselves: one is bounded, two are so in sum.
    #[test]
    fn a_program_with_a_known_solution() {
        let unit = |k: usize| {
            let mut weights = [0.0; 3];
            weights[k] = 1.0;
            Functional { first: 0, weights }
        };
        let terms = (0..3).map(|k| Term { b: unit(k), weight: 1.0 }).collect();
        let sum = Functional { first: 0, weights: [0.0, 0.5, 0.5] };
        let rows = vec![Row { w: unit(0), p: None }, Row { w: sum, p: None }];
        let program = Program { terms, rows };
        let found = program
            .solve(vec![0.1, 0.2, 0.9], 1.0, Stop { gap: 1e-9, iterations: 60, below: f64::MAX })
            .unwrap();
        for x in &found.x {
            assert!((x - 1.0).abs() < 1e-5, "{found:?}");
        }
    }

    /// b ≤ 1/√b is b ≤ 1.
    #[test]
    fn a_row_that_bends_is_met() {
        let one = Functional { first: 0, weights: [1.0, 0.0, 0.0] };
        let others = [[0.0, 1.0, 0.0], [0.0, 0.0, 1.0]].map(|weights| Functional { first: 0, weights });
        let terms = [one, others[0], others[1]].map(|b| Term { b, weight: 1.0 }).to_vec();
        let rows = vec![
            Row { w: one, p: Some(one.weights) },
            Row { w: others[0], p: None },
            Row { w: others[1].times(0.25), p: None },
        ];
        let found = Program { terms, rows }
            .solve(vec![0.1; 3], 1.0, Stop { gap: 1e-9, iterations: 60, below: f64::MAX })
            .unwrap();
        for (x, expected) in found.x.iter().zip([1.0, 1.0, 4.0]) {
            assert!((x / expected - 1.0).abs() < 1e-6, "{found:?}");
        }
    }
}
