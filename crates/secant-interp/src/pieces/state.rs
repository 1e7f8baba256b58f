//! The state of a run on pieces, and the setpoint of a period.

use nurbs_core::{Piece, Shifted};
use real::Real;

use crate::pieces::joint::Reached;
use crate::pieces::trend::Trend;
use crate::step_lengths::LengthCursor;

/// One setpoint on a path of pieces.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PieceSetpoint<R, const D: usize> {
    /// Index of the piece; the number of pieces at the end of the path.
    pub piece: usize,
    /// The local parameter, in units of 2⁻⁶⁴.
    pub phase: u64,
    /// The point as an offset from the piece's origin, in coordinate units. At the end of the path it belongs to
    /// the last piece.
    pub offset: [R; D],
    /// The chord length of the period, in chord units.
    pub length: R,
    /// Evaluations of the chord in this period.
    pub evaluations: u32,
}

/// The values that change from period to period.
#[derive(Clone, Copy, Debug)]
pub struct PieceState<R, const D: usize> {
    pub(crate) cursor: LengthCursor,
    /// The distance of the next period at the plan's own speed, and the cursor after that period. `None` behind the
    /// schedule's end, and after the cursor was moved: the next step then looks ahead anew.
    pub(crate) ahead: Option<R>,
    pub(crate) next: LengthCursor,
    pub(crate) piece: usize,
    pub(crate) phase: u64,
    /// 2^s of `piece`. In fixed point, computing it anew would take a tenth of the time of a step.
    pub(crate) whole: R,
    /// σ of the last steps, in the scale of `piece`.
    pub(crate) trend: Trend<R>,
    /// The piece's polynomials about t, the place of `phase`. They were computed for the setpoint there, and the next
    /// step begins with them.
    pub(crate) t: R,
    pub(crate) at: Shifted<R, D>,
}

impl<R: Real, const D: usize> PieceState<R, D> {
    /// The cursor of the schedule.
    #[must_use]
    pub fn cursor(&self) -> &LengthCursor {
        &self.cursor
    }

    /// Moves to the end of a step over a joint. Returns its evaluations.
    pub(crate) fn reach(&mut self, reached: &Reached<R>, pieces: &[Piece<R, D>]) -> u32 {
        self.trend = self.trend.and(reached.sigma);
        (self.piece, self.phase) = (reached.piece, reached.phase);
        self.whole = pieces.get(self.piece).map_or(R::one(), Piece::whole);
        reached.evaluations
    }
}
