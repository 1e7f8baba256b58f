//! A part of the user's own, as `feedbits compile` has written it: one call a period, from section to section.

use core::hint::black_box;

use real::Backend;
use secant_interp::{PieceInterpolator, PieceSetpoint, PieceState, PositionChecksum};

use crate::{Board, OwnPart, Record};

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

#[unsafe(export_name = "k_step_part")]
#[inline(never)]
fn step(
    run: &PieceInterpolator<'static, Number, DIMENSION>,
    state: &mut PieceState<Number, DIMENSION>,
    setpoint: &mut PieceSetpoint<Number, DIMENSION>,
) -> bool {
    run.step_into(state, setpoint)
}

/// All sections, one after the other.
pub(crate) fn run_all(board: &mut impl Board) {
    let step: Step = black_box(step);
    let zero = Number::default();
    let mut setpoint =
        PieceSetpoint { piece: 0, phase: 0, offset: [zero; DIMENSION], length: zero, evaluations: 0 };
    let (mut checksum, mut calls) = (PositionChecksum::default(), 0);
    board.paint_stack();
    for section in &part::SECTIONS {
        let run = part::PATH.on(section);
        let mut state = run.start();
        while !run.is_at_end(&state) && step(&run, &mut state, &mut setpoint) {
            calls += 1;
            checksum.add(run.pieces.position(setpoint.piece, &setpoint.offset));
        }
    }
    let (stack_bytes, checksum) = (board.used_stack(), checksum.value());
    board.record(Record { format: "own", item: "part", symbol: "k_step_part", calls, checksum, stack_bytes });
}
