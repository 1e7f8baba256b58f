//! The circle test: a full circle at constant feed, and the roundness of the path that results.
//!
//! As in the usual test (ISO 230-4), the path is measured by its distance from the commanded centre, over a turn that
//! begins and ends in motion. In the turns before it the effects of the start die away.
//!
//! - *radial error*: that distance minus the commanded radius, negative inside;
//! - *roundness*: largest minus smallest distance from the least-squares centre, which removes a shift of the whole
//!   circle. ISO 230-4 calls it circular deviation.
//!
//! Two equal axes without friction, play and limits make a perfect circle of a wrong radius. Out-of-roundness comes
//! from the four quadrant points, where an axis reverses.
//!
//! A table that rests at any point of the circle has no radial error. So the table must go round the commanded centre
//! once in the measured turn, however far off the circle.

use std::f64::consts::{PI, TAU};

use real::Backend;
use serde::Serialize;

use crate::error::positive;
use crate::{CommandFilter, Sample, Servo, ServoError, ServoParameters, continuous_gain, sampled_gain};

/// A circle test.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct CircleTest {
    /// Radius R, in mm.
    pub radius: f64,
    /// Feedrate F, in mm/s.
    pub feedrate: f64,
    /// Interpolation period T, in s.
    pub period: f64,
}

/// The result of a circle test.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Roundness {
    /// Mean radial error, in mm; negative inside.
    pub radial_error_mean_mm: f64,
    /// Smallest radial error, in mm.
    pub radial_error_min_mm: f64,
    /// Largest radial error, in mm.
    pub radial_error_max_mm: f64,
    /// Largest minus smallest distance from the least-squares centre, in mm.
    pub roundness_mm: f64,
    /// Radial error of the continuous linear loop in closed form, in mm: no friction, play, limit, filter or sampling.
    pub continuous_closed_form_mm: f64,
    /// Radial error of the linear loop in closed form where it is sampled, with command filter and interpolation, in mm.
    pub sampled_closed_form_mm: f64,
    /// The measured turn: angle in rad from the first axis, counter-clockwise, and radial error in mm.
    #[serde(skip)]
    pub profile: Vec<(f64, f64)>,
}

impl CircleTest {
    /// The paper's test: R10 at F4000 (mm/min), at a period of 1 ms.
    pub const PAPER: Self = Self { radius: 10.0, feedrate: 4000.0 / 60.0, period: 1e-3 };

    /// Angular frequency ω = F/R, in rad/s.
    #[must_use]
    pub fn angular_frequency(&self) -> f64 {
        self.feedrate / self.radius
    }

    /// Setpoints on a turn.
    #[must_use]
    pub fn setpoints_per_turn(&self) -> f64 {
        TAU / (self.angular_frequency() * self.period)
    }

    /// Runs the test on two axes whose loops run in `R`, with exact setpoints.
    ///
    /// # Errors
    /// [`ServoError`] of the parameters, or if the circle takes fewer than 8 periods, or [`ServoError::DoesNotTurn`].
    pub fn run<R: Backend>(&self, axes: &[ServoParameters; 2]) -> Result<Roundness, ServoError> {
        self.run_with::<R>(axes, |point| point)
    }

    /// Runs the test with setpoints changed by `setpoint`: rounded to a grid, for instance.
    ///
    /// # Errors
    /// Those of [`run`](Self::run).
    pub fn run_with<R: Backend>(
        &self,
        axes: &[ServoParameters; 2],
        mut setpoint: impl FnMut([f64; 2]) -> [f64; 2],
    ) -> Result<Roundness, ServoError> {
        self.validate()?;
        let start = setpoint([self.radius, 0.0]);
        let mut servo = Servo::<R, 2>::try_new(axes, self.period, start)?;
        let turn_periods = self.setpoints_per_turn();
        let mut ramp = CommandFilter::<f64>::try_new(axes[0].feed_ramp_ms / 1000.0 / self.period, 0.0)?;
        let ramp_periods = if axes[0].feed_ramp_ms > 0.0 { ramp.periods() } else { 0 };
        let settling = (servo.settling_periods() + ramp_periods) as f64;
        // Whole turns in which the loops settle, then one turn to measure.
        let warm_up = (settling / turn_periods).ceil().max(1.0) * turn_periods;
        let mut samples = Vec::new();
        let mut measured = Vec::new();
        let mut period = 0.0;
        while period < warm_up + turn_periods {
            period += 1.0;
            // At constant feed the angle is the distance along the path, so the ramp is over periods.
            let angle = self.angular_frequency() * self.period * ramp.step(period);
            let (sin, cos) = f64::sin_cos(angle);
            samples.clear();
            servo.step(setpoint([self.radius * cos, self.radius * sin]), &mut samples)?;
            if period > warm_up {
                measured.extend_from_slice(&samples);
            }
        }
        let sub_steps = f64::from(axes[0].sub_steps);
        let one_turn =
            measured.iter().zip(1_u32..).take_while(|(_, n)| f64::from(*n) <= turn_periods * sub_steps);
        let profile = self.profile(one_turn.map(|(sample, _)| sample));
        let turned = turned(&profile);
        // A winding number, except for the part of a sub-step by which the measured turn is not whole.
        if (turned - TAU).abs() >= PI {
            return Err(ServoError::DoesNotTurn { turned_degrees: turned.to_degrees() });
        }
        Ok(self.judge(profile, axes))
    }

    fn validate(&self) -> Result<(), ServoError> {
        /// With fewer setpoints on a turn, the path is a polygon.
        const FEWEST: f64 = 8.0;
        positive("radius", self.radius)?;
        positive("feedrate", self.feedrate)?;
        positive("interpolation period", self.period)?;
        let setpoints_per_turn = self.setpoints_per_turn();
        if setpoints_per_turn >= FEWEST {
            Ok(())
        } else {
            Err(ServoError::CircleTooFast { setpoints_per_turn, least: FEWEST })
        }
    }

    /// Angle and radial error of each sample.
    fn profile<'a>(&self, samples: impl Iterator<Item = &'a Sample<2>>) -> Vec<(f64, f64)> {
        samples
            .map(|sample| {
                let [x, y] = sample.table;
                (y.atan2(x).rem_euclid(TAU), x.hypot(y) - self.radius)
            })
            .collect()
    }

    fn judge(&self, profile: Vec<(f64, f64)>, axes: &[ServoParameters; 2]) -> Roundness {
        let count = profile.len() as f64;
        let mean_of =
            |of: &dyn Fn(f64, f64) -> f64| profile.iter().map(|&(a, e)| of(a, e)).sum::<f64>() / count;
        // The least-squares centre, to first order in error over radius: the terms left out are below e²/R.
        let mean = mean_of(&|_, error| error);
        let centre = [2.0 * mean_of(&|a, e| e * a.cos()), 2.0 * mean_of(&|a, e| e * a.sin())];
        let centred = |&(a, e): &(f64, f64)| e - centre[0] * a.cos() - centre[1] * a.sin();
        let extremes = |values: &mut dyn Iterator<Item = f64>| {
            values.fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), x| (low.min(x), high.max(x)))
        };
        let (min, max) = extremes(&mut profile.iter().map(|&(_, error)| error));
        let (low, high) = extremes(&mut profile.iter().map(centred));
        let frequency = self.angular_frequency();
        // Each axis is a half-axis of an ellipse; the mean radius is their mean, to first order in their difference.
        let mean_gain = |gain: &dyn Fn(&ServoParameters) -> f64| {
            self.radius * (axes.iter().map(gain).sum::<f64>() / 2.0 - 1.0)
        };
        Roundness {
            radial_error_mean_mm: mean,
            radial_error_min_mm: min,
            radial_error_max_mm: max,
            roundness_mm: high - low,
            continuous_closed_form_mm: mean_gain(&|p| continuous_gain(p, frequency)),
            sampled_closed_form_mm: mean_gain(&|p| sampled_gain(p, self.period, frequency)),
            profile,
        }
    }
}

/// The angle by which a profile goes round, in rad, counter-clockwise: each step turns the shorter way.
fn turned(profile: &[(f64, f64)]) -> f64 {
    profile.windows(2).map(|pair| (pair[1].0 - pair[0].0 + PI).rem_euclid(TAU) - PI).sum()
}

#[cfg(test)]
mod tests {
    use super::*;
    use real::{I8F24, I16F16};

    fn fitted(feed_forward: f64, velocity_gain_percent: f64) -> ServoParameters {
        ServoParameters { feed_forward, velocity_gain_percent, ..ServoParameters::new(50.7, 0.39) }
    }

    fn run(parameters: ServoParameters) -> Roundness {
        CircleTest::PAPER.run::<f64>(&[parameters; 2]).unwrap()
    }

    /// The paper: "about 5 µm inside" at 95 %, "near zero" at 98 %, both at a velocity gain of 100 %.
    #[test]
    fn the_papers_circle() {
        let at = |alpha| run(fitted(alpha, 100.0)).radial_error_mean_mm * 1000.0;
        let (at_95, at_98) = (at(0.95), at(0.98));
        assert!((at_95 + 4.97).abs() < 0.01, "95 %: {at_95} µm");
        assert!((at_98 + 0.045).abs() < 0.01, "98 %: {at_98} µm");
    }

    /// The gain of 30 1/s, from the paper's own example, cannot give these figures whatever the lag: with the lag
    /// that is right at 98 %, 95 % is nearly three times too far inside.
    #[test]
    fn the_gain_of_the_example_does_not_give_the_papers_circle() {
        let lag_ms = (1.0 - 0.98_f64.powi(2)) / (2.0 * 30.0) * 1000.0;
        let at = |feed_forward| {
            run(ServoParameters { feed_forward, ..ServoParameters::new(30.0, lag_ms) }).radial_error_mean_mm
                * 1e3
        };
        let (at_95, at_98) = (at(0.95), at(0.98));
        assert!(at_98.abs() < 0.3 && at_95 < -13.0, "{at_95} {at_98} µm");
    }

    #[test]
    fn the_steady_state_is_the_closed_form() {
        let beyond = |alpha, beta, filter| ServoParameters {
            acceleration_feed_forward: beta,
            command_filter_ms: filter,
            ..fitted(alpha, 100.0)
        };
        for (alpha, beta, filter) in [
            (0.0, 0.0, 0.0),
            (0.95, 0.0, 0.0),
            (0.98, 0.5, 0.0),
            (1.0, 1.0, 0.0),
            (0.95, 0.0, 24.0),
            (1.0, 0.0, 7.25),
        ] {
            let found = run(beyond(alpha, beta, filter));
            let off = (found.radial_error_mean_mm - found.sampled_closed_form_mm).abs();
            // Harmonics of the period, at most the sag of a chord: R (ωT)²/8 = 56 nm, and their mean, over
            // the part of a period that a turn is not whole by, is less by the 942 periods of a turn.
            assert!(off < 1e-8, "{alpha} {beta} {filter}: {found:?} off by {off} mm");
            // Without disturbances the circle is round, but for that sag.
            assert!(found.roundness_mm < 1.2e-4, "{alpha} {beta} {filter}: {} mm", found.roundness_mm);
        }
        // The continuous closed form differs by what interpolation between setpoints takes, R (ωT)²/12 = 37 nm, and by
        // the square of the sub-step, at most R (ωh)²/2 = 3.5 nm.
        let found = run(fitted(0.95, 100.0));
        let off = found.radial_error_mean_mm - found.continuous_closed_form_mm;
        assert!((off + 3.7e-5).abs() < 3.5e-6, "{off} mm");
    }

    /// A moving average of 24 ms takes `R(ωt)²/24` = 10.66 µm off the radius after interpolation, and nothing before it.
    /// The measured turn begins elsewhere between two setpoints: up to 1e-8 mm, as for the closed form.
    /// A fast small circle, ω = 100 rad/s, where the current lag counts.
    #[test]
    fn with_a_current_lag_the_steady_state_is_the_closed_form() {
        let test = CircleTest { radius: 1.0, feedrate: 100.0, period: 1e-3 };
        let at = |current_lag_ms, width| {
            let axis = ServoParameters {
                current_lag_ms,
                vibration_filter_hz: width,
                vibration_filter_bandwidth_hz: width,
                acceleration_limit_mm_per_s2: Some(1e6),
                ..fitted(0.95, 100.0)
            };
            test.run::<f64>(&[axis; 2]).unwrap()
        };
        for (current_lag_ms, width) in [(0.05, 0.0), (0.39, 0.0), (0.2, 150.0)] {
            let found = at(current_lag_ms, width);
            let off = (found.radial_error_mean_mm - found.sampled_closed_form_mm).abs();
            // The harmonics of the period, R (ωT)²/8 = 1.2 µm, over the part of a period that a turn is not whole by.
            assert!(off < 2e-5, "{current_lag_ms} {width}: {found:?} off by {off} mm");
        }
        let change = at(0.39, 0.0).sampled_closed_form_mm - at(0.0, 0.0).sampled_closed_form_mm;
        assert!(change.abs() > 1e-4, "{change} mm");
    }

    /// The simulated circle is that of the closed form, and its dependence on the sub-step is of second order.
    #[test]
    fn with_a_vibration_filter_the_steady_state_is_the_closed_form() {
        let at = |sub_steps| {
            run(ServoParameters {
                vibration_filter_hz: 200.0,
                vibration_filter_bandwidth_hz: 60.0,
                sub_steps,
                ..fitted(0.95, 100.0)
            })
        };
        let finest = at(100).radial_error_mean_mm;
        for sub_steps in [1_u32, 2, 4, 8] {
            let found = at(sub_steps);
            let off = (found.radial_error_mean_mm - found.sampled_closed_form_mm).abs();
            assert!(off < 1e-8, "{sub_steps}: {found:?} off by {off} mm");
            // A circle is slow against the filter, so the bound is that of the loop alone.
            let h = 1e-3 / f64::from(sub_steps);
            let bound = 10.0 * (CircleTest::PAPER.angular_frequency() * h).powi(2) / 2.0;
            let change = (found.radial_error_mean_mm - finest).abs();
            assert!(change <= bound, "{sub_steps}: {change} > {bound} mm");
        }
    }

    #[test]
    fn a_ramp_of_the_feed_leaves_the_radius_and_a_filter_of_each_axis_does_not() {
        let mean = |parameters| run(parameters).radial_error_mean_mm;
        let none = mean(fitted(0.95, 100.0));
        for ramp in [0.5, 7.25, 24.0] {
            let ramped = run(ServoParameters { feed_ramp_ms: ramp, ..fitted(0.95, 100.0) });
            let off = ramped.radial_error_mean_mm - none;
            assert!(off.abs() < 1e-8, "{ramp} ms: {off} mm");
            assert!((ramped.radial_error_mean_mm - ramped.sampled_closed_form_mm).abs() < 1e-8);
        }
        let filtered = mean(ServoParameters { command_filter_ms: 24.0, ..fitted(0.95, 100.0) }) - none;
        let expected = 10.0 * (CircleTest::PAPER.angular_frequency() * 0.024).powi(2) / 24.0;
        assert!((filtered + expected).abs() < 0.01 * expected, "{filtered} {expected} mm");
    }

    #[test]
    fn sub_steps_do_not_change_the_circle() {
        let at = |sub_steps| run(ServoParameters { sub_steps, ..fitted(0.98, 100.0) }).radial_error_mean_mm;
        let finest = at(100);
        for sub_steps in [1_u32, 2, 4, 8, 20] {
            let h = 1e-3 / f64::from(sub_steps);
            let bound = 10.0 * (CircleTest::PAPER.angular_frequency() * h).powi(2) / 2.0;
            let off = (at(sub_steps) - finest).abs();
            assert!(off <= bound, "{sub_steps}: {off} > {bound} mm");
        }
    }

    /// Friction and play as a machine has them. The trend of the paper's table: more velocity gain, and then the
    /// reversal's acceleration, make the circle rounder.
    #[test]
    fn more_velocity_gain_makes_the_circle_rounder() {
        let machine = |gain| ServoParameters {
            friction_mm_per_s2: 400.0,
            backlash_mm: 0.002,
            backlash_compensation_mm: 0.002,
            ..fitted(0.98, gain)
        };
        let [at_100, at_200, at_300] =
            [100.0, 200.0, 300.0].map(|gain| run(machine(gain)).roundness_mm * 1000.0);
        assert!(at_100 > 1.2 * at_200 && at_200 > 1.1 * at_300, "{at_100} {at_200} {at_300} µm");
        let pushed = ServoParameters {
            backlash_acceleration_mm_per_s2: 4000.0,
            backlash_acceleration_ms: 4.0,
            ..machine(300.0)
        };
        let with_acceleration = run(pushed).roundness_mm * 1000.0;
        assert!(with_acceleration < 0.9 * at_300, "{with_acceleration} against {at_300} µm");
    }

    /// The quadrant peak of friction alone: fτ/(g Kp) either side of the circle, so inversely to the gain.
    #[test]
    fn the_peak_of_friction_falls_as_one_over_the_velocity_gain() {
        let at = |gain: f64| {
            run(ServoParameters { friction_mm_per_s2: 2000.0, ..fitted(0.98, gain) }).roundness_mm
        };
        let (at_100, at_200, at_300) = (at(100.0), at(200.0), at(300.0));
        assert!((at_100 / at_200 - 2.0).abs() < 0.3, "{at_100} {at_200}");
        assert!((at_100 / at_300 - 3.0).abs() < 0.6, "{at_100} {at_300}");
    }

    #[test]
    fn setpoints_of_a_coarse_grid_raise_the_error_and_those_of_a_fine_one_do_not() {
        let on_grid = |bits: i32| {
            let step = 2.0_f64.powi(-bits);
            CircleTest::PAPER
                .run_with::<f64>(&[fitted(0.98, 100.0); 2], |point| point.map(|x| (x / step).round() * step))
                .unwrap()
                .roundness_mm
        };
        let exact = run(fitted(0.98, 100.0)).roundness_mm;
        let (coarse, fine) = (on_grid(8), on_grid(24));
        assert!(coarse > 1e-3 && coarse > 10.0 * exact, "{coarse} against {exact} mm");
        assert!((fine - exact).abs() < 2e-7, "{fine} against {exact} mm");
    }

    #[test]
    fn a_drive_in_a_coarse_format_makes_a_worse_circle() {
        let parameters = [fitted(0.98, 100.0); 2];
        let exact = run(parameters[0]).roundness_mm;
        let coarse = CircleTest::PAPER.run::<I16F16>(&parameters).unwrap().roundness_mm;
        let fine = CircleTest::PAPER.run::<I8F24>(&parameters).unwrap().roundness_mm;
        assert!(coarse > 10.0 * exact, "{coarse} against {exact} mm");
        assert!((fine - exact).abs() < 2e-5, "{fine} against {exact} mm");
    }

    #[test]
    fn unequal_axes_make_an_ellipse() {
        // Half-axes that differ by e: the radius varies by e from largest to smallest; phases that differ tilt and
        // stretch it further.
        let axes = [fitted(0.95, 100.0), fitted(0.98, 100.0)];
        let found = CircleTest::PAPER.run::<f64>(&axes).unwrap();
        assert!(found.roundness_mm > 0.004, "{}", found.roundness_mm);
    }

    #[test]
    fn a_circle_of_few_setpoints_is_refused() {
        let fast = CircleTest { radius: 0.1, feedrate: 100.0, period: 1e-3 };
        let message = fast.run::<f64>(&[fitted(0.98, 100.0); 2]).unwrap_err().to_string();
        assert!(message.contains("passed in 6.3 interpolation periods"), "{message}");
    }

    /// A table that rests on the circle has no radial error, and is no perfect circle.
    #[test]
    fn a_table_that_rests_makes_no_circle() {
        let small = |radius, feed| CircleTest { radius, feedrate: feed / 60.0, period: 1e-3 };
        let sample = ServoParameters::from_toml(include_str!("../../../data/servo.toml")).unwrap();
        let stuck = ServoParameters { friction_mm_per_s2: 1e9, ..fitted(0.98, 100.0) };
        let slow = ServoParameters { sub_steps: 200, ..ServoParameters::new(0.01, 1.0) };
        for (test, machine) in [
            (CircleTest::PAPER, stuck),
            (CircleTest::PAPER, slow),
            (small(0.001, 10.0), sample),
            (small(0.0005, 0.5), sample),
        ] {
            let refused = test.run::<f64>(&[machine; 2]).unwrap_err();
            assert!(matches!(refused, ServoError::DoesNotTurn { .. }), "{machine:?}: {refused}");
            assert!(
                refused.to_string().starts_with("the table does not follow the circle: it goes"),
                "{refused}"
            );
        }
    }

    /// Far off the circle, but round it: play of a tenth of the radius takes 0.4 mm off it in the mean.
    #[test]
    fn a_bad_circle_is_measured() {
        let play = ServoParameters { backlash_mm: 1.0, ..ServoParameters::new(30.0, 1.0) };
        let found = run(play);
        assert!((found.radial_error_mean_mm + 0.394).abs() < 0.001, "{}", found.radial_error_mean_mm);
        assert!((found.roundness_mm - 0.751).abs() < 0.001, "{}", found.roundness_mm);
        let oscillating = run(ServoParameters::new(30.0, 1e4));
        assert!((oscillating.radial_error_mean_mm + 9.278).abs() < 0.001);
    }
}
