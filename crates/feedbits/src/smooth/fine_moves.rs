//! A smoothed part as a program of straight moves, with what stood between them still in its place.

use std::fmt::Write;

use nurbs_core::Evaluate;
use part_program::{Auxiliary, Curve, Move, MoveKind, Part};

use super::stretch::{length, nurbs_of};

/// Writes every curve as chords that leave it by no more than `chord_error_mm`.
///
/// Rapid moves stay rapid moves, and words that do not move the tool stay before, in or behind the blocks they belong
/// to. Coordinates are rounded to a thousandth of the chord error, and to a nanometre at least.
pub(crate) fn program(part: &Part, chord_error_mm: f64) -> String {
    let mut program = Program::new(chord_error_mm);
    let mut words = part.auxiliary.as_slice();
    if let Some(first) = part.curves.first().and_then(|curve| curve.control_points_mm.first()) {
        program.begin_at(*first);
    }
    for (index, (curve, one)) in part.curves.iter().zip(&part.moves).enumerate() {
        let count = words.partition_point(|word| word.line < one.line);
        program.words_of_their_own(&words[..count]);
        words = &words[count..];
        let is_last = part.moves.get(index + 1).is_none_or(|next| next.line > one.line);
        let own = words.partition_point(|word| word.line <= one.line);
        let (here, rest) = words.split_at(if is_last { own } else { 0 });
        program.curve(curve, one, here);
        words = rest;
    }
    program.words_of_their_own(words);
    program.end(&part.auxiliary)
}

struct Program {
    text: String,
    chord_error_mm: f64,
    decimals: usize,
    position: Option<[f64; 3]>,
    feedrate_mm_per_s: Option<f64>,
}

/// Halvings of a curve's parameter at most.
const MOST_HALVINGS: u32 = 16;

impl Program {
    fn new(chord_error_mm: f64) -> Self {
        let finest = (1..=12).find(|decimals| 0.1_f64.powi(*decimals) <= 1e-3 * chord_error_mm).unwrap_or(12);
        let decimals = usize::try_from(finest.max(6)).unwrap_or(6);
        let text = String::from("G21 G90 G94\n");
        Self {
            text,
            chord_error_mm: chord_error_mm * 0.99,
            decimals,
            position: None,
            feedrate_mm_per_s: None,
        }
    }

    /// Words in blocks of their own, those of one line in one block.
    fn words_of_their_own(&mut self, words: &[Auxiliary]) {
        for block in words.chunk_by(|a, b| a.line == b.line) {
            let block: Vec<_> = block.iter().map(word).collect();
            self.text += &block.join(" ");
            self.text.push('\n');
        }
    }

    fn curve(&mut self, curve: &Curve, one: &Move, words: &[Auxiliary]) {
        let points = self.chords(curve);
        let Some((first, rest)) = points.split_first() else { return };
        self.begin_at(*first);
        for (index, point) in rest.iter().enumerate() {
            let words = if index + 1 == rest.len() { words } else { &[] };
            self.block(*point, one, words);
        }
    }

    /// The ends of the chords, the start of the curve among them.
    fn chords(&self, curve: &Curve) -> Vec<[f64; 3]> {
        let Ok(nurbs) = nurbs_of(curve) else { return curve.control_points_mm.clone() };
        let evaluated = nurbs.as_curve();
        let (begin, _) = evaluated.domain();
        let mut points = vec![evaluated.point(begin)];
        for span in 0..evaluated.span_count() {
            let (from, to) = evaluated.span_bounds(span);
            if curve.degree == 1 {
                points.push(evaluated.point(to));
            } else {
                self.halve(&|u| evaluated.point(u), [from, to], MOST_HALVINGS, &mut points);
            }
        }
        points
    }

    /// Adds the end of [from, to], and what is needed in between.
    fn halve(
        &self,
        point: &impl Fn(f64) -> [f64; 3],
        [from, to]: [f64; 2],
        halvings: u32,
        points: &mut Vec<[f64; 3]>,
    ) {
        let (a, b) = (point(from), point(to));
        let is_off = |share: f64| {
            let on = point(from + (to - from) * share);
            distance_to_chord(&on, &a, &b) > self.chord_error_mm
        };
        if halvings > 0 && [0.125, 0.25, 0.375, 0.5, 0.625, 0.75, 0.875].into_iter().any(is_off) {
            let middle = f64::midpoint(from, to);
            self.halve(point, [from, middle], halvings - 1, points);
            self.halve(point, [middle, to], halvings - 1, points);
        } else {
            points.push(b);
        }
    }

    fn rounded(&self, point: [f64; 3]) -> [f64; 3] {
        let unit = 10.0_f64.powi(i32::try_from(self.decimals).unwrap_or(6));
        // The same decimal as is written, and no negative zero.
        point.map(|x| (x * unit).round() / unit + 0.0)
    }

    /// A rapid move to where a curve begins, unless the tool is there.
    fn begin_at(&mut self, point: [f64; 3]) {
        let point = self.rounded(point);
        if self.position == Some(point) {
            return;
        }
        if self.position.is_none() && point[2] > 0.0 {
            // Up first: where the tool is before the program, nobody knows.
            let _ = writeln!(self.text, "G0 Z{}", self.decimal(point[2]));
            let _ = writeln!(self.text, "G0 X{} Y{}", self.decimal(point[0]), self.decimal(point[1]));
        } else {
            let [x, y, z] = point.map(|x| self.decimal(x));
            let _ = writeln!(self.text, "G0 X{x} Y{y} Z{z}");
        }
        self.position = Some(point);
    }

    fn block(&mut self, point: [f64; 3], one: &Move, words: &[Auxiliary]) {
        let point = self.rounded(point);
        let before = self.position.replace(point);
        if before == Some(point) {
            return self.words_of_their_own(words);
        }
        self.text += if one.kind == MoveKind::Rapid { "G0" } else { "G1" };
        for (axis, letter) in ["X", "Y", "Z"].into_iter().enumerate() {
            if before.is_none_or(|before| before[axis] != point[axis]) {
                let _ = write!(self.text, " {letter}{}", self.decimal(point[axis]));
            }
        }
        if one.kind == MoveKind::Feed && one.feedrate_mm_per_s != self.feedrate_mm_per_s {
            self.feedrate_mm_per_s = one.feedrate_mm_per_s;
            if let Some(feedrate) = one.feedrate_mm_per_s {
                let _ = write!(self.text, " F{}", (feedrate * 60e6).round() / 1e6);
            }
        }
        for one in words {
            let _ = write!(self.text, " {}", word(one));
        }
        self.text.push('\n');
    }

    /// With a decimal point: a control may take a number without one as micrometres.
    fn decimal(&self, x: f64) -> String {
        let text = format!("{x:.*}", self.decimals);
        text.trim_end_matches('0').to_string()
    }

    fn end(mut self, words: &[Auxiliary]) -> String {
        let ends = |word: &Auxiliary| word.letter == 'M' && (word.value == 2.0 || word.value == 30.0);
        if !words.iter().any(ends) {
            self.text += "M30\n";
        }
        self.text
    }
}

fn word(word: &Auxiliary) -> String {
    format!("{}{}", word.letter, word.value)
}

fn distance_to_chord(point: &[f64; 3], a: &[f64; 3], b: &[f64; 3]) -> f64 {
    let (mut along, mut square) = (0.0, 0.0);
    for d in 0..3 {
        along += (point[d] - a[d]) * (b[d] - a[d]);
        square += (b[d] - a[d]) * (b[d] - a[d]);
    }
    let u = if square > 0.0 { (along / square).clamp(0.0, 1.0) } else { 0.0 };
    length(&std::array::from_fn(|d| a[d] + u * (b[d] - a[d]) - point[d]))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn fine(text: &str) -> String {
        program(&part_program::read_part("p.nc", text).unwrap(), 1e-3)
    }

    #[test]
    fn straight_moves_and_what_is_between_them_stay() {
        let text = "G21 G90 G94\nG0 Z5.\nG0 X1. Y2.\nM3 S12000\nG0 X3.5\nG1 Z-0.2 F300\nG1 X9. F2400\nG1 Y-1. M8\nM9\nG0 Z5.\nM5\nM30\n";
        let source = text.replace("G21 G90 G94\n", "G21 G90\n(comment)\n");
        // The first two blocks set where the tool is; no move is known before them.
        assert_eq!(fine(&source), text);
        assert_eq!(
            fine("G91 G20 G1 X0 Y0 Z0 F10\nX1\nX1\n"),
            "G21 G90 G94\nG0 X0. Y0. Z0.\nG1 X25.4 F254\nG1 X50.8\nM30\n"
        );
    }

    #[test]
    fn arcs_become_chords_within_the_error() {
        let text = fine("G1 X5 Y0 F60\nG3 X0 Y5 I-5 J0 M8\nM30\n");
        let part = part_program::read_part("again.nc", &text).unwrap();
        // A chord of 1e-3 mm error turns by 2 acos(1 - 1e-3/5), 40 to a quarter turn; halving makes it a power of two.
        assert_eq!(part.curves.len(), 64);
        for curve in &part.curves {
            let [a, b] = [curve.control_points_mm[0], curve.control_points_mm[1]];
            let middle = f64::midpoint(a[0], b[0]).hypot(f64::midpoint(a[1], b[1]));
            assert!(middle < 5.0 && middle > 5.0 - 1e-3, "{middle}");
        }
        assert!(text.contains(" M8\nM30\n"), "{text}");
    }
}
