//! C files are compiled for the host, and their self-tests run: each compares a checksum over all setpoints with Rust's.
//!
//! The compilers are `gcc` and `clang`, those of them that are found. Where there is none, the tests say so and pass.

mod compiler;
mod papers;
mod random_parts;
