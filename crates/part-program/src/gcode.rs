//! Part programs: blocks of words, with modal state, to curves.
//!
//! | words | meaning |
//! |---|---|
//! | G0 G1 | straight moves: curves of degree 1 |
//! | G2 G3 with I J K or R (CR=) | arcs, full circles and helices: rational curves of degree 2 |
//! | G06.2, G5.2 G5.3, G5, G5.1, BSPLINE | splines of FANUC, LinuxCNC and Siemens |
//! | G17 G18 G19, G20 G21 (G70 G71), G90 G91, G90.1 G91.1 | planes, units, coordinates, centres |
//! | F with G93 G94 | feed |
//! | M S T D H | no effect on the path; listed |
//!
//! A coordinate that is not written keeps its value. Where the tool is at first is not known: an axis begins where it is
//! first sent.

use crate::arc::{ArcFault, ArcMove, Circle, Plane};
use crate::block::Block;
use crate::curve::{Curve, MAX_COORDINATE_MM};
use crate::diagnostic::Report;
use crate::fanuc::FanucNurbs;
use crate::gcode_word::{self, Key, Word};
use crate::linuxcnc::{self, LinuxCncNurbs};
use crate::modal::{FeedMode, Modal, Motion};
use crate::options::{Dialect, ReadOptions};
use crate::part::{Auxiliary, Move, MoveKind, Part, Shape};
use crate::siemens::SiemensSpline;
use crate::source::Span;

/// Highest feedrate that is believed, in mm/s.
const MAX_FEEDRATE: f64 = 1e5;

/// Reads a whole program into `part`. What is wrong goes to the report.
pub(crate) fn read(report: &mut Report<'_>, part: &mut Part, options: ReadOptions) {
    let text = report.source.text;
    let mut reader =
        Reader { report, part, options, modal: Modal::default(), spline: None, smooth: None, ended: false };
    let (mut words, mut at) = (Vec::new(), 0);
    for line in text.split_inclusive('\n') {
        let start = at;
        at += line.len();
        gcode_word::words(reader.report, options.lenient, start, line, &mut words);
        if reader.ended {
            if let Some(word) = words.first() {
                reader.report.warning(word.span, "what follows the end of the program is not read");
                break;
            }
            continue;
        }
        reader.block(&mut words);
    }
    reader.close(Span::new(text.len(), text.len()));
    part.feedrate_mm_per_s = part.highest_feedrate();
    if part.curves.is_empty() && !report.has_errors() {
        report
            .error(Span::new(0, 0), "the program holds no curve")
            .expected("a move from one point to another");
    }
}

/// A spline of which more blocks may come.
enum Spline {
    Fanuc(FanucNurbs),
    LinuxCnc(LinuxCncNurbs),
    Siemens(SiemensSpline),
}

struct Reader<'r, 't, 'p> {
    report: &'r mut Report<'t>,
    part: &'p mut Part,
    options: ReadOptions,
    modal: Modal,
    spline: Option<(Spline, Span)>,
    /// Inner point of a smooth continuation of G5, from its start.
    smooth: Option<[f64; 2]>,
    ended: bool,
}

impl Reader<'_, '_, '_> {
    fn block(&mut self, words: &mut Vec<Word>) {
        let Some(mut block) = Block::new(self.report, words) else { return };
        let span = block.span;
        let Some(motion) = self.preparatory(&mut block) else { return };
        if let Some(motion) = motion {
            self.modal.motion = motion;
        }
        let ends = self.auxiliary(&mut block);
        let inverse_feed = self.feed(&mut block);
        self.motion(&mut block, motion.is_some(), inverse_feed);
        self.refuse(block);
        if ends {
            self.close(span);
            self.ended = true;
        }
    }

    /// Takes the G words, and says which motion the block commands, if it does; `None` when the block cannot be read.
    fn preparatory(&mut self, block: &mut Block<'_>) -> Option<Option<Motion>> {
        let mut motion: Option<Motion> = None;
        let bspline = block.take(Key::Bspline).map(|word| (Motion::Bspline, word.span));
        let mut commands = bspline.into_iter().collect::<Vec<_>>();
        while let Some(word) = block.take_letter(b'G') {
            if matches!(self.spline, Some((Spline::Fanuc(_), _))) {
                self.close(word.span);
            }
            match self.general(block, word) {
                Ok(None) => {}
                Ok(Some(command)) => commands.push((command, word.span)),
                Err(()) => return None,
            }
        }
        for (command, span) in commands {
            if motion.is_some() {
                self.report.error(span, "two motions in one block").expected("one motion a block");
                return None;
            }
            self.belongs(command, span)?;
            let goes_on = matches!(
                (command, &self.spline),
                (Motion::LinuxCncNurbs, Some((Spline::LinuxCnc(_), _)))
                    | (Motion::Bspline, Some((Spline::Siemens(_), _)))
            );
            if !goes_on {
                self.close(span);
            }
            motion = Some(command);
        }
        Some(motion)
    }

    /// Obeys one G word; a motion is handed back.
    fn general(&mut self, block: &mut Block<'_>, word: Word) -> Result<Option<Motion>, ()> {
        let spline_words = b"XYIJQ".iter().any(|letter| block.has(*letter));
        match code(word.value) {
            Some(0) => return Ok(Some(Motion::Rapid)),
            Some(10) => return Ok(Some(Motion::Line)),
            Some(20) => return Ok(Some(Motion::Arc { clockwise: true })),
            Some(30) => return Ok(Some(Motion::Arc { clockwise: false })),
            Some(62) => return Ok(Some(Motion::FanucNurbs)),
            Some(50) if spline_words => return Ok(Some(Motion::Cubic)),
            Some(50) => self.high_precision(block, word)?,
            Some(51) if block.has(b'I') || block.has(b'J') || block.has_axis() => {
                return Ok(Some(Motion::Quadratic));
            }
            Some(51) if block.has(b'Q') => drop(block.take_letter(b'Q')),
            Some(52) => return Ok(Some(Motion::LinuxCncNurbs)),
            Some(53) => self.end_of_linuxcnc_nurbs(word.span),
            Some(170) => self.modal.plane = Plane::Xy,
            Some(180) => self.modal.plane = Plane::Zx,
            Some(190) => self.modal.plane = Plane::Yz,
            Some(200 | 700) => self.modal.inches = true,
            Some(210 | 710) => self.modal.inches = false,
            Some(900) => self.modal.incremental = false,
            Some(910) => self.modal.incremental = true,
            Some(901) => self.modal.absolute_centres = true,
            Some(911) => self.modal.absolute_centres = false,
            Some(930) => self.modal.feed_mode = FeedMode::InverseTime,
            Some(940) => self.modal.feed_mode = FeedMode::PerMinute,
            Some(800) => self.modal.motion = Motion::None,
            // Compensation off, exact stop and path modes, the first coordinate system.
            Some(400 | 490 | 540 | 610 | 640 | 500 | 690) => {}
            Some(40) => {
                self.report.warning(word.span, "a dwell is no part of the path");
                for letter in *b"PXF" {
                    block.take_letter(letter);
                }
            }
            Some(430) => {
                self.report.warning(word.span, "tool length compensation: the path is read as the tip's");
            }
            Some(550 | 560 | 570 | 580 | 590) => {
                self.report.warning(word.span, "another work offset: its origin is taken as the first one's");
            }
            _ => {
                let text = self.report.source.slice(word.span).to_owned();
                if self.options.lenient {
                    self.report.warning(word.span, format!("`{text}` is not read: the block is left out"));
                } else {
                    self.report
                        .error(word.span, format!("`{text}` is not read"))
                        .expected("G0 to G3, a spline, G17 to G21, G90, G91, G93 or G94");
                }
                return Err(());
            }
        }
        Ok(None)
    }

    /// `G05 P10000` and `G05 P0`.
    fn high_precision(&mut self, block: &mut Block<'_>, word: Word) -> Result<(), ()> {
        match block.take_letter(b'P') {
            Some(p) if p.value == 0.0 || p.value == 10_000.0 => Ok(()),
            Some(p) => {
                let message = format!("high-precision contouring P{}", p.value);
                self.report.error(p.span, message).expected("G05 P10000 or G05 P0");
                Err(())
            }
            None => {
                self.report
                    .error(word.span, "G5 without its words")
                    .expected("G05 P10000 or G05 P0, or a spline G5 X Y I J P Q");
                Err(())
            }
        }
    }

    fn end_of_linuxcnc_nurbs(&mut self, span: Span) {
        if let Some((Spline::LinuxCnc(nurbs), start)) = self.spline.take() {
            let curve = nurbs.finish(self.report);
            self.push_spline(curve, start);
        } else {
            self.report.error(span, "G5.3 without G5.2").expected("a curve that G5.2 opened");
        }
        self.modal.motion = Motion::None;
    }

    /// Checks that a spline is of the program's dialect.
    fn belongs(&mut self, motion: Motion, span: Span) -> Option<()> {
        let own = match motion {
            Motion::FanucNurbs => Dialect::Fanuc,
            Motion::Cubic | Motion::Quadratic | Motion::LinuxCncNurbs => Dialect::LinuxCnc,
            Motion::Bspline => Dialect::Siemens,
            _ => return Some(()),
        };
        let dialect = *self.options.dialect.get_or_insert(own);
        if dialect == own {
            return Some(());
        }
        let text = self.report.source.slice(span).to_owned();
        self.report
            .error(span, format!("`{text}` is a spline of {own}, and the program is read as {dialect}"))
            .expected(format!("splines of {dialect} only"));
        None
    }

    /// Takes the words that do not move the tool; says whether the program ends here.
    fn auxiliary(&mut self, block: &mut Block<'_>) -> bool {
        let mut ends = false;
        for letter in *b"MSTDH" {
            while let Some(word) = block.take_letter(letter) {
                let line = self.line(word.span);
                ends |= letter == b'M' && (word.value == 2.0 || word.value == 30.0);
                self.part.auxiliary.push(Auxiliary { letter: letter.into(), value: word.value, line });
            }
        }
        ends
    }

    /// Takes F: in G94 it becomes the feedrate, in G93 it is handed back, in 1/min.
    fn feed(&mut self, block: &mut Block<'_>) -> Option<f64> {
        let word = block.take_letter(b'F')?;
        if word.value <= 0.0 {
            self.report.error(word.span, format!("the feed is {}", word.value)).expected("a feed above 0");
            return None;
        }
        if self.modal.feed_mode == FeedMode::InverseTime {
            return Some(word.value);
        }
        let feedrate = self.modal.mm(word.value) / 60.0;
        if feedrate > MAX_FEEDRATE {
            self.report
                .error(word.span, format!("the feed is {feedrate} mm/s"))
                .expected(format!("at most {MAX_FEEDRATE} mm/s, which is F{}", MAX_FEEDRATE * 60.0));
            return None;
        }
        self.modal.feedrate_mm_per_s = Some(feedrate);
        None
    }

    fn motion(&mut self, block: &mut Block<'_>, is_new: bool, inverse_feed: Option<f64>) {
        if !is_new && block.is_empty() {
            return;
        }
        let continues = std::mem::take(&mut self.smooth).filter(|_| self.modal.motion == Motion::Cubic);
        match self.modal.motion {
            Motion::None if block.has_axis() => {
                self.report
                    .error(block.span, "coordinates without a motion")
                    .expected("G0, G1, G2, G3 or a spline");
                block.take_axes();
            }
            Motion::Rapid | Motion::Line if block.has_axis() => self.straight(block, inverse_feed),
            Motion::Arc { clockwise }
                if is_new || block.has_axis() || b"IJK".iter().any(|c| block.has(*c)) =>
            {
                self.arc(block, clockwise, inverse_feed);
            }
            Motion::FanucNurbs | Motion::LinuxCncNurbs | Motion::Bspline => self.spline_block(block, is_new),
            Motion::Cubic | Motion::Quadratic => {
                let cubic = self.modal.motion == Motion::Cubic;
                if self.spline_allowed(block.span).is_none() {
                    return;
                }
                if let Some((curve, smooth)) =
                    linuxcnc::bezier(self.report, &self.modal, block, cubic, continues)
                {
                    self.modal.position =
                        curve.control_points_mm.last().map_or(self.modal.position, |p| p.map(Some));
                    self.smooth = smooth;
                    self.push(curve, MoveKind::Feed, Shape::Nurbs, self.modal.feedrate_mm_per_s, block.span);
                }
            }
            _ => {}
        }
    }

    fn straight(&mut self, block: &mut Block<'_>, inverse_feed: Option<f64>) {
        let Some((start, end)) = self.ends(block) else { return };
        if start == end {
            return;
        }
        let length = (0..3).map(|axis| (end[axis] - start[axis]).powi(2)).sum::<f64>().sqrt();
        let points = vec![start, end];
        let dimension = Curve::dimension_of(&points);
        let (weights, knots) = (vec![1.0; 2], vec![0.0, 0.0, 1.0, 1.0]);
        let curve = Curve { degree: 1, control_points_mm: points, dimension, weights, knots };
        let (kind, feed) = match self.modal.motion {
            Motion::Rapid => (MoveKind::Rapid, None),
            _ => (MoveKind::Feed, self.feedrate(length, inverse_feed, block.span)),
        };
        self.push(curve, kind, Shape::Line, feed, block.span);
        self.modal.position = end.map(Some);
    }

    /// Start and end of a move by the block's coordinates; the position is brought to the end.
    fn ends(&mut self, block: &mut Block<'_>) -> Option<([f64; 3], [f64; 3])> {
        let written = block.take_axes();
        let end = self.modal.target(self.modal.here(), written);
        if end.iter().any(|x| x.abs() > MAX_COORDINATE_MM) {
            self.report
                .error(block.span, "a coordinate is out of range")
                .expected(format!("coordinates within ±{MAX_COORDINATE_MM:e} mm"));
            return None;
        }
        let start = self.modal.start(end);
        for axis in 0..3 {
            if written[axis].is_some() {
                self.modal.position[axis] = Some(end[axis]);
            }
        }
        Some((start, end))
    }

    fn arc(&mut self, block: &mut Block<'_>, clockwise: bool, inverse_feed: Option<f64>) {
        let plane = self.modal.plane;
        let [first, second, normal] = plane.axes();
        let offset = |axis: usize| [b'I', b'J', b'K'][axis];
        let radius = block.take_letter(b'R').or_else(|| block.take(Key::CircleRadius));
        let (i, j) = (block.take_letter(offset(first)), block.take_letter(offset(second)));
        if let Some(word) = block.take_letter(offset(normal)) {
            let letters = [first, second].map(|axis| char::from(offset(axis)));
            self.report
                .error(word.span, "this centre word is not in the plane of the arc")
                .expected(format!("{} and {}, or R", letters[0], letters[1]))
                .hint("G17, G18 and G19 choose the plane");
            return;
        }
        let Some((start, end)) = self.ends(block) else { return };
        let centre = |word: Option<Word>, axis: usize| match word {
            Some(word) if self.modal.absolute_centres => self.modal.mm(word.value),
            Some(word) => start[axis] + self.modal.mm(word.value),
            None => start[axis],
        };
        let circle = match (radius, i.or(j)) {
            (Some(radius), None) => Circle::Radius(self.modal.mm(radius.value)),
            (None, Some(_)) => Circle::Centre([centre(i, first), centre(j, second)]),
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
        match (ArcMove { plane, clockwise, start, end, circle }).curve() {
            Ok((curve, length)) => {
                let feed = self.feedrate(length, inverse_feed, block.span);
                if let Some(fault) = curve.faults().first() {
                    self.report.error(block.span, fault.to_string()).expected(fault.expected());
                    return;
                }
                self.push(curve, MoveKind::Feed, Shape::Arc, feed, block.span);
                self.modal.position = end.map(Some);
            }
            Err(fault) => self.refuse_arc(fault, block.span),
        }
    }

    fn refuse_arc(&mut self, fault: ArcFault, span: Span) {
        let (message, expected) = match fault {
            ArcFault::NoRadius => ("the centre of the arc is its start".into(), "a centre off the start"),
            ArcFault::EndOffCircle { start, end } => (
                format!("the end is off the circle: radius {start:.4} at the start, {end:.4} at the end"),
                "equal distances of start and end from the centre",
            ),
            ArcFault::RadiusTooSmall { radius, chord } => (
                format!("radius {radius} does not reach: start and end are {chord:.4} mm apart"),
                "a radius of at least half that distance",
            ),
            ArcFault::FullCircleByRadius => {
                ("an arc by radius ends where it starts".into(), "a full circle by its centre I, J, K")
            }
            ArcFault::TooLong => ("the helix is too high".into(), "a rise that a machine has"),
        };
        self.report.error(span, message).expected(expected);
    }

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

    fn spline_block(&mut self, block: &mut Block<'_>, is_new: bool) {
        if is_new && self.spline_allowed(block.span).is_none() {
            self.modal.motion = Motion::None;
            return;
        }
        if self.spline.is_none() {
            let spline = match self.modal.motion {
                Motion::FanucNurbs => FanucNurbs::open(self.report, block).map(Spline::Fanuc),
                Motion::LinuxCncNurbs => Some(Spline::LinuxCnc(LinuxCncNurbs::open(block.span))),
                _ => Some(Spline::Siemens(SiemensSpline::open(&self.modal, block.span))),
            };
            let Some(spline) = spline else {
                self.modal.motion = Motion::None;
                block.clear();
                return;
            };
            self.spline = Some((spline, block.span));
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
            self.spline = Some((Spline::Fanuc(next), block.span));
        }
        match &mut self.spline {
            Some((Spline::Fanuc(nurbs), _)) => nurbs.block(self.report, &mut self.modal, block),
            Some((Spline::LinuxCnc(nurbs), _)) => nurbs.block(self.report, &mut self.modal, block),
            Some((Spline::Siemens(spline), _)) => spline.block(self.report, &mut self.modal, block),
            None => {}
        }
    }

    /// Ends the spline that is open, if one is; `after` is the word that ends it.
    fn close(&mut self, after: Span) {
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

    fn push_spline(&mut self, curve: Option<Curve>, start: Span) {
        if let Some(curve) = curve {
            self.modal.position = curve.control_points_mm.last().map_or(self.modal.position, |p| p.map(Some));
            self.push(curve, MoveKind::Feed, Shape::Nurbs, self.modal.feedrate_mm_per_s, start);
        }
    }

    /// The feedrate of a move of `length` mm.
    fn feedrate(&mut self, length: f64, inverse_feed: Option<f64>, span: Span) -> Option<f64> {
        match (self.modal.feed_mode, inverse_feed) {
            (FeedMode::PerMinute, _) => self.modal.feedrate_mm_per_s,
            (FeedMode::InverseTime, Some(per_minute)) => Some(length * per_minute / 60.0),
            (FeedMode::InverseTime, None) => {
                self.report
                    .error(span, "a move in inverse time feed without F")
                    .expected("F in every block of G93");
                None
            }
        }
    }

    fn push(&mut self, curve: Curve, kind: MoveKind, shape: Shape, feedrate: Option<f64>, span: Span) {
        let line = self.line(span);
        self.part.moves.push(Move { kind, shape, feedrate_mm_per_s: feedrate, line });
        self.part.curves.push(curve);
    }

    fn line(&self, span: Span) -> usize {
        self.report.source.line_number(span.start)
    }

    /// Says the words that nobody took.
    fn refuse(&mut self, block: Block<'_>) {
        let expected = self.motion_words();
        for word in block.rest().iter() {
            let text = self.report.source.slice(word.span);
            let message = format!("`{text}` is no word of {}", self.motion_name());
            if self.options.lenient {
                self.report.warning(word.span, message);
            } else {
                self.report.error(word.span, message).expected(expected);
            }
        }
    }

    fn motion_name(&self) -> &'static str {
        match self.modal.motion {
            Motion::None => "a block without a motion",
            Motion::Rapid => "G0",
            Motion::Line => "G1",
            Motion::Arc { clockwise: true } => "G2",
            Motion::Arc { clockwise: false } => "G3",
            Motion::FanucNurbs => "G06.2",
            Motion::Cubic => "G5",
            Motion::Quadratic => "G5.1",
            Motion::LinuxCncNurbs => "G5.2",
            Motion::Bspline => "BSPLINE",
        }
    }

    fn motion_words(&self) -> &'static str {
        match self.modal.motion {
            Motion::None => "G, F, M, S, T, D or H",
            Motion::Rapid | Motion::Line => "X, Y, Z or F",
            Motion::Arc { .. } => "X, Y, Z, I, J, K, R or F",
            Motion::FanucNurbs => "K, X, Y, Z, R, P or F",
            Motion::Cubic => "X, Y, I, J, P, Q or F",
            Motion::Quadratic => "X, Y, I, J or F",
            Motion::LinuxCncNurbs => "X, Y, P, L or F",
            Motion::Bspline => "X, Y, Z, SD=, PW=, PL= or F",
        }
    }
}

/// Ten times a G number, as G06.2 is 62; `None` for finer fractions and for what no G is.
fn code(value: f64) -> Option<u16> {
    let tenths = (value * 10.0).round();
    #[allow(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "0 ..= 9999")]
    ((0.0..=9999.0).contains(&tenths) && (tenths / 10.0 - value).abs() < 1e-9).then_some(tenths as u16)
}
