//! `target-cost`: how much does a recorded real-time step cost on a processor or an FPGA?
//!
//! A step's data-flow graph ([`real::Graph`]) becomes a [`Step`] of operations, and a [`Target`] schedules it: in
//! program order on a processor, by list scheduling on the units of a VLIW or an FPGA. Targets are data files. Every
//! number in them names its source and its confidence. A number that nobody has published is `unknown`.
//!
//! ```
//! use real::{Graph, I4F28, Real, Recorded};
//! use target_cost::{Step, StepCost, built_in};
//!
//! let number = |name| Recorded::<I4F28>::input(name, I4F28::from_ratio(1, 3));
//! let (_, graph) = Graph::of(|| number("a").mul_add(number("x"), number("b")));
//! let step = Step::of(&graph);
//! for target in built_in()? {
//!     match StepCost::of(&step, &target, real::FormatName::fixed(4, 28)) {
//!         Ok(cost) => println!("{}: {:.0} cycles", target.title, cost.length.typical),
//!         Err(none) => println!("{}: {} is unknown", target.title, none.operation.name()),
//!     }
//! }
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```
//!
//! | question | where |
//! |---|---|
//! | which operations does a step have? | [`Step`], [`Task`], [`Priced`] |
//! | how much does one cost, and who says so? | [`Target`], [`Row`] |
//! | which instructions were counted? | [`Calibration`] |
//! | how long does the step take, and which limit decides that? | [`StepCost`] |
//! | what do the steps of a run cost, in the mean and at most? | [`RecordedRun`], [`cost()`] |
//! | how many instructions does a period take at most? | [`period_bounds`] |

mod built_in;
mod calibration;
mod cycles;
mod error;
mod period_bound;
mod place;
mod recorded_run;
mod run_cost;
mod schedule;
mod target;
mod target_file;
mod task;

pub use built_in::built_in;
pub use calibration::{Calibration, Prediction};
pub use cycles::{Cycles, Level};
pub use error::TargetError;
pub use period_bound::{Limits, Most, PeriodBound, period_bounds};
pub use recorded_run::RecordedRun;
pub use run_cost::{Cost, CostSource, PeriodCost, cost, operations};
pub use schedule::{NoPrice, Placed, StepCost};
pub use target::{Clock, Confidence, Kind, Known, Measure, Mhz, Price, Row, Target, Unit, Unknown};
pub use task::{Priced, Step, Task};
