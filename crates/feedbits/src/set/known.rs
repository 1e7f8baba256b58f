//! What is known of the parts of a set: the result of each, and in which other formats it was tried.

use std::collections::BTreeMap;

use anyhow::{Result, bail};
use format_compare::JudgedRun;
use serde::{Deserialize, Serialize};
use serde_json::Value;

use crate::resumed_file::Work;

/// What a set is: the first line of its file.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct SetOfParts {
    /// The command that runs each part.
    pub(crate) set: String,
    /// A number that changes with the machine, the targets, the options and the version.
    pub(crate) fingerprint: String,
    /// The parts.
    pub(crate) parts: Vec<PartOfSet>,
}

/// A part of a set.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct PartOfSet {
    pub(crate) name: String,
    /// A number that changes with what the part says; empty if it cannot be read.
    pub(crate) fingerprint: String,
}

/// A line of the file behind the first.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case", deny_unknown_fields)]
pub(crate) enum SetLine {
    /// A part that is finished.
    Finished(Finished),
    /// A part that was tried in a format that is not its own answer.
    Tried(Tried),
}

/// A part that is finished.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct Finished {
    /// Its number in the set, from 0.
    pub(crate) part: usize,
    /// How it ended.
    pub(crate) ending: PartEnding,
}

/// How the work on a part ended.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case", deny_unknown_fields)]
pub(crate) enum PartEnding {
    /// It was run: the JSON of the command for this part alone, byte by byte.
    Result(String),
    /// It cannot be read, and why.
    Unread(String),
    /// It cannot be planned or run on the machine, and why.
    Refused(String),
}

/// A part that was tried in a format.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct Tried {
    /// The number of the part in the set, from 0.
    pub(crate) part: usize,
    /// The format.
    pub(crate) format: String,
    /// The run, if it keeps every requirement.
    pub(crate) good: Option<GoodRun>,
}

/// What is told of a good run.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct GoodRun {
    /// The largest fluctuation at cruise.
    pub(crate) fluctuation: f64,
    /// The fluctuation allowed over the one found; `None` where the run has none.
    pub(crate) margin: Option<f64>,
    /// The requirement of which most is used.
    pub(crate) limited_by: Option<Limiting>,
}

/// The requirement of a run that is nearest to being broken.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct Limiting {
    /// The quantity.
    pub(crate) what: String,
    /// The figure found as a share of its limit.
    pub(crate) used: f64,
    /// The line of the part where it was found, if it belongs to one.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub(crate) line: Option<usize>,
}

/// The name of the requirement by which the margin of a run is told.
const FLUCTUATION: &str = "feedrate fluctuation at cruise";

impl Limiting {
    /// Of a run, as JSON has it, the requirement with the greatest share of its limit; of several, the first.
    pub(crate) fn of(run: &Value) -> Option<Self> {
        let requirements = run["requirements"].as_array()?.iter();
        let used = requirements.filter_map(|one| {
            let (found, limit) = (one["found"].as_f64()?, one["limit"].as_f64()?);
            (limit > 0.0).then_some((one, found / limit))
        });
        let (one, used) = used.reduce(|worst, one| if one.1 > worst.1 { one } else { worst })?;
        let line = one["at"]["line"].as_u64().and_then(|line| usize::try_from(line).ok());
        Some(Self { what: one["what"].as_str()?.to_string(), used, line })
    }
}

/// The fluctuation allowed over the one found, of a run as JSON has it.
pub(crate) fn margin(run: &Value) -> Option<f64> {
    let mut requirements = run["requirements"].as_array()?.iter();
    let one = requirements.find(|one| one["what"] == FLUCTUATION)?;
    let margin = one["limit"].as_f64()? / one["found"].as_f64()?;
    // Where nothing fluctuates, as on a single straight move, the figure may be 0.
    margin.is_finite().then_some(margin)
}

impl GoodRun {
    pub(crate) fn of(run: &JudgedRun) -> Result<Self> {
        let fluctuation = run.fluctuation.map_or(0.0, |found| found.cruise_max_abs);
        let run = serde_json::to_value(run)?;
        Ok(Self { fluctuation, margin: margin(&run), limited_by: Limiting::of(&run) })
    }
}

impl Work for SetOfParts {
    type Line = SetLine;
    const NAME: &'static str = "set of parts";
    const LINE: &'static str = "part";
    const OPTION: &'static str = "--resume";
    const TOLD_BY: &'static str = "other parts or contents of them, another machine, list of formats, version or options";

    fn expect_plausible(&self) -> Result<()> {
        if self.parts.is_empty() {
            bail!("a set of no parts: expected at least one");
        }
        Ok(())
    }

    /// The part is one of the set, and what was run has a result.
    fn expect_of_it(&self, line: &SetLine) -> Result<()> {
        let part = match line {
            SetLine::Finished(Finished { part, ending }) => {
                if let PartEnding::Result(json) = ending
                    && !serde_json::from_str::<Value>(json).is_ok_and(|result| result["command"] == *self.set)
                {
                    bail!("part {part} has no result of `feedbits {}`", self.set);
                }
                *part
            }
            SetLine::Tried(tried) => tried.part,
        };
        if part >= self.parts.len() {
            bail!("part {part} is none of the {} of line 1", self.parts.len());
        }
        Ok(())
    }
}

/// All that is known of a set.
#[derive(Default)]
pub(crate) struct Known {
    finished: BTreeMap<usize, PartEnding>,
    tried: BTreeMap<(usize, String), Option<GoodRun>>,
}

impl Known {
    /// Takes in a line. What contradicts an earlier one is an error.
    pub(crate) fn add(&mut self, line: SetLine) -> Result<()> {
        match line {
            SetLine::Finished(Finished { part, ending }) => {
                if self.finished.get(&part).is_some_and(|known| *known != ending) {
                    bail!("part {part} has two results that contradict each other");
                }
                self.finished.insert(part, ending);
            }
            SetLine::Tried(Tried { part, format, good }) => {
                if self.tried.get(&(part, format.clone())).is_some_and(|known| *known != good) {
                    bail!("part {part} has two results in {format} that contradict each other");
                }
                self.tried.insert((part, format), good);
            }
        }
        Ok(())
    }

    /// How the work on a part ended.
    pub(crate) fn ending(&self, part: usize) -> Option<&PartEnding> {
        self.finished.get(&part)
    }

    /// The run of a part in a format that was tried; `Some(None)` if it was not good.
    pub(crate) fn tried(&self, part: usize, format: &str) -> Option<Option<&GoodRun>> {
        self.tried.get(&(part, format.to_string())).map(Option::as_ref)
    }

    /// The parts that are finished.
    pub(crate) fn len(&self) -> usize {
        self.finished.len()
    }

    /// Every line, in order: the finished parts, then what was tried.
    pub(crate) fn lines(&self) -> impl Iterator<Item = SetLine> {
        let finished = self.finished.iter().map(|(part, ending)| finished(*part, ending));
        finished.chain(self.tried.iter().map(|((part, format), good)| tried(*part, format, good.as_ref())))
    }

    /// Every line about a part.
    pub(crate) fn lines_of(&self, part: usize) -> impl Iterator<Item = SetLine> {
        let finished = self.finished.get(&part).map(|ending| finished(part, ending));
        let of_part = self.tried.range((part, String::new())..(part + 1, String::new()));
        finished
            .into_iter()
            .chain(of_part.map(move |((_, format), good)| tried(part, format, good.as_ref())))
    }
}

fn finished(part: usize, ending: &PartEnding) -> SetLine {
    SetLine::Finished(Finished { part, ending: ending.clone() })
}

fn tried(part: usize, format: &str, good: Option<&GoodRun>) -> SetLine {
    SetLine::Tried(Tried { part, format: format.to_string(), good: good.cloned() })
}
