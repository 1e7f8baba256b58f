//! The command line, as a person or a script uses it. One program, so that its tests run side by side.

mod command;
mod message;
mod small_part;

mod baseline;
mod check;
mod cli;
mod compile;
mod convert;
mod domains;
#[cfg(unix)]
mod files;
mod judge;
mod machines;
#[cfg(unix)]
mod names;
#[cfg(unix)]
mod outputs;
mod overrides;
mod plan;
mod refused;
mod report;
mod report_in_browser;
mod servo;
mod sets;
mod side_axes;
#[cfg(target_os = "linux")]
mod signals;
mod smooth;
#[cfg(target_os = "linux")]
mod statuses;
mod stream;
mod sweep;
mod targets;
mod terminal;
mod window;
