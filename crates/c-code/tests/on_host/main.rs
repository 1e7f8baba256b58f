//! C files are compiled for the host: without a warning, and their self-tests, which compare a checksum over all setpoints with
//! Rust's, find the same run.
//!
//! The compilers are `gcc` and `clang`, those of them that are found, or `cc`. Where there is none, the tests say so and pass, unless
//! `FEEDBITS_C_COMPILER=required` asks for both.

mod compilers;
mod hostile_names;
mod paths;
mod planned_path;
mod program;
mod random_parts;
mod runs;
mod warnings;
