//! A spline that is being read block by block: its numbers, each with its place.

use crate::curve::{Curve, Nurbs};
use crate::curve_fault::{CurveFault, Element};
use crate::diagnostic::Report;
use crate::source::Span;

/// The numbers of a spline so far, with their places.
#[derive(Default)]
pub(crate) struct SplineBlocks {
    pub(crate) points: Vec<([f64; 3], Span)>,
    pub(crate) weights: Vec<(f64, Span)>,
    pub(crate) knots: Vec<(f64, Span)>,
    /// The block that opened it.
    pub(crate) start: Span,
}

impl SplineBlocks {
    pub(crate) fn point(&mut self, point: [f64; 3], weight: f64, span: Span) {
        self.points.push((point, span));
        self.weights.push((weight, span));
    }

    /// The curve, if it obeys every rule. `named` is the control's word for a fault, which the message begins with.
    pub(crate) fn finish(
        self,
        degree: usize,
        report: &mut Report<'_>,
        named: impl Fn(&CurveFault) -> Option<&'static str>,
    ) -> Option<Curve> {
        self.finish_except(degree, report, named, |_| false).map(Curve::from)
    }

    /// As [`finish`](Self::finish), but a curve may break the rules that are `forgiven`.
    pub(crate) fn finish_except(
        self,
        degree: usize,
        report: &mut Report<'_>,
        named: impl Fn(&CurveFault) -> Option<&'static str>,
        forgiven: impl Fn(&CurveFault) -> bool,
    ) -> Option<Nurbs> {
        let (control_points_mm, point_spans): (Vec<_>, Vec<_>) = self.points.into_iter().unzip();
        let (weights, weight_spans): (Vec<_>, Vec<_>) = self.weights.into_iter().unzip();
        let (knots, knot_spans): (Vec<_>, Vec<_>) = self.knots.into_iter().unzip();
        let dimension = Nurbs::dimension_of(&control_points_mm);
        let curve = Nurbs { degree, control_points_mm, dimension, weights, knots };
        let faults: Vec<_> = curve.faults().into_iter().filter(|fault| !forgiven(fault)).collect();
        for fault in &faults {
            let span = match fault.element() {
                Element::ControlPoint(i) => point_spans.get(i),
                Element::Weight(i) => weight_spans.get(i),
                Element::Knot(i) => knot_spans.get(i),
                Element::Degree | Element::ControlPoints | Element::Weights | Element::Knots => None,
            };
            let message = match named(fault) {
                Some(name) => format!("{name}: {fault}"),
                None => fault.to_string(),
            };
            report.error(span.copied().unwrap_or(self.start), message).expected(fault.expected());
        }
        faults.is_empty().then_some(curve)
    }
}

/// Uniform clamped knots `0 … 0, 1, 2, …, m … m` of a curve with `points` control points.
pub(crate) fn uniform_knots(points: usize, degree: usize) -> impl Iterator<Item = f64> {
    let spans = points.saturating_sub(degree);
    #[allow(clippy::cast_precision_loss, reason = "a program has fewer than 2⁵³ points")]
    (0..points + degree + 1).map(move |i| i.saturating_sub(degree).min(spans) as f64)
}
