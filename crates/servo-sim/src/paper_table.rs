//! Table 2 of paper D: the four settings of its circle test, with what it prints and what the simulation gives.
//!
//! The paper prints no loop. Two loops are run: one of the fitted position gain, and one of the 30 1/s that the paper names
//! in its example of a following error. The lag of each is the one with which 98 % is right in closed form.

use serde::Serialize;

use crate::{CircleTest, ServoError, ServoParameters, continuous_gain};

/// One setting of the table.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct PaperSetting {
    /// The part of the table, as printed.
    pub part: &'static str,
    /// Velocity gain, in per cent.
    pub velocity_gain_percent: f64,
    /// Feed-forward α, a fraction.
    pub feed_forward: f64,
    /// Whether the control pushes at reversals.
    pub reversal_acceleration: bool,
    /// The printed radial error, in mm, negative inside; `None` where the paper prints none.
    pub printed_radial_error_mm: Option<f64>,
    /// What the paper says of the circle.
    pub printed: &'static str,
}

/// The settings of table 2. Linear acceleration before interpolation is 24 ms in all of them.
pub const PAPER_SETTINGS: [PaperSetting; 4] = [
    PaperSetting {
        part: "a",
        velocity_gain_percent: 100.0,
        feed_forward: 0.95,
        reversal_acceleration: false,
        printed_radial_error_mm: Some(-0.005),
        printed: "about 5 µm inside, deformed, peaks at quadrants",
    },
    PaperSetting {
        part: "b",
        velocity_gain_percent: 100.0,
        feed_forward: 0.98,
        reversal_acceleration: false,
        printed_radial_error_mm: Some(0.0),
        printed: "close to 0",
    },
    PaperSetting {
        part: "c",
        velocity_gain_percent: 200.0,
        feed_forward: 0.98,
        reversal_acceleration: false,
        printed_radial_error_mm: None,
        printed: "less deformed, smaller peaks",
    },
    PaperSetting {
        part: "d",
        velocity_gain_percent: 300.0,
        feed_forward: 0.99,
        reversal_acceleration: true,
        printed_radial_error_mm: None,
        printed: "smaller peaks, rounder",
    },
];

/// The position gain of the paper's example of a following error, in 1/s.
pub const PRINTED_POSITION_GAIN_PER_S: f64 = 30.0;
/// The linear acceleration before interpolation, in ms.
const FEED_RAMP_MS: f64 = 24.0;
/// The push at reversals in part d; typical, not printed.
const REVERSAL_ACCELERATION: (f64, f64) = (4000.0, 4.0);

/// A circle of the table on one loop.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct PaperCircle {
    /// Position gain Kp, in 1/s.
    pub position_gain_per_s: f64,
    /// Lag τ at a velocity gain of 100 %, in ms.
    pub velocity_lag_ms: f64,
    /// Mean radial error of the simulation, in mm; negative inside.
    pub radial_error_mean_mm: f64,
    /// Radial error of the continuous linear loop in closed form, in mm: without friction, play and sampling.
    pub closed_form_mm: f64,
    /// Roundness of the simulation, in mm.
    pub roundness_mm: f64,
}

/// One setting, printed and simulated.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct PaperRow {
    /// The setting, and what is printed of it.
    #[serde(flatten)]
    pub setting: PaperSetting,
    /// With the position gain and lag of the drive that is given.
    pub fitted: PaperCircle,
    /// With the printed position gain, and the lag with which 98 % is right.
    pub printed_gain: PaperCircle,
}

/// The lag in ms with which the feed-forward α gives the right radius at the gain Kp (1/s), to lowest order in the
/// circle's frequency: `(1 - α²)/(2 Kp)`.
#[must_use]
pub fn lag_of_right_radius_ms(position_gain: f64, feed_forward: f64) -> f64 {
    (1.0 - feed_forward * feed_forward) / (2.0 * position_gain) * 1000.0
}

/// Runs the circle of the paper, R10 at F4000, at its four settings. Friction, play and all that the settings do not
/// name are those of `drive`, and so are position gain and lag of the fitted loop.
///
/// # Errors
/// [`ServoError`] of the drive at one of the settings.
pub fn paper_table(drive: &ServoParameters) -> Result<Vec<PaperRow>, ServoError> {
    let printed_gain = ServoParameters {
        position_gain_per_s: PRINTED_POSITION_GAIN_PER_S,
        velocity_lag_ms: lag_of_right_radius_ms(PRINTED_POSITION_GAIN_PER_S, 0.98),
        ..*drive
    };
    let row = |setting: PaperSetting| {
        Ok(PaperRow {
            setting,
            fitted: circle(drive, &setting)?,
            printed_gain: circle(&printed_gain, &setting)?,
        })
    };
    PAPER_SETTINGS.into_iter().map(row).collect()
}

fn circle(drive: &ServoParameters, setting: &PaperSetting) -> Result<PaperCircle, ServoError> {
    let push = if setting.reversal_acceleration { REVERSAL_ACCELERATION } else { (0.0, 0.0) };
    let set = ServoParameters {
        feed_forward: setting.feed_forward,
        feed_ramp_ms: FEED_RAMP_MS,
        backlash_acceleration_mm_per_s2: push.0,
        backlash_acceleration_ms: push.1,
        ..drive.with_velocity_gain(setting.velocity_gain_percent)
    };
    let test = CircleTest::PAPER;
    let found = test.run::<f64>(&[set; 2])?;
    Ok(PaperCircle {
        position_gain_per_s: set.position_gain_per_s,
        velocity_lag_ms: set.velocity_lag_ms,
        radial_error_mean_mm: found.radial_error_mean_mm,
        closed_form_mm: test.radius * (continuous_gain(&set, test.angular_frequency()) - 1.0),
        roundness_mm: found.roundness_mm,
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    fn sample() -> ServoParameters {
        ServoParameters::from_toml(include_str!("../../../data/servo.toml")).unwrap()
    }

    /// `R (|X/R| - 1)` in µm with real arithmetic alone: `|X/R|² = (Kp² + α²ω²)/((Kp - τω²)² + ω²)`.
    fn by_hand(gain: f64, lag: f64, alpha: f64) -> f64 {
        let frequency: f64 = 4000.0 / 60.0 / 10.0;
        let above = gain * gain + (alpha * frequency).powi(2);
        let below = (gain - lag * frequency * frequency).powi(2) + frequency * frequency;
        10.0 * ((above / below).sqrt() - 1.0) * 1000.0
    }

    /// Each figure beside the printed one: -5, 0, none, none. A second implementation found -4.92, 0.00, -1.68, -0.57 for
    /// the fitted loop, and -13.7 and 0 for 30 1/s.
    #[test]
    fn the_figures_stand_beside_the_printed_ones() {
        let ideal = ServoParameters::new(50.7, 0.39);
        let rows = paper_table(&ideal).unwrap();
        let expected =
            [(Some(-5.0), -4.92, -13.66), (Some(0.0), 0.0, 0.0), (None, -1.68, -4.67), (None, -0.57, -1.58)];
        assert_eq!(rows.len(), expected.len());
        for (row, (printed, fitted, printed_gain)) in rows.iter().zip(expected) {
            let PaperSetting { feed_forward: alpha, velocity_gain_percent, printed_radial_error_mm, .. } =
                row.setting;
            assert_eq!(printed_radial_error_mm.map(|mm| mm * 1000.0), printed);
            for (circle, expected) in [(row.fitted, fitted), (row.printed_gain, printed_gain)] {
                let closed = circle.closed_form_mm * 1000.0;
                let lag = circle.velocity_lag_ms / 1000.0 / (velocity_gain_percent / 100.0);
                let hand = by_hand(circle.position_gain_per_s, lag, alpha);
                assert!((closed - hand).abs() < 1e-9, "{row:?}: {hand} µm");
                assert!((closed - expected).abs() < 0.02, "{row:?}: {expected} µm");
                // Interpolation between setpoints takes 37 nm, the sub-steps up to 3.5 nm; the push of part d, without
                // friction to overcome, is a disturbance.
                let off = circle.radial_error_mean_mm * 1000.0 - closed + 0.037;
                let most = if row.setting.reversal_acceleration { 1.0 } else { 0.004 };
                assert!(off.abs() < most, "{row:?}: {off} µm");
            }
        }
        let misses = |circle: PaperCircle| (circle.radial_error_mean_mm + 0.005).abs();
        assert!(misses(rows[0].fitted) < 0.0001 && misses(rows[0].printed_gain) > 0.008, "{rows:?}");
    }

    /// With friction, play and encoder the circle gets rounder from part to part, as the paper says.
    #[test]
    fn the_circle_of_a_machine_gets_rounder_from_b_to_d() {
        let rows = paper_table(&sample()).unwrap();
        let round: Vec<f64> = rows.iter().map(|row| row.fitted.roundness_mm).collect();
        assert!(round[1] > round[2] && round[2] > round[3], "{round:?}");
        assert!((rows[0].fitted.radial_error_mean_mm + 0.005).abs() < 0.0005, "{rows:?}");
        assert!(rows[1].fitted.radial_error_mean_mm.abs() < 0.0005, "{rows:?}");
    }
}
