//! Lexer of DXF: pairs of lines, a group code and a value, to entities.
//!
//! Our own, because the crate `dxf` (0.6) ends a drawing without a word at the first entity that it cannot read, and
//! keeps no places.

use crate::diagnostic::Report;
use crate::source::Span;

/// A group: its code, and its value without the spaces around it.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Group<'t> {
    pub(crate) code: i32,
    pub(crate) text: &'t str,
    pub(crate) span: Span,
}

/// Reads group after group; `None` at the end, or where there is no group code, which is said.
pub(crate) struct Groups<'t> {
    text: &'t str,
    at: usize,
}

impl<'t> Groups<'t> {
    pub(crate) fn new(text: &'t str) -> Self {
        Self { text, at: 0 }
    }

    /// The next line without the spaces around it, and its place.
    fn line(&mut self) -> Option<(&'t str, Span)> {
        let rest = self.text.get(self.at..).filter(|rest| !rest.is_empty())?;
        let line = rest.split_inclusive('\n').next()?;
        let start =
            self.at + (line.len() - line.trim_start().len()).min(line.trim_end_matches(['\r', '\n']).len());
        self.at += line.len();
        let word = line.trim();
        Some((word, Span::new(start, start + word.len())))
    }

    pub(crate) fn next(&mut self, report: Option<&mut Report<'_>>) -> Option<Group<'t>> {
        let (code, place) = self.line()?;
        let Ok(code) = code.parse() else {
            if let Some(report) =
                report.filter(|_| !(code.is_empty() && self.text[self.at..].trim().is_empty()))
            {
                report
                    .error(place, "this line ought to be a group code")
                    .expected("a whole number; values follow on lines of their own");
            }
            return None;
        };
        let (text, span) = self.line().unwrap_or(("", place));
        Some(Group { code, text, span })
    }
}

/// An entity: its name and its groups.
pub(crate) struct Entity<'t> {
    pub(crate) name: &'t str,
    pub(crate) span: Span,
    pub(crate) groups: Vec<Group<'t>>,
}

impl<'t> Entity<'t> {
    /// The text of a group code that stands there once.
    pub(crate) fn text(&self, code: i32) -> Option<&'t str> {
        self.groups.iter().find(|group| group.code == code).map(|group| group.text)
    }

    /// The values of a group code that may stand there several times; each that is no number is said.
    pub(crate) fn numbers(&self, report: &mut Report<'_>, code: i32) -> Vec<(f64, Span)> {
        let groups = self.groups.iter().filter(|group| group.code == code);
        groups.map(|group| (number(report, group), group.span)).collect()
    }

    /// The value of a group code that stands there once.
    pub(crate) fn number(&self, report: &mut Report<'_>, code: i32) -> Option<f64> {
        self.groups.iter().find(|group| group.code == code).map(|group| number(report, group))
    }

    /// The value of a group code without which the entity is none.
    pub(crate) fn needed(&self, report: &mut Report<'_>, code: i32, what: &str) -> Option<f64> {
        let found = self.number(report, code);
        if found.is_none() {
            report
                .error(self.span, format!("this {} has no {what}", self.name))
                .expected(format!("a group {code}"));
        }
        found
    }

    /// The points whose x has the code `x`, y `x + 10` and z `x + 20`; a z that is not there is 0.
    pub(crate) fn points(&self, report: &mut Report<'_>, x: i32) -> Vec<([f64; 3], Span)> {
        let mut points: Vec<([f64; 3], Span)> = Vec::new();
        let mut has_y = true;
        for group in &self.groups {
            let axis = match group.code - x {
                0 => 0,
                10 => 1,
                20 => 2,
                _ => continue,
            };
            let value = number(report, group);
            if axis == 0 {
                self.demand_y(report, has_y, points.last());
                points.push(([value, 0.0, 0.0], group.span));
            } else if let Some((point, _)) = points.last_mut() {
                point[axis] = value;
            } else {
                report
                    .error(group.span, format!("a group {} before the group {x} of its point", group.code))
                    .expected(format!("{x}, {} and {} in this order", x + 10, x + 20));
            }
            has_y = axis > 0 && (has_y || axis == 1);
        }
        self.demand_y(report, has_y, points.last());
        points
    }

    fn demand_y(&self, report: &mut Report<'_>, has_y: bool, point: Option<&([f64; 3], Span)>) {
        if let Some((_, span)) = point.filter(|_| !has_y) {
            let message = format!("a point of this {} has no y", self.name);
            report.error(*span, message).expected("a group for y after the one for x");
        }
    }
}

/// A number, or NaN once it is said that it is none.
fn number(report: &mut Report<'_>, group: &Group<'_>) -> f64 {
    match group.text.parse::<f64>() {
        Ok(value) if value.is_finite() => value,
        _ => {
            let message = format!("`{}` is no number", group.text.chars().take(40).collect::<String>());
            report.error(group.span, message).expected(format!("a number for group {}", group.code));
            f64::NAN
        }
    }
}
