//! A SPLINE by the points it passes through: the cubic with two continuous derivatives.
//!
//! The parameter is proportional to the chords `h_i` between the points. Let `D_i` be the slopes at the points and
//! `Δ_i` those of the chords. The second derivative is continuous where
//!
//! ```text
//! h_i D_{i-1} + 2 (h_{i-1} + h_i) D_i + h_{i-1} D_{i+1} = 3 (h_i Δ_{i-1} + h_{i-1} Δ_i)
//! ```
//!
//! An end has as its slope the unit vector along the tangent that the drawing gives, or it has no curvature: `2 D_0 +
//! D_1 = 3 Δ_0`. A closed spline goes on from its last point to its first. In each row the factor of the slope itself
//! is at least twice the sum of the others, so each sweep of Gauss and Seidel halves the error, and 60 sweeps remove
//! it.
//!
//! # Source
//! Piegl and Tiller, The NURBS Book, section 9.2.3, which has the same curve in another form. A drawing of known length
//! shows that tangents have length 1 in this parameter: tests/programs/cad.rs.

use crate::curve::{Curve, Nurbs};
use crate::vector::{difference, length};

/// Sweeps over the rows: 2⁻⁶⁰ is below the rounding of f64.
const SWEEPS: usize = 60;

/// The ends of a spline.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum Ends {
    /// The ends have these unit vectors as tangents, or no curvature.
    Open([Option<[f64; 3]>; 2]),
    /// The spline ends in its own start.
    Closed,
}

/// The cubic through two or more points, each of which differs from its neighbours. A closed one ends in its first
/// point.
pub(crate) fn through(points: &[[f64; 3]], ends: Ends) -> Curve {
    let chords: Vec<_> = points.windows(2).map(|pair| length(difference(&pair[1], &pair[0]))).collect();
    let slopes = slopes(points, &chords, ends);
    let last = points.len() - 1;
    // The inner control points of the Bézier piece i.
    let inner = |i: usize| {
        let third = chords[i] / 3.0;
        [along(points[i], slopes[i], third), along(points[i + 1], slopes[i + 1], -third)]
    };
    let mut control = vec![points[0], inner(0)[0]];
    for i in 1..last {
        // The polar form at three knots, taken from the longer piece: the third knot is nearer to it.
        let (before, next) = (chords[i - 1], chords[i]);
        let ([from, to], share) =
            if next >= before { (inner(i), -before / next) } else { (inner(i - 1), 1.0 + next / before) };
        control.push(along(from, difference(&to, &from), share));
    }
    control.extend([inner(last - 1)[1], points[last]]);

    let mut knots = vec![0.0; 3];
    knots.push(0.0);
    knots.extend(chords.iter().scan(0.0, |sum, chord| {
        *sum += chord;
        Some(*sum)
    }));
    knots.extend([knots[knots.len() - 1]; 3]);
    let dimension = Nurbs::dimension_of(&control);
    let weights = vec![1.0; control.len()];
    Nurbs { degree: 3, control_points_mm: control, dimension, weights, knots }.into()
}

/// The slopes at the points.
fn slopes(points: &[[f64; 3]], chords: &[f64], ends: Ends) -> Vec<[f64; 3]> {
    let last = points.len() - 1;
    let chord_slope = |i: usize| difference(&points[i + 1], &points[i]).map(|x| x / chords[i]);
    let mut slopes = vec![[0.0; 3]; last + 1];
    // For each row: the factors of the slopes before and behind, and the mean with the next chord's slope.
    let inner = |slopes: &[[f64; 3]], before: usize, i: usize| {
        let (h, next) = (chords[before], chords[i]);
        let (low, high) = (chord_slope(before), chord_slope(i));
        let (from, to) = (slopes[before], slopes[i + 1]);
        std::array::from_fn(|axis| {
            let right = 3.0 * (next * low[axis] + h * high[axis]);
            (right - next * from[axis] - h * to[axis]) / (2.0 * (h + next))
        })
    };
    let natural = |chord: [f64; 3], other: [f64; 3]| {
        std::array::from_fn(|axis| (3.0 * chord[axis] - other[axis]) / 2.0)
    };
    for _ in 0..SWEEPS {
        slopes[0] = match ends {
            Ends::Open([Some(tangent), _]) => tangent,
            Ends::Open([None, _]) => natural(chord_slope(0), slopes[1]),
            Ends::Closed => inner(&slopes, last - 1, 0),
        };
        for i in 1..last {
            slopes[i] = inner(&slopes, i - 1, i);
        }
        slopes[last] = match ends {
            Ends::Open([_, Some(tangent)]) => tangent,
            Ends::Open([_, None]) => natural(chord_slope(last - 1), slopes[last - 1]),
            Ends::Closed => slopes[0],
        };
    }
    slopes
}

/// The point at `share` of a vector.
fn along(point: [f64; 3], vector: [f64; 3], share: f64) -> [f64; 3] {
    std::array::from_fn(|axis| point[axis] + share * vector[axis])
}
