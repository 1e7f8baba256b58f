//! The moving average over setpoints: controls call it linear acceleration after interpolation, for each axis.
//!
//! It turns a velocity step into a ramp of the filter's length t. In exchange the path deviates: the radius of a circle
//! at angular frequency ω shrinks by the factor of [`moving_average_gain`](crate::moving_average_gain), about
//! `1 - (ωt)²/24`.

use real::{Backend, Real};

use crate::ServoError;
use crate::control_law::in_format;
use crate::error::within;

/// Mean of the setpoints of the last `w = t/T` periods. A part of a period counts in proportion.
///
/// `y_k = r_k + (Σ_{j=1}^{n-1} (r_{k-j} - r_k) + (w - n)(r_{k-n} - r_k)) / w`, with n = ⌊w⌋. Differences to the newest
/// setpoint are small, so fixed point rounds twice at most, and a tool at rest stays exactly where it is. The sum is
/// computed anew each period, in n additions, so no rounding accumulates.
///
/// Range: the sum, up to `n · (path of one axis in t)`, must fit the format.
#[derive(Clone, Debug)]
pub struct CommandFilter<R> {
    /// The setpoints r_{k-n} … r_k, as a ring.
    window: Vec<R>,
    /// Place of the oldest.
    oldest: usize,
    /// w, in periods.
    width: R,
    /// w - n.
    fraction: R,
}

impl<R: Backend> CommandFilter<R> {
    /// A filter of `width_periods` = t/T, at rest at `position`. A filter of one period or less does nothing.
    ///
    /// # Errors
    /// [`ServoError`] if the width is NaN, is not from 0 to 10 000, or does not fit the format.
    pub fn try_new(width_periods: f64, position: R) -> Result<Self, ServoError> {
        let width = within("command filter in periods", width_periods, 0.0, 10_000.0)?.max(1.0);
        let whole = (0..=10_000_usize).rev().find(|&n| n as f64 <= width).unwrap_or(1);
        let fraction = width - whole as f64;
        Ok(Self {
            window: vec![position; whole + 1],
            oldest: 0,
            width: in_format("command filter in periods", width)?,
            // A fraction too small for the format counts as 0.
            fraction: R::from_f64(fraction).unwrap_or_else(R::zero),
        })
    }
}

impl<R: Real> CommandFilter<R> {
    /// Takes the setpoint of this period and returns the filtered one.
    pub fn step(&mut self, setpoint: R) -> R {
        let newest = self.oldest;
        self.window[newest] = setpoint;
        self.oldest = if newest + 1 == self.window.len() { 0 } else { newest + 1 };
        let oldest = self.oldest;
        let off = |r: R| r - setpoint;
        let whole = self.window.iter().enumerate().filter(|(place, _)| *place != oldest);
        let sum = whole.fold(R::zero(), |sum, (_, &r)| sum + off(r));
        setpoint + off(self.window[oldest]).mul_add(self.fraction, sum) / self.width
    }

    /// Number of periods after which a change of the setpoint has passed the filter.
    #[must_use]
    pub fn periods(&self) -> usize {
        self.window.len()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;
    use real::{I8F24, I16F16};

    #[test]
    fn a_velocity_step_becomes_a_ramp_of_the_filters_length() {
        // Setpoints run off with 1 mm a period: with w = 24 the increments rise to 1 in 24 equal steps.
        let mut filter = CommandFilter::try_new(24.0, 0.0).unwrap();
        let mut before = 0.0;
        for k in 1..=40 {
            let now = filter.step(f64::from(k));
            let expected = f64::from(k.min(24)) / 24.0;
            assert!((now - before - expected).abs() < 1e-13, "k={k}: {}", now - before);
            before = now;
        }
        // In the ramp's steady state the filter lags by (w - 1)/2 periods.
        assert!((40.0 - before - 11.5).abs() < 1e-12, "{before}");
    }

    #[test]
    fn a_part_of_a_period_counts_in_proportion() {
        let mut filter = CommandFilter::try_new(2.5, 0.0).unwrap();
        let steps: Vec<f64> = (0..4).map(|_| filter.step(1.0)).collect();
        for (found, expected) in steps.iter().zip([0.4, 0.8, 1.0, 1.0]) {
            assert!((found - expected).abs() < 1e-15, "{steps:?}");
        }
    }

    #[test]
    fn a_filter_of_no_length_changes_nothing() {
        for width in [0.0, 0.5, 1.0] {
            let mut filter = CommandFilter::try_new(width, 3.0).unwrap();
            assert_eq!([filter.step(7.0), filter.step(-2.0)], [7.0, -2.0], "width {width}");
        }
    }

    #[test]
    fn a_width_that_is_no_number_or_does_not_fit_is_refused() {
        for width in [-1.0, f64::NAN, 2e4] {
            assert!(CommandFilter::try_new(width, 0.0).is_err(), "{width}");
        }
        assert!(CommandFilter::<I8F24>::try_new(200.0, I8F24::default()).is_err(), "200 does not fit I8F24");
    }

    proptest! {
        /// The promised rounding: in fixed point the output is within two units of the exact mean.
        #[test]
        fn fixed_point_rounds_twice(steps in prop::collection::vec(-200_i32..200, 1..100), width in 1.0..30.0_f64) {
            let width = (width * 16.0).floor() / 16.0;
            let unit = f64::from(2.0_f32.powi(-16));
            let mut coarse = CommandFilter::<I16F16>::try_new(width, I16F16::default()).unwrap();
            let mut exact = CommandFilter::<f64>::try_new(width, 0.0).unwrap();
            let mut position = 0.0;
            for step in steps {
                position += f64::from(step) / 1024.0;
                let found = coarse.step(I16F16::from_f64(position).unwrap()).to_f64();
                let expected = exact.step(position);
                prop_assert!((found - expected).abs() <= 2.0 * unit, "{found} {expected}");
            }
        }

        /// A tool at rest stays where it is, in every format, whatever came before.
        #[test]
        fn rest_is_exact(from in -100.0..100.0_f64, to in -100.0..100.0_f64, width in 1.0..30.0_f64) {
            let [from, to] = [from, to].map(|x| I16F16::from_f64(x).unwrap());
            let mut filter = CommandFilter::try_new(width, from).unwrap();
            prop_assert_eq!(filter.step(from), from);
            let last = (0..filter.periods()).map(|_| filter.step(to)).last();
            prop_assert_eq!(last, Some(to));
        }
    }
}
