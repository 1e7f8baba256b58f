//! One stretch, planned and run twice: with a stop at each corner, and smoothed.

use std::ops::Range;

use nurbs_core::{
    Corner, CornerLambda, CornerOutcome, CornerStyle, Differentiate, Evaluate, PathCurve, PieceLimits,
    Reason, TrigSplineBuf, compile, curvature,
};
use part_program::{Curve, Machine, Move, Part};
use real::{Counted, OperationCounts};

use crate::deviation::Paths;
use crate::error::SmoothError;
use crate::options::Options;
use crate::report::{CornerKind, CornerRow, Forms, PathSummary, SetpointCheck, WithLambda1};
use crate::smooth_stretch::{LEAST_LOOPED_DEG, SmoothStretch};
use crate::stretch::{Rest, length, shape_of};
use crate::timing::Timed;

/// Parameters at which the two forms of a corner are compared, in addition to its begin.
const COMPARED: u32 = 64;
/// Places of a corner at which its curvature is computed.
const BENDS: u32 = 256;

/// A stretch with its two plans, its corners and the distances measured on it.
pub(crate) struct Followed {
    pub(crate) range: Range<usize>,
    pub(crate) path: Written,
    pub(crate) corners: Vec<CornerRow>,
    /// For each corner that is smoothed, its curve and the move before it.
    smoothed_corners: Vec<Option<(usize, usize)>>,
    pub(crate) exact_stop: PathSummary,
    pub(crate) smoothed: PathSummary,
    /// The stretch smoothed with λ = 1, if another λ was asked for.
    pub(crate) with_lambda_1: Option<PathSummary>,
    pub(crate) error_mm_max: f64,
    pub(crate) forms: Forms,
    pub(crate) setpoints: SetpointCheck,
}

/// The smoothed curves, each with the move of the stretch to which it belongs.
pub(crate) struct Written {
    pub(crate) curves: Vec<Curve>,
    pub(crate) move_of: Vec<usize>,
}

impl Followed {
    /// Smooths the moves of `range`, plans and follows them.
    pub(crate) fn new(
        part: &Part,
        range: Range<usize>,
        machine: &Machine,
        options: &Options,
        outer: Option<CornerStyle>,
    ) -> Result<Self, SmoothError> {
        let (curves, moves) = (&part.curves[range.clone()], &part.moves[range.clone()]);
        let smoothed = |lambda| -> Result<(SmoothStretch, Timed), SmoothError> {
            let smooth = SmoothStretch::new(curves, options.tolerance_mm, lambda, outer)?;
            let after = Timed::new(&smooth.curves, &smooth.path.curves, &moves[0], machine)?;
            Ok((smooth, after))
        };
        let is_plain = options.lambda == CornerLambda::default();
        let plain = if is_plain { None } else { Some(smoothed(CornerLambda::default())?) };
        let (mut smooth, mut after) = smoothed(options.lambda)?;
        let with_lambda_1 = plain.as_ref().map(|(smooth, plain)| summary(smooth.curves.len(), plain));
        let plain_corners = plain.as_ref().map_or_else(Vec::new, |(smooth, plain)| with_1(smooth, plain));
        if let Some(plain) = plain
            && options.lambda == CornerLambda::Auto
            && plain.1.time_s() <= after.time_s()
        {
            (smooth, after) = plain;
        }
        let paths = Paths::new(curves, &smooth.curves, &smooth.path.moves)?;
        let before = Timed::new(curves, &smooth.moves, &moves[0], machine)?;
        let rows = smooth.path.corners.iter().enumerate().map(|(index, corner)| {
            let with_lambda_1 = plain_corners.get(index).copied().flatten();
            let feed_before_mm_per_s = before.feed_at_end_of(corner.turn.before);
            let line = moves[corner.turn.before].line;
            let row = CornerRow { feed_before_mm_per_s, with_lambda_1, ..sharp(line, corner) };
            outcome_of(row, corner, &smooth, &after)
        });
        let corners = rows.collect();
        let smoothed_corners = smooth.path.corners.iter().map(|corner| match corner.outcome {
            CornerOutcome::Smoothed { curve, .. } => Some((curve, corner.turn.before)),
            CornerOutcome::Left(_) => None,
        });
        let setpoints = setpoints(&smooth, &paths, &after)?;
        let mut followed = Self {
            range,
            corners,
            smoothed_corners: smoothed_corners.collect(),
            exact_stop: summary(curves.len(), &before),
            smoothed: summary(smooth.curves.len(), &after),
            with_lambda_1,
            error_mm_max: 0.0,
            forms: forms(&smooth)?,
            setpoints,
            path: Written { curves: smooth.curves.clone(), move_of: smooth.path.moves.clone() },
        };
        followed.measure(&paths, |curve| curve..curve + 1);
        Ok(followed)
    }

    /// Measures the distances between the moves and the written path, in total and at each corner. `written` returns
    /// the curves of `paths` as which a smoothed curve is written.
    pub(crate) fn measure(&mut self, paths: &Paths<'_>, written: impl Fn(usize) -> Range<usize>) {
        let off = paths.of_curves();
        self.error_mm_max = off.iter().copied().fold(paths.of_moves(), f64::max);
        for (row, place) in self.corners.iter_mut().zip(&self.smoothed_corners) {
            let Some((curve, before)) = *place else { continue };
            let of_corner = paths.to_curves(before, &row.point_mm);
            row.measured_error_mm =
                off.get(written(curve)).unwrap_or_default().iter().copied().fold(of_corner, f64::max);
        }
    }
}

/// The row of a corner, as if it were left sharp.
fn sharp(line: usize, corner: &Corner<3>) -> CornerRow {
    CornerRow {
        line,
        point_mm: corner.turn.point,
        angle_deg: corner.turn.turn_rad.to_degrees(),
        kind: CornerKind::Left,
        reason: None,
        error_mm: 0.0,
        measured_error_mm: 0.0,
        feed_before_mm_per_s: 0.0,
        feed_after_mm_per_s: 0.0,
        lambda: None,
        least_radius_mm: None,
        with_lambda_1: None,
    }
}

/// The row with what became of its corner.
fn outcome_of(mut row: CornerRow, corner: &Corner<3>, smooth: &SmoothStretch, after: &Timed) -> CornerRow {
    match corner.outcome {
        CornerOutcome::Smoothed { style, curve, error_mm, lambda } => {
            row.kind = if style == CornerStyle::Loop { CornerKind::Loop } else { CornerKind::Cut };
            let is_too_shallow = style == CornerStyle::Cut && smooth.is_too_shallow(&corner.turn);
            row.reason = is_too_shallow.then(|| format!("outer, less than {LEAST_LOOPED_DEG}°"));
            row.error_mm = error_mm;
            row.feed_after_mm_per_s = after.lowest_feed_along(curve);
            row.lambda = Some(lambda);
            row.least_radius_mm = Some(least_radius_mm(&smooth.path.curves[curve]));
        }
        CornerOutcome::Left(reason) => {
            row.reason = Some(reason_of(reason));
            let next = smooth.path.moves.partition_point(|own| *own <= corner.turn.before);
            row.feed_after_mm_per_s = after.feed_at_end_of(next.saturating_sub(1));
        }
    }
    row
}

/// The corners of a stretch that is smoothed with λ = 1; `None` for those that are left sharp.
fn with_1(smooth: &SmoothStretch, timed: &Timed) -> Vec<Option<WithLambda1>> {
    let of = |corner: &Corner<3>| match corner.outcome {
        CornerOutcome::Smoothed { curve, .. } => Some(WithLambda1 {
            least_radius_mm: least_radius_mm(&smooth.path.curves[curve]),
            feed_after_mm_per_s: timed.lowest_feed_along(curve),
        }),
        CornerOutcome::Left(_) => None,
    };
    smooth.path.corners.iter().map(of).collect()
}

/// The least radius of a curve, in mm, at [`BENDS`] places.
fn least_radius_mm(curve: &PathCurve<f64, 3>) -> f64 {
    let (begin, end) = curve.domain();
    let place = |step: u32| begin + (end - begin) * f64::from(step) / f64::from(BENDS);
    1.0 / (0..=BENDS).map(|step| curvature(&curve.derivatives(place(step)))).fold(0.0, f64::max)
}

fn summary(curves: usize, timed: &Timed) -> PathSummary {
    PathSummary { curves, length_mm: timed.length_mm(), time_s: timed.time_s() }
}

/// The row of the corner before move `next`, at which the tool rests.
pub(crate) fn between(part: &Part, next: usize, rest: Rest) -> Result<Option<CornerRow>, SmoothError> {
    let ends = |index: usize| shape_of(&part.curves[index]);
    // Smoothing the two moves alone shows where they meet, and at which angle.
    let path =
        nurbs_core::smooth_corners(&[ends(next - 1)?, ends(next)?], 1.0, CornerLambda::default(), |_| None)?;
    let before: &Move = &part.moves[next - 1];
    let row = |corner: &Corner<3>| CornerRow { reason: Some(rest.to_string()), ..sharp(before.line, corner) };
    Ok(path.corners.first().map(row))
}

fn reason_of(reason: Reason) -> String {
    match reason {
        // Corners are left as `Wanted` only between rapid moves.
        Reason::Wanted => Rest::Machine(part_program::Rest::Rapid).to_string(),
        other => other.to_string(),
    }
}

/// Runs the smoothed stretch in f64, and measures each setpoint.
fn setpoints(smooth: &SmoothStretch, paths: &Paths<'_>, timed: &Timed) -> Result<SetpointCheck, SmoothError> {
    let run = timed.setpoints()?;
    let nurbs = smooth.curves.iter().map(Curve::for_evaluation).collect::<Result<Vec<_>, _>>()?;
    let mut check = SetpointCheck {
        count: run.steps.len(),
        finished: run.about.finished,
        total_acceleration_max_mm_per_s2: timed.total_acceleration_mm_per_s2(&run),
        ..SetpointCheck::default()
    };
    for step in &run.steps {
        // The distance to any one point of the path is an upper bound of the least distance.
        let on_path = match &smooth.path.curves[step.curve] {
            PathCurve::TrigSpline(spline) => spline.as_spline().point(step.u.0),
            _ => nurbs[step.curve].as_curve().point(step.u.0),
        };
        let off = length(&std::array::from_fn(|d| on_path[d] - step.point_mm[d]));
        check.off_path_mm_max = check.off_path_mm_max.max(off);
        check.off_moves_mm_max = check.off_moves_mm_max.max(paths.to_moves(step.curve, &step.point_mm));
    }
    for pair in run.steps.windows(2) {
        let ends = [&pair[0].point_mm, &pair[1].point_mm];
        let off = paths.chord_to_curves((pair[0].curve, pair[1].curve), ends);
        check.chord_error_mm_max = check.chord_error_mm_max.max(off);
    }
    Ok(check)
}

/// Compares the two forms of every corner.
fn forms(smooth: &SmoothStretch) -> Result<Forms, SmoothError> {
    let mut forms = Forms { distance_bound_mm: smooth.polynomial_bound_mm, ..Forms::default() };
    for (curve, written) in smooth.path.curves.iter().zip(&smooth.curves) {
        let PathCurve::TrigSpline(spline) = curve else { continue };
        let nurbs = written.for_evaluation()?;
        let (exact, polynomials) = (spline.as_spline(), nurbs.as_curve());
        forms.polynomials += polynomials.span_count();
        let (begin, end) = exact.domain();
        for step in 0..=COMPARED {
            let u = begin + (end - begin) * f64::from(step) / f64::from(COMPARED);
            let (a, b) = (exact.point(u), polynomials.point(u));
            forms.distance_mm_max = forms.distance_mm_max.max(length(&std::array::from_fn(|d| a[d] - b[d])));
        }
        if forms.polynomial_degree == 0 {
            forms.polynomial_degree = nurbs.degree();
            (forms.trigonometric_operations, forms.polynomial_operations) = operations(spline, &nurbs)?;
        }
    }
    Ok(forms)
}

/// Operations for a point by sine and cosine, and for a point on a compiled piece.
fn operations(
    spline: &TrigSplineBuf<f64, 3>,
    nurbs: &nurbs_core::NurbsBuf<f64, 3>,
) -> Result<(u64, u64), SmoothError> {
    let segment = spline.as_spline().segments()[0].convert::<Counted<f64>>()?;
    let limits = PieceLimits { length_mm: 32.0, step_mm: 1.0 };
    let table = compile::<f64, Counted<f64>, 3>(&[nurbs.as_curve()], &limits)?;
    let third = Counted(1.0 / 3.0);
    let (_, by_sine_and_cosine) = OperationCounts::of(|| segment.point(third));
    let (_, by_polynomial) = OperationCounts::of(|| table.as_pieces().offset(0, third));
    Ok((total(&by_sine_and_cosine), total(&by_polynomial)))
}

/// All arithmetic operations; a sum of products counts as the number of its terms.
fn total(counts: &OperationCounts) -> u64 {
    let OperationCounts {
        add, sub, neg, mul, mul_add, sum_of_products_terms, div, sqrt, scale, compare, ..
    } = counts;
    add + sub + neg + mul + mul_add + sum_of_products_terms + div + sqrt + scale + compare
}
