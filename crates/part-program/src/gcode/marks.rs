//! Where the labels, block numbers and loop ends of a program stand, to which commands lead.

use std::collections::HashMap;

use crate::diagnostic::Report;
use crate::gcode::command::{Keyword, Label};

/// The lines that labels and numbers mark; lines count from 0.
#[derive(Default)]
pub(crate) struct Marks {
    /// The O-words of each label, with their keyword; `None` begins a program.
    pub(crate) words: HashMap<Label, Vec<(usize, Option<Keyword>)>>,
    /// The lines of each block number.
    pub(crate) blocks: HashMap<u32, Vec<usize>>,
    /// FANUC's ENDs, by the number of the loop.
    pub(crate) ends: HashMap<u32, Vec<usize>>,
}

impl Marks {
    /// Looks for them in all lines.
    pub(crate) fn of(report: &Report<'_>) -> Self {
        let mut marks = Self::default();
        for line in 0..report.source.lines() {
            marks.line(line, report.source.line(line).1);
        }
        marks
    }

    fn line(&mut self, line: usize, text: &str) {
        let mut text = text.trim_start().trim_start_matches('/').trim_start();
        if let Some(rest) = text.strip_prefix(['N', 'n']) {
            let (number, rest) = leading_number(rest.trim_start());
            if let Some(number) = number {
                self.blocks.entry(number).or_default().push(line);
            }
            text = rest.trim_start();
        }
        if let Some(rest) = text.strip_prefix(['O', 'o']) {
            self.o_word(line, rest.trim_start());
        } else if text.get(..3).is_some_and(|word| word.eq_ignore_ascii_case("END"))
            && let (Some(number), _) = leading_number(text[3..].trim_start())
        {
            self.ends.entry(number).or_default().push(line);
        }
    }

    fn o_word(&mut self, line: usize, text: &str) {
        let (label, rest) = match text.strip_prefix('<').and_then(|text| text.split_once('>')) {
            Some((name, rest)) => (Label::named(name), rest),
            None => match leading_number(text) {
                (Some(number), rest) => (Label::Number(number), rest),
                _ => return,
            },
        };
        let rest = rest.trim_start();
        let letters = rest.bytes().take_while(u8::is_ascii_alphabetic).count();
        self.words.entry(label).or_default().push((line, Keyword::of(&rest[..letters])));
    }
}

/// The digits that a text begins with, as a number, and what follows them.
fn leading_number(text: &str) -> (Option<u32>, &str) {
    let digits = text.bytes().take_while(u8::is_ascii_digit).count();
    (text[..digits].parse().ok(), &text[digits..])
}
