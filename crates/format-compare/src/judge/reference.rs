//! The judge: the path in double-double arithmetic, against which every run is measured.

use std::cmp::Ordering;

use nurbs_core::{
    CurveError, Differentiate, Evaluate, NurbsBuf, arc_length, distance_to_segment, farthest_from_segment,
    tangent_breaks,
};
use real::{DoubleDouble, Real};

use crate::judge::exact_curve::ExactCurve;
use crate::judge::metrics::{JudgedStep, greater};
use crate::plan::in_format::of_pair;
use crate::problem::problem::Problem;
use crate::run::run::RunStep;

/// A curve and its parameter, as a sum of two floats.
type OnPath = (usize, (f64, f64));

/// A place that a run has reached.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Reached<const D: usize> {
    at: OnPath,
    /// The exact point there.
    point: [DoubleDouble; D],
    /// The point that the run commands there.
    commanded: [DoubleDouble; D],
}

/// The path in about 106 bits.
pub struct Reference<'a, const D: usize> {
    exact: Vec<ExactCurve<'a, D>>,
    plain: &'a [NurbsBuf<f64, D>],
    /// Curve and parameter of each corner that a run may pass.
    corners: Vec<(usize, f64)>,
    /// Curves that begin at rest.
    stops: &'a [usize],
    length_mm: f64,
}

impl<'a, const D: usize> Reference<'a, D> {
    /// The reference of a problem. The curves' numbers are taken without rounding: every f64 is a double-double.
    ///
    /// # Errors
    /// [`CurveError`] if a curve is not valid.
    pub fn new(problem: &'a Problem<D>) -> Result<Self, CurveError> {
        let exact = problem.curves.iter().map(ExactCurve::of).collect::<Result<_, _>>()?;
        let length = |curve: &NurbsBuf<f64, D>| {
            let curve = curve.as_curve();
            let (begin, end) = curve.domain();
            arc_length(&curve, begin, end, 1e-9).length
        };
        let length_mm = problem.curves.iter().map(length).sum();
        Ok(Self {
            exact,
            plain: &problem.curves,
            corners: corners(problem),
            stops: &problem.stops,
            length_mm,
        })
    }

    /// Arc length of the path, in mm.
    #[must_use]
    pub fn length_mm(&self) -> f64 {
        self.length_mm
    }

    fn point(&self, (curve, u): OnPath) -> [DoubleDouble; D] {
        self.exact[curve].point(u)
    }

    fn begin(&self, curve: usize) -> OnPath {
        (curve, (self.plain[curve].as_curve().domain().0, 0.0))
    }

    fn end(&self, curve: usize) -> OnPath {
        (curve, (self.plain[curve].as_curve().domain().1, 0.0))
    }

    /// The begin of the next curve, if `at` is the end of one.
    fn begin_of_next(&self, at: OnPath) -> Option<OnPath> {
        let is_at_end = at.0 + 1 < self.plain.len() && at.1 >= self.end(at.0).1;
        is_at_end.then(|| self.begin(at.0 + 1))
    }

    /// The corners between two places of the path, each a curve and its parameter: joints at which the tangent breaks
    /// and which a run may pass. A corner at which a chord begins or ends is not between.
    fn corners_between(&self, from: OnPath, to: OnPath) -> &[(usize, f64)] {
        let order = |one: &(usize, f64), other: OnPath| {
            one.0.cmp(&other.0).then((one.1, 0.0).partial_cmp(&other.1).unwrap_or(Ordering::Equal))
        };
        if self.corners.is_empty() {
            return &[];
        }
        let from = self.begin_of_next(from).unwrap_or(from);
        let begin = self.corners.partition_point(|corner| order(corner, from).is_le());
        let end = self.corners.partition_point(|corner| order(corner, to).is_lt());
        self.corners.get(begin..end).unwrap_or_default()
    }

    /// Measures each step of a run.
    #[must_use]
    pub fn judge(&self, steps: &[RunStep]) -> Vec<JudgedStep> {
        let mut from = self.start();
        steps.iter().map(|step| self.judge_next(&mut from, step)).collect()
    }

    /// The start of the path.
    pub(crate) fn start(&self) -> Reached<D> {
        self.standing(self.begin(0))
    }

    /// Measures the step from a place, and moves the place to its end.
    pub(crate) fn judge_next(&self, from: &mut Reached<D>, step: &RunStep) -> JudgedStep {
        if let Some(begin) = self.next_section(from.at, step) {
            *from = self.standing(begin);
        }
        let to = self.reached_by(step);
        let judged = self.judge_step(from, step, &to);
        *from = to;
        judged
    }

    /// The point at which a step begins, behind the place before it.
    pub(crate) fn start_of(&self, from: &Reached<D>, step: &RunStep) -> [f64; 3] {
        let standing = self.next_section(from.at, step).map(|begin| self.standing(begin));
        let mut point = [0.0; 3];
        point.iter_mut().zip(standing.unwrap_or(*from).commanded).for_each(|(x, own)| *x = own.value());
        point
    }

    /// The end of a step.
    pub(crate) fn reached_by(&self, step: &RunStep) -> Reached<D> {
        let at = (step.curve, step.u);
        Reached { at, point: self.point(at), commanded: commanded_point(step) }
    }

    /// The machine at rest at a place of the path.
    fn standing(&self, at: OnPath) -> Reached<D> {
        let point = self.point(at);
        Reached { at, point, commanded: point.map(|x| DoubleDouble::from(x.value())) }
    }

    /// The begin of the section in which a step lies, if the place before the step is the end of another section.
    fn next_section(&self, from: OnPath, step: &RunStep) -> Option<OnPath> {
        let begins = step.curve > from.0 && self.stops.binary_search(&(from.0 + 1)).is_ok();
        self.begin_of_next(from).filter(|_| begins)
    }

    /// Judges a step between two exact points, and between the points that the run commands there.
    fn judge_step(&self, from: &Reached<D>, step: &RunStep, to: &Reached<D>) -> JudgedStep {
        let within =
            if from.at.0 == to.at.0 { self.exact[to.at.0].straight_chord(from.at.1, to.at.1) } else { None };
        let (chord, commanded, chord_error_mm, passes_corner) = match within {
            Some(chord) => (chord, distance(&from.commanded, &to.commanded), 0.0, false),
            None => {
                let corners = self.corners_between(from.at, to.at).iter();
                let corners: Vec<_> = corners.map(|(curve, u)| self.point((*curve, (*u, 0.0)))).collect();
                let error = self.chord_error_mm(from.at, step, &from.point, &to.point);
                let [chord, commanded] = [[&from.point, &to.point], [&from.commanded, &to.commanded]]
                    .map(|[from, to]| legs(from, &corners, to));
                (chord, commanded, error, !corners.is_empty())
            }
        };
        let wanted = of_pair(step.wanted_mm);
        let off: [f64; D] = std::array::from_fn(|d| (to.commanded[d] - to.point[d]).value());
        JudgedStep {
            wanted_mm: wanted.value(),
            chord_mm: chord.value(),
            shortfall_mm: (wanted - chord).value(),
            commanded_shortfall_mm: wanted.value() - commanded.value(),
            chord_error_mm,
            passes_corner,
            position_error_mm: f64::norm(&off),
        }
    }

    /// The largest distance between the path and the chord of two setpoints, over joints too. A curve is sampled at
    /// eight points in f64: where the distance matters it is at least half a micrometre, and it is smooth in between.
    /// That of a straight move is at an end.
    fn chord_error_mm(
        &self,
        (curve, from): OnPath,
        step: &RunStep,
        from_point: &[DoubleDouble; D],
        to_point: &[DoubleDouble; D],
    ) -> f64 {
        const SAMPLES: i32 = 8;
        let chord = [from_point, to_point].map(|end| end.map(DoubleDouble::value));
        let on_curve = |index: usize| {
            let begin = if index == curve { from } else { self.begin(index).1 };
            let end = if index == step.curve { step.u } else { self.end(index).1 };
            let Some(plain) = self.exact[index].bent() else {
                let end = self.point((index, end)).map(DoubleDouble::value);
                return distance_to_segment(&end, &chord);
            };
            let width = (end.0 - begin.0) + (end.1 - begin.1);
            let at = move |sample: i32| begin.0 + width * f64::from(sample) / f64::from(SAMPLES);
            farthest_from_segment((1..=SAMPLES).map(|sample| plain.point(at(sample))), &chord)
        };
        (curve..=step.curve).map(on_curve).fold(0.0, greater)
    }

    /// Distance of the commanded point at a place from the end of the path, in mm.
    pub(crate) fn end_error_mm(&self, at: &Reached<D>) -> f64 {
        distance(&self.point(self.end(self.plain.len() - 1)), &at.commanded).value()
    }
}

/// The point that a step commands.
fn commanded_point<const D: usize>(step: &RunStep) -> [DoubleDouble; D] {
    std::array::from_fn(|d| DoubleDouble::from(step.point_mm[d]))
}

fn distance<const D: usize>(from: &[DoubleDouble; D], to: &[DoubleDouble; D]) -> DoubleDouble {
    DoubleDouble::norm(&std::array::from_fn::<_, D, _>(|d| to[d] - from[d]))
}

/// The sum of the lengths of the chords from corner to corner.
fn legs<const D: usize>(
    from: &[DoubleDouble; D],
    corners: &[[DoubleDouble; D]],
    to: &[DoubleDouble; D],
) -> DoubleDouble {
    let ends = corners.iter().chain([to]);
    ends.fold((DoubleDouble::from(0.0), from), |(sum, from), to| (sum + distance(from, to), to)).0
}

/// The corners that a run may pass: where curves meet and at knots of multiplicity p, wherever the tangent breaks,
/// except those at which the program rests.
fn corners<const D: usize>(problem: &Problem<D>) -> Vec<(usize, f64)> {
    let mut corners = Vec::new();
    let mut arriving = None;
    for (index, curve) in problem.curves.iter().enumerate() {
        let curve = curve.as_curve();
        let (first, last) = curve.domain();
        let end = curve.span_count() - 1;
        let leaving = curve.derivatives_in(0, first).first;
        if !problem.rests_before(index) && arriving.is_some_and(|before| tangent_breaks(&before, &leaving)) {
            corners.push((index, first));
        }
        corners.extend((1..=end).filter_map(|span| {
            let u = curve.span_bounds(span).0;
            let [before, after] = [span - 1, span].map(|span| curve.derivatives_in(span, u).first);
            let is_corner =
                curve.knots().multiplicity(u) == curve.degree() && tangent_breaks(&before, &after);
            is_corner.then_some((index, u))
        }));
        arriving = Some(curve.derivatives_in(end, last).first);
    }
    corners
}
