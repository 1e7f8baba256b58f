//! Splines of a part program, each over one or more blocks.

use crate::curve::Curve;
use crate::gcode::block::Block;
use crate::gcode::block_place::BlockPlace;
use crate::gcode::fanuc::FanucNurbs;
use crate::gcode::linuxcnc::{self, LinuxCncNurbs, axes_of};
use crate::gcode::modal::{FeedMode, Motion};
use crate::gcode::reader::Reader;
use crate::gcode::siemens::SiemensSpline;
use crate::gcode::spline::Spline;
use crate::moves::{MoveKind, Shape};
use crate::source::Span;

impl Reader<'_, '_, '_> {
    /// Splines have no feed by time: their length is not known while they are read.
    fn spline_allowed(&mut self, span: Span) -> Option<()> {
        if self.modal.feed_mode == FeedMode::InverseTime {
            self.report
                .error(span, "PS1006: a spline in inverse time feed, G93")
                .expected("G94 before the spline");
            return None;
        }
        Some(())
    }

    pub(crate) fn spline_block(&mut self, block: &mut Block<'_>, is_new: bool) {
        if is_new && self.spline_allowed(block.span).is_none() {
            self.break_off(block);
            return;
        }
        if self.modal.motion == Motion::LinuxCncNurbs && !self.is_planar(block, "G5.2") {
            let [_, _, normal] = self.modal.plane.axes();
            block.take_letter(b"XYZ"[normal]);
        }
        if self.spline.is_none() {
            let spline = match self.modal.motion {
                Motion::FanucNurbs => FanucNurbs::open(self.report, block).map(Spline::Fanuc),
                Motion::LinuxCncNurbs => self
                    .start_is_known(self.modal.plane, block.span)
                    .then(|| Spline::LinuxCnc(LinuxCncNurbs::open(self.modal.plane, block.span))),
                _ => Some(Spline::Siemens(SiemensSpline::open(&self.modal, block.span))),
            };
            let Some(spline) = spline else {
                self.break_off(block);
                return;
            };
            self.spline = Some((spline, self.place(block.span)));
        }
        if let Some((Spline::Fanuc(nurbs), _)) = &self.spline
            && nurbs.is_complete()
        {
            if !block.has_axis() {
                self.report
                    .error(block.span, "a knot after the closing knots")
                    .expected("as many blocks with a K alone as the order");
                block.clear();
                return;
            }
            let next = nurbs.next(block.span);
            self.close(block.span);
            self.spline = Some((Spline::Fanuc(next), self.place(block.span)));
        }
        match &mut self.spline {
            Some((Spline::Fanuc(nurbs), _)) => nurbs.block(self.report, &mut self.modal, block),
            Some((Spline::LinuxCnc(nurbs), _)) => nurbs.block(self.report, &mut self.modal, block),
            Some((Spline::Siemens(spline), _)) => spline.block(self.report, &mut self.modal, block),
            None => {}
        }
    }

    /// Skips a spline whose first block is wrong.
    fn break_off(&mut self, block: &mut Block<'_>) {
        self.modal.motion = Motion::Broken;
        self.pass_over(block);
    }

    /// Ends the spline that is open, if one is; `after` is the word that ends it.
    pub(crate) fn close(&mut self, after: Span) {
        let Some((spline, start)) = self.spline.take() else { return };
        let curve = match spline {
            Spline::Fanuc(nurbs) => nurbs.finish(self.report, after),
            Spline::Siemens(spline) => spline.finish(self.report),
            Spline::LinuxCnc(_) => {
                self.report.error(after, "the curve of G5.2 is not ended").expected("G5.3 before this");
                None
            }
        };
        self.push_spline(curve, start);
    }

    fn push_spline(&mut self, curve: Option<Curve>, start: BlockPlace) {
        if let Some(curve) = curve {
            self.push(curve, MoveKind::Feed, Shape::Nurbs, self.modal.feedrate_mm_per_s, start);
        }
    }

    /// Reports that a spline of LinuxCNC leaves its plane.
    fn is_planar(&mut self, block: &Block<'_>, name: &str) -> bool {
        let [_, _, normal] = self.modal.plane.axes();
        let leaves = block.has(b"XYZ"[normal]);
        if leaves {
            let [first, second] = axes_of(self.modal.plane).map(|axis| char::from(b"XYZ"[axis]));
            let message = format!("{name} with {}", char::from(b"XYZ"[normal]));
            self.report
                .error(block.span, message)
                .expected(format!("{first} and {second} only: this spline is planar"))
                .hint("G17, G18 and G19 choose the plane");
        }
        !leaves
    }

    /// A Bézier curve of G5 or G5.1, in a single block.
    pub(crate) fn bezier(&mut self, block: &mut Block<'_>, continues: Option<[f64; 2]>) {
        let (span, is_cubic) = (block.span, self.modal.motion == Motion::Cubic);
        let name = if is_cubic { "G5" } else { "G5.1" };
        let is_allowed = self.spline_allowed(span).is_some()
            && self.is_planar(block, name)
            && self.start_is_known(self.modal.plane, span);
        let read = is_allowed
            .then(|| linuxcnc::bezier(self.report, &mut self.modal, block, is_cubic, continues))
            .flatten();
        let Some((curve, smooth)) = read else {
            // A block that continues this one smoothly has no fault of its own.
            self.smooth = is_cubic.then_some([0.0; 2]);
            self.pass_over(block);
            return;
        };
        self.smooth = smooth;
        self.push_spline(Some(curve), self.place(span));
    }

    pub(crate) fn end_of_linuxcnc_nurbs(&mut self, span: Span) {
        if let Some((Spline::LinuxCnc(nurbs), start)) = self.spline.take() {
            let curve = nurbs.finish(self.report);
            self.push_spline(curve, start);
        } else if self.modal.motion != Motion::Broken {
            self.report.error(span, "G5.3 without G5.2").expected("a curve that G5.2 opened");
        }
        self.modal.motion = Motion::None;
    }
}
