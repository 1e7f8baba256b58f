//! The powers of two of each named signal's values, for each run.

use format_compare::Trace;

use crate::comparison::runs::RunView;
use crate::figure::Figure;
use crate::ranges::{Ranges, figure};

/// A picture for each run.
pub(crate) fn figures(runs: &[RunView<'_>]) -> Vec<Figure> {
    let of = |run: &RunView<'_>| {
        let Trace { signals, histograms, .. } = run.trace?;
        let (index, name, hue, format) = (run.index, run.name(), run.hue, run.row.format.as_str());
        figure(&Ranges { index, name, hue, format, signals, histograms })
    };
    runs.iter().filter_map(of).collect()
}
