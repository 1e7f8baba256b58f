//! A part of the user's own, as `feedbits compile` has written it: one call a period, from section to section.

use core::hint::black_box;

use nurbs_core::Joint;
use real::Backend;
use secant_interp::{PieceInterpolator, PieceSetpoint, PieceState, PositionChecksum};

use crate::{Board, OwnPart, PeriodKind, Record};

mod part {
    include!(concat!(env!("OUT_DIR"), "/part.rs"));
}

use part::{DIMENSION, Number};

/// The part's format and the checksum of the run that was judged.
pub(crate) fn part() -> OwnPart {
    OwnPart { format: Number::name(), judged: part::CHECKSUM }
}

/// One period of a run; false at its end.
type Step = fn(
    &PieceInterpolator<'static, Number, DIMENSION>,
    &mut PieceState<Number, DIMENSION>,
    &mut PieceSetpoint<Number, DIMENSION>,
) -> bool;

/// A run at rest where a section begins.
type Start = fn(&PieceInterpolator<'static, Number, DIMENSION>) -> PieceState<Number, DIMENSION>;

#[unsafe(export_name = "k_start_part")]
#[inline(never)]
fn start(run: &PieceInterpolator<'static, Number, DIMENSION>) -> PieceState<Number, DIMENSION> {
    run.start()
}

#[unsafe(export_name = "k_step_part")]
#[inline(never)]
fn step(
    run: &PieceInterpolator<'static, Number, DIMENSION>,
    state: &mut PieceState<Number, DIMENSION>,
    setpoint: &mut PieceSetpoint<Number, DIMENSION>,
) -> bool {
    run.step_into(state, setpoint)
}

/// The starts of all sections, and then the sections, one after the other.
pub(crate) fn run_all(board: &mut impl Board) {
    starts(board);
    periods(board);
}

fn starts(board: &mut impl Board) {
    let start: Start = black_box(start);
    let (mut checksum, mut calls) = (PositionChecksum::default(), 0);
    board.paint_stack();
    for section in &part::SECTIONS {
        let run = part::PATH.on(section);
        let mut state = start(&run);
        calls += 1;
        // Where it stands says little: the first period shows what it expects. It is not one of the counted ones.
        let mut setpoint = PieceSetpoint::default();
        run.step_into(&mut state, &mut setpoint);
        checksum.add(run.pieces.position(setpoint.piece, &setpoint.offset));
    }
    let (stack_bytes, checksum) = (board.used_stack(), checksum.value());
    board.record(Record {
        format: "own",
        item: "start",
        symbol: "k_start_part",
        calls,
        checksum,
        stack_bytes,
    });
}

fn periods(board: &mut impl Board) {
    let step: Step = black_box(step);
    let mut setpoint = PieceSetpoint::default();
    let (mut checksum, mut calls) = (PositionChecksum::default(), 0);
    board.paint_stack();
    for section in &part::SECTIONS {
        let run = part::PATH.on(section);
        let mut state = run.start();
        let mut piece = None;
        // Rounding may bring a run to the end of its path a period before the plan: then it holds there.
        while !(run.is_at_end(&state) && run.lengths.is_over(state.cursor())) {
            let before = Before::new(&run, &state, piece);
            if !step(&run, &mut state, &mut setpoint) {
                break;
            }
            board.period(before.kind(&run, &state, &setpoint));
            piece = Some(setpoint.piece);
            calls += 1;
            checksum.add(run.pieces.position(setpoint.piece, &setpoint.offset));
        }
    }
    let (stack_bytes, checksum) = (board.used_stack(), checksum.value());
    board.record(Record { format: "own", item: "part", symbol: "k_step_part", calls, checksum, stack_bytes });
}

/// Where a run stands before a period.
struct Before {
    is_first: bool,
    /// Whether the plan is over.
    is_over: bool,
    piece: usize,
    stage: usize,
}

impl Before {
    /// Of a run whose last setpoint lies on this piece, `None` before the first.
    fn new(
        run: &PieceInterpolator<'_, Number, DIMENSION>,
        state: &PieceState<Number, DIMENSION>,
        piece: Option<usize>,
    ) -> Self {
        Self {
            is_first: piece.is_none(),
            is_over: run.lengths.is_over(state.cursor()),
            piece: piece.unwrap_or(0),
            stage: state.cursor().stage(),
        }
    }

    /// The kind of the period, which ended in `setpoint`.
    fn kind(
        &self,
        run: &PieceInterpolator<'_, Number, DIMENSION>,
        state: &PieceState<Number, DIMENSION>,
        setpoint: &PieceSetpoint<Number, DIMENSION>,
    ) -> PeriodKind {
        let passed = run.pieces.pieces.get(self.piece..setpoint.piece).unwrap_or_default();
        let over = |joint: Joint| passed.iter().any(|piece| piece.joint == joint);
        let is_at_end = setpoint.piece >= run.pieces.pieces.len();
        match () {
            () if self.is_over || is_at_end => PeriodKind::Landing,
            () if self.is_first => PeriodKind::Start,
            () if over(Joint::Breaks) => PeriodKind::Corner,
            () if over(Joint::Smooth) => PeriodKind::Knot,
            () if over(Joint::Continues) => PeriodKind::Joint,
            () if state.cursor().stage() != self.stage => PeriodKind::StageEnd,
            () if setpoint.evaluations > 1 => PeriodKind::Repeated,
            () => PeriodKind::Common,
        }
    }
}
