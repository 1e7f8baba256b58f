//! Exact stops: how the tool passes the ends of moves, and which ends are stops.

use crate::curve::Curve;
use crate::joint;
use crate::moves::{Move, MoveKind};
use crate::part::Part;
use crate::path_tolerance::{PathTolerance, ToleranceFrom};

/// How the tool passes the ends of moves.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum PathMode {
    /// G64: in the way that the machine chooses, within a tolerance if the program states one.
    Continuous(Option<PathTolerance>),
    /// LinuxCNC's G61: through the point, at rest if the direction breaks there.
    ExactPath,
    /// G61 of other controls, LinuxCNC's G61.1, Siemens' G60: at rest.
    ExactStop,
}

impl Default for PathMode {
    fn default() -> Self {
        Self::Continuous(None)
    }
}

/// Adds moves to a part, with the tolerance that holds for them, and decides for each whether it ends in an exact stop.
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
        let tolerance = if let PathMode::Continuous(tolerance) = mode { tolerance } else { None };
        if part.tolerances.last().and_then(|last| last.tolerance) != tolerance {
            part.tolerances.push(ToleranceFrom { first_move: part.moves.len(), tolerance });
        }
        let exact_stop = one.kind == MoveKind::Feed && !matches!(mode, PathMode::Continuous(_));
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
