//! The judge: the path in double-double arithmetic, against which every run is measured.

use std::cmp::Ordering;

use nurbs_core::{
    CurveError, Differentiate, Evaluate, NurbsBuf, arc_length, distance_to_segment, tangent_breaks,
};
use real::{DoubleDouble, Real};

use crate::judge::arc::Sampled;
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

/// A place at which the tangent breaks.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Corner {
    curve: usize,
    u: f64,
    /// By how much each component of the unit tangent changes.
    turn: [f64; 3],
}

/// The path in about 106 bits.
pub struct Reference<'a, const D: usize> {
    exact: Vec<ExactCurve<'a, D>>,
    plain: &'a [NurbsBuf<f64, D>],
    problem: &'a Problem<D>,
    /// The corners that a run may pass, in order.
    corners: Vec<Corner>,
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
            problem,
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

    /// The corners from one place of the path to another: joints at which the tangent breaks and which a run may pass. A corner at the
    /// last place is none of them. Returned as well is how many of them lie at the first place, one or none.
    fn corners_between(&self, from: OnPath, to: OnPath) -> (&[Corner], usize) {
        let order = |one: &Corner, other: OnPath| {
            let at = (one.u, 0.0).partial_cmp(&other.1).unwrap_or(Ordering::Equal);
            one.curve.cmp(&other.0).then(at)
        };
        if self.corners.is_empty() {
            return (&[], 0);
        }
        let from = self.begin_of_next(from).unwrap_or(from);
        let begin = self.corners.partition_point(|corner| order(corner, from).is_lt());
        let end = self.corners.partition_point(|corner| order(corner, to).is_lt());
        let met = self.corners.get(begin..end).unwrap_or_default();
        (met, met.iter().take_while(|corner| order(corner, from).is_eq()).count())
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
        let (met, at_begin) = self.corners_between(from.at, to.at);
        let (chord, commanded, [arc_mm, chord_error_mm], passes_corner) = match within {
            Some(chord) => {
                (chord, distance(&from.commanded, &to.commanded), [chord.value().abs(), 0.0], false)
            }
            None => {
                let passed = met.iter().skip(at_begin);
                let corners: Vec<_> =
                    passed.map(|corner| self.point((corner.curve, (corner.u, 0.0)))).collect();
                let measured = self.arc_and_chord_error_mm(from.at, step, &from.point, &to.point);
                let [chord, commanded] = [[&from.point, &to.point], [&from.commanded, &to.commanded]]
                    .map(|[from, to]| legs(from, &corners, to));
                (chord, commanded, measured, !corners.is_empty())
            }
        };
        let wanted = of_pair(step.wanted_mm);
        let off: [f64; D] = std::array::from_fn(|d| (to.commanded[d] - to.point[d]).value());
        JudgedStep {
            wanted_mm: wanted.value(),
            chord_mm: chord.value(),
            arc_mm,
            feed_mm: self.feed_mm(from.at, step.curve),
            shortfall_mm: (wanted - chord).value(),
            commanded_shortfall_mm: wanted.value() - commanded.value(),
            chord_error_mm,
            passes_corner,
            turn: met.iter().map(|corner| corner.turn).reduce(sharper),
            position_error_mm: f64::norm(&off),
        }
    }

    /// The longest step that the curves passed from a place to one on a later curve, or the same, command.
    fn feed_mm(&self, from: OnPath, last: usize) -> f64 {
        let first = if last > from.0 { self.begin_of_next(from).unwrap_or(from).0 } else { from.0 };
        let feeds = (first..=last).map(|curve| self.problem.feed_mm_per_s(curve));
        feeds.fold(0.0, f64::max) * self.problem.period_s()
    }

    /// The arc length of the path between two setpoints, and its largest distance from their chord, over joints too. A curve is sampled at
    /// eight points in f64: where the distance matters it is at least half a micrometre, and it is smooth in between.
    /// That of a straight move is at an end.
    fn arc_and_chord_error_mm(
        &self,
        (curve, from): OnPath,
        step: &RunStep,
        from_point: &[DoubleDouble; D],
        to_point: &[DoubleDouble; D],
    ) -> [f64; 2] {
        let chord = [from_point, to_point].map(|end| end.map(DoubleDouble::value));
        let on_curve = |index: usize| {
            let begin = if index == curve { from } else { self.begin(index).1 };
            let end = if index == step.curve { step.u } else { self.end(index).1 };
            let Some(plain) = self.exact[index].bent() else {
                let length = self.exact[index].straight_chord(begin, end).map_or(0.0, DoubleDouble::value);
                let end = self.point((index, end)).map(DoubleDouble::value);
                return [length.abs(), distance_to_segment(&end, &chord)];
            };
            let width = (end.0 - begin.0) + (end.1 - begin.1);
            let sampled = Sampled::of(plain, begin.0, width);
            [sampled.arc_mm(plain, begin.0, width), sampled.farthest_from(&chord)]
        };
        let add = |[arc, error]: [f64; 2], [own, off]: [f64; 2]| [arc + own, greater(error, off)];
        (curve..=step.curve).map(on_curve).fold([0.0; 2], add)
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
fn corners<const D: usize>(problem: &Problem<D>) -> Vec<Corner> {
    let mut corners = Vec::new();
    let mut arriving = None;
    for (index, curve) in problem.curves.iter().enumerate() {
        let curve = curve.as_curve();
        let (first, last) = curve.domain();
        let end = curve.span_count() - 1;
        let corner = |u: f64, before: [f64; D], after: [f64; D]| {
            tangent_breaks(&before, &after).then(|| Corner { curve: index, u, turn: turn(&before, &after) })
        };
        let leaving = curve.derivatives_in(0, first).first;
        let before = arriving.filter(|_| !problem.rests_before(index));
        corners.extend(before.and_then(|before| corner(first, before, leaving)));
        corners.extend((1..=end).filter_map(|span| {
            let u = curve.span_bounds(span).0;
            let [before, after] = [span - 1, span].map(|span| curve.derivatives_in(span, u).first);
            corner(u, before, after).filter(|_| curve.knots().multiplicity(u) == curve.degree())
        }));
        arriving = Some(curve.derivatives_in(end, last).first);
    }
    corners
}

/// The larger change of each component of two turns.
fn sharper(one: [f64; 3], other: [f64; 3]) -> [f64; 3] {
    std::array::from_fn(|axis| one[axis].max(other[axis]))
}

/// By how much each component of the unit tangent changes from one derivative to another.
fn turn<const D: usize>(before: &[f64; D], after: &[f64; D]) -> [f64; 3] {
    let [arriving, leaving] = [f64::norm(before), f64::norm(after)];
    let component = |axis: usize| Some((after.get(axis)? / leaving - before.get(axis)? / arriving).abs());
    std::array::from_fn(|axis| component(axis).unwrap_or(0.0))
}
