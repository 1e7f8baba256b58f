//! Straight moves, arcs and helices of a part program.

use domains::shown;
use domains::words::TURNS;

use crate::approach::Approach;
use crate::arc::{ArcFault, ArcMove, Circle, Plane, TAKEN_MM};
use crate::curve::{Curve, MAX_COORDINATE_MM};
use crate::gcode::block::Block;
use crate::gcode::corner::Corner;
use crate::gcode::modal::{FeedMode, Motion};
use crate::gcode::reader::Reader;
use crate::gcode::word::{Key, Word};
use crate::moves::{MoveKind, Shape};
use crate::options::Dialect;
use crate::source::Span;
use crate::vector::{difference, dot};

impl Reader<'_, '_, '_> {
    pub(crate) fn straight(&mut self, block: &mut Block<'_>, inverse_feed: Option<f64>) {
        let (before, span) = (self.modal.position, block.span);
        let corner = if self.modal.motion == Motion::Line {
            Corner::take(self.report, &self.modal, block)
        } else {
            None
        };
        let is_known = self.compensation.is_none() || self.start_is_known(self.modal.plane, span);
        let Some((start, end)) = self.ends(block).filter(|_| is_known) else { return };
        self.approach(before, span);
        if start == end && self.others.side.words.is_some() {
            return self.turn_alone();
        }
        if start == end && self.off_contour.is_none() {
            // A first move gives the place of the tool. A later move to the same place was meant to have a length.
            if self.modal.motion == Motion::Line && self.modal.position == before {
                let line = self.line_of(span);
                self.part.standstills.push(line);
                self.rest_here();
            }
            return;
        }
        let kind = if self.modal.motion == Motion::Rapid { MoveKind::Rapid } else { MoveKind::Feed };
        self.push_line([start, end], kind, inverse_feed, span);
        self.corner = corner;
    }

    /// Makes a straight move; at feed, at the one in force.
    pub(crate) fn push_line(
        &mut self,
        [start, end]: [[f64; 3]; 2],
        kind: MoveKind,
        inverse_feed: Option<f64>,
        span: Span,
    ) {
        let feed = match kind {
            MoveKind::Rapid => None,
            MoveKind::Feed => {
                let way = difference(&end, &start);
                let length = dot(way, way).sqrt();
                let feed = self.feedrate(length, inverse_feed, span);
                self.feed_beside(length, feed)
            }
        };
        if self.compensation.is_some() {
            return self.compensated_line([start, end], kind, feed, span);
        }
        self.push(Curve::line(start, end), kind, Shape::Line, feed, self.place(span));
    }

    /// Stores the axes that were unknown before this straight move and are known now.
    pub(crate) fn approach(&mut self, before: [Option<f64>; 3], span: Span) {
        let here = self.modal.position;
        let axes = std::array::from_fn(|axis| before[axis].is_none() && here[axis].is_some());
        // Incremental words do not give their start.
        if self.modal.incremental || axes == [false; 3] {
            return;
        }
        let (kind, feedrate_mm_per_s) = match (self.modal.motion, self.modal.feed_mode) {
            (Motion::Rapid, _) => (MoveKind::Rapid, None),
            (_, FeedMode::PerMinute) => (MoveKind::Feed, self.modal.feedrate_mm_per_s),
            (_, FeedMode::InverseTime | FeedMode::PerRevolution) => (MoveKind::Feed, None),
        };
        if kind == MoveKind::Feed {
            let letters: Vec<_> = ["X", "Y", "Z"]
                .into_iter()
                .zip(axes)
                .filter(|(_, is)| *is)
                .map(|(letter, _)| letter)
                .collect();
            let message = format!(
                "where the tool is on {} before this move at feed is not known: its way there is left out",
                letters.join(", ")
            );
            self.report
                .of_kind(false, span, "start", message)
                .note()
                .hint("`--start X,Y,Z` says where the tool is at first");
        }
        let line = self.line_of(span);
        self.part.approaches.push(Approach {
            axes,
            kind,
            feedrate_mm_per_s,
            line,
            block: self.place(span).block,
        });
    }

    /// Start and end of a move by the block's coordinates. The position is set to the end.
    pub(crate) fn ends(&mut self, block: &mut Block<'_>) -> Option<([f64; 3], [f64; 3])> {
        let mut written = block.take_axes();
        let polar = [block.take_letter(b'@'), block.take_letter(b'^')];
        self.polar(polar, self.modal.here(), &mut written);
        let end = self.modal.target(self.modal.here(), written);
        if end.iter().any(|x| x.abs() > MAX_COORDINATE_MM) {
            self.report
                .error(block.span, "a coordinate is out of range")
                .expected(format!("coordinates within ±{MAX_COORDINATE_MM:e} mm"));
            return None;
        }
        let start = self.modal.start(end);
        self.modal.arrive(written, end);
        self.begin_axes();
        Some((start, end))
    }

    /// LinuxCNC's polar coordinates: `@` is the distance from 0 in the plane of X and Y, `^` the angle in degrees. They become X and Y.
    pub(crate) fn polar(
        &self,
        [radius, angle]: [Option<Word>; 2],
        from: [f64; 3],
        written: &mut [Option<f64>; 3],
    ) {
        if radius.is_none() && angle.is_none() {
            return;
        }
        let here = self.modal.in_program(from).map(|place| place / self.modal.mm(1.0));
        let value = |word: Option<Word>, here: f64| match word {
            Some(word) if self.modal.incremental => here + word.value,
            Some(word) => word.value,
            None => here,
        };
        let radius = value(radius, here[0].hypot(here[1]));
        let (sin, cos) = value(angle, here[1].atan2(here[0]).to_degrees()).to_radians().sin_cos();
        for (axis, to) in [radius * cos, radius * sin].into_iter().enumerate() {
            written[axis] = Some(if self.modal.incremental { to - here[axis] } else { to });
        }
    }

    /// Reports that a curve cannot be read, because its start in its plane is unknown.
    pub(crate) fn start_is_known(&mut self, plane: Plane, span: Span) -> bool {
        let [first, second, _] = plane.axes();
        let unknown = [first, second].into_iter().find(|axis| self.modal.position[*axis].is_none());
        let Some(axis) = unknown.filter(|_| !self.modal.incremental) else { return true };
        let letter = ["X", "Y", "Z"][axis];
        self.report
            .error(span, format!("where this curve starts on {letter} is not known"))
            .expected("a move to its start, such as G0 with both axes of the plane");
        false
    }

    pub(crate) fn arc(&mut self, block: &mut Block<'_>, clockwise: bool, inverse_feed: Option<f64>) {
        let plane = self.modal.plane;
        let [first, second, normal] = plane.axes();
        let offset = |axis: usize| [b'I', b'J', b'K'][axis];
        let radius = block.take_letter(b'R').or_else(|| block.take(Key::CircleRadius));
        let (i, j) = (block.take_letter(offset(first)), block.take_letter(offset(second)));
        let turns = self.turns(block);
        let angle = block.take(Key::ArcAngle);
        if let Some(word) = block.take_letter(offset(normal)).filter(|word| word.value != 0.0) {
            let letters = [first, second].map(|axis| char::from(offset(axis)));
            self.report
                .error(word.span, "this centre word is not in the plane of the arc")
                .expected(format!("{} and {}, or R", letters[0], letters[1]))
                .hint("G17, G18 and G19 choose the plane");
            self.pass_over(block);
            return;
        }
        if !self.may_turn(plane, block.span) {
            self.pass_over(block);
            return;
        }
        let is_known = self.start_is_known(plane, block.span);
        let names_end = [first, second].iter().any(|axis| block.has(b"XYZ"[*axis]));
        let Some((start, mut end)) = self.ends(block).filter(|_| is_known) else { return };
        let circle = match (radius, i.or(j)) {
            (radius, centre) if angle.is_some() => {
                let given = (radius, centre.map(|_| self.centre(start, [i, j])), names_end);
                let Some(circle) = self.by_angle(angle, given, [start, end]) else { return };
                if let (Circle::Centre(centre), Some(angle)) = (circle, angle) {
                    end = self.turn_to(start, centre, if clockwise { -angle.value } else { angle.value });
                }
                circle
            }
            (Some(radius), None) => Circle::Radius(self.modal.mm(radius.value)),
            // FANUC's R is taken where both are written.
            (Some(radius), Some(_)) if self.options.dialect == Some(Dialect::Fanuc) => {
                Circle::Radius(self.modal.mm(radius.value))
            }
            (None, Some(_)) => Circle::Centre(self.centre(start, [i, j])),
            (Some(radius), Some(_)) => {
                self.report.error(radius.span, "an arc with both centre and radius").expected("one of them");
                return;
            }
            (None, None) => {
                self.report
                    .error(block.span, "an arc without centre or radius")
                    .expected("two of I, J and K in the plane of the arc, or R");
                return;
            }
        };
        let arc = ArcMove { turns, ..ArcMove::new(plane, clockwise, [start, end], circle) };
        match arc.curve() {
            Ok((curve, length)) => {
                self.warn_of_strain(&arc, block.span);
                let feed = self.feedrate(length, inverse_feed, block.span);
                if let Some(fault) = curve.faults().first() {
                    self.report.error(block.span, fault.to_string()).expected(fault.expected());
                    return;
                }
                if self.compensation.is_some() {
                    return self.compensated_arc(&arc, feed, block.span);
                }
                self.push(curve, MoveKind::Feed, Shape::Arc, feed, self.place(block.span));
            }
            Err(fault) => self.refuse_arc(fault, block.span),
        }
    }

    /// The centre of an arc in its plane, by its words along the two axes of the plane.
    fn centre(&self, start: [f64; 3], words: [Option<Word>; 2]) -> [f64; 2] {
        let [first, second, _] = self.modal.plane.axes();
        let values = words.map(|word| word.map(|word| self.modal.mm(word.value)));
        let centre = if self.modal.absolute_centres {
            let mut place = self.modal.in_program(start);
            for (axis, value) in [first, second].into_iter().zip(values) {
                place[axis] = value.unwrap_or(place[axis]);
            }
            self.modal.in_part(place)
        } else {
            let mut offset = [0.0; 3];
            (offset[first], offset[second]) = (values[0].unwrap_or(0.0), values[1].unwrap_or(0.0));
            let offset = self.modal.turned(offset);
            std::array::from_fn(|axis| start[axis] + offset[axis])
        };
        [centre[first], centre[second]]
    }

    /// The number of turns of an arc, the last of which ends at the arc's end: P, or TURN= without the last.
    fn turns(&mut self, block: &mut Block<'_>) -> u32 {
        let beside = block.take(Key::Turns).map(|word| Word { value: word.value + 1.0, ..word });
        let Some(word) = beside.or_else(|| block.take_letter(b'P')) else { return 1 };
        if !TURNS.holds(word.value) {
            self.report
                .error(word.span, format!("an arc of {} turns", shown(word.value)))
                .expected(TURNS.expected());
            return 1;
        }
        #[allow(
            clippy::cast_possible_truncation,
            clippy::cast_sign_loss,
            reason = "within the domain of a u32"
        )]
        let turns = word.value as u32;
        turns
    }

    /// Warns if the reader bends an arc by more than a control may accept.
    fn warn_of_strain(&mut self, arc: &ArcMove, span: Span) {
        let Some([start, end]) = arc.strained_radii() else { return };
        let message = match arc.circle {
            Circle::Centre(_) => format!(
                "the end is off the circle: radius {start:.4} at the start, {end:.4} at the end; the path goes from one to the other"
            ),
            Circle::Radius(_) => format!("radius {start:.4} does not reach: {end:.4} is taken"),
        };
        let expected =
            format!("radii that differ by at most {TAKEN_MM} mm, or 0.1 %: a control may refuse the arc");
        self.report.warning(span, message).expected(expected);
    }

    pub(crate) fn refuse_arc(&mut self, fault: ArcFault, span: Span) {
        let (message, expected) = match fault {
            ArcFault::NoRadius => ("the centre of the arc is its start".into(), "a centre off the start"),
            ArcFault::EndOffCircle { start, end } => (
                format!("the end is off the circle: radius {start:.4} at the start, {end:.4} at the end"),
                "equal distances of start and end from the centre",
            ),
            ArcFault::RadiusTooSmall { radius, chord } => (
                format!("radius {} does not reach: start and end are {chord:.4} mm apart", shown(radius)),
                "a radius of at least half that distance",
            ),
            ArcFault::FullCircleByRadius => {
                ("an arc by radius ends where it starts".into(), "a full circle by its centre I, J, K")
            }
            ArcFault::TooLong => ("the helix is too high".into(), "a rise that a machine has"),
        };
        self.report.of_kind(true, span, expected, message).expected(expected);
    }

    /// The feedrate of a move of `length` mm.
    pub(crate) fn feedrate(&mut self, length: f64, inverse_feed: Option<f64>, span: Span) -> Option<f64> {
        match (self.modal.feed_mode, inverse_feed) {
            (FeedMode::PerMinute, _) => self.modal.feedrate_mm_per_s,
            (FeedMode::PerRevolution, _) => self.feedrate_of_spindle(self.modal.feed_mm_per_revolution, span),
            (FeedMode::InverseTime, Some(per_minute)) => self.within_feeds(length * per_minute / 60.0, span),
            (FeedMode::InverseTime, None) => {
                self.report
                    .error(span, "a move in inverse time feed without F")
                    .expected("F in every block of G93");
                None
            }
        }
    }

    /// The feedrate, in mm/s, of a feed per revolution.
    fn feedrate_of_spindle(&mut self, per_revolution: Option<f64>, span: Span) -> Option<f64> {
        let feedrate =
            per_revolution.zip(self.modal.spindle_per_minute).map(|(feed, speed)| feed * speed / 60.0);
        if feedrate.is_none() {
            self.report
                .warning(
                    span,
                    "a feed per revolution of a spindle whose speed is not known: the move has none",
                )
                .expected("S and F before it");
        }
        feedrate.and_then(|feedrate| self.within_feeds(feedrate, span))
    }

    /// G33: a straight move whose feed is K a revolution; G33.1 comes back the same way.
    pub(crate) fn with_spindle(&mut self, block: &mut Block<'_>, comes_back: bool) {
        let pitch = block.take_letter(b'K').map(|word| self.modal.mm(word.value));
        let span = block.span;
        let Some((start, end)) = self.ends(block) else { return };
        if start == end {
            return;
        }
        let feed = self.feedrate_of_spindle(pitch, span);
        self.push(Curve::line(start, end), MoveKind::Feed, Shape::Line, feed, self.place(span));
        if comes_back {
            self.rest();
            self.push(Curve::line(end, start), MoveKind::Feed, Shape::Line, feed, self.place(span));
            self.modal.position = start.map(Some);
        }
    }
}
