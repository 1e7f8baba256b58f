//! The runs of a comparison in the report: their names and colours, and which of them are shown at first.

use format_compare::{Comparison, Engine, JudgedRun, Trace, Verdict};

use crate::figure::Entry;
use crate::palette::{DASH_COUNT, HUE_COUNT, series};
use crate::switch::Switch;

/// One run: a format with a form of the path.
pub(crate) struct RunView<'a> {
    /// Its place in the comparison.
    pub(crate) index: usize,
    /// Its figures.
    pub(crate) row: &'a JudgedRun,
    /// The trace of the run; `None` if the format was refused.
    pub(crate) trace: Option<&'a Trace>,
    /// Its colour, which all runs of a format share.
    pub(crate) hue: usize,
    /// Its dashes: a solid line on pieces.
    pub(crate) dash: usize,
    /// Whether the comparison recommends it.
    pub(crate) recommended: bool,
    /// Whether it is shown before the reader chooses.
    pub(crate) shown: bool,
}

impl RunView<'_> {
    /// The name: format and form of the path.
    pub(crate) fn name(&self) -> String {
        format!("{} {}", self.row.format, self.row.engine)
    }

    /// The classes of the run's elements in a picture.
    pub(crate) fn class(&self) -> String {
        series(self.index, self.hue, self.dash)
    }

    /// Its switch.
    pub(crate) fn switch(&self) -> Switch {
        Switch {
            shown: self.shown,
            ran: self.trace.is_some(),
            good: self.row.verdict.is_good(),
            recommended: self.recommended,
            ..Switch::new(self.index, self.name(), self.hue, self.dash)
        }
    }

    /// The classes of a mark in a picture that always shows all runs: the mark is hollow if a requirement is not met.
    pub(crate) fn look(&self) -> String {
        let hollow = if self.row.verdict.is_good() { "" } else { " hollow" };
        format!("c{} d0{hollow}", self.hue)
    }
}

/// The runs in the comparison's order.
pub(crate) fn views<'a>(comparison: &'a Comparison, traces: &'a [Option<Trace>]) -> Vec<RunView<'a>> {
    let mut formats: Vec<&str> = Vec::new();
    let mut runs: Vec<RunView<'_>> = Vec::new();
    for (index, row) in comparison.formats.iter().enumerate() {
        let place = formats.iter().position(|name| *name == row.format).unwrap_or_else(|| {
            formats.push(&row.format);
            formats.len() - 1
        });
        let family = usize::from(row.engine != Engine::Pieces);
        runs.push(RunView {
            index,
            row,
            trace: traces.get(index).and_then(Option::as_ref),
            hue: place % HUE_COUNT,
            dash: (2 * (place / HUE_COUNT) + family) % DASH_COUNT,
            recommended: recommended(comparison) == Some(index),
            shown: false,
        });
    }
    let wanted = at_first(comparison);
    runs.iter_mut().for_each(|run| run.shown = wanted.contains(&run.index));
    runs
}

/// A line of a legend for each run that was made.
pub(crate) fn entries(runs: &[RunView<'_>]) -> Vec<Entry> {
    let ran = runs.iter().filter(|run| run.trace.is_some());
    ran.map(|run| Entry::line(&run.class(), &run.name())).collect()
}

/// The run that the comparison recommends.
pub(crate) fn recommended(comparison: &Comparison) -> Option<usize> {
    let (format, engine) = (comparison.recommended.as_ref()?, comparison.recommended_engine?);
    comparison.formats.iter().position(|row| row.format == *format && row.engine == engine)
}

/// The runs that are shown at first, at most six: more lines hide each other. The recommended run comes first, then
/// those of its format, of floats and of the narrowest format, then the others.
fn at_first(comparison: &Comparison) -> Vec<usize> {
    const MOST: usize = 6;
    let rows = &comparison.formats;
    let ran = |row: &JudgedRun| !matches!(row.verdict, Verdict::Refused(_));
    let mut wanted: Vec<usize> = recommended(comparison).into_iter().collect();
    let chosen = comparison.recommended.as_deref().unwrap_or_default();
    let narrowest = rows.iter().find(|row| ran(row)).map_or("", |row| row.format.as_str());
    for name in [chosen, "f32", "f64", narrowest] {
        wanted.extend(rows.iter().enumerate().filter(|(_, row)| row.format == name).map(|(index, _)| index));
    }
    wanted.extend(0..rows.len());
    let mut first = Vec::new();
    for index in wanted {
        if first.len() < MOST && !first.contains(&index) && ran(&rows[index]) {
            first.push(index);
        }
    }
    first
}
