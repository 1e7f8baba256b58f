//! Approaches: moves from an unknown place to the begin of a curve. They are not curves, but words that do not move the
//! tool stand before or after them: a spindle that starts after the approach must not run on the way.

use crate::moves::MoveKind;

/// A straight move that gives the places of axes, which are known afterwards.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Approach {
    /// Which of X, Y and Z it makes known: those that it names and that were unknown.
    pub axes: [bool; 3],
    /// Whether it is at the commanded feedrate, or as fast as the machine can.
    pub kind: MoveKind,
    /// The feedrate in force, in mm/s.
    pub feedrate_mm_per_s: Option<f64>,
    /// Line of the block that commands it, from 1.
    pub line: usize,
    /// Number of that block in the order of execution, from 1.
    pub block: u32,
}
