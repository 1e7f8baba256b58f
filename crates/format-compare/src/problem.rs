//! What is to be run: a path and a machine's limits, in f64.

use feed_plan::{KinematicLimits, PlanError};
use nurbs_core::{CurveError, NurbsBuf};
use part_program::{Machine, Part};

/// A path of curves in mm and the machine that is to follow it.
#[derive(Clone, Debug)]
pub struct Problem<const D: usize> {
    /// Name of the part, for reports.
    pub name: String,
    /// The curves, in the order in which they are followed.
    pub curves: Vec<NurbsBuf<f64, D>>,
    /// The machine's limits, with the feedrate that the part commands, if it does.
    pub machine: Machine,
}

impl<const D: usize> Problem<D> {
    /// Takes the curves of `part` in `D` dimensions; coordinates beyond are dropped, so `D` must be at least the
    /// part's own dimension.
    ///
    /// # Errors
    /// [`CurveError`] of the first curve that is not valid.
    pub fn new(part: &Part, machine: &Machine) -> Result<Self, CurveError> {
        let curves = part.curves.iter().map(|curve| {
            let points = curve.control_points_mm.iter().map(|p| core::array::from_fn(|d| p[d])).collect();
            NurbsBuf::try_new(curve.degree, points, curve.weights.clone(), curve.knots.clone())
        });
        let mut machine = machine.clone();
        if let Some(feedrate) = part.feedrate_mm_per_s {
            machine.feedrate_mm_per_s = feedrate;
        }
        Ok(Self { name: part.name.clone(), curves: curves.collect::<Result<_, _>>()?, machine })
    }

    /// The interpolation period T, in s.
    #[must_use]
    pub fn period_s(&self) -> f64 {
        self.machine.interpolation_period_ms / 1000.0
    }

    /// The limits with the interpolation period as the unit of time: F·T, A·T², J·T³ in mm per period to the
    /// first, second and third power. These are the numbers that a controller works with: they are of the order
    /// of a step, while the same limits per second span nine orders of magnitude.
    ///
    /// # Errors
    /// [`PlanError`] when a limit is not positive.
    pub fn limits_per_period(&self) -> Result<KinematicLimits<f64>, PlanError> {
        let (machine, t) = (&self.machine, self.period_s());
        let limits = KinematicLimits {
            interpolation_period: 1.0,
            feedrate: machine.feedrate_mm_per_s * t,
            acceleration: machine.acceleration_mm_per_s2 * t.powi(2),
            jerk: machine.jerk_mm_per_s3 * t.powi(3),
            chord_error: machine.chord_error_mm,
            centripetal_acceleration: machine.centripetal_acceleration_mm_per_s2.map(|a| a * t.powi(2)),
        };
        limits.validate()?;
        Ok(limits)
    }
}
