//! A real-time step by plain Newton iteration: `|C(u + σL) - C(u)|² = L²` solved for the step per chord σ, with the curve's
//! points and derivatives from a cursor of `PowerCurve`.
//!
//! It is written with care, so that the comparison means something: in `f64`, without the heap, with one division a trial, and with
//! the residual and the number of evaluations at which the step on pieces stops. As there, the correction of the last trial
//! is made too, which leaves a quarter of the square of its residual or less.

use nurbs_core::{Differentiate, Evaluate, PowerCursor, PowerCurve};
use secant_interp::ChordTolerance;

/// What changes from period to period.
#[derive(Clone, Copy, Debug)]
pub(crate) struct NewtonState<'a, const D: usize> {
    cursor: PowerCursor<'a, D>,
    end: f64,
    u: f64,
    point: [f64; D],
    /// σ of the last step, its rise, and the fall that is expected for the next.
    newest: f64,
    rise: f64,
    fall: f64,
}

/// The result of a period.
#[derive(Clone, Copy, Debug)]
pub(crate) struct NewtonSetpoint<const D: usize> {
    #[allow(dead_code, reason = "whoever steps by Newton goes on from it; here only its cost counts")]
    pub(crate) u: f64,
    pub(crate) point: [f64; D],
    pub(crate) length: f64,
    pub(crate) evaluations: u32,
}

impl<const D: usize> NewtonSetpoint<D> {
    /// Of no period.
    pub(crate) const NONE: Self = Self { u: 0.0, point: [0.0; D], length: 0.0, evaluations: 0 };
}

impl<'a, const D: usize> NewtonState<'a, D> {
    /// At the start of the curve, with σ of the first trial.
    pub(crate) fn start(curve: &'a PowerCurve<D>, sigma: f64) -> Self {
        let (u, end) = curve.domain();
        let mut cursor = curve.cursor();
        let point = cursor.point(u);
        Self { cursor, end, u, point, newest: sigma, rise: 0.0, fall: 0.0 }
    }

    /// σ of a chord of this length in mm from the start of the curve. As on pieces, it is found before the run.
    pub(crate) fn first_sigma(curve: &'a PowerCurve<D>, length: f64) -> f64 {
        let speed = curve.derivatives(curve.domain().0).first.iter().map(|x| x * x).sum::<f64>().sqrt();
        let exact = ChordTolerance { residual: f64::EPSILON, ..ChordTolerance::for_fluctuation(None, 20) };
        let mut state = Self::start(curve, 1.0 / speed);
        state.step_by::<false>(length, &exact, &mut { NewtonSetpoint::NONE });
        state.newest
    }

    /// The next setpoint, at a chord of this length in mm; false at the end of the curve. The first trial is the last step
    /// in proportion to the chord, or with TREND the one that the last three steps tell, as on pieces.
    #[inline(always)] // As the step on pieces.
    pub(crate) fn step_by<const TREND: bool>(
        &mut self,
        length: f64,
        tolerance: &ChordTolerance<f64>,
        setpoint: &mut NewtonSetpoint<D>,
    ) -> bool {
        if self.u >= self.end {
            return false;
        }
        let mut sigma = if TREND { self.newest - self.fall } else { self.newest };
        let square = length * length;
        let mut evaluations = 0;
        loop {
            let at = self.cursor.derivatives(self.u + sigma * length);
            let (mut chord, mut slope) = (0.0, 0.0);
            for d in 0..D {
                let along = at.point[d] - self.point[d];
                chord += along * along;
                slope += along * at.first[d];
            }
            let residual = chord - square;
            sigma -= 0.5 * residual / (slope * length);
            evaluations += 1;
            if residual.abs() <= tolerance.residual * square || evaluations >= tolerance.max_evaluations {
                break;
            }
        }
        if TREND {
            let rise = sigma - self.newest;
            (self.fall, self.rise) = (self.rise - rise - rise, rise);
        }
        self.newest = sigma;
        self.u = (self.u + sigma * length).min(self.end);
        self.point = self.cursor.point(self.u);
        *setpoint = NewtonSetpoint { u: self.u, point: self.point, length, evaluations };
        true
    }
}
