//! The cost of a period on each target against fluctuation.

use format_compare::{Cost, PeriodCost};
use plotters::style::text_anchor::{HPos, VPos};
use target_cost::Measure;

use crate::chart::{Axis, Layout, draw};
use crate::comparison::material::Material;
use crate::comparison::runs::RunView;
use crate::figure::Figure;
use crate::number;

/// A picture for each target that the comparison was priced on.
pub(crate) fn figures(material: &Material<'_>, runs: &[RunView<'_>]) -> Vec<Figure> {
    let limit = material.comparison.machine.fluctuation_limit;
    material
        .targets
        .iter()
        .filter_map(|target| figure(&target.name, &target.title, target.measure, limit, runs))
        .collect()
}

fn figure(name: &str, title: &str, measure: Measure, limit: f64, runs: &[RunView<'_>]) -> Option<Figure> {
    let what = match measure {
        Measure::Cycles => "cycles",
        Measure::Instructions => "instructions",
    };
    let points: Vec<(&RunView<'_>, &PeriodCost, f64)> = runs
        .iter()
        .filter_map(|run| match run.row.cycles.get(name)? {
            Cost::Known(cost) => Some((run, cost, run.row.fluctuation?.cruise_max_abs)),
            Cost::Unknown { .. } => None,
        })
        .filter(|(_, cost, fluctuation)| *fluctuation > 0.0 && cost.max > 0.0)
        .collect();
    if points.is_empty() {
        return None;
    }
    let costs = points.iter().flat_map(|(_, cost, _)| [cost.max_range[0], cost.max, cost.max_range[1]]);
    let x = Axis::decades(&format!("{what} of the worst period [count]"), costs, 12);
    let y =
        Axis::decades("largest fluctuation at cruise [ratio]", points.iter().map(|p| p.2).chain([limit]), 24);
    let figure = draw((x, y), &Layout { height: 420, ..Layout::default() }, |plot| {
        plot.limit(limit, "limit at cruise");
        for (run, cost, fluctuation) in &points {
            let share = cost.share_of_period.map_or_else(String::new, |share| {
                format!(", {} % of the period", number::short(share * 100.0))
            });
            let tip = format!(
                "{}: {} {what} ({} to {}){share}, fluctuation {}",
                run.name(),
                number::short(cost.max),
                number::short(cost.max_range[0]),
                number::short(cost.max_range[1]),
                number::short(*fluctuation)
            );
            plot.group(&run.look(), "", |plot| {
                plot.line(&[(cost.max_range[0], *fluctuation), (cost.max_range[1], *fluctuation)]);
                plot.mark((cost.max, *fluctuation), run.dash, &tip);
                plot.note((cost.max * 1.06, *fluctuation), (HPos::Left, VPos::Bottom), &run.name());
            });
        }
    });
    let caption = "Left and low is good. The bar of a mark reaches from the low to the high cost of its operations. A full \
                   mark meets every requirement, a hollow one does not.";
    Some(figure.named(&format!("cycles-{name}"), &format!("Cost against fluctuation on {title}"), caption))
}
