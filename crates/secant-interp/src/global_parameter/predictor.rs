//! Start values of the secant iteration, from the last four parameters.
//!
//! Both extrapolate the parameters u_i, u_{i-1}, … of past periods to u_{i+1}. They are written in the differences d₁ =
//! u_i - u_{i-1}, d₂ = u_{i-1} - u_{i-2}, d₃ = u_{i-2} - u_{i-3}. The differences are small even if the parameters are
//! not: in fixed point nothing overflows, and the common part of the parameters takes no digits.
//!
//! Source: paper A (Wang Yunsen et al.; see `docs/papers.md`), equations (6), (7).

use real::Real;

/// The last four parameters, newest first.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct History<R> {
    parameters: [R; 4],
    known: usize,
}

impl<R: Real> History<R> {
    /// A history that knows only the start of the curve.
    #[must_use]
    pub fn new(start: R) -> Self {
        Self { parameters: [start; 4], known: 1 }
    }

    /// The newest parameter, u_i.
    #[must_use]
    pub fn newest(&self) -> R {
        self.parameters[0]
    }

    /// Appends u_{i+1}.
    pub fn push(&mut self, u: R) {
        let [a, b, c, _] = self.parameters;
        self.parameters = [u, a, b, c];
        self.known = (self.known + 1).min(4);
    }

    /// Whether four parameters are known, as the start values need.
    #[must_use]
    pub fn is_full(&self) -> bool {
        self.known == 4
    }

    /// The last difference d₁; 0 at the start.
    #[must_use]
    pub fn last_difference(&self) -> R {
        self.parameters[0] - self.parameters[1]
    }

    /// Equation (6): `3u_i - 3u_{i-1} + u_{i-2} = u_i + 2d₁ - d₂`, exact where u is quadratic in i.
    #[must_use]
    pub fn taylor(&self) -> R {
        let [u0, u1, u2, _] = self.parameters;
        let (d1, d2) = (u0 - u1, u1 - u2);
        u0 + (d1 + d1 - d2)
    }

    /// Equation (7): `(99u_i - 73u_{i-1} + 41u_{i-2} - 19u_{i-3})/48 = u_i + (51d₁ - 22d₂ + 19d₃)/48`, exact
    /// where u is linear in i.
    ///
    /// The paper prints 95 for 99. Its own equations (11)-(15) give 99, and only with 99 do the coefficients sum to 48,
    /// which keeps a constant history constant.
    #[must_use]
    pub fn adams(&self) -> R {
        let [u0, u1, u2, u3] = self.parameters;
        let weights = [(51, u0 - u1), (-22, u1 - u2), (19, u2 - u3)];
        u0 + R::sum_of_products(weights.map(|(weight, d)| (R::from_ratio(weight, 48), d)))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use real::{Backend, I8F24};

    fn history(u: impl Fn(f64) -> f64) -> History<f64> {
        let mut history = History::new(u(0.0));
        for i in 1..4 {
            history.push(u(f64::from(i)));
        }
        assert!(history.is_full());
        history
    }

    #[test]
    fn taylor_is_exact_to_second_order() {
        let u = |i: f64| 0.1 + 0.02 * i + 0.003 * i * i;
        assert!((history(u).taylor() - u(4.0)).abs() < 1e-15);
    }

    /// Predicted: on u = i² the differences are 5, 3, 1, so u_4 is taken as 9 + (255 - 66 + 19)/48 = 13⅓, not 16.
    #[test]
    fn adams_is_exact_to_first_order_only() {
        let line = |i: f64| 0.1 + 0.02 * i;
        assert!((history(line).adams() - line(4.0)).abs() < 1e-15);
        assert!((history(|i| i * i).adams() - (13.0 + 1.0 / 3.0)).abs() < 1e-14);
    }

    #[test]
    fn adams_has_the_coefficients_of_the_corrected_equation() {
        let u = [0.3, 0.27, 0.25, 0.24];
        let mut history = History::new(u[3]);
        for value in [u[2], u[1], u[0]] {
            history.push(value);
        }
        let printed = (99.0 * u[0] - 73.0 * u[1] + 41.0 * u[2] - 19.0 * u[3]) / 48.0;
        assert!((history.adams() - printed).abs() < 1e-15);
    }

    #[test]
    fn start_values_do_not_overflow_where_the_parameters_fit() {
        let mut history = History::new(I8F24::from_f64(99.0).unwrap());
        for u in [99.3, 99.7, 100.2] {
            history.push(I8F24::from_f64(u).unwrap());
        }
        assert!((history.taylor().to_f64() - 100.8).abs() < 1e-5);
        assert!(
            (history.adams().to_f64() - (100.2 + (51.0 * 0.5 - 22.0 * 0.4 + 19.0 * 0.3) / 48.0)).abs() < 1e-5
        );
    }
}
