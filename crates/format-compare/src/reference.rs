//! The judge: the path in double-double arithmetic, against which every run is measured.

use nurbs_core::{
    CurveError, Differentiate, Evaluate, NurbsBuf, arc_length, distance_to_segment, tangent_breaks,
};
use real::{DoubleDouble, Real};

use crate::metrics::{JudgedStep, greater};
use crate::problem::Problem;
use crate::run::{Run, RunStep};

/// The path in about 106 bits.
pub struct Reference<const D: usize> {
    exact: Vec<NurbsBuf<DoubleDouble, D>>,
    plain: Vec<NurbsBuf<f64, D>>,
    /// Curve and parameter of each corner, where the tangent breaks: of the curve that begins there.
    corners: Vec<(usize, f64)>,
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
        Ok(Self { exact, plain: problem.curves.clone(), corners: corners(&problem.curves), length_mm })
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
        let mut commanded = from_point.map(DoubleDouble::value);
        run.steps
            .iter()
            .map(|step| {
                let to_point = self.point(step.curve, step.u);
                let judged = self.judge_step(from, (&from_point, &commanded), step, &to_point);
                commanded = core::array::from_fn(|d| step.point_mm[d]);
                from = (step.curve, step.u);
                from_point = to_point;
                judged
            })
            .collect()
    }

    fn judge_step(
        &self,
        from: (usize, (f64, f64)),
        (from_point, commanded): (&[DoubleDouble; D], &[f64; D]),
        step: &RunStep,
        to_point: &[DoubleDouble; D],
    ) -> JudgedStep {
        let corners = self.corners_between(from, (step.curve, step.u));
        let chord = legs(from_point, &corners, to_point);
        let wanted = DoubleDouble::new(step.wanted_mm.0, step.wanted_mm.1);
        let off = core::array::from_fn::<_, D, _>(|d| DoubleDouble::from(step.point_mm[d]) - to_point[d]);
        let reached = core::array::from_fn(|d| DoubleDouble::from(step.point_mm[d]));
        let commanded = legs(&commanded.map(DoubleDouble::from), &corners, &reached).value();
        JudgedStep {
            wanted_mm: wanted.value(),
            chord_mm: chord.value(),
            shortfall_mm: (wanted - chord).value(),
            commanded_shortfall_mm: wanted.value() - commanded,
            chord_error_mm: self.chord_error_mm(from, step, from_point, to_point),
            position_error_mm: DoubleDouble::norm(&off).value(),
        }
    }

    /// The corners that a step passes.
    fn corners_between(
        &self,
        (curve, u): (usize, (f64, f64)),
        to: (usize, (f64, f64)),
    ) -> Vec<[DoubleDouble; D]> {
        let passed = self.corners.partition_point(|corner| (corner.0, (corner.1, 0.0)) <= (curve, u));
        let rest = self.corners.get(passed..).unwrap_or_default().iter();
        let passed = rest.take_while(|corner| (corner.0, (corner.1, 0.0)) < to);
        passed.map(|(curve, u)| self.point(*curve, (*u, 0.0))).collect()
    }

    /// The largest distance of the path between two setpoints from their chord, over joints too, sampled on each curve at eight
    /// points in f64: the distance is half a micrometre at least where it matters, and smooth in between.
    fn chord_error_mm(
        &self,
        (curve, from): (usize, (f64, f64)),
        step: &RunStep,
        from_point: &[DoubleDouble; D],
        to_point: &[DoubleDouble; D],
    ) -> f64 {
        const SAMPLES: i32 = 8;
        let chord = [from_point, to_point].map(|end| end.map(DoubleDouble::value));
        let on_curve = |index: usize| {
            let plain = self.plain[index].as_curve();
            let (first, last) = plain.domain();
            let begin = if index == curve { from } else { (first, 0.0) };
            let end = if index == step.curve { step.u } else { (last, 0.0) };
            let width = (end.0 - begin.0) + (end.1 - begin.1);
            let at = move |sample: i32| begin.0 + width * f64::from(sample) / f64::from(SAMPLES);
            let distance = |sample| distance_to_segment(&plain.point(at(sample)), &chord);
            (1..=SAMPLES).map(distance).fold(0.0, greater)
        };
        (curve..=step.curve).map(on_curve).fold(0.0, greater)
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

/// The sum of the chords from corner to corner.
fn legs<const D: usize>(
    from: &[DoubleDouble; D],
    corners: &[[DoubleDouble; D]],
    to: &[DoubleDouble; D],
) -> DoubleDouble {
    let leg = |from: &[DoubleDouble; D], to: &[DoubleDouble; D]| {
        DoubleDouble::norm(&core::array::from_fn::<_, D, _>(|d| to[d] - from[d]))
    };
    let ends = corners.iter().chain([to]);
    ends.fold((DoubleDouble::from(0.0), from), |(sum, from), to| (sum + leg(from, to), to)).0
}

/// Where the tangent breaks, at joints of curves and at knots inside them.
fn corners<const D: usize>(curves: &[NurbsBuf<f64, D>]) -> Vec<(usize, f64)> {
    let (mut corners, mut end) = (Vec::new(), [0.0; D]);
    for (index, curve) in curves.iter().enumerate() {
        let curve = curve.as_curve();
        for span in 0..curve.span_count() {
            let (first, last) = curve.span_bounds(span);
            if tangent_breaks(&end, &curve.derivatives_in(span, first).first) {
                corners.push((index, first));
            }
            end = curve.derivatives_in(span, last).first;
        }
    }
    corners
}

#[cfg(test)]
mod tests {
    use std::fmt::Write;

    use part_program::{read_machine, read_part};

    use super::*;
    use crate::{Engine, Options, compare, select};

    /// Thousands of straight moves along a circle of 1 mm: each corner is within the limit, and a chord passes many of them.
    /// Chords over joints were not judged.
    #[test]
    fn a_chord_over_joints_is_judged() {
        let mut program = String::from("G0 X1 Y0\n");
        for i in 1..=6283 {
            let (y, x) = (f64::from(i) * 1e-3).sin_cos();
            writeln!(program, "G1 X{x:.9} Y{y:.9} F12000").unwrap();
        }
        let machine = read_machine("m", include_str!("../../../data/seed-000.toml")).unwrap();
        let problem = Problem::<2>::new(&read_part("p.nc", &program).unwrap(), &machine).unwrap();
        let formats = select::<2>(&["f64".to_string()]).unwrap();
        let row =
            compare(&problem, &formats, &[Engine::Pieces], &Options::default()).unwrap().formats.remove(0);
        let plan = crate::plan_for(&problem, formats[0].as_ref(), &Options::default()).unwrap();
        let run = formats[0].run(&problem, &plan, &Options::default()).unwrap();
        let longest = run.steps.iter().map(|step| step.wanted_mm.0).fold(0.0, f64::max);
        let (found, sagitta) = (row.chord_error_mm_max.unwrap(), longest * longest / 8.0);
        assert!((found / sagitta - 1.0).abs() < 0.05, "{found} mm, not {sagitta}");
        assert!(!row.verdict.is_good() || found <= 1.005 * machine.chord_error_mm, "{}", row.verdict);
    }
}
