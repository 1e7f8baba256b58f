//! What a command does with each part of a set.

use anyhow::Result;
use format_compare::{Dimension, ExactPlan, Options, Problem, Space};
use real::{Datapath, FormatName};
use serde_json::Value;

/// The work on a part, and what of it can be used again while the part is at hand.
pub(crate) struct Worked {
    /// The JSON of the command for this part alone.
    pub(crate) json: String,
    /// The plan that the runs followed, if there is a common one.
    pub(crate) plan: Option<ExactPlan>,
}

/// A command that takes a set of parts.
pub(crate) trait OfEachPart: Sync {
    /// Its name.
    const COMMAND: &'static str;

    /// Its options, in words: what changes a part's result changes them.
    fn options(&self) -> Result<String>;

    /// How the fixed-point formats compute in which the fewest bits are searched.
    fn datapath(&self) -> Datapath;

    /// The options of a run of a part.
    fn options_for<const D: usize>(&self, problem: &Problem<D>) -> Result<Options>;

    /// Does the work for a part.
    fn work<const D: usize>(&self, problem: &Problem<D>, part_checksum: u32) -> Result<Worked>
    where
        Space: Dimension<D>;

    /// Makes the plan of the runs again.
    fn plan<const D: usize>(&self, problem: &Problem<D>) -> Result<Option<ExactPlan>>
    where
        Space: Dimension<D>;

    /// The fewest bits for a part alone, by the JSON of the work.
    fn own_answer(&self, result: &Value) -> OwnAnswer;
}

/// The fewest bits for a part alone.
#[derive(Clone, Debug, PartialEq)]
pub(crate) enum OwnAnswer {
    /// The narrowest good format, and the fluctuation allowed over the one found.
    Found { format: FormatName, margin: Option<f64> },
    /// There is none, and why.
    None(String),
    /// It was not asked for.
    NotSearched,
}
