//! A part with coordinates of a few decimals, as a control accepts them.
//!
//! A point of a curve, `C(u) = Σ N_i(u) w_i P_i / Σ N_i(u) w_i`, is a mean of control points: the factors are not negative and
//! sum to 1. With the same knots and weights it moves by no more than the control point that moves farthest.
//!
//! Points that are equal to the last bit are equal after rounding: curves that join stay joined.

use std::fmt;

use crate::curve::Curve;
use crate::moves::MoveKind;
use crate::part::Part;
use crate::vector::{angle, difference, length};

/// A part with rounded coordinates.
#[derive(Clone, Debug, PartialEq)]
pub struct Rounded {
    /// The part, without the moves that have no length once rounded.
    pub part: Part,
    /// Largest distance between a point of the part and the same point once rounded, in mm; no point of a curve, at its
    /// parameter, moves farther.
    pub moved_mm: f64,
    /// Largest angle between the directions of a straight move at feed before and once rounded, in degrees, 0 to 180.
    pub turned_deg: f64,
    /// Moves that are left out.
    pub left_out: usize,
}

/// A curve that would stand still over a knot span once its points are rounded.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct StandsStill {
    /// Line of its move.
    pub line: usize,
    /// The first of the degree + 1 control points that become one, from 0.
    pub first: usize,
    /// The last of them.
    pub last: usize,
    /// The decimals that the coordinates would have.
    pub decimals: usize,
}

impl fmt::Display for StandsStill {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self { line, first, last, decimals } = self;
        write!(
            f,
            "the curve of line {line} would stand still with {decimals} decimals: its control points {first} to {last} round to one"
        )
    }
}

impl std::error::Error for StandsStill {}

impl Part {
    /// The part with every coordinate, in mm, rounded to the nearest number of so many decimals. Knots, weights and feedrates
    /// are kept bit by bit.
    ///
    /// Moves whose points all become one are left out. The exact stop of such a move goes to the move at feed before
    /// it.
    #[must_use]
    pub fn rounded(&self, decimals: usize) -> Rounded {
        let mut part = Self { curves: Vec::new(), moves: Vec::new(), ..self.clone() };
        let (mut moved_mm, mut turned_deg) = (0.0_f64, 0.0_f64);
        for (curve, one) in self.curves.iter().zip(&self.moves) {
            let rounded = curve.rounded(decimals);
            for (from, to) in curve.control_points_mm().iter().zip(rounded.control_points_mm()) {
                moved_mm = moved_mm.max(length(difference(to, from)));
            }
            if !are_one(rounded.control_points_mm()) {
                if one.kind == MoveKind::Feed && curve.control_points_mm().len() == 2 {
                    let [before, after] = [curve, &rounded].map(Curve::chord);
                    turned_deg = turned_deg.max(angle(before, after).to_degrees());
                }
                part.curves.push(rounded);
                part.moves.push(*one);
            } else if let Some(before) = part.moves.last_mut() {
                before.exact_stop |= one.exact_stop && before.kind == MoveKind::Feed;
            }
        }
        let left_out = self.curves.len() - part.curves.len();
        Rounded { part, moved_mm, turned_deg, left_out }
    }

    /// Searches for curves at feed that [`rounded`](Self::rounded) would let stand still over a knot span: degree + 1
    /// successive control points that differ now become one. Straight moves without a length are left out and do not
    /// count.
    ///
    /// # Errors
    /// [`StandsStill`], for the first of them.
    pub fn keeps_moving_rounded(&self, decimals: usize) -> Result<(), StandsStill> {
        for (curve, one) in self.curves.iter().zip(&self.moves) {
            let is_spline = one.kind == MoveKind::Feed && curve.control_points_mm().len() > 2;
            let still = is_spline.then(|| curve.stands_still_rounded(decimals)).flatten();
            if let Some(first) = still {
                return Err(StandsStill { line: one.line, first, last: first + curve.degree(), decimals });
            }
        }
        Ok(())
    }
}

impl Curve {
    fn rounded(&self, decimals: usize) -> Self {
        let mut curve = self.clone();
        curve.move_points(|point| *point = point.map(|x| rounded(x, decimals)));
        curve
    }

    /// From the first control point to the last.
    fn chord(&self) -> [f64; 3] {
        let points = self.control_points_mm();
        difference(&points[points.len() - 1], &points[0])
    }

    /// The first control point of a knot span over which the curve moves now, but not after rounding.
    fn stands_still_rounded(&self, decimals: usize) -> Option<usize> {
        let rounded = self.rounded(decimals);
        (self.degree()..self.control_points_mm().len()).map(|span| span - self.degree()).find(|&first| {
            let (last, points) = (first + self.degree(), first..=first + self.degree());
            self.knots()[last] < self.knots()[last + 1]
                && are_one(&rounded.control_points_mm()[points.clone()])
                && !are_one(&self.control_points_mm()[points])
        })
    }
}

fn are_one(points: &[[f64; 3]]) -> bool {
    points.windows(2).all(|pair| pair[0] == pair[1])
}

/// The number nearest to a decimal of so many places. It is found through the decimal: scaling by a power of ten would
/// round twice.
pub(crate) fn rounded(x: f64, decimals: usize) -> f64 {
    // No negative zero. What was written as a number reads as one.
    format!("{x:.decimals$}").parse().unwrap_or(x) + 0.0
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::read_part;

    fn part(text: &str) -> Part {
        read_part("p.nc", text).unwrap_or_else(|errors| panic!("{errors}\n{text}"))
    }

    #[test]
    fn numbers_have_no_more_decimals_than_asked() {
        for (x, decimals, expected) in [
            (0.1234567, 3, "0.123"),
            (-0.0004, 3, "0"),
            (1e7 - 1e-9, 3, "10000000"),
            (0.1 + 0.2, 15, "0.3"),
            (2.5, 0, "2"),
            (9_876_543.210_987_654, 9, "9876543.210987654"),
        ] {
            assert_eq!(rounded(x, decimals).to_string(), expected);
        }
    }

    /// (0.3, 0.4, 0) µm to (0, 0, 0): 0.5 µm.
    #[test]
    fn what_moves_farthest_is_stated() {
        let rounded = part("G0 X0 Y0\nG1 X1.0003 Y2.0004 F60\nX5.0001\n").rounded(3);
        assert!((rounded.moved_mm - 5e-4).abs() < 1e-12, "{}", rounded.moved_mm);
        assert_eq!(rounded.part.curves[0].control_points_mm()[1], [1.0, 2.0, 0.0]);
        assert_eq!(rounded.left_out, 0);
    }

    /// From (1, 0.4) units to (1, 0): atan 0.4. The rapid move and the arc are not judged.
    #[test]
    fn the_sharpest_turn_of_a_straight_move_is_stated() {
        let text = "G0 X0 Y0\nG1 X0.001 Y0.0004 F60\nG1 X100\nG0 X100.001 Y0.0008\nG3 X100 Y0 I-1\n";
        let turned_deg = part(text).rounded(3).turned_deg;
        assert!((turned_deg - 0.4_f64.atan().to_degrees()).abs() < 1e-9, "{turned_deg}");
        assert_eq!(part(text).rounded(4).turned_deg, 0.0);
    }

    #[test]
    fn a_move_of_no_length_is_left_out_and_its_stop_is_not() {
        let before = part("G0 X0 Y0\nG1 X1 F60\nG9 X1.0002\nX2\nG0 X2.0003\n");
        let rounded = before.rounded(3);
        assert_eq!(rounded.left_out, 2);
        let kept: Vec<_> = rounded.part.moves.iter().map(|one| (one.line, one.exact_stop)).collect();
        assert_eq!(kept, [(2, true), (4, false)]);
        assert_eq!(rounded.part.curves[1].control_points_mm(), [[1.0, 0.0, 0.0], [2.0, 0.0, 0.0]]);
        assert_eq!(before.keeps_moving_rounded(3), Ok(()), "straight moves");
    }

    #[test]
    fn a_curve_that_would_stand_still_is_named() {
        // Inner points 2 to 4 of a quadratic, and a circle that is one point.
        let spline = "G0 X0 Y0\nG06.2 P3 K0 X0 Y0\nK0 X1\nK0 X2\nK1 X2.0002\nK2 X2.0003\nK3 X4\nK4\nK4\nK4\n";
        let refused = |text: &str, decimals| part(text).keeps_moving_rounded(decimals);
        assert_eq!(refused(spline, 3), Err(StandsStill { line: 2, first: 2, last: 4, decimals: 3 }));
        assert_eq!(refused(spline, 4), Ok(()));
        let circle = "G0 X0 Y0\nG1 X5 F60\nG3 X5 Y0 I0.0002\n";
        let refused = refused(circle, 3).unwrap_err().to_string();
        assert!(refused.starts_with("the curve of line 3 would stand still with 3 decimals"), "{refused}");
        // A curve that already stands still there may do so.
        let still = spline.replace("X2.0002", "X2").replace("X2.0003", "X2");
        assert_eq!(part(&still).keeps_moving_rounded(3), Ok(()));
    }
}
