//! A sweep over interpolation periods, feeds and part sizes: its cells, as lines of JSON, and its report.

use std::collections::BTreeMap;

use askama::Template;
use plotters::style::text_anchor::{HPos, VPos};
use serde::{Deserialize, Serialize};

use crate::chart::{Axis, Layout, draw};
use crate::figure::Figure;
use crate::frame::Frame;
use crate::levels::{legend, level};
use crate::number;
use crate::report::{Report, files};
use crate::table::{Cell, Column, Table};

/// The parameters of a sweep: the first line of its file. Two files with the same first line are parts of one sweep.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Sweep {
    /// Name of the part.
    pub part: String,
    /// A number that changes if the part's curves, the machine's limits or the options change.
    pub fingerprint: String,
    /// The largest fluctuation at cruise of a good run.
    pub fluctuation_limit: f64,
    /// Interpolation periods, in ms.
    pub periods_ms: Vec<f64>,
    /// Commanded feeds, in mm/s.
    pub feeds_mm_per_s: Vec<f64>,
    /// Sizes of the part, its largest extent, in mm.
    pub sizes_mm: Vec<f64>,
    /// The runs of each cell: format and form of the path.
    pub runs: Vec<String>,
}

/// One period, feed and size with the result of each run: a line of a sweep's file.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct SweepCell {
    /// Its number.
    pub cell: usize,
    /// The period, in ms.
    pub period_ms: f64,
    /// The feed, in mm/s.
    pub feed_mm_per_s: f64,
    /// The size, in mm.
    pub size_mm: f64,
    /// The reason if nothing was run.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub skipped: Option<String>,
    /// A result for each of the sweep's runs; empty if nothing was run.
    pub results: Vec<SweepResult>,
    /// The cheapest good run on each target of the sweep; empty without targets.
    #[serde(default, skip_serializing_if = "BTreeMap::is_empty")]
    pub cheapest: BTreeMap<String, String>,
}

/// The cost of the dearest period of a run on a target.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct SweepCost {
    /// In the target's measure: cycles, or instructions.
    pub max: f64,
    /// In microseconds, if the clock is known.
    pub microseconds_max: Option<f64>,
    /// Over the interpolation period, if the clock is known.
    pub share_of_period: Option<f64>,
    /// DSP blocks, on an FPGA.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub dsp_blocks: Option<u32>,
}

/// The result of a run.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct SweepResult {
    /// Whether every requirement is met.
    pub good: bool,
    /// Largest fluctuation at cruise; `None` if the format was refused.
    pub fluctuation: Option<f64>,
    /// The requirements that are not met.
    pub reason: String,
    /// The cost on each target of the sweep, where every operation has a price; empty without targets.
    #[serde(default, skip_serializing_if = "BTreeMap::is_empty")]
    pub cycles: BTreeMap<String, SweepCost>,
}

impl Sweep {
    /// Number of cells.
    #[must_use]
    pub fn len(&self) -> usize {
        self.periods_ms.len().saturating_mul(self.feeds_mm_per_s.len()).saturating_mul(self.sizes_mm.len())
    }

    /// Whether the sweep has no cell.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }

    /// Period in ms, feed in mm/s and size in mm of a cell: the period changes fastest, the size slowest. `None` beyond
    /// the last cell.
    #[must_use]
    pub fn place(&self, cell: usize) -> Option<(f64, f64, f64)> {
        let (periods, feeds) = (self.periods_ms.len(), self.feeds_mm_per_s.len());
        let period = self.periods_ms.get(cell.checked_rem(periods)?)?;
        let feed = self.feeds_mm_per_s.get((cell / periods).checked_rem(feeds)?)?;
        let size = self.sizes_mm.get(cell / periods / feeds)?;
        Some((*period, *feed, *size))
    }

    /// Draws a heat map for each run and size, with counts.
    ///
    /// # Errors
    /// As [`Report::of`].
    pub fn report(&self, cells: &[SweepCell], command: &str) -> Result<Report, askama::Error> {
        let by_number: BTreeMap<usize, &SweepCell> = cells.iter().map(|cell| (cell.cell, cell)).collect();
        let maps = (0..self.runs.len()).flat_map(|run| (0..self.sizes_mm.len()).map(move |size| (run, size)));
        let figures: Vec<Figure> = maps.map(|(run, size)| self.heat_map(run, size, &by_number)).collect();
        let (summary, all) = (self.summary(cells), self.table(cells));
        let files = files(figures.iter(), [&summary, &all].into_iter());
        let title = format!("feedbits sweep: {}", self.part);
        let question = "For which periods, feeds and sizes does a format stay good?";
        let page = SweepPage {
            frame: Frame::new((title, question), &self.part, &files, command),
            sweep: self,
            answer: self.answer(cells),
            missing: self.len().saturating_sub(by_number.len()),
            summary: &summary,
            figures: figures.iter().map(|figure| (figure, figure.inline())).collect(),
        };
        Ok(Report::new(&page.render()?, files))
    }

    /// In how many of the cells that were run a run is good, and the number of these cells.
    #[must_use]
    pub fn good(&self, cells: &[SweepCell], run: usize) -> (usize, usize) {
        let results = || cells.iter().filter_map(|cell| cell.results.get(run));
        (results().filter(|result| result.good).count(), results().count())
    }

    fn answer(&self, cells: &[SweepCell]) -> Vec<String> {
        let counted: Vec<(usize, (usize, usize))> = (0..self.runs.len())
            .map(|run| (run, self.good(cells, run)))
            .filter(|(_, (_, all))| *all > 0)
            .collect();
        let everywhere: Vec<&str> = counted
            .iter()
            .filter(|(_, (good, all))| good == all)
            .map(|(run, _)| self.runs[*run].as_str())
            .collect();
        if let Some(first) = everywhere.first() {
            let others = everywhere[1..].join(", ");
            let also = if others.is_empty() { String::new() } else { format!(" So do: {others}.") };
            return vec![format!("{first} meets every requirement in every cell that was run.{also}")];
        }
        match counted.iter().max_by_key(|(run, (good, _))| (*good, std::cmp::Reverse(*run))) {
            Some((run, (good, all))) => vec![format!(
                "No format is good everywhere. {} goes farthest: good in {good} of {all} cells.",
                self.runs[*run]
            )],
            None => vec!["No cell was run.".to_string()],
        }
    }

    fn heat_map(&self, run: usize, size: usize, cells: &BTreeMap<usize, &SweepCell>) -> Figure {
        let names = |values: &[f64]| values.iter().map(|value| number::short(*value)).collect::<Vec<_>>();
        let (periods, feeds) = (self.periods_ms.len(), self.feeds_mm_per_s.len());
        let x = Axis::of_names("commanded feed [mm/s]", names(&self.feeds_mm_per_s));
        let y = Axis::of_names("period [ms]", names(&self.periods_ms));
        let height = 70 + 34 * u32::try_from(periods).unwrap_or(1);
        let figure = draw((x, y), &Layout { height, ..Layout::default() }, |plot| {
            for (feed, period) in (0..feeds).flat_map(|feed| (0..periods).map(move |period| (feed, period))) {
                let Some(cell) = cells.get(&((size * feeds + feed) * periods + period)) else { continue };
                let (class, mark, tip) = self.shown(run, cell);
                let (x, y) = (feed as f64, period as f64);
                plot.boxes(&class, &[[x - 0.48, x + 0.48, y - 0.47, y + 0.47]], &tip);
                if !mark.is_empty() {
                    plot.note((x, y), (HPos::Center, VPos::Center), mark);
                }
            }
        });
        let caption = "Colour: the largest fluctuation at cruise. ✗: some requirement is not met, be it this or another; \
                       refused: the format cannot hold the part or its limits; –: not run.";
        let size_name = number::short(self.sizes_mm[size]);
        let name = format!("heat-{}-{}", self.runs[run], size + 1);
        let title = format!("{} on a part of {size_name} mm", self.runs[run]);
        let figure = figure.named(&name, &title, caption).of_run(run);
        figure.with_legend(legend(self.fluctuation_limit, "refused"))
    }

    /// The class of a cell, its text, and its tip.
    fn shown(&self, run: usize, cell: &SweepCell) -> (String, &'static str, String) {
        let place = format!(
            "T {} ms, {} mm/s, {} mm",
            number::short(cell.period_ms),
            number::short(cell.feed_mm_per_s),
            number::short(cell.size_mm)
        );
        match (cell.results.get(run), &cell.skipped) {
            (Some(SweepResult { good, fluctuation: Some(fluctuation), reason, .. }), _) => {
                let verdict = if *good { "good" } else { reason };
                let tip = format!("{place}: fluctuation {}, {verdict}", number::short(*fluctuation));
                (
                    format!("f{}", level(*fluctuation, self.fluctuation_limit)),
                    if *good { "" } else { "✗" },
                    tip,
                )
            }
            (Some(result), _) => ("rest-fill".to_string(), "", format!("{place}: {}", result.reason)),
            (None, why) => {
                ("outside".to_string(), "–", format!("{place}: {}", why.as_deref().unwrap_or("not run")))
            }
        }
    }

    fn summary(&self, cells: &[SweepCell]) -> Table {
        let columns = [
            ("run", "format and path"),
            ("good", "good cells"),
            ("run_cells", "cells run"),
            ("percent", "good [%]"),
        ];
        let row = |run: usize| {
            let (good, all) = self.good(cells, run);
            let share = (all > 0).then(|| 100.0 * good as f64 / all as f64);
            vec![
                Cell::text(&self.runs[run]),
                Cell::Number(good as f64),
                Cell::Number(all as f64),
                Cell::maybe(share),
            ]
        };
        Table {
            name: "summary".into(),
            title: "Where each format is good".into(),
            columns: columns.map(|(key, heading)| Column { key, heading }).to_vec(),
            rows: (0..self.runs.len()).map(row).collect(),
        }
    }

    fn table(&self, cells: &[SweepCell]) -> Table {
        let columns = [
            ("period_ms", "period [ms]"),
            ("feed_mm_per_s", "feed [mm/s]"),
            ("size_mm", "size [mm]"),
            ("run", "format and path"),
            ("good", "good"),
            ("fluctuation_at_cruise", "|δ| at cruise"),
            ("reason", "reason"),
        ];
        let mut rows = Vec::new();
        for cell in cells {
            for (run, result) in self.runs.iter().zip(&cell.results) {
                rows.push(vec![
                    Cell::Number(cell.period_ms),
                    Cell::Number(cell.feed_mm_per_s),
                    Cell::Number(cell.size_mm),
                    Cell::text(run),
                    Cell::text(if result.good { "yes" } else { "no" }),
                    Cell::maybe(result.fluctuation),
                    Cell::text(&result.reason),
                ]);
            }
        }
        Table {
            name: "cells".into(),
            title: "All cells".into(),
            columns: columns.map(|(key, heading)| Column { key, heading }).to_vec(),
            rows,
        }
    }
}

#[derive(Template)]
#[template(path = "sweep.html")]
struct SweepPage<'a> {
    frame: Frame<'a>,
    sweep: &'a Sweep,
    answer: Vec<String>,
    missing: usize,
    summary: &'a Table,
    figures: Vec<(&'a Figure, String)>,
}

#[cfg(test)]
mod tests {
    use super::*;

    fn sweep() -> Sweep {
        Sweep {
            part: "p".into(),
            fingerprint: "0".into(),
            fluctuation_limit: 1e-6,
            periods_ms: vec![1.0, 2.0],
            feeds_mm_per_s: vec![10.0, 20.0, 40.0],
            sizes_mm: vec![100.0, 1000.0],
            runs: vec!["I4F28 pieces".into(), "f32 raw".into()],
        }
    }

    fn cell(sweep: &Sweep, number: usize) -> SweepCell {
        let (period_ms, feed_mm_per_s, size_mm) = sweep.place(number).expect("a cell");
        let result = |good, fluctuation| SweepResult {
            good,
            fluctuation,
            reason: String::new(),
            cycles: BTreeMap::new(),
        };
        let results = vec![result(true, Some(1e-8)), result(number.is_multiple_of(2), Some(1e-3))];
        SweepCell { cell: number, period_ms, feed_mm_per_s, size_mm, results, ..SweepCell::default() }
    }

    #[test]
    fn every_cell_has_a_place_of_its_own() {
        let sweep = sweep();
        let places: Vec<_> = (0..sweep.len()).map(|cell| sweep.place(cell).expect("a place")).collect();
        assert_eq!(
            (places[0], places[1], places[2]),
            ((1.0, 10.0, 100.0), (2.0, 10.0, 100.0), (1.0, 20.0, 100.0))
        );
        assert_eq!((places[11], sweep.place(12)), ((2.0, 40.0, 1000.0), None));
        assert!((0..12).all(|a| (0..a).all(|b| places[a] != places[b])));
    }

    #[test]
    fn a_line_is_read_back_as_it_was() {
        let cell = cell(&sweep(), 5);
        let line = serde_json::to_string(&cell).expect("JSON");
        assert_eq!(serde_json::from_str::<SweepCell>(&line).expect("a cell"), cell);
        assert!(serde_json::from_str::<SweepCell>(&line[..line.len() - 4]).is_err(), "a torn line is none");
    }

    #[test]
    fn the_report_has_a_map_for_each_run_and_size() {
        let sweep = sweep();
        let cells: Vec<_> = (0..11).map(|number| cell(&sweep, number)).collect();
        let report = sweep.report(&cells, "feedbits sweep").expect("a report");
        let maps = report.files.iter().filter(|(name, _)| name.starts_with("heat-")).count();
        assert_eq!(maps, 4);
        let page = &report.files[0].1;
        assert!(
            page.contains("I4F28 pieces meets every requirement in every cell that was run."),
            "{}",
            &page[..2000]
        );
        assert!(page.contains("1 of 12 cells are missing"));
        let summary = report.files.iter().find(|(name, _)| name == "summary.csv").expect("a table");
        assert_eq!(summary.1.lines().nth(2), Some("f32 raw,6,11,54.54545454545455"));
    }
}
