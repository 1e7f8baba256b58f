//! Words of the side axes, A, B, C, U, V and W.
//!
//! An axis that stays at its place changes nothing. One that moves in a rapid move turns the part between two cuts: the
//! machine rests there. One that moves beside a straight move or an arc at feed goes along with it, evenly with the
//! way, and F holds along X, Y and Z; FANUC's F holds along all axes of a straight move together, where a degree counts
//! as one mm or inch. One that moves at feed alone turns the part while the tool stands still: how long that takes is no
//! part of the path. Beside all other moves, such as splines and holes, a side axis is refused.
//!
//! # Source
//! LinuxCNC, G-Code overview, "Feed rate"; RS274/NGC Interpreter (NISTIR 6556), section 2.1.2.5; FANUC Series 30i,
//! B-63944EN/03, section 4.4, for F of a straight move of linear and rotary axes.

use crate::auxiliary::Auxiliary;
use crate::gcode::block::Block;
use crate::gcode::modal::{FeedMode, Motion};
use crate::gcode::other_axes::SideWords;
use crate::gcode::placing::Placing;
use crate::gcode::reader::Reader;
use crate::gcode::word::{Key, Word};
use crate::options::Dialect;
use crate::side_axes::SIDE_AXES;
use crate::source::Span;

/// The number of the first axis whose places are lengths.
const FIRST_LINEAR: usize = 3;

impl Reader<'_, '_, '_> {
    /// Takes the words of the side axes. What they move waits for the curve of the block.
    pub(crate) fn side_axes(&mut self, block: &mut Block<'_>) {
        let words = b"ABCUVW".map(|letter| block.take_letter(letter));
        if words.iter().all(Option::is_none) {
            return;
        }
        if let Some((placing, _)) = self.placing {
            return self.place_side_axes(placing, &words);
        }
        let cuts = !matches!(self.modal.motion, Motion::Rapid | Motion::None);
        let refused = self.refusal_beside(block);
        let mut ways: [Option<(f64, f64)>; 6] = [None; 6];
        let mut first = None;
        for (axis, word) in words.iter().enumerate() {
            let Some(word) = word else { continue };
            let (from, to) = self.side_move(axis, word, cuts);
            if from == to {
                continue;
            }
            if !cuts {
                self.turn_at_rest(axis, to, word.span);
            } else if let Some(why) = refused {
                let text = self.report.source.slice(word.span);
                let message = format!("`{text}` moves an axis that is not followed {why}");
                let said = self.report.of_kind(
                    !self.options.lenient,
                    word.span,
                    format!("{} {why}", SIDE_AXES[axis]),
                    message,
                );
                said.expected("side axes beside straight moves and arcs alone");
            } else {
                ways[axis] = Some((from, to));
                first = first.or(Some(word.span));
            }
        }
        if first.is_some() {
            self.say_feed_rule(block, words.iter().flatten().next().map_or(block.span, |word| word.span));
        }
        // All others stand where they are now: a word may just have said where.
        let at = self.others.side.at;
        let ends = |of: fn((f64, f64)) -> f64| {
            std::array::from_fn(|axis| ways[axis].map_or_else(|| at[axis].unwrap_or(0.0), of))
        };
        self.others.side.words =
            first.map(|span| SideWords { from: ends(|way| way.0), to: ends(|way| way.1), span });
    }

    /// From where to where a word moves its axis, in degrees or mm; the axis is then there. The first number of an axis
    /// gives its place, unless the tool cuts on the way there: then it begins at 0.
    fn side_move(&mut self, axis: usize, word: &Word, cuts: bool) -> (f64, f64) {
        let value = self.side_value(axis, word.value);
        let before = self.others.side.at[axis];
        let is_lost = std::mem::take(&mut self.others.side.is_lost[axis]);
        let to = match before {
            Some(before) if self.modal.incremental => before + value,
            _ => value,
        };
        if is_lost && cuts {
            let text = self.report.source.slice(word.span);
            let message = format!("`{text}`: where this axis is is not known");
            let said = self.report.of_kind(
                !self.options.lenient,
                word.span,
                format!("{} lost", SIDE_AXES[axis]),
                message,
            );
            said.expected("a rapid move to a place of this axis before it");
        }
        self.others.side.at[axis] = Some(to);
        (before.unwrap_or(if cuts && !is_lost { 0.0 } else { to }), to)
    }

    fn side_value(&self, axis: usize, value: f64) -> f64 {
        if axis < FIRST_LINEAR { value } else { self.modal.mm(value) }
    }

    /// Words of side axes that are no ends of a move. G92 gives the present places other numbers; behind all others but
    /// those without effect the places are not known.
    fn place_side_axes(&mut self, placing: Placing, words: &[Option<Word>; 6]) {
        for (axis, word) in words.iter().enumerate() {
            let Some(word) = word else { continue };
            let value = self.side_value(axis, word.value);
            let side = &mut self.others.side;
            match placing {
                Placing::SetPosition => {
                    side.shift[axis] += side.at[axis].map_or(0.0, |at| at - value);
                    (side.at[axis], side.is_lost[axis]) = (Some(value), false);
                }
                Placing::Ignored => {}
                _ => (side.at[axis], side.is_lost[axis]) = (None, true),
            }
        }
    }

    /// Why a side axis cannot move beside the motion of this block; `None` if it can.
    fn refusal_beside(&self, block: &Block<'_>) -> Option<&'static str> {
        const CORNERS: [Key; 3] = [Key::CornerRadius, Key::CornerDistance, Key::Chamfer];
        if !matches!(self.modal.motion, Motion::Line | Motion::Arc { .. }) {
            Some("while the tool cuts in this motion")
        } else if self.compensation.is_some() || self.off_contour.is_some() {
            Some("under cutter compensation")
        } else if self.corner.is_some() || block.words().iter().any(|word| CORNERS.contains(&word.key)) {
            Some("beside a corner that is rounded or cut off")
        } else {
            None
        }
    }

    /// An axis that moves while nothing is cut.
    fn turn_at_rest(&mut self, axis: usize, to: f64, span: Span) {
        let (text, letter) = (self.report.source.slice(span), SIDE_AXES[axis]);
        let message = format!("`{text}` turns the part: its path is read as it runs on X, Y and Z");
        self.report.of_kind(false, span, letter, message);
        self.rest_at_turn(axis, to, span);
    }

    fn rest_at_turn(&mut self, axis: usize, to: f64, span: Span) {
        let (line, block) = (self.line_of(span), self.place(span).block);
        self.part.auxiliary.push(Auxiliary::new(SIDE_AXES[axis], to, line, block));
    }

    /// Side axes that move at feed while X, Y and Z stand still: the tool rests until they are there.
    pub(crate) fn turn_alone(&mut self) {
        let Some(SideWords { from, to, span }) = self.others.side.words.take() else { return };
        let text = self.report.source.slice(span);
        let message =
            format!("`{text}` turns the part alone: the tool rests, for how long is no part of the path");
        self.report
            .of_kind(false, span, format!("{} alone", text.get(..1).unwrap_or_default()), message)
            .note();
        for axis in (0..SIDE_AXES.len()).filter(|axis| from[*axis] != to[*axis]) {
            self.rest_at_turn(axis, to[axis], span);
        }
    }

    /// The block made no curve along which its side axes could move. Where they are is then not known.
    pub(crate) fn leave_out_side_words(&mut self) {
        let Some(SideWords { from, to, .. }) = self.others.side.words.take() else { return };
        for axis in (0..SIDE_AXES.len()).filter(|axis| from[*axis] != to[*axis]) {
            (self.others.side.at[axis], self.others.side.is_lost[axis]) = (None, true);
        }
    }

    /// Says once which rule of F is taken where no control is named.
    fn say_feed_rule(&mut self, block: &Block<'_>, span: Span) {
        if self.options.dialect.is_none() && block.has_axis() && self.modal.feed_mode == FeedMode::PerMinute {
            let text = self.report.source.slice(span);
            let message = format!("beside `{text}` F is read as the feed along X, Y and Z, as LinuxCNC does");
            self.report
                .of_kind(false, span, "feed beside a side axis", message)
                .hint("FANUC's F counts a degree as a mm, as with its dialect given");
        }
    }

    /// The feed along X, Y and Z of a straight move of this length, in mm/s, if F makes `feed` of it: FANUC's F holds
    /// along all axes, F L/√(L² + Δ²), where Δ are the ways of the side axes.
    pub(crate) fn feed_beside(&self, length_mm: f64, feed: Option<f64>) -> Option<f64> {
        let is_shared =
            self.options.dialect == Some(Dialect::Fanuc) && self.modal.feed_mode == FeedMode::PerMinute;
        let Some(words) = self.others.side.words.filter(|_| is_shared) else { return feed };
        let ways = (0..SIDE_AXES.len()).map(|axis| {
            let way = words.to[axis] - words.from[axis];
            if axis < FIRST_LINEAR { self.modal.mm(way) } else { way }
        });
        let all = ways.fold(length_mm, f64::hypot);
        feed.map(|feed| feed * length_mm / all)
    }
}
