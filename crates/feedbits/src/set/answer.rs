//! The answer for a set: what is enough for all parts, and what each part needs.

use std::collections::BTreeMap;

use anyhow::Result;
use real::FormatName;
use serde::Serialize;
use serde_json::Value;

use crate::set::formats::FormatOfSet;
use crate::set::known::{GoodRun, Limiting, PartEnding, SetOfParts, margin};
use crate::set::registers::RegistersOfSet;
use crate::set::search::Search;
use crate::set::work::{OfEachPart, OwnAnswer};

/// The answer for a set.
#[derive(Clone, Debug, Serialize)]
pub(crate) struct Answer {
    /// Number of parts.
    pub(crate) parts: usize,
    /// Number of parts that were run.
    pub(crate) parts_run: usize,
    /// Number of parts that cannot be read.
    pub(crate) parts_unread: usize,
    /// Number of parts that cannot be planned or run on the machine.
    pub(crate) parts_refused: usize,
    /// Number of parts that are not run yet: those of other shards, or those that Ctrl-C has left out.
    pub(crate) parts_unfinished: usize,
    /// How long the plans of all parts take together, in s.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(crate) planned_time_s: Option<f64>,
    /// The fewest bits that are enough for all parts that any are enough for.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(crate) fewest_bits: Option<FewestOfSet>,
    /// The format that is good for all parts and comes first: by its bits, or by its worst cost on the first target.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(crate) recommended: Option<String>,
    /// The form of the path in which it is good.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(crate) recommended_engine: Option<String>,
    /// The cheapest format on each target, by its worst cost over the parts, of those that are good for all.
    #[serde(skip_serializing_if = "BTreeMap::is_empty")]
    pub(crate) recommended_on: BTreeMap<String, [String; 2]>,
    /// Each format and form of the path over all parts; of `compare`.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub(crate) formats: Vec<FormatOfSet>,
    /// A register for each signal that is enough for all parts; of `size`.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(crate) registers: Option<RegistersOfSet>,
}

/// The fewest bits for a set.
#[derive(Clone, Debug, Serialize)]
pub(crate) struct FewestOfSet {
    /// The format, or none if no format of up to 48 bits is good for all these parts.
    pub(crate) format: Option<String>,
    /// Its width.
    pub(crate) bits: Option<u32>,
    /// The least margin of a part, and the part.
    pub(crate) margin: Option<f64>,
    pub(crate) margin_part: Option<String>,
    /// Number of parts for which it is good: all that any format is good for.
    pub(crate) parts: usize,
    /// The part that needs so many bits, if there is one such part.
    pub(crate) decides: Option<Deciding>,
    /// The parts that need the widest format alone, at most ten of them.
    pub(crate) needed_by: Vec<Needing>,
    /// The parts for which no format is enough, and why.
    pub(crate) none_for: Vec<NoneFor>,
}

/// A part without which fewer bits were enough.
#[derive(Clone, Debug, Serialize)]
pub(crate) struct Deciding {
    pub(crate) part: String,
    /// The format with a fraction bit fewer, and what the part breaks first in it.
    pub(crate) narrower: Option<String>,
    pub(crate) breaks: Option<Limiting>,
    /// The fewest bits without the part; null if it is the only one.
    pub(crate) bits_without: Option<u32>,
}

/// A part with its own answer.
#[derive(Clone, Debug, Serialize)]
pub(crate) struct Needing {
    pub(crate) part: String,
    pub(crate) format: String,
    pub(crate) bits: u32,
}

/// A part that no format of the search is good for.
#[derive(Clone, Debug, Serialize)]
pub(crate) struct NoneFor {
    pub(crate) part: String,
    pub(crate) why: String,
}

/// A part in a line.
#[derive(Clone, Debug, Serialize)]
pub(crate) struct PartLine {
    pub(crate) name: String,
    pub(crate) status: PartStatus,
    /// Why it cannot be read or run, or what the recommended format breaks.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(crate) why: Option<String>,
    /// How long its plan takes.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(crate) planned_time_s: Option<f64>,
    /// The fewest bits that are enough for it alone, and the format.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(crate) bits: Option<u32>,
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(crate) format: Option<String>,
    /// The margin of the format that is recommended for the set, or else of the fewest bits for the set.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(crate) margin: Option<f64>,
    /// What of that run is nearest to being broken.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(crate) limited_by: Option<Limiting>,
}

/// How a part ended.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Serialize)]
#[serde(rename_all = "snake_case")]
pub(crate) enum PartStatus {
    /// It cannot be read.
    Unread,
    /// It cannot be planned or run on the machine.
    Refused,
    /// No format is good for it.
    Bad,
    /// A format is good for it.
    Good,
    /// It is not run yet.
    Unfinished,
}

impl PartStatus {
    /// As JSON has it.
    pub(crate) fn word(self) -> &'static str {
        match self {
            Self::Unread => "unread",
            Self::Refused => "refused",
            Self::Bad => "bad",
            Self::Good => "good",
            Self::Unfinished => "unfinished",
        }
    }
}

/// What the parts that were run say of the fewest bits.
pub(crate) struct OwnAnswers {
    pub(crate) found: BTreeMap<usize, (FormatName, Option<f64>)>,
    pub(crate) none: BTreeMap<usize, String>,
}

impl OwnAnswers {
    pub(crate) fn of<W: OfEachPart>(work: &W, results: &BTreeMap<usize, Value>) -> Self {
        let mut answers = Self { found: BTreeMap::new(), none: BTreeMap::new() };
        for (part, result) in results {
            match work.own_answer(result) {
                OwnAnswer::Found { format, margin } => drop(answers.found.insert(*part, (format, margin))),
                OwnAnswer::None(why) => drop(answers.none.insert(*part, why)),
                OwnAnswer::NotSearched => {}
            }
        }
        answers
    }

    /// The formats alone.
    pub(crate) fn formats(&self) -> BTreeMap<usize, FormatName> {
        self.found.iter().map(|(part, (format, _))| (*part, *format)).collect()
    }
}

/// Parts that are named as those which need the widest format.
const MOST_NAMED: usize = 10;

/// Searches the fewest bits for the set, and says what they are; `None` if they were not asked for.
pub(crate) fn fewest<W: OfEachPart>(search: &Search<'_, W>, own: &OwnAnswers) -> Result<Option<FewestOfSet>> {
    if own.found.is_empty() && own.none.is_empty() {
        return Ok(None);
    }
    let found = search.fewest(&own.formats())?;
    let (name, store) = (|part: usize| search.files[part].name.clone(), search.store());
    let run =
        |part: usize| -> Option<&GoodRun> { store.known().tried(part, &found.format?.to_string()).flatten() };
    // The margin of a part whose own answer it is, or of its run in it.
    let margins = own.found.iter().filter_map(|(part, (format, margin))| {
        let margin = if Some(*format) == found.format { *margin } else { run(*part)?.margin };
        Some((margin?, *part))
    });
    let least = margins.min_by(|one, other| one.0.total_cmp(&other.0)).filter(|_| found.format.is_some());
    let most = own.found.values().map(|(format, _)| format.bits()).max();
    let widest = own.found.iter().filter(|(_, (format, _))| Some(format.bits()) == most).take(MOST_NAMED);
    let needing = |(part, (format, _)): (&usize, &(FormatName, Option<f64>))| Needing {
        part: name(*part),
        format: format.to_string(),
        bits: format.bits(),
    };
    let none_for = own.none.iter().map(|(part, why)| NoneFor { part: name(*part), why: why.clone() });
    Ok(Some(FewestOfSet {
        format: found.format.map(|format| format.to_string()),
        bits: found.format.map(FormatName::bits),
        margin: least.map(|(margin, _)| margin),
        margin_part: least.map(|(_, part)| name(part)),
        parts: own.found.len(),
        decides: found.decides.map(|part| Deciding {
            part: name(part),
            narrower: found.narrower.map(|narrower| narrower.to_string()),
            breaks: found
                .narrower
                .and_then(|narrower| store.known().broken(part, &narrower.to_string())?.cloned()),
            bits_without: found.without.map(FormatName::bits),
        }),
        needed_by: widest.map(needing).collect(),
        none_for: none_for.collect(),
    }))
}

/// The run of a format by an engine in the result of a part, as JSON has it.
pub(crate) fn run_in<'v>(result: &'v Value, format: &str, engine: &str) -> Option<&'v Value> {
    let mut runs = result["formats"].as_array()?.iter();
    runs.find(|run| run["format"] == format && run["engine"] == engine)
}

/// A line for each part, in the order of the set.
pub(crate) fn lines<W: OfEachPart>(
    search: &Search<'_, W>,
    results: &BTreeMap<usize, Value>,
    answer: &Answer,
) -> Vec<PartLine> {
    let recommended = answer.recommended.as_deref().zip(answer.recommended_engine.as_deref());
    let fewest = answer.fewest_bits.as_ref().and_then(|fewest| fewest.format.as_deref());
    let store = search.store();
    let of = |part: usize| {
        let mut line = PartLine::new(&search.files[part].name);
        match (store.known().ending(part), results.get(&part)) {
            (Some(PartEnding::Unread(why)), _) => line.refused(PartStatus::Unread, why),
            (Some(PartEnding::Refused(why)), _) => line.refused(PartStatus::Refused, why),
            (Some(PartEnding::Result(_)), Some(result)) => {
                let own = search.work.own_answer(result);
                line.run(result, &own);
                let in_recommended = recommended.and_then(|(format, engine)| run_in(result, format, engine));
                if let Some(run) = in_recommended {
                    (line.margin, line.limited_by) = (margin(run), Limiting::of(run));
                } else if let Some(format) = fewest {
                    line.in_fewest(format, &own, store.known().tried(part, format).flatten());
                }
            }
            _ => {}
        }
        line
    };
    (0..search.files.len()).map(of).collect()
}

impl PartLine {
    fn new(name: &str) -> Self {
        Self {
            name: name.to_string(),
            status: PartStatus::Unfinished,
            why: None,
            planned_time_s: None,
            bits: None,
            format: None,
            margin: None,
            limited_by: None,
        }
    }

    fn refused(&mut self, status: PartStatus, why: &str) {
        (self.status, self.why) = (status, Some(why.to_string()));
    }

    /// What the result of the part says.
    fn run(&mut self, result: &Value, own: &OwnAnswer) {
        self.planned_time_s = result["part"]["planned_time_s"].as_f64();
        let is_good = result["recommended"].is_string() || result["uniform"].is_object();
        self.status = if is_good { PartStatus::Good } else { PartStatus::Bad };
        match own {
            OwnAnswer::Found { format, .. } => {
                (self.bits, self.format) = (Some(format.bits()), Some(format.to_string()));
            }
            OwnAnswer::None(why) => self.why = Some(why.clone()),
            OwnAnswer::NotSearched => {}
        }
        if !is_good {
            let why = result["formats"][0]["verdict"]["reasons"].as_array();
            let first = why.and_then(|reasons| reasons.first()?.as_str());
            self.why = first.map(str::to_string).or(self.why.take());
        }
    }

    /// What is known of the part's run in the fewest bits for the set.
    fn in_fewest(&mut self, name: &str, own: &OwnAnswer, tried: Option<&GoodRun>) {
        match (own, tried) {
            (_, Some(run)) => (self.margin, self.limited_by) = (run.margin, run.limited_by.clone()),
            (OwnAnswer::Found { format, margin }, None) if format.to_string() == name => {
                self.margin = *margin
            }
            _ => {}
        }
    }
}

impl Answer {
    /// How the parts of a set ended, without what is good for all of them.
    pub(crate) fn of_endings<W: OfEachPart>(
        search: &Search<'_, W>,
        results: &BTreeMap<usize, Value>,
        set: &SetOfParts,
    ) -> Self {
        let store = search.store();
        let count = |is: fn(&PartEnding) -> bool| {
            (0..set.parts.len()).filter(|part| store.known().ending(*part).is_some_and(is)).count()
        };
        let times = results.values().filter_map(|result| result["part"]["planned_time_s"].as_f64());
        let times: Vec<f64> = times.collect();
        Self {
            parts: set.parts.len(),
            parts_run: results.len(),
            parts_unread: count(|ending| matches!(ending, PartEnding::Unread(_))),
            parts_refused: count(|ending| matches!(ending, PartEnding::Refused(_))),
            parts_unfinished: set.parts.len() - store.known().len(),
            planned_time_s: (!times.is_empty()).then(|| times.iter().sum()),
            fewest_bits: None,
            recommended: None,
            recommended_engine: None,
            recommended_on: BTreeMap::new(),
            formats: Vec::new(),
            registers: None,
        }
    }

    /// The parts that cannot be read or run.
    pub(crate) fn not_run(&self) -> usize {
        self.parts_unread + self.parts_refused
    }
}
