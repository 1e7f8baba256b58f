//! The steps per chord of the last steps, and the value expected for the next.

use real::Real;

use crate::pieces::chord_step::within;
use crate::pieces::joint::JointScale;

/// σ of the last step, and its differences to those before, all in the scale of one piece. The differences are kept
/// instead of the σ themselves, because a step then has fewer numbers to compute and to move.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Trend<R> {
    /// σ_i.
    pub(crate) newest: R,
    /// σ_i - σ_{i-1}.
    pub(crate) rise: R,
    /// By how much the expected next σ, `3σ_i - 3σ_{i-1} + σ_{i-2}`, is less than σ_i.
    pub(crate) fall: R,
}

impl<R: Real> Trend<R> {
    /// The trend of a constant σ.
    #[inline]
    pub(crate) fn steady(sigma: R) -> Self {
        Self { newest: sigma, rise: R::zero(), fall: R::zero() }
    }

    /// The trend of the last three σ, newest first.
    #[inline]
    fn of([newest, middle, oldest]: [R; 3]) -> Self {
        Self { newest: middle, rise: middle - oldest, fall: R::zero() }.and(newest)
    }

    /// The last three σ, newest first: exact in fixed point, up to rounding in floats.
    #[inline]
    fn sigmas(&self) -> [R; 3] {
        let middle = self.newest - self.rise;
        [self.newest, middle, middle - (self.fall + self.rise + self.rise)]
    }

    /// The trend after another step, which had `sigma`.
    #[inline(always)]
    pub(crate) fn and(&self, sigma: R) -> Self {
        let rise = sigma - self.newest;
        Self { newest: sigma, rise, fall: (self.rise - rise - rise).signal("step_per_chord_fall") }
    }

    /// The expected next σ, limited to the range.
    #[inline]
    pub(crate) fn next(&self, range: &[R; 2]) -> R {
        self.newest - self.within(range).fall
    }

    /// The expected σ of the last part of the next step, over so much of its length, limited to the range. The part begins later
    /// than the step and ends with it: σ has gone on by half of that difference.
    #[inline]
    pub(crate) fn next_part(&self, left: R, range: &[R; 2]) -> R {
        let fall = self.within(range).fall;
        let expected = self.newest - fall;
        expected - within((fall * (R::one() - left)).half(), expected, range)
    }

    /// The trend with its expected σ limited to the range. It is needed after a step that was not a common one and did
    /// not pass to a piece of the same polynomial: a break of the trend there would lead the next guess far off.
    #[inline]
    pub(crate) fn within(&self, range: &[R; 2]) -> Self {
        Self { fall: within(self.fall, self.newest, range), ..*self }
    }

    /// The trend in the scale of the next piece, each σ limited to its range.
    #[inline(always)] // Called, it would take the scale through memory.
    pub(crate) fn into_next(self, scale: JointScale<R>, range: &[R; 2]) -> Self {
        let [newest, middle, oldest] = self.sigmas();
        Self::of([scale.convert(newest, range), scale.convert(middle, range), scale.convert(oldest, range)])
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use real::{Backend, I4F28};

    fn goes_on_as_a_parabola<R: Backend>() {
        let number = |x: f64| R::from_f64(x).unwrap();
        let parabola = |i: f64| number(1.0 + 0.125 * i - 0.015_625 * i * i);
        let mut trend = Trend::of([parabola(2.0), parabola(1.0), parabola(0.0)]);
        let range = [number(0.5), number(2.0)];
        for i in 3..8 {
            assert_eq!(trend.next(&range), parabola(f64::from(i)), "{} {i}", R::name());
            trend = trend.and(parabola(f64::from(i)));
            let last = [i, i - 1, i - 2].map(|i| parabola(f64::from(i)));
            assert_eq!(trend.sigmas(), last, "{} {i}", R::name());
        }
        assert_eq!(trend.next(&[number(0.5), number(1.0)]), number(1.0));
        assert_eq!(Trend::steady(number(1.5)).next(&range), number(1.5));
        assert_eq!(Trend::steady(number(3.0)).next(&range), number(2.0));
    }

    #[test]
    fn three_steps_tell_the_next_one() {
        goes_on_as_a_parabola::<f64>();
        goes_on_as_a_parabola::<f32>();
        goes_on_as_a_parabola::<I4F28>();
    }
}
