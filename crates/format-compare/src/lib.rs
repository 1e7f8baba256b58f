//! `format-compare`: one part, many number formats, a verdict each.
//!
//! | folder | answers | public names |
//! |---|---|---|
//! | `problem/` | what is run, within which limits, and how long does that take at the least? | [`Problem`], [`LeastPeriods`] |
//! | `plan/` | what is the plan, exactly, and what does it ask of the machine? | [`ExactPlan`], [`PlanSummary`], [`FeedSample`], [`AxisPeak`] |
//! | `run/` | which formats are there, and what does each make of a plan? | [`formats`], [`select`], [`plan_for`], [`Format::run`] → [`Run`]; [`Format::run_job`] of a [`Job`] before an [`Observer`] |
//! | | how is it run? Engine, profile, feed overrides | [`Options`], [`Engine`], [`Overrides`] |
//! | | which operations does a step take, and what does a controller get? | [`RecordedRun`], [`Constants`], [`StreamRequest`] |
//! | `cost/` | what does a period cost on a target? | [`Cost`] |
//! | `judge/` | how good is a run, against double-double? | [`Reference::judge`] → [`JudgedStep`], [`Fluctuation`], [`Trace`]; [`Reference::show_setpoints`] |
//! | | does it keep what it must, and where does it not? | [`JudgedRun`], [`Requirement`], [`Verdict`] |
//! | | why is no format good, if even `f64` is not? | [`not_of_format`] → [`NotOfFormat`] |
//! | `size/` | how few bits are enough? | [`fewest_bits`] → [`FewestBits`], and for each signal [`size()`] → [`Sizing`]; [`price_sizing`] |
//! | `compare/` | which format is good enough, and which is the cheapest? | [`compare()`], [`compare_with`] → [`Comparison`]; [`price`] |
//!
//! A folder uses only those above it in the table. [`Refusal`], the reason why a part is refused, is shared by all of
//! them.
//!
//! ```
//! use format_compare::{Engine, Options, Problem, compare, select};
//! use part_program::{read_machine, read_part};
//!
//! let machine = "[machine]
//!     interpolation_period_ms = 1.0
//!     feedrate_mm_per_s = 50.0
//!     acceleration_mm_per_s2 = 1000.0
//!     jerk_mm_per_s3 = 40000.0";
//! let part = "G0 X0 Y0\nG1 X10 F3000\nG2 X20 Y10 R10\n";
//! let problem = Problem::<2>::new(&read_part("part.nc", part)?, &read_machine("mill.toml", machine)?)?;
//!
//! let formats = select(&["I16F16", "I4F28", "f64"])?;
//! let found = compare(&problem, &formats, &[Engine::Pieces], &Options::default())?;
//! for run in &found.formats {
//!     println!("{}: {}", run.format, run.verdict);
//! }
//! assert_eq!(found.recommended.as_deref(), Some("I4F28"));
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

#![allow(clippy::module_inception, reason = "a folder's main file has the folder's name")]

mod refusal;

mod problem {
    pub(crate) mod least_periods;
    pub(crate) mod problem;
    pub(crate) mod side_axes;
}

mod plan {
    pub(crate) mod axis_peaks;
    mod calm;
    pub(crate) mod exact_plan;
    pub(crate) mod in_format;
    pub(crate) mod lengths;
    pub(crate) mod merge_rows;
    pub(crate) mod plan_summary;
    pub(crate) mod samples;
}

mod run {
    pub(crate) mod at_cruise;
    pub(crate) mod auditor;
    pub(crate) mod by_engine;
    pub(crate) mod c_files;
    pub(crate) mod constants;
    pub(crate) mod formats;
    pub(crate) mod in_order;
    pub(crate) mod job;
    pub(crate) mod observer;
    mod on_global_parameter;
    pub(crate) mod on_pieces;
    pub(crate) mod options;
    pub(crate) mod overrides;
    mod recorded_run;
    pub(crate) mod run;
    mod steps_on_pieces;
    pub(crate) mod stream;
    pub(crate) mod vectors;
}

mod judge {
    mod arc;
    mod exact_curve;
    pub(crate) mod judged_run;
    pub(crate) mod judgement;
    pub(crate) mod metrics;
    pub(crate) mod not_of_format;
    pub(crate) mod reference;
    pub(crate) mod requirement;
    pub(crate) mod setpoints;
    pub(crate) mod stated_limits;
    pub(crate) mod tally;
    pub(crate) mod trace;
}

mod size {
    pub(crate) mod common_format;
    pub(crate) mod fewest_bits;
    mod signals;
    pub(crate) mod size;
    mod trial;
}

mod compare {
    pub(crate) mod compare;
    pub(crate) mod price;
}

pub use compare::compare::{Compared, Comparison, PartSummary, Watch, common_plan, compare, compare_with};
pub use compare::price::price;
pub use feed_plan::ProfileKind;
pub use judge::judged_run::{JudgedRun, Verdict};
pub use judge::metrics::{ChordTally, Fluctuation, JudgedStep, PerPeriod};
pub use judge::not_of_format::{NotOfFormat, Remedy, not_of_format};
pub use judge::reference::Reference;
pub use judge::requirement::{PeriodEnd, Requirement};
pub use judge::setpoints::SetpointRow;
pub use judge::trace::{Coarseness, Trace};
pub use part_program::Machine;
pub use plan::axis_peaks::AxisPeak;
pub use plan::exact_plan::ExactPlan;
pub use plan::merge_rows::MergeRow;
pub use plan::plan_summary::{OverLimits, PlanSummary, StageRow, largest_second_difference};
pub use plan::samples::FeedSample;
pub use problem::least_periods::{LeastPeriods, MOST_PERIODS};
pub use problem::problem::Problem;
pub use problem::side_axes::SideAxes;
pub use refusal::Refusal;
pub use run::c_files::CRequest;
pub use run::constants::Constants;
pub use run::formats::{
    Dimension, Format, Space, common_or_plan_for, format_named, formats, plan_for, select,
};
pub use run::job::Job;
pub use run::observer::Observer;
pub use run::options::{Engine, Options, PlanIn};
pub use run::overrides::{OverrideCommands, OverrideError, OverrideTarget, Overrides};
pub use run::run::{AboutRun, Run, RunStep};
pub use run::stream::{StreamFailure, StreamRequest};
pub use run::vectors::{RegisterWord, VectorColumn, VectorTable, Vectors, VectorsAbout};
pub use size::common_format::{common_format, runs_in, splits};
pub use size::fewest_bits::{FewestBits, fewest_bits};
pub use size::size::{
    FrontPoint, Mixed, Register, Sizing, price_sizing, register_vectors, run_in_registers, size,
};
pub use target_cost::{Cost, CostSource, PeriodCost, RecordedRun};
