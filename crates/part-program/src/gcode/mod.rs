//! Part programs: blocks of words, with modal state, to curves.
//!
//! A line becomes words, variables with their new values, and at most one command (`word`, `command_line`, `expression`). The order in
//! which lines are executed is that of `flow`, `o_words` and `marks`. What a block of words does is here and in the files named below.
//!
//! | words | meaning | file |
//! |---|---|---|
//! | G0 G1 G33 G33.1 | straight moves: curves of degree 1 | `path_move` |
//! | G2 G3 with I J K or R (CR=), P turns | arcs and full circles: rational curves of degree 2; helices: of degree 3 | `path_move` |
//! | `,R` `,C` RND= CHR= | corners that are rounded or cut off | `corner` |
//! | G73 G74 G76 G80 to G89, G98 G99 | drilling cycles | `cycle` |
//! | G06.2, G5.2 G5.3, G5, G5.1, BSPLINE | splines of FANUC, LinuxCNC and Siemens | `spline_move`, `fanuc`, `linuxcnc`, `siemens` |
//! | G17 G18 G19, G20 G21 (G70 G71), G90 G91, G90.1 G91.1 | planes, units, coordinates, centres | `preparatory` |
//! | G10 G28 G30 G52 G53 G54 to G59.3 G92 | where 0 is, and moves to places of the machine | `offsets` |
//! | F with G93 G94 G95 | feed | here |
//! | G9, G61 G61.1 G64, of FANUC G62 G63, of Siemens G60 | exact stop at the ends of moves, or not | `preparatory` |
//! | M S T D H | no effect on the path; listed. M2, M30 and M99 end the program, as the second `%` does | `auxiliary` |
//! | G65 M98 M99 | subprograms of the same text | `auxiliary`, `flow` |
//! | A B C U V W, E | other axes, and a printer's filament | `other_axes` |
//!
//! Of each group of G words that exclude one another a block has one: G20 with G21 is an error, as G1 with G2 is.
//!
//! A coordinate that is not written keeps its value. Where the tool is at first is not known: an axis begins where it is
//! first sent, and what came before is read as done there. One that incremental words move first begins at 0.

mod auxiliary;
mod block;
mod command;
mod command_line;
mod corner;
mod cycle;
mod expression;
mod fanuc;
mod flow;
mod linuxcnc;
mod marks;
mod modal;
mod o_words;
mod offsets;
mod other_axes;
mod path_move;
mod preparatory;
mod siemens;
mod spline_move;
mod variables;
mod word;

pub(crate) use linuxcnc::LEAST_ORDER;
pub(crate) use modal::PathMode;

use crate::curve::{Curve, MAX_COORDINATE_MM};
use crate::diagnostic::Report;
use crate::gcode::block::Block;
use crate::gcode::corner::Corner;
use crate::gcode::cycle::Holes;
use crate::gcode::expression::Scope;
use crate::gcode::flow::{Context, Flow};
use crate::gcode::modal::{FeedMode, Modal, Motion, WORK_OFFSETS};
use crate::gcode::offsets::Placing;
use crate::gcode::other_axes::OtherAxes;
use crate::gcode::spline_move::Spline;
use crate::gcode::variables::Variables;
use crate::gcode::word::{Line, Tape, Word};
use crate::joint;
use crate::options::{Dialect, ReadOptions, Unit};
use crate::part::{MAX_FEEDRATE, Move, MoveKind, Part, Shape};
use crate::source::Span;

/// Control points that a program may make beside four for each of its bytes: what loops, cycles and arcs of many turns make of it must
/// fit into memory.
const MAX_POINTS: usize = 8_000_000;
/// A curve takes as much memory beside its control points as so many of them.
const POINTS_OF_A_CURVE: usize = 4;

/// Reads a whole program into `part`. What is wrong goes to the report.
pub(crate) fn read(report: &mut Report<'_>, part: &mut Part, options: ReadOptions) {
    let length = report.source.text.len();
    let mut reader = Reader {
        report,
        part,
        options,
        modal: Modal::default(),
        variables: Variables::default(),
        flow: Flow::default(),
        holes: Holes::default(),
        placing: None,
        corner: None,
        others: OtherAxes::default(),
        known_origins: [false; WORK_OFFSETS],
        kept_shift: [0.0; 3],
        names_unit: false,
        points: 0,
        block_number: 0,
        unknown_from: [0; 3],
        whole_units: options.dialect == Some(Dialect::Fanuc),
        unread: None,
        block_stops: false,
        is_unsure_of_stops: false,
        end: PathMode::Continuous,
        passes_smooth_joints: false,
        spline: None,
        smooth: None,
        ended: false,
    };
    if let Some(start) = options.start_mm {
        reader.modal.position = start.map(Some);
    }
    reader.modal.inches = options.unit == Some(Unit::Inch);
    reader.lines();
    reader.end_corner();
    reader.report.within = None;
    reader.close(Span::new(length, length));
    reader.part.unit_is_assumed = !reader.names_unit && options.unit.is_none();
    part.feedrate_mm_per_s = part.highest_feedrate();
    if part.curves.is_empty() && !report.has_errors() {
        let cause = report.first_warning().map(|first| format!("line {}: {}", first.line, first.message));
        let error = report.error(Span::new(0, 0), "the program holds no curve");
        error.expected("a move from one point to another");
        if let Some(cause) = cause {
            error.hint(format!("what was read over may be why: {cause}"));
        }
    }
}

/// Where a block is: in the text, and in the order of execution.
#[derive(Clone, Copy)]
pub(crate) struct BlockPlace {
    span: Span,
    block: u32,
}

/// A program that is being read.
pub(crate) struct Reader<'r, 't, 'p> {
    pub(crate) report: &'r mut Report<'t>,
    pub(crate) part: &'p mut Part,
    pub(crate) options: ReadOptions,
    pub(crate) modal: Modal,
    pub(crate) variables: Variables,
    pub(crate) flow: Flow,
    pub(crate) holes: Holes,
    /// What the block does with its coordinates other than move to them.
    pub(crate) placing: Option<(Placing, Span)>,
    pub(crate) others: OtherAxes,
    /// What is to become of the corner behind the last move.
    pub(crate) corner: Option<Corner>,
    /// The work offsets whose origins the program has set.
    pub(crate) known_origins: [bool; WORK_OFFSETS],
    /// The last shift that was written, to which G92.3 comes back.
    pub(crate) kept_shift: [f64; 3],
    /// Whether a word has said the unit of lengths.
    pub(crate) names_unit: bool,
    /// Control points of the curves that have been made.
    points: usize,
    /// Blocks that have been executed.
    pub(crate) block_number: u32,
    /// The first curve on which each axis is unknown, while it is.
    pub(crate) unknown_from: [usize; 3],
    /// The program is said to be FANUC's, and no length without a decimal point has been met.
    whole_units: bool,
    /// A G word of the block that is read over.
    pub(crate) unread: Option<Span>,
    /// G9: this block alone ends at rest.
    pub(crate) block_stops: bool,
    /// G61 was read before it was known whether the program is LinuxCNC's.
    pub(crate) is_unsure_of_stops: bool,
    /// How the last block that moved passes its end; of a spline, the last of its blocks.
    end: PathMode,
    /// Whether the exact stop of the last move is none if the next one goes on in its direction.
    passes_smooth_joints: bool,
    pub(crate) spline: Option<(Spline, BlockPlace)>,
    /// Inner point of a smooth continuation of G5, from its start.
    pub(crate) smooth: Option<[f64; 2]>,
    pub(crate) ended: bool,
}

impl Reader<'_, '_, '_> {
    /// Executes the lines of the program in their order.
    fn lines(&mut self) {
        let (mut read, mut tape) = (Line::default(), Tape::default());
        while let Some(index) = self.flow.advance(self.report) {
            let (start, line) = self.report.source.line(index);
            let scope =
                Scope { variables: &self.variables, modal: &self.modal, dialect: self.options.dialect };
            word::read_line(self.report, self.options.lenient, scope, &mut tape, start, line, &mut read);
            self.line(&mut read);
            if self.is_full() {
                let span = Span::new(start, start + line.trim_end().len());
                let message = "the program makes more curves than are taken";
                self.report.error(span, message).expected("fewer turns of arcs, holes and repeated lines");
                return;
            }
            let behind = read.ended.unwrap_or(line.len());
            self.ended |= read.ended.is_some();
            if self.ended {
                self.look_behind_the_end(start + behind, &line[behind..], index);
                return;
            }
        }
        if self.flow.is_called() && !self.report.has_errors() {
            let end = self.report.source.text.len();
            self.report
                .error(Span::new(end, end), "the program ends within a subprogram")
                .expected("M99 or endsub at the end of the subprogram");
        }
    }

    /// Whether the program makes more of its text than is taken.
    pub(crate) fn is_full(&self) -> bool {
        self.points > MAX_POINTS + 4 * self.report.source.text.len()
    }

    /// Executes what a line says.
    fn line(&mut self, read: &mut Line) {
        if let Some(dialect) = read.dialect {
            self.options.dialect.get_or_insert(dialect);
        }
        self.block_number = self.block_number.saturating_add(1);
        if read.is_homing {
            (0..3).for_each(|axis| self.lose(axis));
        }
        for (variable, value) in read.assignments.drain(..) {
            self.variables.set(variable, value);
        }
        self.block(&mut read.words);
        if let Some((command, span)) = read.command.take() {
            let mut context = Context {
                report: self.report,
                variables: &mut self.variables,
                modal: &self.modal,
                dialect: self.options.dialect,
            };
            let is_obeyed = self.flow.obey(&mut context, command, span).is_some();
            self.ended |= !is_obeyed;
        }
    }

    /// Warns of words behind the end of the program, unless they may be those of subprograms.
    fn look_behind_the_end(&mut self, start: usize, rest: &str, index: usize) {
        if self.report.has_errors() || self.flow.has_called {
            return;
        }
        self.report.within = None;
        let mut found = word::remainder(start, rest);
        let mut index = index + 1;
        while found.is_none() && index < self.report.source.lines() {
            let (start, line) = self.report.source.line(index);
            found = word::remainder(start, line);
            index += 1;
        }
        if let Some(span) = found {
            self.report.warning(span, "what follows the end of the program is not read");
        }
    }

    fn block(&mut self, words: &mut Vec<Word>) {
        let Some(mut block) = Block::new(self.report, words) else { return };
        let span = block.span;
        self.unread = None;
        let unit_before = self.modal.mm(1.0);
        let Some(motion) = self.preparatory(&mut block) else { return };
        if let Some(motion) = motion {
            if !matches!(motion, Motion::Cycle(_)) || !matches!(self.modal.motion, Motion::Cycle(_)) {
                self.holes.end();
            }
            self.modal.motion = motion;
        }
        self.look_for_points(&block);
        let ends = self.auxiliary(&mut block);
        self.other_axes(&mut block);
        let inverse_feed = self.feed(&mut block, unit_before);
        let unread = self.unread.take();
        if let Some((placing, span)) = self.placing.take().filter(|_| unread.is_none()) {
            self.place_coordinates(&mut block, placing, span);
        } else if unread.is_some() || self.modal.motion == Motion::Unread {
            self.leave_out(&mut block, unread);
        } else {
            self.motion(&mut block, motion.is_some(), inverse_feed);
            self.begin_axes();
        }
        self.refuse(block);
        if ends {
            self.close(span);
            self.ended = true;
        }
    }

    /// Warns once of a length without a decimal point, which many controls of FANUC count in least increments.
    fn look_for_points(&mut self, block: &Block<'_>) {
        if !self.whole_units {
            return;
        }
        let letters: &[u8] = match self.modal.motion {
            Motion::Arc { .. } => b"XYZIJKR",
            _ => b"XYZ",
        };
        let source = &self.report.source;
        let Some(word) = block.without_point(source, letters) else { return };
        let (text, unit) =
            (source.slice(word.span), if self.modal.inches { "inches" } else { "millimetres" });
        let increments = if self.modal.inches { "0.0001 inch" } else { "0.001 mm" };
        let message = format!("numbers without a decimal point are read as whole {unit}: `{text}`");
        self.report.warning(word.span, message).hint(format!(
            "a control may read them as increments of {increments}; with a point they are alike"
        ));
        self.whole_units = false;
    }

    /// Takes F: in G94 it becomes the feedrate, in G93 it is handed back, in 1/min, and in G95 it becomes the
    /// feed of a revolution.
    fn feed(&mut self, block: &mut Block<'_>, unit_before: f64) -> Option<f64> {
        let word = block.take_letter(b'F')?;
        let mut unit = self.modal.mm(1.0);
        if unit != unit_before {
            let dialect = self.options.dialect;
            if dialect == Some(Dialect::LinuxCnc) {
                unit = unit_before;
            } else if dialect.is_none() {
                let text = self.report.source.slice(word.span).to_owned();
                self.report
                    .warning(word.span, format!("`{text}` is read in the unit that its block sets"))
                    .hint("LinuxCNC reads it in the unit before, as with its dialect given");
            }
        }
        if word.value <= 0.0 {
            self.report.error(word.span, format!("the feed is {}", word.value)).expected("a feed above 0");
            return None;
        }
        match self.modal.feed_mode {
            FeedMode::PerMinute => {}
            FeedMode::InverseTime => return Some(word.value),
            FeedMode::PerRevolution => {
                self.modal.feed_mm_per_revolution = Some(word.value * unit);
                return None;
            }
        }
        let feedrate = word.value * unit / 60.0;
        if feedrate > MAX_FEEDRATE {
            let text = self.report.source.slice(word.span);
            let message = format!(
                "`{text}` is {feedrate:.0} mm/s, as fast as any machine can: the machine's own feed is taken"
            );
            self.report.of_kind(false, word.span, "fast", message);
            self.modal.feedrate_mm_per_s = None;
            return None;
        }
        self.modal.feedrate_mm_per_s = Some(feedrate);
        None
    }

    fn motion(&mut self, block: &mut Block<'_>, is_new: bool, inverse_feed: Option<f64>) {
        if !is_new && block.is_empty() {
            return;
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
            Motion::Rapid | Motion::Line if block.has_axis() => self.straight(block, inverse_feed),
            Motion::Arc { clockwise }
                if is_new || block.has_axis() || b"IJK".iter().any(|c| block.has(*c)) =>
            {
                self.arc(block, clockwise, inverse_feed);
            }
            Motion::FanucNurbs | Motion::LinuxCncNurbs | Motion::Bspline => self.spline_block(block, is_new),
            Motion::Cubic | Motion::Quadratic => self.bezier(block, continues),
            Motion::Cycle(cycle) if block.has_axis() => self.drill(block, cycle),
            Motion::WithSpindle { comes_back } if block.has_axis() => self.with_spindle(block, comes_back),
            Motion::Broken => self.pass_over(block),
            _ => {}
        }
    }

    /// Goes to where a block leads that cannot be read: what is wrong has been said, and no other error is to follow from it.
    pub(crate) fn pass_over(&mut self, block: &mut Block<'_>) {
        let written = block.take_axes();
        let end = self.modal.target(self.modal.here(), written);
        if end.iter().all(|x| x.abs() <= MAX_COORDINATE_MM) {
            self.modal.arrive(written, end);
        }
        block.clear();
    }

    /// Puts the curves that were made while an axis was unknown to where it began.
    pub(crate) fn begin_axes(&mut self) {
        for axis in 0..3 {
            let Some(begin) = self.modal.begun[axis].take() else { continue };
            for curve in &mut self.part.curves[self.unknown_from[axis]..] {
                curve.control_points_mm.iter_mut().for_each(|point| point[axis] = begin);
                curve.dimension = Curve::dimension_of(&curve.control_points_mm);
            }
        }
    }

    /// A block that goes nowhere ends in an exact stop all the same: where the move before it ended.
    pub(crate) fn rest_here(&mut self) {
        if self.end == PathMode::ExactStop {
            self.rest();
        }
    }

    /// The last move ends at rest.
    pub(crate) fn rest(&mut self) {
        if let Some(last) = self.part.moves.last_mut() {
            last.exact_stop |= last.kind == MoveKind::Feed;
            self.passes_smooth_joints = false;
        }
    }

    pub(crate) fn push(
        &mut self,
        mut curve: Curve,
        kind: MoveKind,
        shape: Shape,
        feedrate: Option<f64>,
        place: BlockPlace,
    ) {
        let (line, block) = (self.line_of(place.span), place.block);
        if let Some(corner) = self.corner.take()
            && let Some((between, one)) = self.turn_corner(corner, &mut curve, shape)
        {
            self.part.curves.push(between);
            self.part.moves.push(one);
        }
        self.points += curve.control_points_mm.len() + POINTS_OF_A_CURVE;
        if let (Some(before), Some(last)) = (self.part.curves.last(), self.part.moves.last_mut())
            && last.exact_stop
            && self.passes_smooth_joints
        {
            last.exact_stop = joint::breaks(before, &curve);
        }
        let exact_stop = kind == MoveKind::Feed && self.end != PathMode::Continuous;
        self.passes_smooth_joints = self.end == PathMode::ExactPath;
        self.part.moves.push(Move { kind, shape, feedrate_mm_per_s: feedrate, exact_stop, line, block });
        self.part.curves.push(curve);
    }

    /// Where the block is that is executed.
    pub(crate) fn place(&self, span: Span) -> BlockPlace {
        BlockPlace { span, block: self.block_number }
    }

    pub(crate) fn line_of(&self, span: Span) -> usize {
        self.report.source.line_number(span.start)
    }

    /// Says the words that nobody took.
    fn refuse(&mut self, block: Block<'_>) {
        let expected = self.motion_words();
        for word in block.rest().iter() {
            let text = self.report.source.slice(word.span);
            let name = self.motion_name();
            let kind = format!("{:?} {name}", word.key);
            let message = format!("`{text}` is no word of {name}");
            let said = self.report.of_kind(!self.options.lenient, word.span, kind, message);
            if !self.options.lenient {
                said.expected(expected);
            }
        }
    }

    fn motion_name(&self) -> &'static str {
        match self.modal.motion {
            Motion::None | Motion::Broken => "a block without a motion",
            Motion::Rapid => "G0",
            Motion::Line => "G1",
            Motion::Arc { clockwise: true } => "G2",
            Motion::Arc { clockwise: false } => "G3",
            Motion::FanucNurbs => "G06.2",
            Motion::Cubic => "G5",
            Motion::Quadratic => "G5.1",
            Motion::LinuxCncNurbs => "G5.2",
            Motion::Bspline => "BSPLINE",
            Motion::Cycle(_) => "a drilling cycle",
            Motion::WithSpindle { .. } => "G33",
            Motion::Unread => "a motion that is not read",
        }
    }

    fn motion_words(&self) -> &'static str {
        match self.modal.motion {
            Motion::None | Motion::Unread | Motion::Broken => "G, F, M, S, T, D or H",
            Motion::Rapid | Motion::Line => "X, Y, Z or F",
            Motion::Arc { .. } => "X, Y, Z, I, J, K, R or F",
            Motion::FanucNurbs => "K, X, Y, Z, R, P or F",
            Motion::Cubic => "X, Y, I, J, P, Q or F",
            Motion::Quadratic => "X, Y, I, J or F",
            Motion::LinuxCncNurbs => "X, Y, P, L or F",
            Motion::Bspline => "X, Y, Z, SD=, PW=, PL= or F",
            Motion::Cycle(_) => "X, Y, Z, R, Q, P, L or F",
            Motion::WithSpindle { .. } => "X, Y, Z or K",
        }
    }
}
