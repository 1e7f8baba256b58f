//! A SPLINE by the points it passes through: the cubic with two continuous derivatives.
//!
//! The parameter runs as the chords `h_i` between the points do. With the slopes `D_i` there and those of the chords `Δ_i`, the second
//! derivative is continuous where
//!
//! ```text
//! h_i D_{i-1} + 2 (h_{i-1} + h_i) D_i + h_{i-1} D_{i+1} = 3 (h_i Δ_{i-1} + h_{i-1} Δ_i)
//! ```
//!
//! An end has the unit vector along the tangent that the drawing gives, or no curvature: `2 D_0 + D_1 = 3 Δ_0`. A closed spline
//! goes on from its last point to its first. In each row the slope itself has at least twice the factors of the others together, so
//! that each sweep of Gauss and Seidel halves what is wrong, and 60 leave nothing of it.
//!
//! # Source
//! Piegl and Tiller, The NURBS Book, section 9.2.3, which has the same curve in another form. That tangents have length 1 for this
//! parameter is what a drawing with a known length shows: tests/cad.rs.

use crate::curve::Curve;
use crate::vector::{difference, length};

/// Sweeps over the rows: 2⁻⁶⁰ is below the rounding of f64.
const SWEEPS: usize = 60;

/// How a spline begins or ends.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum Ends {
    /// Along unit vectors, or without curvature.
    Open([Option<[f64; 3]>; 2]),
    /// In its own start.
    Closed,
}

/// The cubic through points that differ from their neighbours, two or more; a closed one ends in its first point.
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
        // The polar form at three knots, from the piece that is the longer: on it the third is nearer.
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
    let dimension = Curve::dimension_of(&control);
    let weights = vec![1.0; control.len()];
    Curve { degree: 3, control_points_mm: control, dimension, weights, knots }
}

/// The slopes at the points.
fn slopes(points: &[[f64; 3]], chords: &[f64], ends: Ends) -> Vec<[f64; 3]> {
    let last = points.len() - 1;
    let chord_slope = |i: usize| difference(&points[i + 1], &points[i]).map(|x| x / chords[i]);
    let mut slopes = vec![[0.0; 3]; last + 1];
    // Of a row: the slopes before and behind, and what the mean with the next chord gives.
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

/// The point `share` of a vector away.
fn along(point: [f64; 3], vector: [f64; 3], share: f64) -> [f64; 3] {
    std::array::from_fn(|axis| point[axis] + share * vector[axis])
}
