//! FANUC part programs with NURBS interpolation, G06.2.
//!
//! `G06.2 P<order> K<knot> X<> Y<> Z<> R<weight> F<feed>` opens a curve, one control point a block; after the last point
//! come `order` blocks with a K alone. P is 4 and R is 1 where they are not written; a coordinate that is not written
//! keeps its value. A feed is in mm/min. `G05 P10000` and `G05 P0` switch high-precision contouring on and off.
//!
//! The alarms of a control, as far as a text can break its rules, are errors here: a block without K, end knots of
//! insufficient multiplicity, a knot repeated too often, decreasing knots, a first point off the current position.

use crate::curve::{Curve, Element};
use crate::diagnostic::Report;
use crate::part::{Move, MoveKind, Part, Shape};
use crate::source::Span;

/// A word: its letter, number and place.
#[derive(Clone, Copy)]
struct Word {
    letter: char,
    value: f64,
    span: Span,
}

/// The curve that is being read.
struct Open {
    order: usize,
    points: Vec<([f64; 3], Span)>,
    weights: Vec<(f64, Span)>,
    knots: Vec<(f64, Span)>,
    start: Span,
}

/// Reads a whole program into `part`. What is wrong goes to the report.
pub(crate) fn read(report: &mut Report<'_>, part: &mut Part) {
    let mut reader = Reader { part, position: [None; 3], open: None };
    let text = report.source.text;
    let mut at = 0;
    for line in text.split_inclusive('\n') {
        if let Some(words) = words(report, at, line) {
            reader.block(report, &words);
        }
        at += line.len();
    }
    reader.close(report);
    if reader.part.curves.is_empty() && !report.has_errors() {
        report.error(Span::new(0, 0), "the program holds no NURBS curve").expected("a block with G06.2");
    }
}

/// The words of a line; `None` if it holds none. Comments, block numbers and program delimiters are passed over.
fn words(report: &mut Report<'_>, start: usize, line: &str) -> Option<Vec<Word>> {
    let bytes = line.as_bytes();
    let mut found = Vec::new();
    let mut i = 0;
    while i < bytes.len() {
        match bytes[i] {
            b';' => break,
            b'(' => match line[i..].find(')') {
                Some(length) => i += length + 1,
                None => {
                    let rest = line.trim_end().len().max(i + 1);
                    report
                        .error(Span::new(start + i, start + rest), "this comment has no end")
                        .expected("a `)` on the same line");
                    break;
                }
            },
            b'%' | b' ' | b'\t' | b'\r' | b'\n' => i += 1,
            letter if letter.is_ascii_alphabetic() => {
                let digits = line[i + 1..]
                    .find(|c: char| !(c.is_ascii_digit() || matches!(c, '.' | '+' | '-' | ' ')))
                    .map_or(line.len(), |n| i + 1 + n);
                let number: String = line[i + 1..digits].chars().filter(|c| *c != ' ').collect();
                let span = Span::new(start + i, start + i + 1 + line[i + 1..digits].trim_end().len());
                match number.parse() {
                    Ok(value) => found.push(Word { letter: letter.to_ascii_uppercase().into(), value, span }),
                    Err(_) => {
                        report
                            .error(span, format!("`{}` has no number", letter as char))
                            .expected("a number such as 12.5");
                    }
                }
                i = digits;
            }
            _ => {
                let c = line[i..].chars().next().unwrap_or(' ');
                let span = Span::new(start + i, start + i + c.len_utf8());
                report
                    .error(span, format!("`{}` is no part of a word", c.escape_debug()))
                    .expected("a word such as X12.5");
                break;
            }
        }
    }
    found.retain(|word| !matches!(word.letter, 'N' | 'O'));
    (!found.is_empty()).then_some(found)
}

struct Reader<'p> {
    part: &'p mut Part,
    position: [Option<f64>; 3],
    open: Option<Open>,
}

impl Reader<'_> {
    fn block(&mut self, report: &mut Report<'_>, words: &[Word]) {
        let g = words.iter().find(|word| word.letter == 'G');
        match g.map(|word| word.value) {
            Some(6.2) => {
                self.close(report);
                let order = words.iter().find(|w| w.letter == 'P');
                let supported = 2..=crate::curve::MAX_DEGREE + 1;
                let Some(order) = order.map_or(Some(4), |w| supported.clone().find(|n| *n as f64 == w.value))
                else {
                    if let Some(word) = order {
                        let message = format!("order {} is not supported", word.value);
                        report.error(word.span, message).expected(format!("P2 to P{}", supported.end()));
                    }
                    return;
                };
                let start = words.iter().map(|w| w.span).reduce(Span::to).unwrap_or_default();
                self.open =
                    Some(Open { order, points: Vec::new(), weights: Vec::new(), knots: Vec::new(), start });
                self.point(report, words);
            }
            Some(5.0 | 90.0 | 21.0) => self.close(report),
            Some(_) => {
                self.close(report);
                if let Some(word) = g {
                    report
                        .error(word.span, format!("G{} is not read", word.value))
                        .expected("G06.2, G05, G90 or G21")
                        .hint("this reader takes NURBS curves in absolute millimetres");
                }
            }
            None if self.open.is_some() => self.point(report, words),
            None => {
                for word in words {
                    if matches!(word.letter, 'M' | 'S' | 'T') {
                        report.warning(
                            word.span,
                            format!("`{}{}` has no effect on the path", word.letter, word.value),
                        );
                        continue;
                    }
                    report
                        .error(word.span, format!("`{}` outside a curve", word.letter))
                        .expected("a block with G06.2 first");
                }
            }
        }
    }

    /// A control point, or a knot alone.
    fn point(&mut self, report: &mut Report<'_>, words: &[Word]) {
        let Some(open) = &mut self.open else { return };
        let whole = words.iter().map(|w| w.span).reduce(Span::to).unwrap_or_default();
        let (mut knot, mut weight, mut moved) = (None, None, false);
        let mut point = self.position;
        for word in words {
            match word.letter {
                'X' | 'Y' | 'Z' => {
                    point[usize::from(word.letter as u8 - b'X')] = Some(word.value);
                    moved = true;
                }
                'K' => knot = Some((word.value, word.span)),
                'R' => weight = Some((word.value, word.span)),
                'F' if word.value > 0.0 => self.part.feedrate_mm_per_s = Some(word.value / 60.0),
                'F' => {
                    report
                        .error(word.span, format!("feed {} mm/min", word.value))
                        .expected("a positive feed");
                }
                'G' | 'P' => {}
                'M' | 'S' | 'T' => {
                    report.warning(
                        word.span,
                        format!("`{}{}` has no effect on the path", word.letter, word.value),
                    );
                }
                other => {
                    report
                        .error(word.span, format!("`{other}` is no word of G06.2"))
                        .expected("K, X, Y, Z, R, P or F");
                }
            }
        }
        match knot {
            Some(knot) => open.knots.push(knot),
            None => {
                report
                    .error(whole, "a block of G06.2 without a knot")
                    .expected("a word K")
                    .hint("a control stops with alarm 1002");
            }
        }
        if moved {
            if open.points.len() < open.knots.len().saturating_sub(1) {
                report
                    .error(whole, "a control point after the closing knots")
                    .expected("a block with a K alone");
            }
            let here = point.map(|x| x.unwrap_or(0.0));
            let first_is_off =
                open.points.is_empty() && self.position.iter().all(Option::is_some) && point != self.position;
            if first_is_off {
                report
                    .error(whole, "the first control point is off the current position")
                    .expected(format!("the position {:?}", self.position.map(|x| x.unwrap_or(0.0))));
            }
            open.points.push((here, whole));
            open.weights.push(weight.unwrap_or((1.0, whole)));
            self.position = here.map(Some);
        }
    }

    /// Ends the curve that is open, if one is.
    fn close(&mut self, report: &mut Report<'_>) {
        let Some(open) = self.open.take() else { return };
        let points: Vec<[f64; 3]> = open.points.iter().map(|(point, _)| *point).collect();
        let curve = Curve {
            degree: open.order - 1,
            dimension: Curve::dimension_of(&points),
            control_points_mm: points,
            weights: open.weights.iter().map(|(w, _)| *w).collect(),
            knots: open.knots.iter().map(|(u, _)| *u).collect(),
        };
        let faults = curve.faults();
        for fault in &faults {
            let span = match fault.element() {
                Element::ControlPoint(i) => open.points.get(i).map(|(_, span)| *span),
                Element::Weight(i) => open.weights.get(i).map(|(_, span)| *span),
                Element::Knot(i) => open.knots.get(i).map(|(_, span)| *span),
                _ => None,
            };
            report.error(span.unwrap_or(open.start), fault.to_string()).expected(fault.expected());
        }
        if faults.is_empty() {
            let line = report.source.line_number(open.start.start);
            let feedrate_mm_per_s = self.part.feedrate_mm_per_s;
            self.part.moves.push(Move { kind: MoveKind::Feed, shape: Shape::Nurbs, feedrate_mm_per_s, line });
            self.part.curves.push(curve);
        }
    }
}
