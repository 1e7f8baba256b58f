//! FANUC's NURBS, G06.2.
//!
//! `G06.2 P<order> K<knot> X<> Y<> Z<> R<weight> F<feed>` opens a curve, one control point a block; after the last point
//! come `order` blocks with a K alone. P is 4 and R is 1 where they are not written; a coordinate that is not written
//! keeps its value. The first control point is the current position, and its block may have neither it nor a knot, which is then
//! that of the second block. `G05 P10000` and `G05 P0` switch high-precision
//! contouring on and off.
//!
//! LinuxCNC 2.10 reads the same blocks. It also reads G6.2 before the knots that close the curve, and Q, which selects
//! how its own interpolator follows the curve and does not belong to the curve.
//!
//! # Source
//! FANUC Series 15i, B-63324EN/03, section 4.17 for the alarms PS1002 to PS1009, whose names head the messages here.

use domains::shown;

use crate::curve::{Curve, MAX_DEGREE};
use crate::curve_fault::CurveFault;
use crate::diagnostic::Report;
use crate::gcode::block::Block;
use crate::gcode::modal::Modal;
use crate::gcode::word::Word;
use crate::source::Span;
use crate::spline_blocks::SplineBlocks;

/// The first control point may be this far from the position, in mm: sums of incremental moves lose as much.
const POSITION_TOLERANCE_MM: f64 = 1e-6;

/// A curve that may have further blocks.
pub(crate) struct FanucNurbs {
    order: usize,
    blocks: SplineBlocks,
    /// Whether the first block has no knot: it is that of the second.
    lacks_first_knot: bool,
}

impl FanucNurbs {
    fn empty(order: usize, start: Span) -> Self {
        Self { order, blocks: SplineBlocks { start, ..SplineBlocks::default() }, lacks_first_knot: false }
    }

    /// Opens a curve; the block still holds its K, X, Y, Z and R.
    pub(crate) fn open(report: &mut Report<'_>, block: &mut Block<'_>) -> Option<Self> {
        let order = match block.take_letter(b'P') {
            None => 4,
            Some(word) => order(report, word)?,
        };
        block.take_letter(b'Q');
        Some(Self::empty(order, block.span))
    }

    /// Whether the curve has all its closing knots.
    pub(crate) fn is_complete(&self) -> bool {
        self.blocks.knots.len() >= self.blocks.points.len() + self.order
    }

    /// Whether a block with G6.2 continues the curve: it has a knot alone, and the curve lacks closing knots.
    pub(crate) fn goes_on_with(&self, block: &Block<'_>) -> bool {
        block.has(b'K') && !block.has(b'P') && !block.has(b'R') && !block.has_axis() && !self.is_complete()
    }

    /// The curve that follows a complete one if there is no new G06.2.
    pub(crate) fn next(&self, span: Span) -> Self {
        Self::empty(self.order, span)
    }

    /// Reads a block: a control point with its knot, or a knot alone.
    pub(crate) fn block(&mut self, report: &mut Report<'_>, modal: &mut Modal, block: &mut Block<'_>) {
        let is_point = block.has_axis() || block.has(b'R') || self.blocks.points.is_empty();
        match block.take_letter(b'K') {
            Some(knot) => {
                if std::mem::take(&mut self.lacks_first_knot) {
                    self.blocks.knots = vec![(knot.value, knot.span)];
                }
                self.blocks.knots.push((knot.value, knot.span));
            }
            None if self.blocks.points.is_empty() => {
                self.lacks_first_knot = true;
                self.blocks.knots.push((0.0, block.span));
            }
            None => {
                report
                    .error(block.span, "PS1002: a block of G06.2 without a knot")
                    .expected("a word K")
                    .hint("every control point has a knot, and order blocks with a K alone close the curve");
                // The value is unknown. The value before it keeps the other rules from reporting errors.
                let last = self.blocks.knots.last().map_or(0.0, |(knot, _)| *knot);
                self.blocks.knots.push((last, block.span));
            }
        }
        if !is_point {
            return;
        }
        let (points, knots) = (self.blocks.points.len(), self.blocks.knots.len());
        if knots > points + 1 {
            report
                .error(block.span, "PS1004: a control point after closing knots")
                .expected(format!("{} blocks with a K alone to close the curve", self.order));
        }
        let weight = block.take_letter(b'R').map_or(1.0, |word| word.value);
        let written = block.take_axes();
        let from = modal.here();
        let point = modal.target(from, written);
        let off = |axis: usize| {
            modal.position[axis].is_some_and(|known| (known - point[axis]).abs() > POSITION_TOLERANCE_MM)
        };
        if points == 0 && (0..3).any(off) {
            report
                .error(block.span, "PS1009: the first control point is off the current position")
                .expected(format!("X{} Y{} Z{}", from[0], from[1], from[2]))
                .hint("move to the first control point before G06.2");
        }
        self.blocks.point(point, weight, block.span);
        modal.arrive(written, point);
    }

    /// The curve, if it obeys every rule.
    pub(crate) fn finish(self, report: &mut Report<'_>, after: Span) -> Option<Curve> {
        let (points, knots) = (self.blocks.points.len(), self.blocks.knots.len());
        let closing = knots.saturating_sub(points);
        if closing < self.order {
            let message = match closing {
                0 => "PS1005: the curve ends without closing knots".to_owned(),
                _ => format!("PS1004: the curve ends after {closing} closing knots"),
            };
            report
                .error(after, message)
                .expected(format!("{} blocks with a K alone before this one", self.order));
            return None;
        }
        let order = self.order;
        self.blocks.finish(order - 1, report, |fault| match fault {
            CurveFault::NotClamped { multiplicity, .. } if *multiplicity < order => {
                Some("PS1007 wrong multiple knots at the start or end")
            }
            CurveFault::NotClamped { .. } => Some("PS1008 a knot repeated more often than the order"),
            CurveFault::KnotRepeatsTooOften { multiplicity, .. } if *multiplicity > order => {
                Some("PS1008 a knot repeated more often than the order")
            }
            _ => None,
        })
    }
}

fn order(report: &mut Report<'_>, word: Word) -> Option<usize> {
    #[allow(clippy::cast_precision_loss, reason = "at most MAX_DEGREE + 1")]
    let order = (2..=MAX_DEGREE + 1).find(|order| *order as f64 == word.value);
    if order.is_none() {
        let message = format!("order {} is not supported", shown(word.value));
        report.error(word.span, message).expected(format!("P2 to P{}, degree + 1", MAX_DEGREE + 1));
    }
    order
}
