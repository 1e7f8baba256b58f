//! The parts that the papers print, as committed files.

/// Paper A's curve and machine.
pub(crate) const PAPER_A: &str = include_str!("../../../data/seed-000.toml");
/// Paper D's program.
pub(crate) const PAPER_D: &str = include_str!("../../../data/seed-003.nc");
/// The drive that is fitted to paper D's circle test.
pub(crate) const SERVO: &str = include_str!("../../../data/servo.toml");
