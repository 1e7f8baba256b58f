//! `hardware`: the step of a compiled part as microcode for a small core, and the core in Verilog.

mod arithmetic;
mod calls;
mod compile;
mod control;
mod error;
mod executor;
mod expressions;
mod front;
mod graph;
mod image;
mod intrinsics;
mod lexer;
mod liveness;
mod machine;
mod microcode;
mod parser;
mod paths;
mod program;
mod schedule;
mod statements;
mod syntax;
mod tables;
mod timing;
mod verilog;

pub use compile::{CoreFiles, CoreRequest, Figures, compile};
pub use error::CoreError;
