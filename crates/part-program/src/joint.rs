//! Joints between one curve and the next, and corners inside a curve.

use serde::{Serialize, Serializer};

use crate::curve::Curve;
use crate::moves::MoveKind;
use crate::part::Part;
use crate::vector::{angle, difference, length};

/// A gap between curves from which on a joint is listed, in mm.
pub const GAP_MM: f64 = 1e-6;
/// A change of direction from which on a joint is listed, in rad: a twentieth of a degree.
pub const TANGENT_BREAK_RAD: f64 = 1e-3;

/// A place where a path jumps or changes its direction suddenly.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Joint {
    /// Index of the curve that begins there, or that has the corner inside.
    pub curve: usize,
    /// Line of its block.
    pub line: usize,
    /// The knot at which the curve itself has a corner; `None` for the begin of the curve.
    pub knot: Option<f64>,
    /// The place at which the path goes on, in mm.
    pub point_mm: [f64; 3],
    /// Distance from the end of the one to the start of the other, in mm.
    pub gap_mm: f64,
    /// Change of direction, in rad, 0 to π; 0 where a rapid move begins or ends, and across a gap.
    pub tangent_break_rad: f64,
}

/// Whether two points are so near to each other that a path has no gap between them: a gap is above [`GAP_MM`].
#[must_use]
pub fn is_joined(end: &[f64; 3], start: &[f64; 3]) -> bool {
    length(difference(start, end)) <= GAP_MM
}

/// Every joint of a part with a gap above [`GAP_MM`] or a break above [`TANGENT_BREAK_RAD`], in the order of the path. A
/// program may have a corner at each of millions of moves, so they are found anew each time and not kept.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Joints<'p>(pub(crate) &'p Part);

impl<'p> Joints<'p> {
    /// The joints, one after the other.
    pub fn iter(&self) -> impl Iterator<Item = Joint> + use<'p> {
        let part = self.0;
        part.curves.iter().zip(&part.moves).enumerate().flat_map(move |(index, (curve, one))| {
            let of_move = move |joint| Joint { curve: index, line: one.line, ..joint };
            let before = index.checked_sub(1).and_then(|before| {
                let is_cut = [before, index].iter().all(|i| part.moves[*i].kind == MoveKind::Feed);
                between(&part.curves[before], curve, is_cut)
            });
            let inside = (one.kind == MoveKind::Feed).then(|| corners(curve));
            before.into_iter().chain(inside.into_iter().flatten()).map(of_move)
        })
    }
}

impl Serialize for Joints<'_> {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        serializer.collect_seq(self.iter())
    }
}

/// A smaller change of direction, in rad, is none for LinuxCNC's exact path.
const COLLINEAR_RAD: f64 = 1e-6;

/// Whether the path breaks between two curves: by a change of direction, or by a gap.
pub(crate) fn breaks(one: &Curve, next: &Curve) -> bool {
    let ends = one.control_points_mm().last().zip(next.control_points_mm().first());
    let is_joined = ends.is_some_and(|(end, start)| is_joined(end, start));
    let arriving = direction(one.control_points_mm().iter().rev());
    let turn = arriving.zip(direction(next.control_points_mm().iter()));
    !is_joined || turn.is_none_or(|(back, leaving)| angle(back.map(|x| -x), leaving) > COLLINEAR_RAD)
}

fn between(one: &Curve, next: &Curve, is_cut: bool) -> Option<Joint> {
    let (end, start) = (one.control_points_mm().last()?, next.control_points_mm().first()?);
    let gap_mm = length(difference(start, end));
    let is_joined = is_joined(end, start);
    let tangent_break_rad = if is_cut && is_joined {
        let arriving = direction(one.control_points_mm().iter().rev())?.map(|x| -x);
        angle(arriving, direction(next.control_points_mm().iter())?)
    } else {
        0.0
    };
    let listed = !is_joined || tangent_break_rad > TANGENT_BREAK_RAD;
    listed.then_some(Joint { curve: 0, line: 0, knot: None, point_mm: *start, gap_mm, tangent_break_rad })
}

/// The corners of one curve: at an inner knot of multiplicity degree the curve passes through a control point, from
/// the one before it to the one after it.
fn corners(curve: &Curve) -> impl Iterator<Item = Joint> + '_ {
    let points = curve.control_points_mm();
    let inner = curve.knots().get(curve.degree() + 1..points.len()).unwrap_or_default();
    let mut at = curve.degree();
    inner.chunk_by(|a, b| a == b).filter_map(move |equal| {
        let through = at;
        at += equal.len();
        if equal.len() < curve.degree() {
            return None;
        }
        let arriving = direction(points.get(..=through)?.iter().rev())?.map(|x| -x);
        let tangent_break_rad = angle(arriving, direction(points.get(through..)?.iter())?);
        (tangent_break_rad > TANGENT_BREAK_RAD).then_some(Joint {
            curve: 0,
            line: 0,
            knot: Some(equal[0]),
            point_mm: points[through],
            gap_mm: 0.0,
            tangent_break_rad,
        })
    })
}

/// From the first point to the first that differs: the direction in which a clamped curve leaves its end.
fn direction<'p>(mut points: impl Iterator<Item = &'p [f64; 3]>) -> Option<[f64; 3]> {
    let first = points.next()?;
    points.find(|point| *point != first).map(|next| difference(next, first))
}

#[cfg(test)]
mod tests {
    use std::f64::consts::{FRAC_PI_2, PI};

    use super::*;
    use crate::read_part;

    fn seen(text: &str) -> Vec<Joint> {
        Joints(&read_part("p.nc", text).unwrap()).iter().collect()
    }

    #[test]
    fn a_gap_is_measured_and_has_no_break() {
        let one = "[[curve]]\ndegree = 1\ncontrol_points_mm = [[0, 0, 0], [1, 0, 0]]\nknots = [0, 0, 1, 1]\n";
        let two = one.replace("[0, 0, 0], [1, 0, 0]", "[1, 3, 4], [1, 9, 4]");
        let joint = seen(&format!("{one}{two}"))[0];
        assert_eq!((joint.curve, joint.line, joint.gap_mm, joint.tangent_break_rad), (1, 5, 5.0, 0.0));
        assert_eq!(joint.point_mm, [1.0, 3.0, 4.0]);
    }

    #[test]
    fn a_corner_inside_a_spline_is_found_at_its_knot() {
        let spline = |middle: &str| {
            format!(
                "[curve]\ndegree = 2\ncontrol_points_mm = [[0, 0], [1, 0], [2, 0], {middle}, [4, 4]]\n\
                 knots = [0, 0, 0, 0.4, 0.4, 1, 1, 1]\n"
            )
        };
        let joints = seen(&spline("[2, 3]"));
        assert_eq!((joints.len(), joints[0].knot, joints[0].point_mm), (1, Some(0.4), [2.0, 0.0, 0.0]));
        assert!((joints[0].tangent_break_rad - FRAC_PI_2).abs() < 1e-15);
        assert_eq!(seen(&spline("[2.5, 0]")), [], "a double knot without a corner");
        assert!((seen(&spline("[1.5, 0]"))[0].tangent_break_rad - PI).abs() < 1e-15);
    }

    #[test]
    fn arcs_are_smooth_inside_and_rapid_moves_have_no_corners() {
        assert_eq!(seen("G0 X0 Y0\nG3 X0 Y0 I5 J0 F100\nG0 X10\nG0 Y10\nG1 Y20\n"), []);
    }
}
