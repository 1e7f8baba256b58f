//! Each format of a comparison over all parts of a set: in how many it is good, its least margin, and its worst cost.

use std::collections::BTreeMap;

use serde::Serialize;
use serde_json::Value;

use crate::set::known::{Limiting, margin};

/// A format by an engine over all parts that were run.
#[derive(Clone, Debug, Serialize)]
pub(crate) struct FormatOfSet {
    pub(crate) format: String,
    pub(crate) bits: u64,
    pub(crate) engine: String,
    /// Number of parts for which it is good, and of those that were run.
    pub(crate) good: usize,
    pub(crate) of: usize,
    /// The least margin of the parts for which it is good, and that part.
    pub(crate) margin: Option<f64>,
    pub(crate) margin_part: Option<String>,
    /// What of all its good runs is nearest to being broken, and in which part.
    pub(crate) limited_by: Option<Limiting>,
    pub(crate) limited_part: Option<String>,
    /// The first part for which it is not good, and why.
    pub(crate) bad_part: Option<String>,
    pub(crate) bad_why: Option<String>,
    /// The worst cost of a period on each target; null where the cost of a part is not known.
    #[serde(skip_serializing_if = "BTreeMap::is_empty")]
    pub(crate) cycles: BTreeMap<String, Option<CostOfSet>>,
}

/// The dearest period of all parts.
#[derive(Clone, Debug, Serialize)]
pub(crate) struct CostOfSet {
    /// The part that has it.
    pub(crate) part: String,
    pub(crate) max: f64,
    pub(crate) microseconds_max: Option<f64>,
    pub(crate) share_of_period: Option<f64>,
    /// The most blocks and LUTs that a part takes.
    pub(crate) dsp_blocks: Option<f64>,
    pub(crate) luts: Option<f64>,
}

impl FormatOfSet {
    pub(crate) fn is_good_for_all(&self) -> bool {
        self.good == self.of && self.of > 0
    }

    /// Every format of the results, in their order. `results` are of one call: each has the same formats.
    pub(crate) fn all(results: &[(&str, &Value)]) -> Vec<Self> {
        let Some((_, first)) = results.first() else { return Vec::new() };
        let rows = first["formats"].as_array().map_or(0, Vec::len);
        (0..rows).map(|row| Self::of_row(results, row)).collect()
    }

    fn of_row(results: &[(&str, &Value)], row: usize) -> Self {
        let runs: Vec<_> = results.iter().map(|(part, result)| (*part, &result["formats"][row])).collect();
        let is_good = |run: &Value| run["verdict"]["result"] == "good";
        let good: Vec<_> = runs.iter().filter(|(_, run)| is_good(run)).copied().collect();
        let margins = good.iter().filter_map(|(part, run)| Some((margin(run)?, *part)));
        let least = margins.min_by(|one, other| one.0.total_cmp(&other.0));
        let limiting = good.iter().filter_map(|(part, run)| Some((Limiting::of(run)?, *part)));
        let most_used = limiting.reduce(|worst, one| if one.0.used > worst.0.used { one } else { worst });
        let bad = runs.iter().find(|(_, run)| !is_good(run));
        let text = |key: &str| runs.first().and_then(|(_, run)| run[key].as_str()).unwrap_or_default();
        let targets = runs.first().and_then(|(_, run)| run["cycles"].as_object());
        let targets = targets.into_iter().flat_map(serde_json::Map::keys);
        Self {
            format: text("format").to_string(),
            bits: runs.first().and_then(|(_, run)| run["bits"].as_u64()).unwrap_or_default(),
            engine: text("engine").to_string(),
            good: good.len(),
            of: runs.len(),
            margin: least.map(|(margin, _)| margin),
            margin_part: least.map(|(_, part)| part.to_string()),
            limited_part: most_used.as_ref().map(|(_, part)| (*part).to_string()),
            limited_by: most_used.map(|(limiting, _)| limiting),
            bad_part: bad.map(|(part, _)| (*part).to_string()),
            bad_why: bad.map(|(_, run)| why(run)),
            cycles: targets.map(|target| (target.clone(), CostOfSet::of(&runs, target))).collect(),
        }
    }
}

/// Why a run is not good, in a few words.
fn why(run: &Value) -> String {
    let reasons = &run["verdict"]["reasons"];
    let first = reasons.as_str().or_else(|| reasons[0].as_str());
    first.unwrap_or_default().to_string()
}

impl CostOfSet {
    /// The worst of each figure; `None` if a part that is run has no known cost.
    fn of(runs: &[(&str, &Value)], target: &str) -> Option<Self> {
        let ran = runs.iter().filter(|(_, run)| run["verdict"]["result"] != "refused");
        let costs: Vec<_> = ran.map(|(part, run)| (*part, &run["cycles"][target])).collect();
        if costs.iter().any(|(_, cost)| !cost["max"].is_number()) {
            return None;
        }
        let most = |key: &str| {
            let figures = costs.iter().filter_map(|(_, cost)| cost[key].as_f64());
            figures.reduce(f64::max)
        };
        let max = most("max")?;
        let part = costs.iter().find(|(_, cost)| cost["max"].as_f64() == Some(max))?.0.to_string();
        let [microseconds_max, share_of_period, dsp_blocks, luts] =
            ["microseconds_max", "share_of_period", "dsp_blocks", "luts"].map(most);
        Some(Self { part, max, microseconds_max, share_of_period, dsp_blocks, luts })
    }

    /// By what a format is dear: its blocks first, and then its LUTs on an FPGA, its time on a processor.
    fn price(&self) -> [f64; 3] {
        [self.dsp_blocks.unwrap_or(0.0), self.luts.unwrap_or(0.0), self.microseconds_max.unwrap_or(self.max)]
    }
}

/// The cheapest format on a target of those that are good for all parts and fit the period there; of formats that cost as much, the
/// first.
pub(crate) fn cheapest<'f>(formats: &'f [FormatOfSet], target: &str) -> Option<&'f FormatOfSet> {
    let priced = formats.iter().filter(|format| format.is_good_for_all()).filter_map(|format| {
        let cost = format.cycles.get(target)?.as_ref()?;
        (cost.share_of_period.is_none_or(|share| share <= 1.0)).then(|| (cost.price(), format))
    });
    let (_, cheapest) = priced.reduce(|best, one| if one.0 < best.0 { one } else { best })?;
    Some(cheapest)
}
