//! A run on compiled pieces.

use nurbs_core::{NurbsBuf, ORIGIN_EXPONENT, PieceLimits, PiecesBuf, compile};
use real::{Audit, Backend, DoubleDouble, Real, Recorded};
use secant_interp::{ChordTolerance, LengthStage, PieceInterpolator, PieceSetpoint, StepLengths};

use crate::exact_plan::{ExactPlan, nearest};
use crate::problem::Problem;
use crate::recorded::RecordedRun;
use crate::run::{Options, Refusal, Run, RunStep, most_periods, resolution_at, unit_in_last_place};

/// Compiles path and plan for `R` and runs.
pub(crate) fn run<R: Backend, const D: usize>(
    problem: &Problem<D>,
    plan: &ExactPlan,
    options: &Options,
) -> Result<Run, Refusal> {
    let prepared = Prepared::<R, D>::new(problem, plan, options)?;
    let interpolator = prepared.interpolator();
    let mut state = interpolator.start();
    let drive = Drive {
        table: &prepared.table,
        per_second: 1.0 / problem.period_s(),
        full_step_mm: problem.machine.feedrate_mm_per_s * problem.period_s(),
    };
    let Some(commands) = &options.overrides else {
        return Ok(drive.run(plan.periods(), plan.lengths(), |_| interpolator.step(&mut state)));
    };
    let mut rates = commands.start();
    let lengths = commands.lengths.iter().map(|length| (*length, length.value()));
    // At most 2^24.
    let periods = u32::try_from(lengths.len()).unwrap_or(u32::MAX);
    Ok(drive.run(periods, lengths, |period| {
        commands.command(period, &mut rates);
        interpolator.step_overridden(&mut state, &commands.feeds, &mut rates)
    }))
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
        let table: PiecesBuf<R, D> = compile::<DoubleDouble, R, D>(&curves, &piece_limits)?;
        let chord_exponent = table.as_pieces().chord_exponent;
        let chord_unit = 1.0.scale(chord_exponent);
        Ok(Self {
            stages: compiled_stages::<R>(plan, chord_exponent)?,
            tolerance: ChordTolerance {
                residual: residual::<R>(options.fluctuation),
                max_evaluations: problem.machine.max_iterations,
            },
            landing_step: crate::exact_plan::in_format("acceleration", landing_step_mm * chord_unit)?,
            table,
        })
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

/// The stages in units of the pieces' chords, and of 2⁻³² periods, on which the plan's joints lie.
fn compiled_stages<R: Backend>(
    plan: &ExactPlan,
    chord_exponent: i32,
) -> Result<Vec<LengthStage<R>>, Refusal> {
    let feed = |x: DoubleDouble| {
        let scaled = x.scale(chord_exponent);
        nearest::<R>(scaled).ok_or(Refusal::Limit {
            what: "stage feed",
            value: scaled.value(),
            format: R::name(),
        })
    };
    let mut stages = Vec::with_capacity(plan.schedule().stages().len());
    for stage in plan.schedule().stages() {
        let (from, to) = (feed(stage.start_feed)?, feed(stage.end_feed)?);
        let compiled = LengthStage::new(stage.duration.to_phase(-32), from, to - from);
        stages.extend(compiled.map(|compiled| compiled.shaped(stage.shape)));
    }
    Ok(stages)
}

/// Setpoints become steps in mm.
struct Drive<'a, R, const D: usize> {
    table: &'a PiecesBuf<R, D>,
    per_second: f64,
    /// F·T.
    full_step_mm: f64,
}

impl<R: Backend, const D: usize> Drive<'_, R, D> {
    /// Takes setpoints until there are none, beside the distance that each period wants and the feed at its end.
    fn run(
        &self,
        planned_periods: u32,
        mut planned: impl Iterator<Item = (DoubleDouble, f64)>,
        mut step: impl FnMut(usize) -> Option<PieceSetpoint<R, D>>,
    ) -> Run {
        let pieces = self.table.as_pieces();
        let mut steps = Vec::with_capacity(planned_periods as usize + 1);
        let mut finished = false;
        while steps.len() < most_periods(planned_periods) {
            let Some(setpoint) = step(steps.len()) else {
                finished = true;
                break;
            };
            let length = exact(setpoint.length).scale(-pieces.chord_exponent);
            let (wanted, feed) = planned.next().unwrap_or((length, length.value()));
            let (curve, u) = parameter(self.table, &setpoint);
            steps.push(RunStep {
                curve,
                u,
                point_mm: point_mm(self.table, &setpoint),
                wanted_mm: wanted.to_f64_pair(),
                feed_mm_per_s: feed * self.per_second,
                evaluations: setpoint.evaluations,
            });
        }
        // An offset is at most about a piece long, which is the unit.
        let unit = 1.0.scale(pieces.coordinate_exponent);
        let full_step = self.full_step_mm * 1.0.scale(pieces.chord_exponent);
        Run {
            steps,
            finished,
            planned_periods,
            resolution_mm: unit * resolution_at::<R>(1.0),
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
    table: &PiecesBuf<R, D>,
    setpoint: &PieceSetpoint<R, D>,
) -> (usize, (f64, f64)) {
    let last = table.places().len() - 1;
    let place = &table.places()[setpoint.piece.min(last)];
    if setpoint.piece > last {
        return (place.curve, place.end);
    }
    let (begin, end) =
        (DoubleDouble::new(place.begin.0, place.begin.1), DoubleDouble::new(place.end.0, place.end.1));
    let u = begin + (end - begin) * DoubleDouble::from_phase(setpoint.phase, 0);
    (place.curve, u.to_f64_pair())
}

/// Origin and offset together, in mm.
fn point_mm<R: Backend, const D: usize>(table: &PiecesBuf<R, D>, setpoint: &PieceSetpoint<R, D>) -> [f64; 3] {
    let pieces = table.as_pieces();
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
