//! Tests that cross crates.

mod book;
mod constants;
mod hard_curves;
mod paper_a;
mod plan_keeps_limits;
