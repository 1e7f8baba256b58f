//! SPLINE, by control points or by the points it passes through.

use super::fit::{Ends, through};
use super::groups::Entity;
use super::item::Item;
use crate::clamp::{clamped, is_of_clamping, merge_knots};
use crate::curve::{Curve, Nurbs};
use crate::curve_fault::CurveFault;
use crate::diagnostic::Report;
use crate::moves::Shape;
use crate::source::Span;
use crate::spline_blocks::SplineBlocks;
use crate::vector::{difference, length, unit};

/// A share of the extent of the points. A point closer than this to the one before counts as the same point.
const SAME_POINT: f64 = 1e-12;
/// Bit of group 70.
const CLOSED: u32 = 1;

/// Reads a SPLINE. Returns whether the drawing leaves its ends free, so that CAD systems may differ there.
pub(crate) fn read<'t>(entity: &Entity<'t>, report: &mut Report<'_>, items: &mut Vec<Item<'t>>) -> bool {
    let points = entity.points(report, 10);
    if points.is_empty() {
        return by_fit_points(entity, report, items);
    }
    if let Some(curve) = by_control_points(entity, points, report) {
        match clamped(curve) {
            Some(curves) => items.extend(curves.into_iter().map(|curve| drawn(curve.into(), entity.span))),
            None => {
                report.error(entity.span, "the parameter of this SPLINE has no range").expected(
                    "the knot behind the last point to be greater than the one before the first span",
                );
            }
        }
    }
    false
}

/// The curve with the entity's numbers; its knots may not be clamped.
fn by_control_points(
    entity: &Entity<'_>,
    points: Vec<([f64; 3], Span)>,
    report: &mut Report<'_>,
) -> Option<Nurbs> {
    let weights = entity.numbers(report, 41);
    let mut knots = entity.numbers(report, 40);
    check_counts(entity, [(72, "knots", knots.len()), (73, "control points", points.len())], report);
    let degree = entity.needed(report, 71, "degree")?;
    let numbers = points.iter().flat_map(|(point, _)| point);
    if numbers.chain(weights.iter().chain(&knots).map(|(number, _)| number)).any(|number| number.is_nan()) {
        // The number has been reported as invalid.
        return None;
    }
    let mut values: Vec<_> = knots.iter().map(|(knot, _)| *knot).collect();
    merge_knots(&mut values, entity.number(report, 42).filter(|tolerance| *tolerance > 0.0));
    for ((knot, _), merged) in knots.iter_mut().zip(values) {
        *knot = merged;
    }
    let weights = match weights.is_empty() {
        true => points.iter().map(|(_, span)| (1.0, *span)).collect(),
        false => weights,
    };
    let blocks = SplineBlocks { start: entity.span, points, weights, knots };
    #[allow(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "255 is no degree either")]
    let degree = if degree.fract() == 0.0 { degree.clamp(0.0, 255.0) as usize } else { 0 };
    let named = |fault: &CurveFault| matches!(fault, CurveFault::DegreeOutOfRange { .. }).then_some("SPLINE");
    // Coordinates are checked where the curve is drawn.
    blocks.finish_except(degree, report, named, |fault| {
        is_of_clamping(fault)
            || matches!(fault, CurveFault::CoordinateOutOfRange { .. } | CurveFault::NoLength)
    })
}

/// Reports if the entity states other numbers of knots and points than it has.
fn check_counts(entity: &Entity<'_>, counts: [(i32, &str, usize); 2], report: &mut Report<'_>) {
    for (code, what, found) in counts {
        #[allow(clippy::cast_precision_loss, reason = "a drawing has fewer than 2⁵³ of anything")]
        let found = found as f64;
        if let Some(stated) = entity.number(report, code).filter(|stated| *stated != found) {
            report
                .error(entity.span, format!("this SPLINE has {found} {what} and says that it has {stated}"))
                .expected(format!("group {code} to be their number"));
        }
    }
}

fn drawn<'t>(curve: Curve, span: Span) -> Item<'t> {
    if curve.control_points_mm().windows(2).all(|pair| pair[0] == pair[1]) {
        Item::Standstill(span)
    } else {
        Item::Curve { curve, shape: Shape::Nurbs, span }
    }
}

/// Reads a spline through points; the degree that it names is not used. Returns whether an end has no tangent.
fn by_fit_points<'t>(entity: &Entity<'t>, report: &mut Report<'_>, items: &mut Vec<Item<'t>>) -> bool {
    let found = entity.points(report, 11);
    let tangents = [12, 13].map(|code| entity.points(report, code).first().map(|(tangent, _)| *tangent));
    if found.iter().map(|(point, _)| point).chain(tangents.iter().flatten()).flatten().any(|x| x.is_nan()) {
        // The number has been reported as invalid.
        return false;
    }
    let mut points: Vec<_> = found.into_iter().map(|(point, _)| point).collect();
    let extent = points.iter().map(|point| length(difference(point, &points[0]))).fold(0.0, f64::max);
    let is_same = |one: &[f64; 3], other: &[f64; 3]| length(difference(one, other)) <= SAME_POINT * extent;
    points.dedup_by(|next, point| is_same(next, point));
    let ends = Ends::Open(tangents.map(|tangent| tangent.and_then(unit)));
    let is_closed = entity.flags(report, 70) & CLOSED != 0 && ends == Ends::Open([None; 2]);
    if is_closed && points.len() > 1 {
        let first = points[0];
        points.pop_if(|last| is_same(last, &first));
        points.push(first);
    }
    if points.len() < 2 {
        report
            .error(entity.span, "this SPLINE has no control points and fewer than two points to pass through")
            .expected("groups 10, 20 and 30, or 11, 21 and 31");
        return false;
    }
    let ends = if is_closed && points.len() > 2 { Ends::Closed } else { ends };
    items.push(drawn(through(&points, ends), entity.span));
    matches!(ends, Ends::Open(tangents) if tangents.contains(&None))
}
