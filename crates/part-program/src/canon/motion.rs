//! Moves: straight moves, arcs, and moves whose end is not printed.

use crate::approach::Approach;
use crate::arc::{ArcFault, ArcMove, Circle};
use crate::canon::call::Call;
use crate::canon::frame::Frame;
use crate::canon::{FeedMode, Once, Reader};
use crate::curve::{Curve, MAX_COORDINATE_MM};
use crate::exact_stops::PathMode;
use crate::moves::{Move, MoveKind, Shape};
use crate::source::Span;

/// The most turns of one arc. So a line of text cannot become more curves than a machine ever turns.
const MAX_TURNS: u32 = 1000;

impl Reader<'_, '_, '_> {
    pub(super) fn straight(&mut self, call: &Call<'_>) {
        let numbers = call.numbers();
        let Some((end, rotary)) = numbers.as_ref().and_then(|numbers| numbers.split::<3>()) else {
            return self.malformed(call, "X, Y and Z");
        };
        let kind = if call.name == "STRAIGHT_FEED" { MoveKind::Feed } else { MoveKind::Rapid };
        let Some(end) = self.place(end, call.span) else { return };
        let turns = self.turns_rotary(rotary, call.span);
        match self.position.replace(end) {
            None => self.approach(kind),
            Some(start) if start != end => self.push(Curve::line(start, end), kind, Shape::Line, call.span),
            Some(_) if kind == MoveKind::Feed && turns => {
                let expected = "a move of X, Y or Z: how fast the tool is then nobody knows here";
                self.refuse(call.span, "a cut by rotary axes alone", expected);
            }
            Some(_) if kind == MoveKind::Feed => {
                self.part.standstills.push(self.line);
                if self.path_mode == PathMode::ExactStop {
                    self.rest();
                }
            }
            Some(_) => {}
        }
    }

    /// The first straight move, or the first one after a move that is not read.
    fn approach(&mut self, kind: MoveKind) {
        let feedrate_mm_per_s = if kind == MoveKind::Feed { self.feedrate() } else { None };
        self.part.approaches.push(Approach {
            axes: [true; 3],
            kind,
            feedrate_mm_per_s,
            line: self.line,
            block: self.block(),
        });
    }

    pub(super) fn arc(&mut self, call: &Call<'_>) {
        let numbers = call.numbers();
        let Some(([a, b, centre_a, centre_b, rotation, c], rotary)) =
            numbers.as_ref().and_then(|numbers| numbers.split::<6>())
        else {
            return self.malformed(call, "end, centre, turns and the end along the axis");
        };
        let Some(turns) = turns(rotation) else {
            return self.malformed(call, "a whole number of turns, negative for clockwise, within ±1000");
        };
        let [first, second, normal] = self.plane.axes();
        let (mut end, mut centre) = ([0.0; 3], [0.0; 3]);
        (end[first], end[second], end[normal]) = (a, b, c);
        (centre[first], centre[second], centre[normal]) = (centre_a, centre_b, c);
        let places = self.place(end, call.span).zip(self.place(centre, call.span));
        let Some((end, centre)) = places else { return };
        self.turns_rotary(rotary, call.span);
        let Some(start) = self.position.replace(end) else {
            let expected = "a straight move to its start";
            return self.refuse(call.span, "where this arc starts is not known", expected);
        };
        // A rotation about Z turns the planes XZ and YZ: such an arc is made in the coordinates as written, and then
        // turned.
        let first_frame = self.first_frame.unwrap_or(self.frame);
        let frame = if normal == 2 { Frame::default() } else { self.frame.seen_from(&first_frame) };
        let [start, end, centre] = [start, end, centre].map(|point| frame.turned_back(point));
        let circle = Circle::Centre([centre[first], centre[second]]);
        let arc = ArcMove::new(self.plane, rotation < 0.0, [start, end], circle);
        match self.push_turns(arc, turns, frame, call.span) {
            Ok(()) => {}
            // The radius is less than the last decimal.
            Err(ArcFault::NoRadius) if start == end => self.part.standstills.push(self.line),
            Err(ArcFault::NoRadius) => {
                self.push(turned(Curve::line(start, end), frame), MoveKind::Feed, Shape::Line, call.span);
            }
            Err(_) => {
                self.report.error(call.span, "the helix is too high").expected("a rise that a machine has");
            }
        }
    }

    /// Makes one curve of each turn of an arc; all but the last are full turns.
    fn push_turns(&mut self, arc: ArcMove, turns: u32, frame: Frame, span: Span) -> Result<(), ArcFault> {
        let [.., normal] = arc.plane.axes();
        // The share of the height for one full turn: the height is proportional to the angle.
        let angle = arc.sweep()?;
        let whole = f64::from(turns - 1) * std::f64::consts::TAU;
        let rise = (arc.end[normal] - arc.start[normal]) * std::f64::consts::TAU / (whole + angle);
        let mut from = arc.start;
        for turn in 1..turns {
            let mut to = arc.start;
            to[normal] += rise * f64::from(turn);
            let (curve, _) = ArcMove { start: from, end: to, ..arc }.spiral()?;
            self.push(turned(curve, frame), MoveKind::Feed, Shape::Arc, span);
            from = to;
        }
        let (curve, _) = ArcMove { start: from, ..arc }.spiral()?;
        self.push(turned(curve, frame), MoveKind::Feed, Shape::Arc, span);
        Ok(())
    }

    /// Rigid tapping: to the depth with the spindle, and back.
    pub(super) fn tap(&mut self, call: &Call<'_>) {
        let numbers = call.numbers();
        let Some((depth, _)) = numbers.as_ref().and_then(|numbers| numbers.split::<3>()) else {
            return self.malformed(call, "X, Y and Z");
        };
        let Some(depth) = self.place(depth, call.span) else { return };
        let Some(start) = self.position else {
            return self.refuse(
                call.span,
                "where this thread starts is not known",
                "a straight move to its start",
            );
        };
        if start != depth {
            let synchronous = std::mem::replace(&mut self.is_synchronous, true);
            for (from, to) in [(start, depth), (depth, start)] {
                self.push(Curve::line(from, to), MoveKind::Feed, Shape::Line, call.span);
                self.rest();
            }
            self.is_synchronous = synchronous;
        }
    }

    /// A move whose end is not printed. After it, the place of the tool is unknown.
    pub(super) fn lose(&mut self, call: &Call<'_>) {
        let (message, expected) = match call.name {
            "NURBS_FEED" => (
                "a spline, of which rs274 prints no points",
                "the program itself, which is read with G5.2, G5 and G5.1",
            ),
            "STRAIGHT_PROBE" => ("a probing move, which ends where it touches", "moves whose end is known"),
            _ => ("a retraction, whose end is not printed", "moves whose end is known"),
        };
        self.refuse(call.span, message, expected);
        self.position = None;
    }

    /// The place of a printed point in the part, in mm.
    fn place(&mut self, point: [f64; 3], span: Span) -> Option<[f64; 3]> {
        let first = *self.first_frame.get_or_insert(self.frame);
        let place = self.frame.place(point.map(|x| x * self.unit), &first);
        // If the sum of offsets is NaN, it is out of range too.
        if place.iter().all(|x| x.abs() <= MAX_COORDINATE_MM) {
            return Some(place);
        }
        self.report
            .error(span, "a coordinate is out of range")
            .expected(format!("coordinates within ±{MAX_COORDINATE_MM:e} mm"));
        None
    }

    /// Stores the places of rotary axes and second linear axes, and reports once that they move.
    fn turns_rotary(&mut self, rotary: &[f64], span: Span) -> bool {
        let mut now = self.rotary;
        now.iter_mut().zip(rotary).for_each(|(axis, value)| *axis = *value);
        let turns = now != self.rotary;
        self.rotary = now;
        if turns {
            let message = "rotary axes move, which are not read: the path is that of X, Y and Z";
            self.say_once(Once::Rotary, span, message);
        }
        turns
    }

    /// The feedrate in force.
    fn feedrate(&self) -> Option<f64> {
        let is_known = self.feed_mode == FeedMode::PerMinute && !self.is_synchronous;
        self.feedrate_mm_per_s.filter(|_| is_known)
    }

    /// Adds a curve. Its direction decides whether the curve before it ends with a stop.
    fn push(&mut self, curve: Curve, kind: MoveKind, shape: Shape, span: Span) {
        if let Some(fault) = curve.faults().first() {
            self.report.error(span, fault.to_string()).expected(fault.expected());
            return;
        }
        let feedrate_mm_per_s = if kind == MoveKind::Feed { self.feedrate() } else { None };
        if kind == MoveKind::Feed && (self.feed_mode == FeedMode::PerRevolution || self.is_synchronous) {
            self.say_once(Once::Revolution, span, "moves with a feed per revolution have none");
        }
        let (line, block) = (self.line, self.block());
        let one = Move { kind, shape, feedrate_mm_per_s, exact_stop: false, line, block };
        self.stops.push(self.part, self.path_mode, curve, one);
    }

    /// The last move ends at rest.
    pub(super) fn rest(&mut self) {
        self.stops.rest(self.part);
    }
}

/// A curve turned about Z like the coordinates.
fn turned(mut curve: Curve, frame: Frame) -> Curve {
    curve.control_points_mm_mut().iter_mut().for_each(|point| *point = frame.turned(*point));
    curve
}

/// The number of an arc's turns, without their sense.
fn turns(rotation: f64) -> Option<u32> {
    (1..=MAX_TURNS).find(|turns| f64::from(*turns) == rotation.abs())
}
