//! A run on compiled pieces.

use std::cell::Cell;
use std::ops::Range;

use nurbs_core::{NurbsBuf, ORIGIN_EXPONENT, PieceLimits, Pieces, PiecesBuf, Place, compile_with_stops};
use real::{Backend, DoubleDouble, Real, Recorded};
use secant_interp::{
    ChordTolerance, CompiledPath, CompiledPathError, LengthCursor, PieceSetpoint, StepLengths,
};

use crate::plan::in_format::{exact, in_format, of_pair};
use crate::problem::problem::Problem;
use crate::refusal::Refusal;
use crate::run::job::{Job, most_periods};
use crate::run::overrides::OverrideCommands;
use crate::run::recorded_run::RecordedRun;
use crate::run::run::{Run, RunStep, resolution_at, unit_in_last_place};

/// Additional periods that an overridden run may take at each stop: most stops take a dozen.
const LANDING: usize = 256;

/// Compiles path and plan for `R` and runs, landing on each stop on the way.
pub(crate) fn run<R: Backend, const D: usize>(job: &Job<'_, D>) -> Result<Run, Refusal> {
    let path = compiled::<R, D>(job)?;
    Ok(driven(job, &path, true))
}

/// Makes the same steps as [`run`] and keeps none of them.
pub(crate) fn step_through<R: Backend, const D: usize>(job: &Job<'_, D>) -> Result<(), Refusal> {
    let path = compiled::<R, D>(job)?;
    driven(job, &path, false);
    Ok(())
}

/// Runs a compiled path. Unless `keeps_steps`, the result has no steps.
fn driven<R: Backend, const D: usize>(job: &Job<'_, D>, path: &CompiledPath<R, D>, keeps_steps: bool) -> Run {
    let mut drive = Drive::new(job.problem, path.table(), job.plan.periods(), keeps_steps);
    if let Some(commands) = &job.options.overrides {
        run_overridden(path, commands, &mut drive);
        return drive.finish();
    }
    let mut lengths = job.plan.lengths();
    for (section, interpolator) in path.sections().iter().zip(path.runs()) {
        let mut state = interpolator.start();
        let mut planned = lengths.by_ref().take(interpolator.lengths.periods());
        drive.run(section.pieces.clone(), &mut planned, |_| interpolator.step(&mut state));
        planned.for_each(drop);
    }
    drive.finish()
}

/// Runs the path with the plan's time stretched by the overrides. The rate is carried over from section to section.
fn run_overridden<R: Backend, const D: usize>(
    path: &CompiledPath<R, D>,
    commands: &OverrideCommands,
    drive: &mut Drive<'_, R, D>,
) {
    // At most 2^24.
    drive.planned_periods = u32::try_from(commands.periods).unwrap_or(u32::MAX);
    drive.most_periods = most_periods(drive.planned_periods) + LANDING * path.sections().len();
    let mut rates = commands.start();
    for (section, interpolator) in path.sections().iter().zip(path.runs()) {
        let stages = commands.stages.get(section.stages.clone()).unwrap_or_default();
        let (own, mut cursor) = (StepLengths { stages }, LengthCursor::default());
        let (mut state, wanted) = (interpolator.start(), Cell::new(None));
        let lengths = std::iter::from_fn(|| wanted.take());
        drive.run(section.pieces.clone(), lengths, |period| {
            commands.command(period, &mut rates);
            let length = commands.feeds.advance(&own, &mut cursor, &mut { rates });
            wanted.set(length.map(|length| (length, length.value())));
            interpolator.step_overridden(&mut state, &commands.feeds, &mut rates)
        });
    }
}

/// The operations of each of the first `most` steps of the run that [`run`] makes without overrides. The state at the
/// begin of a section is computed before the section's first period.
pub(crate) fn record<R: Backend, const D: usize>(
    job: &Job<'_, D>,
    most: usize,
) -> Result<RecordedRun, Refusal> {
    let path = compiled::<Recorded<R>, D>(job)?;
    let runs = path.runs().map(|run| (run.start(), run));
    Ok(RecordedRun::of(most.min(job.most_periods()), runs, |run, state| run.step(state).is_some()))
}

/// Path and plan in `R`, as they lie in a controller's flash.
pub(crate) fn compiled<R: Backend, const D: usize>(job: &Job<'_, D>) -> Result<CompiledPath<R, D>, Refusal> {
    let Job { problem, plan, options } = job;
    let limits = problem.limits_per_period()?;
    let landing_step_mm = limits.acceleration;
    let curves: Vec<_> = problem.curves.iter().map(NurbsBuf::as_curve).collect();
    // With overrides, the plan is made for the highest of them, and a coarse format may round the feed up.
    let fastest = limits.feedrate.max(plan.greatest_feed());
    let piece_limits = PieceLimits { length_mm: options.piece_length_mm, step_mm: fastest + landing_step_mm };
    let stops: Vec<_> = plan.rests().collect();
    let table = compile_with_stops::<DoubleDouble, R, D>(&curves, &piece_limits, &stops)
        .map_err(|error| problem.refusal(error))?;
    in_format::<R>("acceleration", landing_step_mm.ldexp(table.as_pieces().chord_exponent))?;
    let tolerance = ChordTolerance::for_fluctuation(options.fluctuation, problem.machine.max_iterations);
    CompiledPath::new(table, &plan.schedule(), tolerance, landing_step_mm).map_err(|error| {
        let (what, value) = match error {
            CompiledPathError::FeedTooHigh { feed, .. } => ("stage feed", feed),
            CompiledPathError::LandingStepTooLong { step } => ("acceleration", step),
            _ => ("plan", f64::NAN),
        };
        Refusal::Limit { what, value, format: R::name() }
    })
}

/// Collects the setpoints of a run as steps in mm.
struct Drive<'a, R, const D: usize> {
    problem: &'a Problem<D>,
    table: &'a PiecesBuf<R, D>,
    planned_periods: u32,
    most_periods: usize,
    /// The periods so far.
    periods: usize,
    /// The steps of all of them; `None` if they are not kept.
    steps: Option<Vec<RunStep>>,
    /// The largest coordinate of an offset, in the table's units.
    farthest: f64,
    finished: bool,
}

impl<'a, R: Backend, const D: usize> Drive<'a, R, D> {
    fn new(
        problem: &'a Problem<D>,
        table: &'a PiecesBuf<R, D>,
        planned_periods: u32,
        keeps_steps: bool,
    ) -> Self {
        Self {
            problem,
            table,
            planned_periods,
            most_periods: most_periods(planned_periods),
            periods: 0,
            steps: keeps_steps.then(|| Vec::with_capacity(planned_periods as usize + 1)),
            farthest: 0.0,
            finished: true,
        }
    }

    /// Makes steps on some pieces until `step` gives no more setpoints; `planned` has the wanted distance of each
    /// period and the feed at its end.
    fn run(
        &mut self,
        pieces: Range<usize>,
        planned: impl IntoIterator<Item = (DoubleDouble, f64)>,
        mut step: impl FnMut(usize) -> Option<PieceSetpoint<R, D>>,
    ) {
        let (mut planned, per_second) = (planned.into_iter(), 1.0 / self.problem.period_s());
        let places = self.table.places().get(pieces.clone()).unwrap_or_default();
        let pieces = self.table.as_pieces().part(pieces);
        while self.finished {
            self.finished = self.periods < self.most_periods;
            let Some(setpoint) = step(self.periods) else { break };
            self.periods += 1;
            let Some(steps) = &mut self.steps else { continue };
            let length = exact(setpoint.length).ldexp(-pieces.chord_exponent);
            let (wanted, feed) = planned.next().unwrap_or((length, length.value()));
            let (curve, u) = parameter(places, &setpoint);
            self.farthest = setpoint.offset.iter().fold(self.farthest, |most, x| most.max(x.to_f64().abs()));
            steps.push(RunStep {
                curve,
                u,
                point_mm: point_mm(&pieces, &setpoint),
                wanted_mm: wanted.to_f64_pair(),
                feed_mm_per_s: feed * per_second,
                evaluations: setpoint.evaluations,
            });
        }
    }

    fn finish(self) -> Run {
        let pieces = self.table.as_pieces();
        let unit = 1.0.ldexp(pieces.coordinate_exponent);
        let full_step = self.problem.full_step_mm() * 1.0.ldexp(pieces.chord_exponent);
        Run {
            steps: self.steps.unwrap_or_default(),
            finished: self.finished,
            planned_periods: self.planned_periods,
            resolution_mm: unit * resolution_at::<R>(self.farthest),
            fluctuation_resolution: 0.5 * unit_in_last_place::<R>(full_step) / full_step,
            ..Run::default()
        }
    }
}

/// The curve and its parameter at a setpoint, computed exactly from piece and phase.
fn parameter<R: Backend, const D: usize>(
    places: &[Place],
    setpoint: &PieceSetpoint<R, D>,
) -> (usize, (f64, f64)) {
    let last = places.len() - 1;
    let place = &places[setpoint.piece.min(last)];
    if setpoint.piece > last {
        return (place.curve, place.end);
    }
    let [begin, end] = [place.begin, place.end].map(of_pair);
    let u = begin + (end - begin) * DoubleDouble::from_phase(setpoint.phase, 0);
    (place.curve, u.to_f64_pair())
}

/// The sum of origin and offset, in mm.
fn point_mm<R: Backend, const D: usize>(
    pieces: &Pieces<'_, R, D>,
    setpoint: &PieceSetpoint<R, D>,
) -> [f64; 3] {
    let origin = pieces.pieces[setpoint.piece.min(pieces.pieces.len() - 1)].origin;
    let mut point = [0.0; 3];
    for d in 0..D {
        let (high, low) = (origin[d] >> 32, origin[d] & 0xffff_ffff);
        let base =
            DoubleDouble::new((high as f64).ldexp(32 + ORIGIN_EXPONENT), (low as f64).ldexp(ORIGIN_EXPONENT));
        point[d] = (base + exact(setpoint.offset[d]).ldexp(pieces.coordinate_exponent)).value();
    }
    point
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::examples::on_example_machine;
    use crate::{ExactPlan, Options};
    use real::I8F24;

    /// On stairs of equal steps, every kind of period occurs more than once, including the one from rest and the one
    /// onto a stop.
    #[test]
    fn what_is_recorded_comes_to_rest_at_every_stop() {
        let problem = on_example_machine::<3>("G1 X16 F6000\nY16\nX32\nY32\nX48\nY48\n", "");
        let plan = ExactPlan::in_format::<f64, 3>(&problem, [0.0; 2]).unwrap();
        let job = Job { problem: &problem, plan: &plan, options: &Options::default() };
        let run = run::<I8F24, 3>(&job).unwrap();
        let recorded = record::<I8F24, 3>(&job, usize::MAX).unwrap();
        let counts: Vec<_> = recorded.steps.iter().map(|(_, count)| *count as usize).collect();
        assert_eq!(counts.iter().sum::<usize>(), run.steps.len());
        assert!(counts.iter().all(|count| *count > 1), "{counts:?}");
    }
}
