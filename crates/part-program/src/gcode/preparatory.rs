//! G words: the settings that they change, and the motions that they command.

use crate::arc::Plane;
use crate::exact_stops::PathMode;
use crate::gcode::block::Block;
use crate::gcode::cycle::Cycle;
use crate::gcode::modal::{FeedMode, Motion};
use crate::gcode::reader::Reader;
use crate::gcode::spline::Spline;
use crate::gcode::word::{Key, Word};
use crate::options::Dialect;
use crate::source::Span;

impl Reader<'_, '_, '_> {
    /// Takes the G words. Returns the motion that the block commands, if it does; `None` if the block cannot be read.
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
            if let Some((Spline::Fanuc(nurbs), _)) = &self.spline
                && !(word.value == 6.2 && nurbs.goes_on_with(block))
            {
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
        let Some(tenths) = code(word.value) else { return self.unread_word(word) };
        if let Some(reason) = self.turning(block, tenths) {
            self.report.error(word.span, format!("this is a program for a lathe: {reason}")).expected(
                "a program for a mill: a lathe's X may be a diameter, and its feed one a revolution",
            );
            return Err(());
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
            || self.is_aside(block, tenths)
        {
            return Ok(None);
        }
        self.unread_word(word)
    }

    /// The feature that shows that a program is for a lathe: its diameters, speeds or cycles.
    fn turning(&self, block: &Block<'_>, tenths: u16) -> Option<&'static str> {
        let has_contour = block.has(b'P') && block.has(b'Q') || block.has(b'U') && block.has(b'R');
        match tenths {
            700 | 710 if self.options.dialect == Some(Dialect::Fanuc) => Some("G70 to G72 turn a contour"),
            70 if self.options.dialect != Some(Dialect::Fanuc) => Some("G7 makes X a diameter"),
            960 => Some("G96 keeps the speed of the cut"),
            500 if block.has(b'S') => Some("G50 with S limits the speed of the spindle"),
            700..=723 if has_contour || block.has(b'D') => Some("G70 to G72 turn a contour"),
            700..=723 if !tenths.is_multiple_of(10) => Some("G70 to G72 turn a contour"),
            760 if block.has(b'P') && !block.has(b'X') && !block.has(b'Y') => Some("G76 cuts a thread"),
            _ => None,
        }
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
            51 if b"IJK".iter().any(|letter| block.has(*letter)) || block.has_axis() => Motion::Quadratic,
            52 => Motion::LinuxCncNurbs,
            330 => Motion::WithSpindle { comes_back: false },
            331 if self.may_be(&[Dialect::LinuxCnc]) => Motion::WithSpindle { comes_back: true },
            _ => Motion::Cycle(Cycle::of(tenths)?),
        })
    }

    /// Planes, units, coordinates and feeds. Returns whether the word is one of them.
    fn mode(&mut self, block: &mut Block<'_>, word: Word, tenths: u16) -> Result<bool, ()> {
        match tenths {
            50 => self.high_precision(block, word)?,
            51 if block.has(b'Q') => drop(block.take_letter(b'Q')),
            53 => self.end_of_linuxcnc_nurbs(word.span),
            80 if block.has(b'P') => drop(block.take_letter(b'P')),
            170 => self.modal.plane = Plane::Xy,
            180 => self.modal.plane = Plane::Zx,
            190 => self.modal.plane = Plane::Yz,
            200 | 700 => self.modal.inches = true,
            210 | 710 => self.modal.inches = false,
            540..=590 if tenths.is_multiple_of(10) => {
                self.choose_work_offset(offset_of(tenths / 10 - 54), word.span)
            }
            591..=593 => self.choose_work_offset(offset_of(tenths - 585), word.span),
            900 => self.absolute(word.span),
            910 => self.modal.incremental = true,
            901 => self.modal.absolute_centres = true,
            911 => self.modal.absolute_centres = false,
            921..=923 => self.change_shift(tenths),
            930 => self.modal.feed_mode = FeedMode::InverseTime,
            940 => self.modal.feed_mode = FeedMode::PerMinute,
            950 => self.modal.feed_mode = FeedMode::PerRevolution,
            800 => {
                self.modal.motion = Motion::None;
                self.holes.end();
            }
            980 | 990 if self.may_be(&[Dialect::Fanuc, Dialect::LinuxCnc]) => {
                self.holes.returns_to_begin = Some(tenths == 980);
            }
            650 if block.has(b'P') => self.call_macro(block, word.span),
            _ => return Ok(false),
        }
        if matches!(tenths, 200 | 700 | 210 | 710) {
            self.names_unit = true;
        }
        Ok(true)
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
            90 if dialect != Some(Dialect::LinuxCnc) => self.block_stops = true,
            610 if dialect == Some(Dialect::LinuxCnc) => self.modal.path_mode = PathMode::ExactPath,
            610 | 611 => {
                self.modal.path_mode = PathMode::ExactStop;
                self.is_unsure_of_stops |= word.value == 61.0 && dialect.is_none();
            }
            // FANUC's G60 is positioning from one side, which is not read.
            600 if dialect == Some(Dialect::Siemens) => self.modal.path_mode = PathMode::ExactStop,
            // The window, fine or coarse, within which a position counts as reached: the tool rests with each of them.
            6010 | 6020 | 6030 if dialect == Some(Dialect::Siemens) => {}
            640 => {
                self.modal.path_mode = PathMode::Continuous;
                let may_have = if self.may_be(&[Dialect::LinuxCnc]) { &b"PQ"[..] } else { &[] };
                if may_have.iter().filter(|letter| block.take_letter(**letter).is_some()).count() > 0 {
                    let said = "a tolerance of the path: it is taken as commanded";
                    self.report.warning(word.span, said).note();
                }
            }
            // Rounding at the ends of blocks.
            6410 | 6420 | 6430 | 6440 | 6450 if dialect == Some(Dialect::Siemens) => {
                self.report.warning(word.span, "blocks are rounded: the path is taken as commanded").note();
                self.modal.path_mode = PathMode::Continuous;
            }
            // In Siemens programs these words have other meanings.
            620 | 630 if dialect == Some(Dialect::Fanuc) => {
                self.report
                    .warning(word.span, "a cutting mode that changes feeds: they are taken as commanded")
                    .note();
                self.modal.path_mode = PathMode::Continuous;
            }
            40 => {
                let said = "a dwell: the tool rests here, and for how long is no part of the path";
                self.report.warning(word.span, said).note();
                for letter in *b"PXFS" {
                    block.take_letter(letter);
                }
                self.rest();
            }
            _ => return false,
        }
        true
    }

    /// Whether a word is a setting that does not affect the path, or switches off a function that is not read.
    fn is_aside(&mut self, block: &Block<'_>, tenths: u16) -> bool {
        match tenths {
            // The coordinate setting of lathes.
            500 => !block.has_axis(),
            400 | 490 | 690 | 970 | 430 => true,
            // Of printers: the bed is measured, filament is pulled and pushed.
            290 | 100 | 110 if self.others.is_printer => true,
            80 => self.may_be(&[Dialect::LinuxCnc]),
            131 | 150 | 230 | 250 | 401 | 670 => self.may_be(&[Dialect::Fanuc]),
            501 => self.may_be(&[Dialect::Fanuc]) && !block.has_axis(),
            4500 | 4510 | 5000 => self.may_be(&[Dialect::Siemens]),
            _ => false,
        }
    }

    /// Whether the program can be in one of these dialects.
    fn may_be(&self, dialects: &[Dialect]) -> bool {
        self.options.dialect.is_none_or(|dialect| dialects.contains(&dialect))
    }

    /// A G word that is not read: an error; or, for a lenient reader, the words of the block that it leaves out are
    /// stored.
    fn unread_word(&mut self, word: Word) -> Result<Option<Motion>, ()> {
        if self.options.lenient {
            if let Some(other) = self.unread.replace(word.span) {
                let text = self.report.source.slice(other).to_owned();
                let message = format!("`{text}` is not read");
                self.report.of_kind(false, other, text, message);
            }
            return Ok(moves(word.value).then_some(Motion::Unread));
        }
        let text = self.report.source.slice(word.span);
        let message = if matches!(code(word.value), Some(410..=429)) {
            format!("cutter compensation, `{text}`, is not read")
        } else {
            format!("`{text}` is not read")
        };
        self.report
            .of_kind(true, word.span, format!("G{}", word.value), message)
            .expected("a motion, G0 to G3 or a spline, or a setting such as G17 to G21, G90, G91, G93 or G94")
            .hint("`--lenient` reads over it and says what of its block is left out");
        Err(())
    }

    /// Leaves out the rest of a block that `by` makes unreadable, or that continues a motion that is not read.
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

    /// Checks that a spline is of the program's dialect.
    fn belongs(&mut self, block: &Block<'_>, motion: Motion, span: Span) -> Option<()> {
        let own = match motion {
            Motion::FanucNurbs if block.has(b'Q') || self.options.dialect == Some(Dialect::LinuxCnc) => {
                Dialect::LinuxCnc
            }
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
    code(value).is_some_and(|code| matches!(code / 10, 2 | 3 | 32..=35 | 38 | 76 | 87 | 331 | 332))
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
