//! `feed-plan`: how fast may the tool go along this path, and when is it where?
//!
//! ```
//! use feed_plan::{EndFeeds, FeedLimit, KinematicLimits, plan};
//! use nurbs_core::NurbsCurve;
//!
//! // A quarter circle of 50 mm, in mm and periods of 1 ms: 200 mm/s, 5 m/s², 400 m/s³, 0.5 µm.
//! let points = [[50.0, 0.0], [50.0, 50.0], [0.0, 50.0]];
//! let weights = [1.0, 0.5_f64.sqrt(), 1.0];
//! let knots = [0.0, 0.0, 0.0, 1.0, 1.0, 1.0];
//! let curve = NurbsCurve::try_new(2, &points, &weights, &knots)?;
//! let limits = KinematicLimits {
//!     interpolation_period: 1.0,
//!     feedrate: 0.2,
//!     acceleration: 0.005,
//!     jerk: 0.0004,
//!     chord_error: 0.0005,
//!     centripetal_acceleration: None,
//!     axes: Default::default(),
//!     junction: Default::default(),
//! };
//!
//! let limit = FeedLimit::along(&[curve], &limits)?;
//! let plan = plan(&limit, &limits, EndFeeds::default())?;
//!
//! // The real-time side: a cursor of a few words, and one call a period.
//! let schedule = plan.as_schedule();
//! let mut cursor = schedule.start();
//! let mut travelled = 0.0;
//! while let Some(step) = schedule.advance(&mut cursor) {
//!     travelled += step;
//! }
//! assert!((travelled - 25.0 * std::f64::consts::PI).abs() < 1e-10);
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```
//!
//! | step | where |
//! |---|---|
//! | largest feed for a chord error; on a bend | [`chord_feedrate`], [`KinematicLimits::feedrate_at_radius`] |
//! | the limit along a path: samples, minima, corners, cusps | [`FeedLimit`] |
//! | transitions between two feeds | [`Transition`] of a [`ProfileKind`], made of [`FeedPiece`]s |
//! | key points, passes, cruise, whole periods | [`plan`], [`plan_with`] a [`ProfileKind`] |
//! | the same through a window, for a path of any length | [`plan_through_window`] |
//! | the result: stages, and the distance of each period | [`ScheduleBuf`], [`Schedule`], [`Cursor`] |
//! | setpoints by chords instead of arcs | [`FeedLimit::in_chords`]; its parts [`FeedLimit::shortfalls`], [`ScheduleBuf::shortened`] |
//! | what no plan can beat | [`jerk_free_duration`] |
//!
//! **Units**: mm, and any unit of time, the same in all limits. Take the interpolation period: then T = 1,
//! feeds are in mm/period, accelerations in mm/period², jerks in mm/period³, and all values suit a
//! fixed-point format.
//!
//! **Formats**: every kernel is generic over [`real::Real`]. Planning wants f64, f32 or 64-bit fixed point:
//! arc lengths and derivatives of a raw curve overflow or drown in 32 bits, which is an error or a poor plan,
//! never a panic or an endless loop. Walking a schedule suits any format that holds its numbers.
//!
//! **Heap**: planning allocates; a [`Schedule`] and its cursor do not.
//!
//! | feature | for |
//! |---|---|
//! | `std` (default) | square roots of floats through std; implies `alloc` |
//! | `libm` | square roots of floats without std |
//! | `alloc` | planning; without it there is what walks a plan made elsewhere, and no allocator is linked |
//!
//! # Source
//! *Paper A*: Wang Y., Gai R., Sun Y., Yang D., Han J., "NURBS interpolation algorithm for high-quality machining" (received 2012), in
//! Chinese. *Paper C*: Wang H., Zhao D., Lu Y., Liu K., "Parametric curve look-ahead interpolation algorithm with flexible
//! acceleration and deceleration method", *China Mechanical Engineering* 2012, no. 3, in Chinese. What they misprint is in
//! `docs/papers.md`.

#![cfg_attr(not(any(test, feature = "std")), no_std)]
#![allow(clippy::neg_cmp_op_on_partial_ord, reason = "!(x > 0) refuses NaN as well, and is written for that")]

#[cfg(feature = "alloc")]
extern crate alloc;

#[cfg(feature = "alloc")]
mod axis_budget;
#[cfg(feature = "alloc")]
mod broken_chord;
#[cfg(feature = "alloc")]
mod chord_error;
#[cfg(feature = "alloc")]
mod chord_feeds;
#[cfg(feature = "alloc")]
mod chord_shortfall;
#[cfg(test)]
mod corner_chords;
#[cfg(feature = "alloc")]
mod error;
#[cfg(feature = "alloc")]
mod feed_limit;
mod feed_piece;
#[cfg(feature = "alloc")]
mod fine_moves;
#[cfg(feature = "alloc")]
mod flank;
#[cfg(feature = "alloc")]
mod flexible;
#[cfg(feature = "alloc")]
mod in_chords;
#[cfg(feature = "alloc")]
mod junctions;
#[cfg(feature = "alloc")]
mod key_points;
#[cfg(feature = "alloc")]
mod limits;
#[cfg(feature = "alloc")]
mod look_ahead;
#[cfg(feature = "alloc")]
mod lower_bound;
#[cfg(feature = "alloc")]
mod lowered_samples;
#[cfg(feature = "alloc")]
mod sample;
#[cfg(feature = "alloc")]
mod scan;
mod schedule;
#[cfg(feature = "alloc")]
mod schedule_buf;
mod section;
#[cfg(feature = "alloc")]
mod span_walk;
mod stage_shape;
#[cfg(feature = "alloc")]
mod stages;
#[cfg(feature = "alloc")]
mod stops;
#[cfg(all(test, feature = "alloc"))]
mod test_paths;
#[cfg(feature = "alloc")]
mod transition;
#[cfg(feature = "alloc")]
mod whole_periods;
#[cfg(feature = "alloc")]
mod window;

#[cfg(feature = "alloc")]
pub use chord_error::chord_feedrate;
#[cfg(feature = "alloc")]
pub use error::PlanError;
#[cfg(feature = "alloc")]
pub use feed_limit::FeedLimit;
pub use feed_piece::FeedPiece;
#[cfg(feature = "alloc")]
pub use key_points::EndFeeds;
#[cfg(feature = "alloc")]
pub use limits::{AxisLimits, Junction, KinematicLimits};
#[cfg(feature = "alloc")]
pub use look_ahead::{plan, plan_with};
#[cfg(feature = "alloc")]
pub use lower_bound::jerk_free_duration;
#[cfg(feature = "alloc")]
pub use sample::LimitPoint;
pub use schedule::{Cursor, Schedule, Stage, StageKind};
#[cfg(feature = "alloc")]
pub use schedule_buf::ScheduleBuf;
pub use section::{Section, sections};
pub use stage_shape::StageShape;
#[cfg(feature = "alloc")]
pub use transition::{ProfileKind, Transition};
#[cfg(feature = "alloc")]
pub use window::{CommandedCurve, WindowedPlan, plan_through_window};
