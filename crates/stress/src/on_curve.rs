//! A run on one curve with its global parameter; each step is checked.

use feed_plan::{Schedule, Stage};
use kernel_oracle::{Violation, demand};
use nurbs_core::{Differentiate, Evaluate, NurbsBuf};
use real::{Backend, FormatName, Real};
use secant_interp::{Interpolator, Method, Outcome as Ending, Tolerance};

use crate::PlannedPath;
use crate::violation::Outcome;

/// A curve and its plan in `R`, ready to run.
pub struct OnCurve<'a, R, const D: usize> {
    planned: &'a PlannedPath<'a, D>,
    curve: NurbsBuf<R, D>,
    stages: Vec<Stage<R>>,
    tolerance: Tolerance<R>,
    landing_step: R,
}

/// The worst figures of a run.
#[derive(Clone, Copy, Debug, Default, PartialEq, serde::Serialize, serde::Deserialize)]
pub struct CurveFigures {
    /// Steps.
    pub periods: u64,
    /// Most evaluations of the curve in a step.
    pub evaluations: u64,
    /// Steps whose solver found the chord within its tolerance.
    pub converged: u64,
    /// Runs that did not reach the end of the curve in twice their time. Either the format's resolution is longer than
    /// a step, or the solver finds no chord, as over coincident points.
    pub too_slow: u64,
    /// Difference between a converged chord and the wanted one, over its bound.
    pub length_share: f64,
}

impl CurveFigures {
    /// The worse of two figures each, and the sums of the counts.
    #[must_use]
    pub fn with(self, other: &Self) -> Self {
        Self {
            periods: self.periods + other.periods,
            evaluations: self.evaluations.max(other.evaluations),
            converged: self.converged + other.converged,
            too_slow: self.too_slow + other.too_slow,
            length_share: self.length_share.max(other.length_share),
        }
    }
}

/// The fluctuation that the solver is to keep.
const FLUCTUATION: f64 = 1e-6;

impl<'a, R: Backend, const D: usize> OnCurve<'a, R, D> {
    /// Converts curve and plan to `R`.
    ///
    /// # Errors
    /// A text that says which number does not fit.
    pub fn new(planned: &'a PlannedPath<'a, D>) -> Result<Self, String> {
        let [curve] = planned.path.curves.as_slice() else {
            return Err("one global parameter runs one curve".to_string());
        };
        let curve = curve.convert::<R>().map_err(|error| error.to_string())?;
        let stages: Option<Vec<_>> = planned.chords.stages().iter().map(stage_in).collect();
        let number = |x: f64| R::from_f64(x).filter(|x| *x > R::zero());
        let (Some(stages), Some(landing_step)) = (stages, number(planned.path.limits.acceleration)) else {
            return Err(format!("a feed or a duration of the plan does not fit {}", R::name()));
        };
        let tolerance = Tolerance {
            parameter: R::from_f64(FLUCTUATION).unwrap_or_else(R::zero),
            fluctuation: R::from_f64(FLUCTUATION).unwrap_or_else(R::zero),
            max_iterations: planned.path.max_evaluations,
        };
        Ok(Self { planned, curve, stages, tolerance, landing_step })
    }

    /// Whether C' almost vanishes for a step of this length: `2 |C''| L ≥ |C'|²`. A run searches for a start value if
    /// `|C''| L ≥ |C'|²`, in numbers of its format; the factor of two covers their rounding.
    fn is_slow(&self, u: R, length: R) -> bool {
        let Some(curve) = self.planned.path.curves.first() else { return false };
        let at = curve.as_curve().derivatives(u.to_f64());
        2.0 * f64::norm(&at.second) * length.to_f64() >= f64::norm(&at.first).powi(2)
    }

    /// Runs to the end and checks every step. The parameter neither goes back nor passes the end. No step takes more
    /// than K + 4 evaluations; where C' almost vanishes, the first three may take K + 12. A chord whose solver has
    /// converged has the wanted length.
    ///
    /// A run may fall behind its plan where the solver finds no chord: in a coarse format whose resolution is longer
    /// than a step, or over coincident points. Such runs are counted, and are not violations.
    ///
    /// # Errors
    /// The first promise that is broken.
    pub fn run(&self, method: Method) -> Result<Outcome<CurveFigures>, Violation> {
        let name = R::name().to_string();
        let schedule = Schedule::new(&self.stages, R::one(), self.planned.periods());
        let interpolator = Interpolator {
            curve: self.curve.as_curve(),
            schedule,
            method,
            tolerance: self.tolerance,
            landing_step: self.landing_step,
        };
        let (begin, end) = self.curve.as_curve().domain();
        let most = u64::from(self.tolerance.max_iterations) + 4;
        let mut worst = CurveFigures::default();
        let mut state = interpolator.start::<D>();
        let mut at = begin;
        let mut from = self.curve.as_curve().point(begin);
        for step in 0..self.planned.most_periods() {
            let Some(setpoint) = interpolator.step(&mut state) else {
                demand("the end is missed", &name, step, f64::from(u8::from(at < end)), 0.0)?;
                return Ok(Outcome::Ran(worst));
            };
            let u = setpoint.u;
            let inside = u >= at && u <= end && setpoint.point.iter().all(|x| x.is_finite());
            demand(
                "the parameter goes back or past the end",
                &name,
                step,
                f64::from(u8::from(!inside)),
                0.0,
            )?;
            let evaluations = u64::from(setpoint.evaluations);
            // Steps without a history take up to eight trials more where C' almost vanishes.
            let is_slow = step < 3 && self.is_slow(at, setpoint.length);
            let most = most + if is_slow { 8 } else { 0 };
            demand("evaluations", &name, step, evaluations as f64, most as f64)?;
            worst.periods += 1;
            worst.evaluations = worst.evaluations.max(evaluations);
            let is_over = schedule.is_over(state.cursor());
            if setpoint.outcome == Ending::Converged && method == Method::Secant && !is_over && u < end {
                worst.converged += 1;
                let share = self.check_length(step, &name, &from, &setpoint.point, setpoint.length)?;
                worst.length_share = worst.length_share.max(share);
            }
            (at, from) = (u, setpoint.point);
        }
        worst.too_slow += 1;
        let on_time = f64::from(u8::from(worst.converged == worst.periods));
        demand("every chord is found and the end is not reached", &name, 0, on_time, 0.0)?;
        Ok(Outcome::Ran(worst))
    }

    /// The commanded points are a chord apart: |F| ≤ Δ L, as the solver says. F is computed from these points with one
    /// rounding each for a difference, a norm and a subtraction.
    fn check_length(
        &self,
        step: usize,
        name: &str,
        from: &[R; D],
        to: &[R; D],
        length: R,
    ) -> Result<f64, Violation> {
        let chord = f64::norm(&core::array::from_fn::<_, D, _>(|d| to[d].to_f64() - from[d].to_f64()));
        // A last step that also takes the landing step may be longer by the landing step.
        let wanted = length.to_f64();
        let unit = match R::name() {
            FormatName::Fixed { .. } => R::resolution().to_f64(),
            _ => {
                R::resolution().to_f64() * (wanted + to.iter().map(|x| x.to_f64().abs()).fold(0.0, f64::max))
            }
        };
        let allowed = self.tolerance.fluctuation.to_f64() * wanted + 4.0 * unit;
        demand("commanded chord off the wanted one, mm", name, step, (chord - wanted).abs(), allowed)
    }
}

/// A stage in `R`. Feeds and durations must fit; numbers that are only shown in a table need not.
fn stage_in<R: Backend>(stage: &Stage<f64>) -> Option<Stage<R>> {
    let nearest = |x: f64| R::from_f64(x).unwrap_or_else(R::max_value);
    let fits = |x: &f64| R::from_f64(*x).is_some();
    [stage.start_feed, stage.end_feed, stage.duration].iter().all(fits).then(|| stage.map(nearest))
}
