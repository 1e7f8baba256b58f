//! Several axes driven by setpoints, one point per period.

use nurbs_core::Differentiate;
use real::Backend;

use crate::axis::{Axis, AxisState};
use crate::command_filter::CommandFilter;
use crate::contour_error::distance;
use crate::error_size::ErrorTally;
use crate::{Arrival, ContourTracker, ErrorSize, ServoError, ServoParameters};

/// A machine of `D` axes, whose command filters and control laws run in the number format `R`.
///
/// `R` is the format of the drive. The interpolator's format only affects the setpoints.
#[derive(Clone, Debug)]
pub struct Servo<R, const D: usize> {
    units: Vec<Unit<R>>,
}

/// The parts of one axis.
#[derive(Clone, Debug)]
struct Unit<R> {
    axis: Axis<R>,
    filter: CommandFilter<R>,
    state: AxisState<R>,
}

/// The positions of the axes at the end of a sub-step, in mm.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Sample<const D: usize> {
    /// The command, after filter and interpolation.
    pub command: [f64; D],
    /// The table.
    pub table: [f64; D],
}

/// A simulated path.
#[derive(Clone, Debug, PartialEq)]
pub struct Trace<const D: usize> {
    /// Time between two samples, in s; the first is at the end of the first sub-step.
    pub sub_step: f64,
    /// The samples: those of the motion, then those of the machine settling.
    pub samples: Vec<Sample<D>>,
    /// The number of samples that belong to the motion: those of the periods in which setpoints were commanded.
    pub motion_samples: usize,
    /// The largest distance from the last setpoint that the loops may keep at rest, in mm, for all axes together.
    pub standstill_error: f64,
}

/// The figures of a simulated path whose samples are not kept.
#[derive(Clone, Debug, PartialEq)]
pub struct Followed<const D: usize> {
    /// See [`Trace::following_error`].
    pub following_error: [ErrorSize; D],
    /// See [`Trace::contour_error`].
    pub contour_error: ErrorSize,
    /// See [`Trace::arrival`].
    pub arrival: Arrival,
    /// See [`Trace::motion_samples`].
    pub motion_samples: usize,
}

impl<R: Backend, const D: usize> Servo<R, D> {
    /// A machine at rest at `start` (mm), with a set of parameters an axis and an interpolation period (s).
    ///
    /// # Errors
    /// [`ServoError`] if a value is out of its range, a loop is unstable, the axes differ in `sub_steps` or
    /// `feed_ramp_ms`, or a number does not fit `R`.
    pub fn try_new(
        parameters: &[ServoParameters; D],
        period: f64,
        start: [f64; D],
    ) -> Result<Self, ServoError> {
        let mut units = Vec::with_capacity(D);
        for (index, (parameters, start)) in parameters.iter().zip(start).enumerate() {
            let axis = Axis::try_new(parameters, period)?;
            let out_of_range =
                ServoError::PositionNotInFormat { axis: index, value: start, format: R::name() };
            let state = axis.at_rest(start).ok_or(out_of_range)?;
            let position = R::from_f64(start).ok_or(out_of_range)?;
            let filter = CommandFilter::try_new(parameters.command_filter_ms / 1000.0 / period, position)?;
            units.push(Unit { axis, filter, state });
        }
        let [first, others @ ..] = parameters.as_slice() else { return Err(ServoError::PathEmpty) };
        if let Some(other) = others.iter().find(|other| other.sub_steps != first.sub_steps) {
            return Err(ServoError::SubStepsDiffer { first: first.sub_steps, other: other.sub_steps });
        }
        if let Some(other) = others.iter().find(|other| other.feed_ramp_ms != first.feed_ramp_ms) {
            return Err(ServoError::FeedRampsDiffer { first: first.feed_ramp_ms, other: other.feed_ramp_ms });
        }
        Ok(Self { units })
    }

    /// Runs one period towards `setpoint` (mm) and appends its sub-steps to `samples`.
    ///
    /// # Errors
    /// [`ServoError::PositionNotInFormat`]; the machine then stands somewhere within the period.
    pub fn step(&mut self, setpoint: [f64; D], samples: &mut Vec<Sample<D>>) -> Result<(), ServoError> {
        let begin = samples.len();
        let sub_steps = self.units.first().map_or(0, |unit| unit.axis.sub_steps());
        samples.extend((0..sub_steps).map(|_| Sample { command: [0.0; D], table: [0.0; D] }));
        for (index, (unit, value)) in self.units.iter_mut().zip(setpoint).enumerate() {
            let out_of_range = ServoError::PositionNotInFormat { axis: index, value, format: R::name() };
            let filtered = unit.filter.step(R::from_f64(value).ok_or(out_of_range)?);
            let mut places = samples[begin..].iter_mut();
            unit.axis
                .run_period(&mut unit.state, filtered, |axis_sample| {
                    if let Some(sample) = places.next() {
                        sample.command[index] = axis_sample.command;
                        sample.table[index] = axis_sample.table;
                    }
                })
                .ok_or(out_of_range)?;
        }
        Ok(())
    }

    /// Runs all `setpoints` (mm), then holds the last one until filters and loops have settled, and keeps every sample.
    ///
    /// # Errors
    /// [`ServoError::PositionNotInFormat`].
    pub fn run(mut self, setpoints: impl IntoIterator<Item = [f64; D]>) -> Result<Trace<D>, ServoError> {
        let (mut samples, mut motion_samples) = (Vec::new(), 0);
        self.each_sample(setpoints, |sample, is_motion| {
            samples.push(*sample);
            motion_samples += usize::from(is_motion);
        })?;
        Ok(Trace {
            sub_step: self.sub_step(),
            samples,
            motion_samples,
            standstill_error: self.standstill_error(),
        })
    }

    /// Runs all `setpoints` (mm) of a path that consists of `curves` as [`run`](Self::run) does, and keeps no sample: a path
    /// of an hour has thirty million.
    ///
    /// # Errors
    /// [`ServoError::PositionNotInFormat`], [`ServoError::PathEmpty`].
    pub fn follow<C: Differentiate<f64, D>>(
        mut self,
        setpoints: impl IntoIterator<Item = [f64; D]>,
        curves: &[C],
    ) -> Result<Followed<D>, ServoError> {
        let mut tracker = ContourTracker::try_new(curves)?;
        let (mut following, mut contour, mut motion_samples) =
            ([ErrorTally::default(); D], ErrorTally::default(), 0);
        let mut arriving = Arriving::default();
        self.each_sample(setpoints, |sample, is_motion| {
            for (d, tally) in following.iter_mut().enumerate() {
                tally.add(sample.command[d] - sample.table[d], is_motion);
            }
            contour.add(tracker.follow(sample.table).distance, is_motion);
            arriving.add(sample);
            motion_samples += usize::from(is_motion);
        })?;
        Ok(Followed {
            following_error: following.map(|tally| tally.size()),
            contour_error: contour.size(),
            arrival: arriving.arrival(self.standstill_error()),
            motion_samples,
        })
    }

    /// Runs the setpoints and then settles. Each sample is passed on, with whether it is one of the motion.
    fn each_sample(
        &mut self,
        setpoints: impl IntoIterator<Item = [f64; D]>,
        mut take: impl FnMut(&Sample<D>, bool),
    ) -> Result<(), ServoError> {
        let (mut samples, mut last) = (Vec::new(), None);
        for setpoint in setpoints {
            self.step(setpoint, &mut samples)?;
            samples.drain(..).for_each(|sample| take(&sample, true));
            last = Some(setpoint);
        }
        let Some(setpoint) = last else { return Ok(()) };
        for _ in 0..self.settling_periods() {
            self.step(setpoint, &mut samples)?;
            samples.drain(..).for_each(|sample| take(&sample, false));
        }
        Ok(())
    }

    /// Time between two samples, in s.
    fn sub_step(&self) -> f64 {
        self.units.first().map_or(0.0, |unit| unit.axis.sub_step())
    }

    /// The largest distance from the last setpoint that the loops may keep at rest, in mm, for all axes together.
    fn standstill_error(&self) -> f64 {
        self.units.iter().map(|unit| unit.axis.standstill_error(&unit.state)).fold(0.0, f64::hypot)
    }

    /// Number of periods after which an old setpoint's effect has fallen to 2e-9 of itself, on the slowest axis; at
    /// most 1e6.
    #[must_use]
    #[allow(
        clippy::cast_possible_truncation,
        clippy::cast_sign_loss,
        reason = "at most 1e6; below 0 it is 0"
    )]
    pub fn settling_periods(&self) -> usize {
        let of =
            |unit: &Unit<R>| unit.filter.periods() + unit.axis.settling_periods().min(1e6).ceil() as usize;
        self.units.iter().map(of).max().unwrap_or(0)
    }
}

impl<const D: usize> Trace<D> {
    /// Following error of each axis, command minus table at the same instant: its largest magnitude, and its root
    /// mean square over the motion, in mm.
    #[must_use]
    pub fn following_error(&self) -> [ErrorSize; D] {
        core::array::from_fn(|d| {
            let errors = self.samples.iter().map(|s| s.command[d] - s.table[d]);
            ErrorSize::of_motion(errors, self.motion_samples)
        })
    }

    /// Contour error, the distance of the table from the path that consists of `curves`: the largest, and the root mean
    /// square over the motion, in mm. It is meaningless for a table that does not follow; see
    /// [`arrival`](Self::arrival).
    ///
    /// # Errors
    /// [`ServoError::PathEmpty`].
    pub fn contour_error<C: Differentiate<f64, D>>(&self, curves: &[C]) -> Result<ErrorSize, ServoError> {
        let mut tracker = ContourTracker::try_new(curves)?;
        let distances = self.samples.iter().map(|sample| tracker.follow(sample.table).distance);
        Ok(ErrorSize::of_motion(distances, self.motion_samples))
    }

    /// Where the run took the table; all values are zero for a run without setpoints.
    #[must_use]
    pub fn arrival(&self) -> Arrival {
        let mut arriving = Arriving::default();
        self.samples.iter().for_each(|sample| arriving.add(sample));
        arriving.arrival(self.standstill_error)
    }
}

/// Where a run has taken the table so far.
struct Arriving<const D: usize> {
    first: Option<[f64; D]>,
    arrival: Arrival,
}

impl<const D: usize> Default for Arriving<D> {
    fn default() -> Self {
        Self { first: None, arrival: Arrival::default() }
    }
}

impl<const D: usize> Arriving<D> {
    fn add(&mut self, sample: &Sample<D>) {
        let (first, arrival) = (self.first.get_or_insert(sample.table), &mut self.arrival);
        arrival.end_error_mm = distance(&sample.command, &sample.table);
        arrival.reach_mm = arrival.reach_mm.max(distance(&sample.command, first));
        arrival.table_reach_mm = arrival.table_reach_mm.max(distance(&sample.table, first));
    }

    /// All values are zero for a run without setpoints.
    fn arrival(&self, standstill_error_mm: f64) -> Arrival {
        self.first.map_or_else(Arrival::default, |_| Arrival { standstill_error_mm, ..self.arrival })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    const T: f64 = 1e-3;

    fn circle(radius: f64, feed: f64, periods: u32) -> impl Iterator<Item = [f64; 2]> {
        (1..=periods).map(move |k| {
            let angle = feed / radius * T * f64::from(k);
            [radius * angle.cos(), radius * angle.sin()]
        })
    }

    fn run(parameters: ServoParameters, periods: u32) -> Trace<2> {
        let servo = Servo::<f64, 2>::try_new(&[parameters; 2], T, [10.0, 0.0]).unwrap();
        servo.run(circle(10.0, 200.0 / 3.0, periods)).unwrap()
    }

    #[test]
    fn a_run_without_samples_has_the_figures_of_one_with_them() {
        let parameters =
            ServoParameters { backlash_mm: 0.01, command_filter_ms: 5.0, ..ServoParameters::new(30.0, 0.39) };
        let points = vec![[10.0, 0.0], [10.0, 10.0], [0.0, 10.0]];
        let knots = vec![0.0, 0.0, 0.0, 1.0, 1.0, 1.0];
        let arc = nurbs_core::NurbsBuf::try_new(2, points, vec![1.0, 0.5_f64.sqrt(), 1.0], knots).unwrap();
        let servo = || Servo::<f64, 2>::try_new(&[parameters; 2], T, [10.0, 0.0]).unwrap();
        let setpoints = || circle(10.0, 200.0 / 3.0, 200);
        let (trace, curves) = (servo().run(setpoints()).unwrap(), [arc.as_curve()]);
        let followed = Followed {
            following_error: trace.following_error(),
            contour_error: trace.contour_error(&curves).unwrap(),
            arrival: trace.arrival(),
            motion_samples: trace.motion_samples,
        };
        assert_eq!(servo().follow(setpoints(), &curves).unwrap(), followed);
    }

    #[test]
    fn a_machine_that_is_told_to_stay_stays() {
        let parameters = ServoParameters { command_filter_ms: 24.0, ..ServoParameters::new(50.7, 0.39) };
        let servo = Servo::<f64, 2>::try_new(&[parameters; 2], T, [10.0, -3.0]).unwrap();
        let trace = servo.run([[10.0, -3.0]; 5]).unwrap();
        assert!(trace.samples.iter().all(|s| s.table == [10.0, -3.0] && s.command == s.table));
    }

    #[test]
    fn the_machine_arrives_and_settles() {
        let trace = run(ServoParameters { command_filter_ms: 24.0, ..ServoParameters::new(30.0, 0.39) }, 300);
        let last = trace.samples.last().unwrap();
        for d in 0..2 {
            assert!((last.table[d] - last.command[d]).abs() < 1e-7, "{last:?}");
        }
    }

    /// A ramp at feed V for 0.2 s behind `τ x'' + x' + Kp x = Kp r`, with Kp = 30/s and τ = 1 ms, by Euler's method.
    /// The error rises to V/Kp with 1/30 s, so its mean square over the motion is V/Kp times the root of
    /// `1 - 2(1 - e^-6)/6 + (1 - e^-12)/12`, but for the lag; a standstill would be in it as long as one looks.
    #[test]
    fn the_root_mean_square_is_that_of_the_motion_however_long_the_machine_settles() {
        let (feed, gain, lag, periods) = (100.0, 30.0, 1e-3, 200_u32);
        let axis = ServoParameters::new(gain, lag * 1000.0);
        let ramp = (1..=periods).map(|k| [feed * T * f64::from(k)]);
        let trace = Servo::<f64, 1>::try_new(&[axis], T, [0.0]).unwrap().run(ramp).unwrap();
        let [found] = trace.following_error();

        let (mut position, mut velocity, mut sum, steps) = (0.0, 0.0, 0.0, 200_000_u32);
        let dt = 0.2 / f64::from(steps);
        for step in 0..steps {
            let error = feed * dt * f64::from(step) - position;
            sum += error * error;
            position += velocity * dt;
            velocity += (gain * error - velocity) / lag * dt;
        }
        let expected = f64::sqrt(sum / f64::from(steps));
        // Samples at the ends of eighths of a period weigh the rise by half of one more: 0.06 ms of 200 ms.
        assert!((found.rms / expected - 1.0).abs() < 1e-3, "{} {expected} mm", found.rms);
        let without_lag: f64 = 1.0 - 2.0 * (1.0 - (-6.0_f64).exp()) / 6.0 + (1.0 - (-12.0_f64).exp()) / 12.0;
        assert!((found.rms / (feed / gain * without_lag.sqrt()) - 1.0).abs() < 0.01, "{} mm", found.rms);
        assert_eq!(trace.motion_samples, 8 * 200);
    }

    /// `ln(2e-9) = -20` over the slow root of `τs² + s + Kp = 0`, in periods, not the next power of two, 1024.
    #[test]
    fn a_machine_settles_for_as_long_as_its_loop_takes() {
        let servo = Servo::<f64, 1>::try_new(&[ServoParameters::new(30.0, 1.0)], T, [0.0]).unwrap();
        let slow = (1.0 - (1.0_f64 - 4.0 * 30.0 * 1e-3).sqrt()) / (2.0 * 1e-3);
        let expected = (20.0 / slow / T).ceil();
        let found = servo.settling_periods() as f64;
        // The filter of no length holds two setpoints.
        assert!((found - expected - 2.0).abs() <= 1.0, "{found} {expected}");
    }

    #[test]
    fn axes_that_differ_in_sub_steps_are_refused() {
        let one = ServoParameters::new(50.7, 0.39);
        let other = ServoParameters { sub_steps: 5, ..one };
        let refused = Servo::<f64, 2>::try_new(&[one, other], T, [0.0; 2]).unwrap_err();
        assert_eq!(refused.to_string(), "sub_steps = 5: expected 8 as on the first axis");
    }

    #[test]
    fn axes_that_differ_in_the_ramp_of_the_feed_are_refused() {
        let one = ServoParameters::new(50.7, 0.39);
        let other = ServoParameters { feed_ramp_ms: 24.0, ..one };
        let refused = Servo::<f64, 2>::try_new(&[one, other], T, [0.0; 2]).unwrap_err();
        assert_eq!(refused.to_string(), "feed_ramp_ms = 24: expected 0 as on the first axis");
    }

    #[test]
    fn a_setpoint_that_is_no_number_is_refused() {
        let mut servo = Servo::<f64, 1>::try_new(&[ServoParameters::new(50.7, 0.39)], T, [0.0]).unwrap();
        assert!(servo.step([f64::NAN], &mut Vec::new()).is_err());
    }

    /// A setpoint that fits the format, but whose velocity does not: the motor's position is then NaN or infinite.
    #[test]
    fn a_motor_that_leaves_the_numbers_is_an_error() {
        let mut servo = Servo::<f64, 1>::try_new(&[ServoParameters::new(50.7, 0.39)], T, [0.0]).unwrap();
        let mut samples = Vec::new();
        let ended = [f64::MAX, -f64::MAX, f64::MAX].map(|setpoint| servo.step([setpoint], &mut samples));
        assert!(ended.iter().any(Result::is_err));
    }

    #[test]
    fn an_unstable_loop_is_refused() {
        let refused = Servo::<f64, 1>::try_new(&[ServoParameters::new(1e5, 0.39)], T, [0.0]).unwrap_err();
        assert!(matches!(refused, ServoError::Unstable { .. }), "{refused}");
    }

    proptest! {
        /// The step size does not change the path beyond second order. Where the drive is at its limit A, the moment at
        /// which it leaves it is known to h only: up to 32 A h²; over 500 settings on a grid the largest was 15.
        #[test]
        fn sub_steps_do_not_change_the_path(
            gain in 20.0..80.0_f64,
            lag_ms in 0.3..2.0_f64,
            alpha in 0.0..1.0_f64,
            limit in 2000.0..20_000.0_f64,
        ) {
            let at = |sub_steps| ServoParameters {
                sub_steps,
                feed_forward: alpha,
                acceleration_limit_mm_per_s2: Some(limit),
                ..ServoParameters::new(gain, lag_ms)
            };
            let (coarse, fine) = (run(at(4), 400), run(at(64), 400));
            let h = T / 4.0;
            let bound = 32.0 * limit * h * h;
            let ends = coarse.samples.chunks(4).zip(fine.samples.chunks(64));
            for (period, (a, b)) in ends.enumerate() {
                let (a, b) = (a[3].table, b[63].table);
                let off = (a[0] - b[0]).hypot(a[1] - b[1]);
                prop_assert!(off <= bound, "period {period}: {off} > {bound}");
            }
        }
    }
}
