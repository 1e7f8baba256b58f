//! The knot vectors of drawings and of geomdl, converted to the form that controls need: clamped, inner knots at most degree times.
//!
//! A curve of degree p with the points `P_0 … P_n` is drawn on `[u_p, u_{n+1}]`, whatever the knots outside. Inserting
//! a knot a gives the points
//!
//! ```text
//! Q_i = α_i P_i + (1 - α_i) P_{i-1}        α_i = (a - u_i)/(u_{i+p} - u_i)        k-p+1 ≤ i ≤ k-s
//! ```
//!
//! where `u_k` is the last knot that equals a, with multiplicity s, and points are homogeneous. With s = p the curve
//! passes through a point, and the points before it are dropped. All α are between 0 and 1, so that no number grows.
//!
//! # Source
//! W. Boehm, "Inserting new knots into B-spline curves", Computer-Aided Design 12 (1980); Piegl and Tiller, The NURBS Book,
//! equation 5.15.

use crate::curve::Nurbs;
use crate::curve_fault::CurveFault;
use crate::vector::{difference, length};

/// A share of the parameter's range within which knots are equal, if the drawing does not give one.
const EQUAL_KNOTS: f64 = 1e-10;
/// The least and the largest share that a drawing may give.
const EQUAL_KNOTS_RANGE: [f64; 2] = [1e-12, 1e-6];
/// A share of a curve's extent within which points are equal.
const EQUAL_POINTS: f64 = 1e-9;

/// Makes knots equal that differ by no more than rounding; `tolerance` is the one that the drawing gives.
pub(crate) fn merge_knots(knots: &mut [f64], tolerance: Option<f64>) {
    let (Some(first), Some(last)) = (knots.first(), knots.last()) else { return };
    let width = (last - first).abs();
    let [least, most] = EQUAL_KNOTS_RANGE.map(|share| share * width);
    // If the width is NaN, the knots stay as they are, and a later check reports them.
    let tolerance = tolerance.unwrap_or(EQUAL_KNOTS * width).max(least).min(most);
    let mut kept = *first;
    for knot in knots {
        if (*knot - kept).abs() <= tolerance {
            *knot = kept;
        } else {
            kept = *knot;
        }
    }
}

/// Whether a curve has a fault that [`clamped`] mends.
pub(crate) fn is_of_clamping(fault: &CurveFault) -> bool {
    matches!(fault, CurveFault::NotClamped { .. } | CurveFault::KnotRepeatsTooOften { .. })
}

/// The curves that are drawn: several if the curve breaks at a knot. `None` if the range of the parameter is empty. The
/// counts of points, weights and knots must fit, and knots must not decrease.
pub(crate) fn clamped(mut curve: Nurbs) -> Option<Vec<Nurbs>> {
    if curve.knots[curve.degree] >= curve.knots[curve.control_points_mm.len()] {
        return None;
    }
    clamp_start(&mut curve);
    reverse(&mut curve);
    clamp_start(&mut curve);
    reverse(&mut curve);
    Some(joined(pieces(curve)))
}

/// Gives the first knot the multiplicity degree + 1.
fn clamp_start(curve: &mut Nurbs) {
    let (degree, start) = (curve.degree, curve.knots[curve.degree]);
    let mut last = curve.knots.partition_point(|knot| *knot <= start) - 1;
    let found = curve.knots[..=last].iter().rev().take_while(|knot| **knot == start).count();
    for multiplicity in found..degree {
        insert_knot(curve, last, multiplicity);
        last += 1;
    }
    let first = last - degree;
    curve.knots.drain(..first);
    curve.control_points_mm.drain(..first);
    curve.weights.drain(..first);
    curve.knots[0] = start;
}

/// Inserts the knot with this index once more. It must be the last of its value, which has `multiplicity` knots.
fn insert_knot(curve: &mut Nurbs, index: usize, multiplicity: usize) {
    let (degree, knot) = (curve.degree, curve.knots[index]);
    let (first, last) = (index + 1 - degree, index - multiplicity);
    let (mut points, mut weights) = (Vec::new(), Vec::new());
    for i in first..=last {
        let (low, high) = (curve.knots[i], curve.knots[i + degree]);
        let shares = [high - knot, knot - low].map(|part| part / (high - low));
        let (point, weight) = mean(curve, i, shares);
        points.push(point);
        weights.push(weight);
    }
    // Of the points from first - 1 to last, the two ends are kept.
    curve.control_points_mm.splice(first..last, points);
    curve.weights.splice(first..last, weights);
    curve.knots.insert(index, knot);
}

/// The mean of points i - 1 and i with the given shares. Equal weights stay the same.
fn mean(curve: &Nurbs, i: usize, [before, this]: [f64; 2]) -> ([f64; 3], f64) {
    let (p, q) = (curve.control_points_mm[i - 1], curve.control_points_mm[i]);
    let (v, w) = (curve.weights[i - 1], curve.weights[i]);
    if v == w {
        return (std::array::from_fn(|axis| before * p[axis] + this * q[axis]), w);
    }
    let weight = before * v + this * w;
    (std::array::from_fn(|axis| (before * v * p[axis] + this * w * q[axis]) / weight), weight)
}

/// Reverses the curve.
fn reverse(curve: &mut Nurbs) {
    curve.control_points_mm.reverse();
    curve.weights.reverse();
    curve.knots.reverse();
    for knot in &mut curve.knots {
        *knot = -*knot;
    }
}

/// Cuts the curve at inner knots of a multiplicity above the degree: the curve breaks there.
fn pieces(curve: Nurbs) -> Vec<Nurbs> {
    let degree = curve.degree;
    let inner = degree + 1..curve.control_points_mm.len();
    let breaks: Vec<_> = curve.knots[inner]
        .chunk_by(|a, b| a == b)
        .scan(degree + 1, |index, equal| {
            let from = *index;
            *index += equal.len();
            Some((from, equal.len()))
        })
        .filter(|(_, multiplicity)| *multiplicity > degree)
        .collect();
    if breaks.is_empty() {
        return vec![curve];
    }
    let mut pieces = Vec::with_capacity(breaks.len() + 1);
    let mut start = 0;
    for (from, multiplicity) in breaks {
        pieces.push(piece(&curve, start, from));
        start = from + multiplicity - degree - 1;
    }
    pieces.push(piece(&curve, start, curve.control_points_mm.len()));
    pieces
}

/// The curve with the points from `start` to before `end`.
fn piece(curve: &Nurbs, start: usize, end: usize) -> Nurbs {
    Nurbs {
        control_points_mm: curve.control_points_mm[start..end].to_vec(),
        weights: curve.weights[start..end].to_vec(),
        knots: curve.knots[start..=end + curve.degree].to_vec(),
        ..*curve
    }
}

/// Joins curves that meet. Of the two points there, one is dropped, and so is one of the degree + 1 knots.
fn joined(pieces: Vec<Nurbs>) -> Vec<Nurbs> {
    let mut joined: Vec<Nurbs> = Vec::with_capacity(pieces.len());
    for piece in pieces {
        match joined.last_mut() {
            Some(before) if meets(before, &piece) => append(before, piece),
            _ => joined.push(piece),
        }
    }
    joined
}

/// Whether one curve ends where the next begins, up to rounding.
fn meets(one: &Nurbs, next: &Nurbs) -> bool {
    let (Some(end), Some(start)) = (one.control_points_mm.last(), next.control_points_mm.first()) else {
        return false;
    };
    let extent = next.control_points_mm.iter().map(|point| length(difference(point, start)));
    // Far from the origin, floats are coarser.
    let coarse = start.iter().fold(0.0, |most: f64, x| most.max(x.abs())) * 4.0 * f64::EPSILON;
    length(difference(start, end)) <= (EQUAL_POINTS * extent.fold(0.0, f64::max)).max(coarse)
}

/// Appends a curve that meets this one. All weights of a curve may be multiplied by a factor: the appended curve then
/// begins with the last weight of the first.
fn append(one: &mut Nurbs, next: Nurbs) {
    let scale = one.weights.last().copied().unwrap_or(1.0) / next.weights[0];
    one.knots.pop();
    one.knots.extend(&next.knots[next.degree + 1..]);
    one.control_points_mm.extend(&next.control_points_mm[1..]);
    one.weights.extend(next.weights[1..].iter().map(|weight| weight * scale));
}

#[cfg(test)]
mod tests {
    use nurbs_core::Evaluate;
    use proptest::prelude::*;

    use super::*;
    use crate::curve::Curve;

    /// Evaluates by the recurrence of Cox and de Boor, with any knots.
    fn basis(knots: &[f64], degree: usize, i: usize, u: f64) -> f64 {
        if degree == 0 {
            return if knots[i] <= u && u < knots[i + 1] { 1.0 } else { 0.0 };
        }
        let share = |part: f64, whole: f64| if whole > 0.0 { part / whole } else { 0.0 };
        share(u - knots[i], knots[i + degree] - knots[i]) * basis(knots, degree - 1, i, u)
            + share(knots[i + degree + 1] - u, knots[i + degree + 1] - knots[i + 1])
                * basis(knots, degree - 1, i + 1, u)
    }

    fn point(curve: &Nurbs, u: f64) -> [f64; 3] {
        let shares =
            (0..curve.weights.len()).map(|i| curve.weights[i] * basis(&curve.knots, curve.degree, i, u));
        let shares: Vec<_> = shares.collect();
        let sum: f64 = shares.iter().sum();
        std::array::from_fn(|axis| {
            let parts = shares.iter().zip(&curve.control_points_mm);
            parts.map(|(share, point)| share * point[axis]).sum::<f64>() / sum
        })
    }

    proptest! {
        /// For any knots, the clamped curve has the same points as the curve in the drawing.
        #[test]
        fn clamping_keeps_the_curve(
            degree in 1_usize..6,
            corners in prop::collection::vec(([-100.0..100.0_f64, -100.0..100.0, -100.0..100.0], 0.1..10.0_f64), 6..12),
            widths in prop::collection::vec(prop_oneof![Just(0.0), 0.1..2.0_f64], 18),
        ) {
            let (control_points_mm, weights): (Vec<_>, Vec<_>) = corners.into_iter().unzip();
            let count = control_points_mm.len();
            let mut knots: Vec<f64> = widths.iter().scan(-3.0, |knot, width| { *knot += width; Some(*knot) }).collect();
            knots.truncate(count + degree + 1);
            let drawn = Nurbs { degree, dimension: 3, control_points_mm, weights, knots };
            let Some(curves) = clamped(drawn.clone()) else { return Err(TestCaseError::reject("no curve")) };
            let (first, last) = (drawn.knots[degree], drawn.knots[count]);
            prop_assert_eq!((curves[0].knots[0], curves[curves.len() - 1].knots.last()), (first, Some(&last)));
            for curve in curves {
                prop_assert_eq!(curve.faults(), []);
                let nurbs = Curve::from(curve).for_evaluation().unwrap();
                let (from, to) = nurbs.as_curve().domain();
                for k in 0..40_u8 {
                    let u = from + (to - from) * f64::from(k) / 40.0;
                    let (found, expected) = (nurbs.as_curve().point(u), point(&drawn, u));
                    prop_assert!(length(difference(&found, &expected)) < 1e-9, "{u}: {found:?}, not {expected:?}");
                }
            }
        }
    }
}
