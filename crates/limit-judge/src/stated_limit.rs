//! A limit that a machine states for a derivative of its motion.

/// What a limit holds for.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Of {
    /// An axis, 0 for X.
    Axis(usize),
    /// The way along the path.
    Path,
    /// All axes together, as a vector.
    Vector,
    /// The jump of an axis' velocity at a corner.
    Jump(usize),
}

/// A limit of a derivative, in mm and periods.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct StatedLimit {
    /// What it holds for.
    pub of: Of,
    /// The derivative less 1: 0 for the velocity, 1 for the acceleration, 2 for the jerk.
    pub order: usize,
    /// The largest value; of the feed along the path, the share of what each step's block commands.
    pub most: f64,
}

impl StatedLimit {
    /// The limit's name.
    #[must_use]
    pub fn what(&self) -> &'static str {
        const OF_AXES: [[&str; 3]; 3] = [
            ["velocity of X", "acceleration of X", "jerk of X"],
            ["velocity of Y", "acceleration of Y", "jerk of Y"],
            ["velocity of Z", "acceleration of Z", "jerk of Z"],
        ];
        const JUMPS: [&str; 3] = ["velocity jump of X", "velocity jump of Y", "velocity jump of Z"];
        const OF_PATH: [&str; 3] = ["feed", "acceleration along the path", "jerk along the path"];
        const OF_VECTOR: [&str; 3] = ["feed", "total acceleration", "total jerk"];
        match self.of {
            Of::Axis(axis) => OF_AXES[axis][self.order],
            Of::Path => OF_PATH[self.order],
            Of::Vector => OF_VECTOR[self.order],
            Of::Jump(axis) => JUMPS[axis],
        }
    }
}
