//! The file of a sweep: its first line holds the grid, and each further line a cell.

use std::collections::HashSet;

use anyhow::{Result, bail};
use foreign_text::in_a_file_name;
use format_report::{Sweep, SweepCell};

use crate::resumed_file::Work;

/// Cells of a sweep, at most.
pub(crate) const MOST_CELLS: usize = 1_000_000;

/// The longest name of a run.
const LONGEST_RUN: usize = 64;

impl Work for Sweep {
    type Line = SweepCell;
    const NAME: &'static str = "sweep";
    const LINE: &'static str = "cell";
    const OPTION: &'static str = "--out";
    const TOLD_BY: &'static str = "another part, machine, grid, list of formats or options";

    /// A grid of a size that can be run, with runs whose pictures have names of their own.
    fn expect_plausible(&self) -> Result<()> {
        if self.len() > MOST_CELLS {
            bail!("a sweep of {} cells: expected at most {MOST_CELLS}", self.len());
        }
        let mut files = HashSet::new();
        for run in &self.runs {
            if run.len() > LONGEST_RUN || !files.insert(in_a_file_name(run)) {
                bail!(
                    "expected runs such as \"I4F28 pieces\", each once; found {:?}",
                    run.chars().take(LONGEST_RUN).collect::<String>()
                );
            }
        }
        Ok(())
    }

    /// The cell is at the place of its number, and has a result for each run or a reason.
    fn expect_of_it(&self, cell: &SweepCell) -> Result<()> {
        let place = Some((cell.period_ms, cell.feed_mm_per_s, cell.size_mm));
        let complete = cell.skipped.is_some() || cell.results.len() == self.runs.len();
        if self.place(cell.cell) != place || !complete {
            bail!("cell {} does not belong to the grid of line 1", cell.cell);
        }
        Ok(())
    }
}
