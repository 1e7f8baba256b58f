//! A run as a table, with a row for each period.

use std::sync::{Mutex, PoisonError};

use nurbs_core::Evaluate;
use real::FormatName;
use serde::{Serialize, Serializer};

use crate::judge::judged_run::JudgedRun;
use crate::judge::judgement::Judgement;
use crate::judge::metrics::JudgedStep;
use crate::judge::reference::{Reached, Reference};
use crate::judge::stated_limits::stated_limits;
use crate::judge::tally::Tally;
use crate::problem::problem::Problem;
use crate::refusal::Refusal;
use crate::run::observer::Observer;
use crate::run::options::Options;
use crate::run::run::{AboutRun, RunStep};

/// One setpoint with the figures that the reference finds for it.
#[derive(Clone, Debug, Serialize)]
pub struct SetpointRow {
    /// Number of the period, from 1.
    pub step: u64,
    /// Time at the setpoint, in s.
    pub time_s: f64,
    /// Index of the knot span, over all curves.
    pub span: usize,
    /// Parameter within the span, in [0, 1].
    pub t: f64,
    /// Parameter of the curve.
    pub u: f64,
    /// The commanded point, in mm.
    pub point_mm: [f64; 3],
    /// The planned feed at the end of the period, in mm/s; with an override, the mean over the period.
    pub feed_mm_per_s: f64,
    /// The chord of this period, in mm.
    pub chord_mm: f64,
    /// Feedrate fluctuation, a ratio.
    pub fluctuation: f64,
    /// Evaluations of the curve.
    pub evaluations: u32,
    /// Each axis that moves beside the path, as `a_deg` or `u_mm`, with its place.
    #[serde(flatten, serialize_with = "as_fields")]
    pub side_axes: Vec<(&'static str, f64)>,
}

/// The places as fields of their row.
fn as_fields<S: Serializer>(places: &[(&'static str, f64)], serializer: S) -> Result<S::Ok, S::Error> {
    serializer.collect_map(places.iter().copied())
}

/// An observer that judges the periods, hands on a row for each, in order, and keeps none.
struct Rows<'a, const D: usize, S> {
    reference: &'a Reference<'a, D>,
    problem: &'a Problem<D>,
    spans_before: Vec<usize>,
    starts_at_rest: bool,
    state: Mutex<State<D, S>>,
}

struct State<const D: usize, S> {
    at: Reached<D>,
    tally: Tally,
    show: S,
}

impl<const D: usize> Reference<'_, D> {
    /// Makes the run in a format that `run` makes, hands `show` a row for each period, in order, and judges the run. With overrides the
    /// feed may be up to the highest of them.
    ///
    /// # Errors
    /// As `run`.
    pub fn show_setpoints(
        &self,
        problem: &Problem<D>,
        (format, options): (FormatName, &Options),
        run: impl FnOnce(&dyn Observer) -> Result<AboutRun, Refusal>,
        show: impl FnMut(&SetpointRow) + Send,
    ) -> Result<JudgedRun, Refusal> {
        let mut spans_before = vec![0];
        for curve in &problem.curves {
            spans_before.push(spans_before[spans_before.len() - 1] + curve.as_curve().span_count());
        }
        let highest = options.overrides.as_ref().map_or(1.0, |commands| commands.commanded_share().recip());
        let tally = Tally::new(problem.full_step_mm(), &stated_limits(problem, highest));
        let state = Mutex::new(State { at: self.start(), tally, show });
        let starts_at_rest = options.starts_at_rest();
        let rows = Rows { reference: self, problem, spans_before, starts_at_rest, state };
        let about = run(&rows)?;
        let State { at, tally, .. } = rows.state.into_inner().unwrap_or_else(PoisonError::into_inner);
        let judgement = Judgement { tally, end_error_mm: self.end_error_mm(&at), trace: None };
        Ok(JudgedRun::of((format, options.engine), problem, &about, &judgement))
    }
}

impl<const D: usize, S: FnMut(&SetpointRow)> Rows<'_, D, S> {
    fn row(&self, number: u64, step: &RunStep, judged: &JudgedStep) -> SetpointRow {
        let curve = self.problem.curves[step.curve].as_curve();
        let u = step.u.0;
        let span = curve.knots().span_number(u);
        let (begin, end) = curve.span_bounds(span);
        SetpointRow {
            step: number,
            time_s: number as f64 * self.problem.period_s(),
            span: self.spans_before[step.curve] + span,
            t: (u - begin) / (end - begin),
            u,
            point_mm: step.point_mm,
            feed_mm_per_s: step.feed_mm_per_s,
            chord_mm: judged.chord_mm,
            fluctuation: judged.fluctuation(),
            evaluations: step.evaluations,
            side_axes: self.problem.side_axes.columns(&self.problem.curves, step.curve, u),
        }
    }
}

impl<const D: usize, S: FnMut(&SetpointRow) + Send> Observer for Rows<'_, D, S> {
    fn goes_in_order(&self) -> bool {
        true
    }

    fn look(&self, _: usize, steps: &mut dyn Iterator<Item = RunStep>) {
        let mut state = self.state.lock().unwrap_or_else(PoisonError::into_inner);
        for step in steps {
            let State { at, tally, show } = &mut *state;
            let begins_at_rest = tally.steps > 0 || self.starts_at_rest;
            let judged = tally.judge_next(self.reference, at, &step, begins_at_rest);
            show(&self.row(tally.steps, &step, &judged));
        }
    }

    fn take(&self, _: usize) {}
}
