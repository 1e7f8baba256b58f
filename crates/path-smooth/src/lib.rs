//! `path-smooth`: how much faster is a part with smoothed corners, and how far is it off the programmed path?
//!
//! And the other way round: which curves are the fine straight moves of a program?
//!
//! [`smooth`] takes a part, a machine's limits and [`Options`], and returns the smoothed moves with a table of the corners.
//!
//! ```
//! use nurbs_core::{CornerLambda, CornerStyle};
//! use path_smooth::{Options, smooth};
//!
//! let part = part_program::read_part("square.nc", "G1 X0 Y0 F1200\nX10\nY10\nX0\nY0\n")?;
//! let limits = "[machine]\ninterpolation_period_ms = 1\nfeedrate_mm_per_s = 50\n\
//!               acceleration_mm_per_s2 = 1000\njerk_mm_per_s3 = 50000\n";
//! let machine = part_program::read_machine("machine.toml", limits)?;
//!
//! // No point of the path is farther than 0.05 mm from the part's moves, and none of them from it.
//! let options = Options { tolerance_mm: 0.05, outer: CornerStyle::Cut, lambda: CornerLambda::Auto };
//! let smoothed = smooth(&part, &machine, &options)?;
//!
//! // Three corners between four moves.
//! assert_eq!((smoothed.report.cuts, smoothed.path.curves.len()), (3, 7));
//! assert!(smoothed.report.error_mm_max <= 0.05 && smoothed.report.faults().is_empty());
//! assert!(smoothed.report.smoothed.time_s < smoothed.report.exact_stop.time_s);
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```
//!
//! | question | where |
//! |---|---|
//! | which moves does the tool pass from rest to rest? | `stretch` |
//! | what is a stretch with its corners smoothed? | `smooth_stretch`, and `nurbs_core::smooth_corners` |
//! | how far are two paths from each other? | `deviation` |
//! | how long does a path take, and how fast is each corner? | `timing` |
//! | what became of each corner of a stretch? | `followed` |
//! | what does the part gain? | [`smooth`], [`Report`] |
//! | what is the path as straight moves? | [`Smoothed::write_program`] |
//! | which curves stand for runs of short straight moves? | [`fit_curves`] |

#![allow(clippy::module_inception, reason = "a folder's main file has the folder's name")]

mod deviation;
mod error;
mod followed;
mod options;
mod program;
mod report;
mod smooth;
mod smooth_stretch;
mod stretch;
mod timing;

mod fit {
    pub(crate) mod error;
    pub(crate) mod fit;
    pub(crate) mod options;
    mod run;
}

pub use error::{ProgramError, SmoothError};
pub use fit::{
    error::FitError,
    fit::{FitReport, Fitted, fit_curves},
    options::FitOptions,
};
pub use options::Options;
pub use report::{
    CornerKind, CornerRow, Forms, Lambda, Measured, PathSummary, Report, SetpointCheck, WithLambda1,
};
pub use smooth::{Smoothed, smooth};
pub use smooth_stretch::LEAST_LOOPED_DEG;
