//! G words: what they switch, and which motion they command.

use crate::arc::Plane;
use crate::gcode::Reader;
use crate::gcode::block::Block;
use crate::gcode::modal::{FeedMode, Motion, PathMode};
use crate::gcode::spline_move::Spline;
use crate::gcode::word::{Key, Word};
use crate::options::Dialect;
use crate::source::Span;

impl Reader<'_, '_, '_> {
    /// Takes the G words, and says which motion the block commands, if it does; `None` when the block cannot be read.
    pub(crate) fn preparatory(&mut self, block: &mut Block<'_>) -> Option<Option<Motion>> {
        let mut motion: Option<Motion> = None;
        let bspline = block.take(Key::Bspline).map(|word| (Motion::Bspline, word.span));
        let mut commands = bspline.into_iter().collect::<Vec<_>>();
        self.block_stops = false;
        let mut settings: Vec<(Setting, Span)> = Vec::new();
        while let Some(word) = block.take_letter(b'G') {
            if let Some(setting) = Setting::of(word.value) {
                if self.contradicts(setting, word.span, &settings) {
                    continue;
                }
                settings.push((setting, word.span));
            }
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
                self.modal.motion = Motion::Broken;
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

    /// Says that a word sets what an earlier one of the block sets otherwise.
    fn contradicts(&mut self, setting: Setting, span: Span, earlier: &[(Setting, Span)]) -> bool {
        let Some((_, other)) = earlier.iter().find(|(other, _)| other.contradicts(setting)) else {
            return false;
        };
        let [word, other] = [span, *other].map(|span| self.report.source.slice(span).to_owned());
        self.report
            .error(span, format!("`{other}` and `{word}`: two {} in one block", setting.group))
            .expected("one of them");
        true
    }

    /// Obeys one G word; a motion is handed back.
    fn general(&mut self, block: &mut Block<'_>, word: Word) -> Result<Option<Motion>, ()> {
        let spline_words = b"XYIJQ".iter().any(|letter| block.has(*letter));
        let dialect = self.options.dialect;
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
            Some(900) => self.absolute(word.span),
            Some(910) => self.modal.incremental = true,
            Some(901) => self.modal.absolute_centres = true,
            Some(911) => self.modal.absolute_centres = false,
            Some(930) => self.modal.feed_mode = FeedMode::InverseTime,
            Some(940) => self.modal.feed_mode = FeedMode::PerMinute,
            Some(950) => {
                self.modal.feed_mode = FeedMode::PerRevolution;
                return self.unread_word(word);
            }
            Some(800) => self.modal.motion = Motion::None,
            // The coordinate setting of lathes.
            Some(500) if block.has_axis() => return self.unread_word(word),
            // Compensation off, the first coordinate system.
            Some(400 | 490 | 540 | 500 | 690) => {}
            Some(90) if dialect != Some(Dialect::LinuxCnc) => self.block_stops = true,
            Some(610) if dialect == Some(Dialect::LinuxCnc) => self.modal.path_mode = PathMode::ExactPath,
            Some(610 | 611) => {
                self.modal.path_mode = PathMode::ExactStop;
                self.is_unsure_of_stops |= word.value == 61.0 && dialect.is_none();
            }
            // FANUC's G60 is positioning from one side, which is not read.
            Some(600) if dialect == Some(Dialect::Siemens) => self.modal.path_mode = PathMode::ExactStop,
            // When a position is reached, fine or coarse: the tool rests at all of them.
            Some(6010 | 6020 | 6030) if dialect == Some(Dialect::Siemens) => {}
            Some(640) => {
                self.modal.path_mode = PathMode::Continuous;
                let may_have = if self.may_be(&[Dialect::LinuxCnc]) { &b"PQ"[..] } else { &[] };
                if may_have.iter().filter(|letter| block.take_letter(**letter).is_some()).count() > 0 {
                    self.report.warning(word.span, "a tolerance of the path: it is taken as commanded");
                }
            }
            // Rounding at the ends of blocks.
            Some(6410 | 6420 | 6430 | 6440 | 6450) if dialect == Some(Dialect::Siemens) => {
                self.report.warning(word.span, "blocks are rounded: the path is taken as commanded");
                self.modal.path_mode = PathMode::Continuous;
            }
            // Siemens means other things by these.
            Some(620 | 630) if dialect == Some(Dialect::Fanuc) => {
                self.report
                    .warning(word.span, "a cutting mode that changes feeds: they are taken as commanded");
                self.modal.path_mode = PathMode::Continuous;
            }
            Some(40) => {
                self.report.warning(
                    word.span,
                    "a dwell: the tool rests here, and for how long is no part of the path",
                );
                for letter in *b"PXF" {
                    block.take_letter(letter);
                }
                self.rest();
            }
            Some(430) => {
                self.report.warning(word.span, "tool length compensation: the path is read as the tip's");
            }
            Some(550 | 560 | 570 | 580 | 590) => {
                self.report.warning(word.span, "another work offset: its origin is taken as the first one's");
            }
            // Settings that are no part of the path, or switch off what is not read.
            Some(970) => {}
            Some(980 | 990) if self.may_be(&[Dialect::Fanuc, Dialect::LinuxCnc]) => {}
            Some(131 | 150 | 230 | 250 | 401 | 670) if self.may_be(&[Dialect::Fanuc]) => {}
            Some(501) if self.may_be(&[Dialect::Fanuc]) && !block.has_axis() => {}
            Some(4500 | 4510 | 5000) if self.may_be(&[Dialect::Siemens]) => {}
            _ => return self.unread_word(word),
        }
        Ok(None)
    }

    /// Whether the program can be of one of these dialects.
    fn may_be(&self, dialects: &[Dialect]) -> bool {
        self.options.dialect.is_none_or(|dialect| dialects.contains(&dialect))
    }

    /// A G word that is not read: an error, or else remembered with what it leaves out of the block.
    fn unread_word(&mut self, word: Word) -> Result<Option<Motion>, ()> {
        if self.options.lenient {
            if let Some(other) = self.unread.replace(word.span) {
                let message = format!("`{}` is not read", self.report.source.slice(other));
                self.report.warning(other, message);
            }
            return Ok(moves(word.value).then_some(Motion::Unread));
        }
        let message = format!("`{}` is not read", self.report.source.slice(word.span));
        self.report
            .error(word.span, message)
            .expected("a motion, G0 to G3 or a spline, or a setting such as G17 to G21, G90, G91, G93 or G94")
            .hint("`--lenient` reads over it and says what of its block is left out");
        Err(())
    }

    /// Leaves out what is left of a block that `by` makes unreadable, or a motion that is in force and is not read.
    pub(crate) fn leave_out(&mut self, block: &mut Block<'_>, by: Option<Span>) {
        let span = by.unwrap_or(block.span);
        let word = by.map(|by| format!("`{}` is not read", self.report.source.slice(by)));
        if self.modal.motion.is_spline() {
            let message = word.unwrap_or_default();
            self.report.error(span, message).expected("no such word in a spline: its points would be others");
            block.clear();
            return;
        }
        for axis in (0..3).filter(|axis| block.has(b"XYZ"[*axis])) {
            if self.modal.position[axis].is_some() {
                self.unknown_from[axis] = self.part.curves.len();
            }
            self.modal.forget(axis);
        }
        let moves = block.has_axis();
        let words = block.texts(&self.report.source).join(" ");
        block.clear();
        let message = match word {
            Some(word) if words.is_empty() => word,
            Some(word) => format!("{word}: {words} left out of its block"),
            None if words.is_empty() => return,
            None => format!("{words} left out: the motion in force is not read"),
        };
        let warning = self.report.warning(span, message);
        if moves {
            warning.hint("where these axes are is not known until a move in G90 names them");
        }
    }

    /// G90. Where incremental words moved an axis from that was unknown matters from here on.
    fn absolute(&mut self, span: Span) {
        self.modal.incremental = false;
        let moved = std::mem::take(&mut self.modal.from_unknown);
        let letters: Vec<_> = ["X", "Y", "Z"].into_iter().zip(moved).filter(|(_, moved)| *moved).collect();
        if !letters.is_empty() {
            let letters: Vec<_> = letters.into_iter().map(|(letter, _)| letter).collect();
            let message = format!("where {} began to move by increments is not known", letters.join(", "));
            self.report
                .warning(span, message)
                .expected("a move in G90 first")
                .hint("it is taken as 0, or where it was known last");
        }
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

    /// Checks that a spline is of the program's dialect.
    fn belongs(&mut self, motion: Motion, span: Span) -> Option<()> {
        let own = match motion {
            Motion::FanucNurbs => Dialect::Fanuc,
            Motion::Cubic | Motion::Quadratic | Motion::LinuxCncNurbs => Dialect::LinuxCnc,
            Motion::Bspline => Dialect::Siemens,
            _ => return Some(()),
        };
        if own == Dialect::LinuxCnc && self.options.dialect.is_none() && self.is_unsure_of_stops {
            let said = "G61 before this was read as an exact stop at every joint; LinuxCNC's passes smooth ones, as with \
                        its dialect given";
            self.report.warning(span, said);
        }
        let dialect = *self.options.dialect.get_or_insert(own);
        if dialect == own {
            return Some(());
        }
        let text = self.report.source.slice(span).to_owned();
        self.report
            .error(span, format!("`{text}` is a spline of {own}, and the program is read as {dialect}"))
            .expected(format!("splines of {dialect} only"));
        self.modal.motion = Motion::Broken;
        None
    }
}

/// What a word of a modal group sets, of which a block has one. Words that set the same are one setting.
#[derive(Clone, Copy)]
struct Setting {
    /// What the group chooses between.
    group: &'static str,
    /// Which of them, in the order of [`GROUPS`].
    index: usize,
}

/// The modal groups besides the motions: ten times the numbers of the words of each setting.
const GROUPS: [(&str, &[&[u16]]); 6] = [
    ("planes", &[&[170], &[180], &[190]]),
    ("units", &[&[200, 700], &[210, 710]]),
    ("kinds of coordinates", &[&[900], &[910]]),
    ("kinds of arc centres", &[&[901], &[911]]),
    ("kinds of feed", &[&[930], &[940], &[950]]),
    (
        "path modes",
        &[&[600], &[610], &[611], &[620], &[630], &[640], &[6410], &[6420], &[6430], &[6440], &[6450]],
    ),
];

impl Setting {
    fn of(value: f64) -> Option<Self> {
        let code = code(value)?;
        GROUPS.iter().find_map(|(group, settings)| {
            let index = settings.iter().position(|words| words.contains(&code))?;
            Some(Self { group, index })
        })
    }

    fn contradicts(self, other: Self) -> bool {
        self.group == other.group && self.index != other.index
    }
}

/// Whether a G word that is not read is a motion that stays in force: threads, probing, cycles, and other curves.
fn moves(value: f64) -> bool {
    code(value)
        .is_some_and(|code| matches!(code / 10, 2 | 3 | 32..=35 | 38 | 73 | 74 | 76 | 81..=89 | 331 | 332))
}

/// Ten times a G number, as G06.2 is 62; `None` for finer fractions and for what no G is.
fn code(value: f64) -> Option<u16> {
    let tenths = (value * 10.0).round();
    #[allow(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "0 ..= 9999")]
    ((0.0..=9999.0).contains(&tenths) && (tenths / 10.0 - value).abs() < 1e-9).then_some(tenths as u16)
}
