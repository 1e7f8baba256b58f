//! What a block does with its coordinates other than move to them.

/// What a block does with its coordinates other than move to them.
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
    /// G28.1, G30.1, G43.1 and G43.2: coordinates that are no part of the path.
    Ignored,
}
