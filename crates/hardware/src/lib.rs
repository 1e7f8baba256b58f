//! `hardware`: the step of a compiled part as microcode for a small core, and the core in Verilog.
//!
//! [`compile`] takes the C that [`c-code`](https://docs.rs/c-code) writes, which is enough of a description: no recursion, loops with
//! bounds, no arithmetic on pointers, and numbers only by named functions. It gives [`CoreFiles`], and runs the microcode over the
//! whole part before.
//!
//! | files | make |
//! |---|---|
//! | `lexer`, `parser`, `syntax` | functions of the C's text |
//! | `front`, `expressions`, `intrinsics`, `statements`, `calls`, `control` | blocks of operations on registers |
//! | `tables`, `operation`, `program`, `arithmetic` | what such a program is, and what each operation gives |
//! | `executor` | a run of the blocks, one operation after the other |
//! | `liveness`, `coalesce` | which registers are read later, and one register for those that copies join |
//! | `paths`, `graph` | straight ways through the blocks, and the values in them, each once |
//! | `timing`, `schedule`, `microcode`, `image` | words of microcode in their cycles, registers, and the table memory |
//! | `machine`, `pace` | a run of the microcode, cycle by cycle, and the least period that it holds |
//! | `verilog` | the texts, from `templates/core.v` and `templates/testbench.v` |

mod arithmetic;
mod calls;
mod coalesce;
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
mod operation;
mod pace;
mod parser;
mod paths;
mod program;
mod schedule;
mod statements;
mod syntax;
mod tables;
mod timing;
mod verilog;

pub use compile::{CoreFiles, CoreRequest, Figures, QUEUES, compile};
pub use error::CoreError;
