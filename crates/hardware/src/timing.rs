//! How many cycles after an operation is issued its result can be read, and what a branch costs. `core.v` is built to these.

use crate::program::{Numbers, Op};

/// Sums, bits and moves: issue, operands, result.
pub(crate) const SUM: u32 = 3;
/// Shifts take a second stage.
pub(crate) const SHIFT: u32 = 4;
/// The lesser and the greater of two, and words that do not come from registers: a stage keeps them before they are written.
pub(crate) const CHOICE: u32 = 4;
/// Products: one stage multiplies, one adds.
pub(crate) const PRODUCT: u32 = 5;
/// A branch that is taken is followed by so many cycles in which nothing is issued.
pub(crate) const BUBBLE: u32 = 4;
/// The longest wait that a word of microcode can ask for.
pub(crate) const LONGEST_WAIT: u32 = 63;

/// Cycles from the issue of an operation until its result can be read.
pub(crate) fn latency(op: Op, numbers: Numbers) -> u32 {
    match op {
        Op::ShiftLeft | Op::ShiftRight | Op::Scale | Op::ToPhase => SHIFT,
        Op::Product | Op::Sum | Op::RoundedSum | Op::Limbs(..) | Op::Row => PRODUCT,
        Op::Min | Op::Max | Op::Input => CHOICE,
        // A bit a cycle, between a stage that takes magnitudes and two that round and give the sign.
        Op::Divide => CHOICE + numbers.bits + 3,
        Op::Root => CHOICE + 32 + 3,
        _ => SUM,
    }
}
