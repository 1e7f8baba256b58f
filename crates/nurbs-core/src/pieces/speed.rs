//! The speed |C'| on a piece, and the steps per chord that follow from it.

use real::Real;

use crate::pieces::scales::{exponent_below, power_of_two};

/// The greatest magnitude of a piece's step exponent.
pub(crate) const MAX_STEP_EXPONENT: i32 = 60;

/// |C'(t)| of a piece in mm per unit of t.
#[derive(Clone, Copy)]
pub(crate) struct Speed {
    pub(crate) least: f64,
    pub(crate) greatest: f64,
    pub(crate) begin: f64,
    pub(crate) end: f64,
}

impl Speed {
    /// Whether the greatest speed is at most `max_ratio` times the least, which is above 0.
    pub(crate) fn is_even(&self, max_ratio: f64) -> bool {
        self.least > 0.0 && self.greatest <= max_ratio * self.least
    }

    /// s for which the mean of |C'|·2^(λ - s) lies between 1/√2 and √2.
    pub(crate) fn step_exponent(&self, chord_exponent: i32) -> i32 {
        let mean = Real::sqrt(self.least * self.greatest);
        (exponent_below(mean * core::f64::consts::SQRT_2) + chord_exponent)
            .clamp(-MAX_STEP_EXPONENT, MAX_STEP_EXPONENT)
    }

    /// The range of steps per chord: `1/|C'|` in the solver's scale, with a margin for trials.
    pub(crate) fn step_per_chord(&self, exponent: i32) -> [f64; 2] {
        const MARGIN: f64 = 1.0625;
        let unit = power_of_two(exponent);
        [1.0 / (self.greatest * unit * MARGIN), MARGIN / (self.least * unit)]
    }
}
