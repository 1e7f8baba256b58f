//! To be written.
use crate::{FeedLimit, KinematicLimits, PlanError, ScheduleBuf};
use real::Real;

/// Feeds at the two ends of the path; at rest by default.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct EndFeeds<R> {
    /// Feed at the start.
    pub start: R,
    /// Feed at the end.
    pub end: R,
}

/// The plan.
///
/// # Errors
/// To be written.
pub fn plan<R: Real>(
    limit: &FeedLimit<R>,
    limits: &KinematicLimits<R>,
    ends: EndFeeds<R>,
) -> Result<ScheduleBuf<R>, PlanError> {
    let _ = (limit, limits, ends);
    Err(PlanError::PathEmpty)
}
