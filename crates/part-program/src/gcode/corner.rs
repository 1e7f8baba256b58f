//! Corners that a program has rounded or cut off: `,R` and `,C` of FANUC, `RND=`, `CHR=` and `CHF=` of Siemens.
//!
//! The word stands in the block of a straight move and changes the corner to the next move. `,R` puts an arc of this
//! radius between the two moves, `,C` a straight line that begins and ends at this distance from the corner, `CHF=` one of this length.
//!
//! # Source
//! FANUC Series 30i, B-63944EN/03, section 4.12 ("optional angle chamfering and corner rounding"); SINUMERIK 840D sl, Programming
//! Manual Fundamentals, "Chamfer, rounding".

use crate::curve::{Curve, Nurbs};
use crate::diagnostic::Report;
use crate::gcode::block::Block;
use crate::gcode::modal::Modal;
use crate::gcode::word::Key;
use crate::joint;
use crate::moves::{Move, MoveKind, Shape};
use crate::part::Part;
use crate::source::Span;
use crate::vector::{difference, dot};

/// The change of the corner at the end of the last move.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Corner {
    size_mm: f64,
    kind: Kind,
    span: Span,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Kind {
    /// An arc of this radius.
    Round,
    /// A line that begins and ends at this distance from the corner.
    Distance,
    /// A line of this length.
    Chamfer,
}

impl Corner {
    /// Takes the word of a corner from the block of a straight move.
    pub(crate) fn take(report: &mut Report<'_>, modal: &Modal, block: &mut Block<'_>) -> Option<Self> {
        const WORDS: [(Key, Kind); 3] = [
            (Key::CornerRadius, Kind::Round),
            (Key::CornerDistance, Kind::Distance),
            (Key::Chamfer, Kind::Chamfer),
        ];
        let (word, kind) = WORDS.into_iter().find_map(|(key, kind)| Some((block.take(key)?, kind)))?;
        if word.value <= 0.0 {
            let text = report.source.slice(word.span).to_owned();
            report.error(word.span, format!("`{text}`: a corner of no size")).expected("a length above 0");
            return None;
        }
        Some(Self { size_mm: modal.mm(word.value), kind, span: word.span })
    }

    /// Reports a word of a corner at the end of the program, where no move follows.
    pub(crate) fn say_unmet(self, report: &mut Report<'_>) {
        report.error(self.span, "no move follows this corner").expected("a straight move behind it");
    }

    /// The move between the last one and `next`, both of which are shortened. It is an error if it does not fit.
    pub(crate) fn turn(
        self,
        report: &mut Report<'_>,
        part: &mut Part,
        next: &mut Curve,
        next_shape: Shape,
    ) -> Option<(Curve, Move)> {
        let (Some(last), Some(before)) = (part.moves.last().copied(), part.curves.last_mut()) else {
            return None;
        };
        let are_lines = last.shape == Shape::Line && next_shape == Shape::Line && last.kind == MoveKind::Feed;
        let (Some(&[from, at]), Some(&[start, to])) = (
            before.control_points_mm().first_chunk::<2>().filter(|_| are_lines),
            next.control_points_mm().first_chunk::<2>().filter(|_| are_lines),
        ) else {
            report
                .error(self.span, "a corner between moves that are not both straight")
                .expected("G1 before and behind it");
            return None;
        };
        if !joint::is_joined(&at, &start) {
            return None;
        }
        let (back, back_length) = direction(at, from);
        let (on, on_length) = direction(at, to);
        let cos_between = dot(back, on);
        // Half of the angle by which the path turns; its tangent tells where an arc of radius 1 begins.
        let turn = (std::f64::consts::PI - cos_between.clamp(-1.0, 1.0).acos()) / 2.0;
        let reach = match self.kind {
            Kind::Round => self.size_mm * turn.tan(),
            Kind::Distance => self.size_mm,
            Kind::Chamfer => self.size_mm / 2.0 / turn.cos(),
        };
        if !(reach < back_length && reach < on_length) {
            report
                .error(
                    self.span,
                    format!(
                        "this corner takes {reach:.4} mm of moves of {back_length:.4} and {on_length:.4} mm"
                    ),
                )
                .expected("moves that are longer");
            return None;
        }
        if reach < 1e-9 {
            return None;
        }
        let [begin, end] = [back, on].map(|way| std::array::from_fn(|axis| at[axis] + reach * way[axis]));
        before.control_points_mm_mut()[1] = begin;
        next.control_points_mm_mut()[0] = end;
        let (curve, shape) = if self.kind == Kind::Round {
            (arc([begin, at, end], turn.cos()), Shape::Arc)
        } else {
            (Curve::line(begin, end), Shape::Line)
        };
        Some((curve, Move { shape, exact_stop: false, ..last }))
    }
}

/// The unit vector from one place to another, and their distance.
fn direction(from: [f64; 3], to: [f64; 3]) -> ([f64; 3], f64) {
    let way = difference(&to, &from);
    let length = dot(way, way).sqrt();
    (way.map(|x| x / length), length)
}

/// The arc that touches two lines at its ends, as its control points and the cosine of half its angle.
fn arc(points: [[f64; 3]; 3], middle_weight: f64) -> Curve {
    let control_points_mm = points.to_vec();
    let dimension = Nurbs::dimension_of(&control_points_mm);
    let knots = vec![0.0, 0.0, 0.0, 1.0, 1.0, 1.0];
    Nurbs { degree: 2, control_points_mm, dimension, weights: vec![1.0, middle_weight, 1.0], knots }.into()
}
