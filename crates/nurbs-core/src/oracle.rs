//! The definition of a NURBS curve, taken literally and in double-double: tests compare evaluation with it.

use crate::NurbsBuf;
use real::{Backend, DoubleDouble, Real};

/// `N_{i,p}(u)` by its recurrence, with `N_{i,0} = 1` for i = `span` only.
pub(crate) fn cox_de_boor(
    knots: &[DoubleDouble],
    i: usize,
    p: usize,
    span: usize,
    u: DoubleDouble,
) -> DoubleDouble {
    let zero = DoubleDouble::from(0.0);
    if p == 0 {
        return if i == span { DoubleDouble::from(1.0) } else { zero };
    }
    let term = |numerator: DoubleDouble, denominator: DoubleDouble, i: usize| {
        if denominator == zero {
            return zero;
        }
        numerator / denominator * cox_de_boor(knots, i, p - 1, span, u)
    };
    term(u - knots[i], knots[i + p] - knots[i], i)
        + term(knots[i + p + 1] - u, knots[i + p + 1] - knots[i + 1], i + 1)
}

/// `C(u)` as the quotient of two full sums.
pub(crate) fn point<const D: usize>(curve: &NurbsBuf<DoubleDouble, D>, u: DoubleDouble) -> [DoubleDouble; D] {
    let knots = curve.knots();
    let last = curve.control_points().len() - 1;
    // By linear search: the last non-empty span that does not begin after u.
    let span = (0..=last).rev().find(|&i| knots[i] <= u && knots[i] < knots[i + 1]).unwrap();
    let basis: Vec<_> = (0..=last)
        .map(|i| {
            if i <= span && i + curve.degree() >= span {
                cox_de_boor(knots, i, curve.degree(), span, u)
            } else {
                0.0.into()
            }
        })
        .collect();
    let denominator =
        DoubleDouble::sum_of_products(basis.iter().copied().zip(curve.weights().iter().copied()));
    core::array::from_fn(|axis| {
        let terms = basis.iter().zip(curve.weights()).zip(curve.control_points());
        DoubleDouble::sum_of_products(terms.map(|((n, w), p)| (*n * *w, p[axis]))) / denominator
    })
}

/// The curve in double-double, every number exact.
pub(crate) fn exactly<const D: usize>(curve: &NurbsBuf<f64, D>) -> NurbsBuf<DoubleDouble, D> {
    curve.convert().unwrap()
}

/// The curve in `f64`, with its numbers as a format of at most 53 significant bits holds them.
pub(crate) fn in_f64<Q: Backend, const D: usize>(curve: &NurbsBuf<Q, D>) -> NurbsBuf<f64, D> {
    let all = |numbers: &[Q]| numbers.iter().map(|x| x.to_f64()).collect();
    let points = curve.control_points().iter().map(|p| p.map(Q::to_f64)).collect();
    NurbsBuf::try_new(curve.degree(), points, all(curve.weights()), all(curve.knots())).unwrap()
}
