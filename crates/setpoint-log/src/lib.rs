//! `setpoint-log`: what did a controller really do, by a log of its setpoints?
//!
//! | file | answers | public names |
//! |---|---|---|
//! | `text` | which bytes are the log's text, unpacked? | |
//! | `csv_log`, `columns`, `decimal` | which setpoints are in rows of numbers, and how finely are they written? | [`ColumnMap`], [`LengthUnit`] |
//! | `motan_log` | which setpoints are in the moves that Klipper's `motan` keeps? | |
//! | `row` | what does a log say of a setpoint? | |
//! | `log_period` | how long is a period, by the times of the first rows? | |
//! | `period` | which period does a row belong to: which are there twice, which are missing? | |
//! | `machine_limits` | which limits has the machine, per period? | |
//! | `part_path` | where is the path of a part, exactly and in straight segments? | |
//! | `tolerances` | which tolerance of the part holds for each move? | |
//! | `in_order`, `nearest` | where on the path is a setpoint, in the order of both, and wherever? | |
//! | `cruise` | how even is the feed where it is constant? | [`Fluctuation`] |
//! | `part_follower` | how far off is it, and how fast may it be there? | |
//! | `along_path` | what is taken of acceleration and jerk along the path? | |
//! | `judge`, `verdict` | are they kept? | |
//! | `log` | what does a whole log show? | [`judge()`], [`Log`] |
//! | `options` | how is it to be read, and which part is it to follow? | [`LogOptions`], [`Followed`] |
//! | `trace` | what do pictures of it show? | [`TraceColumn`], [`QUANTITIES`] |
//! | `findings` | what was found? | [`Judgement`], [`JudgedLimit`], [`LimitVerdict`], [`Faults`], [`Standstills`] |
//! | `log_place` | where in a log? | [`LogPlace`] |
//! | `part_findings` | how does the log follow a part? | [`PartFindings`], [`SkippedMoves`], [`LineFeed`] |
//! | `off` | how far are log and path from each other? | [`Off`] |
//! | `judged_tolerance` | how is a tolerance of the part kept? | [`JudgedTolerance`], [`ToleranceVerdict`] |
//! | `log_error` | why can a log not be judged, and at which place? | [`LogError`] |
//!
//! The limits are judged by the one routine of [`limit_judge`].
//!
//! ```
//! use part_program::read_limits;
//! use setpoint_log::{LimitVerdict, LogOptions, judge};
//!
//! let machine = read_limits("m.toml", "[machine]\n[machine.axes.x]\nacceleration_mm_per_s2 = 1000\n")?;
//! let log = "time,x\n0.000,0.000\n0.001,0.000\n0.002,0.001\n0.003,0.002\n0.004,0.005\n0.005,0.008\n";
//! let found = judge(log.as_bytes(), &machine, &LogOptions::default())?;
//! // 0.002 mm in (1 ms)² are 2,000 mm/s², which rounding to 0.001 mm may be.
//! assert_eq!(found.limits[0].verdict, LimitVerdict::KeptWithin);
//! assert!((found.limits[0].raw - 2.0).abs() < 1e-9);
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

mod along_path;
mod columns;
mod cruise;
mod csv_log;
mod decimal;
mod findings;
mod in_order;
mod judge;
mod judged_tolerance;
mod log;
mod log_error;
mod log_period;
mod log_place;
mod machine_limits;
mod motan_log;
mod nearest;
mod off;
mod options;
mod part_findings;
mod part_follower;
mod part_path;
mod period;
mod row;
mod text;
mod tolerances;
mod trace;
mod unit;
mod verdict;

pub use columns::ColumnMap;
pub use cruise::Fluctuation;
pub use findings::{Faults, JudgedLimit, Judgement, LimitVerdict, Standstills};
pub use judged_tolerance::{JudgedTolerance, ToleranceVerdict};
pub use log::{Log, judge};
pub use log_error::LogError;
pub use log_place::LogPlace;
pub use off::Off;
pub use options::{Followed, LogOptions};
pub use part_findings::{LineFeed, PartFindings, SkippedMoves};
pub use trace::{QUANTITIES, TraceColumn};
pub use unit::LengthUnit;
