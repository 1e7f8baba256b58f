//! Kernels against exact arithmetic: the same drawn cases in each run, and a format of eight bits whole.

mod chords;
mod limit_tables;
mod operations;
mod seeded_bytes;
mod small_format;
mod stage_lengths;
mod streams;
