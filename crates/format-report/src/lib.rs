//! `format-report`: a comparison of number formats as a page for people.
//!
//! One file, `index.html`, opens anywhere without a network: the answer, the formats with their verdicts, and pictures
//! whose formats can be switched on and off. Beside it lies each picture as SVG and each table as CSV and JSON.
//!
//! | question | where |
//! |---|---|
//! | what is a report made of? | [`Material`], [`Solver`], [`Schedule`] |
//! | where does a format stay good? | [`Sweep`], [`SweepCell`] |
//! | which format is good for many parts? | [`SetPage`], [`PartOfSet`] |
//! | what did a controller do, by its log? | [`LogPage`], [`LogLimitRow`], [`LogPathPoint`] |
//! | which format is good for a kernel of your own? | [`KernelPage`] |
//! | what does it consist of? | [`Report`], [`Figure`], [`Table`] |
//! | what is a picture of any lines? | [`LineChart`] |
//!
//! `plotters` draws axes, ticks and grids on a canvas of SVG elements that have classes in place of colours. A long
//! series is drawn by the least and the greatest value of each pixel column. So a picture of a million periods takes no
//! more room than one of a thousand, and no extreme is lost.
//!
//! The feature `comparisons`, which is on unless you turn it off, brings [`Material`] and what is drawn of it.
//!
//! Names of parts and targets, and the command, are text from outside: `askama` and `svg` escape them, and `foreign-text` says what of
//! them a page, a picture, a cell of CSV and the name of a file may hold.

#![cfg_attr(
    not(feature = "comparisons"),
    allow(dead_code, reason = "some marks and axes are those of the pictures of a comparison alone")
)]

mod canvas;
mod chart;
#[cfg(feature = "comparisons")]
mod comparison;
mod cost_table;
mod envelope;
mod equal_scales;
mod figure;
mod frame;
mod kernel;
mod levels;
mod line_chart;
mod log_page;
mod log_path;
mod log_path_point;
mod number;
mod palette;
mod ranges;
mod report;
mod set;
mod sweep;
mod switch;
mod table;
mod thinned;

#[cfg(feature = "comparisons")]
pub use comparison::{Material, Schedule, Solver};
pub use figure::Figure;
pub use kernel::KernelPage;
pub use line_chart::LineChart;
pub use log_page::{LogLimitRow, LogPage};
pub use log_path_point::LogPathPoint;
pub use report::{Report, listed};
pub use set::{PartOfSet, SetPage};
pub use sweep::{Sweep, SweepCell, SweepCost, SweepResult};
pub use table::{Cell, Column, Table};
