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
    /// What a part breaks in a format that is too narrow for it.
    Broken(Broken),
}

impl SetLine {
    /// The number of the part.
    pub(crate) fn part(&self) -> usize {
        match self {
            Self::Finished(finished) => finished.part,
            Self::Tried(tried) => tried.part,
            Self::Broken(broken) => broken.part,
        }
    }

    /// The same line of another part.
    pub(crate) fn of_part(self, part: usize) -> Self {
        match self {
            Self::Finished(finished) => Self::Finished(Finished { part, ..finished }),
            Self::Tried(tried) => Self::Tried(Tried { part, ..tried }),
            Self::Broken(broken) => Self::Broken(Broken { part, ..broken }),
        }
    }
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

/// What a part breaks in a format.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct Broken {
    /// The number of the part in the set, from 0.
    pub(crate) part: usize,
    /// The format.
    pub(crate) format: String,
    /// The first requirement that is broken; none if the path cannot be run at all.
    pub(crate) by: Option<Limiting>,
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

/// A requirement of a run: the one that is nearest to being broken, or that is broken.
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

/// The requirements that tell how finely a format computes. The others are taken up by the plan in every format: it runs at the limits.
const OF_FORMAT: [&str; 5] = [
    "step of the format in a period's way",
    FLUCTUATION,
    "position error",
    "distance from the end of the path",
    "step of the filament's position",
];

impl Limiting {
    /// Of a good run, as JSON has it, the requirement on the format with the greatest share of its limit; of several, the first.
    pub(crate) fn of(run: &Value) -> Option<Self> {
        let requirements = run["requirements"].as_array()?.iter();
        let of_format = requirements.filter(|one| OF_FORMAT.iter().any(|what| one["what"] == *what));
        let used = of_format.filter_map(Self::one);
        used.reduce(|worst, one| if one.used > worst.used { one } else { worst })
    }

    /// Of a run, as JSON has it, the first requirement that is broken.
    pub(crate) fn broken_by(run: &Value) -> Option<Self> {
        let holds = |one: &Value| {
            one["found"].as_f64().zip(one["limit"].as_f64()).is_some_and(|(found, limit)| found <= limit)
        };
        run["requirements"].as_array()?.iter().find(|one| !holds(one)).and_then(Self::one)
    }

    /// A requirement, as JSON has it. One that is broken by no number, or has the limit 0, is used without end.
    fn one(requirement: &Value) -> Option<Self> {
        let (found, limit) = (requirement["found"].as_f64(), requirement["limit"].as_f64()?);
        let used = found.filter(|_| limit > 0.0).map_or(f64::MAX, |found| found / limit);
        let line = requirement["at"]["line"].as_u64().and_then(|line| usize::try_from(line).ok());
        Some(Self { what: requirement["what"].as_str()?.to_string(), used, line })
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
    const TOLD_BY: &'static str =
        "other parts or contents of them, another machine, list of formats, version or options";

    fn expect_plausible(&self) -> Result<()> {
        if self.parts.is_empty() {
            bail!("a set of no parts: expected at least one");
        }
        Ok(())
    }

    /// The part is one of the set, and what was run has a result.
    fn expect_of_it(&self, line: &SetLine) -> Result<()> {
        let part = line.part();
        if let SetLine::Finished(Finished { ending: PartEnding::Result(json), .. }) = line
            && !serde_json::from_str::<Value>(json).is_ok_and(|result| result["command"] == *self.set)
        {
            bail!("part {part} has no result of `feedbits {}`", self.set);
        }
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
    broken: BTreeMap<(usize, String), Option<Limiting>>,
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
            SetLine::Broken(Broken { part, format, by }) => {
                if self.broken.get(&(part, format.clone())).is_some_and(|known| *known != by) {
                    bail!("part {part} breaks two things in {format} that contradict each other");
                }
                self.broken.insert((part, format), by);
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

    /// Whether a part was tried in a format that is not good for it.
    pub(crate) fn has_failed(&self, part: usize) -> bool {
        let of_part = (part, String::new())..(part + 1, String::new());
        self.tried.range(of_part).any(|(_, good)| good.is_none())
    }

    /// What a part breaks first in a format that is too narrow for it, if that is known.
    pub(crate) fn broken(&self, part: usize, format: &str) -> Option<Option<&Limiting>> {
        self.broken.get(&(part, format.to_string())).map(Option::as_ref)
    }

    /// Whether there is such a line, with whatever result.
    pub(crate) fn has(&self, line: &SetLine) -> bool {
        match line {
            SetLine::Finished(finished) => self.ending(finished.part).is_some(),
            SetLine::Tried(tried) => self.tried(tried.part, &tried.format).is_some(),
            SetLine::Broken(broken) => self.broken(broken.part, &broken.format).is_some(),
        }
    }

    /// The parts that are finished.
    pub(crate) fn len(&self) -> usize {
        self.finished.len()
    }

    /// Every line, in order of the parts.
    pub(crate) fn lines(&self, parts: usize) -> impl Iterator<Item = SetLine> {
        (0..parts).flat_map(|part| self.lines_of(part))
    }

    /// Every line about a part: its end, what it was tried in, and what it breaks.
    pub(crate) fn lines_of(&self, part: usize) -> impl Iterator<Item = SetLine> {
        let of_part = (part, String::new())..(part + 1, String::new());
        let finished = self.finished.get(&part).into_iter();
        let finished =
            finished.map(move |ending| SetLine::Finished(Finished { part, ending: ending.clone() }));
        let tried = self.tried.range(of_part.clone()).map(move |((_, format), good)| {
            SetLine::Tried(Tried { part, format: format.clone(), good: good.clone() })
        });
        let broken = self.broken.range(of_part).map(move |((_, format), by)| {
            SetLine::Broken(Broken { part, format: format.clone(), by: by.clone() })
        });
        finished.chain(tried).chain(broken)
    }
}
