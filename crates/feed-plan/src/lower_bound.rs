//! To be written.
use crate::{FeedLimit, KinematicLimits};
use real::Real;

/// The bound.
#[must_use]
pub fn jerk_free_duration<R: Real>(limit: &FeedLimit<R>, limits: &KinematicLimits<R>) -> R {
    let _ = limits;
    limit.length()
}
