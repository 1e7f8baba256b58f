//! Approaches: moves from where nobody knows to where curves begin. They are no curves, but words that do not move the tool have
//! their place before or behind them: a spindle that starts behind the approach is not to run on the way.

use crate::moves::MoveKind;

/// A straight move that says where axes are, after which they are known.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Approach {
    /// Whether it brings X, Y and Z: those that it names and that were unknown.
    pub axes: [bool; 3],
    /// At the commanded feedrate, or as fast as the machine can.
    pub kind: MoveKind,
    /// The feedrate in force, in mm/s.
    pub feedrate_mm_per_s: Option<f64>,
    /// Line of the block that commands it, from 1.
    pub line: usize,
    /// Number of that block in the order of execution, from 1.
    pub block: u32,
}
