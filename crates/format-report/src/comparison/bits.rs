//! Bits against fluctuation, and the front: the formats that no narrower format beats.

use format_compare::Engine;
use plotters::style::text_anchor::{HPos, VPos};

use crate::chart::{Axis, Layout, draw};
use crate::comparison::material::Material;
use crate::comparison::runs::RunView;
use crate::figure::Figure;
use crate::number;

/// One picture of all runs.
pub(crate) fn figures(material: &Material<'_>, runs: &[RunView<'_>]) -> Vec<Figure> {
    let limit = material.comparison.machine.fluctuation_limit;
    let points: Vec<(&RunView<'_>, f64, f64)> = runs
        .iter()
        .filter_map(|run| Some((run, f64::from(run.row.bits), run.row.fluctuation?.cruise_max_abs)))
        .filter(|(_, _, fluctuation)| *fluctuation > 0.0)
        .collect();
    if points.is_empty() {
        return Vec::new();
    }
    let widths = points.iter().map(|(_, bits, _)| *bits);
    let (low, high) =
        widths.fold((f64::INFINITY, 0.0_f64), |(low, high), bits| (low.min(bits), high.max(bits)));
    let x = Axis::linear("width of the format [bit]", low - 7.0..high + 7.0);
    let y =
        Axis::decades("largest fluctuation at cruise [ratio]", points.iter().map(|p| p.2).chain([limit]), 24);
    let front = front(&points.iter().map(|(_, bits, fluctuation)| (*bits, *fluctuation)).collect::<Vec<_>>());
    let labels = labels(&points, (y.range.end / y.range.start).log10() * LABEL_HEIGHT);
    let figure = draw((x, y), &Layout { height: 420, ..Layout::default() }, |plot| {
        plot.limit(limit, "limit at cruise");
        plot.group("c5 d2", "", |plot| plot.line(&front));
        for ((run, bits, fluctuation), label_at) in points.iter().zip(&labels) {
            let verdict = if run.row.verdict.is_good() { "good" } else { "not good enough" };
            let tip = format!(
                "{}: {} bits, fluctuation {}, {verdict}",
                run.name(),
                run.row.bits,
                number::short(*fluctuation)
            );
            plot.group(&run.look(), "", |plot| {
                plot.mark((*bits, *fluctuation), run.dash, &tip);
                let (beside, side) = if is_raw(run) { (-0.7, HPos::Right) } else { (0.7, HPos::Left) };
                plot.note((*bits + beside, *label_at), (side, VPos::Center), &run.name());
            });
        }
    });
    let caption = "A full mark meets every requirement, a hollow one does not. The dotted line joins the runs that nothing \
                   of the same width or narrower beats.";
    vec![figure.named("bits", "Bits against fluctuation", caption)]
}

/// The height of a label, as a share of the picture's height.
const LABEL_HEIGHT: f64 = 0.036;

fn is_raw(run: &RunView<'_>) -> bool {
    run.row.engine != Engine::Pieces
}

/// The places of the marks' labels, so that no label covers another. Each is at its mark or below it. Two labels on the
/// same side of the same width are `apart` decades from each other.
fn labels(points: &[(&RunView<'_>, f64, f64)], apart: f64) -> Vec<f64> {
    let mut order: Vec<usize> = (0..points.len()).collect();
    order.sort_by(|a, b| points[*b].2.total_cmp(&points[*a].2));
    let mut places: Vec<f64> = points.iter().map(|point| point.2).collect();
    let mut above: Vec<(f64, bool, f64)> = Vec::new();
    for index in order {
        let (run, bits, value) = points[index];
        let last = above.iter().rev().find(|(width, raw, _)| *width == bits && *raw == is_raw(run));
        let at = last.map_or(value, |(_, _, last)| value.min(last / 10.0_f64.powf(apart)));
        places[index] = at;
        above.push((bits, is_raw(run), at));
    }
    places
}

/// The least value up to each width, as a line of steps, narrow before wide.
fn front(points: &[(f64, f64)]) -> Vec<(f64, f64)> {
    let mut sorted = points.to_vec();
    sorted.sort_by(|a, b| a.0.total_cmp(&b.0).then(a.1.total_cmp(&b.1)));
    let mut steps: Vec<(f64, f64)> = Vec::new();
    for (bits, value) in sorted {
        match steps.last() {
            Some((_, best)) if *best <= value => {}
            Some((_, best)) => {
                let corner = (bits, *best);
                steps.extend([corner, (bits, value)]);
            }
            None => steps.push((bits, value)),
        }
    }
    steps
}

#[cfg(test)]
mod tests {
    #[test]
    fn the_front_goes_down_in_steps() {
        let points = [(64.0, 1e-9), (32.0, 1e-3), (32.0, 1e-6), (48.0, 1e-5)];
        assert_eq!(super::front(&points), [(32.0, 1e-6), (64.0, 1e-6), (64.0, 1e-9)]);
    }
}
