//! The places of a program's labels, block numbers and loop ends, to which commands lead.

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
    /// The lines on which programs begin.
    pub(crate) programs: Vec<usize>,
    /// FANUC's ENDs, by the number of the loop.
    pub(crate) ends: HashMap<u32, Vec<usize>>,
}

impl Marks {
    /// Searches all lines for marks.
    pub(crate) fn of(report: &Report<'_>) -> Self {
        let mut marks = Self::default();
        for line in 0..report.source.lines() {
            marks.line(line, report.source.line(line).1);
        }
        marks
    }

    fn line(&mut self, line: usize, text: &str) {
        let (number, text) = numbered(text);
        if let Some(number) = number {
            self.blocks.entry(number).or_default().push(line);
        }
        if let Some((label, keyword)) = labelled(text) {
            let letters = keyword.bytes().take_while(u8::is_ascii_alphabetic).count();
            let keyword = Keyword::of(&keyword[..letters]);
            if keyword.is_none() {
                self.programs.push(line);
            }
            self.words.entry(label).or_default().push((line, keyword));
        } else if text.get(..3).is_some_and(|word| word.eq_ignore_ascii_case("END"))
            && let (Some(number), _) = leading_number(text[3..].trim_start())
        {
            self.ends.entry(number).or_default().push(line);
        }
    }
}

impl Marks {
    /// The line of a block number in the program in which line `here` stands. The search goes from there to the
    /// program's end, and then from its begin.
    pub(crate) fn block(&self, number: u32, here: usize) -> Option<usize> {
        let next = self.programs.partition_point(|line| *line <= here);
        let begin = next.checked_sub(1).map_or(0, |own| self.programs[own]);
        let end = self.programs.get(next).copied().unwrap_or(usize::MAX);
        let lines = self.blocks.get(&number)?;
        let from = |first: usize| lines[lines.partition_point(|line| *line < first)..].first().copied();
        [here + 1, begin].into_iter().filter_map(from).find(|line| *line < end)
    }
}

/// The place in a line where the values of an O-word begin.
pub(crate) fn behind_keyword(line: &str) -> usize {
    let keyword = labelled(numbered(line).1).map_or("", |(_, keyword)| keyword);
    line.len() - keyword.trim_start_matches(|c: char| c.is_ascii_alphabetic()).len()
}

/// The number of a block, and its words.
fn numbered(line: &str) -> (Option<u32>, &str) {
    let text = words(line);
    let text = words(text.strip_prefix('/').map_or(text, |text| leading_number(text).1));
    let Some(rest) = text.strip_prefix(['N', 'n']) else { return (None, text) };
    let (number, rest) = leading_number(rest.trim_start());
    (number, words(rest))
}

/// The label of an O-word, and the text behind it.
fn labelled(text: &str) -> Option<(Label, &str)> {
    let text = text.strip_prefix(['O', 'o'])?.trim_start();
    let (label, rest) = match text.strip_prefix('<').and_then(|text| text.split_once('>')) {
        Some((name, rest)) => (Label::named(name), rest),
        None => {
            let (number, rest) = leading_number(text);
            (Label::Number(number?), rest)
        }
    };
    Some((label, words(rest)))
}

/// A text without the white space and the comments at its begin.
fn words(mut text: &str) -> &str {
    loop {
        text = text.trim_start();
        match text.strip_prefix('(').and_then(|text| text.split_once(')')) {
            Some((_, behind)) => text = behind,
            None => return text,
        }
    }
}

/// The digits at the begin of a text, as a number, and the text behind them.
fn leading_number(text: &str) -> (Option<u32>, &str) {
    let digits = text.bytes().take_while(u8::is_ascii_digit).count();
    (text[..digits].parse().ok(), &text[digits..])
}
