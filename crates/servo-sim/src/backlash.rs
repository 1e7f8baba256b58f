//! Play between motor and table, and how a control compensates it at a reversal.

use real::{Backend, Real};

use crate::ServoError;
use crate::control_law::in_format;

/// Play of a given width: the table rests until the motor has crossed it.
///
/// `table ← clamp(table, motor - b/2, motor + b/2)`. The encoder sits on the motor and does not see the play.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Play {
    /// The width b, in mm.
    pub width: f64,
}

impl Play {
    /// The table's position once the motor is at `motor`, all in mm. If the motor's position is NaN the table stays
    /// where it is.
    #[must_use]
    pub fn follow(&self, table: f64, motor: f64) -> f64 {
        let half = self.width / 2.0;
        table.max(motor - half).min(motor + half)
    }
}

/// The compensation that the control adds when the commanded motion of an axis reverses. It is an offset of the command
/// that crosses the play, and for some time an acceleration b_a. The acceleration is given as the velocity `b_a τ`,
/// which the lag τ of the velocity loop turns into b_a.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ReversalCompensation<R> {
    /// Half of the compensated play, in mm.
    half_width: R,
    /// The added velocity, in mm per sub-step.
    boost: R,
    /// Number of sub-steps for which the boost is added.
    boost_sub_steps: u32,
}

/// The state of the compensation.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct ReversalState {
    direction: Option<Direction>,
    boost_left: u32,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Direction {
    Up,
    Down,
}

/// The values to add in this sub-step.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Compensation<R> {
    /// To the commanded position, in mm.
    pub position: R,
    /// To the velocity command, in mm per sub-step.
    pub velocity: R,
}

impl<R: Backend> ReversalCompensation<R> {
    /// Compensates a play of `width` (mm), with an acceleration (mm/s²) for `boost_s` (s) over a lag τ (s), at sub-steps
    /// of h (s).
    ///
    /// # Errors
    /// [`ServoError::ParameterNotInFormat`] if one of them is out of the format's range or vanishes in it.
    pub fn try_new(
        width: f64,
        acceleration: f64,
        boost_s: f64,
        lag: f64,
        sub_step: f64,
    ) -> Result<Self, ServoError> {
        let count = (boost_s / sub_step).round();
        let boost_sub_steps = (0..=1_000_000_u32).find(|&n| f64::from(n) >= count).unwrap_or(1_000_000);
        Ok(Self {
            half_width: in_format("half of the backlash compensation", width / 2.0)?,
            boost: in_format("backlash acceleration per sub-step", acceleration * lag * sub_step)?,
            boost_sub_steps,
        })
    }
}

impl<R: Real> ReversalCompensation<R> {
    /// Takes the commanded increment of this sub-step. The first motion does not count as a reversal: the motor is
    /// assumed to be at that side of the play already.
    pub fn step(&self, state: &mut ReversalState, increment: R) -> Compensation<R> {
        let zero = R::zero();
        let direction = match increment {
            i if i > zero => Some(Direction::Up),
            i if i < zero => Some(Direction::Down),
            _ => state.direction,
        };
        if state.direction.is_some() && direction != state.direction {
            state.boost_left = self.boost_sub_steps;
        }
        state.direction = direction;
        let boosting = state.boost_left > 0;
        state.boost_left = state.boost_left.saturating_sub(1);
        let boost = if boosting { self.boost } else { zero };
        match direction {
            None => Compensation { position: zero, velocity: zero },
            Some(Direction::Up) => Compensation { position: self.half_width, velocity: boost },
            Some(Direction::Down) => Compensation { position: -self.half_width, velocity: -boost },
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_table_rests_until_the_motor_has_crossed_the_play() {
        let play = Play { width: 0.01 };
        let motor = [0.0, 1.0, 0.995, 0.991, 0.98, 0.985];
        let table: Vec<f64> = motor
            .iter()
            .scan(0.0, |table, &motor| {
                *table = play.follow(*table, motor);
                Some(*table)
            })
            .collect();
        for (found, expected) in table.iter().zip([0.0, 0.995, 0.995, 0.995, 0.985, 0.985]) {
            assert!((found - expected).abs() < 1e-15, "{table:?}");
        }
    }

    #[test]
    fn a_reversal_moves_the_command_and_pushes_for_a_while() {
        // 10 µm, 1000 mm/s² for 2 sub-steps of 0.1 ms over a lag of 1 ms: 1 mm/s, or 1e-4 mm a sub-step.
        let compensation = ReversalCompensation::<f64>::try_new(0.01, 1000.0, 2e-4, 1e-3, 1e-4).unwrap();
        let mut state = ReversalState::default();
        let found: Vec<(f64, f64)> = [0.0, 1.0, 1.0, 0.0, -1.0, -1.0, -1.0]
            .map(|increment| compensation.step(&mut state, increment))
            .map(|added| (added.position, added.velocity))
            .to_vec();
        let (up, down) = ((0.005, 0.0), (-0.005, 0.0));
        let expected = [(0.0, 0.0), up, up, up, (-0.005, -1e-4), (-0.005, -1e-4), down];
        for (found, expected) in found.iter().zip(expected) {
            let close = |a: f64, b: f64| (a - b).abs() < 1e-15;
            assert!(close(found.0, expected.0) && close(found.1, expected.1), "{found:?} {expected:?}");
        }
    }
}
