//! To be written.
use crate::{KinematicLimits, PlanError};
use alloc::vec::Vec;
use nurbs_core::Differentiate;
use real::Real;

/// The feed limit at one point of the path.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LimitPoint<R> {
    /// Arc length from the path's start, mm.
    pub distance: R,
    /// Index of the curve.
    pub curve: usize,
    /// Parameter on that curve.
    pub u: R,
    /// Largest feed there.
    pub feedrate: R,
}

/// The largest feed that the path allows, as a function of the distance along it.
#[derive(Clone, Debug, PartialEq)]
pub struct FeedLimit<R> {
    pub(crate) points: Vec<LimitPoint<R>>,
}

impl<R: Real> FeedLimit<R> {
    /// The limit along curves that follow each other.
    ///
    /// # Errors
    /// To be written.
    pub fn along<const D: usize, C: Differentiate<R, D>>(
        curves: &[C],
        limits: &KinematicLimits<R>,
    ) -> Result<Self, PlanError> {
        limits.validate()?;
        let _ = curves;
        Err(PlanError::PathEmpty)
    }

    /// The points, in order of distance.
    #[must_use]
    pub fn points(&self) -> &[LimitPoint<R>] {
        &self.points
    }

    /// Arc length of the path, mm.
    #[must_use]
    pub fn length(&self) -> R {
        self.points.last().map_or_else(R::zero, |p| p.distance)
    }

    /// A lower bound of the limit at `distance`.
    #[must_use]
    pub fn at(&self, distance: R) -> R {
        distance
    }

    /// By how much the chords of a plan's setpoints fall short of the arcs in all.
    #[must_use]
    pub fn shortfall(&self, schedule: &crate::Schedule<'_, R>) -> R {
        let _ = schedule;
        R::zero()
    }
}
