//! `--baseline` of a set: its parts beside those of an earlier call.

use std::collections::BTreeMap;
use std::path::PathBuf;

use anyhow::{Result, bail};
use serde_json::Value;

use crate::baseline::{BaselineArguments, differing_key, worse_figures};
use crate::ending::Ending;
use crate::output;
use crate::set::answer::Answer;

/// The JSON of an earlier set.
pub(crate) struct SetBaseline {
    path: PathBuf,
    result: Value,
    /// By how much a figure may grow, as a share.
    share: f64,
}

/// Lines and names in a message, at most.
const MOST_LINES: usize = 20;

impl SetBaseline {
    /// The baseline that is asked for, if it is one of a set of `command`.
    pub(crate) fn read(arguments: &BaselineArguments, command: &str) -> Result<Option<Self>> {
        let Some((path, result)) = arguments.result_of(&format!("{command}-set"))? else { return Ok(None) };
        Ok(Some(Self { path, result, share: arguments.share() }))
    }

    /// The result of each part that was run, by the part's name.
    fn results(&self) -> BTreeMap<&str, &Value> {
        let parts = self.result["parts"].as_array().into_iter().flatten();
        let parts = parts.filter(|part| part["result"].is_object());
        parts.filter_map(|part| Some((part["name"].as_str()?, &part["result"]))).collect()
    }

    /// Refuses a baseline of another machine, before anything is printed.
    pub(crate) fn expect_machine(&self, now: &BTreeMap<String, &Value>) -> Result<()> {
        for (name, old) in self.results() {
            let Some(new) = now.get(name).filter(|new| is_same_text(old, new)) else { continue };
            if let Some((key, [old, new])) = differing_key(&old["machine"], &new["machine"]) {
                bail!(
                    "{}: {name} was run with {key} = {old} in the machine file, and in this call with {new}",
                    self.path.display()
                );
            }
        }
        Ok(())
    }

    /// Says which parts are new, changed and gone, and which figures are worse. A good ending is [`Ending::WorseThanBaseline`] if a figure is
    /// worse, or a part is gone that was run before.
    pub(crate) fn judge(
        &self,
        answer: &Answer,
        now: &BTreeMap<String, &Value>,
        ending: Ending,
    ) -> Result<Ending> {
        let before = self.results();
        let (path, per_cent) = (self.path.display(), 100.0 * self.share);
        let new: Vec<&str> =
            now.keys().map(String::as_str).filter(|name| !before.contains_key(name)).collect();
        let changed: Vec<&str> = before
            .iter()
            .filter(|(name, old)| now.get(**name).is_some_and(|new| !is_same_text(old, new)))
            .map(|(name, _)| *name)
            .collect();
        let gone: Vec<&str> = before.keys().copied().filter(|name| !now.contains_key(*name)).collect();
        say_names("new", "are not in", &new, &path.to_string());
        say_names("changed", "have another text than in", &changed, &path.to_string());
        let mut worse: Vec<String> =
            gone.iter().map(|name| format!("{name} was run, and is gone or refused now")).collect();
        let of_set = worse_figures(&self.result["answer"], &serde_json::to_value(answer)?, self.share);
        worse.extend(of_set.into_iter().map(|figure| format!("all parts: {figure}")));
        let mut compared = 0;
        for (name, old) in &before {
            let Some(new) = now.get(*name).filter(|new| is_same_text(old, new)) else { continue };
            compared += 1;
            worse.extend(
                worse_figures(old, new, self.share).into_iter().map(|figure| format!("{name}: {figure}")),
            );
        }
        if worse.is_empty() {
            let parts = output::counted(compared, "part is", "parts are");
            output::note(&format!("{parts} at most {per_cent} % worse than in {path}"));
            return Ok(ending);
        }
        output::say(&format!("feedbits: more than {per_cent} % worse than in {path}:"));
        worse.iter().take(MOST_LINES).for_each(|line| output::say(&format!("  {line}")));
        if worse.len() > MOST_LINES {
            output::say(&format!("  and {} more", worse.len() - MOST_LINES));
        }
        Ok(if ending == Ending::Good { Ending::WorseThanBaseline } else { ending })
    }
}

/// Whether two results are of the same text, read by the same options.
fn is_same_text(old: &Value, new: &Value) -> bool {
    old["part_crc32"] == new["part_crc32"]
}

fn say_names(kind: &str, how: &str, names: &[&str], path: &str) {
    if names.is_empty() {
        return;
    }
    let shown: Vec<&str> = names.iter().take(MOST_LINES).copied().collect();
    let more = if names.len() > MOST_LINES {
        format!(" and {} more", names.len() - MOST_LINES)
    } else {
        String::new()
    };
    output::note(&format!(
        "{kind} parts, which {how} {path} and are not compared: {}{more}",
        shown.join(", ")
    ));
}
