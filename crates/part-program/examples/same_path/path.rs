//! The feed path of a part: polylines from where feed begins to where it ends.

use nurbs_core::{Differentiate, Evaluate};
use part_program::{Curve, MoveKind, Part, Shape};

use crate::point::{Point, distance};

/// How far chords may leave a curve, in mm.
const CHORD_ERROR_MM: f64 = 1e-4;
/// Halvings of a span of a curve at most.
const MAX_HALVINGS: u32 = 14;

/// A move at feed.
pub(crate) struct Cut {
    pub(crate) points: Vec<Point>,
    pub(crate) feedrate_mm_per_s: Option<f64>,
    pub(crate) line: usize,
}

/// Cuts that follow on one another without a way between them.
pub(crate) struct Run {
    pub(crate) points: Vec<Point>,
    /// The line of each segment between two points.
    pub(crate) lines: Vec<usize>,
    /// The feedrate of each segment.
    pub(crate) feeds: Vec<Option<f64>>,
}

impl Run {
    pub(crate) fn length(&self) -> f64 {
        self.points.windows(2).map(|ends| distance(ends[0], ends[1])).sum()
    }
}

/// The cuts of a part. With `without_splines` splines are left out, and the cut behind each: rs274 prints neither.
pub(crate) fn cuts(part: &Part, without_splines: bool) -> Vec<Cut> {
    let is_spline = |index: usize| part.moves[index].shape == Shape::Nurbs;
    let is_left_out = |index: usize| is_spline(index) || index > 0 && is_spline(index - 1);
    let moves = part.curves.iter().zip(&part.moves).enumerate();
    moves
        .filter(|(index, (_, one))| one.kind == MoveKind::Feed && !(without_splines && is_left_out(*index)))
        .map(|(_, (curve, one))| Cut {
            points: flat(curve),
            feedrate_mm_per_s: one.feedrate_mm_per_s,
            line: one.line,
        })
        .collect()
}

/// Joins cuts that meet within the tolerance; runs that are no longer than it are left out.
pub(crate) fn runs(cuts: &[Cut], tolerance: f64) -> Vec<Run> {
    let mut runs: Vec<Run> = Vec::new();
    for cut in cuts {
        let goes_on = runs
            .last()
            .is_some_and(|run| distance(run.points[run.points.len() - 1], cut.points[0]) <= tolerance);
        if !goes_on {
            runs.push(Run { points: vec![cut.points[0]], lines: Vec::new(), feeds: Vec::new() });
        }
        let Some(run) = runs.last_mut() else { continue };
        for point in &cut.points[1..] {
            run.points.push(*point);
            run.lines.push(cut.line);
            run.feeds.push(cut.feedrate_mm_per_s);
        }
    }
    runs.retain(|run| run.length() > tolerance);
    runs
}

/// A curve as chords.
fn flat(curve: &Curve) -> Vec<Point> {
    let points = curve.control_points_mm();
    if curve.degree() == 1 {
        return points.to_vec();
    }
    let Ok(nurbs) = curve.for_evaluation() else { return points.to_vec() };
    let nurbs = nurbs.as_curve();
    let mut chords = vec![points[0]];
    for span in 0..nurbs.span_count() {
        let (from, to) = nurbs.span_bounds(span);
        let at = |u: f64| nurbs.derivatives_in(span, u).point;
        halve(&at, [from, to], [at(from), at(to)], MAX_HALVINGS, &mut chords);
    }
    if let Some(last) = chords.last_mut() {
        *last = points[points.len() - 1];
    }
    chords
}

/// Adds the chords of a piece of a curve behind its start, halved until three points within it are near their chord.
fn halve(
    at: &impl Fn(f64) -> Point,
    [from, to]: [f64; 2],
    ends: [Point; 2],
    halvings: u32,
    chords: &mut Vec<Point>,
) {
    let u = |share: f64| from + (to - from) * share;
    let is_flat = [0.25, 0.5, 0.75].iter().all(|share| off_chord(at(u(*share)), ends) <= CHORD_ERROR_MM);
    if halvings == 0 || is_flat && halvings < MAX_HALVINGS {
        chords.push(ends[1]);
        return;
    }
    let middle = at(u(0.5));
    halve(at, [from, u(0.5)], [ends[0], middle], halvings - 1, chords);
    halve(at, [u(0.5), to], [middle, ends[1]], halvings - 1, chords);
}

fn off_chord(point: Point, [from, to]: [Point; 2]) -> f64 {
    let square: f64 = (0..3).map(|axis| (to[axis] - from[axis]).powi(2)).sum();
    let along: f64 = (0..3).map(|axis| (to[axis] - from[axis]) * (point[axis] - from[axis])).sum();
    let share = if square > 0.0 { (along / square).clamp(0.0, 1.0) } else { 0.0 };
    distance(point, std::array::from_fn(|axis| from[axis] + (to[axis] - from[axis]) * share))
}
