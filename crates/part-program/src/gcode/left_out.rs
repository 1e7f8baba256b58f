//! What lenient reading leaves out, and what is not known behind it.
//!
//! A block with a word that is not read is left out whole: without this word its move may be another, or longer. The
//! axes that it names are *lost*; so are those of its plane if it may be an arc or a hole, and behind a name, a call or a G word that is
//! in no table every axis is. Nothing moves until words in G90 have named each lost axis again. What lenient reading moves is so a part
//! of what the control moves.
//!
//! Words that turn, scale or mirror the coordinates, calls at every place, and other words that change what moves mean stay in force:
//! what they shape is left out until each of them has ended.

use crate::curve::MAX_COORDINATE_MM;
use crate::gcode::block::Block;
use crate::gcode::frame::Frame;
use crate::gcode::known_words::{Act, act_of};
use crate::gcode::modal::Motion;
use crate::gcode::placing::Placing;
use crate::gcode::preparatory::code;
use crate::gcode::reader::Reader;
use crate::gcode::unread_names::NameAct;
use crate::gcode::word::{Key, Word};
use crate::options::Dialect;
use crate::source::Span;

impl Reader<'_, '_, '_> {
    /// A G word that is not read: an error; or, for a lenient reader, the words of the block that it leaves out are
    /// stored.
    pub(crate) fn unread_word(&mut self, block: &Block<'_>, word: Word) -> Result<Option<Motion>, ()> {
        if self.options.lenient {
            if let Some(other) = self.unread.replace(word.span) {
                let text = self.report.source.slice(other).to_owned();
                let message = format!("`{text}` is not read");
                self.report.of_kind(false, other, text, message);
            }
            let tenths = code(word.value).unwrap_or(0);
            if matches!(tenths, 580 | 590) {
                self.open_frame(Frame::ForEver);
            }
            let act = act_of(tenths, self.options.dialect);
            match act {
                Act::Frame(ends) => self.open_frame(Frame::Until(ends)),
                Act::Cylinder if block.words().iter().all(|word| !is_angle(word) || word.value == 0.0) => {
                    self.unread_frames.end(|frame| frame == Frame::UntilNoCylinder);
                    self.lose_track_of_all();
                }
                Act::Cylinder => self.open_frame(Frame::UntilNoCylinder),
                Act::Motion => {}
                _ => self.lose_track_of_all(),
            }
            return Ok((act == Act::Motion).then_some(Motion::Unread));
        }
        let text = self.report.source.slice(word.span);
        let message = match code(word.value) {
            Some(410 | 420) => {
                let control = self.options.dialect.map_or("this control", Dialect::name);
                format!(
                    "cutter compensation, `{text}`, is not read: {control} begins it and passes corners otherwise than LinuxCNC"
                )
            }
            Some(870) => {
                format!("`{text}` bores from behind, with a shift that the machine directs: it is not read")
            }
            _ => format!("`{text}` is not read"),
        };
        self.report
            .of_kind(true, word.span, format!("G{}", word.value), message)
            .expected("a motion, G0 to G3 or a spline, or a setting such as G17 to G21, G90, G91, G93 or G94")
            .hint("`--lenient` reads over it and says what of its block is left out");
        Err(())
    }

    /// Takes Siemens' frames: TRANS shifts, and the others without axes end what was in force.
    pub(crate) fn frame_words(&mut self, block: &mut Block<'_>) -> Option<()> {
        for adds in [false, true] {
            if let Some(word) = block.take(Key::Trans { adds }) {
                self.placing = Some((Placing::Shift { adds }, word.span));
                self.replace_frame(adds);
            }
            let Some(word) = block.take(Key::Frame { adds }) else { continue };
            if block.is_empty() && self.unread_name.is_none() {
                self.placing = Some((Placing::Shift { adds: false }, word.span));
                self.replace_frame(false);
                continue;
            }
            if !self.options.lenient {
                let text = self.report.source.slice(word.span);
                let message = format!("`{text}` turns or scales the coordinates, which is not read");
                self.report
                    .of_kind(true, word.span, text, message)
                    .expected("TRANS, or coordinates as they are");
                return None;
            }
            self.unread = Some(word.span);
            self.open_frame(Frame::UntilReplaced);
        }
        Some(())
    }

    /// A frame that does not add to the one in force ends it.
    fn replace_frame(&mut self, adds: bool) {
        if !adds {
            self.unread_frames.end(|frame| frame == Frame::UntilReplaced);
        }
    }

    pub(crate) fn open_frame(&mut self, frame: Frame) {
        self.unread_frames.open(frame);
        self.lose_track_of_all();
    }

    /// Ends the frames in force that this word ends.
    pub(crate) fn end_frame(&mut self, word: Word) {
        let Some(tenths) = code(word.value) else { return };
        self.unread_frames.end(|frame| matches!(frame, Frame::Until(ends) if ends.contains(&tenths)));
    }

    /// Executes what names of the line, which are not read, do to the moves behind them.
    pub(crate) fn obey_names(&mut self, acts: &[NameAct]) {
        for act in acts {
            match *act {
                NameAct::Motion => self.modal.motion = Motion::Unread,
                NameAct::Begins(ender) => self.open_frame(Frame::UntilName(ender)),
                NameAct::Ends(ender) => self.unread_frames.end(|frame| frame == Frame::UntilName(ender)),
            }
        }
    }

    /// A word that the motion in force does not know, and that may shape its path, for a lenient reader.
    pub(crate) fn shaping_word(&self, block: &Block<'_>) -> Option<Span> {
        let motion = self.modal.motion;
        let shapes = |word: &&Word| !motion.takes(word.key) && !motion.may_lack(word.key);
        let moves = self.placing.is_none() && (block.has_axis() || matches!(motion, Motion::Arc { .. }));
        block.words().iter().find(shapes).filter(|_| self.options.lenient && moves).map(|word| word.span)
    }

    /// From here on the place of every axis that was known is not.
    pub(crate) fn lose_track_of_all(&mut self) {
        let known = self.modal.position.map(|place| place.is_some());
        (0..3).filter(|axis| known[*axis]).for_each(|axis| self.modal.lose_track(axis));
    }

    /// Leaves out the rest of a block that `by` makes unreadable, that continues a motion that is not read, or whose
    /// coordinates are in a frame that is not read.
    pub(crate) fn leave_out(&mut self, block: &mut Block<'_>, by: Option<Span>) {
        let span = by.unwrap_or(block.span);
        let word = by.map(|by| format!("`{}` is not read", self.report.source.slice(by)));
        if self.modal.motion.is_spline() && self.spline.is_some() {
            let message = word.unwrap_or_default();
            self.report.error(span, message).expected("no such word in a spline: its points would be others");
            block.clear();
            return;
        }
        let moves = block.has_axis();
        // A name may move any axis, and so may a word that drills or mills with words of its own.
        if self.unread_name.is_some() || by.is_some() && !moves && !block.is_empty() {
            self.lose_track_of_all();
        }
        for axis in (0..3).filter(|axis| block.has(b"XYZ"[*axis])) {
            self.modal.lose_track(axis);
        }
        if block.has(b'@') || block.has(b'^') {
            (0..2).for_each(|axis| self.modal.lose_track(axis));
        }
        // An arc may end beside the axes that it names, and a hole is drilled along one that need not be named.
        let [first, second, normal] = self.modal.plane.axes();
        let beside: &[usize] = match self.modal.motion {
            Motion::None | Motion::Rapid | Motion::Line | Motion::Unread => &[],
            Motion::Cycle(_) => &[first, second, normal],
            _ => &[first, second],
        };
        if !block.is_empty() {
            beside.iter().for_each(|axis| self.modal.lose_track(*axis));
        }
        self.forget_the_last_move();
        if let Some((
            Placing::SetOffset | Placing::SetPosition | Placing::MoveOrigin | Placing::Shift { .. },
            _,
        )) = self.placing.take()
        {
            self.open_frame(Frame::ForEver);
        }
        let words = block.texts(&self.report.source).join(" ");
        block.clear();
        let (kind, message) = match word {
            Some(word) if words.is_empty() => (word.clone(), word),
            Some(word) => (word.clone(), format!("{word}: {words} left out of its block")),
            None if words.is_empty() => return,
            None if self.modal.motion == Motion::Unread => {
                ("motion".into(), format!("{words} left out: the motion in force is not read"))
            }
            None => ("frame".into(), format!("{words} left out: where these coordinates are is not read")),
        };
        let warning = self.report.of_kind(false, span, kind, message);
        if moves {
            warning.hint("where these axes are is not known until a move in G90 names them");
        }
    }

    /// What a block shapes by the move before it no longer does: that move was left out.
    pub(crate) fn forget_the_last_move(&mut self) {
        self.goes_on = false;
        (self.corner, self.smooth) = (None, None);
        self.lose_compensation();
    }

    /// A move from a place that is not known is left out; from its end on the axes are known that it names.
    pub(crate) fn find_again(&mut self, block: &mut Block<'_>, is_new: bool) {
        let (motion, span) = (self.modal.motion, block.span);
        if motion.is_spline() && is_new {
            self.modal.motion = Motion::Broken;
        }
        self.forget_the_last_move();
        let is_polar = block.has(b'@') || block.has(b'^');
        let [first, second, normal] = self.modal.plane.axes();
        // What moves these axes does not name their end: a polar place, the angle of an arc, a repeated step.
        let is_repeated = matches!(motion, Motion::Cycle(_)) && (block.has(b'L') || block.has(b'K'));
        let by_angle = block.words().iter().any(|word| word.key == Key::ArcAngle);
        let mut written = block.take_axes();
        if by_angle || is_repeated && self.modal.incremental {
            [first, second].into_iter().for_each(|axis| self.modal.lose_track(axis));
        }
        if is_polar {
            (0..2).for_each(|axis| self.modal.lose_track(axis));
        }
        if let Motion::Cycle(_) = motion {
            self.holes.keep(written[normal].take(), block);
            // It ends above the hole.
            self.modal.lose_track(normal);
        }
        let moves = written != [None; 3] || !block.is_empty();
        // G33.1 comes back to where it began.
        let comes_back = motion == Motion::WithSpindle { comes_back: true };
        if !is_polar && !comes_back {
            let end = self.modal.target(self.modal.here(), written);
            if end.iter().all(|x| x.abs() <= MAX_COORDINATE_MM) {
                self.modal.arrive(written, end);
            }
        }
        block.clear();
        if !self.modal.is_lost() {
            // However the axes came there: the way is one from an unknown place.
            self.approach([None; 3], span);
        }
        if moves && (self.modal.is_lost() || !matches!(motion, Motion::Rapid | Motion::Line)) {
            let message = "left out: where the tool is is not known, since a block before it was left out";
            self.report.of_kind(false, span, "lost", message);
        }
    }
}

/// Whether a word is an angle, or a radius, of coordinates on a cylinder.
fn is_angle(word: &Word) -> bool {
    matches!(word.key, Key::Letter(b'A' | b'B' | b'C' | b'R' | b'Q'))
}
