//! Chord error of each period in each format.

use crate::chart::{Axis, Layout, draw};
use crate::comparison::material::Material;
use crate::comparison::over_time::over_time;
use crate::comparison::runs::{RunView, entries};
use crate::figure::Figure;

/// One picture of all runs.
pub(crate) fn figures(material: &Material<'_>, runs: &[RunView<'_>]) -> Vec<Figure> {
    let period = material.period_s();
    let machine = &material.comparison.machine;
    let limit = machine.chord_error_mm * 1000.0;
    let at_corners = machine.corner_error_mm().0 * 1000.0;
    let longest = runs.iter().filter_map(|run| Some(run.trace?.periods())).max().unwrap_or(0);
    if longest == 0 {
        return Vec::new();
    }
    // A format with very large errors must not squeeze the others into a line.
    let values = runs.iter().filter_map(|run| run.trace).flat_map(|trace| trace.chord_error_mm.iter());
    let y = Axis::over(
        "chord error [µm]",
        values.map(|mm| (mm * 1000.0).min(3.0 * at_corners)).chain([at_corners]),
    );
    let x = Axis::linear("time [s]", 0.0..longest as f64 * period);
    let figure = draw((x, y), &Layout::default(), |plot| {
        plot.limit(limit, "limit");
        if at_corners > limit {
            plot.limit(at_corners, "limit over corners");
        }
        for run in runs {
            let Some(trace) = run.trace else { continue };
            let micrometres: Vec<f64> = trace.chord_error_mm.iter().map(|mm| mm * 1000.0).collect();
            plot.group(&run.class(), &run.name(), |plot| plot.line(&over_time(trace, &micrometres, period)));
        }
    });
    let caption = "The largest distance of the exact curve from the chord of each period. Where it follows the limit, the \
                   chord error is what holds the feed down; that is the plan's doing and much the same in every format.";
    vec![
        figure
            .named("chord-error", "Chord error over time, by format", caption)
            .following_the_pointer()
            .with_runs(entries(runs)),
    ]
}
