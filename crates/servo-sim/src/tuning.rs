//! The tuning table: a circle at several settings of feed-forward and velocity gain.

use serde::Serialize;

use crate::{CircleTest, ServoError, ServoParameters};

/// Feed-forward fractions of the table.
pub const FEED_FORWARDS: [f64; 5] = [0.0, 0.95, 0.98, 0.99, 1.0];
/// Velocity gains of the table, in per cent.
pub const VELOCITY_GAINS_PERCENT: [f64; 3] = [100.0, 200.0, 300.0];

/// The circle at one setting.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct TuningRow {
    /// Feed-forward α, a fraction.
    pub feed_forward: f64,
    /// Velocity gain, in per cent.
    pub velocity_gain_percent: f64,
    /// Mean radial error, in mm; negative inside.
    pub radial_error_mean_mm: f64,
    /// Roundness, in mm.
    pub roundness_mm: f64,
}

/// A setting at which the table does not make a circle.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LeftOut {
    /// Feed-forward α, a fraction.
    pub feed_forward: f64,
    /// Velocity gain, in per cent.
    pub velocity_gain_percent: f64,
    /// The reason.
    pub reason: ServoError,
}

/// The tuning table. Every setting is in one of the two lists.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Tuning {
    /// The circles.
    pub rows: Vec<TuningRow>,
    /// The settings without a circle.
    pub left_out: Vec<LeftOut>,
}

/// Runs `test` at every setting of [`FEED_FORWARDS`] and [`VELOCITY_GAINS_PERCENT`], with all other parameters as
/// given. A setting is left out, with the reason, if its velocity loop oscillates, its position loop is unstable, or
/// its table does not follow the circle.
///
/// # Errors
/// [`ServoError`] of the other parameters, or of the test.
pub fn tuning_table(parameters: &[ServoParameters; 2], test: &CircleTest) -> Result<Tuning, ServoError> {
    let mut tuning = Tuning::default();
    for velocity_gain_percent in VELOCITY_GAINS_PERCENT {
        for feed_forward in FEED_FORWARDS {
            let set = |p: ServoParameters| {
                ServoParameters { feed_forward, ..p }.with_velocity_gain(velocity_gain_percent)
            };
            match test.run::<f64>(&parameters.map(set)) {
                Ok(circle) => tuning.rows.push(TuningRow {
                    feed_forward,
                    velocity_gain_percent,
                    radial_error_mean_mm: circle.radial_error_mean_mm,
                    roundness_mm: circle.roundness_mm,
                }),
                Err(reason) if belongs_to_the_setting(&reason) => {
                    tuning.left_out.push(LeftOut { feed_forward, velocity_gain_percent, reason });
                }
                Err(error) => return Err(error),
            }
        }
    }
    Ok(tuning)
}

/// Whether this error depends on the setting, so that another setting may not have it.
fn belongs_to_the_setting(reason: &ServoError) -> bool {
    matches!(
        reason,
        ServoError::VelocityLoopOscillates { .. }
            | ServoError::CurrentLoopSlow { .. }
            | ServoError::Unstable { .. }
            | ServoError::DoesNotTurn { .. }
    )
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The trends of the paper's table 2, on the sample machine.
    #[test]
    fn the_papers_trends() {
        let sample = ServoParameters::from_toml(include_str!("../../../data/servo.toml")).unwrap();
        let Tuning { rows, left_out } = tuning_table(&[sample; 2], &CircleTest::PAPER).unwrap();
        assert_eq!(left_out, []);
        assert_eq!(rows.len(), FEED_FORWARDS.len() * VELOCITY_GAINS_PERCENT.len());
        let at = |alpha: f64, gain: f64| {
            *rows.iter().find(|r| r.feed_forward == alpha && r.velocity_gain_percent == gain).unwrap()
        };
        let mean = |alpha, gain| at(alpha, gain).radial_error_mean_mm * 1000.0;
        // Friction and play take a few tenths of a µm more than the loop that was fitted.
        assert!((mean(0.95, 100.0) + 5.0).abs() < 0.5 && mean(0.98, 100.0).abs() < 0.5);
        for gain in VELOCITY_GAINS_PERCENT {
            // More feed-forward, larger circle; without any it is smaller by R ω²/(2 Kp²), 0.08 mm.
            assert!(FEED_FORWARDS.windows(2).all(|a| mean(a[0], gain) < mean(a[1], gain)), "{rows:?}");
        }
        for alpha in FEED_FORWARDS {
            let rounder = VELOCITY_GAINS_PERCENT.windows(2);
            for gains in rounder {
                assert!(
                    at(alpha, gains[1]).roundness_mm < at(alpha, gains[0]).roundness_mm,
                    "{alpha}: {rows:?}"
                );
            }
        }
    }

    #[test]
    fn settings_that_oscillate_are_left_out_with_the_reason() {
        let weak = ServoParameters { velocity_gain_limit_percent: 250.0, ..ServoParameters::new(50.7, 0.39) };
        let Tuning { rows, left_out } = tuning_table(&[weak; 2], &CircleTest::PAPER).unwrap();
        assert!(rows.iter().all(|row| row.velocity_gain_percent < 250.0));
        assert_eq!((rows.len(), left_out.len()), (10, 5));
        for setting in left_out {
            assert_eq!(setting.velocity_gain_percent, 300.0);
            assert!(setting.reason.to_string().contains("oscillates from velocity_gain_limit_percent = 250"));
        }
    }

    /// Less lag lowers the largest gain of a loop that is closed every ms: 4012 1/s at 4 ms, 3014 at 2 ms, 2644 at 4/3 ms.
    #[test]
    fn settings_of_an_unstable_loop_are_left_out_and_the_others_run() {
        let fast = ServoParameters { sub_steps: 1, ..ServoParameters::new(3500.0, 4.0) };
        let Tuning { rows, left_out } = tuning_table(&[fast; 2], &CircleTest::PAPER).unwrap();
        let unstable = left_out.iter().filter(|s| matches!(s.reason, ServoError::Unstable { .. })).count();
        assert_eq!((rows.len(), left_out.len(), unstable), (5, 10, 10), "{left_out:?}");
    }
}
