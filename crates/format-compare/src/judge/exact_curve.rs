//! A curve in about 106 bits.

use nurbs_core::{CentredCurve, CurveError, Evaluate, FastCurve, NurbsBuf};
use real::{DoubleDouble, Real};

use crate::plan::in_format::of_pair;

/// A curve in double-double. Most moves of most programs are straight, and have a form of their own: a point takes a
/// product for each axis, and the chord between two of them one in all.
pub(super) enum ExactCurve<'a, const D: usize> {
    Straight(Straight<D>),
    Other(Box<Other<'a, D>>),
}

/// Any other curve, exactly and in f64.
pub(super) struct Other<'a, const D: usize> {
    exact: NurbsBuf<DoubleDouble, D>,
    /// The curve's polynomials, unless they lose too much.
    polynomials: Option<CentredCurve<DoubleDouble, D>>,
    plain: FastCurve<'a, D>,
}

/// The most that polynomials may lose, in units of the 106 bits. A curve whose polynomials may lose more is evaluated by
/// its basis functions. It is far below what a judge sees: a billionth of a unit of f64.
const MOST_LOSS: f64 = 1024.0;

impl<'a, const D: usize> Other<'a, D> {
    fn of(curve: &'a NurbsBuf<f64, D>) -> Result<Self, CurveError> {
        let plain = curve.as_curve();
        let is_even = CentredCurve::<DoubleDouble, D>::loss(&plain) <= MOST_LOSS;
        let polynomials = is_even.then(|| CentredCurve::new(&plain));
        Ok(Self { exact: curve.convert()?, polynomials, plain: FastCurve::of(plain) })
    }

    /// At its ends the curve is its control points, exactly.
    fn point(&self, u: (f64, f64)) -> [DoubleDouble; D] {
        let (first, last) = self.plain.domain();
        match &self.polynomials {
            Some(polynomials) if u != (first, 0.0) && u != (last, 0.0) => polynomials.point(of_pair(u)),
            _ => self.exact.as_curve().point(of_pair(u)),
        }
    }
}

/// The line `A + (u - u₀) S`.
pub(super) struct Straight<const D: usize> {
    /// u₀.
    first: DoubleDouble,
    /// A.
    begin: [DoubleDouble; D],
    /// S, in mm.
    slope: [DoubleDouble; D],
    /// |S|.
    speed: DoubleDouble,
}

impl<'a, const D: usize> ExactCurve<'a, D> {
    /// A curve whose numbers are taken without rounding: every f64 is a double-double.
    pub(super) fn of(curve: &'a NurbsBuf<f64, D>) -> Result<Self, CurveError> {
        let plain = curve.as_curve();
        let ([from, to], None) = (plain.control_points(), plain.weights()) else {
            return Ok(Self::Other(Box::new(Other::of(curve)?)));
        };
        let (first, last) = plain.domain();
        let of = DoubleDouble::from;
        let width = of(last) - of(first);
        let slope = std::array::from_fn(|d| (of(to[d]) - of(from[d])) / width);
        Ok(Self::Straight(Straight {
            first: of(first),
            begin: from.map(of),
            slope,
            speed: DoubleDouble::norm(&slope),
        }))
    }

    /// The curve in f64; `None` if it is straight.
    pub(super) fn bent(&self) -> Option<&FastCurve<'a, D>> {
        match self {
            Self::Straight(_) => None,
            Self::Other(curve) => Some(&curve.plain),
        }
    }

    /// The point at a parameter that is a sum of two floats.
    pub(super) fn point(&self, u: (f64, f64)) -> [DoubleDouble; D] {
        match self {
            Self::Straight(Straight { first, begin, slope, .. }) => {
                let along = of_pair(u) - *first;
                std::array::from_fn(|d| match slope[d].value() {
                    0.0 => begin[d],
                    _ => begin[d] + slope[d] * along,
                })
            }
            Self::Other(curve) => curve.point(u),
        }
    }

    /// The length of the chord between two parameters, in mm, if the curve is straight.
    pub(super) fn straight_chord(&self, from: (f64, f64), to: (f64, f64)) -> Option<DoubleDouble> {
        match self {
            Self::Straight(line) => Some(line.speed * (of_pair(to) - of_pair(from))),
            Self::Other(_) => None,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The short form of a line is the curve itself, to some units of the 106 bits.
    #[test]
    fn a_straight_move_is_the_curve_that_it_stands_for() {
        let points = vec![[1.0, -20.0, 7.0], [81.3, 0.1, 7.0]];
        let curve = NurbsBuf::try_new_nonrational(1, points, vec![0.25, 0.25, 1.75, 1.75]).unwrap();
        let (short, exact) = (ExactCurve::of(&curve).unwrap(), curve.convert::<DoubleDouble>().unwrap());
        assert!(short.bent().is_none());
        let off = |a: DoubleDouble, b: DoubleDouble| (a - b).value().abs();
        let at = |u: (f64, f64)| exact.as_curve().point(of_pair(u));
        let mut before = (0.25, 0.0);
        for u in [(0.25, 0.0), (0.3, 1e-18), (1.0, -3e-17), (1.75, 0.0)] {
            let (found, expected) = (short.point(u), at(u));
            assert!((0..3).all(|d| off(found[d], expected[d]) < 1e-28), "{found:?} {expected:?}");
            let begin = at(before);
            let chord = DoubleDouble::norm(&std::array::from_fn::<_, 3, _>(|d| expected[d] - begin[d]));
            assert!(off(short.straight_chord(before, u).unwrap(), chord) < 1e-28);
            before = u;
        }
    }

    /// A curve whose weights differ a hundredfold keeps its basis functions, and the ends of every curve are exact.
    #[test]
    fn polynomials_serve_where_they_lose_little() {
        for (weight, is_even) in [(0.7, true), (0.01, false)] {
            let points = vec![[0.1, 0.2], [1.1, 0.3], [1.3, 1.7]];
            let knots = vec![0.0, 0.0, 0.0, 0.3, 0.3, 0.3];
            let curve = NurbsBuf::try_new(2, points.clone(), vec![1.0, weight, 1.0], knots).unwrap();
            let other = Other::of(&curve).unwrap();
            assert_eq!(other.polynomials.is_some(), is_even);
            let exact = curve.convert::<DoubleDouble>().unwrap();
            for k in 0..=32 {
                let u = 0.3 * f64::from(k) / 32.0;
                let (found, expected) =
                    (other.point((u, 1e-19)), exact.as_curve().point(of_pair((u, 1e-19))));
                assert!(
                    (0..2).all(|d| (found[d] - expected[d]).value().abs() < 1e-29),
                    "{found:?} {expected:?}"
                );
            }
            for (u, end) in [(0.0, points[0]), (0.3, points[2])] {
                assert_eq!(other.point((u, 0.0)), end.map(DoubleDouble::from));
            }
        }
    }

    #[test]
    fn a_curve_is_evaluated_as_it_is() {
        let points = vec![[0.0, 0.0], [1.0, 0.0], [1.0, 1.0]];
        let bent = NurbsBuf::try_new_nonrational(1, points, vec![0.0, 0.0, 1.0, 2.0, 2.0]);
        let bent = bent.unwrap();
        let bent = ExactCurve::of(&bent).unwrap();
        assert!(bent.bent().is_some() && bent.straight_chord((0.0, 0.0), (2.0, 0.0)).is_none());
        assert_eq!(bent.point((1.5, 0.0)).map(DoubleDouble::value), [1.0, 0.5]);
    }
}
