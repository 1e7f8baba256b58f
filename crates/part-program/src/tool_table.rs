//! Tool tables: the diameters that cutter compensation needs, by the numbers of the tools.
//!
//! LinuxCNC's table has a line for each tool, of words as in a program: `T1 P1 D6.35 Z12.5 ; end mill`. D is the diameter in the unit of
//! the machine; a tool without D has the diameter 0. What follows a `;` is a comment.
//!
//! A CSV table has a header that names its columns. One is `tool`; one of `diameter_mm`, `radius_mm`, `diameter_inch` and `radius_inch`
//! is there too. Other columns are passed over.
//!
//! # Source
//! LinuxCNC, "Tool Compensation", section "Tool Table Format".

use std::collections::{BTreeMap, BTreeSet};

use domains::shown;

use crate::diagnostic::{Diagnostics, Report};
use crate::options::Unit;
use crate::source::{Source, Span};
use crate::unit::INCH;

/// Letters of LinuxCNC's table.
const LETTERS: &[u8] = b"TPXYZABCUVWDIJQ";
/// The greatest number of a tool.
const MAX_TOOL: u32 = 99_999_999;
/// The greatest diameter, in mm: no spindle turns a larger tool.
const MAX_DIAMETER_MM: f64 = 1e4;
/// Columns of a diameter: how many millimetres one of its numbers is.
const COLUMNS: [(&str, f64); 4] =
    [("diameter_mm", 1.0), ("radius_mm", 2.0), ("diameter_inch", INCH), ("radius_inch", 2.0 * INCH)];

/// The diameters of tools.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct ToolTable {
    diameters_mm: BTreeMap<u32, f64>,
    /// Tools with an orientation, which those of lathes have.
    of_lathe: BTreeSet<u32>,
}

impl ToolTable {
    /// Reads a table of LinuxCNC, whose lengths are in `unit`, or a CSV table, which names its own; told by the content. Diagnostics call
    /// it `name`.
    ///
    /// # Errors
    /// Every fault of the text.
    pub fn read(name: &str, text: &str, unit: Unit) -> Result<Self, Diagnostics> {
        let mut report = Report::new(Source::new(name, text));
        let mut table = Self::default();
        let is_linuxcnc = |line: &str| {
            let mut letters = line.trim_start().bytes().map(|c| c.to_ascii_uppercase());
            letters.next() == Some(b'T') && letters.next().is_some_and(|c| c.is_ascii_digit())
        };
        let mut lines = text.lines().map(without_comment).filter(|line| !line.trim().is_empty());
        match lines.next() {
            None => {
                report
                    .error(Span::default(), "the tool table has no tool")
                    .expected("lines as T1 P1 D6.35, or a CSV header with tool and diameter_mm");
            }
            Some(first) if is_linuxcnc(first) => {
                table.linuxcnc(&mut report, if unit == Unit::Inch { INCH } else { 1.0 });
            }
            Some(_) => table.csv(&mut report),
        }
        report.finish()?;
        Ok(table)
    }

    /// The diameter of a tool, in mm; negative where the contour is that of a larger tool.
    #[must_use]
    pub fn diameter_mm(&self, tool: u32) -> Option<f64> {
        self.diameters_mm.get(&tool).copied()
    }

    /// The tools with their diameters in mm, in the order of their numbers.
    pub fn tools(&self) -> impl Iterator<Item = (u32, f64)> {
        self.diameters_mm.iter().map(|(tool, diameter)| (*tool, *diameter))
    }

    /// Whether a tool has an orientation, Q1 to Q8 of LinuxCNC.
    pub(crate) fn is_of_lathe(&self, tool: u32) -> bool {
        self.of_lathe.contains(&tool)
    }

    /// Sets the diameter of a tool, as G10 L1 does.
    pub(crate) fn set(&mut self, tool: u32, diameter_mm: f64) {
        self.diameters_mm.insert(tool, diameter_mm);
    }

    fn linuxcnc(&mut self, report: &mut Report<'_>, unit: f64) {
        for index in 0..report.source.lines() {
            let (start, line) = report.source.line(index);
            let (mut tool, mut diameter, mut orientation) = (None, 0.0, 0.0);
            let line = without_comment(line);
            for word in line.split_ascii_whitespace() {
                let at = start + (word.as_ptr() as usize - line.as_ptr() as usize);
                let span = Span::new(at, at + word.len());
                let letter = word.bytes().next().map_or(0, |letter| letter.to_ascii_uppercase());
                let value =
                    word.get(1..).and_then(|number| number.parse::<f64>().ok()).filter(|x| x.is_finite());
                match value.filter(|_| LETTERS.contains(&letter)) {
                    Some(value) if letter == b'T' => tool = Some((value, span)),
                    Some(value) if letter == b'D' => diameter = value,
                    Some(value) if letter == b'Q' => orientation = value,
                    Some(_) => {}
                    None => {
                        let message = format!("`{}` is no word of a tool table", shortened(word));
                        report.error(span, message).expected("T1 P1 D6.35, with lengths X to W, I, J and Q");
                    }
                }
            }
            match tool {
                Some((tool, span)) => {
                    if let Some(tool) =
                        self.add(report, span, tool, diameter * unit).filter(|_| orientation != 0.0)
                    {
                        self.of_lathe.insert(tool);
                    }
                }
                None if line.trim().is_empty() => {}
                None => {
                    let span = Span::new(start, start + line.trim_end().len());
                    report.error(span, "a tool without its number").expected("a word T");
                }
            }
        }
    }

    fn csv(&mut self, report: &mut Report<'_>) {
        let text = report.source.text;
        let mut rows = csv::ReaderBuilder::new()
            .trim(csv::Trim::All)
            .comment(Some(b'#'))
            .flexible(true)
            .from_reader(text.as_bytes());
        let Ok(header) = rows.headers().cloned() else { return };
        let column = |name: &str| header.iter().position(|cell| cell.eq_ignore_ascii_case(name));
        let diameter = COLUMNS.into_iter().find_map(|(name, unit)| Some((column(name)?, unit)));
        let (Some(number), Some((diameter, unit))) = (column("tool"), diameter) else {
            report
                .error(Span::default(), "this is no tool table")
                .expected("lines as T1 P1 D6.35, or a CSV header with tool and one of diameter_mm, radius_mm, diameter_inch, radius_inch");
            return;
        };
        for row in rows.records() {
            let place = row.as_ref().ok().and_then(|row| row.position()).map_or(0, csv::Position::byte);
            let start = usize::try_from(place).unwrap_or(0).min(text.len());
            let span = Span::new(start, start + text[start..].lines().next().map_or(0, str::len));
            let cell = |column: usize| {
                let row = row.as_ref().ok()?;
                row.get(column)?.parse::<f64>().ok().filter(|x| x.is_finite())
            };
            match (cell(number), cell(diameter)) {
                (Some(tool), Some(value)) => drop(self.add(report, span, tool, value * unit)),
                _ => {
                    report
                        .error(span, "a row without its two numbers")
                        .expected("the tool's number and its size");
                }
            }
        }
    }

    /// Adds a tool, and returns its number if it is one.
    fn add(&mut self, report: &mut Report<'_>, span: Span, tool: f64, diameter_mm: f64) -> Option<u32> {
        if !(0.0..=f64::from(MAX_TOOL)).contains(&tool) || tool.fract() != 0.0 {
            report.error(span, format!("{} is no number of a tool", shown(tool))).expected("a whole number");
            return None;
        }
        if diameter_mm.abs() > MAX_DIAMETER_MM {
            let message = format!("the diameter is {} mm", shown(diameter_mm));
            report.error(span, message).expected(format!("at most {MAX_DIAMETER_MM} mm"));
            return None;
        }
        #[allow(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "whole, 0 ..= MAX_TOOL")]
        let number = tool as u32;
        if self.diameters_mm.insert(number, diameter_mm).is_some() {
            report.error(span, format!("tool {number} is there twice")).expected("each tool once");
        }
        Some(number)
    }
}

/// A line as far as its comment.
fn without_comment(line: &str) -> &str {
    line.split(';').next().unwrap_or("")
}

/// The begin of a text that may be long.
fn shortened(text: &str) -> String {
    text.chars().take(40).collect()
}
