//! The numbers of a curve in a curve file, each with its place.

use domains::curve::POINTS;
use toml::de::DeValue;
use toml_parser::lexer::{Lexer, Token, TokenKind};

use crate::curve_fault::{CurveFault, Element};
use crate::diagnostic::Report;
use crate::source::Span;
use crate::toml_table::{holds, number_of};

/// The places of a curve's numbers.
#[derive(Default)]
pub(crate) struct Places {
    pub(crate) degree: Span,
    pub(crate) points: Span,
    pub(crate) point: Vec<Span>,
    pub(crate) weights: Span,
    pub(crate) weight: Vec<Span>,
    pub(crate) knots: Span,
    pub(crate) knot: Vec<Span>,
}

impl Places {
    /// All numbers at the place of the control points, from which they are computed.
    pub(crate) fn all_at(points: Span) -> Self {
        Self { degree: points, points, weights: points, knots: points, ..Self::default() }
    }

    fn of(&self, element: Element) -> Span {
        let one = |places: &[Span], index: usize, all: Span| places.get(index).copied().unwrap_or(all);
        match element {
            Element::Degree => self.degree,
            Element::ControlPoints => self.points,
            Element::ControlPoint(index) => one(&self.point, index, self.points),
            Element::Weights => self.weights,
            Element::Weight(index) => one(&self.weight, index, self.weights),
            Element::Knots => self.knots,
            Element::Knot(index) => one(&self.knot, index, self.knots),
        }
    }
}

/// Reports each fault at its place.
pub(crate) fn say(report: &mut Report<'_>, places: &Places, faults: &[CurveFault]) {
    for fault in faults {
        report.error(places.of(fault.element()), fault.to_string()).expected(fault.expected());
    }
}

/// The numbers of an array at a place; their places are added to `places`.
pub(crate) fn numbers(
    report: &mut Report<'_>,
    key: &str,
    array: Span,
    places: &mut Vec<Span>,
) -> Option<Vec<f64>> {
    let mut numbers = Vec::new();
    let mut sound = true;
    Items::of(report, array).each(report, |items, report, item| {
        let (number, span) = number(items, report, key, item)?;
        places.push(span);
        sound &= number.is_some();
        numbers.push(number.unwrap_or(f64::NAN));
        Some(())
    })?;
    sound.then_some(numbers)
}

/// The points of an array at a place, and the number of coordinates of each.
pub(crate) fn control_points(
    report: &mut Report<'_>,
    array: Span,
    places: &mut Vec<Span>,
) -> Option<(Vec<[f64; 3]>, usize)> {
    let (mut points, mut sound, mut dimension) = (Vec::new(), true, None);
    Items::of(report, array).each(report, |items, report, item| {
        let (point, span) = control_point(items, report, item, &mut dimension)?;
        places.push(span);
        sound &= point.is_some();
        points.push(point.unwrap_or_default());
        Some(())
    })?;
    sound.then(|| (points, dimension.unwrap_or(0).max(2)))
}

/// A point and its place; no point after its fault was reported, and nothing if the array cannot be read further.
fn control_point(
    items: &mut Items<'_>,
    report: &mut Report<'_>,
    item: Item<'_>,
    dimension: &mut Option<usize>,
) -> Option<(Option<[f64; 3]>, Span)> {
    const FORM: &str = "2 or 3 coordinates, as [x, y] or [x, y, z]";
    let Item::Open(begin) = item else {
        let (kind, span) = items.kind_of(report, item)?;
        holds(report, POINTS.name, (span, kind), &format!("points of {FORM}"));
        return Some((None, span));
    };
    let (mut point, mut found, mut sound) = ([0.0; 3], 0, true);
    let end = items.each(report, |items, report, item| {
        let (coordinate, _) = number(items, report, POINTS.name, item)?;
        sound &= coordinate.is_some();
        if let (Some(slot), Some(coordinate)) = (point.get_mut(found), coordinate) {
            *slot = coordinate;
        }
        found += 1;
        Some(())
    })?;
    let span = begin.to(end);
    let dimension = *dimension.get_or_insert(found);
    if !(2..=3).contains(&found) {
        report.error(span, format!("a control point has {found} coordinates")).expected(FORM);
    } else if found != dimension && (2..=3).contains(&dimension) {
        let message = format!("a control point has {found} coordinates, the first has {dimension}");
        report.error(span, message).expected("the same number of coordinates in every point");
    } else if sound {
        return Some((Some(point), span));
    }
    Some((None, span))
}

/// A number and its place; no number after its fault was reported, and nothing if the array cannot be read further.
fn number(
    items: &mut Items<'_>,
    report: &mut Report<'_>,
    key: &str,
    item: Item<'_>,
) -> Option<(Option<f64>, Span)> {
    let Item::Value(text, span) = item else {
        let (kind, span) = items.kind_of(report, item)?;
        holds(report, key, (span, kind), "a number");
        return Some((None, span));
    };
    match DeValue::parse(text) {
        Ok(value) => {
            let number = number_of(value.get_ref());
            if number.is_none() {
                holds(report, key, (span, value.get_ref().type_str()), "a number");
            }
            Some((number, span))
        }
        Err(error) => {
            report.error(span, error.message()).expected("a number");
            Some((None, span))
        }
    }
}

/// A part of an array.
#[derive(Clone, Copy)]
enum Item<'t> {
    /// `[` or `{`.
    Open(Span),
    /// `]` or `}`.
    Close(Span),
    Comma(Span),
    /// Any other value, as it is written.
    Value(&'t str, Span),
}

impl Item<'_> {
    fn span(self) -> Span {
        match self {
            Self::Open(span) | Self::Close(span) | Self::Comma(span) | Self::Value(_, span) => span,
        }
    }
}

/// The parts of an array that stands in the text, one after the other, so that no memory is taken for them.
struct Items<'t> {
    text: &'t str,
    lexer: std::iter::Peekable<Lexer<'t>>,
    /// Where the array begins.
    begin: usize,
    end: Span,
}

impl<'t> Items<'t> {
    /// The parts of the array at a place, without its first bracket.
    fn of(report: &Report<'t>, array: Span) -> Self {
        let text = report.slice(array);
        let mut lexer = toml_parser::Source::new(text).lex().peekable();
        lexer.next();
        Self { text, lexer, begin: array.start, end: Span::new(array.end.saturating_sub(1), array.end) }
    }

    /// The next part; `None` at the end of the text.
    fn next(&mut self) -> Option<Item<'t>> {
        let token = self.lexer.find(|token| {
            !matches!(token.kind(), TokenKind::Whitespace | TokenKind::Newline | TokenKind::Comment)
        })?;
        let (start, mut end) = (token.span().start(), token.span().end());
        let is_word = |token: &Token| matches!(token.kind(), TokenKind::Atom | TokenKind::Dot);
        if is_word(&token) {
            // A number with a fraction is three tokens.
            while let Some(more) = self.lexer.next_if(is_word) {
                end = more.span().end();
            }
        }
        let span = Span::new(self.begin + start, self.begin + end);
        Some(match token.kind() {
            TokenKind::LeftSquareBracket | TokenKind::LeftCurlyBracket => Item::Open(span),
            TokenKind::RightSquareBracket | TokenKind::RightCurlyBracket => Item::Close(span),
            TokenKind::Comma => Item::Comma(span),
            TokenKind::Eof => return None,
            _ => Item::Value(self.text.get(start..end).unwrap_or(""), span),
        })
    }

    /// Takes each value up to the closing bracket, whose place is returned; `None` after an error of the array's form.
    fn each<'r>(
        &mut self,
        report: &mut Report<'r>,
        mut take: impl FnMut(&mut Self, &mut Report<'r>, Item<'t>) -> Option<()>,
    ) -> Option<Span> {
        let mut expects_value = true;
        loop {
            match (self.next(), expects_value) {
                (Some(Item::Close(span)), _) => return Some(span),
                (Some(Item::Comma(_)), false) => expects_value = true,
                (Some(item @ (Item::Open(_) | Item::Value(..))), true) => {
                    take(self, report, item)?;
                    expects_value = false;
                }
                (item, _) => {
                    let expected = if expects_value { "a value, or `]`" } else { "`,` or `]`" };
                    let span = item.map_or(self.end, Item::span);
                    report.error(span, "this array cannot be read here").expected(expected);
                    return None;
                }
            }
        }
    }

    /// The kind and the place of a value that is no number; an array or a table is passed over.
    fn kind_of(&mut self, report: &mut Report<'_>, item: Item<'_>) -> Option<(&'static str, Span)> {
        match item {
            Item::Open(begin) => {
                let is_table = report.slice(begin) == "{";
                let mut depth = 1;
                while depth > 0 {
                    match self.next()? {
                        Item::Open(_) => depth += 1,
                        Item::Close(_) => depth -= 1,
                        _ => {}
                    }
                }
                Some((if is_table { "table" } else { "array" }, begin))
            }
            Item::Value(text, span) => {
                let kind = DeValue::parse(text).map_or("value", |value| value.get_ref().type_str());
                Some((kind, span))
            }
            Item::Close(span) | Item::Comma(span) => Some(("value", span)),
        }
    }
}

#[cfg(test)]
mod tests {
    use crate::read_part;

    fn said(points: &str, knots: &str) -> Vec<String> {
        let text = format!("[[curve]]\ndegree = 1\ncontrol_points_mm = {points}\nknots = {knots}\n");
        match read_part("c.toml", &text) {
            Ok(part) => vec![format!("{:?}", part.curves[0].to_nurbs().control_points_mm)],
            Err(errors) => errors.iter().map(|e| format!("{}:{} {}", e.line, e.column, e.message)).collect(),
        }
    }

    const POINTS: &str = "[[0, 0], [1, 1]]";
    const KNOTS: &str = "[0, 0, 1, 1]";

    #[test]
    fn arrays_are_read_as_toml_has_them() {
        let expected = ["[[0.0, 0.0, 0.0], [1000.5, -0.25, 0.0]]"];
        for points in ["[[0, 0], [1_000.5, -25e-2]]", "[ # two\n [+0.0,0,],\n\t[1000.5 , -0.25] , # end\n]"] {
            assert_eq!(said(points, KNOTS), expected, "{points}");
        }
    }

    #[test]
    fn faults_of_arrays_have_their_places() {
        for (points, knots, expected) in [
            (POINTS, "[0, 0, \"1\", x]", &["4:16 `knots` holds a string", "4:21 "][..]),
            (POINTS, "[0, 0, [1], {a = 1}]", &["4:16 `knots` holds an array", "4:21 `knots` holds a table"]),
            (POINTS, "[0, 0 1, 1]", &["4:15 this array cannot be read here"]),
            (POINTS, "[0,, 0]", &["4:12 this array cannot be read here"]),
            ("[[0, 0], [1]]", KNOTS, &["3:30 a control point has 1 coordinates"]),
            ("[[0, 0], [1, 1, 1]]", KNOTS, &["3:30 a control point has 3 coordinates, the first has 2"]),
            ("[[0, 0], 7, [1, 01]]", KNOTS, &["3:30 `control_points_mm` holds an integer", "3:37 "]),
            ("7", KNOTS, &["3:21 `control_points_mm` holds an integer"]),
        ] {
            let found = said(points, knots);
            assert_eq!(found.len(), expected.len(), "{found:?}");
            assert!(found.iter().zip(expected).all(|(found, begin)| found.starts_with(begin)), "{found:?}");
        }
    }
}
