//! The steps of a run on pieces, in mm.

use std::iter::Take;
use std::ops::Range;

use nurbs_core::{ORIGIN_EXPONENT, Pieces, Place};
use real::{Backend, DoubleDouble, Real};
use secant_interp::{
    CompiledPath, LengthCursor, OverrideState, PieceInterpolator, PieceSetpoint, PieceState, StepLengths,
};

use crate::plan::in_format::{exact, of_pair};
use crate::plan::lengths::Lengths;
use crate::run::job::{Job, MOST_LATE, most_of_section, most_periods};
use crate::run::observer::Stretch;
use crate::run::overrides::OverrideCommands;
use crate::run::run::RunStep;

/// What is known of a part of a run after its last step.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Outcome {
    pub(crate) periods: u64,
    /// The largest coordinate of an offset, in the table's units.
    pub(crate) farthest: f64,
    /// Whether every section ended within the periods that it may take.
    pub(crate) finished: bool,
}

impl Default for Outcome {
    fn default() -> Self {
        Self { periods: 0, farthest: 0.0, finished: true }
    }
}

impl Outcome {
    pub(crate) fn join(&mut self, other: Self) {
        self.periods += other.periods;
        self.farthest = self.farthest.max(other.farthest);
        self.finished &= other.finished;
    }
}

/// The run of one section.
struct OnSection<'a, R, const D: usize> {
    interpolator: PieceInterpolator<'a, R, D>,
    places: &'a [Place],
    state: PieceState<R, D>,
    per_second: f64,
}

impl<'a, R: Backend, const D: usize> OnSection<'a, R, D> {
    fn new(job: &Job<'_, D>, path: &'a CompiledPath<R, D>, section: usize) -> Option<Self> {
        let section = path.sections().get(section)?;
        let interpolator = path.interpolator().on(section);
        let places = path.table().places().get(section.pieces.clone()).unwrap_or_default();
        let state = interpolator.start();
        Some(Self { interpolator, places, state, per_second: 1.0 / job.problem.period_s() })
    }

    /// A setpoint as a step; `planned` is the wanted distance of the period and the feed at its end.
    fn step(
        &self,
        setpoint: &PieceSetpoint<R, D>,
        planned: Option<(DoubleDouble, f64)>,
        outcome: &mut Outcome,
    ) -> RunStep {
        let pieces = &self.interpolator.pieces;
        let length = || exact(setpoint.length).ldexp(-pieces.chord_exponent);
        let (wanted, feed) = planned.unwrap_or_else(|| (length(), length().value()));
        let (curve, u) = parameter(self.places, setpoint);
        outcome.periods += 1;
        outcome.farthest =
            setpoint.offset.iter().fold(outcome.farthest, |most, x| most.max(x.to_f64().abs()));
        RunStep {
            curve,
            u,
            point_mm: point_mm(pieces, setpoint),
            wanted_mm: wanted.to_f64_pair(),
            feed_mm_per_s: feed * self.per_second,
            evaluations: setpoint.evaluations,
        }
    }
}

/// The steps of a stretch of sections, one section after the other.
pub(crate) struct Steps<'a, R, const D: usize> {
    job: &'a Job<'a, D>,
    path: &'a CompiledPath<R, D>,
    /// The sections that are left, and the period of the plan with which the first of them begins.
    sections: Range<usize>,
    period: u64,
    current: Option<Current<'a, R, D>>,
    pub(crate) outcome: Outcome,
}

/// The section that is run.
struct Current<'a, R, const D: usize> {
    on: OnSection<'a, R, D>,
    planned: Take<Lengths<'a>>,
    /// Periods after which the run is given up.
    most: u64,
}

impl<'a, R: Backend, const D: usize> Steps<'a, R, D> {
    pub(crate) fn new(job: &'a Job<'a, D>, path: &'a CompiledPath<R, D>, stretch: &Stretch) -> Self {
        let (sections, period) = (stretch.sections.clone(), stretch.first_period);
        Self { job, path, sections, period, current: None, outcome: Outcome::default() }
    }

    /// Begins the next section; `None` if there is none.
    fn begin(&mut self) -> Option<()> {
        let on = OnSection::new(self.job, self.path, self.sections.next()?)?;
        let periods = on.interpolator.lengths.periods();
        let planned = self.job.plan.lengths_from(self.period).take(periods);
        self.period += periods as u64;
        self.current = Some(Current { on, planned, most: most_of_section(periods as u64) });
        Some(())
    }
}

impl<R: Backend, const D: usize> Iterator for Steps<'_, R, D> {
    type Item = RunStep;

    fn next(&mut self) -> Option<RunStep> {
        while self.outcome.finished {
            let Some(Current { on, planned, most }) = &mut self.current else {
                self.begin()?;
                continue;
            };
            if let Some(setpoint) = on.interpolator.step(&mut on.state) {
                self.outcome.finished = *most > 0 && !self.job.options.is_interrupted();
                *most = most.saturating_sub(1);
                let planned = planned.next().map(|(length, feed)| (length, feed.value()));
                return Some(on.step(&setpoint, planned, &mut self.outcome));
            }
            self.current = None;
        }
        None
    }
}

/// The steps of a path with the plan's time stretched by overrides. The rate is carried over from section to section.
pub(crate) struct OverriddenSteps<'a, R, const D: usize> {
    job: &'a Job<'a, D>,
    path: &'a CompiledPath<R, D>,
    commands: &'a OverrideCommands,
    rates: OverrideState,
    /// The number of the next section.
    section: usize,
    /// The section that is run, and the place in its plan.
    current: Option<(OnSection<'a, R, D>, StepLengths<'a, DoubleDouble>, LengthCursor)>,
    most: u64,
    pub(crate) outcome: Outcome,
}

impl<'a, R: Backend, const D: usize> OverriddenSteps<'a, R, D> {
    pub(crate) fn new(
        job: &'a Job<'a, D>,
        path: &'a CompiledPath<R, D>,
        commands: &'a OverrideCommands,
    ) -> Self {
        let most = most_periods(commands.periods) + MOST_LATE * path.sections().len() as u64;
        let (rates, outcome) = (commands.start(), Outcome::default());
        Self { job, path, commands, rates, section: 0, current: None, most, outcome }
    }

    fn begin(&mut self) -> Option<()> {
        let section = OnSection::new(self.job, self.path, self.section)?;
        let stages = self.path.sections().get(self.section)?.stages.clone();
        let stages = self.commands.stages.get(stages).unwrap_or_default();
        self.current = Some((section, StepLengths { stages, crossings: &[] }, LengthCursor::default()));
        self.section += 1;
        Some(())
    }
}

impl<R: Backend, const D: usize> Iterator for OverriddenSteps<'_, R, D> {
    type Item = RunStep;

    fn next(&mut self) -> Option<RunStep> {
        while self.outcome.finished {
            let Some((section, own, cursor)) = &mut self.current else {
                self.begin()?;
                continue;
            };
            self.commands.command(self.outcome.periods, &mut self.rates);
            let feeds = &self.commands.feeds;
            let wanted = feeds.advance(own, cursor, &mut { self.rates });
            let setpoint = section.interpolator.step_overridden(&mut section.state, feeds, &mut self.rates);
            if let Some(setpoint) = setpoint {
                self.outcome.finished =
                    self.outcome.periods < self.most && !self.job.options.is_interrupted();
                let planned = wanted.map(|length| (length, length.value()));
                return Some(section.step(&setpoint, planned, &mut self.outcome));
            }
            self.current = None;
        }
        None
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
