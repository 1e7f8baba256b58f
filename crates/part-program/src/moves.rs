//! How a curve is followed: at which feed, and whether the tool rests at its end.

/// How a curve is to be followed.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Move {
    /// At the commanded feedrate, or as fast as the machine can.
    pub kind: MoveKind,
    /// The kind of curve in the program.
    pub shape: Shape,
    /// The feedrate in force, in mm/s.
    pub feedrate_mm_per_s: Option<f64>,
    /// Whether the program wants the tool at rest at the end of the move: G9, G61, Siemens' G60. It is never set for a
    /// rapid move, which a control ends at rest anyway.
    pub exact_stop: bool,
    /// Line of the block that commands it, from 1.
    pub line: usize,
    /// Number of that block in the order of execution, from 1: a loop executes a line more than once.
    pub block: u32,
}

/// With or without cutting.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum MoveKind {
    /// As fast as the machine can; no feedrate holds.
    Rapid,
    /// At the commanded feedrate.
    Feed,
}

/// The kind of a curve in a program or a drawing.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub enum Shape {
    /// A straight line, degree 1.
    Line,
    /// A circular arc or a helix, rational.
    Arc,
    /// A spline with the given numbers.
    Nurbs,
}
