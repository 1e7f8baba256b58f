//! A run on compiled pieces; each step is checked.

use feed_plan::{Junction, Schedule};
use kernel_oracle::{ChordBound, PieceJudge, RIGHT_ANGLE, Violation, demand};
use nurbs_core::ORIGIN_EXPONENT;
use real::{Backend, Counted, OperationCounts, Real};
use secant_interp::{
    BEHIND_JOINT, ChordTolerance, CompiledPath, LengthStage, PieceInterpolator, PieceSetpoint,
};

use crate::PlannedPath;
use crate::next_setpoint::next_setpoint;
use crate::piece_points::{compiled, judge};
use crate::step_bound::{StepBound, StepShape};
use crate::violation::Outcome;

/// Path, plan and tolerances in `R`, ready to run.
pub struct OnPieces<'a, R, const D: usize> {
    planned: &'a PlannedPath<'a, D>,
    path: CompiledPath<R, D>,
}

/// The worst figures of a run, as shares of their bounds: all are at most 1.
#[derive(Clone, Copy, Debug, Default, PartialEq, serde::Serialize, serde::Deserialize)]
pub struct PieceFigures {
    /// Steps.
    pub periods: u64,
    /// Most evaluations in a step.
    pub evaluations: u64,
    /// Evaluations over their bound.
    pub evaluations_share: f64,
    /// Operations over their bound; 0 where they were not counted.
    pub operations_share: f64,
    /// Most operations in a step.
    pub operations: u64,
    /// Difference between chord and wanted chord, over its bound.
    pub length_share: f64,
    /// Chord error over the limit, less the distance by which steps that were not found have moved the run off its
    /// plan. It is taken where rounding has moved the run by at most an eighth of a chord.
    pub chord_error_share: f64,
    /// Steps over three pieces or more whose chord error is above the limit. A plan may miss a bend that is narrower
    /// than 2⁻²⁰ of a span ([`feed_plan::FeedLimit::along`]).
    pub narrow_bends: u64,
    /// The largest chord error of these steps, over the limit.
    pub narrow_bend_share: f64,
    /// Wanted chord over the longest chord that is allowed.
    pub feed_share: f64,
}

impl PieceFigures {
    /// The worse of two figures each, and the sums of the counts.
    #[must_use]
    pub fn with(self, other: &Self) -> Self {
        Self {
            periods: self.periods + other.periods,
            evaluations: self.evaluations.max(other.evaluations),
            operations: self.operations.max(other.operations),
            evaluations_share: self.evaluations_share.max(other.evaluations_share),
            operations_share: self.operations_share.max(other.operations_share),
            length_share: self.length_share.max(other.length_share),
            chord_error_share: self.chord_error_share.max(other.chord_error_share),
            narrow_bends: self.narrow_bends + other.narrow_bends,
            narrow_bend_share: self.narrow_bend_share.max(other.narrow_bend_share),
            feed_share: self.feed_share.max(other.feed_share),
        }
    }
}

impl<'a, R: Backend, const D: usize> OnPieces<'a, R, D> {
    /// Compiles path and plan for `R`.
    ///
    /// # Errors
    /// A text that says which number does not fit.
    pub fn new(planned: &'a PlannedPath<'a, D>) -> Result<Self, String> {
        let table = compiled::<R, D>(planned.path, &planned.stops())?;
        let tolerance = ChordTolerance::for_fluctuation(None, planned.path.max_evaluations);
        let stages = planned.stages();
        let plan = Schedule::new(&stages, 1.0, planned.periods());
        let path = CompiledPath::new(table, &plan, tolerance, planned.landing_step())
            .map_err(|error| format!("{error}: {}", R::name()))?;
        Ok(Self { planned, path })
    }

    /// The interpolator of the whole path, which does not land on stops.
    #[must_use]
    pub fn interpolator(&self) -> PieceInterpolator<'_, R, D> {
        self.path.interpolator()
    }

    /// Runs to the end, from stop to stop, and checks every step.
    ///
    /// # Errors
    /// The first promise that is broken.
    pub fn run(&self) -> Result<Outcome<PieceFigures>, Violation> {
        match judge(self.planned) {
            Ok(judge) => self.run_judged(&judge),
            Err(refusal) => Ok(Outcome::Refused(refusal)),
        }
    }

    /// Runs the path against a judge that the caller has already made.
    pub(crate) fn run_judged(&self, judge: &PieceJudge<D>) -> Result<Outcome<PieceFigures>, Violation> {
        let mut steps = Steps::new(self, judge);
        for (section, interpolator) in self.path.sections().iter().zip(self.path.runs()) {
            let mut state = interpolator.start();
            while let Some(setpoint) = next_setpoint(&interpolator, &mut state) {
                let piece = section.pieces.start + setpoint.piece;
                let lands = piece >= section.pieces.end || interpolator.lengths.is_over(state.cursor());
                steps.check(&PieceSetpoint { piece, ..setpoint }, lands)?;
            }
        }
        steps.finish().map(Outcome::Ran)
    }
}

impl<const D: usize> OnPieces<'_, Counted<f64>, D> {
    /// Runs to the end and counts the operations of each step.
    ///
    /// # Errors
    /// The first step that takes more operations than [`StepBound`] allows.
    pub fn count(&self) -> Result<Outcome<PieceFigures>, Violation> {
        let interpolator = self.interpolator();
        let stages = most_stages_in_a_period(self.path.stages());
        let pieces = interpolator.pieces;
        let mut state = interpolator.start();
        let mut at = 0;
        let mut worst = PieceFigures::default();
        let mut step = 0;
        loop {
            let (setpoint, counts) = OperationCounts::of(|| next_setpoint(&interpolator, &mut state));
            let Some(setpoint) = setpoint else { return Ok(Outcome::Ran(worst)) };
            let bound = StepBound::of(&StepShape {
                degree: pieces.degree,
                dimensions: D,
                rational: pieces.is_rational(),
                max_evaluations: interpolator.tolerance.max_evaluations,
                pieces: setpoint.piece + 1 - at,
                stages,
            });
            at = setpoint.piece;
            let total = counts.total();
            let share = demand("operations", "f64", step, total as f64, bound.operations as f64)?;
            worst.operations_share = worst.operations_share.max(share);
            worst.operations = worst.operations.max(total);
            step += 1;
            demand("steps until the end", "f64", step, step as f64, self.planned.most_periods() as f64)?;
        }
    }
}

/// The most stages that any one period touches.
fn most_stages_in_a_period<R>(stages: &[LengthStage<R>]) -> usize {
    let (mut time, mut first, mut most) = (0_u64, 0_u64, 1);
    let mut touched = 0;
    for stage in stages {
        if time >> 32 != first {
            (first, touched) = (time >> 32, 0);
        }
        touched += 1;
        most = most.max(touched);
        time += stage.duration;
        let last = time.saturating_sub(1) >> 32;
        if last != first {
            (first, touched) = (last, 1);
        }
    }
    // The part of the path behind the schedule's end is one stage more.
    most + 1
}

/// Checks step after step.
struct Steps<'a, R, const D: usize> {
    run: &'a OnPieces<'a, R, D>,
    judge: &'a PieceJudge<D>,
    name: String,
    at: (usize, u64),
    worst: PieceFigures,
    bound: ChordBound,
    /// The distance in mm that the run may be from its plan since it last landed.
    adrift: f64,
    /// The part of that distance that is not rounding: it comes from steps that were not found.
    astray: f64,
}

/// Cosine of a turn of 0.1° at a joint. Up to this turn the chord over the joint is checked against the chord error;
/// over a sharper one against the deviation, if the plan does not stop there.
const SMOOTH: f64 = 1.0 - 1.5e-6;
/// The factor by which the chord error may exceed its limit, as in a verdict: the planner lowers the feed where a chord would leave the path
/// by more than 1.004 times what is allowed.
const CHORD_ERROR_SHARE: f64 = 1.005;
/// Nor is the chord error checked where rounding may have moved the run along its path by more than this share of what is allowed.
const NEAR: f64 = 1.0 / 8.0;
/// The chord error of shorter chords is not checked. A run is within 1e-5 mm of its plan. In a bend so narrow that the
/// plan passes it with steps as short as this, the run is not at the planned place.
const SHORT_MM: f64 = 1e-4;
/// The chord error grows with the square of the chord. A chord that was not found is not checked if it is longer than
/// wanted by more than this part.
const TOO_LONG: f64 = 1.0 / 64.0;
/// The judge's own rounding, relative to a piece.
pub(crate) const JUDGE: f64 = 1e-13;
/// The part by which rounding may make a chord longer or shorter than that of its period's feed.
const FEED_SLACK: f64 = 1e-6;

fn fraction(phase: u64) -> f64 {
    f64::from_phase(phase, 0)
}

impl<'a, R: Backend, const D: usize> Steps<'a, R, D> {
    fn new(run: &'a OnPieces<'a, R, D>, judge: &'a PieceJudge<D>) -> Self {
        let pieces = run.path.table().as_pieces();
        let bound = ChordBound::of(&pieces);
        let worst = PieceFigures::default();
        Self { run, judge, name: R::name().to_string(), at: (0, 0), worst, bound, adrift: 0.0, astray: 0.0 }
    }

    fn check(&mut self, setpoint: &PieceSetpoint<R, D>, lands: bool) -> Result<(), Violation> {
        let step = usize::try_from(self.worst.periods).unwrap_or(usize::MAX);
        let planned = self.run.planned;
        demand("steps until the end", &self.name, step, step as f64 + 1.0, self.most_periods())?;
        let (from, to) = (self.at, (setpoint.piece, setpoint.phase));
        let back = f64::from(u8::from(to < from));
        demand("the position goes back", &self.name, step, back, 0.0)?;
        let touched = to.0 - from.0 + 1;
        let bound = u64::from(self.run.interpolator().tolerance.max_evaluations)
            + u64::from(BEHIND_JOINT) * (touched as u64 - 1);
        let evaluations = u64::from(setpoint.evaluations);
        let share = demand("evaluations", &self.name, step, evaluations as f64, bound as f64)?;
        let finite = setpoint.offset.iter().all(|x| x.is_finite()) && setpoint.length.is_finite();
        demand("a setpoint that is no number", &self.name, step, f64::from(u8::from(!finite)), 0.0)?;

        let limits = &planned.path.limits;
        let wanted = self.bound.in_mm(setpoint.length);
        let resolution = self.bound.resolution_mm(wanted);
        let longest = limits.feedrate * (1.0 + FEED_SLACK) + 2.0 * resolution;
        let feed = demand(
            "wanted chord, mm",
            &self.name,
            step,
            wanted,
            longest.max(limits.acceleration + resolution),
        )?;

        let worst = &mut self.worst;
        worst.periods += 1;
        worst.evaluations = worst.evaluations.max(evaluations);
        worst.evaluations_share = worst.evaluations_share.max(share);
        worst.feed_share = worst.feed_share.max(feed);
        self.at = to;
        if to.0 < self.judge.piece_count() {
            let converged = setpoint.evaluations < self.run.interpolator().tolerance.max_evaluations;
            self.check_chord(step, from, to, wanted, (converged, lands))?;
        }
        // A landing step that does not arrive leaves the run as far behind its plan as the step is long.
        if lands && to.1 == 0 {
            (self.adrift, self.astray) = (0.0, 0.0);
        }
        Ok(())
    }

    /// Number of periods after which the run must be over. Each period may lose a few units of a fixed format. The run
    /// travels the sum of these losses in landing steps, or in steps of one unit where that is longer.
    fn most_periods(&self) -> f64 {
        let lost = self.bound.lost_in_a_period(self.run.interpolator().landing_step);
        let planned = self.run.planned;
        (planned.most_periods() as f64).max(planned.periods() as f64 * (1.0 + lost))
    }

    /// Checks the length of a chord that does not land, and the chord error of any chord.
    fn check_chord(
        &mut self,
        step: usize,
        from: (usize, u64),
        to: (usize, u64),
        wanted: f64,
        (converged, lands): (bool, bool),
    ) -> Result<(), Violation> {
        let (from, to) = ((from.0, fraction(from.1)), (to.0, fraction(to.1)));
        let (start, end) = (self.judge.point(from.0, from.1, from.0), self.judge.point(to.0, to.1, from.0));
        let chord = self.judge.step_length(from, to);
        let joints = to.0 - from.0;
        let resolution = self.bound.resolution_mm(wanted);
        let piece = self.run.planned.path.piece_mm;
        let bound = self.bound.chord_mm(wanted, joints)
            + JUDGE * piece
            + if joints > 0 {
                4.0 * 1.0_f64.ldexp(ORIGIN_EXPONENT)
            } else {
                // Phases are converted to f64: where a piece is fast, a unit of their last place is a noticeable
                // length.
                2.0 * f64::EPSILON * chord / (to.1 - from.1).max(f64::MIN_POSITIVE)
            };
        let turns = self.judge.turns(from, to);
        let row = self.run.path.table().as_pieces().pieces.get(to.0);
        let is_found = converged && !lands && turns.leave_in_reach(row);
        if is_found {
            let share =
                demand("chord off the wanted one, mm", &self.name, step, (chord - wanted).abs(), bound)?;
            self.worst.length_share = self.worst.length_share.max(share);
        }
        let limits = &self.run.planned.path.limits;
        // Each step is off its plan by a rounding; in a slow run at one feed the sign is always the same. A step that
        // was not found, because evaluations ran out, the path comes back or turns out of the solver's reach, is off by its
        // whole error of length, and may end behind a hairpin instead of in front of it. A step that was found may do so too if the run is off its
        // plan already, because it reaches the hairpin at the feed of another place. Such a step is off by no more than
        // its whole way.
        let off = if is_found || lands { 0.0 } else { (chord - wanted).abs() };
        self.astray += off;
        let comes_back = turns.in_all <= RIGHT_ANGLE && !lands;
        let behind = if comes_back && self.astray > bound { self.judge.way(from, to) } else { 0.0 };
        self.astray += behind;
        self.adrift += resolution + off + behind;
        let is_in_place = self.adrift <= wanted / 8.0 && (lands || chord <= wanted * (1.0 + TOO_LONG));
        let is_smooth = turns.at_joint > SMOOTH;
        // A corner may be cut by the deviation. Where an axis' velocity may jump, no limit says by how much it may be
        // cut.
        let allowed_mm = match limits.junction {
            Junction::Deviation(deviation) if !is_smooth => Some(limits.chord_error.max(deviation)),
            _ => is_smooth.then_some(limits.chord_error),
        };
        // Rounding may have moved a run from its plan by more than tells of the chord error.
        let is_near = |allowed_mm: &f64| self.adrift - self.astray <= allowed_mm * NEAR;
        let allowed_mm = allowed_mm.filter(is_near);
        if let Some(allowed_mm) = allowed_mm.filter(|_| is_in_place && wanted > SHORT_MM) {
            // If both ends of a chord are moved along the path, its error grows by no more than they are moved.
            let error = self.judge.chord_error((from, &start), (to, &end)) - self.astray;
            let share = error / allowed_mm;
            if to.0 - from.0 > 1 {
                // The path bends within a fraction of a step: the plan may not have seen it.
                self.worst.narrow_bends += u64::from(share > CHORD_ERROR_SHARE);
                self.worst.narrow_bend_share = self.worst.narrow_bend_share.max(share);
            } else {
                let allowed = allowed_mm * CHORD_ERROR_SHARE + 4.0 * resolution + JUDGE * piece;
                let what = if is_smooth { "chord error, mm" } else { "corner cut by, mm" };
                demand(what, &self.name, step, error, allowed)?;
                self.worst.chord_error_share = self.worst.chord_error_share.max(share);
            }
        }
        Ok(())
    }

    fn finish(self) -> Result<PieceFigures, Violation> {
        let steps = usize::try_from(self.worst.periods).unwrap_or(usize::MAX);
        let missing = f64::from(u8::from(self.at != (self.judge.piece_count(), 0)));
        demand("the end is missed", &self.name, steps, missing, 0.0)?;
        Ok(self.worst)
    }
}
