//! Whether the table has followed the path to its end.
//!
//! The contour error is the distance from the table to the path, so a table that never leaves one point of the path has
//! none. Two conditions tell such a table from one that follows:
//!
//! - *the end*: once settled, the table is as near to the last command as its loop at rest can come, which is
//!   [`ServoParameters::standstill_error_mm`](crate::ServoParameters::standstill_error_mm) on each axis;
//! - *the reach*: the table has been at least half as far from the start as the command. The end alone is not enough,
//!   because a closed path ends where it begins.
//!
//! A loop whose standstill error is as large as half of the path's reach cannot follow a path of that size.

use serde::Serialize;

use crate::ServoError;

/// Where a run took the table, and where the commands led; all in mm.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize)]
pub struct Arrival {
    /// Distance of the table from the last command, once the loops have settled.
    pub end_error_mm: f64,
    /// The largest part of that distance which loops at rest may leave.
    pub standstill_error_mm: f64,
    /// Largest distance of the command from the start.
    pub reach_mm: f64,
    /// Largest distance of the table from the start.
    pub table_reach_mm: f64,
}

impl Arrival {
    /// Refuses a run in which the table does not follow.
    ///
    /// # Errors
    /// [`ServoError::DoesNotArrive`], [`ServoError::StaysBehind`].
    pub fn validate(&self) -> Result<(), ServoError> {
        /// The part of the reach that settling may leave: an old setpoint's effect has then fallen to 2e-9.
        const UNSETTLED: f64 = 1e-6;
        let half = self.reach_mm / 2.0;
        let most_mm = self.standstill_error_mm.min(half) + UNSETTLED * self.reach_mm;
        let end_error_mm = self.end_error_mm;
        if end_error_mm > most_mm {
            return Err(ServoError::DoesNotArrive { end_error_mm, most_mm });
        }
        if self.table_reach_mm < half {
            let (reach_mm, commanded_mm) = (self.table_reach_mm, self.reach_mm);
            return Err(ServoError::StaysBehind { reach_mm, commanded_mm });
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{Servo, ServoParameters};
    use proptest::prelude::*;
    use std::f64::consts::TAU;

    const T: f64 = 1e-3;

    /// Half a turn, or a whole one, on R5 at 50 mm/s.
    fn arrival(parameters: ServoParameters, turns: f64) -> Arrival {
        let periods = (1..=10_000).map(f64::from).take_while(|k| k * T * 10.0 <= TAU * turns);
        let circle = periods.map(|k| [5.0 * (k * T * 10.0).cos(), 5.0 * (k * T * 10.0).sin()]);
        Servo::<f64, 2>::try_new(&[parameters; 2], T, [5.0, 0.0]).unwrap().run(circle).unwrap().arrival()
    }

    #[test]
    fn a_machine_that_cannot_move_does_not_follow_even_a_path_that_comes_back() {
        let stuck = ServoParameters { friction_mm_per_s2: 1e9, ..ServoParameters::new(30.0, 1.0) };
        let half = arrival(stuck, 0.5);
        assert!(matches!(half.validate(), Err(ServoError::DoesNotArrive { .. })), "{half:?}");
        let whole = arrival(stuck, 1.0);
        assert!(matches!(whole.validate(), Err(ServoError::StaysBehind { .. })), "{whole:?}");
        let said = whole.validate().unwrap_err().to_string();
        assert!(said.starts_with("the table does not follow: ") && said.contains("10.0000 mm"), "{said}");
    }

    #[test]
    fn a_loop_that_has_not_settled_after_a_million_sub_steps_does_not_arrive() {
        let slow = ServoParameters { sub_steps: 200, ..ServoParameters::new(0.01, 1.0) };
        let found = arrival(slow, 0.5);
        assert!(matches!(found.validate(), Err(ServoError::DoesNotArrive { .. })), "{found:?}");
    }

    /// Each of these leaves the table off the end, by no more than the bound that it names.
    #[test]
    fn friction_play_compensation_and_encoder_leave_no_more_than_the_bound() {
        let ideal = ServoParameters::new(30.0, 1.0);
        for (machine, bound) in [
            (ideal, 0.0),
            (ServoParameters { friction_mm_per_s2: 3000.0, ..ideal }, 0.1),
            (ServoParameters { backlash_mm: 1.0, ..ideal }, 0.5),
            (ServoParameters { backlash_compensation_mm: 0.1, feed_forward: 1.0, ..ideal }, 0.05),
            (ServoParameters { encoder_resolution_mm: 0.01, ..ideal }, 0.01),
            (ServoParameters { encoder_resolution_mm: 0.0173, ..ServoParameters::new(300.0, 30.0) }, 0.0173),
        ] {
            assert!((machine.standstill_error_mm() - bound).abs() < 1e-12, "{machine:?}");
            for turns in [0.1, 0.5, 0.77, 1.0] {
                let found = arrival(machine, turns);
                assert_eq!(found.validate(), Ok(()), "{turns} turns of {machine:?}: {found:?}");
            }
        }
    }

    proptest! {
        /// No false alarm: a drive that is poor, but whose dead band of less than 1 mm is small against the path's reach
        /// of at least 5.8 mm, arrives within the bound.
        #[test]
        fn a_drive_that_moves_arrives(
            (gain, lag) in (10.0..200.0_f64, 0.2..10.0_f64),
            (feed_forward, acceleration_feed_forward) in (0.0..1.2_f64, 0.0..1.2_f64),
            (friction, play) in (0.0..700.0_f64, 0.0..0.15_f64),
            compensated in 0.0..1.5_f64,
            encoder in prop_oneof![Just(0.0), 1e-5..0.02_f64],
            turns in 0.2..1.0_f64,
        ) {
            let machine = ServoParameters {
                feed_forward,
                acceleration_feed_forward,
                friction_mm_per_s2: friction,
                backlash_mm: play,
                backlash_compensation_mm: compensated * play,
                encoder_resolution_mm: encoder,
                ..ServoParameters::new(gain, lag)
            };
            let found = arrival(machine, turns);
            prop_assert_eq!(found.validate(), Ok(()), "{:?}", found);
        }
    }
}
