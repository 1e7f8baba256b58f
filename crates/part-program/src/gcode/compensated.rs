//! Moves under cutter compensation: which words begin and end it, the radius of the tool, and what it does not allow.

use domains::shown;

use crate::arc::{ArcMove, Plane};
use crate::gcode::block::Block;
use crate::gcode::compensation::{Beside, Compensation, ContourMove, Fault, What};
use crate::gcode::contour::Sense;
use crate::gcode::frame::Frame;
use crate::gcode::modal::Motion;
use crate::gcode::reader::Reader;
use crate::gcode::word::{Key, Word};
use crate::moves::MoveKind;
use crate::options::Dialect;
use crate::source::Span;

impl Reader<'_, '_, '_> {
    /// G41, G42, G41.1 and G42.1. It is not read without the radius of the tool.
    pub(crate) fn begin_compensation(
        &mut self,
        block: &mut Block<'_>,
        word: Word,
        tenths: u16,
    ) -> Result<(), ()> {
        let span = word.span;
        if self.compensation.is_some() || self.modal.plane == Plane::Yz {
            let (said, expected) = match self.compensation {
                Some(_) => ("the cutter is compensated already", "G40 before it"),
                None => ("the cutter is not compensated in the plane of Y and Z", "G17 or G18 before it"),
            };
            self.report.error(span, said).expected(expected);
            return Err(());
        }
        let is_known = !self.modal.is_lost() && !self.unread_frames.are_in_force();
        let diameter = self.diameter_mm(block, word, !tenths.is_multiple_of(10)).filter(|_| is_known);
        let Some(diameter) = diameter else {
            if !self.options.lenient {
                return Err(());
            }
            self.open_frame(Frame::Until(&[400]));
            return Ok(());
        };
        if self.options.dialect.is_none() {
            let text = self.report.source.slice(span);
            let message = format!("`{text}` is read as LinuxCNC compensates: around outer corners by arcs");
            self.report
                .of_kind(false, span, "compensation", message)
                .hint("other controls begin, end and pass corners in other ways");
        }
        let side = if matches!(tenths, 410 | 411) { 1.0 } else { -1.0 };
        if diameter != 0.0 {
            self.compensation = Some(Compensation::new(side * diameter / 2.0, self.modal.plane));
        }
        Ok(())
    }

    /// The diameter of the tool that a word names, in mm.
    fn diameter_mm(&mut self, block: &mut Block<'_>, word: Word, is_written: bool) -> Option<f64> {
        let d = block.take_letter(b'D');
        if is_written {
            if let Some(word) = block.take_letter(b'L').filter(|word| word.value != 0.0) {
                self.unread_or_error(word.span, "a tool of a lathe".into(), "G41.1 and G42.1 without L");
                return None;
            }
            if d.is_none() {
                let text = self.report.source.slice(word.span);
                let message = format!("`{text}` without the diameter of the tool");
                self.unread_or_error(word.span, message, "D, the diameter");
            }
            return d.map(|word| self.modal.mm(word.value));
        }
        let written = d.map(|word| word.value).or(self.tool.offset).filter(|number| *number != 0.0);
        let Some(number) = written.or(self.tool.loaded).filter(|number| *number != 0.0) else {
            let message = "no tool is named: the contour itself is followed, as LinuxCNC does";
            self.report
                .of_kind(false, word.span, "no tool", message)
                .expected("D with the number of a tool, or T and M6");
            return Some(0.0);
        };
        #[allow(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "whole, 0 ..= 99,999,999")]
        let tool = ((0.0..=99_999_999.0).contains(&number) && number.fract() == 0.0).then_some(number as u32);
        if self.modal.plane == Plane::Zx && tool.is_some_and(|tool| self.tools.is_of_lathe(tool)) {
            let message = format!("tool {} has an orientation, Q: it is one of a lathe", shown(number));
            self.unread_or_error(word.span, message, "a tool of a mill");
            return None;
        }
        let diameter = tool.and_then(|tool| self.tools.diameter_mm(tool));
        if diameter.is_none() {
            let message = format!("the radius of tool {} is not known", shown(number));
            self.unread_or_error(
                word.span,
                message,
                "a tool table with this tool, `--tools FILE`, or G41.1 with the diameter as D",
            );
        }
        diameter
    }

    /// An error, or for a lenient reader a warning.
    fn unread_or_error(&mut self, span: Span, message: String, expected: &str) {
        self.report.of_kind(!self.options.lenient, span, message.clone(), message).expected(expected);
    }

    /// G40, or the end of the program: the tool ends beside the end of the contour, and the next move leads it there.
    pub(crate) fn end_compensation(&mut self) {
        let Some(compensation) = &mut self.compensation else { return };
        let (at, plane) = (compensation.at(), compensation.plane);
        let done = std::mem::take(compensation.waiting());
        self.push_compensated(&done);
        self.compensation = None;
        self.off_contour = at.map(|at| (at, plane)).or(self.off_contour);
    }

    /// Follows a straight move of the contour.
    pub(crate) fn compensated_line(
        &mut self,
        ends: [[f64; 3]; 2],
        kind: MoveKind,
        feed: Option<f64>,
        span: Span,
    ) {
        let what = What { kind, feed, place: self.place(span), end: self.end, rests: false };
        self.follow_contour(ContourMove { start: ends[0], end: ends[1], about: None, beside: what }, span);
    }

    /// Follows an arc of the contour.
    pub(crate) fn compensated_arc(&mut self, arc: &ArcMove, feed: Option<f64>, span: Span) {
        let Ok(centre) = arc.centre() else { return };
        let sense = if arc.clockwise { Sense::Clockwise } else { Sense::Counterclockwise };
        let what = What { kind: MoveKind::Feed, feed, place: self.place(span), end: self.end, rests: false };
        let about = Some((centre, sense, arc.turns));
        self.follow_contour(ContourMove { start: arc.start, end: arc.end, about, beside: what }, span);
    }

    fn follow_contour(&mut self, one: ContourMove, span: Span) {
        let here = self.leave_contour(one.start);
        let Some(compensation) = &mut self.compensation else { return };
        let last = compensation.last_place();
        let radius = compensation.radius();
        match compensation.follow(one, here) {
            Ok(done) => self.push_compensated(&done),
            Err(fault) => self.say_fault(fault, radius, last.map(|place| self.line_of(place.span)), span),
        }
    }

    fn say_fault(&mut self, fault: Fault, radius: f64, last_line: Option<usize>, span: Span) {
        let radius = shown(radius);
        let line = self.line_of(span);
        let between = last_line.map_or(String::new(), |last| format!(" between lines {last} and {line}"));
        let (message, expected) = match fault {
            Fault::EntryTooShort { length } => (
                format!(
                    "the first move of the compensation is {} mm long, and the radius of the tool {radius} mm",
                    shown(length)
                ),
                "a first move that is longer than the radius",
            ),
            Fault::NoArcIn => (
                format!("no arc leads a tool of radius {radius} mm beside this one"),
                "a straight first move, or an arc that is longer",
            ),
            Fault::ArcTooSmall => (
                format!("a tool of radius {radius} mm does not fit into this arc"),
                "a radius of the arc above that of the tool",
            ),
            Fault::NotReached => (
                format!(
                    "a tool of radius {radius} mm does not reach the inner corner{between}: a move is too short for it"
                ),
                "longer moves, or a smaller tool",
            ),
            Fault::TooManyAcross => (
                "too many moves across the plane of the compensation in one place".into(),
                "a move in the plane between them",
            ),
        };
        self.report.error(span, message).expected(expected);
        self.compensation = None;
        self.modal.motion = Motion::Broken;
    }

    fn push_compensated(&mut self, done: &[Beside]) {
        let Some(plane) = self.compensation.as_ref().map(|compensation| compensation.plane) else { return };
        for one in done {
            let Some((curve, shape)) = one.curve(plane) else { continue };
            if let Some(fault) = curve.faults().first() {
                self.report.error(one.what.place.span, fault.to_string()).expected(fault.expected());
                continue;
            }
            let end = std::mem::replace(&mut self.end, one.what.end);
            self.push(curve, one.what.kind, shape, one.what.feed, one.what.place);
            self.end = end;
            if one.what.rests {
                self.rest_at_last();
            }
        }
    }

    /// Where a move begins: where the tool is beside the contour, if a compensation has ended there, or else at `start`.
    pub(crate) fn leave_contour(&mut self, start: [f64; 3]) -> [f64; 3] {
        let mut from = start;
        if let Some((at, plane)) = self.off_contour.take() {
            let [first, second, _] = plane.axes();
            (from[first], from[second]) = (at[first], at[second]);
        }
        from
    }

    /// Whether something is in the way of a compensation that is in force, which is reported.
    pub(crate) fn is_barred(&mut self, span: Span, what: &str) -> bool {
        if self.compensation.is_none() {
            return false;
        }
        self.report
            .of_kind(
                true,
                span,
                format!("{what} compensated"),
                format!("{what} while the cutter is compensated"),
            )
            .expected("G40 before it");
        true
    }

    /// Whether the motion of a block cannot be compensated, which is reported.
    pub(crate) fn motion_is_barred(&mut self, block: &Block<'_>) -> bool {
        let is_taken = matches!(
            self.modal.motion,
            Motion::None
                | Motion::Rapid
                | Motion::Line
                | Motion::Arc { .. }
                | Motion::Unread
                | Motion::Broken
        );
        let has_corner = block
            .words()
            .iter()
            .any(|word| matches!(word.key, Key::CornerRadius | Key::CornerDistance | Key::Chamfer));
        if is_taken && !has_corner {
            return false;
        }
        let name = if has_corner { "a corner that the control rounds" } else { self.modal.motion.name() };
        self.is_barred(block.span, name)
    }

    /// A move was left out: what goes on from it is not known before G40. For a lenient reader alone.
    pub(crate) fn lose_compensation(&mut self) {
        self.off_contour = None;
        if self.compensation.take().is_some() {
            self.open_frame(Frame::Until(&[400]));
        }
    }

    /// Keeps which tool is in use, of T, M6, M61 and D.
    pub(crate) fn use_tool(&mut self, letter: u8, value: f64) {
        match (letter, self.options.dialect) {
            (b'T', _) => self.tool.prepared = Some(value),
            (b'D', None) => self.tool.offset = Some(value),
            _ => {}
        }
    }

    /// G10 L1, L10 and L11: R is the radius of a tool.
    pub(crate) fn set_tool_radius(&mut self, number: f64, radius: Option<Word>) {
        let Some(radius) = radius.filter(|_| self.options.dialect != Some(Dialect::Fanuc)) else { return };
        #[allow(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "whole, 0 ..= 99,999,999")]
        if (0.0..=99_999_999.0).contains(&number) && number.fract() == 0.0 {
            self.tools.to_mut().set(number as u32, 2.0 * self.modal.mm(radius.value));
        }
    }
}
