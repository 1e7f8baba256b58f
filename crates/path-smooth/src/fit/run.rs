//! One run of straight moves as cubic curves, and the moves that stay as they are.
//!
//! A curve passes its first and last point, and at first no others. Where it is too far off, it is made to pass the point
//! in the middle too, until it is near enough or passes every point there. If it is still too far off between two
//! neighbours, that move stays straight, and the run is divided there: the curves on both sides begin and end along it.

use std::ops::Range;

use nurbs_core::{
    Differentiate, EndCondition, InterpolationError, NurbsBuf, NurbsCurve, distance_from_segment, interpolate,
};
use real::{Backend, DoubleDouble};

use crate::fit::options::FitOptions;
use crate::stretch::length;

/// A run of fewer moves stays as it is: a curve would be longer to write.
pub(crate) const LEAST_MOVES: usize = 3;
/// Newton steps to the place of a point on the curve. The bound holds for any place; a nearer one makes it less.
const STEPS: usize = 3;

/// A part of a run.
#[derive(Clone, Debug, PartialEq)]
pub(crate) enum Piece {
    /// This move, as it is.
    Straight(usize),
    /// A curve in place of these moves.
    Curve(FittedCurve),
}

/// A curve in place of moves.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct FittedCurve {
    /// The moves, counted in the run.
    pub(crate) moves: Range<usize>,
    pub(crate) curve: NurbsBuf<f64, 3>,
    /// Proven bound of the distance from the moves, both ways, in mm.
    pub(crate) bound_mm: f64,
}

type Ends = [EndCondition<3>; 2];

/// Ends that nothing is beside.
const FREE: Ends = [EndCondition::Parabola; 2];

/// Fits moves from point to point. Neighbours among the points are apart; `ends` are those of the whole run.
pub(crate) fn fit(
    points: &[[f64; 3]],
    ends: Ends,
    options: &FitOptions,
) -> Result<Vec<Piece>, InterpolationError> {
    let run = Run::new(points, options);
    let mut pieces = Vec::new();
    // What is left to do, the last first.
    let mut left = vec![Task::Fit(0..points.len() - 1, ends)];
    while let Some(task) = left.pop() {
        match task {
            Task::Keep(at) => pieces.push(Piece::Straight(at)),
            Task::Fit(moves, _) if moves.len() < LEAST_MOVES => pieces.extend(moves.map(Piece::Straight)),
            Task::Fit(moves, ends) => match run.attempt(moves.clone(), ends)? {
                Attempt::Curve(fitted) => pieces.push(Piece::Curve(fitted)),
                Attempt::IsStraight => pieces.extend(moves.map(Piece::Straight)),
                Attempt::Without(kept) => left.extend(run.divided(moves, ends, &kept).into_iter().rev()),
            },
        }
    }
    Ok(pieces)
}

enum Task {
    Fit(Range<usize>, Ends),
    Keep(usize),
}

enum Attempt {
    Curve(FittedCurve),
    /// One straight move would be near enough to all.
    IsStraight,
    /// No curve, unless these moves stay straight.
    Without(Vec<usize>),
}

/// A span of a trial curve that is not known to be near enough.
struct Failing {
    /// The span, counted in the curve.
    span: usize,
    off_mm: f64,
}

struct Run<'p> {
    points: &'p [[f64; 3]],
    /// The length of the moves before each point, in mm.
    lengths: Vec<f64>,
    tolerance_mm: f64,
    every_point: bool,
}

impl<'p> Run<'p> {
    fn new(points: &'p [[f64; 3]], options: &FitOptions) -> Self {
        let mut lengths = vec![0.0];
        let mut sum = 0.0;
        for pair in points.windows(2) {
            sum += length(&between(&pair[0], &pair[1]));
            lengths.push(sum);
        }
        let &FitOptions { tolerance_mm, every_point, .. } = options;
        Self { points, lengths, tolerance_mm, every_point }
    }

    /// Tries one curve for some of the moves.
    fn attempt(&self, moves: Range<usize>, mut ends: Ends) -> Result<Attempt, InterpolationError> {
        let few = vec![moves.start, moves.end];
        if self.every_point && ends == FREE && self.is_straight(&few)? {
            return Ok(Attempt::IsStraight);
        }
        let mut passed = if self.every_point { (moves.start..=moves.end).collect() } else { few };
        // Every round adds a point or gives up the direction of an end; or it is the last.
        for _ in 0..=moves.len() + 2 {
            while let Some(at) =
                passed.windows(2).position(|pair| self.points[pair[0]] == self.points[pair[1]])
            {
                // A closed run: its begin is its end.
                passed.insert(at + 1, self.middle(passed[at], passed[at + 1]));
            }
            let through: Vec<_> = passed.iter().map(|at| self.points[*at]).collect();
            let curve = interpolate(&through, ends)?;
            let mut failing = self.failing::<f64>(&curve.as_curve(), &passed);
            if failing.is_empty() {
                failing = self.failing::<DoubleDouble>(&curve.as_curve(), &passed);
            }
            if failing.is_empty() {
                let is_straight = passed.len() == 2 && ends == FREE;
                let bound_mm = self.bound(&curve.as_curve(), &passed);
                let fitted = FittedCurve { moves, curve, bound_mm };
                return Ok(if is_straight { Attempt::IsStraight } else { Attempt::Curve(fitted) });
            }
            let is_open = |one: &&Failing| passed[one.span + 1] - passed[one.span] > 1;
            let added: Vec<usize> = failing
                .iter()
                .filter(is_open)
                .map(|one| self.middle(passed[one.span], passed[one.span + 1]))
                .collect();
            if !added.is_empty() {
                passed.extend(added);
                passed.sort_unstable();
                continue;
            }
            if !give_up_directions(&mut ends, &failing, passed.len() - 1) {
                return Ok(Attempt::Without(worst(&failing).map(|span| passed[span]).collect()));
            }
        }
        Ok(Attempt::Without(moves.collect()))
    }

    /// Whether the straight line between the two points is near enough to all moves between them.
    fn is_straight(&self, ends: &[usize]) -> Result<bool, InterpolationError> {
        let points: Vec<_> = ends.iter().map(|at| self.points[*at]).collect();
        Ok(points[0] != points[1]
            && self.failing::<DoubleDouble>(&interpolate(&points, FREE)?.as_curve(), ends).is_empty())
    }

    /// The point nearest to the middle of the moves between two points that are not neighbours.
    fn middle(&self, from: usize, to: usize) -> usize {
        let half = f64::midpoint(self.lengths[from], self.lengths[to]);
        let at = self.lengths.partition_point(|length| *length < half);
        at.clamp(from + 1, to - 1)
    }

    /// The spans that are not known to be near enough. Control points are computed in `H`.
    fn failing<H: Backend>(&self, curve: &NurbsCurve<'_, f64, 3>, passed: &[usize]) -> Vec<Failing> {
        let off = |span| self.span_off::<H>(curve, span, [passed[span], passed[span + 1]]);
        let spans = (0..passed.len() - 1).map(|span| Failing { span, off_mm: off(span) });
        spans.filter(|one| one.off_mm.is_nan() || one.off_mm > self.tolerance_mm).collect()
    }

    /// The bound for the whole curve, in mm.
    fn bound(&self, curve: &NurbsCurve<'_, f64, 3>, passed: &[usize]) -> f64 {
        let off = |span| self.span_off::<DoubleDouble>(curve, span, [passed[span], passed[span + 1]]);
        (0..passed.len() - 1).map(off).fold(0.0, f64::max)
    }

    /// A bound of the distance of a span from the moves between two points; of the first move that is too far off, if
    /// there is one.
    fn span_off<H: Backend>(
        &self,
        curve: &NurbsCurve<'_, f64, 3>,
        span: usize,
        [from, to]: [usize; 2],
    ) -> f64 {
        use nurbs_core::Evaluate;
        let (begin, end) = curve.span_bounds(span);
        let mut place = begin;
        let mut most = 0.0_f64;
        for at in from..to {
            let next = if at + 1 == to { end } else { self.place(curve, span, [from, at + 1, to], place) };
            let segment = [self.points[at], self.points[at + 1]];
            let off = distance_from_segment::<H, 3>(curve, span, [place, next], &segment);
            if off.is_nan() || off > self.tolerance_mm {
                return off;
            }
            most = most.max(off);
            place = next;
        }
        most
    }

    /// A parameter of the span near a point between those at its ends, not before `least`.
    fn place(
        &self,
        curve: &NurbsCurve<'_, f64, 3>,
        span: usize,
        [from, at, to]: [usize; 3],
        least: f64,
    ) -> f64 {
        use nurbs_core::Evaluate;
        let (begin, end) = curve.span_bounds(span);
        let share = (self.lengths[at] - self.lengths[from]) / (self.lengths[to] - self.lengths[from]);
        let mut u = (begin + (end - begin) * share).clamp(least, end);
        for _ in 0..STEPS {
            let here = curve.derivatives_in(span, u);
            let off = between(&here.point, &self.points[at]);
            let dot = |a: &[f64; 3], b: &[f64; 3]| a.iter().zip(b).map(|(x, y)| x * y).sum::<f64>();
            let step = dot(&off, &here.first) / dot(&here.first, &here.first);
            if step.is_finite() {
                u = (u + step).clamp(least, end);
            }
        }
        u
    }

    /// What is to be done if some moves stay straight: the runs beside them go along them.
    fn divided(&self, moves: Range<usize>, ends: Ends, kept: &[usize]) -> Vec<Task> {
        let along = |at: usize| EndCondition::Along(between(&self.points[at], &self.points[at + 1]));
        let mut tasks = Vec::new();
        let (mut begin, mut start) = (moves.start, ends[0]);
        for &at in kept {
            tasks.push(Task::Fit(begin..at, [start, along(at)]));
            tasks.push(Task::Keep(at));
            (begin, start) = (at + 1, along(at));
        }
        tasks.push(Task::Fit(begin..moves.end, [start, ends[1]]));
        tasks
    }
}

/// Where the first or the last span fails, gives up the direction of that end. Whether there was one.
fn give_up_directions(ends: &mut Ends, failing: &[Failing], spans: usize) -> bool {
    let mut is_new = false;
    for (end, span) in ends.iter_mut().zip([0, spans - 1]) {
        if matches!(end, EndCondition::Along(_)) && failing.iter().any(|one| one.span == span) {
            *end = EndCondition::Parabola;
            is_new = true;
        }
    }
    is_new
}

/// Of neighbouring spans that fail, those that are farther off than both beside them: a curve too far off in one span
/// swings in the next.
fn worst(failing: &[Failing]) -> impl Iterator<Item = usize> + '_ {
    let off_at = |index: Option<usize>, span: usize| {
        let beside = index.and_then(|index| failing.get(index)).filter(|one| one.span == span);
        beside.map_or(0.0, |one| one.off_mm)
    };
    failing.iter().enumerate().filter_map(move |(index, one)| {
        let before = one.span.checked_sub(1).map_or(0.0, |span| off_at(index.checked_sub(1), span));
        let is_worst = !(before > one.off_mm || off_at(Some(index + 1), one.span + 1) > one.off_mm);
        is_worst.then_some(one.span)
    })
}

/// From one point to another.
pub(crate) fn between(from: &[f64; 3], to: &[f64; 3]) -> [f64; 3] {
    std::array::from_fn(|d| to[d] - from[d])
}

#[cfg(test)]
mod tests {
    use nurbs_core::{Evaluate, distance_to_segment};
    use proptest::prelude::*;
    use std::f64::consts::TAU;

    use super::*;

    fn within(points: &[[f64; 3]], tolerance_mm: f64) -> Vec<Piece> {
        fit(points, FREE, &FitOptions::within(tolerance_mm)).unwrap()
    }

    fn circle(radius: f64, count: u32) -> Vec<[f64; 3]> {
        let at = |k: u32| f64::from(k % count) / f64::from(count) * TAU;
        (0..=count).map(|k| [radius * at(k).cos(), radius * at(k).sin(), 1.5]).collect()
    }

    /// A curve of radius 4 mm or more is so far from the polygon of its samples, (31.5 mm / 1000)²/8/4 mm.
    const SAMPLES_MM: f64 = 3.2e-5;

    /// 1000 points of each curve to its moves, and each of these to the polygon of the points.
    fn sampled(points: &[[f64; 3]], fitted: &FittedCurve) -> f64 {
        let curve = fitted.curve.as_curve();
        let seen: Vec<_> = (0..=1000_u32).map(|k| curve.point(f64::from(k) / 1000.0)).collect();
        let own = &points[fitted.moves.start..=fitted.moves.end];
        let off = |point: &[f64; 3], path: &[[f64; 3]]| {
            path.windows(2)
                .map(|pair| distance_to_segment(point, &[pair[0], pair[1]]))
                .fold(f64::MAX, f64::min)
        };
        let middles =
            own.windows(2).map(|pair| std::array::from_fn(|d| f64::midpoint(pair[0][d], pair[1][d])));
        let back = own.iter().copied().chain(middles).map(|point| off(&point, &seen));
        seen.iter().map(|point| off(point, own)).chain(back).fold(0.0, f64::max)
    }

    /// Chords of a circle of radius 5, 3° each, are 1.7 µm inside: a curve within 2 µm of them is within 2 µm of the circle,
    /// and within 5 µm it needs fewer points than there are chords.
    #[test]
    fn a_circle_of_chords_is_one_curve() {
        let points = circle(5.0, 120);
        for (tolerance_mm, most) in [(0.002, 125), (0.005, 40)] {
            let pieces = within(&points, tolerance_mm);
            let [Piece::Curve(fitted)] = pieces.as_slice() else { panic!("{pieces:?}") };
            assert_eq!(fitted.moves, 0..120);
            let count = fitted.curve.control_points().len();
            assert!(count <= most, "{count} control points at {tolerance_mm}");
            let seen = sampled(&points, fitted);
            assert!(
                seen <= fitted.bound_mm + SAMPLES_MM && fitted.bound_mm <= tolerance_mm,
                "{seen}, {}",
                fitted.bound_mm
            );
            assert!(fitted.bound_mm < 1.3 * seen + 1e-6, "the bound {} is far above {seen}", fitted.bound_mm);
            for k in 0..=500_u32 {
                let [x, y, z] = fitted.curve.as_curve().point(f64::from(k) / 500.0);
                assert!((x.hypot(y) - 5.0).abs() <= tolerance_mm + 0.0018, "{x} {y} {z}");
            }
            assert!(fitted.curve.control_points().iter().all(|point| point[2] == 1.5));
        }
    }

    /// Through every point, the curve is far nearer to the circle than the chords are, but for the ends, where it knows no
    /// direction; straight moves stay also then.
    #[test]
    fn a_curve_through_every_point_is_the_circle() {
        let options = FitOptions { every_point: true, ..FitOptions::within(0.005) };
        let pieces = fit(&circle(5.0, 120), FREE, &options).unwrap();
        let [Piece::Curve(fitted)] = pieces.as_slice() else { panic!("{pieces:?}") };
        assert_eq!(fitted.curve.control_points().len(), 123);
        for k in 0..=500_u32 {
            let u = f64::from(k) / 500.0;
            let [x, y, _] = fitted.curve.as_curve().point(u);
            let most = if (0.05..=0.95).contains(&u) { 2e-7 } else { 1e-4 };
            assert!((x.hypot(y) - 5.0).abs() <= most, "u = {u}: {}", x.hypot(y) - 5.0);
        }
        let line: Vec<[f64; 3]> = (0..9_u32).map(|k| [f64::from(k), 0.0, 0.0]).collect();
        assert_eq!(fit(&line, FREE, &options).unwrap(), (0..8).map(Piece::Straight).collect::<Vec<_>>());
    }

    /// A long move between two arcs stays straight, and the curves beside it begin and end along it.
    #[test]
    fn a_long_move_stays_and_the_curves_go_along_it() {
        let mut points: Vec<[f64; 3]> = (0..=30_u32)
            .map(|k| f64::from(k) / 30.0 * TAU / 4.0)
            .map(|angle| [4.0 * angle.sin() - 4.0, 4.0 - 4.0 * angle.cos() - 4.0, 0.0])
            .collect();
        points.reverse();
        let mut points: Vec<_> = points.into_iter().map(|[x, y, z]| [x, -y, z]).collect();
        // Up to here a quarter circle that ends upright at (-4, 4); from there straight on, and another one.
        let last = points[points.len() - 1];
        let direction = between(&points[points.len() - 2], &last);
        let unit = direction.map(|x| x / length(&direction));
        let far = std::array::from_fn(|d| last[d] + 50.0 * unit[d]);
        points.push(far);
        for k in 1..=30_u32 {
            let angle = f64::from(k) / 30.0 * TAU / 4.0;
            let side = [-unit[1], unit[0], 0.0];
            points.push(std::array::from_fn(|d| {
                far[d] + 4.0 * angle.sin() * unit[d] + 4.0 * (1.0 - angle.cos()) * side[d]
            }));
        }
        let pieces = within(&points, 0.004);
        let [Piece::Curve(first), Piece::Straight(30), Piece::Curve(second)] = pieces.as_slice() else {
            panic!("{pieces:?}")
        };
        for (curve, u) in [(first, 1.0), (second, 0.0)] {
            let first = curve.curve.as_curve().derivatives(u).first;
            let turn: f64 = (0..3).map(|d| first[d] * unit[d]).sum::<f64>() / length(&first);
            assert!(turn > 1.0 - 1e-12, "{first:?} is not along {unit:?}");
            let (seen, bound) = (sampled(&points, curve), curve.bound_mm);
            assert!(seen <= bound + SAMPLES_MM && bound <= 0.004, "{seen}, {bound}");
        }
    }

    #[test]
    fn straight_moves_and_short_runs_stay() {
        let line: Vec<[f64; 3]> = (0..9_u32).map(|k| [f64::from(k), 2.0 * f64::from(k), 0.0]).collect();
        let kept = |count| (0..count).map(Piece::Straight).collect::<Vec<_>>();
        assert_eq!(within(&line, 0.001), kept(8));
        assert_eq!(within(&circle(5.0, 120)[..3], 0.01), kept(2));
        // A polygon of long sides: no curve is near enough.
        assert_eq!(within(&circle(50.0, 24), 0.01), kept(24));
    }

    proptest! {
        /// Whatever the moves are: each of them is in one piece, in order; curves begin and end at their points to the last
        /// bit; and no sampled distance is above the bound, nor the bound above the tolerance.
        #[test]
        fn curves_keep_their_bound_on_random_moves(
            moves in prop::collection::vec((0.05..0.6_f64, -0.5..0.5_f64, -0.1..0.1_f64, 1..12_u32), 3..40),
            tolerance_mm in 0.001..0.05_f64,
        ) {
            let mut points = vec![[0.0; 3]];
            let mut heading = 0.0_f64;
            for (step, turn, rise, long) in moves {
                heading += turn;
                let step = if long == 1 { 20.0 * step } else { step };
                let [x, y, z] = points[points.len() - 1];
                points.push([x + step * heading.cos(), y + step * heading.sin(), z + step * rise]);
            }
            let mut next = 0;
            for piece in within(&points, tolerance_mm) {
                let fitted = match piece {
                    Piece::Straight(at) => {
                        prop_assert_eq!(at, next);
                        next += 1;
                        continue;
                    }
                    Piece::Curve(fitted) => fitted,
                };
                prop_assert!(fitted.moves.start == next && fitted.moves.len() >= LEAST_MOVES);
                next = fitted.moves.end;
                let control = fitted.curve.control_points();
                prop_assert!(control[0] == points[fitted.moves.start] && control[control.len() - 1] == points[next]);
                // The polygon of the samples is as far from the curve as at radius 0.05 mm: steps of 0.01 mm, squared, over 8.
                let seen = sampled(&points, &fitted) - 2.5e-4;
                prop_assert!(seen <= fitted.bound_mm && fitted.bound_mm <= tolerance_mm, "{} {}", seen, fitted.bound_mm);
            }
            prop_assert_eq!(next, points.len() - 1);
        }
    }
}
