//! Siemens' B-splines: BSPLINE with SD=, PW= and PL=.
//!
//! `BSPLINE` opens a curve whose first control point is the current position; each block with coordinates adds one,
//! of weight `PW=` (1 where it is not written). A first block that repeats the current position is that first point,
//! and so can give it a weight. A weight of 0 lets its point have no effect; it is the least that is read, with which
//! the curve is another by less than the share 1e-8 of the distance of this point. `SD=` is the degree (3 where it is not written); any other motion ends the curve.
//!
//! `PL=` in the block of point i is the knot interval `u_{p+i} - u_{p+i-1}`: with points 0 … n the blocks 1 … n-p+1
//! hold the n-p+1 intervals, and the last p - 1 blocks 0 or nothing. Without any PL= the control spaces the knots by a
//! rule that its manual does not give; they are taken as uniform, with a warning.
//!
//! # Source
//! SINUMERIK 840D sl / 828D, Programming Manual Job Planning, "Spline interpolation". The manual does not say which
//! block's PL= is which interval; this is the order in which CAM systems write them.

use domains::curve::WEIGHT;
use domains::shown;

use crate::curve::{Curve, MAX_DEGREE};
use crate::diagnostic::Report;
use crate::gcode::block::Block;
use crate::gcode::modal::Modal;
use crate::gcode::word::Key;
use crate::source::Span;
use crate::spline_blocks::{SplineBlocks, uniform_knots};

/// A curve that may have further blocks.
pub(crate) struct SiemensSpline {
    degree: usize,
    blocks: SplineBlocks,
    /// `PL=` of each point, where it is written.
    intervals: Vec<Option<(f64, Span)>>,
}

impl SiemensSpline {
    pub(crate) fn open(modal: &Modal, span: Span) -> Self {
        let mut blocks = SplineBlocks { start: span, ..SplineBlocks::default() };
        if modal.incremental || modal.position.iter().any(Option::is_some) {
            blocks.point(modal.here(), 1.0, span);
        }
        let intervals = vec![None; blocks.points.len()];
        Self { degree: 3, blocks, intervals }
    }

    /// Reads a block with or without coordinates.
    pub(crate) fn block(&mut self, report: &mut Report<'_>, modal: &mut Modal, block: &mut Block<'_>) {
        if let Some(word) = block.take(Key::SplineDegree) {
            #[allow(clippy::cast_precision_loss, reason = "at most MAX_DEGREE")]
            match (1..=MAX_DEGREE).find(|degree| *degree as f64 == word.value) {
                Some(degree) => self.degree = degree,
                None => {
                    let message = format!("degree {} is not supported", shown(word.value));
                    report
                        .error(word.span, message)
                        .expected(format!("SD=2 or SD=3, here up to SD={MAX_DEGREE}"));
                }
            }
        }
        let weight = block.take(Key::PointWeight);
        let interval = block.take(Key::IntervalLength).map(|word| (word.value, word.span));
        if let Some((length, span)) = interval.filter(|(length, _)| *length < 0.0) {
            report
                .error(span, format!("the knot interval is {}", shown(length)))
                .expected("PL= of at least 0");
        }
        if !block.has_axis() {
            if let Some(word) = weight {
                report
                    .error(word.span, "a weight without a control point")
                    .expected("coordinates in the same block");
            }
            return;
        }
        let weight = weight.map_or(1.0, |word| if word.value == 0.0 { WEIGHT.least() } else { word.value });
        let here = modal.here();
        let written = block.take_axes();
        let point = modal.target(here, written);
        let repeats_start = self.blocks.points.len() == 1 && point == here;
        if repeats_start {
            self.blocks.weights[0] = (weight, block.span);
            self.intervals[0] = interval;
        } else {
            self.blocks.point(point, weight, block.span);
            self.intervals.push(interval);
        }
        modal.arrive(written, point);
    }

    /// The curve, if it obeys every rule.
    pub(crate) fn finish(mut self, report: &mut Report<'_>) -> Option<Curve> {
        let (points, degree) = (self.blocks.points.len(), self.degree);
        let start = self.blocks.start;
        if points <= degree {
            report
                .error(start, format!("too few control points: {points}"))
                .expected(format!("at least degree + 1 = {} with the start", degree + 1));
            return None;
        }
        if self.intervals.iter().all(Option::is_none) {
            report
                .warning(start, "a BSPLINE without PL=: its knots are taken as uniform")
                .hint("write PL= in each block to say the knot intervals");
            self.blocks.knots = uniform_knots(points, degree).map(|knot| (knot, start)).collect();
            return self.blocks.finish(degree, report, |_| None);
        }
        let mut knots = vec![(0.0, start); degree + 1];
        let mut knot = 0.0;
        for (index, interval) in self.intervals.iter().enumerate() {
            let inside = (1..=points - degree).contains(&index);
            let (length, span) = match interval {
                Some(interval) => *interval,
                None if inside => {
                    let span = self.blocks.points[index].1;
                    report.error(span, "a block of BSPLINE without a knot interval").expected("a word PL=");
                    continue;
                }
                None => continue,
            };
            if inside {
                knot += length;
                knots.push((knot, span));
            } else if length != 0.0 {
                let message = format!("a knot interval of {} too many", shown(length));
                report.error(span, message).expected(format!(
                    "PL=0 at the start and in the last degree - 1 = {} blocks",
                    degree - 1
                ));
            }
        }
        knots.extend(vec![(knot, start); degree]);
        self.blocks.knots = knots;
        if report.has_errors() { None } else { self.blocks.finish(degree, report, |_| None) }
    }
}
