//! Lexer of DXF: pairs of lines, a group code and a value, to entities.
//!
//! A lexer of our own: the crate `dxf` (0.6) ends a drawing without a message at the first entity that it cannot read,
//! and does not keep places.

use super::affine::Affine;
use crate::diagnostic::Report;
use crate::source::Span;

/// A group: its code, and its value without the spaces around it.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Group<'t> {
    pub(crate) code: i32,
    pub(crate) text: &'t str,
    pub(crate) span: Span,
}

/// Reads group after group; `None` at the end, or if there is no group code, which is reported.
pub(crate) struct Groups<'t> {
    text: &'t str,
    at: usize,
}

impl<'t> Groups<'t> {
    /// Reads from a byte of the text on; the byte must begin a line.
    pub(crate) fn new(text: &'t str, at: usize) -> Self {
        Self { text, at }
    }

    /// The byte at which the next group begins.
    pub(crate) fn at(&self) -> usize {
        self.at
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
    /// The entities VERTEX that follow a POLYLINE.
    pub(crate) vertices: Vec<Entity<'t>>,
}

/// In a block, the layer on which the block is inserted.
pub(super) const INSERTS_LAYER: &str = "0";

/// Reads entity after entity, to the end of their section or block.
pub(crate) struct Entities<'t> {
    groups: Groups<'t>,
    /// The group 0 of the next entity.
    opening: Option<Group<'t>>,
}

impl<'t> Entities<'t> {
    /// Reads from a byte of the text on, at which a group 0 must begin.
    pub(crate) fn new(text: &'t str, at: usize) -> Self {
        let mut groups = Groups::new(text, at);
        let opening = groups.next(None);
        Self { groups, opening }
    }

    /// The next entity; a POLYLINE with its vertices.
    fn polyline(&mut self) -> Option<Entity<'t>> {
        let mut entity = self.one()?;
        while entity.name == "POLYLINE" && self.opening.is_some_and(|next| next.text == "VERTEX") {
            entity.vertices.extend(self.one());
        }
        Some(entity)
    }

    fn one(&mut self) -> Option<Entity<'t>> {
        let opening = self.opening.filter(|group| group.code == 0)?;
        if matches!(opening.text, "ENDSEC" | "ENDBLK" | "EOF" | "SECTION") {
            return None;
        }
        let mut groups = Vec::new();
        self.opening = loop {
            match self.groups.next(None) {
                Some(group) if group.code != 0 => groups.push(group),
                next => break next,
            }
        };
        Some(Entity { groups, ..Entity::new(opening.text, opening.span) })
    }
}

impl<'t> Iterator for Entities<'t> {
    type Item = Entity<'t>;

    fn next(&mut self) -> Option<Entity<'t>> {
        self.polyline()
    }
}

impl<'t> Entity<'t> {
    /// An entity without groups yet.
    pub(crate) fn new(name: &'t str, span: Span) -> Self {
        Self { name, span, groups: Vec::new(), vertices: Vec::new() }
    }

    /// The name of its layer.
    pub(super) fn layer(&self) -> &'t str {
        self.text(8).unwrap_or(INSERTS_LAYER)
    }

    /// The text of a group code that occurs once.
    pub(crate) fn text(&self, code: i32) -> Option<&'t str> {
        self.groups.iter().find(|group| group.code == code).map(|group| group.text)
    }

    /// The values of a group code that may occur several times; each that is not a number is reported.
    pub(crate) fn numbers(&self, report: &mut Report<'_>, code: i32) -> Vec<(f64, Span)> {
        let groups = self.groups.iter().filter(|group| group.code == code);
        groups.map(|group| (number(report, group), group.span)).collect()
    }

    /// The value of a group code that occurs once.
    pub(crate) fn number(&self, report: &mut Report<'_>, code: i32) -> Option<f64> {
        self.groups.iter().find(|group| group.code == code).map(|group| number(report, group))
    }

    /// The bits of a group code; no bit is set if the code is missing.
    pub(crate) fn flags(&self, report: &mut Report<'_>, code: i32) -> u32 {
        let value = self.number(report, code).filter(|value| (0.0..65536.0).contains(value));
        #[allow(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "0 to 65535")]
        value.map_or(0, |value| value as u32)
    }

    /// The value of a group code that the entity must have; `None` after an error was reported.
    pub(crate) fn needed(&self, report: &mut Report<'_>, code: i32, what: &str) -> Option<f64> {
        let found = self.number(report, code);
        if found.is_none() {
            report
                .error(self.span, format!("this {} has no {what}", self.name))
                .expected(format!("a group {code}"));
        }
        found.filter(|value| !value.is_nan())
    }

    /// The single point whose x has this code; `None` after an error was reported.
    pub(crate) fn point(&self, report: &mut Report<'_>, x: i32, what: &str) -> Option<[f64; 3]> {
        let points = self.points(report, x);
        if let &[(point, _)] = points.as_slice() {
            return point.iter().all(|x| !x.is_nan()).then_some(point);
        }
        let message = match points.len() {
            0 => format!("this {} has no {what}", self.name),
            count => format!("this {} has a {what} {count} times", self.name),
        };
        report.error(self.span, message).expected(format!("groups {x}, {} and {} once", x + 10, x + 20));
        None
    }

    /// The map from the entity's plane to the drawing's axes; `None` after an error was reported.
    pub(crate) fn plane(&self, report: &mut Report<'_>) -> Option<Affine> {
        let normal = [(210, 0.0), (220, 0.0), (230, 1.0)]
            .map(|(code, default)| self.number(report, code).unwrap_or(default));
        let plane = Affine::of_plane(normal);
        if plane.is_none() && normal.iter().all(|x| !x.is_nan()) {
            report
                .error(self.span, format!("the plane of this {} has no normal", self.name))
                .expected("the groups 210, 220 and 230 to be a direction");
        }
        plane
    }

    /// The points whose x has the code `x`, y `x + 10` and z `x + 20`; a missing z is 0.
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

/// A number; NaN after an error was reported.
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
