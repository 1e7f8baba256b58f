//! A program as stretches: moves that the tool passes from rest to rest, with one feed and no other word between them.

use std::fmt;
use std::ops::Range;

use nurbs_core::{Arc, Evaluate, Line, NurbsBuf, PathCurve, ShapeError};
use part_program::{Curve, Move, Nurbs, Part, Shape};

/// The reason why the tool rests between two moves, whatever their directions.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Rest {
    /// The machine would rest there in any run.
    Machine(part_program::Rest),
    /// The moves have different feeds, and a smoothed corner has only one.
    FeedChange,
}

impl fmt::Display for Rest {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Machine(rest) => rest.fmt(f),
            Self::FeedChange => f.write_str("the feed changes"),
        }
    }
}

/// The part with every polygon, a curve of degree 1 with more than two points, as a straight move for each side.
pub(crate) fn with_polygons_as_lines(part: &Part) -> Part {
    let (mut curves, mut moves) = (Vec::new(), Vec::new());
    for (curve, one) in part.curves.iter().zip(&part.moves) {
        if curve.degree() != 1 {
            curves.push(curve.clone());
            moves.push(*one);
            continue;
        }
        let first = moves.len();
        for side in curve.control_points_mm().windows(2).filter(|side| side[0] != side[1]) {
            let side = Nurbs {
                degree: 1,
                control_points_mm: side.to_vec(),
                dimension: curve.dimension(),
                weights: vec![1.0; 2],
                knots: vec![0.0, 0.0, 1.0, 1.0],
            };
            curves.push(side.into());
            moves.push(Move { shape: Shape::Line, exact_stop: false, ..*one });
        }
        // Only the last side ends where the polygon ends.
        if let Some(last) = moves[first..].last_mut() {
            last.exact_stop = one.exact_stop;
        }
    }
    Part { curves, moves, ..part.clone() }
}

/// The stretches of a part, in order, as ranges of its moves.
pub(crate) fn stretches(part: &Part) -> Vec<Range<usize>> {
    let mut found = Vec::new();
    let mut begin = 0;
    for next in 1..=part.moves.len() {
        if next == part.moves.len() || rest_before(part, next).is_some() {
            found.push(begin..next);
            begin = next;
        }
    }
    found
}

/// The reason why the tool rests before a move; `None` if it does not.
pub(crate) fn rest_before(part: &Part, next: usize) -> Option<Rest> {
    let (before, after) = (part.moves.get(next.checked_sub(1)?)?, part.moves.get(next)?);
    let changes = before.feedrate_mm_per_s != after.feedrate_mm_per_s;
    part.rest_before(next).map(Rest::Machine).or(changes.then_some(Rest::FeedChange))
}

/// The shape of a move for smoothing: a line, an arc of a circle, or any other curve.
pub(crate) fn shape_of(curve: &Curve) -> Result<PathCurve<f64, 3>, ShapeError> {
    if let ([a, b], 1) = (curve.control_points_mm(), curve.degree()) {
        return Ok(Line::try_new(*a, *b)?.into());
    }
    let nurbs = curve.for_evaluation()?;
    Ok(match circle_of(&nurbs) {
        Some(arc) => arc.into(),
        None => nurbs.into(),
    })
}

/// A rational curve is taken for a circle if it is no farther from it than this, in mm.
const CIRCLE_TOLERANCE_MM: f64 = 1e-7;

/// The circular arc that a rational curve of degree 2 represents; `None` if it is no arc, or if its spans are not
/// equal, as readers make them.
///
/// A span from S to E whose tangents meet in M has the weight w = cos α in the middle, where α is half the span's
/// angle. The centre lies on the line through M and the middle Q of the chord, at `Q - (M - Q) w²/(1 - w²)`.
fn circle_of(nurbs: &NurbsBuf<f64, 3>) -> Option<Arc<f64, 3>> {
    let (points, weights) = (nurbs.control_points(), nurbs.weights());
    if nurbs.degree() != 2 || points.len().is_multiple_of(2) {
        return None;
    }
    let (&[start, meet, end, ..], &[_, weight, ..]) = (points, weights) else { return None };
    let share = weight * weight / (1.0 - weight * weight);
    let centre: [f64; 3] = std::array::from_fn(|d| {
        let middle = f64::midpoint(start[d], end[d]);
        middle - (meet[d] - middle) * share
    });
    let arm: [f64; 3] = std::array::from_fn(|d| start[d] - centre[d]);
    let tangent: [f64; 3] = std::array::from_fn(|d| meet[d] - start[d]);
    let tangent_of_half = length(&tangent) / length(&arm);
    let spans = f64::from(u32::try_from(points.len() / 2).ok()?);
    let quarters = (spans * tangent_of_half.atan() * 4.0 / std::f64::consts::PI).min(4.0);
    let arc = Arc::try_new(centre, [arm, tangent.map(|x| x / tangent_of_half)], quarters).ok()?;
    // The curve's parameter and the arc's angle agree at the ends and in the middle of a span, so the curve is compared
    // there.
    let curve = nurbs.as_curve();
    let (first, last) = curve.domain();
    let checks = 2 * u32::try_from(points.len() / 2).ok()?;
    let is_on = |check: u32| {
        let share = f64::from(check) / f64::from(checks);
        let (a, b) = (curve.point(first + (last - first) * share), arc.point(quarters * share));
        length(&std::array::from_fn(|d| a[d] - b[d])) <= CIRCLE_TOLERANCE_MM
    };
    (0..=checks).all(is_on).then_some(arc)
}

/// The length of a vector.
pub(crate) fn length(v: &[f64; 3]) -> f64 {
    v.iter().map(|x| x * x).sum::<f64>().sqrt()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn part(program: &str) -> Part {
        part_program::read_part("p.nc", program).unwrap()
    }

    #[test]
    fn a_stretch_ends_where_the_tool_rests() {
        let part = part(
            "G0 X0 Y0 Z5\nG0 X1\nG1 Z0 F300\nG1 X5 F2400\nG1 Y5\nM8\nG1 X0\nG1 Y9 M9\nG1 X3\nG1 X4\nG0 Z5\nM30\n",
        );
        // Moves: rapid X1 | Z0 | X5, Y5 | X0 | Y9 | X3, X4 | rapid.
        assert_eq!(stretches(&part), [0..1, 1..2, 2..4, 4..5, 5..6, 6..8, 8..9]);
        let rests: Vec<_> = (0..9).map(|next| rest_before(&part, next)).collect();
        let [rapid, word] =
            [part_program::Rest::Rapid, part_program::Rest::Auxiliary].map(|rest| Some(Rest::Machine(rest)));
        let feed = Some(Rest::FeedChange);
        assert_eq!(rests, [None, rapid, feed, None, word, word, word, None, rapid]);
    }

    #[test]
    fn arcs_are_recognised_and_helices_are_not() {
        for (program, quarters) in [
            ("G1 X0 Y0 F60\nG3 X-10 Y10 I-10 J0\n", Some(1.0)),
            ("G1 X0 Y0 F60\nG2 X0 Y0 I4 J3\n", Some(4.0)),
            ("G18 G1 X0 Y0 Z0 F60\nG2 X0.001 Z0 R100\n", Some(0.001 / 100.0 * 2.0 / std::f64::consts::PI)),
            ("G1 X0 Y0 F60\nG3 X1 Y1 R-1\n", Some(3.0)),
            ("G1 X0 Y0 Z0 F60\nG3 X-10 Y10 Z1 I-10 J0\n", None),
        ] {
            let part = part(program);
            match (shape_of(part.curves.last().unwrap()).unwrap(), quarters) {
                (PathCurve::Arc(arc), Some(quarters)) => {
                    assert!((arc.quarters() - quarters).abs() < 1e-9, "{program}: {}", arc.quarters());
                }
                (PathCurve::Nurbs(_), None) => {}
                other => panic!("{program}: {other:?}"),
            }
        }
    }

    #[test]
    fn a_polygon_is_its_sides() {
        let text =
            "[curve]\ndegree = 1\ncontrol_points_mm = [[0,0],[1,0],[1,1],[0,1]]\nknots = [0,0,1,2,3,3]\n";
        let part = with_polygons_as_lines(&part_program::read_part("p.toml", text).unwrap());
        assert_eq!((part.curves.len(), part.moves.len()), (3, 3));
        assert!(part.curves.iter().all(|curve| curve.faults().is_empty()));
        assert_eq!((stretches(&part).len(), stretches(&part)[0].clone()), (1, 0..3));
    }
}
