//! `kernel-zoo`: kernels of controllers whose numbers failed in public.
//!
//! Each file has one kernel, written from the formula that a public report describes, with the numbers of the report where it
//! gives them. Each runs as it was reported and with its cure, in every format. No code of the projects is used.
//!
//! ```
//! let report = kernel_zoo::named("open-loop-angle").expect("a kernel of the zoo");
//! let found = report.judge(&kernel_size::built_in())?;
//! assert!(found.as_reported.good_formats.contains(&"f64".to_string()));
//! assert!(found.cured.good_formats.contains(&"f32".to_string()));
//! # Ok::<(), kernel_size::Refusal>(())
//! ```

mod report;

mod arc_epsilon;
mod bezier_ramp;
mod brake_steps;
mod clock_in_ms;
mod encoder_pll;
mod extruder_position;
mod first_interval;
mod full_circle;
mod open_loop_angle;
mod pid_zero_time;
mod ramp_steps;
mod rate_register;
mod relative_moves;
mod running_sum;
mod step_time;
mod tick_schedule;
mod trajectory_time;
mod turns_and_angle;

pub use report::{Found, Report, Variant};

/// All kernels, in the order of names.
pub const ALL: [&Report; 18] = [
    &arc_epsilon::REPORT,
    &bezier_ramp::REPORT,
    &brake_steps::REPORT,
    &clock_in_ms::REPORT,
    &encoder_pll::REPORT,
    &extruder_position::REPORT,
    &first_interval::REPORT,
    &full_circle::REPORT,
    &open_loop_angle::REPORT,
    &pid_zero_time::REPORT,
    &ramp_steps::REPORT,
    &rate_register::REPORT,
    &relative_moves::REPORT,
    &running_sum::REPORT,
    &step_time::REPORT,
    &tick_schedule::REPORT,
    &trajectory_time::REPORT,
    &turns_and_angle::REPORT,
];

/// The kernel of this name.
#[must_use]
pub fn named(name: &str) -> Option<&'static Report> {
    ALL.into_iter().find(|report| report.name == name)
}
