//! Tests that cross crates.

mod book;
mod constants;
mod fewest_bits;
mod hard_curves;
mod paper_a;
mod plan_keeps_limits;
