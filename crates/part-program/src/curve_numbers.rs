//! The numbers of a curve in a curve file, each with its place.

use toml::Spanned;
use toml::de::{DeArray, DeValue};

use crate::curve::{CurveFault, Element};
use crate::diagnostic::Report;
use crate::source::Span;
use crate::toml_table::{self, wrong_kind};

/// The places of a curve's numbers.
#[derive(Default)]
pub(crate) struct Places {
    pub(crate) degree: Span,
    pub(crate) points: Span,
    pub(crate) point: Vec<Span>,
    pub(crate) weights: Span,
    pub(crate) weight: Vec<Span>,
    pub(crate) knots: Span,
    pub(crate) knot: Vec<Span>,
}

impl Places {
    /// All numbers at the place of the control points, from which they are computed.
    pub(crate) fn all_at(points: Span) -> Self {
        Self { degree: points, points, weights: points, knots: points, ..Self::default() }
    }

    fn of(&self, element: Element) -> Span {
        let one = |places: &[Span], index: usize, all: Span| places.get(index).copied().unwrap_or(all);
        match element {
            Element::Degree => self.degree,
            Element::ControlPoints => self.points,
            Element::ControlPoint(index) => one(&self.point, index, self.points),
            Element::Weights => self.weights,
            Element::Weight(index) => one(&self.weight, index, self.weights),
            Element::Knots => self.knots,
            Element::Knot(index) => one(&self.knot, index, self.knots),
        }
    }
}

/// Reports each fault at its place.
pub(crate) fn say(report: &mut Report<'_>, places: &Places, faults: &[CurveFault]) {
    for fault in faults {
        report.error(places.of(fault.element()), fault.to_string()).expected(fault.expected());
    }
}

/// The numbers of an array; their places are added to `places`.
pub(crate) fn numbers(
    report: &mut Report<'_>,
    key: &str,
    array: &DeArray<'_>,
    places: &mut Vec<Span>,
) -> Option<Vec<f64>> {
    places.extend(array.iter().map(|item| Span::from(item.span())));
    let numbers: Vec<_> = array.iter().map(|item| toml_table::number(report, key, item)).collect();
    numbers.into_iter().collect()
}

/// The points, and the number of coordinates of each.
pub(crate) fn control_points(
    report: &mut Report<'_>,
    array: &DeArray<'_>,
    places: &mut Vec<Span>,
) -> Option<(Vec<[f64; 3]>, usize)> {
    places.extend(array.iter().map(|item| Span::from(item.span())));
    let dimension = array.first().and_then(|first| first.get_ref().as_array()).map_or(0, |point| point.len());
    let points: Vec<_> = array.iter().map(|item| control_point(report, item, dimension)).collect();
    Some((points.into_iter().collect::<Option<_>>()?, dimension.max(2)))
}

fn control_point(report: &mut Report<'_>, item: &Spanned<DeValue<'_>>, dimension: usize) -> Option<[f64; 3]> {
    const KEY: &str = "control_points_mm";
    let DeValue::Array(coordinates) = item.get_ref() else {
        wrong_kind(report, KEY, item, "points of 2 or 3 coordinates, as [x, y] or [x, y, z]");
        return None;
    };
    let found = coordinates.len();
    if !(2..=3).contains(&found) {
        let message = format!("a control point has {found} coordinates");
        report.error(item.span(), message).expected("2 or 3 coordinates, as [x, y] or [x, y, z]");
        return None;
    }
    if found != dimension && (2..=3).contains(&dimension) {
        let message = format!("a control point has {found} coordinates, the first has {dimension}");
        report.error(item.span(), message).expected("the same number of coordinates in every point");
        return None;
    }
    let mut point = [0.0; 3];
    for (coordinate, value) in point.iter_mut().zip(coordinates.iter()) {
        *coordinate = toml_table::number(report, KEY, value)?;
    }
    Some(point)
}
