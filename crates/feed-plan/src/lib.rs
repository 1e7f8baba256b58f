//! `feed-plan`: how fast may the tool go, where, and when does it arrive?

#![cfg_attr(not(feature = "std"), no_std)]
#![allow(clippy::neg_cmp_op_on_partial_ord, reason = "!(x > 0) refuses NaN as well, and is written for that")]

extern crate alloc;

mod chord_error;
mod cubic_profile;
mod error;
mod feed_limit;
mod flank;
mod limits;
mod look_ahead;
mod lower_bound;
mod quadrature;
mod scan;
mod schedule;
#[cfg(test)]
mod test_paths;

pub use chord_error::chord_feedrate;
pub use cubic_profile::CubicProfile;
pub use error::PlanError;
pub use feed_limit::{FeedLimit, LimitPoint};
pub use limits::KinematicLimits;
pub use look_ahead::{EndFeeds, plan};
pub use lower_bound::jerk_free_duration;
pub use schedule::{Cursor, Schedule, ScheduleBuf, Stage, StageKind};
