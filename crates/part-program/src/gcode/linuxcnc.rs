//! LinuxCNC's splines: NURBS between G5.2 and G5.3, cubic G5, quadratic G5.1. All lie in the plane in force: X and Y in G17, X and Z
//! (with I and K) in G18, Y and Z (with J and K) in G19.
//!
//! `G5.2 X<> Y<> P<weight> L<order>` opens a curve whose first control point is the current position, of weight 1 (or of
//! the weight P of a first block without X and Y); each block adds a point, and needs its P; G5.3 ends it. L is 3
//! unless it is written; L below 3 is taken as 3. There is no word for knots: they are `0 …, 1, 2, …, m …`, each end
//! `order` times.
//!
//! `G5 X<> Y<> I<> J<> P<> Q<>`: a Bézier cubic, (I, J) from the start to the first inner point and (P, Q) from the end
//! to the second; without I and J it goes on smoothly from the G5 before it. `G5.1 X<> Y<> I<> J<>`: a Bézier quadratic.
//!
//! # Source
//! LinuxCNC's interpreter (`convert_nurbs`, `convert_spline`, `knot_vector_creator`), whose behaviour this follows.

use domains::shown;

use crate::arc::Plane;
use crate::curve::{Curve, MAX_DEGREE};
use crate::diagnostic::Report;
use crate::gcode::block::Block;
use crate::gcode::modal::Modal;
use crate::source::Span;
use crate::spline_blocks::{SplineBlocks, uniform_knots};

/// The smallest order that LinuxCNC makes.
pub(crate) const LEAST_ORDER: usize = 3;

/// A curve that may have further blocks.
pub(crate) struct LinuxCncNurbs {
    order: usize,
    /// The axes of its plane.
    axes: [usize; 2],
    blocks: SplineBlocks,
}

/// The axes of a plane, in the order in which a spline names them.
pub(crate) fn axes_of(plane: Plane) -> [usize; 2] {
    match plane {
        Plane::Xy => [0, 1],
        Plane::Zx => [0, 2],
        Plane::Yz => [1, 2],
    }
}

impl LinuxCncNurbs {
    pub(crate) fn open(plane: Plane, span: Span) -> Self {
        Self {
            order: LEAST_ORDER,
            axes: axes_of(plane),
            blocks: SplineBlocks { start: span, ..SplineBlocks::default() },
        }
    }

    /// Reads a block of G5.2.
    pub(crate) fn block(&mut self, report: &mut Report<'_>, modal: &mut Modal, block: &mut Block<'_>) {
        if let Some(word) = block.take_letter(b'L') {
            #[allow(clippy::cast_precision_loss, reason = "at most MAX_DEGREE + 1")]
            let order = (1..=MAX_DEGREE + 1).find(|order| *order as f64 == word.value);
            match order {
                Some(order) => self.order = order.max(LEAST_ORDER),
                None => {
                    let message = format!("order {} is not supported", shown(word.value));
                    report
                        .error(word.span, message)
                        .expected(format!("L3 to L{}, degree + 1", MAX_DEGREE + 1));
                }
            }
        }
        let [x, y] = self.axes.map(|axis| block.has(b"XYZ"[axis]));
        let weight = block.take_letter(b'P');
        if x != y {
            report
                .error(block.span, "a control point of G5.2 with one coordinate")
                .expected("both axes of its plane");
        }
        if self.blocks.points.is_empty() {
            let first = weight.filter(|_| !x && !y).map_or(1.0, |word| word.value);
            self.blocks.point(modal.here(), first, block.span);
            if !x && !y {
                return;
            }
        }
        if !x && !y {
            if let Some(word) = weight {
                report
                    .error(word.span, "a weight without a control point")
                    .expected("the coordinates before P");
            }
            return;
        }
        let written = block.take_axes();
        let target = modal.target(modal.here(), written);
        if weight.is_none() {
            report.error(block.span, "a control point of G5.2 without a weight").expected("a word P, as P1");
        }
        self.blocks.point(target, weight.map_or(1.0, |word| word.value), block.span);
        modal.arrive(written, target);
    }

    /// The curve, if it obeys every rule.
    pub(crate) fn finish(mut self, report: &mut Report<'_>) -> Option<Curve> {
        let degree = self.order - 1;
        let start = self.blocks.start;
        self.blocks.knots =
            uniform_knots(self.blocks.points.len(), degree).map(|knot| (knot, start)).collect();
        self.blocks.finish(degree, report, |_| None)
    }
}

/// A Bézier curve as programmed, with the inner point that a smooth continuation needs.
pub(crate) fn bezier(
    report: &mut Report<'_>,
    modal: &mut Modal,
    block: &mut Block<'_>,
    cubic: bool,
    smooth: Option<[f64; 2]>,
) -> Option<(Curve, Option<[f64; 2]>)> {
    let span = block.span;
    let pair = |block: &mut Block<'_>, first: u8, second: u8| match (
        block.take_letter(first),
        block.take_letter(second),
    ) {
        (Some(a), Some(b)) => Ok(Some([modal.mm(a.value), modal.mm(b.value)])),
        (None, None) => Ok(None),
        _ => Err(format!("{} without {}", char::from(first), char::from(second))),
    };
    let (name, inner) = if cubic { ("G5", pair(block, b'P', b'Q')) } else { ("G5.1", Ok(None)) };
    let axes = axes_of(modal.plane);
    let [first, second] = axes.map(|axis| b"IJK"[axis]);
    let outer = pair(block, first, second);
    let [first, second] = [first, second].map(char::from);
    let (outer, inner) = match (outer, inner) {
        (Ok(outer), Ok(inner)) => (outer, inner),
        (Err(message), _) | (_, Err(message)) => {
            report.error(span, message).expected(format!("both words of a pair in {name}"));
            return None;
        }
    };
    let Some(outer) = outer.or(smooth.filter(|_| cubic)) else {
        report
            .error(span, format!("{name} without {first} and {second}"))
            .expected(format!("{first} and {second}: from the start to the next control point"));
        return None;
    };
    if cubic && inner.is_none() {
        report
            .error(span, "G5 without P and Q")
            .expected("P and Q: from the end to the control point before it");
        return None;
    }
    let written = block.take_axes();
    let end = modal.target(modal.here(), written);
    let start = modal.start(end);
    modal.arrive(written, end);
    let beside = |point: [f64; 3], along: [f64; 2]| {
        let mut offset = [0.0; 3];
        (offset[axes[0]], offset[axes[1]]) = (along[0], along[1]);
        let offset = modal.turned(offset);
        std::array::from_fn(|axis| point[axis] + offset[axis])
    };
    let mut blocks = SplineBlocks { start: span, ..SplineBlocks::default() };
    blocks.point(start, 1.0, span);
    blocks.point(beside(start, outer), 1.0, span);
    if let Some(inner) = inner {
        blocks.point(beside(end, inner), 1.0, span);
    }
    blocks.point(end, 1.0, span);
    let degree = blocks.points.len() - 1;
    blocks.knots = uniform_knots(degree + 1, degree).map(|knot| (knot, span)).collect();
    let curve = blocks.finish(degree, report, |_| None)?;
    Some((curve, inner.map(|inner| [-inner[0], -inner[1]])))
}
