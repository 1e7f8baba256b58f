//! The time that a stretch takes from rest to rest, and the feed at each place of it.

use feed_plan::Stage;
use format_compare::{ExactPlan, Options, Problem, Refusal, Run, largest_second_difference};
use nurbs_core::{PathCurve, arc_length};
use part_program::{Curve, Machine, Move, Part};
use real::{Backend, DoubleDouble};

use crate::error::SmoothError;

/// The width of a place, in mm, so that rounding does not miss a rest in its middle.
const PLACE_MM: f64 = 1e-6;

/// A stretch with its plan, in f64.
pub(crate) struct Timed {
    problem: Problem<3>,
    plan: ExactPlan,
    /// Distance from the start to the end of each curve, in mm.
    ends: Vec<f64>,
}

impl Timed {
    /// Plans curves that are all followed like the move `one`; `shapes` are the same curves, and give the lengths.
    pub(crate) fn new(
        curves: &[Curve],
        shapes: &[PathCurve<f64, 3>],
        one: &Move,
        machine: &Machine,
    ) -> Result<Self, SmoothError> {
        let part = Part {
            curves: curves.to_vec(),
            moves: vec![*one; curves.len()],
            feedrate_mm_per_s: one.feedrate_mm_per_s,
            ..Part::default()
        };
        // Whoever knows the part says of which line a refusal is.
        let problem = Problem { lines: Vec::new(), ..Problem::new(&part, machine)? };
        let plan = ExactPlan::in_format::<f64, 3>(&problem, [0.0; 2])?;
        let mut distance = 0.0;
        let mut ends: Vec<f64> = Vec::with_capacity(shapes.len());
        for shape in shapes {
            distance += length_mm(shape);
            ends.push(distance);
        }
        Ok(Self { problem, plan, ends })
    }

    /// Time in s.
    pub(crate) fn time_s(&self) -> f64 {
        self.plan.periods() as f64 * self.problem.period_s()
    }

    /// Length in mm.
    pub(crate) fn length_mm(&self) -> f64 {
        self.ends.last().copied().unwrap_or(0.0)
    }

    /// The lowest feed along curve `curve`, in mm/s.
    pub(crate) fn lowest_feed_along(&self, curve: usize) -> f64 {
        let begin = curve.checked_sub(1).map_or(0.0, |before| self.end_of(before));
        self.lowest_feed(begin, self.end_of(curve))
    }

    /// The feed where curve `curve` ends, in mm/s.
    pub(crate) fn feed_at_end_of(&self, curve: usize) -> f64 {
        let place = self.end_of(curve);
        self.lowest_feed(place - PLACE_MM, place + PLACE_MM)
    }

    fn end_of(&self, curve: usize) -> f64 {
        self.ends.get(curve).copied().unwrap_or_else(|| self.length_mm())
    }

    /// The lowest feed over a range of distances. A feed only rises or only falls within a stage, so the lowest is at
    /// an end of a stage or of the range.
    fn lowest_feed(&self, from: f64, to: f64) -> f64 {
        let stages = self.plan.arcs().stages();
        let first = stages.partition_point(|stage| (stage.start + stage.length).value() < from);
        let over = stages[first..].iter().take_while(|stage| stage.start.value() <= to);
        let lowest =
            over.map(|stage| feed_in(stage, from).min(feed_in(stage, to))).fold(f64::INFINITY, f64::min);
        if lowest.is_finite() { lowest / self.problem.period_s() } else { 0.0 }
    }

    /// The largest acceleration of setpoints in any direction, from rest to rest, in mm/s².
    pub(crate) fn total_acceleration_mm_per_s2(&self, run: &Run) -> f64 {
        let start = self.problem.curves.first().and_then(|curve| curve.control_points().first());
        let steps = run.steps.iter().map(|step| step.point_mm);
        let end = run.steps.last().map(|step| step.point_mm);
        let points = [start; 2].into_iter().flatten().copied().chain(steps).chain(end);
        largest_second_difference(points) / self.problem.period_s().powi(2)
    }

    /// The setpoints of the plan, interpolated on compiled pieces in f64.
    pub(crate) fn setpoints(&self) -> Result<Run, SmoothError> {
        let formats = format_compare::formats::<3>();
        let format = formats.iter().find(|format| format.name() == f64::name());
        let format = format.ok_or(Refusal::NoType(f64::name()))?;
        Ok(format.run(&self.problem, &self.plan, &Options::default())?)
    }
}

fn length_mm(curve: &PathCurve<f64, 3>) -> f64 {
    use nurbs_core::Evaluate;
    match curve {
        PathCurve::Line(line) => line.length(),
        PathCurve::Arc(arc) => arc.length(),
        other => {
            let (begin, end) = other.domain();
            arc_length(other, begin, end, 1e-9).length
        }
    }
}

/// The feed of a stage at a distance from the path's start. If the distance is outside of the stage, the feed at its
/// nearer end.
fn feed_in(stage: &Stage<DoubleDouble>, distance: f64) -> f64 {
    let along = distance - stage.start.value();
    if along <= 0.0 {
        return stage.start_feed.value();
    }
    if along >= stage.length.value() {
        return stage.end_feed.value();
    }
    let (mut low, mut high) = (0.0, stage.duration.value());
    for _ in 0..50 {
        let middle = f64::midpoint(low, high);
        if stage.distance_at(middle.into()).value() < along { low = middle } else { high = middle }
    }
    stage.feed_at(low.into()).value()
}
