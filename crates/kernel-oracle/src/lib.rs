//! `kernel-oracle`: one operation, one step, one period or one plan of a kernel, against what it must be.
//!
//! A case is drawn from bytes, by a fuzzer or a seeded generator, takes far less than a millisecond, and knows the
//! right answer: by integers of any size, by double-double, or by the promise of a docstring. Whole paths are the
//! matter of the crate `stress`.
//!
//! | question | answer |
//! |---|---|
//! | is every operation of every format the exact one, rounded and fitted? | [`OperationCase::check`], [`ExactFormat::check_operations`] |
//! | does one step, from any place of any piece and over its joints, travel the wanted chord? | [`ChordCase::check`] |
//! | by how much may a chord differ from the wanted one? | [`ChordBound`] |
//! | where are the points, chords and turns of pieces? | [`PieceJudge`] |
//! | is each period of any stages as long as its feed makes it? | [`StageCase::check`] |
//! | does a plan keep its promises? | [`PlanPromises::check`] |
//! | does it where its limit is a table, and is a damaged plan seen? | [`LimitTable::check`] |
//! | is a stream of any content refused, or run forward? | [`StreamCase::check`], [`reads_stream`] |
//!
//! A wrong result is a [`KernelFault`], a figure beyond its bound a [`Violation`].

mod chord_bound;
mod chords;
mod exact_format;
mod fault;
mod limit_tables;
mod operations;
mod piece_judge;
mod plan_promises;
mod stage_lengths;
mod streams;
mod violation;

pub use chord_bound::ChordBound;
pub use chords::{ChordCase, ChordTally};
pub use exact_format::ExactFormat;
pub use fault::KernelFault;
pub use limit_tables::LimitTable;
pub use operations::{Operands, OperationCase};
pub use piece_judge::{PieceJudge, RIGHT_ANGLE, Turns};
pub use plan_promises::PlanPromises;
pub use stage_lengths::StageCase;
pub use streams::{StreamCase, reads_stream, sealed};
pub use violation::{Violation, demand};
