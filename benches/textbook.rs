//! A real-time step the textbook way: one global parameter, basis functions by Cox and de Boor for each trial, the secant
//! iteration of paper A with start values (6) and (7), of which (7) has 99 for the misprinted 95.
//!
//! It is written with care, so that the comparison means something: plain `f64`, no heap, arrays of the degree's own size,
//! the span found from the last one.

use nurbs_core::NurbsBuf;
use secant_interp::{LengthCursor, StepLengths};

const DEGREE: usize = 3;
const TOLERANCE: f64 = 1e-6;
const MAX_ITERATIONS: u32 = 5;

/// A cubic curve and the distances to travel on it.
pub(crate) struct Textbook<'a, const D: usize> {
    curve: &'a NurbsBuf<f64, D>,
    lengths: StepLengths<'a, f64>,
    /// Millimetres in a unit of the distances.
    unit_mm: f64,
}

/// What changes from period to period.
#[derive(Clone, Copy)]
pub(crate) struct TextbookState<const D: usize> {
    cursor: LengthCursor,
    /// u_i to u_{i-3}.
    parameters: [f64; 4],
    known: usize,
    point: [f64; D],
    span: usize,
    /// Evaluations of the curve so far.
    pub(crate) evaluations: u64,
}

impl<'a, const D: usize> Textbook<'a, D> {
    /// # Panics
    /// If the curve is no cubic.
    pub(crate) fn new(curve: &'a NurbsBuf<f64, D>, lengths: StepLengths<'a, f64>, unit_mm: f64) -> Self {
        assert_eq!(curve.degree(), DEGREE, "the textbook way is written for cubics");
        Self { curve, lengths, unit_mm }
    }

    /// The state at the start of the curve.
    pub(crate) fn start(&self) -> TextbookState<D> {
        let first = self.curve.knots()[DEGREE];
        TextbookState {
            cursor: LengthCursor::default(),
            parameters: [first; 4],
            known: 1,
            point: self.curve.control_points()[0],
            span: DEGREE,
            evaluations: 0,
        }
    }

    /// The next parameter and point; `None` at the end of the curve or of the distances.
    pub(crate) fn step(&self, state: &mut TextbookState<D>) -> Option<(f64, [f64; D])> {
        let last = self.curve.control_points().len();
        let end = self.curve.knots()[last];
        let [u0, u1, u2, u3] = state.parameters;
        if u0 >= end {
            return None;
        }
        let length = self.lengths.advance(&mut state.cursor)? * self.unit_mm;
        let (mut older, mut newer) = if state.known == 4 {
            ((99.0 * u0 - 73.0 * u1 + 41.0 * u2 - 19.0 * u3) / 48.0, 3.0 * u0 - 3.0 * u1 + u2)
        } else {
            let rate = length / self.speed(state, u0);
            (u0 + 0.9 * rate, u0 + rate)
        };
        let residual = |state: &mut TextbookState<D>, u: f64| {
            let point = self.point(state, u);
            let squares: f64 = (0..D).map(|d| (point[d] - state.point[d]).powi(2)).sum();
            (squares.sqrt() - length, point)
        };
        let (mut f_older, _) = residual(state, older);
        let (mut f_newer, mut point) = residual(state, newer);
        for _ in 0..MAX_ITERATIONS {
            if (newer - older).abs() <= TOLERANCE && f_newer.abs() <= TOLERANCE * length {
                break;
            }
            let rise = f_newer - f_older;
            if rise == 0.0 {
                break;
            }
            let next = (newer - f_newer * (newer - older) / rise).max(u0);
            (older, f_older) = (newer, f_newer);
            newer = next;
            (f_newer, point) = residual(state, newer);
        }
        state.parameters = [newer, u0, u1, u2];
        state.known = (state.known + 1).min(4);
        state.point = point;
        (newer < end).then_some((newer, point))
    }

    /// |C'| at u, by a difference: only in the first three steps.
    fn speed(&self, state: &mut TextbookState<D>, u: f64) -> f64 {
        let h = 1e-6 * (self.curve.knots()[self.curve.knots().len() - 1] - self.curve.knots()[0]);
        let (a, b) = (self.point(state, u), self.point(state, u + h));
        (0..D).map(|d| (b[d] - a[d]).powi(2)).sum::<f64>().sqrt() / h
    }

    /// C(u): algorithms A2.1 from the span before, A2.2, and A3.1 or A4.1.
    fn point(&self, state: &mut TextbookState<D>, u: f64) -> [f64; D] {
        let (knots, points) = (self.curve.knots(), self.curve.control_points());
        state.evaluations += 1;
        let mut span = state.span;
        while span > DEGREE && u < knots[span] {
            span -= 1;
        }
        while span + 1 < points.len() && u >= knots[span + 1] {
            span += 1;
        }
        state.span = span;
        let (mut left, mut right, mut basis) = ([0.0; DEGREE + 1], [0.0; DEGREE + 1], [1.0; DEGREE + 1]);
        for j in 1..=DEGREE {
            left[j] = u - knots[span + 1 - j];
            right[j] = knots[span + j] - u;
            let mut saved = 0.0;
            for r in 0..j {
                let part = basis[r] / (right[r + 1] + left[j - r]);
                basis[r] = saved + right[r + 1] * part;
                saved = left[j - r] * part;
            }
            basis[j] = saved;
        }
        let first = span - DEGREE;
        let mut point = [0.0; D];
        let rational = self.curve.as_curve().weights().is_some();
        let mut total = 0.0;
        for (r, function) in basis.iter().enumerate() {
            let part = if rational { function * self.curve.weights()[first + r] } else { *function };
            total += part;
            for d in 0..D {
                point[d] += part * points[first + r][d];
            }
        }
        if rational { point.map(|x| x / total) } else { point }
    }
}
