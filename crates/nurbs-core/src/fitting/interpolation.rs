//! A cubic curve through given points, whose knots are accumulated chord lengths.
//!
//! On spans of length h_k, with `d_k = (Q_{k+1} - Q_k)/h_k`, the second derivatives M_k at the points Q_k of a curve with
//! continuous C'' obey (de Boor, *A Practical Guide to Splines*, chapter IV)
//!
//! ```text
//! h_{k-1} M_{k-1} + 2 (h_{k-1} + h_k) M_k + h_k M_{k+1} = 6 (d_k - d_{k-1}),    k = 1 … n-1
//! ```
//!
//! With a row for each end, the matrix has three diagonals, and each number on the main one is larger than the two beside
//! it together: elimination needs no pivots, and takes a time linear in n. The polar form of the curve at
//! (u_{k-1}, u_k, u_{k+1}) is control point k + 1:
//!
//! ```text
//! P_{k+1} = Q_k + C'(u_k) (h_k - h_{k-1})/3 - M_k h_{k-1} h_k/6,    h_{-1} = h_n = 0
//! ```

use alloc::vec::Vec;
use core::error::Error;
use core::fmt;

use real::Real;

use crate::vector::{add, distance, over, scaled, sub};
use crate::{CurveError, NurbsBuf};

/// What a curve through points does at one of its ends.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum EndCondition<const D: usize> {
    /// It does not bend: C'' = 0.
    Natural,
    /// It goes in this direction, a vector of any length above 0, as fast as its chords: `|C'|` is their length over
    /// the range of u.
    Along([f64; D]),
    /// C' is that of the parabola through the three points at this end. With two points only, it does not bend.
    Parabola,
}

/// Why there is no curve through points.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub enum InterpolationError {
    /// There are fewer than two points.
    TooFewPoints {
        /// The number given.
        found: usize,
    },
    /// A point, or the parameter that its chord adds, is that of the one before it.
    PointsCoincide {
        /// Index of the later point.
        index: usize,
    },
    /// The direction at an end has no length.
    NoDirection,
    /// A number of the curve is none, or too large.
    Curve(CurveError),
}

impl fmt::Display for InterpolationError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::TooFewPoints { found } => write!(f, "{found} points: expected two or more"),
            Self::PointsCoincide { index } => write!(f, "point {index} is where the one before it is"),
            Self::NoDirection => f.write_str("the direction at an end has no length"),
            Self::Curve(error) => error.fmt(f),
        }
    }
}

impl Error for InterpolationError {}

/// Accumulated chord lengths as parameters of points: `u_0 = 0`, `u_k = u_{k-1} + |Q_k - Q_{k-1}|`, all divided by the
/// last of them, so that `u_n = 1`. Points that all coincide get NaN.
///
/// # Source
/// Paper D (Liu Ping et al.; see `docs/papers.md`), equation (5), scaled as in (6).
#[must_use]
pub fn chord_length_parameters<const D: usize>(points: &[[f64; D]]) -> Vec<f64> {
    let mut length = 0.0;
    let chords = points.windows(2).map(|pair| distance(&pair[1], &pair[0]));
    let mut parameters: Vec<f64> = core::iter::once(0.0)
        .chain(chords.map(|chord| {
            length += chord;
            length
        }))
        .collect();
    for u in &mut parameters {
        *u /= length;
    }
    parameters
}

/// The cubic curve through `points` Q_0 … Q_n, with continuous C'' and the knots
/// `0 0 0 0 u_1 … u_{n-1} 1 1 1 1`, u_k by [`chord_length_parameters`]. It has n + 3 control points, and passes Q_k at u_k.
///
/// Units: those of the points. Domain: two or more points, neighbours apart.
///
/// # Errors
/// [`InterpolationError`].
///
/// # Source
/// Paper D (Liu Ping et al.; see `docs/papers.md`), equations (5) and (6): the knots. The paper solves for no control
/// points and says nothing of the ends; the system is that at the top of this file.
pub fn interpolate<const D: usize>(
    points: &[[f64; D]],
    ends: [EndCondition<D>; 2],
) -> Result<NurbsBuf<f64, D>, InterpolationError> {
    if points.len() < 2 {
        return Err(InterpolationError::TooFewPoints { found: points.len() });
    }
    through(points, &chord_length_parameters(points), ends)
}

/// The curve that passes each point at the parameter given for it.
fn through<const D: usize>(
    points: &[[f64; D]],
    parameters: &[f64],
    ends: [EndCondition<D>; 2],
) -> Result<NurbsBuf<f64, D>, InterpolationError> {
    let spans = Spans::try_new(points, parameters)?;
    let seconds = spans.second_derivatives(ends)?;
    let last = points.len() - 1;
    let mut control_points = Vec::with_capacity(points.len() + 2);
    control_points.push(points[0]);
    for (k, point) in points.iter().enumerate() {
        let (before, after) = (spans.length_before(k), spans.length_after(k));
        let along = scaled(&spans.first_derivative(k, &seconds), (after - before) / 3.0);
        let bent = scaled(&seconds[k], before * after / 6.0);
        control_points.push(sub(&add(point, &along), &bent));
    }
    control_points.push(points[last]);
    let (first, end) = (parameters[0], parameters[last]);
    let knots = [&[first; 4], &parameters[1..last], &[end; 4]].concat();
    NurbsBuf::try_new_nonrational(3, control_points, knots).map_err(InterpolationError::Curve)
}

/// The lengths in u of the spans between points, and the slopes `d_k` of their chords.
struct Spans<const D: usize> {
    lengths: Vec<f64>,
    slopes: Vec<[f64; D]>,
}

impl<const D: usize> Spans<D> {
    fn try_new(points: &[[f64; D]], parameters: &[f64]) -> Result<Self, InterpolationError> {
        let lengths: Vec<f64> = parameters.windows(2).map(|pair| pair[1] - pair[0]).collect();
        let has_length = |length: &f64| *length > 0.0;
        if let Some(span) = lengths.iter().position(|length| !has_length(length)) {
            return Err(InterpolationError::PointsCoincide { index: span + 1 });
        }
        let slopes =
            points.windows(2).zip(&lengths).map(|(pair, h)| over(&sub(&pair[1], &pair[0]), *h)).collect();
        Ok(Self { lengths, slopes })
    }

    fn length_before(&self, k: usize) -> f64 {
        k.checked_sub(1).map_or(0.0, |span| self.lengths[span])
    }

    fn length_after(&self, k: usize) -> f64 {
        self.lengths.get(k).copied().unwrap_or(0.0)
    }

    /// C' at point k, by the second derivatives.
    fn first_derivative(&self, k: usize, seconds: &[[f64; D]]) -> [f64; D] {
        match self.lengths.get(k) {
            Some(h) => {
                let bent = add(&scaled(&seconds[k], 2.0), &seconds[k + 1]);
                sub(&self.slopes[k], &scaled(&bent, h / 6.0))
            }
            None => {
                let bent = add(&scaled(&seconds[k], 2.0), &seconds[k - 1]);
                add(&self.slopes[k - 1], &scaled(&bent, self.lengths[k - 1] / 6.0))
            }
        }
    }

    /// The second derivatives M_k.
    fn second_derivatives(&self, ends: [EndCondition<D>; 2]) -> Result<Vec<[f64; D]>, InterpolationError> {
        let last = self.lengths.len();
        let mut rows: Vec<Row<D>> = Vec::with_capacity(last + 1);
        let [start, end] = [self.end_row(ends[0], true)?, self.end_row(ends[1], false)?];
        rows.push(start);
        for k in 1..last {
            let (before, after) = (self.lengths[k - 1], self.lengths[k]);
            let right = scaled(&sub(&self.slopes[k], &self.slopes[k - 1]), 6.0);
            rows.push(Row { before, own: 2.0 * (before + after), after, right });
        }
        rows.push(end);
        Ok(solved(rows))
    }

    /// The row of an end: `2 h M + h M' = ±6 (d - C')`, M' that of the neighbour, where C' is given.
    fn end_row(&self, condition: EndCondition<D>, is_start: bool) -> Result<Row<D>, InterpolationError> {
        let last = self.lengths.len() - 1;
        let (own, next) = if is_start { (0, 1) } else { (last, last.wrapping_sub(1)) };
        let (h, slope) = (self.lengths[own], self.slopes[own]);
        let sign = if is_start { 1.0 } else { -1.0 };
        // What C' is less than the slope of the chord, times the sign.
        let missing = match condition {
            EndCondition::Natural => None,
            EndCondition::Along(direction) => {
                let length = f64::norm(&direction);
                if !(length > 0.0 && length < f64::MAX) {
                    return Err(InterpolationError::NoDirection);
                }
                let speed = self.mean_speed() / length;
                Some(scaled(&sub(&slope, &scaled(&direction, speed)), sign))
            }
            EndCondition::Parabola => {
                let other = self.slopes.get(next).zip(self.lengths.get(next));
                other.map(|(beside, length)| scaled(&sub(beside, &slope), sign * h / (h + length)))
            }
        };
        Ok(match missing {
            None => Row { before: 0.0, own: 1.0, after: 0.0, right: [0.0; D] },
            Some(missing) => {
                let (before, after) = if is_start { (0.0, h) } else { (h, 0.0) };
                Row { before, own: 2.0 * h, after, right: scaled(&missing, 6.0) }
            }
        })
    }

    /// The length of all chords over the range of u.
    fn mean_speed(&self) -> f64 {
        let length: f64 = self.slopes.iter().zip(&self.lengths).map(|(slope, h)| f64::norm(slope) * h).sum();
        length / self.lengths.iter().sum::<f64>()
    }
}

/// A row of the system: `before M_{k-1} + own M_k + after M_{k+1} = right`.
#[derive(Clone, Copy)]
struct Row<const D: usize> {
    before: f64,
    own: f64,
    after: f64,
    right: [f64; D],
}

/// Solves the system by elimination from the first row to the last, and back.
fn solved<const D: usize>(mut rows: Vec<Row<D>>) -> Vec<[f64; D]> {
    let mut above: Option<Row<D>> = None;
    for row in &mut rows {
        if let Some(above) = above {
            let factor = row.before / above.own;
            row.own -= factor * above.after;
            row.right = sub(&row.right, &scaled(&above.right, factor));
        }
        above = Some(*row);
    }
    let mut solution: Vec<[f64; D]> = Vec::with_capacity(rows.len());
    let mut below = [0.0; D];
    for row in rows.iter().rev() {
        below = over(&sub(&row.right, &scaled(&below, row.after)), row.own);
        solution.push(below);
    }
    solution.reverse();
    solution
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{Differentiate, Evaluate, basis_functions};
    use proptest::prelude::*;

    const ENDS: [EndCondition<2>; 2] = [EndCondition::Parabola; 2];

    fn apart(a: &[f64; 2], b: &[f64; 2]) -> f64 {
        f64::norm(&sub(a, b))
    }

    /// The knots of paper D's equation (6), from the points that it prints: for ten points, 16 knots. Those of its program
    /// are others.
    #[test]
    fn the_knots_are_accumulated_chords() {
        let points = crate::golden::seed_003().control_points().to_vec();
        let curve = interpolate(&points, ENDS).unwrap();
        assert_eq!((curve.knots().len(), curve.control_points().len()), (16, 12));
        let expected = [0.1075, 0.2371, 0.2952, 0.3859, 0.5775, 0.7594, 0.7983, 0.8876];
        for (knot, expected) in curve.knots()[4..12].iter().zip(expected) {
            assert!((knot - expected).abs() < 5e-5, "{knot} for {expected}");
        }
    }

    /// A cubic is the only cubic with its points and its tangents, whatever the parameters.
    #[test]
    fn a_cubic_is_reproduced() {
        let cubic =
            |u: f64| [3.0 * u - 2.0 * u * u + 5.0 * u * u * u, 1.0 - u + 4.0 * u * u - 3.0 * u * u * u];
        let speed = |u: f64| [3.0 - 4.0 * u + 15.0 * u * u, -1.0 + 8.0 * u - 9.0 * u * u];
        let parameters = [0.0, 0.07, 0.3, 0.34, 0.8, 1.0];
        let points = parameters.map(cubic);
        // `Along` takes the length of C' from the chords; here it is given by the parameters' scale.
        let chords: f64 = points.windows(2).map(|pair| apart(&pair[0], &pair[1])).sum();
        let spans = Spans::try_new(&points, &parameters).unwrap();
        assert!((spans.mean_speed() - chords).abs() < 1e-14);
        let row = |at: usize, sign: f64| {
            let h = spans.lengths[at];
            let u = if sign > 0.0 { 0.0 } else { 1.0 };
            let right = scaled(&sub(&spans.slopes[at], &speed(u)), 6.0 * sign);
            Row {
                before: if sign > 0.0 { 0.0 } else { h },
                own: 2.0 * h,
                after: if sign > 0.0 { h } else { 0.0 },
                right,
            }
        };
        let mut rows = alloc::vec![row(0, 1.0)];
        for k in 1..5 {
            let (before, after) = (spans.lengths[k - 1], spans.lengths[k]);
            let right = scaled(&sub(&spans.slopes[k], &spans.slopes[k - 1]), 6.0);
            rows.push(Row { before, own: 2.0 * (before + after), after, right });
        }
        rows.push(row(4, -1.0));
        for (second, u) in solved(rows).iter().zip(parameters) {
            let exact = [-4.0 + 30.0 * u, 8.0 - 18.0 * u];
            assert!(apart(second, &exact) < 1e-12, "u={u}: {second:?} for {exact:?}");
        }
    }

    /// By the parabola at both ends, the points of a parabola give that parabola: its C'' is the same everywhere.
    #[test]
    fn a_parabola_is_reproduced() {
        let parabola = |u: f64| [2.0 * u - 1.0, u * (3.0 * u - 2.0)];
        let parameters = [0.0, 0.2, 0.25, 0.9, 1.0];
        let curve = through(&parameters.map(parabola), &parameters, ENDS).unwrap();
        for step in 0..=50 {
            let u = f64::from(step) / 50.0;
            let found = curve.as_curve().point(u);
            assert!(apart(&found, &parabola(u)) < 1e-14, "u={u}: {found:?}");
        }
    }

    #[test]
    fn ends_are_as_they_are_asked_for() {
        let points = [[0.0, 0.0], [2.0, 1.0], [3.0, -1.0], [5.0, 0.5]];
        let curve = interpolate(&points, [EndCondition::Along([0.0, 3.0]), EndCondition::Natural]).unwrap();
        let chords: f64 = points.windows(2).map(|pair| apart(&pair[0], &pair[1])).sum();
        let [start, end] = [0.0, 1.0].map(|u| curve.as_curve().derivatives(u));
        assert!(apart(&start.first, &[0.0, chords]) < 1e-12, "{start:?}");
        assert!(f64::norm(&end.second) < 1e-11, "{end:?}");
        let straight = interpolate(&[[1.0, 2.0], [4.0, 6.0]], ENDS).unwrap();
        assert!(apart(&straight.as_curve().point(0.25), &[1.75, 3.0]) < 1e-15);
    }

    #[test]
    fn what_makes_no_curve_is_refused() {
        use InterpolationError as E;
        let refused =
            |points: &[[f64; 2]], end| interpolate(points, [end, EndCondition::Natural]).unwrap_err();
        assert_eq!(refused(&[[0.0; 2]], EndCondition::Natural), E::TooFewPoints { found: 1 });
        let twice = [[0.0; 2], [1.0, 0.0], [1.0, 0.0]];
        assert_eq!(refused(&twice, EndCondition::Natural), E::PointsCoincide { index: 2 });
        assert_eq!(refused(&[[0.0; 2]; 2], EndCondition::Natural), E::PointsCoincide { index: 1 });
        let none = [[0.0; 2], [f64::NAN, 0.0], [1.0, 0.0]];
        assert_eq!(refused(&none, EndCondition::Natural), E::PointsCoincide { index: 1 });
        assert_eq!(refused(&twice[..2], EndCondition::Along([0.0; 2])), E::NoDirection);
    }

    proptest! {
        /// Each point is where its knot is, and C'' does not jump there; the control points are those of a dense solve of
        /// the basis functions' matrix by another library.
        #[test]
        fn it_passes_every_point_and_is_what_the_dense_system_gives(
            steps in prop::collection::vec([-3.0..3.0_f64, 0.05..3.0_f64], 2..14),
        ) {
            let mut points = alloc::vec![[0.0; 2]];
            for step in &steps {
                points.push(add(&points[points.len() - 1], step));
            }
            let natural = [EndCondition::Natural; 2];
            let curve = interpolate(&points, natural).unwrap();
            let parameters = chord_length_parameters(&points);
            for (u, point) in parameters.iter().zip(&points) {
                prop_assert!(apart(&curve.as_curve().point(*u), point) < 1e-12);
            }
            let count = curve.control_points().len();
            let mut matrix = nalgebra::DMatrix::<f64>::zeros(count, count);
            let mut right = nalgebra::DMatrix::<f64>::zeros(count, 2);
            let knots = curve.as_curve();
            let knots = knots.knots();
            for (row, (u, point)) in parameters.iter().zip(&points).enumerate() {
                let span = knots.find_span(*u);
                for (k, value) in basis_functions(knots, span, *u).iter().take(4).enumerate() {
                    matrix[(row, span - 3 + k)] = *value;
                }
                right[(row, 0)] = point[0];
                right[(row, 1)] = point[1];
            }
            // C'' = 0 at the ends: second differences of control points over their knots.
            let all = curve.knots();
            for (row, at, [a, b]) in
                [(count - 2, 0, [all[4], all[5]]), (count - 1, count - 3, [all[count - 2], all[count - 1]])]
            {
                let (first, second) = if at == 0 { (1.0 / a, 1.0 / b) } else { (1.0 / (1.0 - a), 1.0 / (1.0 - b)) };
                matrix[(row, at)] = first;
                matrix[(row, at + 1)] = -first - second;
                matrix[(row, at + 2)] = second;
            }
            let dense = matrix.lu().solve(&right).unwrap();
            let extent = points.iter().flatten().fold(1.0_f64, |most, x| most.max(x.abs()));
            for (k, point) in curve.control_points().iter().enumerate() {
                let other = [dense[(k, 0)], dense[(k, 1)]];
                prop_assert!(apart(point, &other) < 1e-9 * extent, "{k}: {point:?} for {other:?}");
            }
        }
    }
}
