//! The input of a run: a path and a machine's limits, in f64.
//!
//! Rapid moves cut nothing, so they are left out. The moves at feed stay at their places in the part. Behind a rapid
//! move or a gap in a drawing, a move begins elsewhere than the one before it ends. The machine rests there and makes
//! another move, and the path goes on where the next move begins.

use std::ops::Range;

use feed_plan::{AxisLimits, FeedLimit, Junction, KinematicLimits, PlanError};
use nurbs_core::{CompileError, CurveError, FastCurve, NurbsBuf};
use part_program::{Machine, MoveKind, Part, Rest};

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
        let curves = curves.collect::<Result<_, _>>()?;
        let (name, machine) = (part.name.clone(), machine.clone());
        let filament_mm = part.filament.map(|filament| filament.greatest_mm.max(-filament.least_mm));
        Ok(Self {
            name,
            curves,
            feeds_mm_per_s,
            stops,
            breaks,
            lines,
            rapids_left_out,
            gaps,
            filament_mm,
            machine,
        })
    }

    /// A problem of the curves of this range alone, on the same machine. It rests where the range begins and ends.
    #[must_use]
    pub(crate) fn part(&self, curves: Range<usize>) -> Self {
        let of_range = |all: &[usize]| {
            let inner = all.iter().filter(|curve| curves.start < **curve && **curve < curves.end);
            inner.map(|curve| curve - curves.start).collect()
        };
        Self {
            curves: self.curves.get(curves.clone()).unwrap_or_default().to_vec(),
            feeds_mm_per_s: self.feeds_mm_per_s.get(curves.clone()).unwrap_or_default().to_vec(),
            lines: self.lines.get(curves.clone()).unwrap_or_default().to_vec(),
            stops: of_range(&self.stops),
            breaks: of_range(&self.breaks),
            ..self.clone()
        }
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
        limit.capped(|curve| limits.feedrate * ratio(curve))
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

    /// The limits with the interpolation period as the unit of time: F·T, A·T², J·T³ in mm per period to the first,
    /// second and third power. A controller works with these numbers. They are of the order of a step, while the same
    /// limits per second span nine orders of magnitude.
    ///
    /// # Errors
    /// [`PlanError`] when a limit is not positive.
    pub fn limits_per_period(&self) -> Result<KinematicLimits<f64>, PlanError> {
        let (machine, t) = (&self.machine, self.period_s());
        let axes = [machine.axes.x, machine.axes.y, machine.axes.z];
        let limits = KinematicLimits {
            interpolation_period: 1.0,
            feedrate: self.full_step_mm(),
            acceleration: machine.acceleration_mm_per_s2 * t.powi(2),
            jerk: machine.jerk_mm_per_s3 * t.powi(3),
            chord_error: machine.chord_error_mm,
            centripetal_acceleration: machine.centripetal_acceleration_mm_per_s2.map(|a| a * t.powi(2)),
            axes: axes.map(|axis| AxisLimits {
                velocity: axis.velocity_mm_per_s.map(|v| v * t),
                acceleration: axis.acceleration_mm_per_s2.map(|a| a * t.powi(2)),
                jerk: axis.jerk_mm_per_s3.map(|j| j * t.powi(3)),
            }),
            junction: match machine.junction {
                part_program::Junction::Stop => Junction::Stop,
                part_program::Junction::DeviationMm(deviation) => Junction::Deviation(deviation),
                part_program::Junction::VelocityJump => Junction::VelocityJump(
                    axes.map(|axis| axis.velocity_jump_mm_per_s.map_or(NO_JUMP, |jump| jump * t)),
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
    use crate::examples::on_example_machine;

    fn problem(program: &str) -> Problem<3> {
        on_example_machine(program, "")
    }

    /// The second curve that is run, behind a rapid move.
    #[test]
    fn a_curve_that_cannot_be_compiled_is_named_with_its_line() {
        let refusal = problem("G0 X0 Y0\nG1 X10 F600\nG0 X20\nG1 X40\n")
            .refusal(CompileError::OriginOutOfRange { curve: 1 });
        assert_eq!(refusal.to_string(), "p.nc:4: curve 1 lies beyond ±2^24 mm");
    }

    #[test]
    fn each_move_has_its_own_feedrate() {
        let problem = problem("G0 X0 Y0\nG1 X10 F600\nG0 X20\nG1 X40 F6000\nX60\n");
        assert_eq!((problem.feedrate_mm_per_s(), problem.machine.feedrate_mm_per_s), (100.0, 200.0));
        assert_eq!(problem.feeds_mm_per_s, [10.0, 100.0, 100.0]);
        assert_eq!(problem.at_feedrate(50.0).feeds_mm_per_s, [5.0, 50.0, 50.0]);
        let limit = problem.feed_limit().unwrap();
        let at = |distance: f64| limit.at(distance) / problem.period_s();
        assert!(
            (at(5.0) - 10.0).abs() < 1e-12 && (at(20.0) - 100.0).abs() < 1e-9,
            "{} {}",
            at(5.0),
            at(20.0)
        );
    }

    #[test]
    fn rapid_moves_are_left_out_and_curves_stay_where_they_are() {
        let problem = problem("G0 X0 Y0 Z5\nG0 X3 Y0\nG1 X10 F600\nG0 X20 Y7\nG1 X25 Z6\nG1 X25 Y9\nG0 Z5\n");
        assert_eq!((problem.rapids_left_out, problem.curves.len()), (3, 3));
        assert_eq!((problem.stops.as_slice(), problem.gaps), (&[1][..], 0));
        let ends: Vec<_> =
            problem.curves.iter().map(|c| (c.control_points()[0], c.control_points()[1])).collect();
        assert_eq!(ends[0], ([3.0, 0.0, 5.0], [10.0, 0.0, 5.0]));
        assert_eq!(ends[1], ([20.0, 7.0, 5.0], [25.0, 7.0, 6.0]));
        assert_eq!(ends[2], ([25.0, 7.0, 6.0], [25.0, 9.0, 6.0]));
    }

    /// The machine rests behind a lift, a gap in a drawing or an exact stop, even if the path goes straight on.
    #[test]
    fn the_machine_rests_where_it_makes_another_move() {
        let lifted = problem("G0 X0 Y0 Z0\nG1 X10 F600\nG0 Z5\nG0 Z0\nG1 X20\nG1 X30\n");
        assert_eq!((lifted.stops.as_slice(), lifted.gaps), (&[1][..], 0));
        let line = |from: f64, to: f64| {
            format!(
                "[[curve]]\ndegree = 1\nknots = [0, 0, 1, 1]\ncontrol_points_mm = [[{from}, 0], [{to}, 0]]\n"
            )
        };
        let drawn = [line(0.0, 10.0), line(20.0, 30.0), line(30.0, 40.0)].concat();
        let drawn: Problem<2> = on_example_machine(&drawn, "");
        assert_eq!((drawn.stops.as_slice(), drawn.gaps), (&[1][..], 1));
        let limit = drawn.feed_limit().unwrap();
        assert_eq!((limit.at(10.0), limit.at(20.0) > 0.1), (0.0, true));
    }

    /// `smooth` rested there, but plans and runs once passed these places at full feed.
    #[test]
    fn the_machine_rests_where_a_word_acts() {
        let stops = |text: &str| problem(text).stops;
        assert_eq!(stops("G0 X0 Y0 Z0\nM3 S900\nG1 X10 F600\nM8\nG1 X20\nG1 X30\nG1 X40\nM30\n"), [1]);
        // A word in the block of a move makes a rest on both sides of the move: some words act before the move and some
        // after it.
        assert_eq!(stops("G0 X0 Y0 Z0\nG1 X10 F600\nG1 X20\nG1 X30 M9\nG1 X40\nG1 X50\nM30\n"), [2, 3]);
        let limit = problem("G0 X0 Y0 Z0\nG1 X10 F600\nM8\nG1 X20\n").feed_limit().unwrap();
        let mut rests = limit.points().filter(|point| point.feedrate == 0.0);
        assert!(rests.any(|point| (point.distance - 10.0).abs() < 1e-12) && limit.at(5.0) > 0.0);
    }

    #[test]
    fn rapid_moves_alone_are_followed() {
        let problem = problem("G0 X0 Y0\nG0 X10\nG0 Y10\n");
        assert_eq!((problem.rapids_left_out, problem.curves.len()), (0, 2));
    }
}
