//! A run as a table, with a row for each period.

use nurbs_core::Evaluate;
use serde::Serialize;

use crate::judge::reference::Reference;
use crate::problem::problem::Problem;
use crate::run::run::Run;

/// One setpoint with the figures that the reference finds for it.
#[derive(Clone, Debug, Serialize)]
pub struct SetpointRow {
    /// Number of the period, from 1.
    pub step: usize,
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
}

/// A run as rows.
pub type SetpointTable = Vec<SetpointRow>;

impl<const D: usize> Reference<D> {
    /// The table of a run.
    #[must_use]
    pub fn setpoints(&self, problem: &Problem<D>, run: &Run) -> SetpointTable {
        let mut spans_before = vec![0];
        for curve in &problem.curves {
            spans_before.push(spans_before[spans_before.len() - 1] + curve.as_curve().span_count());
        }
        let rows = run.steps.iter().zip(self.judge(run)).enumerate();
        rows.map(|(index, (step, judged))| {
            let curve = problem.curves[step.curve].as_curve();
            let u = step.u.0;
            let span = curve.knots().span_number(u);
            let (begin, end) = curve.span_bounds(span);
            SetpointRow {
                step: index + 1,
                time_s: (index + 1) as f64 * problem.period_s(),
                span: spans_before[step.curve] + span,
                t: (u - begin) / (end - begin),
                u,
                point_mm: step.point_mm,
                feed_mm_per_s: step.feed_mm_per_s,
                chord_mm: judged.chord_mm,
                fluctuation: judged.fluctuation(),
                evaluations: step.evaluations,
            }
        })
        .collect()
    }
}
