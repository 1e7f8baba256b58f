//! Axes other than X, Y and Z: rotary axes, and the extruder of a 3-D printer.
//!
//! A rotary or second linear axis (A, B, C, U, V, W) that stays at its place changes nothing. An axis that turns alone,
//! or in a rapid move, turns the part between two cuts: the machine rests there, and the path goes on in X, Y and Z. An
//! axis that moves while the tool cuts is refused, since the path would then not be that of X, Y and Z alone.
//!
//! E is the length of filament that an extruder has pushed. It moves along with the path: the part keeps how far it
//! gets, and how fast. A block with E alone pushes or pulls filament while the tool rests.

use crate::auxiliary::Auxiliary;
use crate::gcode::block::Block;
use crate::gcode::modal::Motion;
use crate::gcode::other_axes::OTHERS;
use crate::gcode::reader::Reader;
use crate::gcode::word::{Count, Key};
use crate::part::Filament;
use crate::source::Span;

impl Reader<'_, '_, '_> {
    /// Takes the words of the other axes.
    pub(crate) fn other_axes(&mut self, block: &mut Block<'_>) {
        let is_set = self.placing.is_some();
        for (index, letter) in OTHERS.into_iter().enumerate() {
            let Some(word) = block.take_letter(letter) else { continue };
            let before = self.others.rotary[index];
            let now = match before {
                Some(before) if self.modal.incremental && !is_set => before + word.value,
                _ => word.value,
            };
            self.others.rotary[index] = Some(now);
            let cuts = !matches!(self.modal.motion, Motion::Rapid | Motion::None);
            // The first number of an axis gives its place, unless the tool cuts on the way there.
            if is_set || before.unwrap_or(if cuts { 0.0 } else { now }) == now {
                continue;
            }
            let text = self.report.source.slice(word.span);
            if !cuts {
                let message = format!("`{text}` turns the part: its path is read as it runs on X, Y and Z");
                self.report.of_kind(false, word.span, letter, message);
                let (line, block) = (self.line_of(word.span), self.place(word.span).block);
                self.part.auxiliary.push(Auxiliary::new(letter, now, line, block));
            } else {
                let message = format!("`{text}` moves an axis that is not followed while the tool cuts");
                let said = self.report.of_kind(!self.options.lenient, word.span, letter, message);
                said.expected("cuts on X, Y and Z alone");
            }
        }
        if let Some(word) = block.take_letter(b'E') {
            self.leave_unheld(word.span, false);
            self.extrude(block, self.modal.mm(word.value), is_set, word.span);
        }
    }

    /// Makes numbers that say where they count from, AC() and IC(), count as G90 or G91 wants those of the block, or as
    /// centres count. Where the tool is not known, a number that counts from there is dropped.
    pub(crate) fn count_as_ordered(&mut self, block: &mut Block<'_>) {
        let modal = &self.modal;
        let moves_on = |letter: u8| match letter {
            b'X' | b'Y' | b'Z' => Some((usize::from(letter - b'X'), modal.incremental)),
            b'I' | b'J' | b'K' => Some((usize::from(letter - b'I'), !modal.absolute_centres)),
            _ => None,
        };
        block.change(|word| {
            let (Some(count), Key::Letter(letter)) = (word.count, word.key) else { return true };
            let Some((axis, is_incremental)) = moves_on(letter) else { return true };
            let here = modal.programmed(axis);
            match count {
                Count::Incremental if modal.lost[axis] => return false,
                Count::Incremental if !is_incremental => word.value += here,
                Count::Absolute if is_incremental => word.value -= here,
                _ => {}
            }
            true
        });
    }

    /// E: the length of filament in this block.
    fn extrude(&mut self, block: &Block<'_>, value: f64, is_set: bool, span: Span) {
        self.others.is_printer = true;
        let before = self.others.extruder_mm;
        let is_relative = self.others.is_relative && !is_set;
        let now = if is_relative { before + value } else { value };
        self.others.extruder_mm = now;
        let filament = self.part.filament.get_or_insert_with(Filament::default);
        filament.least_mm = filament.least_mm.min(now);
        filament.greatest_mm = filament.greatest_mm.max(now);
        if !is_set && now != before && !block.has_axis() {
            let (line, block) = (self.line_of(span), self.place(span).block);
            self.part.auxiliary.push(Auxiliary::new(b'E', now, line, block));
        }
    }

    /// M words of printers. Returns whether the word was executed or does not affect the path.
    pub(crate) fn printer_word(&mut self, block: &mut Block<'_>, value: f64, span: Span) -> bool {
        let is_its_own = [82.0, 83.0, 104.0, 106.0, 107.0, 109.0, 117.0, 140.0, 190.0].contains(&value);
        let is_setting = LIMITS.contains(&value)
            || value == 220.0
            || SETTINGS.contains(&value) && !block.is_empty() && !block.has_axis();
        let may_be_its_own = is_setting && self.options.dialect.is_none();
        if !(is_its_own || may_be_its_own || self.others.is_printer && value > 72.0) {
            return false;
        }
        self.others.is_printer = true;
        self.leave_unheld(span, true);
        match value {
            82.0 => self.others.is_relative = false,
            83.0 => self.others.is_relative = true,
            220.0 => self.feed_percentage(block, span),
            _ if LIMITS.contains(&value) => {
                let text = self.report.source.slice(span);
                let message = format!("`{text}` sets limits of the printer: those of the machine file hold");
                self.report.of_kind(false, span, text, message);
            }
            _ => {}
        }
        block.clear();
        // Words at which a printer waits.
        !WAITED_FOR.contains(&value)
    }
}

/// M words that set a printer up and have words of their own: progress, motors, filament, drives, pressure.
const SETTINGS: [f64; 24] = [
    73.0, 84.0, 92.0, 115.0, 200.0, 206.0, 207.0, 208.0, 209.0, 221.0, 301.0, 304.0, 412.0, 413.0, 420.0,
    486.0, 500.0, 569.0, 572.0, 593.0, 851.0, 900.0, 906.0, 907.0,
];
/// M words with the feeds, accelerations and jerks that a printer allows itself.
const LIMITS: [f64; 6] = [201.0, 202.0, 203.0, 204.0, 205.0, 566.0];
/// M words at which a printer rests: heat up, wait for the moves, park, change the filament.
const WAITED_FOR: [f64; 6] = [84.0, 109.0, 190.0, 191.0, 400.0, 600.0];
