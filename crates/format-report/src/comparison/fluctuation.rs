//! Fluctuation of each period in each format, with the fluctuation that comes from the format's resolution alone.

use crate::chart::{Axis, Layout, draw};
use crate::comparison::material::Material;
use crate::comparison::over_time::over_time;
use crate::comparison::runs::{RunView, entries};
use crate::figure::Figure;

/// The runs in the order of drawing: from wide to narrow, then the recommended one, since the last is on top.
fn in_front<'a, 'b>(series: &'b [(&'a RunView<'a>, Vec<f64>)]) -> Vec<&'b (&'a RunView<'a>, Vec<f64>)> {
    let mut ordered: Vec<_> = series.iter().collect();
    ordered.sort_by_key(|(run, _)| (run.recommended, std::cmp::Reverse(run.index)));
    ordered
}

/// One picture of all runs.
pub(crate) fn figures(material: &Material<'_>, runs: &[RunView<'_>]) -> Vec<Figure> {
    let period = material.period_s();
    let limit = material.comparison.machine.fluctuation_limit;
    let series: Vec<(&RunView<'_>, Vec<f64>)> = runs
        .iter()
        .filter_map(|run| Some((run, run.trace?.fluctuation.iter().map(|x| x.abs()).collect())))
        .collect();
    let longest = runs.iter().filter_map(|run| Some(run.trace?.periods())).max().unwrap_or(0);
    if longest == 0 {
        return Vec::new();
    }
    // Fluctuations of 0 lie on the lower edge; a value far below every resolution would only squeeze the others.
    let bounds = series.iter().filter_map(|(run, _)| run.row.fluctuation_resolution).filter(|x| *x > 0.0);
    let lowest = bounds.fold(f64::INFINITY, f64::min) / 10.0;
    let values = series.iter().flat_map(|(_, values)| values.iter().copied()).filter(|x| *x >= lowest);
    let y = Axis::decades("feedrate fluctuation |δ| [ratio]", values.chain([limit]), 20);
    let x = Axis::linear("time [s]", 0.0..longest as f64 * period);
    let end = x.range.end;
    let figure = draw((x, y), &Layout { height: 440, ..Layout::default() }, |plot| {
        plot.limit(limit, "limit at cruise");
        for (run, values) in in_front(&series) {
            plot.group(&run.class(), &run.name(), |plot| {
                let trace = run.trace.map(|trace| over_time(trace, values, period));
                plot.line(&trace.unwrap_or_default());
            });
            if let Some(bound) = run.row.fluctuation_resolution {
                plot.group(&format!("{} bound", run.class()), "", |plot| {
                    plot.line(&[(0.0, bound), (end, bound)]);
                });
            }
        }
    });
    let caption = "δ = 1 − chord/(V·T) of each period, as a magnitude. The level line of a format is the most that \
                   rounding the solved quantity to its resolution may cost at cruise; its worst period comes near that or \
                   lies above. Near rest, at \
                   both ends, the wanted step is a micrometre or less and the ratio says little; the limit holds at \
                   cruise, for steps of at least a quarter of F·T.";
    vec![
        figure
            .named("fluctuation", "Feedrate fluctuation over time, by format", caption)
            .following_the_pointer()
            .with_runs(entries(runs)),
    ]
}
