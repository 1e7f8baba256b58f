//! The state of a run on pieces, and the setpoint of a period.

use nurbs_core::{Piece, Pieces, RightShifts, Shifted};
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

impl<R: Real, const D: usize> Default for PieceSetpoint<R, D> {
    /// The begin of a path, in no period.
    fn default() -> Self {
        let zero = R::zero();
        Self { piece: 0, phase: 0, offset: [zero; D], length: zero, evaluations: 0 }
    }
}

/// The values that change from period to period.
#[derive(Clone, Copy, Debug)]
pub struct PieceState<R, const D: usize> {
    pub(crate) cursor: LengthCursor,
    pub(crate) piece: usize,
    pub(crate) phase: u64,
    /// 2^s of `piece`. In fixed point, computing it anew would take a tenth of the time of a step.
    pub(crate) whole: R,
    /// How a step on `piece` is computed.
    pub(crate) form: Form,
    /// σ of the last steps, in the scale of `piece`.
    pub(crate) trend: Trend<R>,
    /// The piece's polynomials about t, the place of `phase`. They were computed for the setpoint there, and the next
    /// step begins with them.
    pub(crate) t: R,
    pub(crate) at: Shifted<R, D>,
}

/// The forms in which a step is compiled. All give the same setpoints.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Form {
    /// For every piece.
    Any,
    /// On a cubic without weights.
    Cubic,
    /// The same if all its scalings go to the right.
    LoweredCubic(RightShifts),
    /// On a cubic with weights whose scalings all go to the right.
    RationalCubic(RightShifts),
}

/// The degree that has forms of its own, with the feature `cubic`: the compiler unrolls chains of three coefficients.
pub(crate) const CUBIC: usize = 3;

impl Form {
    /// Whether this build has other forms than the one for every piece.
    #[inline(always)]
    pub(crate) const fn are_compiled<R: Real>() -> bool {
        R::IS_FOR_SPEED && cfg!(feature = "cubic")
    }

    /// The scalings of a step on the piece, where the form is made for them.
    #[inline]
    pub(crate) fn right_shifts(self) -> Option<RightShifts> {
        match self {
            Self::LoweredCubic(shifts) | Self::RationalCubic(shifts) => Some(shifts),
            Self::Any | Self::Cubic => None,
        }
    }

    /// The form for a piece of this row.
    #[inline]
    pub(crate) fn of<R: Real, const D: usize>(pieces: &Pieces<'_, R, D>, row: &Piece<R, D>) -> Self {
        if !Self::are_compiled::<R>() || pieces.degree != CUBIC {
            return Self::Any;
        }
        match (pieces.right_shifts(row), pieces.is_rational()) {
            (Some(shifts), false) => Self::LoweredCubic(shifts),
            (Some(shifts), true) => Self::RationalCubic(shifts),
            (None, false) => Self::Cubic,
            (None, true) => Self::Any,
        }
    }
}

impl<R: Real, const D: usize> PieceState<R, D> {
    /// The cursor of the schedule.
    #[must_use]
    pub fn cursor(&self) -> &LengthCursor {
        &self.cursor
    }

    /// Moves to the end of a step over a joint. Returns its evaluations.
    #[inline]
    pub(crate) fn reach(&mut self, reached: &Reached<R>, pieces: &Pieces<'_, R, D>) -> u32 {
        self.trend = self.trend.and(reached.sigma);
        (self.piece, self.phase) = (reached.piece, reached.phase);
        if let Some(row) = pieces.pieces.get(self.piece) {
            (self.whole, self.form) = (row.whole(), Form::of(pieces, row));
        }
        reached.evaluations
    }
}
