//! How far from the commanded path a program lets a control go.

/// How far from the commanded path a program lets a control go: `G64 P… Q…` of LinuxCNC.
///
/// The control makes one straight move of several that are within Q of it, and rounds the corners of what it then has within P. So its path
/// is at most P + Q from the commanded one. A P of 0 is none: corners are then rounded as far as the feed takes.
///
/// # Source
/// LinuxCNC, `convert_control_mode` of its interpreter, where a Q that is not written is P, and `tcFindBlendTolerance` of its planner.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PathTolerance {
    /// P, in mm: how far the rounding of a corner may be from the path. Above 0.
    pub rounding_mm: f64,
    /// Q, in mm: how far straight moves may be from the one that is made of them.
    pub merging_mm: f64,
}

impl PathTolerance {
    /// Of the numbers of G64, in mm, as far as they are written. A negative one is as if it were not.
    pub(crate) fn of(p_mm: Option<f64>, q_mm: Option<f64>) -> Option<Self> {
        let rounding_mm = p_mm.filter(|p| *p > 0.0)?;
        Some(Self { rounding_mm, merging_mm: q_mm.filter(|q| *q >= 0.0).unwrap_or(rounding_mm) })
    }

    /// How far from the commanded path the control may be, in mm: P + Q.
    #[must_use]
    pub fn most_mm(&self) -> f64 {
        self.rounding_mm + self.merging_mm
    }
}

/// Where in a part another tolerance comes into force, or none.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ToleranceFrom {
    /// The first move for which it holds, by its number from 0.
    pub first_move: usize,
    /// The tolerance; `None` where the program states none.
    pub tolerance: Option<PathTolerance>,
}
