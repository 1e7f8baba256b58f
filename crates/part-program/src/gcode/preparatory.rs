//! G words: the settings that they change, and the motions that they command.

use crate::arc::Plane;
use crate::exact_stops::PathMode;
use crate::gcode::block::Block;
use crate::gcode::cycle::Cycle;
use crate::gcode::known_words::{Act, act_of};
use crate::gcode::modal::{FeedMode, Motion};
use crate::gcode::reader::Reader;
use crate::gcode::spline::Spline;
use crate::gcode::word::{Key, Word};
use crate::options::{Dialect, Unit};
use crate::path_tolerance::PathTolerance;
use crate::source::Span;
use crate::unit::INCH;

impl Reader<'_, '_, '_> {
    /// Takes the G words. Returns the motion that the block commands, if it does; `None` if the block cannot be read.
    pub(crate) fn preparatory(&mut self, block: &mut Block<'_>) -> Option<Option<Motion>> {
        let mut motion: Option<Motion> = None;
        const NAMED: [(Key, Motion); 3] = [
            (Key::Bspline, Motion::Bspline),
            (Key::ThroughPoint, Motion::ThroughPoint),
            (Key::Tangent, Motion::Tangent),
        ];
        let named = NAMED.into_iter().filter_map(|(key, motion)| Some((motion, block.take(key)?.span)));
        let mut commands = named.collect::<Vec<_>>();
        self.block_stops = false;
        self.frame_words(block)?;
        let mut settings: Vec<(Setting, Span)> = Vec::new();
        while let Some(word) = block.take_letter(b'G') {
            if let Some(setting) = Setting::of(word.value) {
                if self.contradicts(setting, word.span, &settings) {
                    continue;
                }
                settings.push((setting, word.span));
            }
            if let Some((Spline::Fanuc(nurbs), _)) = &self.spline
                && !(word.value == 6.2 && nurbs.goes_on_with(block))
            {
                self.close(word.span);
            }
            self.end_frame(word);
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
            self.belongs(block, command, span)?;
            let goes_on = matches!(
                (command, &self.spline),
                (Motion::LinuxCncNurbs, Some((Spline::LinuxCnc(_), _)))
                    | (Motion::Bspline, Some((Spline::Siemens(_), _)))
                    | (Motion::FanucNurbs, Some((Spline::Fanuc(_), _)))
            );
            if !goes_on {
                self.close(span);
            }
            motion = Some(command);
        }
        Some(motion)
    }

    /// Reports a word that contradicts an earlier word of the block.
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

    /// Executes one G word; a motion is returned.
    fn general(&mut self, block: &mut Block<'_>, word: Word) -> Result<Option<Motion>, ()> {
        let Some(tenths) = code(word.value) else { return self.unread_word(block, word) };
        if let Some(reason) = self.turning(block, tenths) {
            self.refuse_lathe(word.span, reason);
            return Err(());
        }
        match act_of(tenths, self.options.dialect) {
            Act::Read | Act::Foreign => {}
            Act::Pass(letters) => {
                for letter in letters {
                    block.take_letter(*letter);
                }
                self.leave_unheld(word.span, true);
                return Ok(None);
            }
            Act::Off => return Ok(None),
            Act::Frame(_) | Act::Cylinder | Act::Motion | Act::Leave | Act::Lathe => {
                return self.unread_word(block, word);
            }
        }
        if let Some(placing) = self.placing(block, word) {
            self.placing = Some((placing, word.span));
            return Ok(None);
        }
        if let Some(motion) = self.motion_word(block, tenths) {
            return Ok(Some(motion));
        }
        if self.mode(block, word, tenths)?
            || self.stop_or_path_mode(block, word, tenths)
            || self.is_aside(block, word, tenths)
        {
            return Ok(None);
        }
        self.unread_word(block, word)
    }

    /// The feature that shows that a program is for a lathe: its diameters, speeds or cycles.
    fn turning(&self, block: &Block<'_>, tenths: u16) -> Option<&'static str> {
        let has_contour = block.has(b'P') && block.has(b'Q') || block.has(b'U') && block.has(b'R');
        match tenths {
            700 | 710 if matches!(self.options.dialect, Some(Dialect::Fanuc | Dialect::LinuxCnc)) => {
                Some("G70 to G72 turn a contour")
            }
            70 if self.options.dialect != Some(Dialect::Fanuc) => Some("G7 makes X a diameter"),
            500 if block.has(b'S') => Some("G50 with S limits the speed of the spindle"),
            700..=723 if has_contour || block.has(b'D') => Some("G70 to G72 turn a contour"),
            700..=723 if !tenths.is_multiple_of(10) => Some("G70 to G72 turn a contour"),
            760 if block.has(b'P') && !block.has(b'X') && !block.has(b'Y') => Some("G76 cuts a thread"),
            _ => None,
        }
    }

    /// Says that a program is for a lathe, and nothing else of it.
    pub(crate) fn refuse_lathe(&mut self, span: Span, reason: &str) {
        self.report.forget_errors();
        self.report
            .error(span, format!("this is a program for a lathe: {reason}"))
            .expected("a program for a mill: a lathe's X may be a diameter, and its feed one a revolution");
        self.ended = true;
    }

    /// G96: S is the speed of the cut, and the spindle's follows from where X is.
    fn keeps_cut_speed(&mut self, span: Span) {
        self.modal.keeps_cut_speed = true;
        self.leave_unheld(span, true);
        self.modal.spindle_per_minute = None;
        self.cut_speed_from.get_or_insert(span);
        let message = "the speed of the cut is kept, G96: that of the spindle is not known";
        self.report
            .of_kind(false, span, "G96", message)
            .hint("a feed per revolution, G95, is not known there");
    }

    /// The motion that a word commands.
    fn motion_word(&mut self, block: &Block<'_>, tenths: u16) -> Option<Motion> {
        let spline_words = b"XYZIJKQ".iter().any(|letter| block.has(*letter));
        Some(match tenths {
            0 => Motion::Rapid,
            10 => Motion::Line,
            20 => Motion::Arc { clockwise: true },
            30 => Motion::Arc { clockwise: false },
            62 => Motion::FanucNurbs,
            50 if spline_words => Motion::Cubic,
            // FANUC's G05.1 has a Q, and may name the axes that it smooths.
            51 if !block.has(b'Q')
                && (b"IJK".iter().any(|letter| block.has(*letter)) || block.has_axis()) =>
            {
                Motion::Quadratic
            }
            52 => Motion::LinuxCncNurbs,
            330 => Motion::WithSpindle { comes_back: false },
            331 => Motion::WithSpindle { comes_back: true },
            _ => Motion::Cycle(Cycle::of(tenths)?),
        })
    }

    /// Planes, units, coordinates and feeds. Returns whether the word is one of them.
    fn mode(&mut self, block: &mut Block<'_>, word: Word, tenths: u16) -> Result<bool, ()> {
        match tenths {
            50 => self.high_precision(block, word)?,
            51 if block.has(b'Q') => {
                for letter in *b"QRXYZ" {
                    block.take_letter(letter);
                }
            }
            53 => self.end_of_linuxcnc_nurbs(word.span),
            170 => self.choose_plane(Plane::Xy, word.span)?,
            180 => self.choose_plane(Plane::Zx, word.span)?,
            190 => self.choose_plane(Plane::Yz, word.span)?,
            400 => self.end_compensation(),
            410 | 411 | 420 | 421 => self.begin_compensation(block, word, tenths)?,
            200 | 210 => self.units(tenths == 200, tenths == 200),
            7000 | 7100 => self.units(tenths == 7000, tenths == 7000),
            // Haas drills circles of holes with these words.
            700 | 710 if !b"IJL".iter().any(|letter| block.has(*letter)) => {
                self.units(tenths == 700, self.options.unit == Some(Unit::Inch));
            }
            // With axes Siemens' words shift the coordinates.
            580 | 590 if self.options.dialect == Some(Dialect::Siemens) && block.has_axis() => {
                return Ok(false);
            }
            540..=590 if tenths.is_multiple_of(10) => {
                self.choose_work_offset(offset_of(tenths / 10 - 54), word.span)
            }
            591..=593 => self.choose_work_offset(offset_of(tenths - 585), word.span),
            900 => self.absolute(word.span),
            910 => self.modal.incremental = true,
            901 => self.modal.absolute_centres = true,
            911 => self.modal.absolute_centres = false,
            921..=923 if !self.is_barred(word.span, "another shift of the coordinates") => {
                self.change_shift(tenths);
            }
            921..=923 => {}
            960 => {
                block.take_letter(b'D');
                self.keeps_cut_speed(word.span);
            }
            970 => self.modal.keeps_cut_speed = false,
            930 => self.modal.feed_mode = FeedMode::InverseTime,
            940 => self.modal.feed_mode = FeedMode::PerMinute,
            950 => self.modal.feed_mode = FeedMode::PerRevolution,
            800 => {
                self.modal.motion = Motion::None;
                self.holes.end();
            }
            980 | 990 => {
                self.holes.returns_to_begin = Some(tenths == 980);
            }
            650 if block.has(b'P') => self.call_macro(block, word.span),
            _ => return Ok(false),
        }
        Ok(true)
    }

    fn choose_plane(&mut self, plane: Plane, span: Span) -> Result<(), ()> {
        if plane != self.modal.plane && self.is_barred(span, "another plane") {
            return Err(());
        }
        self.modal.plane = plane;
        Ok(())
    }

    /// Whether lengths are in inches, and whether F is.
    fn units(&mut self, of_lengths: bool, of_feed: bool) {
        (self.modal.inches, self.modal.feed_in_inches) = (of_lengths, of_feed);
        self.names_unit = true;
    }

    /// `G65 P9000 A1 B2`: the letters are variables of the subprogram.
    fn call_macro(&mut self, block: &mut Block<'_>, span: Span) {
        const LETTERS: [(u8, u32); 21] = [
            (b'A', 1),
            (b'B', 2),
            (b'C', 3),
            (b'I', 4),
            (b'J', 5),
            (b'K', 6),
            (b'D', 7),
            (b'E', 8),
            (b'F', 9),
            (b'H', 11),
            (b'M', 13),
            (b'Q', 17),
            (b'R', 18),
            (b'S', 19),
            (b'T', 20),
            (b'U', 21),
            (b'V', 22),
            (b'W', 23),
            (b'X', 24),
            (b'Y', 25),
            (b'Z', 26),
        ];
        let arguments = LETTERS
            .into_iter()
            .filter_map(|(letter, number)| block.take_letter(letter).map(|word| (number, word.value)));
        let arguments = arguments.collect();
        self.call(block, span, Some(arguments));
    }

    /// The mode for ends of moves, and dwells. Returns whether the word is one of them.
    fn stop_or_path_mode(&mut self, block: &mut Block<'_>, word: Word, tenths: u16) -> bool {
        let dialect = self.options.dialect;
        match tenths {
            90 => self.block_stops = true,
            610 if dialect == Some(Dialect::LinuxCnc) => self.modal.path_mode = PathMode::ExactPath,
            610 | 611 => {
                self.modal.path_mode = PathMode::ExactStop;
                self.is_unsure_of_stops |= word.value == 61.0 && dialect.is_none();
            }
            600 => self.modal.path_mode = PathMode::ExactStop,
            640 => {
                self.modal.path_mode = PathMode::Continuous(self.path_tolerance(block, word.span));
            }
            // Rounding at the ends of blocks.
            6410 | 6420 | 6430 | 6440 | 6450 => {
                self.report.warning(word.span, "blocks are rounded: the path is taken as commanded").note();
                self.modal.path_mode = PathMode::Continuous(None);
            }
            620 | 630 => {
                self.report
                    .warning(word.span, "a cutting mode that changes feeds: they are taken as commanded")
                    .note();
                self.modal.path_mode = PathMode::Continuous(None);
            }
            40 => {
                let said = "a dwell: the tool rests here, and for how long is no part of the path";
                self.report.warning(word.span, said).note();
                // LinuxCNC's time is P, FANUC's P or X, Siemens' F or S.
                let letters: &[u8] = match dialect {
                    Some(Dialect::LinuxCnc) => b"P",
                    None if block.has(b'P') => b"P",
                    Some(Dialect::Fanuc) => b"PX",
                    _ => b"PXFS",
                };
                for letter in letters {
                    block.take_letter(*letter);
                }
                self.rest();
                self.leave_unheld(word.span, true);
            }
            _ => return false,
        }
        true
    }

    /// Whether a word does not affect the path in this block.
    fn is_aside(&mut self, block: &mut Block<'_>, word: Word, tenths: u16) -> bool {
        match tenths {
            // G50 with axes is the coordinate setting of lathes.
            500 | 501 => !block.has_axis(),
            // A printer measures its bed; FANUC's G29 has axes.
            290 if self.others.is_printer || self.options.dialect.is_none() && !block.has_axis() => {
                block.clear();
                self.leave_unheld(word.span, true);
                true
            }
            // It pulls and pushes filament.
            100 | 110 if self.others.is_printer => {
                self.leave_unheld(word.span, true);
                true
            }
            _ => false,
        }
    }

    /// Whether the program can be in one of these dialects.
    fn may_be(&self, dialects: &[Dialect]) -> bool {
        self.options.dialect.is_none_or(|dialect| dialects.contains(&dialect))
    }

    /// G90. If incremental words moved an axis from an unknown place, that place matters from here on.
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

    /// The tolerance that a G64 states, of which only LinuxCNC's does.
    fn path_tolerance(&mut self, block: &mut Block<'_>, span: Span) -> Option<PathTolerance> {
        if !self.may_be(&[Dialect::LinuxCnc]) {
            return None;
        }
        let [p, q] = [b'P', b'Q'].map(|letter| block.take_letter(letter));
        if p.or(q).is_some() {
            self.report.warning(span, "a tolerance of the path: it is taken as commanded").note();
        }
        // G20 and G21 are obeyed before G64, wherever they are in the block.
        let of_block = block.words().iter().filter(|word| word.key == Key::Letter(b'G'));
        let mut inches = of_block.filter_map(|word| match code(word.value) {
            Some(200) => Some(true),
            Some(210) => Some(false),
            _ => None,
        });
        let unit_mm = if inches.next_back().unwrap_or(self.modal.inches) { INCH } else { 1.0 };
        let [p_mm, q_mm] = [p, q].map(|word| word.map(|word| unit_mm * word.value));
        PathTolerance::of(p_mm, q_mm)
    }

    /// Checks that a curve is of the program's dialect.
    fn belongs(&mut self, block: &Block<'_>, motion: Motion, span: Span) -> Option<()> {
        let own = match motion {
            Motion::FanucNurbs if block.has(b'Q') || self.options.dialect == Some(Dialect::LinuxCnc) => {
                Dialect::LinuxCnc
            }
            Motion::FanucNurbs => Dialect::Fanuc,
            Motion::Cubic | Motion::Quadratic | Motion::LinuxCncNurbs => Dialect::LinuxCnc,
            Motion::Bspline | Motion::ThroughPoint | Motion::Tangent => Dialect::Siemens,
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
            .error(
                span,
                format!("`{text}` is a {} of {own}, and the program is read as {dialect}", motion.kind()),
            )
            .expected(format!("words of {dialect} only"));
        self.modal.motion = Motion::Broken;
        None
    }
}

/// The setting of a modal group, of which a block has one. Words with the same effect are one setting.
#[derive(Clone, Copy)]
struct Setting {
    /// The subject of the group.
    group: &'static str,
    /// Index of the setting, in the order of [`GROUPS`].
    index: usize,
}

/// The modal groups other than the motions: for each setting, ten times the numbers of its words.
const GROUPS: [(&str, &[&[u16]]); 6] = [
    ("planes", &[&[170], &[180], &[190]]),
    ("units", &[&[200, 700], &[210, 710], &[7000], &[7100]]),
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

/// Ten times a G number: 62 for G06.2. `None` for finer fractions and for numbers that no G word has.
pub(crate) fn code(value: f64) -> Option<u16> {
    let tenths = (value * 10.0).round();
    #[allow(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "0 ..= 9999")]
    ((0.0..=9999.0).contains(&tenths) && (tenths / 10.0 - value).abs() < 1e-9).then_some(tenths as u16)
}

/// The index of a work offset.
fn offset_of(index: u16) -> u8 {
    u8::try_from(index).unwrap_or(0)
}
