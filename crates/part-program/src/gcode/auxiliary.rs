//! Words that do not move the tool: M, S, T, D and H, and calls of subprograms.

use crate::auxiliary::Auxiliary;
use crate::gcode::block::Block;
use crate::gcode::flow::Call;
use crate::gcode::known_words::{MAct, m_act_of};
use crate::gcode::reader::Reader;
use crate::gcode::word::{END_OF_SUBPROGRAM, Key, Word};
use crate::options::Dialect;
use crate::source::Span;

impl Reader<'_, '_, '_> {
    /// Takes the words that do not move the tool. Returns whether the program ends here.
    pub(crate) fn auxiliary(&mut self, block: &mut Block<'_>) -> bool {
        let mut ends = false;
        let changes_tool =
            block.words().iter().any(|word| word.key == Key::Letter(b'M') && word.value == 6.0);
        let is_named = |word: &&Word| word.key == Key::Letter(b'Q') && block.words().iter().any(is_m61);
        if let Some(word) = block.words().iter().find(is_named) {
            self.tool.loaded = Some(word.value);
        }
        for letter in *b"MSTDH" {
            while let Some(word) = block.take_letter(letter) {
                match word.value {
                    98.0 if letter == b'M' => self.call(block, word.span, None),
                    198.0 if letter == b'M' => {
                        for letter in *b"PLQ" {
                            block.take_letter(letter);
                        }
                        self.not_in_this_file(word.span, "a subprogram of another device");
                    }
                    99.0 if letter == b'M' && block.has(b'P') => {
                        ends |= !self.return_to_block(block, word.span)
                    }
                    99.0 if letter == b'M' && self.flow.is_called() => {
                        self.flow.return_from(&mut self.variables)
                    }
                    value if letter == b'M' && self.printer_word(block, value, word.span) => {}
                    value => {
                        if letter == b'M' {
                            self.take_arguments(block, value);
                        }
                        if letter == b'S' {
                            self.modal.spindle_per_minute =
                                Some(value).filter(|speed| *speed > 0.0 && !self.modal.keeps_cut_speed);
                        }
                        self.use_tool(letter, value);
                        let line = self.line_of(word.span);
                        ends |= letter == b'M' && self.is_end(value);
                        let block = self.block_number;
                        self.part.auxiliary.push(Auxiliary::new(letter, value, line, block));
                    }
                }
            }
        }
        if changes_tool {
            self.tool.loaded = self.tool.prepared.or(self.tool.loaded);
        }
        ends
    }

    /// Whether an M word ends the program.
    fn is_end(&self, value: f64) -> bool {
        let is_of_control = value != END_OF_SUBPROGRAM || self.options.dialect == Some(Dialect::Siemens);
        is_of_control && m_act_of(value) == Some(MAct::End)
    }

    /// Calls a subprogram of this file by M98 or G65.
    pub(crate) fn call(&mut self, block: &mut Block<'_>, span: Span, arguments: Option<Vec<(u32, f64)>>) {
        let program = block.take_letter(b'P').and_then(|word| whole(word.value));
        let times = block.take_letter(b'L').map_or(Some(1), |word| whole(word.value));
        block.take_letter(b'Q');
        let (Some(program), Some(times)) = (program, times) else {
            self.report
                .error(span, "a call without the number of a program")
                .expected("P with a whole number");
            return;
        };
        let call = Call { program, times, arguments, span };
        if !self.flow.call(self.report, &mut self.variables, &call) {
            self.not_in_this_file(span, &format!("subprogram O{program}"));
        }
    }

    /// `M99 P10`. Returns whether the block exists.
    fn return_to_block(&mut self, block: &mut Block<'_>, span: Span) -> bool {
        let Some(word) = block.take_letter(b'P') else { return false };
        let Some(number) = whole(word.value) else {
            self.report
                .error(word.span, "M99 with a P that is no block number")
                .expected("P with a whole number");
            return false;
        };
        self.flow.return_to(self.report, &mut self.variables, number, span.to(word.span)).is_some()
    }

    /// Takes the words that belong to an M word of LinuxCNC, or to one that turns the spindle to an angle.
    fn take_arguments(&mut self, block: &mut Block<'_>, value: f64) {
        let letters: &[u8] = match value {
            19.0 => b"RQP",
            29.0 => b"S",
            50.0..=53.0 => b"P",
            61.0 => b"Q",
            62.0..=65.0 => b"P",
            66.0 => b"PELQ",
            67.0 | 68.0 => b"EQ",
            100.0..=199.0 => b"PQ",
            _ => &[],
        };
        for letter in letters {
            if let Some(word) = block.take_letter(*letter) {
                self.unheld.add(&format!("{} of M{value}", char::from(*letter)), word.span);
            }
        }
    }

    fn not_in_this_file(&mut self, span: Span, what: &str) {
        let message = format!("{what} is not in this file");
        if self.options.lenient {
            self.report.warning(span, format!("{message}: its moves are left out"));
            self.lose_track_of_all();
        } else {
            self.report
                .error(span, message)
                .expected("its lines behind the end of the program, from O and its number to M99");
        }
    }
}

/// Whether a word is LinuxCNC's M61, whose Q is the tool in the spindle.
fn is_m61(word: &Word) -> bool {
    word.key == Key::Letter(b'M') && word.value == 61.0
}

/// A whole number of a word.
fn whole(value: f64) -> Option<u32> {
    #[allow(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "whole, 0 ..= 99,999,999")]
    ((0.0..=99_999_999.0).contains(&value) && value.fract() == 0.0).then_some(value as u32)
}
