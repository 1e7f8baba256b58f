//! Exact stops: how the tool passes the ends of moves, and which ends are stops.

use crate::curve::Curve;
use crate::joint;
use crate::moves::{Move, MoveKind};
use crate::part::Part;

/// How the tool passes the ends of moves.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(crate) enum PathMode {
    /// G64: in the way that the machine chooses.
    #[default]
    Continuous,
    /// LinuxCNC's G61: through the point, at rest if the direction breaks there.
    ExactPath,
    /// G61 of other controls, LinuxCNC's G61.1, Siemens' G60: at rest.
    ExactStop,
}

/// Adds moves to a part, and decides for each whether it ends in an exact stop.
///
/// In [`PathMode::ExactStop`] every move at feed does. In [`PathMode::ExactPath`] a move does unless the next move goes
/// on in its direction, which is known only once the next move is added.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct ExactStops {
    /// Whether the exact stop of the last move is dropped if the next one goes on in its direction.
    passes_smooth_joints: bool,
}

impl ExactStops {
    /// Adds a curve, whose end is passed as `mode` says, and its move. The exact stop of the move is set here.
    pub(crate) fn push(&mut self, part: &mut Part, mode: PathMode, curve: Curve, one: Move) {
        if let (Some(before), Some(last)) = (part.curves.last(), part.moves.last_mut())
            && last.exact_stop
            && self.passes_smooth_joints
        {
            last.exact_stop = joint::breaks(before, &curve);
        }
        let exact_stop = one.kind == MoveKind::Feed && mode != PathMode::Continuous;
        self.passes_smooth_joints = mode == PathMode::ExactPath;
        part.moves.push(Move { exact_stop, ..one });
        part.curves.push(curve);
    }

    /// Makes the last move end at rest, whatever the direction of the next one.
    pub(crate) fn rest(&mut self, part: &mut Part) {
        if let Some(last) = part.moves.last_mut() {
            last.exact_stop |= last.kind == MoveKind::Feed;
            self.passes_smooth_joints = false;
        }
    }
}
