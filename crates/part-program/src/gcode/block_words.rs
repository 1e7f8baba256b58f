//! Executes the words of a block in order: preparatory words, words that do not move the tool, the feed, then the
//! motion.

use crate::exact_stops::PathMode;
use crate::gcode::block::Block;
use crate::gcode::modal::Motion;
use crate::gcode::reader::Reader;
use crate::gcode::word::Word;

impl Reader<'_, '_, '_> {
    /// Executes the words of a line, if there are any.
    pub(crate) fn block(&mut self, words: &mut Vec<Word>) {
        let Some(mut block) = Block::new(self.report, words) else { return };
        let span = block.span;
        self.unread = self.unread_name;
        let unit_before = self.modal.feed_unit_mm();
        self.has_g_word = block.has(b'G');
        let Some(motion) = self.preparatory(&mut block) else { return };
        if let Some(motion) = motion {
            if !matches!(motion, Motion::Cycle(_)) || !matches!(self.modal.motion, Motion::Cycle(_)) {
                self.holes.end();
            }
            self.modal.motion = motion;
        }
        self.names_y |= block.has(b'Y');
        self.count_as_ordered(&mut block);
        self.look_for_points(&block);
        let ends = self.auxiliary(&mut block);
        self.side_axes(&mut block);
        self.extruder(&mut block);
        let inverse_feed = self.feed(&mut block, unit_before);
        let unread = self.unread.take().or_else(|| self.shaping_word(&block));
        if unread.is_none()
            && let Some((placing, span)) = self.placing.take()
        {
            self.place_coordinates(&mut block, placing, span);
        } else if unread.is_some() || self.modal.motion == Motion::Unread {
            self.leave_out(&mut block, unread);
        } else {
            self.motion(&mut block, motion.is_some(), inverse_feed);
            self.begin_axes();
        }
        self.leave_out_side_words();
        self.refuse(block);
        if ends {
            self.close(span);
            self.ended = true;
        }
    }

    /// Executes the motion in force; `inverse_feed` is the F word of G93, in 1/min.
    fn motion(&mut self, block: &mut Block<'_>, is_new: bool, inverse_feed: Option<f64>) {
        if !is_new && block.is_empty() && self.others.side.words.is_none() {
            return;
        }
        if self.unread_frames.are_in_force() {
            return self.leave_out(block, None);
        }
        if self.modal.is_lost() && !matches!(self.modal.motion, Motion::None | Motion::Broken) {
            return self.find_again(block, is_new);
        }
        if block.has_axis() && self.motion_is_barred(block) {
            return self.pass_over(block);
        }
        self.end = if self.block_stops { PathMode::ExactStop } else { self.modal.path_mode };
        if block.has_axis() || b"IJK".iter().any(|letter| block.has(*letter)) {
            self.modal.settle();
        }
        let continues = std::mem::take(&mut self.smooth).filter(|_| self.modal.motion == Motion::Cubic);
        match self.modal.motion {
            Motion::None if block.has_axis() => {
                self.report
                    .error(block.span, "coordinates without a motion")
                    .expected("G0, G1, G2, G3 or a spline");
                block.take_axes();
            }
            Motion::Line | Motion::Arc { .. } if self.turns_alone(block) => self.turn_alone(),
            Motion::Rapid | Motion::Line if block.has_axis() => self.straight(block, inverse_feed),
            Motion::Arc { clockwise }
                if is_new || block.has_axis() || b"IJK".iter().any(|c| block.has(*c)) =>
            {
                self.arc(block, clockwise, inverse_feed);
            }
            Motion::ThroughPoint if block.has_axis() => self.through_point(block, inverse_feed),
            Motion::Tangent if block.has_axis() => self.tangent(block, inverse_feed),
            Motion::FanucNurbs | Motion::LinuxCncNurbs | Motion::Bspline => self.spline_block(block, is_new),
            Motion::Cubic | Motion::Quadratic => self.bezier(block, continues),
            Motion::Cycle(cycle) if block.has_axis() => self.drill(block, cycle),
            Motion::WithSpindle { comes_back } if block.has_axis() => self.with_spindle(block, comes_back),
            Motion::Broken => self.pass_over(block),
            _ => {}
        }
    }

    /// Whether side axes move in a block that moves neither X, Y nor Z.
    fn turns_alone(&self, block: &Block<'_>) -> bool {
        let is_arc = matches!(self.modal.motion, Motion::Arc { .. }) && b"IJK".iter().any(|c| block.has(*c));
        self.others.side.words.is_some() && !block.has_axis() && !is_arc
    }

    /// Reports the words that were not taken.
    fn refuse(&mut self, block: Block<'_>) {
        let motion = self.modal.motion;
        for word in block.rest().iter() {
            let text = self.report.source.slice(word.span);
            let name = motion.name();
            let kind = format!("{:?} {name}", word.key);
            let message = format!("`{text}` is no word of {name}");
            let said = self.report.of_kind(!self.options.lenient, word.span, kind, message);
            if !self.options.lenient {
                said.expected(motion.words());
            }
        }
    }
}
