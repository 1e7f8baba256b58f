//! An earlier comparison, as its JSON has it, beside a new one.

use std::collections::BTreeMap;
use std::fmt;

use serde_json::Value;
use worse_figures::Figures;

use crate::compare::Comparison;
use crate::refusal::Refusal;

/// An earlier comparison of a kernel.
#[derive(Clone, Debug, PartialEq)]
pub struct Baseline {
    kernel: String,
    steps: u64,
    formats: BTreeMap<String, Figures>,
}

/// What has become of the formats since. Formats are known by their names.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Since {
    /// Formats that the earlier comparison had not: nothing is said of them.
    pub new: Vec<String>,
    /// Formats that it had, and the new one has not.
    pub gone: Vec<String>,
    /// The verdicts and errors that are worse, in words.
    pub worse: Vec<String>,
}

/// The words for a verdict.
const VERDICTS: [&str; 2] = ["good", "bad"];

impl Baseline {
    /// Reads what [`Comparison::json`] wrote.
    ///
    /// # Errors
    /// [`Refusal::Baseline`] if the text is something else.
    pub fn read(json: &str) -> Result<Self, Refusal> {
        let value = serde_json::from_str(json).map_err(|error| Refusal::Baseline(error.to_string()))?;
        Self::of(&value).ok_or_else(|| Refusal::Baseline("expected what Comparison::json writes".to_string()))
    }

    fn of(comparison: &Value) -> Option<Self> {
        Some(Self {
            kernel: comparison["kernel"].as_str()?.to_string(),
            steps: comparison["steps"].as_u64()?,
            formats: comparison["formats"].as_array()?.iter().map(figures).collect::<Option<_>>()?,
        })
    }

    /// What has become of the formats in a new comparison of the same kernel over as many steps. An error may grow by the
    /// `share` of itself, or of a thousandth of its limit where that is more.
    ///
    /// # Errors
    /// [`Refusal::Baseline`] if the baseline is one of another kernel or of another number of steps.
    pub fn since(&self, comparison: &Comparison, share: f64) -> Result<Since, Refusal> {
        let wrong = || Refusal::Baseline("expected a comparison that has JSON".to_string());
        let now =
            serde_json::to_value(comparison).ok().and_then(|value| Self::of(&value)).ok_or_else(wrong)?;
        if (&self.kernel, self.steps) != (&now.kernel, now.steps) {
            let of = |one: &Self| format!("{:?} over {} steps", one.kernel, one.steps);
            return Err(Refusal::Baseline(format!("it is of {}: expected one of {}", of(self), of(&now))));
        }
        let without = |some: &Self, others: &Self| {
            some.formats.keys().filter(|name| !others.formats.contains_key(*name)).cloned().collect()
        };
        let both = self.formats.iter().filter_map(|(name, old)| Some((name, old, now.formats.get(name)?)));
        let worse = both.flat_map(|(name, old, new)| {
            new.worse_than(old, share).into_iter().map(move |figure| format!("{name}: {figure}"))
        });
        Ok(Since { new: without(&now, self), gone: without(self, &now), worse: worse.collect() })
    }
}

/// A format's name and figures.
fn figures(run: &Value) -> Option<(String, Figures)> {
    let mut figures = Figures::default();
    let verdict = if run["good"].as_bool()? { "good" } else { "bad" };
    figures.add_word("verdict".to_string(), verdict, &VERDICTS);
    for output in run["outputs"].as_array()? {
        for required in output["requirements"].as_array()? {
            // What is no number has no figure in JSON: it is missing then, and so it is worse.
            if let Some(found) = required["found"].as_f64() {
                let name = format!("{} error of {}", required["kind"].as_str()?, output["output"].as_str()?);
                figures.add(name, found, required["limit"].as_f64()?);
            }
        }
    }
    Some((run["format"].as_str()?.to_string(), figures))
}

impl Since {
    /// Whether a format is gone or worse.
    #[must_use]
    pub fn is_worse(&self) -> bool {
        !(self.gone.is_empty() && self.worse.is_empty())
    }
}

impl fmt::Display for Since {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let named = |f: &mut fmt::Formatter<'_>, what: &str, names: &[String]| match names {
            [] => Ok(()),
            names => writeln!(f, "{what}: {}", names.join(", ")),
        };
        named(f, "new, and not compared", &self.new)?;
        named(f, "gone", &self.gone)?;
        self.worse.iter().try_for_each(|line| writeln!(f, "{line}"))?;
        if self.is_worse() { Ok(()) } else { writeln!(f, "no format is worse than in the baseline") }
    }
}
