//! `format-compare`: one part, many number formats, a verdict each.
//!
//! | question | answer |
//! |---|---|
//! | what is run, within which limits? | [`Problem`] |
//! | what is the plan, exactly? | [`ExactPlan`] |
//! | which formats are there? | [`formats`], [`select`] |
//! | what does one format make of it? | [`Format::run`] → [`Run`] |
//! | the same with the feed overridden on the way? | [`Overrides`] |
//! | how long does it take at the least? | [`LeastPeriods`] |
//! | how good is that? | [`Reference::judge`] → [`JudgedStep`], [`Fluctuation`] |
//! | which format is good enough? | [`compare`] → [`Comparison`] |
//! | why is none, if even `f64` is not? | [`not_of_format`] → [`NotOfFormat`] |
//! | what happened in each period? | [`compare_with`] → [`Trace`] |
//! | what does a period cost on a target? | [`price`] → [`Cost`] |
//! | how few bits are enough? | [`fewest_bits`] → [`FewestBits`], and for each signal [`size`] → [`Sizing`] |

mod axis_peaks;
mod compare;
mod constants;
mod cost;
mod exact_plan;
mod fewest_bits;
mod formats;
mod least_periods;
mod metrics;
mod not_of_format;
mod on_global_parameter;
mod on_pieces;
mod overrides;
mod plan_table;
mod problem;
mod recorded;
mod reference;
mod requirement;
mod run;
mod setpoints;
mod size;
mod trace;

pub use axis_peaks::AxisPeak;
pub use compare::{Comparison, PartSummary, Row, Verdict, compare, compare_with, in_parallel};
pub use constants::Constants;
pub use cost::{Cost, Level, PeriodCost, price, price_with};
pub use exact_plan::ExactPlan;
pub use feed_plan::ProfileKind;
pub use fewest_bits::{FewestBits, fewest_bits};
pub use formats::{Dimension, Format, Space, formats, plan_for, select};
pub use least_periods::{LeastPeriods, MOST_PERIODS};
pub use metrics::{Fluctuation, JudgedStep, PerPeriod, jerk_of_chords};
pub use not_of_format::{NotOfFormat, Remedy, not_of_format};
pub use overrides::{OverrideCommands, OverrideError, OverrideTarget, Overrides};
pub use part_program::Machine;
pub use plan_table::{FeedSample, PlanSummary, StageRow, largest_second_difference};
pub use problem::Problem;
pub use recorded::RecordedRun;
pub use reference::Reference;
pub use requirement::{Place, Requirement};
pub use run::{Engine, Options, PlanIn, Refusal, Run, RunStep};
pub use setpoints::{SetpointRow, SetpointTable};
pub use size::{FrontPoint, Mixed, Register, Sizing, size};
pub use trace::Trace;
