//! The input of a run: a path and a machine's limits, in f64.
//!
//! Rapid moves cut nothing, so they are left out. The moves at feed stay at their places in the part. Behind a rapid
//! move or a gap in a drawing, a move begins elsewhere than the one before it ends. The machine rests there and makes
//! another move, and the path goes on where the next move begins.

use feed_plan::{AxisLimits, FeedLimit, Junction, KinematicLimits, PlanError};
use nurbs_core::{CompileError, CurveError, FastCurve, NurbsBuf};
use part_program::{Machine, MoveKind, Part, Rest};
use real::Real;

use crate::problem::side_axes::SideAxes;
use crate::refusal::Refusal;

/// A path of curves in mm and the machine that is to follow it.
#[derive(Clone, Debug)]
pub struct Problem<const D: usize> {
    /// Name of the part, for reports.
    pub name: String,
    /// The curves, in the order in which they are followed.
    pub curves: Vec<NurbsBuf<f64, D>>,
    /// The commanded feedrate of each curve, in mm/s; empty if the part commands none, and the machine's holds.
    pub feeds_mm_per_s: Vec<f64>,
    /// Numbers of the curves that begin at rest whatever their direction, in order: those behind an exact stop, a rapid
    /// move, a gap, or a word for the machine such as M8.
    pub stops: Vec<usize>,
    /// The members of `stops` before which the machine makes another move: behind a rapid move or a gap.
    pub breaks: Vec<usize>,
    /// The line of each curve in the part; empty if the lines are unknown.
    pub lines: Vec<usize>,
    /// The number of rapid moves that were left out.
    pub rapids_left_out: usize,
    /// The number of gaps for which the part has no rapid move.
    pub gaps: usize,
    /// The largest distance of a printer's filament position from 0, in mm, if the part counts the position.
    pub filament_mm: Option<f64>,
    /// The axes that move beside the path.
    pub side_axes: SideAxes,
    /// The machine's limits.
    pub machine: Machine,
}

/// The jump of velocity allowed to an axis that may not jump, in mm per period. It is so small that any break of the
/// tangent is a stop.
const NO_JUMP: f64 = 1e-9;

impl<const D: usize> Problem<D> {
    /// The curves in the form that is planned on in f64.
    #[must_use]
    pub fn fast_curves(&self) -> Vec<FastCurve<'_, D>> {
        self.curves.iter().map(|curve| FastCurve::of(curve.as_curve())).collect()
    }

    /// Takes the moves at feed of `part` in `D` dimensions. Coordinates beyond `D` are dropped, so `D` must be at least
    /// the part's dimension. If a part has rapid moves only, these are taken.
    ///
    /// # Errors
    /// [`CurveError`] of the first curve that is not valid.
    pub fn new(part: &Part, machine: &Machine) -> Result<Self, CurveError> {
        let rapids_left_out = rapid_moves(part);
        let taken = part.curves.iter().enumerate().filter(|(index, _)| {
            let is_rapid = part.moves.get(*index).is_some_and(|one| one.kind == MoveKind::Rapid);
            rapids_left_out == 0 || !is_rapid
        });
        let (indices, taken): (Vec<_>, Vec<_>) = taken.unzip();
        let feeds_mm_per_s = commanded_feeds(part, &indices);
        let lines = indices.iter().map_while(|index| part.moves.get(*index)).map(|one| one.line).collect();
        let (mut stops, mut breaks, mut gaps) = (Vec::new(), Vec::new(), 0);
        for (curve, pair) in (1..).zip(indices.windows(2)) {
            let is_behind_rapid = pair[1] > pair[0] + 1;
            let is_gap = !is_behind_rapid && part.has_gap_before(pair[1]);
            gaps += usize::from(is_gap);
            breaks.extend((is_behind_rapid || is_gap).then_some(curve));
            let rest = part.rest_before(pair[1]).filter(|rest| *rest != Rest::Rapid || rapids_left_out > 0);
            stops.extend((is_gap || rest.is_some()).then_some(curve));
        }
        let curves = taken.iter().map(|curve| {
            let points =
                curve.control_points_mm().iter().map(|point| core::array::from_fn(|d| point[d])).collect();
            NurbsBuf::try_new(curve.degree(), points, curve.weights().to_vec(), curve.knots().to_vec())
        });
        let curves = curves.collect::<Result<Vec<_>, _>>()?;
        let (name, machine) = (part.name.clone(), machine.clone());
        let filament_mm = part.filament.map(|filament| filament.greatest_mm.max(-filament.least_mm));
        let side_axes = SideAxes::of(part, &indices, &curves);
        let mut problem = Self {
            name,
            curves,
            feeds_mm_per_s,
            stops,
            breaks,
            lines,
            rapids_left_out,
            gaps,
            filament_mm,
            side_axes,
            machine,
        };
        problem.rest_for_side_axes();
        Ok(problem)
    }

    /// Adds the rests that the side axes need.
    fn rest_for_side_axes(&mut self) {
        let feed_of = |curve: usize| self.feed_mm_per_s(curve);
        let mut rests = self.side_axes.stops(&self.machine, feed_of);
        rests.retain(|curve| *curve < self.curves.len());
        self.stops.extend(rests);
        self.stops.sort_unstable();
        self.stops.dedup();
    }

    /// Whether the machine rests before it begins this curve, whatever the directions there.
    pub(crate) fn rests_before(&self, curve: usize) -> bool {
        self.stops.binary_search(&curve).is_ok()
    }

    /// The highest commanded feedrate F, in mm/s.
    #[must_use]
    pub fn feedrate_mm_per_s(&self) -> f64 {
        self.feeds_mm_per_s.iter().copied().reduce(f64::max).unwrap_or(self.machine.feedrate_mm_per_s)
    }

    /// The commanded feedrate of a curve, in mm/s.
    #[must_use]
    pub fn feed_mm_per_s(&self, curve: usize) -> f64 {
        self.feeds_mm_per_s.get(curve).copied().unwrap_or(self.machine.feedrate_mm_per_s)
    }

    /// The commanded feedrate of a curve over the highest.
    pub(crate) fn feed_ratios(&self) -> impl Fn(usize) -> f64 + '_ {
        let highest = self.feedrate_mm_per_s();
        move |curve| self.feed_mm_per_s(curve) / highest
    }

    /// The problem with this highest feedrate F, in mm/s. The other feedrates keep their ratios to the highest.
    #[must_use]
    pub fn at_feedrate(&self, feedrate_mm_per_s: f64) -> Self {
        let mut changed = self.clone();
        let highest = self.feedrate_mm_per_s();
        for feed in &mut changed.feeds_mm_per_s {
            *feed = feedrate_mm_per_s * (*feed / highest);
        }
        if changed.feeds_mm_per_s.is_empty() {
            changed.machine.feedrate_mm_per_s = feedrate_mm_per_s;
        }
        changed
    }

    /// The refusal for curves that cannot be compiled, with the place in the part.
    pub(crate) fn refusal(&self, error: CompileError) -> Refusal {
        match error.curve().and_then(|curve| self.lines.get(curve)) {
            Some(line) => Refusal::CurveAt { part: self.name.clone(), line: *line, error },
            None => Refusal::Compile(error),
        }
    }

    /// The refusal for curves that cannot be planned, with the place in the part.
    pub(crate) fn plan_refusal(&self, error: PlanError) -> Refusal {
        match error.curve().and_then(|curve| self.lines.get(curve)) {
            Some(line) => Refusal::PlanAt { part: self.name.clone(), line: *line, error },
            None => Refusal::Plan(error),
        }
    }

    /// The largest feed at each distance, in f64, in mm and periods.
    ///
    /// # Errors
    /// [`PlanError`] when a limit or the feed of a curve is not positive, or the path has no length.
    pub fn feed_limit(&self) -> Result<FeedLimit<f64>, PlanError> {
        self.feed_limit_under(&self.fast_curves(), &self.limits_per_period()?)
    }

    /// The same of these curves, which are those of the problem, under other limits.
    pub(crate) fn feed_limit_under(
        &self,
        curves: &[FastCurve<'_, D>],
        limits: &KinematicLimits<f64>,
    ) -> Result<FeedLimit<f64>, PlanError> {
        let limit = FeedLimit::along_with_stops(curves, limits, &self.stops)?;
        let ratio = self.feed_ratios();
        let limit = limit.capped(|curve| limits.feedrate * ratio(curve))?;
        self.within_side_axes(limit, |_, number| Ok(number))
    }

    /// The limit of the feed, in mm and periods, with what the side axes leave for the path. `number` makes a number of
    /// the format, which may be infinite.
    pub(crate) fn within_side_axes<R: Real, E: From<PlanError>>(
        &self,
        limit: FeedLimit<R>,
        number: impl Fn(&'static str, f64) -> Result<R, E>,
    ) -> Result<FeedLimit<R>, E> {
        if self.side_axes.is_empty() {
            return Ok(limit);
        }
        let t = self.period_s();
        let (mut feeds, mut changes, mut joints) = (Vec::new(), Vec::new(), Vec::new());
        for curve in 0..self.curves.len() {
            let most = self.side_axes.most(curve, &self.machine, &self.stops);
            feeds.push(number("velocity of a side axis", most.feed * t)?);
            changes.push((
                number("acceleration of a side axis", most.acceleration * t.powi(2))?,
                number("jerk of a side axis", most.jerk * t.powi(3))?,
            ));
            let joint = self.side_axes.feed_before(curve, &self.machine);
            joints.push(if self.rests_before(curve) {
                R::max_value()
            } else {
                number("velocity jump of a side axis", joint * t)?
            });
        }
        let limit = limit.capped(|curve| feeds.get(curve).copied().unwrap_or_else(R::max_value))?;
        let limit = limit.allowing(|curve| changes.get(curve).copied());
        Ok(limit.passing_joints(|curve| joints.get(curve).copied()))
    }

    /// The interpolation period T, in s.
    #[must_use]
    pub fn period_s(&self) -> f64 {
        self.machine.interpolation_period_ms / 1000.0
    }

    /// The step F·T of a period at the highest commanded feed, in mm.
    #[must_use]
    pub fn full_step_mm(&self) -> f64 {
        self.feedrate_mm_per_s() * self.period_s()
    }

    fn axes(&self) -> [part_program::AxisLimits; 3] {
        let axes = &self.machine.axes;
        [axes.x, axes.y, axes.z]
    }

    /// The limits of single axes, in mm and periods.
    pub(crate) fn axes_per_period(&self) -> [AxisLimits<f64>; 3] {
        let t = self.period_s();
        self.axes().map(|axis| AxisLimits {
            velocity: axis.velocity_mm_per_s.map(|v| v * t),
            acceleration: axis.acceleration_mm_per_s2.map(|a| a * t.powi(2)),
            jerk: axis.jerk_mm_per_s3.map(|j| j * t.powi(3)),
        })
    }

    /// The limits with the interpolation period as the unit of time: F·T, A·T², J·T³ in mm per period to the first,
    /// second and third power. A controller works with these numbers. They are of the order of a step, while the same
    /// limits per second span nine orders of magnitude.
    ///
    /// # Errors
    /// [`PlanError`] when a limit is not positive.
    pub fn limits_per_period(&self) -> Result<KinematicLimits<f64>, PlanError> {
        let (machine, t) = (&self.machine, self.period_s());
        let limits = KinematicLimits {
            interpolation_period: 1.0,
            feedrate: self.full_step_mm(),
            acceleration: machine.acceleration_mm_per_s2 * t.powi(2),
            jerk: machine.jerk_mm_per_s3 * t.powi(3),
            chord_error: machine.chord_error_mm,
            centripetal_acceleration: machine.centripetal_acceleration_mm_per_s2.map(|a| a * t.powi(2)),
            axes: self.axes_per_period(),
            junction: match machine.junction {
                part_program::Junction::Stop => Junction::Stop,
                part_program::Junction::DeviationMm(deviation) => Junction::Deviation(deviation),
                part_program::Junction::VelocityJump => Junction::VelocityJump(
                    self.axes().map(|axis| axis.velocity_jump_mm_per_s.map_or(NO_JUMP, |jump| jump * t)),
                ),
            },
        };
        limits.validate()?;
        Ok(limits)
    }
}

/// The number of rapid moves that a [`Problem`] leaves out: all of the part's, or none if the part has nothing else.
fn rapid_moves(part: &Part) -> usize {
    let rapids = part.moves.iter().filter(|one| one.kind == MoveKind::Rapid).count();
    if rapids == part.moves.len() { 0 } else { rapids }
}

/// The commanded feedrates of these moves, in mm/s; empty if the part commands none. A move without a feedrate has the
/// highest of the part.
fn commanded_feeds(part: &Part, moves: &[usize]) -> Vec<f64> {
    let Some(highest) = part.feedrate_mm_per_s else { return Vec::new() };
    let own = |index: &usize| part.moves.get(*index).and_then(|one| one.feedrate_mm_per_s);
    moves.iter().map(|index| own(index).unwrap_or(highest)).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use part_program::{read_machine, read_part};

    /// The second curve that is run, after a rapid move.
    #[test]
    fn a_curve_that_cannot_be_compiled_is_named_with_its_line() {
        let machine = "[machine]\ninterpolation_period_ms = 1\nfeedrate_mm_per_s = 50\nacceleration_mm_per_s2 = 1000\njerk_mm_per_s3 = 4e4\n";
        let part = read_part("p.nc", "G0 X0 Y0\nG1 X10 F600\nG0 X20\nG1 X40\n").unwrap();
        let problem = Problem::<3>::new(&part, &read_machine("m", machine).unwrap()).unwrap();
        let refusal = problem.refusal(CompileError::OriginOutOfRange { curve: 1 });
        assert_eq!(refusal.to_string(), "p.nc:4: curve 1 lies beyond ±2^24 mm");
    }
}
