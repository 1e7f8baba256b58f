//! How a log keeps a tolerance that its part states.

use part_program::PathTolerance;
use serde::Serialize;

use crate::off::Off;

/// How a log keeps a tolerance that its part states, P and Q of LinuxCNC's G64, on the moves at feed for which it holds.
#[derive(Clone, Copy, Debug, Serialize)]
pub struct JudgedTolerance {
    /// P, how far the rounding of a corner may be from the path, in mm.
    pub rounding_mm: f64,
    /// Q, how far straight moves may be from the one that is made of them, in mm.
    pub merging_mm: f64,
    /// Whether it is kept.
    pub verdict: ToleranceVerdict,
    /// The larger of both distances, as a share of P.
    pub share: f64,
    /// The largest distance of a setpoint from the path, wherever on it.
    pub off_path: Off,
    /// The largest distance of the path from the log, which is at a corner.
    pub off_log: Off,
}

/// Whether a tolerance is kept.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum ToleranceVerdict {
    /// The log is within P of the path.
    Kept,
    /// It is farther off than P, and within P + Q, as a control may be that makes one of several straight moves.
    KeptIfMerged,
    /// It is farther off than P + Q.
    Broken,
}

/// What is hidden of distances, in mm.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Hidden {
    /// By the log's resolution.
    pub(crate) by_resolution_mm: f64,
    /// By a motion that is not straight between two setpoints.
    pub(crate) between_setpoints_mm: f64,
}

impl JudgedTolerance {
    pub(crate) fn of(tolerance: &PathTolerance, [off_path, off_log]: [Off; 2], hidden: Hidden) -> Self {
        let is_within = |most_mm: f64| {
            let most_mm = most_mm * (1.0 + 1e-9) + hidden.by_resolution_mm;
            off_path.mm <= most_mm && off_log.mm <= most_mm + hidden.between_setpoints_mm
        };
        let verdict = if is_within(tolerance.rounding_mm) {
            ToleranceVerdict::Kept
        } else if is_within(tolerance.most_mm()) {
            ToleranceVerdict::KeptIfMerged
        } else {
            ToleranceVerdict::Broken
        };
        let PathTolerance { rounding_mm, merging_mm } = *tolerance;
        let share = off_path.mm.max(off_log.mm) / rounding_mm;
        Self { rounding_mm, merging_mm, verdict, share, off_path, off_log }
    }

    /// How far the log may be from the path, in mm.
    fn most_mm(&self) -> f64 {
        self.rounding_mm + self.merging_mm
    }

    /// The share of that which is taken.
    pub(crate) fn used(&self) -> f64 {
        self.off_path.mm.max(self.off_log.mm) / self.most_mm()
    }

    /// That it is broken, in short.
    pub(crate) fn fault(&self) -> Option<String> {
        let (what, off) = if self.off_path.mm >= self.off_log.mm {
            ("leaves", &self.off_path)
        } else {
            ("cuts", &self.off_log)
        };
        (self.verdict == ToleranceVerdict::Broken).then(|| {
            format!(
                "the log {what} the path by {:.6} mm in line {}, where G64 allows {:.6} mm",
                off.mm,
                off.line,
                self.most_mm()
            )
        })
    }
}
