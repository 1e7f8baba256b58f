//! The state of a program that is being read, and the changes that every word makes: curves, rests, first places of
//! axes.

use std::borrow::Cow;

use crate::arc::Plane;
use crate::curve::{Curve, MAX_COORDINATE_MM};
use crate::diagnostic::Report;
use crate::exact_stops::{ExactStops, PathMode};
use crate::gcode::block::Block;
use crate::gcode::block_place::BlockPlace;
use crate::gcode::compensation::Compensation;
use crate::gcode::corner::Corner;
use crate::gcode::cycle::Holes;
use crate::gcode::flow::Flow;
use crate::gcode::frame::Frames;
use crate::gcode::modal::{Modal, WORK_OFFSETS};
use crate::gcode::other_axes::OtherAxes;
use crate::gcode::placing::Placing;
use crate::gcode::spline::Spline;
use crate::gcode::tool_in_use::ToolInUse;
use crate::gcode::variables::Variables;
use crate::kinds::Kinds;
use crate::moves::{Move, MoveKind, Shape};
use crate::options::{Dialect, ReadOptions, Unit};
use crate::part::Part;
use crate::side_axes::SideMove;
use crate::source::Span;
use crate::tool_table::ToolTable;

/// Bytes that the curves of a program may take beyond [`MAX_BYTES_PER_BYTE`] for each byte of its text: the curves of its
/// loops, cycles and arcs of many turns must fit into memory. A straight move takes about a hundred.
const MAX_BYTES: usize = 40 << 20;
/// A block of ten bytes may be a straight move.
const MAX_BYTES_PER_BYTE: usize = 10;

/// A program that is being read.
pub(crate) struct Reader<'r, 't, 'p> {
    pub(crate) report: &'r mut Report<'t>,
    pub(crate) part: &'p mut Part,
    pub(crate) options: ReadOptions,
    pub(crate) modal: Modal,
    pub(crate) variables: Variables,
    pub(crate) flow: Flow,
    pub(crate) holes: Holes,
    /// How the block uses its coordinates if they are not the end of a move.
    pub(crate) placing: Option<(Placing, Span)>,
    pub(crate) others: OtherAxes,
    /// The change of the corner behind the last move.
    pub(crate) corner: Option<Corner>,
    /// The work offsets whose origins the program has set.
    pub(crate) known_origins: [bool; WORK_OFFSETS],
    /// The last shift that was written, which G92.3 restores.
    pub(crate) kept_shift: [f64; 3],
    /// Whether a word has given the unit of lengths.
    pub(crate) names_unit: bool,
    /// Bytes of the curves that have been made, and of their moves.
    bytes: usize,
    /// Blocks that have been executed.
    pub(crate) block_number: u32,
    /// The first curve on which each axis is unknown, while it is.
    pub(crate) unknown_from: [usize; 3],
    /// Whether the control was named, and not found out.
    pub(crate) is_declared: bool,
    /// Whether the program is declared as FANUC's, and no length without a decimal point has been found yet.
    pub(crate) whole_units: bool,
    /// A name of the block that is not read, or a character.
    pub(crate) unread_name: Option<Span>,
    /// Turned or scaled coordinates, calls at every place and other meanings of moves that are in force and are not read.
    pub(crate) unread_frames: Frames,
    /// Whether the block has a G word.
    pub(crate) has_g_word: bool,
    /// A G word of the block that is skipped.
    pub(crate) unread: Option<Span>,
    /// The first G96. On a lathe, whose programs never name Y, it means that X is a diameter.
    pub(crate) cut_speed_from: Option<Span>,
    pub(crate) names_y: bool,
    /// Words that the part does not hold.
    pub(crate) unheld: Kinds,
    /// Letters of the block that have no number.
    pub(crate) flags: Vec<u8>,
    /// G9: this block alone ends at rest.
    pub(crate) block_stops: bool,
    /// Whether G61 was read before it was known whether the program is LinuxCNC's.
    pub(crate) is_unsure_of_stops: bool,
    /// How the last block with a move passes its end; for a spline, the last of its blocks.
    pub(crate) end: PathMode,
    stops: ExactStops,
    pub(crate) spline: Option<(Spline, BlockPlace)>,
    /// Inner point of a smooth continuation of G5, from its start.
    pub(crate) smooth: Option<[f64; 2]>,
    pub(crate) ended: bool,
    /// The tools, whose radii G10 may change.
    pub(crate) tools: Cow<'p, ToolTable>,
    pub(crate) tool: ToolInUse,
    /// The cutter compensation in force.
    pub(crate) compensation: Option<Compensation>,
    /// Where the tool is after G40, in this plane: the next move begins there.
    pub(crate) off_contour: Option<([f64; 3], Plane)>,
    /// Whether the last curve is the move before the block that is read: nothing was left out in between.
    pub(crate) goes_on: bool,
}

impl<'r, 't, 'p> Reader<'r, 't, 'p> {
    /// A reader at the beginning of a program.
    pub(crate) fn new(
        report: &'r mut Report<'t>,
        part: &'p mut Part,
        options: ReadOptions,
        tools: &'p ToolTable,
    ) -> Self {
        let mut modal = Modal::default();
        modal.inches = options.unit == Some(Unit::Inch);
        modal.feed_in_inches = modal.inches;
        if let Some(start) = options.start_mm {
            modal.position = start.map(Some);
        }
        Self {
            report,
            part,
            options,
            modal,
            variables: Variables::default(),
            flow: Flow::default(),
            holes: Holes::default(),
            placing: None,
            corner: None,
            others: OtherAxes::default(),
            known_origins: [false; WORK_OFFSETS],
            kept_shift: [0.0; 3],
            names_unit: false,
            bytes: 0,
            block_number: 0,
            unknown_from: [0; 3],
            is_declared: options.dialect.is_some(),
            whole_units: options.dialect == Some(Dialect::Fanuc),
            unread_name: None,
            unread_frames: Frames::default(),
            has_g_word: false,
            unread: None,
            cut_speed_from: None,
            names_y: false,
            unheld: Kinds::default(),
            flags: Vec::new(),
            block_stops: false,
            is_unsure_of_stops: false,
            end: PathMode::default(),
            stops: ExactStops::default(),
            spline: None,
            smooth: None,
            ended: false,
            tools: Cow::Borrowed(tools),
            tool: ToolInUse::default(),
            compensation: None,
            off_contour: None,
            goes_on: false,
        }
    }

    /// Whether the curves of the program take more memory than is allowed for its text.
    pub(crate) fn is_full(&self) -> bool {
        self.bytes > MAX_BYTES + MAX_BYTES_PER_BYTE * self.report.source.text.len()
    }

    /// Goes to the end of a block that cannot be read. Its fault has been reported and must not cause further errors.
    pub(crate) fn pass_over(&mut self, block: &mut Block<'_>) {
        let written = block.take_axes();
        let end = self.modal.target(self.modal.here(), written);
        if end.iter().all(|x| x.abs() <= MAX_COORDINATE_MM) {
            self.modal.arrive(written, end);
        }
        block.clear();
    }

    /// Moves the curves that were made while an axis was unknown to the place where the axis began.
    pub(crate) fn begin_axes(&mut self) {
        for axis in 0..3 {
            let Some(begin) = self.modal.begun[axis].take() else { continue };
            for curve in &mut self.part.curves[self.unknown_from[axis]..] {
                curve.move_points(|point| point[axis] = begin);
            }
            if let Some(compensation) = &mut self.compensation {
                compensation.waiting().iter_mut().for_each(|one| one.put(axis, begin));
            }
        }
    }

    /// A block without a length may also have an exact stop: it is at the end of the move before.
    pub(crate) fn rest_here(&mut self) {
        if self.end == PathMode::ExactStop {
            self.rest();
        }
    }

    /// The last move ends at rest.
    pub(crate) fn rest(&mut self) {
        match self.compensation.as_mut().and_then(|compensation| compensation.waiting().last_mut()) {
            Some(last) => last.what.rests = true,
            None => self.rest_at_last(),
        }
    }

    /// The last move of the part ends at rest.
    pub(crate) fn rest_at_last(&mut self) {
        self.stops.rest(self.part);
    }

    /// Adds a curve with its move, after the corner that the program puts before it.
    pub(crate) fn push(
        &mut self,
        mut curve: Curve,
        kind: MoveKind,
        shape: Shape,
        feedrate: Option<f64>,
        place: BlockPlace,
    ) {
        let (line, block) = (self.line_of(place.span), place.block);
        if self.off_contour.is_some() {
            if shape != Shape::Line {
                self.off_contour = None;
                self.report
                    .error(place.span, "the move behind a compensation is not straight")
                    .expected("G0 or G1 behind G40, which leads the tool back to the contour");
                return;
            }
            let [start, ..] = curve.control_points_mm_mut() else { return };
            *start = self.leave_contour(*start);
        }
        if let Some(corner) = self.corner.take()
            && let Some((between, one)) = corner.turn(self.report, self.part, &mut curve, shape)
        {
            self.part.curves.push(between);
            self.part.moves.push(one);
        }
        self.goes_on = true;
        self.bytes += curve.bytes() + size_of::<Move>();
        let next = self.part.curves.len();
        if let Some(side) = self.others.side.along(next, &self.part.side_moves) {
            self.bytes += size_of::<SideMove>();
            self.part.side_moves.push(side);
        }
        let one = Move { kind, shape, feedrate_mm_per_s: feedrate, exact_stop: false, line, block };
        self.stops.push(self.part, self.end, curve, one);
    }

    /// Counts a word that the part does not hold: by its letter, or whole.
    pub(crate) fn leave_unheld(&mut self, span: Span, is_whole: bool) {
        let text = self.report.source.slice(span);
        let text = if is_whole { text } else { text.get(..1).unwrap_or("") };
        self.unheld.add(&text.to_ascii_uppercase(), span);
    }

    /// The place of the block that is executed.
    pub(crate) fn place(&self, span: Span) -> BlockPlace {
        BlockPlace { span, block: self.block_number }
    }

    /// The line of a place, from 1.
    pub(crate) fn line_of(&self, span: Span) -> usize {
        self.report.source.line_number(span.start)
    }
}
