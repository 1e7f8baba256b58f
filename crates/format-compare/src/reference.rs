//! The judge: the path in double-double arithmetic, against which every run is measured.

use nurbs_core::{CurveError, Evaluate, NurbsBuf, arc_length};
use real::{DoubleDouble, Real};

use crate::metrics::JudgedStep;
use crate::problem::Problem;
use crate::run::{Run, RunStep};

/// The path in about 106 bits.
pub struct Reference<const D: usize> {
    exact: Vec<NurbsBuf<DoubleDouble, D>>,
    plain: Vec<NurbsBuf<f64, D>>,
    length_mm: f64,
}

impl<const D: usize> Reference<D> {
    /// The reference of a problem. The curves' numbers are taken as they stand: every f64 is a double-double.
    ///
    /// # Errors
    /// [`CurveError`] if a curve is not valid.
    pub fn new(problem: &Problem<D>) -> Result<Self, CurveError> {
        let exact = problem.curves.iter().map(NurbsBuf::convert).collect::<Result<_, _>>()?;
        let length = |curve: &NurbsBuf<f64, D>| {
            let curve = curve.as_curve();
            let (begin, end) = curve.domain();
            arc_length(&curve, begin, end, 1e-9).length
        };
        let length_mm = problem.curves.iter().map(length).sum();
        Ok(Self { exact, plain: problem.curves.clone(), length_mm })
    }

    /// Arc length of the path, in mm.
    #[must_use]
    pub fn length_mm(&self) -> f64 {
        self.length_mm
    }

    fn point(&self, curve: usize, u: (f64, f64)) -> [DoubleDouble; D] {
        self.exact[curve].as_curve().point(DoubleDouble::new(u.0, u.1))
    }

    fn start(&self) -> (usize, (f64, f64)) {
        (0, (self.plain[0].as_curve().domain().0, 0.0))
    }

    /// Measures each step of a run.
    #[must_use]
    pub fn judge(&self, run: &Run) -> Vec<JudgedStep> {
        let mut from = self.start();
        let mut from_point = self.point(from.0, from.1);
        run.steps
            .iter()
            .map(|step| {
                let to_point = self.point(step.curve, step.u);
                let judged = self.judge_step(from, &from_point, step, &to_point);
                from = (step.curve, step.u);
                from_point = to_point;
                judged
            })
            .collect()
    }

    fn judge_step(
        &self,
        from: (usize, (f64, f64)),
        from_point: &[DoubleDouble; D],
        step: &RunStep,
        to_point: &[DoubleDouble; D],
    ) -> JudgedStep {
        let chord = DoubleDouble::norm(&core::array::from_fn::<_, D, _>(|d| to_point[d] - from_point[d]));
        let wanted = DoubleDouble::new(step.wanted_mm.0, step.wanted_mm.1);
        let off = core::array::from_fn::<_, D, _>(|d| DoubleDouble::from(step.point_mm[d]) - to_point[d]);
        JudgedStep {
            wanted_mm: wanted.value(),
            chord_mm: chord.value(),
            shortfall_mm: (wanted - chord).value(),
            chord_error_mm: self.chord_error_mm(from, step, from_point, to_point),
            position_error_mm: DoubleDouble::norm(&off).value(),
        }
    }

    /// The largest distance of the curve between two setpoints from their chord, sampled at seven points in f64: the
    /// distance is half a micrometre at least where it matters, and smooth in between.
    fn chord_error_mm(
        &self,
        (curve, from): (usize, (f64, f64)),
        step: &RunStep,
        from_point: &[DoubleDouble; D],
        to_point: &[DoubleDouble; D],
    ) -> f64 {
        const SAMPLES: i32 = 8;
        if curve != step.curve {
            return 0.0; // over a joint the curve has no single parameter; the planner stops or passes smoothly there
        }
        let start = from_point.map(DoubleDouble::value);
        let chord: [f64; D] = core::array::from_fn(|d| (to_point[d] - from_point[d]).value());
        let length = f64::norm(&chord);
        if length <= 0.0 {
            return 0.0;
        }
        let along = chord.map(|x| x / length);
        let width = (step.u.0 - from.0) + (step.u.1 - from.1);
        let distance = |sample: i32| {
            let u = from.0 + width * f64::from(sample) / f64::from(SAMPLES);
            let point = self.plain[curve].as_curve().point(u);
            let arm: [f64; D] = core::array::from_fn(|d| point[d] - start[d]);
            let projection = f64::sum_of_products((0..D).map(|d| (arm[d], along[d])));
            f64::norm(&core::array::from_fn::<_, D, _>(|d| arm[d] - projection * along[d]))
        };
        (1..SAMPLES).map(distance).fold(0.0, f64::max)
    }

    /// Distance of the last commanded point from the end of the path, in mm; from its start if there is none.
    #[must_use]
    pub fn end_error_mm(&self, run: &Run) -> f64 {
        let last = self.exact.len() - 1;
        let end = self.plain[last].as_curve().domain().1;
        let end_point = self.point(last, (end, 0.0));
        let commanded: [DoubleDouble; D] = match run.steps.last() {
            Some(step) => core::array::from_fn(|d| DoubleDouble::from(step.point_mm[d])),
            None => self.point(0, self.start().1),
        };
        DoubleDouble::norm(&core::array::from_fn::<_, D, _>(|d| commanded[d] - end_point[d])).value()
    }
}
