//! The papers' comparison: secant against Taylor expansions of first and second order, in f64.

use crate::chart::{Axis, Layout, draw};
use crate::comparison::material::Material;
use crate::comparison::over_time::over_time;
use crate::figure::{Entry, Figure};
use crate::palette::DASH_COUNT;

/// One picture; none if the solvers were not run.
pub(crate) fn figures(material: &Material<'_>) -> Vec<Figure> {
    let period = material.period_s();
    let longest = material.solvers.iter().map(|solver| solver.trace.periods()).max().unwrap_or(0);
    if longest == 0 {
        return Vec::new();
    }
    let size = |trace: &format_compare::Trace| trace.fluctuation.iter().map(|x| x.abs()).collect::<Vec<_>>();
    let values = material.solvers.iter().flat_map(|solver| size(&solver.trace)).filter(|x| *x > 1e-18);
    let y = Axis::decades("feedrate fluctuation |δ| [ratio]", values, 14);
    let x = Axis::linear("time [s]", 0.0..longest as f64 * period);
    let figure = draw((x, y), &Layout { height: 380, ..Layout::default() }, |plot| {
        for (place, solver) in material.solvers.iter().enumerate() {
            plot.group(&format!("c{place} d{}", place % DASH_COUNT), &solver.name, |plot| {
                plot.line(&over_time(&solver.trace, &size(&solver.trace), period));
            });
        }
    });
    let class = |place: usize| format!("c{place} d{}", place % DASH_COUNT);
    let solvers = material.solvers.iter().enumerate();
    let legend = solvers.map(|(place, solver)| Entry::line(&class(place), &solver.name)).collect();
    let caption = "All three in f64 on the raw path with one global parameter, as the secant paper has it. A Taylor \
                   expansion follows the curve's derivatives and never checks the chord it makes; the secant iteration \
                   goes on until the chord is right.";
    vec![
        figure
            .named("solvers", "Secant against Taylor, in f64", caption)
            .following_the_pointer()
            .with_legend(legend),
    ]
}
