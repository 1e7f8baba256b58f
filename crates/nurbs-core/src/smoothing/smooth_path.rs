//! A path with its corners smoothed: each corner is planned by itself, then built in the room that its neighbours
//! leave.

use alloc::vec::Vec;

use crate::smoothing::corner_segment::Planned;
use crate::smoothing::corner_shape::CornerLambda;
use crate::smoothing::leg::Leg;
use crate::{Corner, CornerOutcome, CornerStyle, PathCurve, ShapeError, Turn};

/// A path with its corners smoothed.
#[derive(Clone, Debug, PartialEq)]
pub struct SmoothPath<const D: usize> {
    /// The curves: the parts left of the moves, and the segments between them.
    pub curves: Vec<PathCurve<f64, D>>,
    /// For each curve the index of the move that it is a part of; for a corner's segment, the index of the incoming
    /// move.
    pub moves: Vec<usize>,
    /// Every corner, in order.
    pub corners: Vec<Corner<D>>,
}

/// Smooths the corners of `moves`, which follow each other. `style` is called for each corner that can be smoothed; if
/// it returns `None` the corner stays as it is. `lambda` is the shape factor of all corners, or how it is found.
///
/// Moves without length are dropped. Each smoothed corner stays within `tolerance_mm` of the moves, and the moves stay
/// within that distance of it. Parts that are cut off a move at both its ends do not overlap.
///
/// # Errors
/// [`ShapeError::ToleranceNotPositive`]; [`ShapeError::LambdaOutOfRange`] unless |λ| ≤ [`MOST_CORNER_LAMBDA`](crate::MOST_CORNER_LAMBDA).
pub fn smooth_corners<const D: usize>(
    moves: &[PathCurve<f64, D>],
    tolerance_mm: f64,
    lambda: CornerLambda,
    mut style: impl FnMut(&Turn<D>) -> Option<CornerStyle>,
) -> Result<SmoothPath<D>, ShapeError> {
    if !(tolerance_mm > 0.0 && tolerance_mm.is_finite()) {
        return Err(ShapeError::ToleranceNotPositive);
    }
    if !lambda.is_in_range() {
        return Err(ShapeError::LambdaOutOfRange);
    }
    let legs: Vec<Leg<'_, D>> =
        moves.iter().enumerate().filter_map(|(i, curve)| Leg::new(i, curve)).collect();
    let planned: Vec<Planned<D>> = legs
        .windows(2)
        .map(|pair| Planned::new(&pair[0], &pair[1], tolerance_mm, lambda, &mut style))
        .collect();
    let wanted = |joint: Option<usize>| joint.and_then(|j| planned.get(j)).map_or(0.0, |p| p.wanted_mm);
    // Leg i lies between the joints i - 1 and i.
    let room = |leg: usize, other: Option<usize>| {
        let length = legs[leg].length_mm;
        (length / 2.0).max(length - wanted(other))
    };
    let mut path = SmoothPath { curves: Vec::new(), moves: Vec::new(), corners: Vec::new() };
    let mut used = 0.0; // of the current leg, at its beginning
    for (i, leg) in legs.iter().enumerate() {
        let cut = planned.get(i).zip(legs.get(i + 1)).map(|(plan, next)| {
            let distance = plan.wanted_mm.min(room(i, i.checked_sub(1))).min(room(i + 1, Some(i + 1)));
            (plan, plan.build(leg, next, distance, tolerance_mm))
        });
        let (at_end, next_used) = match &cut {
            Some((_, Ok(built))) => (built.distance_mm, built.distance_mm),
            _ => (0.0, 0.0),
        };
        if let Some(rest) = leg.without(used, at_end) {
            path.curves.push(rest);
            path.moves.push(leg.index);
        }
        used = next_used;
        if let Some((plan, result)) = cut {
            let outcome = match result {
                Ok(built) => {
                    let curve = path.curves.len();
                    path.curves.push(built.curve);
                    path.moves.push(leg.index);
                    let (style, error_mm, lambda) = (built.style, built.error_mm, built.lambda);
                    CornerOutcome::Smoothed { style, curve, error_mm, lambda }
                }
                Err(reason) => CornerOutcome::Left(reason),
            };
            path.corners.push(Corner { turn: plan.turn, outcome });
        }
    }
    Ok(path)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::smoothing::corner_segment::half_turn;
    use crate::vector::{add, distance, scaled};
    use crate::{Arc, Differentiate, Evaluate, Line, Reason, Sense, curvature};
    use proptest::prelude::*;
    use real::Real;

    fn polyline<const D: usize>(points: &[[f64; D]]) -> Vec<PathCurve<f64, D>> {
        points.windows(2).map(|p| Line::try_new(p[0], p[1]).unwrap().into()).collect()
    }

    fn cut<const D: usize>(moves: &[PathCurve<f64, D>], tolerance: f64) -> SmoothPath<D> {
        smooth_corners(moves, tolerance, CornerLambda::default(), |_| Some(CornerStyle::Cut)).unwrap()
    }

    fn reason<const D: usize>(path: &SmoothPath<D>, corner: usize) -> Option<Reason> {
        match path.corners[corner].outcome {
            CornerOutcome::Left(reason) => Some(reason),
            CornerOutcome::Smoothed { .. } => None,
        }
    }

    /// Points along a curve, close together.
    fn dense<const D: usize>(curve: &PathCurve<f64, D>, count: i32) -> Vec<[f64; D]> {
        let (begin, end) = curve.domain();
        (0..=count).map(|i| curve.point(begin + (end - begin) * f64::from(i) / f64::from(count))).collect()
    }

    /// Distance from a point to a polygon, by projecting on each side.
    fn to_polygon<const D: usize>(point: &[f64; D], polygon: &[[f64; D]]) -> f64 {
        let to_side = |side: &[[f64; D]]| {
            let (a, b) = (side[0], side[1]);
            let (mut along, mut square) = (0.0, 0.0);
            for d in 0..D {
                along += (point[d] - a[d]) * (b[d] - a[d]);
                square += (b[d] - a[d]).powi(2);
            }
            let u = if square > 0.0 { (along / square).clamp(0.0, 1.0) } else { 0.0 };
            (0..D).map(|d| (a[d] + u * (b[d] - a[d]) - point[d]).powi(2)).sum::<f64>().sqrt()
        };
        polygon.windows(2).map(to_side).fold(f64::INFINITY, f64::min)
    }

    /// The largest distance between the smooth path and the moves, both ways, by polygons of many points: a check that shares
    /// nothing with what it checks but the points of the curves.
    fn deviation<const D: usize>(moves: &[PathCurve<f64, D>], path: &SmoothPath<D>) -> f64 {
        let sides = |curve: &PathCurve<f64, D>| if matches!(curve, PathCurve::Line(_)) { 1 } else { 400 };
        let of_moves: Vec<_> = moves.iter().map(|m| dense(m, sides(m))).collect();
        let of_path: Vec<_> = path.curves.iter().map(|c| dense(c, sides(c))).collect();
        let (mut worst, near) = (0.0_f64, 3);
        for (curve, index) in path.curves.iter().zip(&path.moves) {
            let close = index.saturating_sub(near)..(index + near + 1).min(moves.len());
            let nearest = |p: &[f64; D]| {
                of_moves[close.clone()].iter().map(|m| to_polygon(p, m)).fold(f64::MAX, f64::min)
            };
            worst = dense(curve, 40).iter().map(nearest).fold(worst, f64::max);
        }
        let mut first = 0;
        for (index, polygon) in of_moves.iter().enumerate() {
            // Curves are in order of moves; those of near moves lie close together.
            while path.moves.get(first).is_some_and(|m| m + near < index) {
                first += 1;
            }
            let close = of_path.iter().zip(&path.moves).skip(first).take_while(|(_, m)| **m <= index + near);
            let close: Vec<_> = close.map(|(polygon, _)| polygon).collect();
            let nearest = |p: &[f64; D]| close.iter().map(|c| to_polygon(p, c)).fold(f64::MAX, f64::min);
            worst = [polygon[0], polygon[polygon.len() - 1]].iter().map(nearest).fold(worst, f64::max);
        }
        worst
    }

    /// The curves follow each other, with one direction but for the corners that were left.
    fn is_continuous<const D: usize>(path: &SmoothPath<D>) -> Result<(), TestCaseError> {
        let left: Vec<_> = path
            .corners
            .iter()
            .filter(|c| matches!(c.outcome, CornerOutcome::Left(_)))
            .map(|c| c.turn.point)
            .collect();
        for (i, pair) in path.curves.windows(2).enumerate() {
            let (end, begin) = (pair[0].domain().1, pair[1].domain().0);
            let (a, b) = (pair[0].derivatives_in(usize::MAX, end), pair[1].derivatives_in(0, begin));
            prop_assert!(distance(&a.point, &b.point) <= 1e-11, "curves {i}: {:?} {:?}", a.point, b.point);
            let is_left = left.iter().any(|corner| distance(corner, &a.point) <= 1e-9);
            let (sine, cosine) = half_turn(&unit(a.first), &unit(b.first));
            prop_assert!(is_left || sine <= 1e-6 && cosine > 0.0, "curves {i}: {:?} {:?}", a.first, b.first);
        }
        Ok(())
    }

    fn unit<const D: usize>(v: [f64; D]) -> [f64; D] {
        let length = f64::norm(&v);
        v.map(|x| x / length)
    }

    fn corner_of<const D: usize>(path: &SmoothPath<D>, corner: usize) -> (&PathCurve<f64, D>, f64) {
        match path.corners[corner].outcome {
            CornerOutcome::Smoothed { curve, error_mm, .. } => (&path.curves[curve], error_mm),
            CornerOutcome::Left(reason) => panic!("left: {reason}"),
        }
    }

    fn greatest_curvature(curve: &PathCurve<f64, 2>) -> f64 {
        (1..1000).map(|i| curvature(&curve.derivatives(f64::from(i) / 1000.0))).fold(0.0, f64::max)
    }

    /// Two moves of 100 mm, turning by an angle in degrees.
    fn turning(degrees: f64) -> Vec<PathCurve<f64, 2>> {
        let angle = degrees.to_radians();
        polyline(&[[-100.0, 0.0], [0.0, 0.0], [100.0 * angle.cos(), 100.0 * angle.sin()]])
    }

    proptest! {
        #[test]
        fn every_corner_of_a_polyline_is_within_tolerance(
            steps in proptest::collection::vec([-1.0..1.0, -1.0..1.0, -0.2..0.2], 3..20),
            scale in -2..2_i32, exponent in -4..1_i32, loops: bool,
        ) {
            let (scale, tolerance) = (10.0_f64.powi(scale), 10.0_f64.powi(exponent));
            let mut points = vec![[0.0; 3]];
            for step in steps {
                let last = points[points.len() - 1];
                points.push(add(&last, &scaled(&step, scale)));
            }
            let moves = polyline(&points);
            let style = if loops { CornerStyle::Loop } else { CornerStyle::Cut };
            let path = smooth_corners(&moves, tolerance, CornerLambda::default(), |_| Some(style)).unwrap();
            prop_assert_eq!(path.corners.len(), moves.len() - 1);
            is_continuous(&path)?;
            prop_assert!(deviation(&moves, &path) <= tolerance * (1.0 + 1e-9), "{}", deviation(&moves, &path));
            for (i, corner) in path.corners.iter().enumerate() {
                let expected = [None, Some(Reason::Reversal)];
                prop_assert!(expected.contains(&reason(&path, i)), "{corner:?}");
                let reversal = corner.turn.turn_rad > 170.0_f64.to_radians();
                prop_assert_eq!(reason(&path, i).is_some(), reversal);
            }
            prop_assert_eq!(path.curves[0].point(0.0), points[0]);
            let last = path.curves.last().unwrap();
            prop_assert_eq!(last.point(last.domain().1), points[points.len() - 1]);
        }

        #[test]
        fn corners_of_lines_and_arcs_are_within_tolerance_or_left(
            radius in 0.5..20.0_f64, by in 0.1..3.9_f64, turn in 10.0..160.0_f64, clockwise: bool, exponent in -4..0_i32,
        ) {
            // A line, an arc that leaves it at an angle, and a line that leaves the arc at an angle.
            let tolerance = 10.0_f64.powi(exponent);
            let (side, sense) = if clockwise { (-1.0, Sense::Clockwise) } else { (1.0, Sense::Counterclockwise) };
            let direction = turn.to_radians();
            let centre = [-radius * side * direction.sin(), radius * side * direction.cos()];
            let around = |quarters: f64| {
                let angle = direction - side * core::f64::consts::FRAC_PI_2 + side * quarters * core::f64::consts::FRAC_PI_2;
                [centre[0] + radius * angle.cos(), centre[1] + radius * angle.sin()]
            };
            let end = around(by);
            let arc = Arc::in_plane([[0.0, 0.0], end, centre], [0, 1], sense, 1e-6).unwrap();
            let line = |a, b| PathCurve::from(Line::try_new(a, b).unwrap());
            let moves = [line([-30.0, 0.0], [0.0, 0.0]), arc.into(), line(end, [end[0], end[1] + 30.0])];
            let path = cut(&moves, tolerance);
            is_continuous(&path)?;
            // Polygons of 400 sides leave an arc of 20 mm and a full turn by 6e-4 mm at most.
            prop_assert!(deviation(&moves, &path) <= tolerance + 7e-4, "{}", deviation(&moves, &path));
            for corner in 0..2 {
                // An arc that almost turns back, or bends a lot within the distance of a cut, may leave no room.
                let turn = path.corners[corner].turn.turn_rad;
                let may_lack_room = radius < 10.0 * tolerance || turn > 160.0_f64.to_radians();
                let is_expected = match reason(&path, corner) {
                    None | Some(Reason::Reversal | Reason::Tangent) => true,
                    found => found == Some(Reason::NoRoom) && may_lack_room,
                };
                prop_assert!(is_expected, "{:?}", path.corners);
            }
        }
    }

    /// An arc on the left of its start, or on the right, that leaves it in a direction and turns by `sweep`.
    fn arc_from(start: [f64; 2], direction: f64, radius: f64, is_left: bool, sweep: f64) -> Arc<f64, 2> {
        let (side, sense) = if is_left { (1.0, Sense::Counterclockwise) } else { (-1.0, Sense::Clockwise) };
        let centre = [start[0] - radius * side * direction.sin(), start[1] + radius * side * direction.cos()];
        let angle = direction + side * (sweep - core::f64::consts::FRAC_PI_2);
        let end = [centre[0] + radius * angle.cos(), centre[1] + radius * angle.sin()];
        Arc::in_plane([start, end, centre], [0, 1], sense, 1e-6).unwrap()
    }

    /// Beside an arc a cut may be farthest from the moves between two samples, by 0.25 % more than at them: whether it is
    /// taken must not hang on where they lie.
    #[test]
    fn the_largest_cut_beside_an_arc_is_within_tolerance() {
        let back = arc_from([0.0, 0.0], core::f64::consts::PI, 313.0, false, 0.9);
        let (start, centre) = (back.point(back.quarters()), *back.centre());
        let before =
            Arc::in_plane([start, [0.0, 0.0], centre], [0, 1], Sense::Counterclockwise, 1e-6).unwrap();
        let mut largest = 0.0_f64;
        for (sweep, turn) in
            [0.74, 0.76, 0.78].into_iter().flat_map(|a| [0.0025, 0.005, 0.0075].map(|b| (a, b)))
        {
            // The cut takes all of the second arc, for every tolerance that lets it.
            let moves = [before.into(), arc_from([0.0; 2], turn, 66.8, false, sweep).into()];
            let is_whole = |tolerance| cut(&moves, tolerance).curves.len() == 2;
            let (mut refused, mut tolerance) = (1e-3, 10.0);
            assert!(is_whole(tolerance) && !is_whole(refused), "{sweep} {turn}");
            for _ in 0..40 {
                let middle = f64::midpoint(refused, tolerance);
                if is_whole(middle) { tolerance = middle } else { refused = middle }
            }
            let legs: Vec<_> = moves.iter().enumerate().filter_map(|(i, one)| Leg::new(i, one)).collect();
            let path = cut(&moves, tolerance);
            let to_moves = |p: &[f64; 2]| legs[0].distance_mm(p).min(legs[1].distance_mm(p));
            let off = dense(corner_of(&path, 0).0, 4000).iter().map(to_moves).fold(0.0, f64::max);
            assert!(off <= tolerance, "turn {turn}, sweep {sweep}: {off} > {tolerance}");
            largest = largest.max(off / tolerance);
        }
        assert!(largest > 0.998, "no cut is at its limit: {largest}");
    }

    #[test]
    fn a_cut_is_nearly_as_round_as_a_circle() {
        for degrees in (1..170).map(f64::from) {
            let path = cut(&turning(degrees), 0.1);
            let (curve, error) = corner_of(&path, 0);
            assert!((path.corners[0].turn.turn_rad.to_degrees() - degrees).abs() < 1e-6);
            // The distance follows from the error: the tolerance is used up.
            assert!((0.0998..=0.1).contains(&error), "{degrees}: {error}");
            // A circle of radius ρ, tangent to both, comes within ρ(1/cos(φ/2) - 1) of the corner.
            let of_circle = 1.0 / (degrees.to_radians() / 2.0).cos() - 1.0;
            let ratio = greatest_curvature(curve) * error / of_circle;
            assert!(ratio <= 1.21, "{degrees}: {ratio}");
        }
        let path = cut(&turning(90.0), 0.1);
        let (quarter, _) = corner_of(&path, 0);
        let bend = greatest_curvature(quarter);
        assert!((bend * 0.0999 / (2.0_f64.sqrt() - 1.0) - 1.0).abs() < 5e-3, "{bend}");
    }

    #[test]
    fn a_loop_has_the_figures_of_another_program() {
        // For ℓ = 1 and 90°: farthest 0.187, greatest curvature 28.3; no curvature at its ends.
        let moves = turning(90.0);
        let path =
            smooth_corners(&moves, 0.187, CornerLambda::default(), |_| Some(CornerStyle::Loop)).unwrap();
        let (curve, error) = corner_of(&path, 0);
        assert!((error - 0.999 * 0.187).abs() < 1e-12);
        assert!((greatest_curvature(curve) - 28.3).abs() < 0.1, "{}", greatest_curvature(curve));
        let outside = curve.point(0.5);
        assert!(outside[0] > 0.1 && outside[1] < -0.1, "{outside:?}");
        for end in [0.0, 1.0] {
            assert_eq!(curve.point(end), [0.0, 0.0]);
            assert!(curvature(&curve.derivatives(end)) < 1e-9);
        }
        assert_eq!((&path.curves[0], &path.curves[2]), (&moves[0], &moves[1]));
    }

    #[test]
    fn moves_that_are_none_and_corners_that_are_none() {
        // A zero-length move is dropped, and the corner is that of its neighbours.
        let path = cut(&polyline(&[[0.0, 0.0], [10.0, 0.0], [10.0, 0.0], [10.0, 10.0]]), 0.1);
        assert_eq!(path.moves, [0, 0, 2]);
        assert_eq!((path.corners.len(), path.corners[0].turn.after), (1, 2));
        // Collinear moves have no corner; a reversal has one that stays.
        let path = cut(&polyline(&[[0.0, 0.0], [10.0, 5.0], [20.0, 10.0], [0.0, 0.0]]), 0.1);
        assert_eq!([reason(&path, 0), reason(&path, 1)], [Some(Reason::Tangent), Some(Reason::Reversal)]);
        assert_eq!((path.corners[1].turn.turn_rad - core::f64::consts::PI).abs(), 0.0);
        assert_eq!(path.curves.len(), 3);
        // Moves apart, a spline, and what the caller wants left.
        let line = |a, b| PathCurve::from(Line::try_new(a, b).unwrap());
        let spline = line([10.0, 0.0], [10.0, 10.0]).to_nurbs(1.0).unwrap().into();
        let path = cut(&[line([0.0, 0.0], [9.0, 0.0]), line([10.0, 0.0], [10.0, 5.0])], 0.1);
        assert_eq!(reason(&path, 0), Some(Reason::NotJoined));
        let path = cut(&[line([0.0, 0.0], [10.0, 0.0]), spline], 0.1);
        assert_eq!((reason(&path, 0), path.curves.len()), (Some(Reason::NotLineOrArc), 2));
        let path = smooth_corners(&turning(90.0), 0.1, CornerLambda::default(), |_| None).unwrap();
        assert_eq!((reason(&path, 0), path.curves), (Some(Reason::Wanted), turning(90.0)));
        assert_eq!(cut::<2>(&[], 0.1).curves, []);
        assert_eq!(
            smooth_corners::<2>(&[], 0.0, CornerLambda::default(), |_| None),
            Err(ShapeError::ToleranceNotPositive)
        );
    }

    #[test]
    fn moves_shorter_than_the_tolerance_share_their_room() {
        // A staircase of 10 µm steps with a tolerance of 1 mm: each corner takes half of both moves, and nothing is left of them.
        let stairs: Vec<_> =
            (0..=20_i32).map(|i| [f64::from((i + 1) / 2) * 0.01, f64::from(i / 2) * 0.01]).collect();
        let path = cut(&polyline(&stairs), 1.0);
        assert_eq!((path.corners.len(), path.curves.len()), (19, 21));
        is_continuous(&path).unwrap();
        let middle = corner_of(&path, 9).0;
        assert!(
            (middle.point(0.0)[0] - stairs[9][0]).abs().max((middle.point(0.0)[1] - stairs[9][1]).abs())
                < 5.1e-3
        );
        // A corner that needs less than half leaves the rest to its neighbour.
        let path = cut(&polyline(&[[-50.0, 0.0], [0.0, 0.0], [0.0, 1.0], [0.01, 50.0]]), 0.3);
        let (sharp, flat) = (corner_of(&path, 0).0, corner_of(&path, 1).0);
        assert!(sharp.point(1.0)[1] > 0.49 && flat.point(0.0)[1] >= sharp.point(1.0)[1]);
    }

    #[test]
    fn every_corner_of_an_engraving_is_within_tolerance() {
        // 6 500 cutting moves of 75 outlines; rapid moves and plunges are followed as they are.
        let program = include_str!("../../../../data/engraving.nc");
        let (mut at, mut points, mut cuts) = ([0.0; 3], vec![[0.0; 3]], Vec::new());
        for line in program.lines().filter(|line| line.starts_with('G')) {
            let mut next = at;
            for word in line.split_whitespace() {
                if let Some(axis) = "XYZ".find(&word[..1]) {
                    next[axis] = word[1..].parse().unwrap();
                }
            }
            if next != at {
                cuts.push(line.starts_with("G1") && next[2] == at[2]);
                points.push(next);
                at = next;
            }
        }
        let moves = polyline(&points);
        let cutting = |turn: &Turn<3>| cuts[turn.before] && cuts[turn.after];
        let tolerance = 0.01;
        let path = smooth_corners(&moves, tolerance, CornerLambda::default(), |turn| {
            cutting(turn).then_some(CornerStyle::Cut)
        })
        .unwrap();
        let count = |of: Option<Reason>| (0..path.corners.len()).filter(|i| reason(&path, *i) == of).count();
        let smoothed = count(None);
        assert_eq!(smoothed + count(Some(Reason::Tangent)) + count(Some(Reason::Wanted)), path.corners.len());
        assert!(smoothed > 6000, "{smoothed}");
        is_continuous(&path).unwrap();
        let worst = deviation(&moves, &path);
        assert!(worst <= tolerance, "{worst}");
    }
}
