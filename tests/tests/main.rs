//! Tests that cross crates.

mod constants;
mod fewest_bits;
mod hard_curves;
mod paper_a;
mod plan_keeps_limits;
