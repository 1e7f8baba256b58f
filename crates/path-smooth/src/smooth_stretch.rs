//! One stretch with smoothed corners: as lines, arcs and trigonometric splines, and in the form that real time
//! evaluates.

use std::f64::consts::FRAC_PI_2;

use nurbs_core::{
    CornerLambda, CornerStyle, Differentiate, Evaluate, PathCurve, ShapeError, SmoothPath, Turn,
    smooth_corners,
};
use part_program::{Curve, Nurbs};

use crate::stretch::{length, shape_of};

/// Share of the tolerance that is left to the chords of fine straight moves.
pub(crate) const CHORD_SHARE: f64 = 0.02;
/// Share of the tolerance that is left to the polynomials, and the largest distance that they need, in mm.
const POLYNOMIAL_SHARE: f64 = 1e-3;
const POLYNOMIAL_MM: f64 = 1e-6;
/// Degree of these polynomials. A corner has a handful of them, and their second derivatives at joints are those of the
/// spline.
const POLYNOMIAL_DEGREE: usize = 5;

/// Outer corners that turn by less, in degrees, are cut even where loops are wanted. A loop turns by nearly a full turn
/// more than its corner, in as little room as the tolerance gives. Its least radius is a fifth of the tolerance at 90°,
/// 1/35 at 30° and 1/1200 at 5°. A cut there has a radius of 2.4, 24 and 880 times the tolerance, and almost keeps the
/// feed.
pub const LEAST_LOOPED_DEG: f64 = 30.0;

/// A smoothed stretch.
pub(crate) struct SmoothStretch {
    /// The moves before smoothing.
    pub(crate) moves: Vec<PathCurve<f64, 3>>,
    /// The smooth path; its corners are trigonometric splines.
    pub(crate) path: SmoothPath<3>,
    /// The curves of `path` as NURBS: lines and arcs exactly, corners as polynomials of the same parameter.
    pub(crate) curves: Vec<Curve>,
    /// Proven bound of the distance of a polynomial from its spline, in mm.
    pub(crate) polynomial_bound_mm: f64,
    /// The turning senses that tell which corners are outer ones, if outer corners are to be looped.
    looped: Option<Sides>,
}

impl SmoothStretch {
    /// Smooths the corners of moves; if `outer` is `None`, it leaves them all sharp.
    pub(crate) fn new(
        curves: &[Curve],
        tolerance_mm: f64,
        lambda: CornerLambda,
        outer: Option<CornerStyle>,
    ) -> Result<Self, ShapeError> {
        let moves = curves.iter().map(shape_of).collect::<Result<Vec<_>, _>>()?;
        let polynomial_mm = (tolerance_mm * POLYNOMIAL_SHARE).min(POLYNOMIAL_MM);
        let sides = Sides::of(&moves);
        let style = |turn: &Turn<3>| match outer {
            Some(CornerStyle::Loop) if is_shallow(turn) || !sides.is_outer(turn) => Some(CornerStyle::Cut),
            outer => outer,
        };
        let path = smooth_corners(&moves, tolerance_mm * (1.0 - CHORD_SHARE) - polynomial_mm, lambda, style)?;
        let dimension = curves.iter().map(|curve| curve.dimension()).max().unwrap_or(3);
        let (mut written, mut bound) = (Vec::with_capacity(path.curves.len()), 0.0_f64);
        for curve in &path.curves {
            let nurbs = match curve {
                PathCurve::TrigSpline(spline) => {
                    let polynomials = spline.to_polynomials(polynomial_mm, POLYNOMIAL_DEGREE)?;
                    bound = bound.max(polynomials.error_bound_mm);
                    polynomials.curve
                }
                other => other.to_nurbs(polynomial_mm)?,
            };
            written.push(Nurbs::of(&nurbs, dimension).into());
        }
        let looped = (outer == Some(CornerStyle::Loop)).then_some(sides);
        Ok(Self { moves, path, curves: written, polynomial_bound_mm: bound, looped })
    }

    /// Whether a corner is cut only because it is too shallow for a loop.
    pub(crate) fn is_too_shallow(&self, turn: &Turn<3>) -> bool {
        is_shallow(turn) && self.looped.as_ref().is_some_and(|sides| sides.is_outer(turn))
    }
}

fn is_shallow(turn: &Turn<3>) -> bool {
    turn.turn_rad.to_degrees() < LEAST_LOOPED_DEG
}

/// In which sense a stretch turns in total, and in which sense each of its corners turns.
struct Sides {
    /// Directions at both ends of each move.
    directions: Vec<[[f64; 3]; 2]>,
    /// The sum of all turns, each along its axis, in rad.
    total: [f64; 3],
}

impl Sides {
    fn of(moves: &[PathCurve<f64, 3>]) -> Self {
        let directions: Vec<_> = moves.iter().map(end_directions).collect();
        let mut total = [0.0; 3];
        let mut add = |turn: [f64; 3]| (0..3).for_each(|d| total[d] += turn[d]);
        for pair in directions.windows(2) {
            add(turn_vector(&pair[0][1], &pair[1][0]));
        }
        for curve in moves {
            if let PathCurve::Arc(arc) = curve {
                let [a, b] = arc.radii();
                let axis = cross(a, b);
                let angle = arc.quarters() * FRAC_PI_2;
                add(axis.map(|x| x / length(&axis) * angle));
            }
        }
        Self { directions, total }
    }

    /// Whether a corner turns in the same sense as its stretch, as a convex corner of an outline does.
    fn is_outer(&self, turn: &Turn<3>) -> bool {
        let direction =
            |index: usize, end: usize| self.directions.get(index).map_or([0.0; 3], |ends| ends[end]);
        let own = turn_vector(&direction(turn.before, 1), &direction(turn.after, 0));
        (0..3).map(|d| own[d] * self.total[d]).sum::<f64>() > 0.0
    }
}

fn end_directions(curve: &PathCurve<f64, 3>) -> [[f64; 3]; 2] {
    let (begin, end) = curve.domain();
    [(0, begin), (usize::MAX, end)].map(|(span, u)| {
        let first = curve.derivatives_in(span, u).first;
        let speed = length(&first);
        first.map(|x| if speed > 0.0 { x / speed } else { 0.0 })
    })
}

/// The angle from one unit vector to another, along the axis of the turn.
fn turn_vector(from: &[f64; 3], to: &[f64; 3]) -> [f64; 3] {
    let axis = cross(from, to);
    let sine = length(&axis);
    let cosine: f64 = (0..3).map(|d| from[d] * to[d]).sum();
    axis.map(|x| if sine > 0.0 { x / sine * sine.atan2(cosine) } else { 0.0 })
}

fn cross(a: &[f64; 3], b: &[f64; 3]) -> [f64; 3] {
    [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]
}

#[cfg(test)]
mod tests {
    use super::*;
    use nurbs_core::CornerOutcome;

    fn styles(program: &str) -> Vec<Option<CornerStyle>> {
        let part = part_program::read_part("p.nc", program).unwrap();
        let smooth =
            SmoothStretch::new(&part.curves, 0.1, CornerLambda::default(), Some(CornerStyle::Loop)).unwrap();
        let style = |outcome| match outcome {
            CornerOutcome::Smoothed { style, .. } => Some(style),
            CornerOutcome::Left(_) => None,
        };
        smooth.path.corners.iter().map(|corner| style(corner.outcome)).collect()
    }

    #[test]
    fn outer_corners_are_the_convex_ones_of_an_outline_whichever_way_it_is_followed() {
        use CornerStyle::{Cut, Loop};
        // An L: the fourth of its corners points inward.
        let points = [[0, 0], [20, 0], [20, 10], [10, 10], [10, 20], [0, 20], [0, 0]];
        let program = |points: &mut dyn Iterator<Item = &[i32; 2]>| {
            points.map(|p| format!("G1 X{} Y{} F60\n", p[0], p[1])).collect::<String>()
        };
        assert_eq!(styles(&program(&mut points.iter())), [Loop, Loop, Cut, Loop, Loop].map(Some));
        assert_eq!(styles(&program(&mut points.iter().rev())), [Loop, Loop, Cut, Loop, Loop].map(Some));
        // A half circle decides the sense of the whole path, and the corner behind it turns the other way.
        assert_eq!(styles("G1 X0 Y0 F60\nX10\nG3 X10 Y10 J5\nG1 X5\nY20\n"), [None, None, Some(Cut)]);
    }

    /// A loop round a corner of 3° has a radius of 1/3300 of the tolerance. It was once made, and the plan almost
    /// stopped at it.
    #[test]
    fn shallow_outer_corners_are_cut() {
        use CornerStyle::{Cut, Loop};
        for (degrees, style) in [(3.0_f64, Cut), (29.9, Cut), (30.1, Loop), (90.0, Loop)] {
            let [sine, cosine] = [degrees.to_radians().sin(), degrees.to_radians().cos()].map(|x| 20.0 * x);
            let program = format!("G1 X-20 Y0 F60\nX0\nX{cosine:.9} Y{sine:.9}\n");
            assert_eq!(styles(&program).last(), Some(&Some(style)), "{degrees}");
        }
    }
}
