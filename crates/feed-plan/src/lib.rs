//! `feed-plan`: how fast may the tool go along this path, and when is it where?
//!
//! | folder | answers | public names |
//! |---|---|---|
//! | | what do machine and part allow? | [`KinematicLimits`], [`KinematicLimits::feedrate_at_radius`], [`chord_feedrate`] |
//! | `limit/` | how fast may each point of the path be passed? Samples, minima, corners, cusps | [`FeedLimit`] |
//! | `transition/` | how does the feed get from one value to another? | [`Transition`] of a [`ProfileKind`], made of [`FeedPiece`]s |
//! | `schedule/` | what is a plan, and how far does it go in each period? | [`Stage`], [`Section`], [`Schedule`], [`Cursor`], [`ScheduleBuf`] |
//! | `plan/` | which feed is reached where? Key points, passes, cruise, whole periods | [`plan()`], [`plan_with`] |
//! | | what can no plan beat? | [`jerk_free_duration`], and with the jerk limited [`least_duration`] |
//! | `axes/` | what is the fastest plan, where single axes are limited too? Interior point on a spline of v² | [`plan_within_axes`] |
//! | `chords/` | which plan do setpoints keep whose chords, not arcs, have the planned lengths? | [`FeedLimit::in_chords`]; its parts [`FeedLimit::shortfalls`], [`ScheduleBuf::shortened`] |
//! | | all of it in one call: the limit, the plan in arcs, the plan in chords | [`Planned`] |
//! | `window/` | which plans are these of a path of any length, of which no more than a window is in view? | [`plan_through_window`] |
//!
//! A folder uses only those above it in the table.
//!
//! ```
//! use feed_plan::{EndFeeds, KinematicLimits, Planned, ProfileKind};
//! use nurbs_core::NurbsCurve;
//!
//! // A quarter circle of 50 mm, in mm and periods of 1 ms: 200 mm/s, 5 m/s², 400 m/s³, 0.5 µm.
//! let (points, weights) = ([[50.0, 0.0], [50.0, 50.0], [0.0, 50.0]], [1.0, 0.5_f64.sqrt(), 1.0]);
//! let curves = [NurbsCurve::try_new(2, &points, &weights, &[0.0, 0.0, 0.0, 1.0, 1.0, 1.0])?];
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
//! let planned = Planned::along(&curves, &limits, EndFeeds::default(), ProfileKind::default())?;
//!
//! // The real-time side: a cursor of a few words, and one call a period.
//! let schedule = planned.arcs.as_schedule();
//! let mut cursor = schedule.start();
//! let travelled: f64 = std::iter::from_fn(|| schedule.advance(&mut cursor)).sum();
//! assert!((travelled - 25.0 * std::f64::consts::PI).abs() < 1e-10);
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```
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
#![allow(clippy::module_inception, reason = "a folder's main file has the folder's name")]

#[cfg(feature = "alloc")]
extern crate alloc;

#[cfg(feature = "alloc")]
mod chord_error;
#[cfg(feature = "alloc")]
mod cube_root;
#[cfg(feature = "alloc")]
mod error;
#[cfg(feature = "alloc")]
mod limits;
#[cfg(all(test, feature = "alloc"))]
mod test_paths;

mod transition {
    pub(crate) mod feed_piece;
    pub(crate) mod stage_shape;
    #[cfg(feature = "alloc")]
    pub(crate) mod transition;
}

mod schedule {
    pub(crate) mod schedule;
    #[cfg(feature = "alloc")]
    pub(crate) mod schedule_buf;
    pub(crate) mod section;
    pub(crate) mod stage;
}

#[cfg(feature = "alloc")]
mod limit {
    pub(crate) mod axis_budget;
    pub(crate) mod broken_chord;
    mod curve_shares;
    pub(crate) mod feed_limit;
    pub(crate) mod fine_moves;
    pub(crate) mod junctions;
    pub(crate) mod lowered_samples;
    mod places;
    mod rounded_moves;
    pub(crate) mod sample;
    pub(crate) mod scan;
    pub(crate) mod span_walk;
    pub(crate) mod stops;
    pub(crate) mod too_fast;
    #[cfg(test)]
    pub(crate) mod track;
    mod turning_limits;
    pub(crate) mod vector;
}

#[cfg(feature = "alloc")]
mod parallel;

#[cfg(feature = "alloc")]
mod plan {
    pub(crate) mod fastest {
        pub(crate) mod caps;
        pub(crate) mod contacts;
        pub(crate) mod fastest;
        pub(crate) mod fit;
        pub(crate) mod grid;
        pub(crate) mod motion;
        pub(crate) mod parts;
        pub(crate) mod profile;
        #[cfg(test)]
        pub(crate) mod published;
        pub(crate) mod repair;
        pub(crate) mod sections;
        pub(crate) mod touches;
        pub(crate) mod valleys;
    }
    pub(crate) mod flank;
    pub(crate) mod flexible;
    pub(crate) mod key_points;
    pub(crate) mod least_duration;
    pub(crate) mod look_ahead;
    pub(crate) mod lower_bound;
    pub(crate) mod merge_verdicts;
    #[cfg(test)]
    pub(crate) mod promises;
    pub(crate) mod ramp_shape;
    pub(crate) mod ramps;
    pub(crate) mod stages;
    pub(crate) mod whole_periods;
    pub(crate) mod without_look_ahead;
}

#[cfg(feature = "alloc")]
mod axes {
    mod arcs;
    mod check;
    mod geometry;
    mod grid;
    mod pentadiagonal;
    mod profile;
    mod program;
    mod rows;
    mod spline;
    mod way;
    pub(crate) mod within_axes;
}

#[cfg(feature = "alloc")]
mod chords {
    mod axis_windows;
    #[cfg(test)]
    mod corner_chords;
    pub(crate) mod feeds;
    mod followed;
    mod joints;
    pub(crate) mod kept;
    pub(crate) mod landing;
    pub(crate) mod lead;
    mod parts;
    pub(crate) mod planned;
    pub(crate) mod shortfall;
    mod steps;
    pub(crate) mod stretch;
}

#[cfg(feature = "alloc")]
mod window {
    pub(crate) mod chord_run;
    pub(crate) mod view;
    pub(crate) mod window;
}

#[cfg(feature = "std")]
pub use parallel::in_parallel;
pub use schedule::schedule::{Cursor, Schedule};
pub use schedule::section::{Section, sections};
pub use schedule::stage::{Stage, StageKind};
pub use transition::feed_piece::FeedPiece;
pub use transition::stage_shape::{StageShape, sinc_terms};
#[cfg(feature = "alloc")]
pub use {
    axes::within_axes::plan_within_axes,
    chord_error::chord_feedrate,
    chords::{lead::Lead, planned::Planned},
    error::PlanError,
    limit::{feed_limit::FeedLimit, sample::LimitPoint},
    limits::{AxisLimits, Junction, KinematicLimits},
    plan::{
        flexible::{KeptApart, MergeVerdict},
        key_points::EndFeeds,
        least_duration::least_duration,
        look_ahead::{plan, plan_with},
        lower_bound::jerk_free_duration,
        merge_verdicts::merge_verdicts,
        whole_periods::MOST_PERIODS,
    },
    schedule::schedule_buf::ScheduleBuf,
    transition::transition::{ProfileKind, Transition},
    window::{
        chord_run::FinalStages,
        view::CommandedCurve,
        window::{WindowedPlan, plan_through_window},
    },
};
