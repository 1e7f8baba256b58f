//! Runs of the interpolators, in one program: a kernel that several of these files run in a format is compiled once.

mod alike;
mod compiled_path;
mod compiled_pieces;
mod degenerate_paths;
mod landing;
mod landing_run;
mod nonsense_fields;
mod operation_counts;
mod overridden;
mod passed_corners;
mod path_run;
mod random_paths;
mod random_programs;
mod steps;
mod stream;
