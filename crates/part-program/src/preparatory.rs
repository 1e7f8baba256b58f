//! G words: what they switch, and which motion they command.

use crate::arc::Plane;
use crate::block::Block;
use crate::gcode::Reader;
use crate::gcode_word::{Key, Word};
use crate::modal::{FeedMode, Motion};
use crate::options::Dialect;
use crate::source::Span;
use crate::spline_move::Spline;

impl Reader<'_, '_, '_> {
    /// Takes the G words, and says which motion the block commands, if it does; `None` when the block cannot be read.
    pub(crate) fn preparatory(&mut self, block: &mut Block<'_>) -> Option<Option<Motion>> {
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
            Some(900) => self.absolute(word.span),
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

    /// G90. What incremental words moved first is counted from 0, and from here on that matters.
    fn absolute(&mut self, span: Span) {
        self.modal.incremental = false;
        let from_zero = std::mem::take(&mut self.modal.from_zero);
        let letters: Vec<_> = ["X", "Y", "Z"]
            .into_iter()
            .zip(from_zero)
            .filter(|(_, it)| *it)
            .map(|(letter, _)| letter)
            .collect();
        if !letters.is_empty() {
            let message =
                format!("{} moved by increments first: taken to have begun at 0", letters.join(", "));
            self.report.warning(span, message);
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
}

/// Ten times a G number, as G06.2 is 62; `None` for finer fractions and for what no G is.
fn code(value: f64) -> Option<u16> {
    let tenths = (value * 10.0).round();
    #[allow(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "0 ..= 9999")]
    ((0.0..=9999.0).contains(&tenths) && (tenths / 10.0 - value).abs() < 1e-9).then_some(tenths as u16)
}
