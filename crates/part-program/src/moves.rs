//! How a curve is followed: at which feed, and whether the tool rests behind it.

/// How a curve is to be followed.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Move {
    /// At the commanded feedrate, or as fast as the machine can.
    pub kind: MoveKind,
    /// What the program wrote.
    pub shape: Shape,
    /// The feedrate in force, in mm/s.
    pub feedrate_mm_per_s: Option<f64>,
    /// Whether the program wants the tool at rest where the move ends: G9, G61, Siemens' G60. Never of a rapid move,
    /// which a control ends at rest anyhow.
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

/// What a program or a drawing calls a curve.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub enum Shape {
    /// A straight line, degree 1.
    Line,
    /// A circular arc or a helix, rational.
    Arc,
    /// A spline as it was given.
    Nurbs,
}

/// Highest feedrate that is believed, in mm/s.
pub(crate) const MAX_FEEDRATE: f64 = 1e5;
