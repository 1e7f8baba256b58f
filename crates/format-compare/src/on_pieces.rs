//! A run on compiled pieces.

use nurbs_core::{NurbsBuf, ORIGIN_EXPONENT, PieceLimits, Pieces, PiecesBuf, Place, compile_with_stops};
use real::{Audit, Backend, DoubleDouble, Real, Recorded};
use secant_interp::{
    ChordTolerance, LengthStage, PieceInterpolator, PieceSetpoint, StepLengths, Stretch, stretches,
};

use crate::exact_plan::{ExactPlan, Rest, nearest};
use crate::problem::Problem;
use crate::recorded::RecordedRun;
use crate::run::{Options, Refusal, Run, RunStep, most_periods, resolution_at, unit_in_last_place};

/// Compiles path and plan for `R` and runs, landing on each stop on the way.
pub(crate) fn run<R: Backend, const D: usize>(
    problem: &Problem<D>,
    plan: &ExactPlan,
    options: &Options,
) -> Result<Run, Refusal> {
    let prepared = Prepared::<R, D>::new(problem, plan, options)?;
    let path = prepared.interpolator();
    let mut drive = Drive::new(problem, &prepared.table, plan.periods());
    if let Some(commands) = &options.overrides {
        let (mut state, mut rates) = (path.start(), commands.start());
        let lengths = commands.lengths.iter().map(|length| (*length, length.value()));
        // At most 2^24.
        drive.planned_periods = u32::try_from(commands.lengths.len()).unwrap_or(u32::MAX);
        drive.run(&prepared.whole(), lengths, |period| {
            commands.command(period, &mut rates);
            path.step_overridden(&mut state, &commands.feeds, &mut rates)
        });
        return Ok(drive.finish());
    }
    let mut lengths = plan.lengths();
    for stretch in &prepared.stretches {
        let interpolator = path.on(stretch);
        let mut state = interpolator.start();
        let planned: Vec<_> = lengths.by_ref().take(interpolator.lengths.periods()).collect();
        drive.run(stretch, planned, |_| interpolator.step(&mut state));
    }
    Ok(drive.finish())
}

/// The operations of each of the first `most` steps of the same run.
pub(crate) fn record<R: Backend, const D: usize>(
    problem: &Problem<D>,
    plan: &ExactPlan,
    options: &Options,
    most: usize,
) -> Result<RecordedRun, Refusal> {
    let prepared = Prepared::<Recorded<R>, D>::new(problem, plan, options)?;
    let interpolator = prepared.interpolator();
    let mut state = interpolator.start();
    Ok(RecordedRun::of(most.min(most_periods(plan.periods())), || interpolator.step(&mut state).is_some()))
}

/// Path, stages and tolerances in `R`: what lies in a controller's flash.
struct Prepared<R, const D: usize> {
    table: PiecesBuf<R, D>,
    stages: Vec<LengthStage<R>>,
    stretches: Vec<Stretch>,
    tolerance: ChordTolerance<R>,
    landing_step: R,
}

impl<R: Backend, const D: usize> Prepared<R, D> {
    fn new(problem: &Problem<D>, plan: &ExactPlan, options: &Options) -> Result<Self, Refusal> {
        let limits = problem.limits_per_period()?;
        let landing_step_mm = limits.acceleration;
        let curves: Vec<_> = problem.curves.iter().map(NurbsBuf::as_curve).collect();
        let piece_limits =
            PieceLimits { length_mm: options.piece_length_mm, step_mm: limits.feedrate + landing_step_mm };
        let stops: Vec<_> = plan.rests().flatten().collect();
        let table = compile_with_stops::<DoubleDouble, R, D>(&curves, &piece_limits, &stops)?;
        let chord_exponent = table.as_pieces().chord_exponent;
        let chord_unit = 1.0.scale(chord_exponent);
        let (stages, rests) = compiled_stages::<R>(plan, chord_exponent)?;
        let joints = rests.into_iter().map(|rest| rest.and_then(|(curve, u)| table.joint(curve, u)));
        Ok(Self {
            stages,
            stretches: stretches(joints, table.places().len()).collect(),
            tolerance: ChordTolerance {
                residual: residual::<R>(options.fluctuation),
                max_evaluations: problem.machine.max_iterations,
            },
            landing_step: crate::exact_plan::in_format("acceleration", landing_step_mm * chord_unit)?,
            table,
        })
    }

    /// The path as one stretch.
    fn whole(&self) -> Stretch {
        Stretch { pieces: 0..self.table.places().len(), stages: 0..self.stages.len() }
    }

    fn interpolator(&self) -> PieceInterpolator<'_, R, D> {
        PieceInterpolator {
            pieces: self.table.as_pieces(),
            lengths: StepLengths { stages: &self.stages },
            tolerance: self.tolerance,
            landing_step: self.landing_step,
        }
    }
}

/// The residual whose one correction leaves at most this fluctuation.
///
/// A correction leaves an error of about |f| (|f| + |g|)³, with the growth g of the parametric speed over a step a few
/// hundredths at most; measured, 2e-5 |f| on tightly curved rational parts, and |f|² where f itself is large. No
/// tolerance is finer than a few units of the format's resolution.
fn residual<R: Backend>(fluctuation: Option<f64>) -> R {
    let finest = R::resolution() + R::resolution();
    let wanted = fluctuation.map_or(0.0, |wanted| wanted.sqrt().min(1e4 * wanted));
    R::from_f64(wanted).unwrap_or(finest).max(finest)
}

/// The stages in units of the pieces' chords, and of 2⁻³² periods, on which the plan's joints lie; each with curve and
/// parameter where it comes to rest.
fn compiled_stages<R: Backend>(
    plan: &ExactPlan,
    chord_exponent: i32,
) -> Result<(Vec<LengthStage<R>>, Vec<Rest>), Refusal> {
    let feed = |x: DoubleDouble| {
        let scaled = x.scale(chord_exponent);
        nearest::<R>(scaled).ok_or(Refusal::Limit {
            what: "stage feed",
            value: scaled.value(),
            format: R::name(),
        })
    };
    let (mut stages, mut rests) = (Vec::new(), Vec::new());
    for (stage, rest) in plan.schedule().stages().iter().zip(plan.rests()) {
        let (from, to) = (feed(stage.start_feed)?, feed(stage.end_feed)?);
        if let Some(compiled) = LengthStage::new(stage.duration.to_phase(-32), from, to - from) {
            stages.push(compiled.shaped(stage.shape));
            rests.push(rest);
        }
    }
    Ok((stages, rests))
}

/// Setpoints become steps in mm.
struct Drive<'a, R, const D: usize> {
    table: &'a PiecesBuf<R, D>,
    per_second: f64,
    /// F·T.
    full_step_mm: f64,
    planned_periods: u32,
    steps: Vec<RunStep>,
    /// The largest coordinate of an offset, in the table's units.
    farthest: f64,
    finished: bool,
}

impl<'a, R: Backend, const D: usize> Drive<'a, R, D> {
    fn new(problem: &Problem<D>, table: &'a PiecesBuf<R, D>, planned_periods: u32) -> Self {
        Self {
            table,
            per_second: 1.0 / problem.period_s(),
            full_step_mm: problem.machine.feedrate_mm_per_s * problem.period_s(),
            planned_periods,
            steps: Vec::with_capacity(planned_periods as usize + 1),
            farthest: 0.0,
            finished: true,
        }
    }

    /// Takes the setpoints of a stretch until there are none, beside the distance that each period wants and the feed at
    /// its end.
    fn run(
        &mut self,
        stretch: &Stretch,
        planned: impl IntoIterator<Item = (DoubleDouble, f64)>,
        mut step: impl FnMut(usize) -> Option<PieceSetpoint<R, D>>,
    ) {
        let mut planned = planned.into_iter();
        let pieces = self.table.as_pieces().part(stretch.pieces.clone());
        let places = self.table.places().get(stretch.pieces.clone()).unwrap_or_default();
        while self.finished {
            self.finished = self.steps.len() < most_periods(self.planned_periods);
            let Some(setpoint) = step(self.steps.len()) else { break };
            let length = exact(setpoint.length).scale(-pieces.chord_exponent);
            let (wanted, feed) = planned.next().unwrap_or((length, length.value()));
            let (curve, u) = parameter(places, &setpoint);
            self.farthest = setpoint.offset.iter().fold(self.farthest, |most, x| most.max(x.to_f64().abs()));
            self.steps.push(RunStep {
                curve,
                u,
                point_mm: point_mm(&pieces, &setpoint),
                wanted_mm: wanted.to_f64_pair(),
                feed_mm_per_s: feed * self.per_second,
                evaluations: setpoint.evaluations,
            });
        }
    }

    fn finish(self) -> Run {
        let pieces = self.table.as_pieces();
        let unit = 1.0.scale(pieces.coordinate_exponent);
        let full_step = self.full_step_mm * 1.0.scale(pieces.chord_exponent);
        Run {
            steps: self.steps,
            finished: self.finished,
            planned_periods: self.planned_periods,
            resolution_mm: unit * resolution_at::<R>(self.farthest),
            fluctuation_resolution: 0.5 * unit_in_last_place::<R>(full_step) / full_step,
            audit: Audit::default(),
        }
    }
}

fn exact<R: Backend>(x: R) -> DoubleDouble {
    let (high, low) = x.to_f64_pair();
    DoubleDouble::new(high, low)
}

/// The curve and its parameter at a setpoint, exactly as piece and phase say.
fn parameter<R: Backend, const D: usize>(
    places: &[Place],
    setpoint: &PieceSetpoint<R, D>,
) -> (usize, (f64, f64)) {
    let last = places.len() - 1;
    let place = &places[setpoint.piece.min(last)];
    if setpoint.piece > last {
        return (place.curve, place.end);
    }
    let (begin, end) =
        (DoubleDouble::new(place.begin.0, place.begin.1), DoubleDouble::new(place.end.0, place.end.1));
    let u = begin + (end - begin) * DoubleDouble::from_phase(setpoint.phase, 0);
    (place.curve, u.to_f64_pair())
}

/// Origin and offset together, in mm.
fn point_mm<R: Backend, const D: usize>(
    pieces: &Pieces<'_, R, D>,
    setpoint: &PieceSetpoint<R, D>,
) -> [f64; 3] {
    let origin = pieces.pieces[setpoint.piece.min(pieces.pieces.len() - 1)].origin;
    let mut point = [0.0; 3];
    for d in 0..D {
        let (high, low) = (origin[d] >> 32, origin[d] & 0xffff_ffff);
        let base =
            DoubleDouble::new((high as f64).scale(32 + ORIGIN_EXPONENT), (low as f64).scale(ORIGIN_EXPONENT));
        point[d] = (base + exact(setpoint.offset[d]).scale(pieces.coordinate_exponent)).value();
    }
    point
}
