//! Binary DXF: the groups of a drawing as bytes, turned into the text that has the same groups.
//!
//! Behind the sentinel each group is its code and its value. A code has two bytes, low one first; in files of release
//! 12 and before it has one byte, or 255 and two bytes. The code tells the kind of the value: a text with a 0 behind
//! it; a number of 1, 2, 4 or 8 bytes, low ones first; or a count in one byte and so many bytes. Diagnostics of such a
//! drawing have the line and the column of the text: group n stands in its lines 2n - 1 and 2n.
//!
//! # Source
//! Autodesk, DXF Reference, "Binary DXF Files" and "Group Code Value Types".

use std::fmt::Write;

use super::is_drawing;
use crate::diagnostic::{Diagnostics, Report};
use crate::source::{Source, Span};
use crate::text_length::{MAX_TEXT, too_long};

/// The first bytes of a binary drawing.
pub(crate) const SENTINEL: &[u8] = b"AutoCAD Binary DXF\r\n\x1a\0";

/// Why bytes are not groups, with the byte at which this shows.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Fault {
    CutOff(usize),
    NoGroup(usize, u16),
    TooLong(usize),
}

/// The text with the same groups.
///
/// # Errors
/// The place in the file from which on it is not a drawing.
pub(crate) fn as_text(name: &str, bytes: &[u8]) -> Result<String, Diagnostics> {
    let (message, expected) = match text_of(bytes.get(SENTINEL.len()..).unwrap_or_default()) {
        Ok(text) if is_drawing(&text) => return Ok(text),
        Ok(_) => {
            ("this binary drawing does not begin with a section".to_owned(), "groups 0 SECTION and 2 HEADER")
        }
        Err(Fault::TooLong(length)) => return Err(too_long(name, length, MAX_TEXT)),
        Err(Fault::CutOff(at)) => {
            let at = at + SENTINEL.len();
            (format!("the binary drawing is cut off in the group at byte {at}"), "a group 0 with EOF")
        }
        Err(Fault::NoGroup(at, code)) => {
            let at = at + SENTINEL.len();
            (
                format!("byte {at} of the binary drawing begins a group {code}, which there is not"),
                "a code up to 1071",
            )
        }
    };
    let mut report = Report::new(Source::new(name, ""));
    report.error(Span::default(), message).expected(expected);
    Err(report.finish().err().unwrap_or_default())
}

fn text_of(bytes: &[u8]) -> Result<String, Fault> {
    let mut reader = Reader { bytes, at: 0, is_wide: is_wide(bytes) };
    let mut text = String::new();
    while reader.at < bytes.len() {
        let start = reader.at;
        let code = reader.code().ok_or(Fault::CutOff(start))?;
        let kind = Kind::of(code).ok_or(Fault::NoGroup(start, code))?;
        let value = reader.value(kind).ok_or(Fault::CutOff(start))?;
        let _ = writeln!(text, "{code}\n{value}");
        if text.len() > MAX_TEXT {
            return Err(Fault::TooLong(text.len()));
        }
        if code == 0 && value == "EOF" {
            return Ok(text);
        }
    }
    Err(Fault::CutOff(bytes.len()))
}

/// Whether codes have two bytes: the first group is 0 or the comment 999.
fn is_wide(bytes: &[u8]) -> bool {
    matches!(bytes, [0, 0, ..] | [0xe7, 3, ..])
}

/// The kind of a group's value.
#[derive(Clone, Copy)]
enum Kind {
    Text,
    Real,
    Whole(usize),
    Chunk,
}

impl Kind {
    fn of(code: u16) -> Option<Self> {
        Some(match code {
            1004 | 310..=319 => Self::Chunk,
            0..=9 | 100..=109 | 300..=309 | 320..=369 | 390..=399 | 410..=419 | 430..=439 | 470..=481 => {
                Self::Text
            }
            999..=1009 => Self::Text,
            10..=59 | 110..=149 | 210..=239 | 460..=469 | 1010..=1059 => Self::Real,
            290..=299 => Self::Whole(1),
            60..=79 | 170..=179 | 270..=289 | 370..=389 | 400..=409 | 1060..=1070 => Self::Whole(2),
            90..=99 | 420..=429 | 440..=459 | 1071 => Self::Whole(4),
            160..=169 => Self::Whole(8),
            _ => return None,
        })
    }
}

struct Reader<'b> {
    bytes: &'b [u8],
    at: usize,
    is_wide: bool,
}

impl<'b> Reader<'b> {
    fn take(&mut self, count: usize) -> Option<&'b [u8]> {
        let taken = self.bytes.get(self.at..)?.get(..count)?;
        self.at += count;
        Some(taken)
    }

    fn whole(&mut self, count: usize) -> Option<i64> {
        let bytes = self.take(count)?;
        let is_negative = count > 1 && bytes.last().is_some_and(|high| *high > 127);
        let mut all = [if is_negative { 0xff } else { 0 }; 8];
        all[..count].copy_from_slice(bytes);
        Some(i64::from_le_bytes(all))
    }

    fn code(&mut self) -> Option<u16> {
        if !self.is_wide {
            let code = self.take(1)?[0];
            if code != 255 {
                return Some(u16::from(code));
            }
        }
        Some(u16::from_le_bytes(self.take(2)?.try_into().ok()?))
    }

    /// The value as a line of text.
    fn value(&mut self, kind: Kind) -> Option<String> {
        match kind {
            Kind::Whole(count) => self.whole(count).map(|value| value.to_string()),
            Kind::Real => Some(format!("{:?}", f64::from_le_bytes(self.take(8)?.try_into().ok()?))),
            Kind::Chunk => {
                let count = usize::from(self.take(1)?[0]);
                self.take(count).map(|_| String::new())
            }
            Kind::Text => {
                let length = self.bytes.get(self.at..)?.iter().position(|byte| *byte == 0)?;
                let bytes = self.take(length)?;
                self.at += 1;
                Some(line_of(bytes))
            }
        }
    }
}

/// A text on one line, read as UTF-8 or, if it is not valid, as Latin-1.
fn line_of(bytes: &[u8]) -> String {
    match std::str::from_utf8(bytes) {
        Ok(text) => text.replace(['\r', '\n'], " "),
        Err(_) => bytes.iter().map(|byte| char::from(*byte)).collect::<String>().replace(['\r', '\n'], " "),
    }
}
