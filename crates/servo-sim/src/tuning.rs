//! The tuning table: what feed-forward and velocity gain make of a circle.

use serde::Serialize;

use crate::{CircleTest, ServoError, ServoParameters};

/// Feed-forward fractions of the table.
pub const FEED_FORWARDS: [f64; 5] = [0.0, 0.95, 0.98, 0.99, 1.0];
/// Velocity gains of the table, in per cent.
pub const VELOCITY_GAINS_PERCENT: [f64; 3] = [100.0, 200.0, 300.0];

/// A circle at one setting.
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

/// Runs `test` at every setting of [`FEED_FORWARDS`] and [`VELOCITY_GAINS_PERCENT`] whose velocity loop does not
/// oscillate, all other parameters as given.
///
/// # Errors
/// [`ServoError`] of the other parameters, or of the test.
pub fn tuning_table(
    parameters: &[ServoParameters; 2],
    test: &CircleTest,
) -> Result<Vec<TuningRow>, ServoError> {
    let mut rows = Vec::new();
    for velocity_gain_percent in VELOCITY_GAINS_PERCENT {
        for feed_forward in FEED_FORWARDS {
            let set = |p: ServoParameters| ServoParameters { feed_forward, velocity_gain_percent, ..p };
            match test.run::<f64>(&parameters.map(set)) {
                Ok(circle) => rows.push(TuningRow {
                    feed_forward,
                    velocity_gain_percent,
                    radial_error_mean_mm: circle.radial_error_mean_mm,
                    roundness_mm: circle.roundness_mm,
                }),
                Err(ServoError::VelocityLoopOscillates { .. }) => {}
                Err(error) => return Err(error),
            }
        }
    }
    Ok(rows)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The trends of the paper's table 2, on the sample machine.
    #[test]
    fn the_papers_trends() {
        let sample = ServoParameters::from_toml(include_str!("../../../data/servo.toml")).unwrap();
        let rows = tuning_table(&[sample; 2], &CircleTest::PAPER).unwrap();
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
    fn settings_that_oscillate_are_left_out() {
        let weak = ServoParameters { velocity_gain_limit_percent: 250.0, ..ServoParameters::new(50.7, 0.39) };
        let rows = tuning_table(&[weak; 2], &CircleTest::PAPER).unwrap();
        assert!(rows.iter().all(|row| row.velocity_gain_percent < 250.0));
        assert_eq!(rows.len(), 10);
    }
}
