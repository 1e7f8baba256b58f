//! Parts to part programs. Numbers are written as the shortest decimals that read back as the same f64, and with a
//! decimal point, since a control may take a number without one as micrometres.
//!
//! Rapid moves stay G0 and straight moves G1, whatever becomes of the curves between them. Words that do not move the
//! tool stay at their moves: M0, M1, M5 and M9 of a move's own block behind it, all others before it. The way to the first curve
//! is written where the program had it, among them.
//!
//! A part in the plane Z = 0 is written without Z, but for the way to it if the program names Z.
//!
//! An exact stop is G61 before the block that ends in it, G61.1 for LinuxCNC, whose G61 passes smooth joints, G60 for Siemens;
//! G64 stands before the next block at feed without one.

use std::fmt::{self, Write};

use crate::MAX_TEXT;
use crate::approach::Approach;
use crate::bezier;
use crate::curve::Curve;
use crate::gcode::LEAST_ORDER;
use crate::options::Dialect;
use crate::part::{Auxiliary, Move, MoveKind, Part};
use crate::spline_blocks::uniform_knots;

/// Most chords of one program.
const MAX_CHORDS: usize = 5_000_000;
/// Chords that are counted at most, to say how many a program would need.
const MAX_COUNTED: usize = 4 * MAX_CHORDS;
/// Halvings of a span at most: 2²⁰ chords.
const MAX_HALVINGS: u32 = 20;

/// Why a part cannot be written.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub enum WriteError {
    /// G5.2 is planar, and the curve leaves its plane.
    NotPlanar {
        /// Index of the curve.
        curve: usize,
        /// Line of the move that it belongs to.
        line: usize,
    },
    /// A rapid move that is not straight.
    CurvedRapid {
        /// Index of the curve.
        curve: usize,
        /// Line of the move that it belongs to.
        line: usize,
    },
    /// The tolerance asks for more than 2²⁰ chords in one span.
    SpanTooFine {
        /// Index of the curve.
        curve: usize,
        /// Line of the move that it belongs to.
        line: usize,
    },
    /// The tolerance asks for more than five million chords.
    TooManyChords {
        /// So many at least: counting ends beyond twenty million.
        needed: usize,
    },
    /// The program is longer than [`MAX_TEXT`], so that no reader of this crate takes it.
    TooLong {
        /// Its length.
        bytes: usize,
    },
}

impl fmt::Display for WriteError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::NotPlanar { line, .. } => {
                write!(f, "the curve of line {line} leaves its plane: G5.2 takes X and Y only")
            }
            Self::CurvedRapid { line, .. } => {
                write!(f, "the rapid move of line {line} is not straight: G0 is")
            }
            Self::SpanTooFine { line, .. } => {
                write!(
                    f,
                    "the tolerance takes more than 2^{MAX_HALVINGS} chords in a span of the curve of line {line}: "
                )?;
                f.write_str("give a larger one")
            }
            Self::TooManyChords { needed } => {
                write!(
                    f,
                    "the tolerance takes at least {needed} chords, and a program has at most {MAX_CHORDS}: "
                )?;
                f.write_str("give a larger one")
            }
            Self::TooLong { bytes } => {
                write!(f, "the program takes {bytes} bytes, and at most {MAX_TEXT} (64 MiB) are read back")
            }
        }
    }
}

impl std::error::Error for WriteError {}

/// Writes a part as G1 moves that leave its curves by no more than `tolerance_mm`.
///
/// The bound is proven, by the convex hulls of Bézier pieces. Ends of curves are written to the last bit; points
/// between them are rounded to a thousandth of the tolerance, or to less. The control `dialect` says which word an exact stop is;
/// without one it is G61, by which LinuxCNC passes smooth joints.
///
/// # Errors
/// [`WriteError::CurvedRapid`], [`WriteError::SpanTooFine`], [`WriteError::TooManyChords`], [`WriteError::TooLong`].
pub fn write_g1(part: &Part, tolerance_mm: f64, dialect: Option<Dialect>) -> Result<String, WriteError> {
    let exact_stop = match dialect {
        Some(Dialect::LinuxCnc | Dialect::Canon) => "G61.1",
        Some(Dialect::Siemens) => "G60",
        Some(Dialect::Fanuc) | None => EXACT_STOP,
    };
    let decimals = (0..15).find(|decimals| 0.1_f64.powi(*decimals) <= 1e-3 * tolerance_mm).unwrap_or(15);
    let unit = 10.0_f64.powi(decimals);
    let mut count = 0;
    let text = write(part, None, exact_stop, |program, index, curve| {
        let mut ends = Vec::new();
        for piece in bezier::pieces(curve) {
            let before = ends.len();
            // Rounding moves each coordinate by half a unit at most.
            piece
                .chords(tolerance_mm - 1.0 / unit, MAX_HALVINGS, &mut ends)
                .ok_or(WriteError::SpanTooFine { curve: index, line: line_of(part, index) })?;
            count += ends.len() - before;
            if count > MAX_COUNTED {
                return Err(WriteError::TooManyChords { needed: count });
            }
            if count > MAX_CHORDS {
                ends.clear();
            }
        }
        if count > MAX_CHORDS {
            return Ok(());
        }
        ends.pop();
        for end in &mut ends {
            *end = end.map(|x| (x * unit).round() / unit);
        }
        ends.extend(curve.control_points_mm.last());
        program.lines_to_end(ends);
        Ok(())
    })?;
    if count > MAX_CHORDS { Err(WriteError::TooManyChords { needed: count }) } else { readable(text) }
}

/// Writes a part with its curves as FANUC's G06.2. Reading it back gives every control point, weight and knot bit by
/// bit.
///
/// Between curves that do not join stands a G0, which is read back as a rapid move.
///
/// # Errors
/// [`WriteError::CurvedRapid`], [`WriteError::TooLong`].
pub fn write_g06_2(part: &Part) -> Result<String, WriteError> {
    let has_curves = part.curves.iter().any(|curve| !is_line(curve));
    let around = has_curves.then_some(["G05 P10000", "G05 P0"]);
    let text = write(part, around, EXACT_STOP, |program, _, curve| {
        program.path_mode(true);
        for (i, ((point, weight), knot)) in
            curve.control_points_mm.iter().zip(&curve.weights).zip(&curve.knots).enumerate()
        {
            if i == 0 {
                program.word("G06.2 P", curve.degree + 1);
            }
            program.number("K", *knot);
            program.point(*point);
            program.number("R", *weight);
            program.end_block();
        }
        for knot in curve.knots.iter().skip(curve.control_points_mm.len()) {
            program.number("K", *knot);
            program.end_block();
        }
        Ok(())
    })?;
    readable(text)
}

/// Writes a part with its curves, which have to be planar, as LinuxCNC's G5.2, which has no word for knots.
///
/// A curve of knots 0 …, 1, 2, … is read back bit by bit; one of other uniform knots is the same curve with those
/// knots. Any other is cut at its knots into Bézier curves, which are the same points to rounding. Degree 1, which
/// G5.2 does not have, becomes G1 moves.
///
/// # Errors
/// [`WriteError::NotPlanar`] when z changes along a curve, [`WriteError::CurvedRapid`], [`WriteError::TooLong`].
pub fn write_g5_2(part: &Part) -> Result<String, WriteError> {
    let text = write(part, None, "G61.1", |program, index, curve| {
        let height = curve.control_points_mm.first().map_or(0.0, |point| point[2]);
        if curve.degree + 1 < LEAST_ORDER {
            program.lines_to_end(curve.control_points_mm.get(1..).unwrap_or_default().to_vec());
        } else if curve.control_points_mm.iter().any(|point| point[2] != height) {
            return Err(WriteError::NotPlanar { curve: index, line: line_of(part, index) });
        } else if has_uniform_knots(curve) {
            program.path_mode(true);
            program.g5_2(curve.degree, &curve.control_points_mm, &curve.weights);
        } else {
            let mut pieces = bezier::pieces(curve);
            // The curve stands still over such a span, and G5.2 has no such curve.
            pieces.retain(|piece| piece.points_mm().windows(2).any(|pair| pair[0] != pair[1]));
            for (number, piece) in pieces.iter().enumerate() {
                let mut points = piece.points_mm();
                program.path_mode(number + 1 == pieces.len());
                if let (true, Some(end), Some(last)) =
                    (number + 1 == pieces.len(), points.last_mut(), curve.control_points_mm.last())
                {
                    *end = *last;
                }
                program.g5_2(curve.degree, &points, &piece.weights());
            }
        }
        Ok(())
    })?;
    readable(text)
}

/// A program that is not too long to be read back.
fn readable(text: String) -> Result<String, WriteError> {
    if text.len() > MAX_TEXT { Err(WriteError::TooLong { bytes: text.len() }) } else { Ok(text) }
}

fn line_of(part: &Part, curve: usize) -> usize {
    part.moves.get(curve).map_or(0, |one| one.line)
}

/// Exact stop, where a dialect has no word of its own for it.
const EXACT_STOP: &str = "G61";

/// Writes a part, with `write_curve` for what is neither rapid nor a straight move, between a first and a last line.
fn write(
    part: &Part,
    around: Option<[&str; 2]>,
    exact_stop: &'static str,
    mut write_curve: impl FnMut(&mut Program, usize, &Curve) -> Result<(), WriteError>,
) -> Result<String, WriteError> {
    let is_planar = !part.curves.iter().any(Curve::leaves_z_0);
    let mut program = Program { exact_stop, ..Program::new(is_planar) };
    around.into_iter().for_each(|[first, _]| program.line(first));
    let all: Vec<_> = part.auxiliary.iter().collect();
    let mut words = Words(&all);
    let mut approaches = part.whole_approaches().into_iter().peekable();
    for (index, (curve, one)) in part.curves.iter().zip(&part.moves).enumerate() {
        while let Some(approach) = approaches.next_if(|approach| approach.block <= one.block) {
            program.auxiliary(words.before(approach.block));
            // Words of a block that makes a curve too are the curve's.
            let is_own = approach.block < one.block && part.approaches_in(approach.block);
            let [ahead, behind] = words.of_block(approach.block, is_own);
            program.auxiliary(&ahead);
            program.approach(&approach, curve, one);
            program.auxiliary(&behind);
        }
        program.auxiliary(words.before(one.block));
        // Several curves may come from one block: its words are written once, at the last of them.
        let is_last = part.moves.get(index + 1).is_none_or(|next| next.block > one.block);
        let [ahead, behind] = words.of_block(one.block, is_last);
        program.auxiliary(&ahead);
        program.curve(index, curve, one, &mut write_curve)?;
        program.auxiliary(&behind);
    }
    program.auxiliary(words.0);
    around.into_iter().for_each(|[_, last]| program.line(last));
    Ok(program.end())
}

/// Words that do not move the tool and are still to be written, in the order of the program.
struct Words<'w, 'p>(&'w [&'p Auxiliary]);

impl<'w, 'p> Words<'w, 'p> {
    /// Takes those of the blocks before one.
    fn before(&mut self, block: u32) -> &'w [&'p Auxiliary] {
        let (before, rest) = self.0.split_at(self.0.partition_point(|word| word.block < block));
        self.0 = rest;
        before
    }

    /// Takes those of a move's own block, if `is_last` of its moves: ahead of the move, and behind it.
    fn of_block(&mut self, block: u32, is_last: bool) -> [Vec<&'p Auxiliary>; 2] {
        let own = if is_last { self.before(block.saturating_add(1)) } else { &[] };
        let (behind, ahead) = own.iter().copied().partition(|word| word.is_behind());
        [ahead, behind]
    }
}

impl Auxiliary {
    /// Whether the word acts when the move of its block is over.
    fn is_behind(&self) -> bool {
        self.letter == 'M' && [0.0, 1.0, 5.0, 9.0].contains(&self.value)
    }
}

/// Whether a curve is a straight move as G1 is read.
fn is_line(curve: &Curve) -> bool {
    curve.degree == 1 && curve.weights == [1.0; 2] && curve.knots == [0.0, 0.0, 1.0, 1.0]
}

/// Whether the knots are those of G5.2, up to origin and unit.
fn has_uniform_knots(curve: &Curve) -> bool {
    let uniform = || uniform_knots(curve.control_points_mm.len(), curve.degree);
    let first = curve.knots.first().copied().unwrap_or(0.0);
    let unit = curve.knots.iter().find(|knot| **knot > first).map_or(1.0, |knot| knot - first);
    uniform().zip(&curve.knots).all(|(u, knot)| first + u * unit == *knot)
}

/// The F word, in mm/min: the shortest decimal that reads back as a feedrate in mm/s.
fn feed_word(feedrate_mm_per_s: f64) -> f64 {
    const DECIMALS: i32 = 12;
    let near = feedrate_mm_per_s * 60.0;
    let decimals = (0..=DECIMALS).map(|decimals| {
        let unit = 10.0_f64.powi(decimals);
        (near * unit).round() / unit
    });
    let reads_back = |feed: &f64| feed / 60.0 == feedrate_mm_per_s;
    decimals.chain([near, near.next_down(), near.next_up()]).find(reads_back).unwrap_or(near)
}

/// A program that is being written.
struct Program {
    text: String,
    planar: bool,
    /// Where the tool is, as written.
    position: [Option<f64>; 3],
    /// In mm/s: the feedrate that holds, as written.
    feedrate: Option<f64>,
    /// F, in mm/min, until it is written.
    feed: Option<f64>,
    /// The word for exact stop.
    exact_stop: &'static str,
    /// Whether it holds, as written.
    stops: bool,
    /// Whether the move at hand ends in one.
    ends_at_rest: bool,
    block: String,
}

impl Program {
    fn new(planar: bool) -> Self {
        let text = "G21 G90 G94\n".into();
        Self {
            text,
            planar,
            position: [None; 3],
            feedrate: None,
            feed: None,
            exact_stop: EXACT_STOP,
            stops: false,
            ends_at_rest: false,
            block: String::new(),
        }
    }

    fn set_feed(&mut self, feedrate_mm_per_s: Option<f64>) {
        if let Some(feedrate) = feedrate_mm_per_s.filter(|feedrate| self.feedrate != Some(*feedrate)) {
            self.feedrate = Some(feedrate);
            self.feed = Some(feed_word(feedrate));
        }
    }

    /// Words that do not move the tool, those of one line in one block. The end of the program is written at its end.
    fn auxiliary(&mut self, words: &[&Auxiliary]) {
        let ends = |word: &Auxiliary| word.letter == 'M' && (word.value == 2.0 || word.value == 30.0);
        for block in words.chunk_by(|a, b| a.block == b.block) {
            for word in block.iter().filter(|word| !ends(word)) {
                self.word(word.letter.encode_utf8(&mut [0; 4]), word.value);
            }
            if !self.block.is_empty() {
                self.text.push_str(&self.block);
                self.text.push('\n');
                self.block.clear();
            }
        }
    }

    fn curve(
        &mut self,
        index: usize,
        curve: &Curve,
        one: &Move,
        write_curve: &mut impl FnMut(&mut Self, usize, &Curve) -> Result<(), WriteError>,
    ) -> Result<(), WriteError> {
        let Some((first, rest)) = curve.control_points_mm.split_first() else { return Ok(()) };
        if one.kind == MoveKind::Rapid {
            self.line_through("G0", &[*first]);
            if curve.degree > 1 {
                return Err(WriteError::CurvedRapid { curve: index, line: one.line });
            }
            self.line_through("G0", rest);
            return Ok(());
        }
        self.set_feed(one.feedrate_mm_per_s);
        self.line_through("G0", &[*first]);
        self.ends_at_rest = one.exact_stop;
        if is_line(curve) {
            self.lines_to_end(rest.to_vec());
        } else {
            write_curve(self, index, curve)?;
        }
        self.position = rest.last().unwrap_or(first).map(Some);
        Ok(())
    }

    /// Straight moves at feed to the end of the move at hand.
    fn lines_to_end(&mut self, mut points: Vec<[f64; 3]>) {
        // What comes to the end before it would leave no block to stop at.
        points.dedup();
        let Some((end, inner)) = points.split_last() else { return };
        if !inner.is_empty() {
            self.path_mode(false);
            self.line_through("G1", inner);
        }
        self.path_mode(true);
        self.line_through("G1", &[*end]);
    }

    /// Says whether the next block, which ends the move at hand if `is_last`, ends in an exact stop.
    fn path_mode(&mut self, is_last: bool) {
        let stops = is_last && self.ends_at_rest;
        if stops != self.stops {
            self.stops = stops;
            self.line(if stops { self.exact_stop } else { "G64" });
        }
    }

    fn line(&mut self, line: &str) {
        self.text.push_str(line);
        self.text.push('\n');
    }

    fn word(&mut self, address: &str, number: impl fmt::Display) {
        if !self.block.is_empty() {
            self.block.push(' ');
        }
        // Writing to a String does not fail.
        let _ = write!(self.block, "{address}{number}");
    }

    fn number(&mut self, address: &str, number: f64) {
        self.word(address, number);
        if number.fract() == 0.0 {
            self.block.push('.');
        }
    }

    fn point(&mut self, point: [f64; 3]) {
        self.coordinates(point, self.axes());
    }

    /// The axes that each point is written with.
    fn axes(&self) -> [bool; 3] {
        [true, true, !self.planar]
    }

    fn coordinates(&mut self, point: [f64; 3], axes: [bool; 3]) {
        for ((address, value), _) in
            ["X", "Y", "Z"].into_iter().zip(point).zip(axes).filter(|(_, is_written)| *is_written)
        {
            self.number(address, value);
        }
    }

    fn end_block(&mut self) {
        if !self.block.starts_with("G0 ")
            && let Some(feed) = self.feed.take()
        {
            self.number("F", feed);
        }
        self.block.push('\n');
        self.text.push_str(&self.block);
        self.block.clear();
    }

    /// Whether the tool is at a point, to the last bit, as far as these axes say.
    fn is_at(&self, point: [f64; 3], axes: [bool; 3]) -> bool {
        let is_there =
            |axis: usize| self.position[axis].is_some_and(|here| here.to_bits() == point[axis].to_bits());
        (0..3).all(|axis| !axes[axis] || is_there(axis))
    }

    /// A move of axes to where the next curve begins, unless the tool is there.
    ///
    /// Where the tool is before, nobody knows: in one block with others, Z goes up before them, and down once they are there, at the
    /// feed of the curve if that has one.
    fn approach(&mut self, approach: &Approach, curve: &Curve, one: &Move) {
        let Some(&to) = curve.control_points_mm.first() else { return };
        let [x, y, z] = approach.axes;
        if self.is_at(to, approach.axes) {
            return;
        }
        // From where the program has been, a move at feed would cut what it did not.
        let was_known = (0..3).any(|axis| approach.axes[axis] && self.position[axis].is_some());
        let is_rapid = approach.kind == MoveKind::Rapid || was_known;
        let own_feedrate = approach.feedrate_mm_per_s.or(one.feedrate_mm_per_s).filter(|_| !is_rapid);
        let feedrate_down = own_feedrate.or(one.feedrate_mm_per_s).filter(|_| !was_known);
        if !(z && (x || y)) {
            self.bring(approach.axes, to, own_feedrate);
        } else if to[2] > 0.0 {
            self.bring([false, false, true], to, own_feedrate);
            self.bring(approach.axes, to, own_feedrate);
        } else {
            self.bring([x, y, false], to, own_feedrate);
            self.bring([false, false, true], to, feedrate_down);
        }
    }

    /// A straight move of some axes, rapid without a feedrate.
    fn bring(&mut self, axes: [bool; 3], to: [f64; 3], feedrate_mm_per_s: Option<f64>) {
        self.set_feed(feedrate_mm_per_s);
        self.block.push_str(if feedrate_mm_per_s.is_some() { "G1" } else { "G0" });
        self.coordinates(to, axes);
        self.end_block();
        for axis in (0..3).filter(|axis| axes[*axis]) {
            self.position[axis] = Some(to[axis]);
        }
    }

    /// Straight moves from point to point; none to where the tool is.
    fn line_through(&mut self, motion: &str, points: &[[f64; 3]]) {
        for point in points {
            if self.is_at(*point, self.axes()) {
                continue;
            }
            self.block.push_str(motion);
            self.point(*point);
            self.end_block();
            self.position = point.map(Some);
        }
    }

    fn g5_2(&mut self, degree: usize, points: &[[f64; 3]], weights: &[f64]) {
        for (i, (point, weight)) in points.iter().zip(weights).enumerate() {
            if i == 0 {
                self.block.push_str("G5.2");
            } else {
                self.number("X", point[0]);
                self.number("Y", point[1]);
            }
            self.number("P", *weight);
            if i == 0 {
                self.word("L", degree + 1);
            }
            self.end_block();
        }
        self.line("G5.3");
    }

    fn end(mut self) -> String {
        self.ends_at_rest = false;
        self.path_mode(true);
        self.line("M30");
        self.text
    }
}
