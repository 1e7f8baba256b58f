//! Comparisons, plans and runs in many formats, in one program: it links the library, in which every format is compiled
//! once, and compiles none again.

mod examples;

mod audits;
mod axis_peaks;
mod compare;
mod corners;
mod exact_plan;
mod fewest_bits;
mod formats;
mod least_periods;
mod not_of_format;
mod overrides;
mod plans_followed;
mod problem;
mod recorded_runs;
mod requirements;
mod samples;
mod side_axes;
mod still_places;
mod stream;
mod trace;
mod vectors;
mod windows;
