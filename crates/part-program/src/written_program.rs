//! A program that is being written: its text, and the state that this text gives to the machine.

use std::fmt::{self, Write};

use crate::approach::Approach;
use crate::auxiliary::Auxiliary;
use crate::curve::Curve;
use crate::moves::{Move, MoveKind};
use crate::write_error::WriteError;

/// Exact stop, where a dialect has no word of its own for it.
pub(crate) const EXACT_STOP: &str = "G61";

/// A program that is being written.
pub(crate) struct Program {
    text: String,
    planar: bool,
    /// The place of the tool according to the text.
    position: [Option<f64>; 3],
    /// In mm/s: the feedrate that holds, as written.
    feedrate: Option<f64>,
    /// F, in mm/min, until it is written.
    feed: Option<f64>,
    /// The word for exact stop.
    exact_stop: &'static str,
    /// Whether it is in force according to the text.
    stops: bool,
    /// Whether the move at hand ends in one.
    ends_at_rest: bool,
    block: String,
}

impl Program {
    /// The first line of a program in which `exact_stop` is the word for an exact stop.
    pub(crate) fn new(planar: bool, exact_stop: &'static str) -> Self {
        let text = "G21 G90 G94\n".into();
        Self {
            text,
            planar,
            position: [None; 3],
            feedrate: None,
            feed: None,
            exact_stop,
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

    /// Writes words that do not move the tool, those of one line in one block. The end of the program is written last.
    pub(crate) fn auxiliary(&mut self, words: &[&Auxiliary]) {
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

    pub(crate) fn curve(
        &mut self,
        index: usize,
        curve: &Curve,
        one: &Move,
        write_curve: &mut impl FnMut(&mut Self, usize, &Curve) -> Result<(), WriteError>,
    ) -> Result<(), WriteError> {
        let Some((first, rest)) = curve.control_points_mm().split_first() else { return Ok(()) };
        if one.kind == MoveKind::Rapid {
            self.line_through("G0", &[*first]);
            if curve.degree() > 1 {
                return Err(WriteError::CurvedRapid { curve: index, line: one.line });
            }
            self.line_through("G0", rest);
            return Ok(());
        }
        self.set_feed(one.feedrate_mm_per_s);
        self.line_through("G0", &[*first]);
        self.ends_at_rest = one.exact_stop;
        if curve.is_straight_move() {
            self.lines_to_end(rest.to_vec());
        } else {
            write_curve(self, index, curve)?;
        }
        self.position = rest.last().unwrap_or(first).map(Some);
        Ok(())
    }

    /// Straight moves at feed to the end of the move at hand.
    pub(crate) fn lines_to_end(&mut self, mut points: Vec<[f64; 3]>) {
        // A move that reaches the end too early would leave no block at which to stop.
        points.dedup();
        let Some((end, inner)) = points.split_last() else { return };
        if !inner.is_empty() {
            self.path_mode(false);
            self.line_through("G1", inner);
        }
        self.path_mode(true);
        self.line_through("G1", &[*end]);
    }

    /// Sets whether the next block, which ends the current move if `is_last`, ends in an exact stop.
    pub(crate) fn path_mode(&mut self, is_last: bool) {
        let stops = is_last && self.ends_at_rest;
        if stops != self.stops {
            self.stops = stops;
            self.line(if stops { self.exact_stop } else { "G64" });
        }
    }

    pub(crate) fn line(&mut self, line: &str) {
        self.text.push_str(line);
        self.text.push('\n');
    }

    pub(crate) fn word(&mut self, address: &str, number: impl fmt::Display) {
        if !self.block.is_empty() {
            self.block.push(' ');
        }
        // Writing to a String cannot fail.
        let _ = write!(self.block, "{address}{number}");
    }

    pub(crate) fn number(&mut self, address: &str, number: f64) {
        self.word(address, number);
        if number.fract() == 0.0 {
            self.block.push('.');
        }
    }

    pub(crate) fn point(&mut self, point: [f64; 3]) {
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

    pub(crate) fn end_block(&mut self) {
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

    /// Moves axes to the begin of the next curve, unless the tool is there.
    ///
    /// The place of the tool before is unknown. So Z moves apart from the other axes. It goes up before them, or it goes
    /// down after them, at the feed of the curve if that has one.
    pub(crate) fn approach(&mut self, approach: &Approach, curve: &Curve, one: &Move) {
        let Some(&to) = curve.control_points_mm().first() else { return };
        let [x, y, z] = approach.axes;
        if self.is_at(to, approach.axes) {
            return;
        }
        // From the place that the program has reached, a move at feed would cut material that the part leaves.
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

    pub(crate) fn g5_2(&mut self, degree: usize, points: &[[f64; 3]], weights: &[f64]) {
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

    pub(crate) fn end(mut self) -> String {
        self.ends_at_rest = false;
        self.path_mode(true);
        self.line("M30");
        self.text
    }
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
