//! Blocks whose coordinates are not the end of a move.

/// How a block uses its coordinates if they are not the end of a move.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Placing {
    /// G28, G30.
    Home,
    /// G53.
    MachineCoordinates,
    /// G10.
    SetOffset,
    /// G92.
    SetPosition,
    /// G52.
    MoveOrigin,
    /// TRANS, and ATRANS, which adds.
    Shift { adds: bool },
    /// G28.1, G30.1, G43.1 and G43.2: their coordinates do not affect the path.
    Ignored,
}
