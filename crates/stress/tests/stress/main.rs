//! Random paths and their promises, in one program: a kernel that several of these files run in a format is compiled once.

mod faults;
mod generate;
mod promises;
mod soak;
mod split_mix;
