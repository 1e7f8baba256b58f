//! The extruder of a 3-D printer, and coordinates that say where they count from.
//!
//! E is the length of filament that an extruder has pushed. It moves along with the path: the part keeps how far it
//! gets, and how fast. A block with E alone pushes or pulls filament while the tool rests.

use crate::auxiliary::Auxiliary;
use crate::gcode::block::Block;
use crate::gcode::known_words::{MAct, m_act_of};
use crate::gcode::reader::Reader;
use crate::gcode::word::{Count, Key};
use crate::part::Filament;
use crate::source::Span;

impl Reader<'_, '_, '_> {
    /// E: the length of filament that the block pushes.
    pub(crate) fn extruder(&mut self, block: &mut Block<'_>) {
        let is_set = self.placing.is_some();
        if let Some(word) = block.take_letter(b'E') {
            self.leave_unheld(word.span, false);
            self.extrude(block, self.modal.mm(word.value), is_set, word.span);
        }
    }

    /// Makes numbers that say where they count from, AC() and IC(), count as G90 or G91 wants those of the block, or as
    /// centres count. Where the tool is not known, a number that counts from there is dropped; on an axis that was never named it is an
    /// error, and for a lenient reader the axis is lost.
    pub(crate) fn count_as_ordered(&mut self, block: &mut Block<'_>) {
        let (mut unknown, mut begun) = (Vec::new(), [None; 3]);
        let modal = &self.modal;
        let moves_on = |letter: u8| match letter {
            b'X' | b'Y' | b'Z' => Some((usize::from(letter - b'X'), modal.incremental)),
            b'I' | b'J' | b'K' => Some((usize::from(letter - b'I'), !modal.absolute_centres)),
            _ => None,
        };
        block.change(|word| {
            let Some(count) = word.count else { return true };
            let ordered = match word.key {
                Key::Letter(letter) => moves_on(letter),
                Key::Middle(axis) => Some((axis, modal.incremental)),
                _ => None,
            };
            let Some((axis, is_incremental)) = ordered else { return true };
            let here = modal.programmed(axis);
            let is_place = !matches!(word.key, Key::Letter(b'I' | b'J' | b'K'));
            let is_never_named = is_place && modal.position[axis].is_none();
            match count {
                Count::Incremental if modal.lost[axis] => return false,
                Count::Incremental if !is_incremental && is_never_named => {
                    unknown.push((axis, word.span));
                    return false;
                }
                Count::Incremental if !is_incremental => word.value += here,
                Count::Absolute if is_incremental && is_never_named && !modal.lost[axis] => {
                    begun[axis] = Some(modal.origin(axis) + modal.mm(word.value));
                    word.value = 0.0;
                }
                Count::Absolute if is_incremental => word.value -= here,
                _ => {}
            }
            true
        });
        for (axis, begin) in begun.into_iter().enumerate().filter_map(|(axis, begin)| Some((axis, begin?))) {
            (self.modal.position[axis], self.modal.begun[axis]) = (Some(begin), Some(begin));
        }
        for (axis, span) in unknown {
            let text = self.report.source.slice(span);
            let message = format!("`{text}` counts from a place that is not known");
            let said = self.report.of_kind(!self.options.lenient, span, format!("IC {axis}"), message);
            said.expected("a move before it that names this axis");
            self.modal.lose_track(axis);
        }
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

    /// Whether a block of an M word has words that only a printer's has.
    fn has_own_words(&self, block: &Block<'_>) -> bool {
        self.options.dialect.is_none() && !block.is_empty() && !block.has_axis()
    }

    /// Takes the words that belong to a printer's M word: those behind it. Beside a G word the axes, centres and F are the move's.
    fn take_own_words(&mut self, block: &mut Block<'_>, span: Span) {
        let has_g_word = self.has_g_word;
        block.drop_words(|word| {
            let of_move = matches!(word.key, Key::Letter(letter) if b"XYZIJKEFABCUVW@^".contains(&letter));
            word.span.start > span.start && !(has_g_word && of_move)
        });
    }

    /// M words of printers. Returns whether the word was executed or does not affect the path.
    pub(crate) fn printer_word(&mut self, block: &mut Block<'_>, value: f64, span: Span) -> bool {
        let act = m_act_of(value);
        let is_unnamed = self.options.dialect.is_none();
        let shows_printer = match act {
            Some(MAct::Printer) => true,
            Some(MAct::PrinterWaits) => [109.0, 190.0].contains(&value) || self.has_own_words(block),
            Some(MAct::PrinterLimits) => is_unnamed,
            // A printer's M220 has no axes.
            Some(MAct::PrinterFeed) => is_unnamed && !block.has_axis(),
            Some(MAct::PrinterSetting) => self.has_own_words(block),
            _ => false,
        };
        if !(shows_printer || self.others.is_printer && value > 72.0) {
            return false;
        }
        self.others.is_printer = true;
        self.leave_unheld(span, true);
        match value {
            82.0 => self.others.is_relative = false,
            83.0 => self.others.is_relative = true,
            220.0 => self.feed_percentage(block, span),
            _ if act == Some(MAct::PrinterLimits) => {
                let text = self.report.source.slice(span);
                let message = format!("`{text}` sets limits of the printer: those of the machine file hold");
                self.report.of_kind(false, span, text, message).note();
            }
            _ => {}
        }
        self.take_own_words(block, span);
        // Words at which a printer waits.
        act != Some(MAct::PrinterWaits)
    }
}
