//! `--baseline`: the figures of a run beside those of an earlier one.
//!
//! The JSON of an earlier run is the baseline. Figures of which less is better are compared one by one, and a format
//! that was good must still be. A part is known by its text and a machine by its values, whatever their names.

use std::path::{Path, PathBuf};

use anyhow::{Context, Result, bail};
use clap::Args;
use domains::options::WORSE_BY;
use format_compare::{Engine, Machine};
use real::FormatName;
use serde::Serialize;
use serde_json::{Value, json};
use target_cost::Target;
use worse_figures::Figures;

use crate::ending::Ending;
use crate::input::Text;
use crate::numbers::number;
use crate::{files, output};

/// The version of the JSON of `compare`, `size` and `judge`. It grows when a key goes or changes its meaning.
pub(crate) const SCHEMA: u64 = 1;

/// The end of a command's name in the JSON of a set of parts.
const OF_SET: &str = "-set";

/// The largest result of an earlier set, which has that of each of its parts.
const MOST_OF_SET: usize = 1 << 30;

/// The JSON of a command's result, with the version of its keys.
#[derive(Serialize)]
struct Versioned<'a, T> {
    schema: u64,
    command: &'a str,
    part_crc32: String,
    #[serde(flatten)]
    result: &'a T,
}

/// The result of `command` as JSON, with the checksum of its part.
pub(crate) fn json<T: Serialize>(command: &str, part: u32, result: &T) -> Result<String> {
    let part_crc32 = checksum(part);
    Ok(serde_json::to_string_pretty(&Versioned { schema: SCHEMA, command, part_crc32, result })? + "\n")
}

fn checksum(part: u32) -> String {
    format!("{part:08x}")
}

/// Options of a command whose result can be compared with an earlier one.
#[derive(Args)]
pub(crate) struct BaselineArguments {
    /// The JSON of an earlier run of this command: end with status 3 if a figure has got worse since.
    #[arg(long, value_name = "FILE")]
    baseline: Option<PathBuf>,
    /// By how much a figure may grow over the baseline's, in per cent.
    #[arg(
        long,
        value_name = "PERCENT",
        default_value_t = 1.0,
        requires = "baseline",
        value_parser = number(&WORSE_BY)
    )]
    worse_by: f64,
}

/// An earlier result.
pub(crate) struct Baseline {
    path: PathBuf,
    result: Value,
    /// By how much a figure may grow, as a share.
    share: f64,
}

impl BaselineArguments {
    /// Whether there is a baseline, which has every figure of JSON.
    pub(crate) fn is_given(&self) -> bool {
        self.baseline.is_some()
    }

    /// The baseline that is asked for, if it is one of `command` for this part.
    pub(crate) fn read(&self, command: &str, part: &Text) -> Result<Option<Baseline>> {
        let Some((path, result)) = self.result_of(command)? else { return Ok(None) };
        expect_part(part, &result, &path)?;
        Ok(Some(Baseline { path, result, share: self.share() }))
    }

    /// The result of the baseline that is asked for, if it is one of `command`, with its path.
    pub(crate) fn result_of(&self, command: &str) -> Result<Option<(PathBuf, Value)>> {
        let Some(path) = &self.baseline else { return Ok(None) };
        let most = if command.ends_with(OF_SET) { MOST_OF_SET } else { files::MOST_OF_RESULT };
        let text = files::text("--baseline", path, most)?;
        let result: Value = serde_json::from_str(&text).with_context(|| path.display().to_string())?;
        expect_result_of(command, &result, path)?;
        Ok(Some((path.clone(), result)))
    }

    /// By how much a figure may grow, as a share.
    pub(crate) fn share(&self) -> f64 {
        self.worse_by / 100.0
    }
}

fn expect_result_of(command: &str, result: &Value, path: &Path) -> Result<()> {
    let path = path.display();
    let expected = match command.strip_suffix(OF_SET) {
        Some(command) => format!("expected what `feedbits {command} --json` prints of several parts"),
        None => format!("expected what `feedbits {command} --json` prints"),
    };
    let Some(schema) = result["schema"].as_u64() else { bail!("{path}: no \"schema\": {expected}") };
    if schema != SCHEMA {
        bail!("{path}: \"schema\" is {schema}, and this feedbits has {SCHEMA}: make the baseline again");
    }
    match result["command"].as_str() {
        Some(found) if found == command => Ok(()),
        found => bail!("{path}: \"command\" is \"{}\": {expected}", found.unwrap_or_default()),
    }
}

/// Refuses a baseline of another part, before this one is read.
fn expect_part(part: &Text, result: &Value, path: &Path) -> Result<()> {
    let (path, name) = (path.display(), &result["part"]["name"]);
    match result["part_crc32"].as_str() {
        Some(old) if old == checksum(part.checksum()) => Ok(()),
        Some(_) => bail!(
            "{path} is of the part {name}, and {:?} has another text, or is read by other options: expected the part of the baseline",
            part.name
        ),
        None => bail!("{path}: no \"part_crc32\", by which a part is known: make the baseline again"),
    }
}

/// The words for a verdict, from the best to the worst, as JSON has them.
const VERDICTS: [&str; 3] = ["good", "bad", "refused"];

impl Baseline {
    /// Says which figures of `result` are worse than those of the baseline. A good ending is [`Ending::WorseThanBaseline`] if one is.
    pub(crate) fn judge<T: Serialize>(&self, result: &T, ending: Ending) -> Result<Ending> {
        let worse = worse_figures(&self.result, &serde_json::to_value(result)?, self.share);
        let (path, per_cent) = (self.path.display(), 100.0 * self.share);
        if worse.is_empty() {
            output::note(&format!(
                "{} are at most {per_cent} % worse than in {path}",
                output::counted(figures(&self.result).len(), "figure", "figures")
            ));
            return Ok(ending);
        }
        output::say(&format!("feedbits: more than {per_cent} % worse than in {path}:"));
        worse.iter().for_each(|line| output::say(&format!("  {line}")));
        Ok(if ending == Ending::Good { Ending::WorseThanBaseline } else { ending })
    }

    /// Before any work, refuses a baseline of another machine.
    pub(crate) fn expect_machine(&self, machine: &Machine) -> Result<()> {
        let path = self.path.display();
        let (old, new) = (&self.result["machine"], serde_json::to_value(machine)?);
        if let Some((key, [old, new])) = differing_key(old, &new) {
            bail!("{path} was made with {key} = {old} in the machine file, and this run with {new}");
        }
        Ok(())
    }

    /// Before any work, refuses a baseline with runs or costs that this comparison leaves out.
    pub(crate) fn expect_runs(&self, runs: &[(String, Engine)], targets: &[Target]) -> Result<()> {
        let path = self.path.display();
        let runs: Vec<Value> =
            runs.iter().map(|(format, engine)| json!({"format": format, "engine": engine})).collect();
        for old in self.result["formats"].as_array().into_iter().flatten() {
            let (format, engine) = (&old["format"], &old["engine"]);
            if !runs.contains(&json!({"format": format, "engine": engine})) {
                bail!(
                    "{path} has a run in {format} by {engine}, and this comparison has none: give the options of the baseline"
                );
            }
            for (name, cost) in old["cycles"].as_object().into_iter().flatten() {
                let Some(target) = targets.iter().find(|target| target.name == *name) else {
                    bail!("{path} has costs on {name}, and this comparison has none: give --targets {name}");
                };
                if let Some([old, new]) = other_clock(cost, target, &old["format"]) {
                    bail!(
                        "{path} has costs on {name} at {old} MHz, and this comparison at {new}: give --clock {old}"
                    );
                }
            }
        }
        Ok(())
    }
}

/// The clock of an earlier cost and that of the target now, in MHz to seven digits, where they differ: all times differ then by
/// as much.
fn other_clock(cost: &Value, target: &Target, format: &Value) -> Option<[String; 2]> {
    let old = cost["max"].as_f64()? / cost["microseconds_max"].as_f64()?;
    let new = target.clock_mhz(FormatName::named(format.as_str()?)?)?.typical;
    let shown = [old, new]
        .map(|mhz| format!("{:.6e}", mhz).parse::<f64>().map(|mhz| mhz.to_string()).unwrap_or_default());
    (shown[0] != shown[1]).then_some(shown)
}

/// The first key that two tables do not have alike, with both values.
pub(crate) fn differing_key<'v>(old: &'v Value, new: &'v Value) -> Option<(&'v String, [&'v Value; 2])> {
    let keys = [old, new].into_iter().filter_map(Value::as_object).flat_map(|values| values.keys());
    let mut both = keys.map(|key| (key, [&old[key], &new[key]]));
    both.find(|(_, [old, new])| old != new)
}

/// The figures of a result that are worse by more than this share than those of an earlier one, each in words.
pub(crate) fn worse_figures(before: &Value, now: &Value, share: f64) -> Vec<String> {
    figures(now).worse_than(&figures(before), share)
}

/// The names of figures of a result that an earlier one has not.
pub(crate) fn new_figures(before: &Value, now: &Value) -> Vec<String> {
    figures(now).new_since(&figures(before))
}

/// The figures of a judged log.
fn figures_of_log(result: &Value) -> Figures {
    let mut figures = Figures::default();
    let judged =
        result["limits"].as_array().into_iter().flatten().filter(|one| one["verdict"] != "not_judged");
    for limit in judged {
        let what = limit["what"].as_str().unwrap_or_default();
        let [raw, taken] = ["raw", "taken"].map(|key| limit[key].as_f64());
        // The same motion, sampled a little later, may differ by what the resolution makes of it.
        let least = raw.zip(taken).map_or(0.0, |(raw, taken)| raw - taken);
        for (share, how) in [(raw, "as it is"), (taken, "at least")] {
            if let Some(share) = share {
                figures.add_from(format!("{what}, share of its limit {how}"), share, least);
            }
        }
    }
    for one in result["part"]["tolerances"].as_array().into_iter().flatten() {
        let number = |key: &str| one[key].as_f64().unwrap_or(0.0);
        let (p, q) = (number("rounding_mm"), number("merging_mm"));
        figures.add(format!("distance as a share of G64 P{p} Q{q}"), number("share"), (p + q) / p);
    }
    let mut add = |name: &str, value: &Value, least: f64| {
        if let Some(value) = value.as_f64() {
            figures.add_from(name.to_string(), value, least);
        }
    };
    add("rows that are there twice", &result["doubled"]["rows"], 0.0);
    add("rows that are missing", &result["missing"]["rows"], 0.0);
    add("places with missing rows", &result["missing"]["places"], 0.0);
    let part = &result["part"];
    // A distance that the resolution of three axes makes is none.
    let least = 3.0_f64.sqrt() * result["resolution_mm"].as_f64().unwrap_or(0.0);
    add("distance from the path in mm", &part["nearest"]["mm"], least);
    add("distance of rapid moves from the path in mm", &part["nearest_rapid"]["mm"], least);
    add("distance in order in mm", &part["order_mm"], least);
    add("distance of the path from the log in mm", &part["path_to_log_mm"], least);
    add("chord error in mm", &part["chord_error"]["mm"], least);
    add("path not visited in mm", &part["never_visited_mm"], least);
    let hidden = part["fluctuation"]["hidden"].as_f64().unwrap_or(0.0);
    add("fluctuation at cruise", &part["fluctuation"]["share"], hidden);
    if let Some(over) = part["over_feed"].as_array() {
        figures.add("lines above their feed".to_string(), over.len() as f64, 0.0);
    }
    figures
}

/// The figures of a result, by their names.
fn figures(result: &Value) -> Figures {
    if result["command"] == "judge" {
        return figures_of_log(result);
    }
    let mut figures = Figures::default();
    let add = |figures: &mut Figures, name: String, value: &Value, limit: &Value| {
        if let Some(value) = value.as_f64() {
            figures.add(name, value, limit.as_f64().unwrap_or(0.0));
        }
    };
    let no_limit = &Value::Null;
    for (name, [of, key]) in [
        ("planned time in s", ["part", "planned_time_s"]),
        ("fewest bits", ["fewest_bits", "bits"]),
        ("bits in one format", ["uniform", "bits"]),
        ("bits of all registers", ["mixed", "bits"]),
    ] {
        add(&mut figures, name.to_string(), &result[of][key], no_limit);
    }
    for run in result["formats"].as_array().into_iter().flatten() {
        let text = |key: &str| run[key].as_str().unwrap_or_default();
        let of = |what: &str| format!("{} {}: {what}", text("format"), text("engine"));
        figures.add_word(of("verdict"), run["verdict"]["result"].as_str().unwrap_or_default(), &VERDICTS);
        add(&mut figures, of("evaluations of a step"), &run["evaluations"]["max"], no_limit);
        add(&mut figures, of("periods"), &run["periods"], no_limit);
        for requirement in run["requirements"].as_array().into_iter().flatten() {
            let what = requirement["what"].as_str().unwrap_or_default();
            add(&mut figures, of(what), &requirement["found"], &requirement["limit"]);
        }
        for (target, cost) in run["cycles"].as_object().into_iter().flatten() {
            add(&mut figures, of(&format!("dearest period on {target}")), &cost["max"], no_limit);
        }
    }
    figures
}
