//! `judge --baseline`: a log beside an earlier one of the same machine, and of the same part where one is followed.
//!
//! Figures of which less is better are compared one by one: what is taken of each limit, rows that are there twice or
//! missing, and how the log follows its part. A row that was there and is gone counts as worse, as in `compare`; new
//! rows are named.

use std::path::PathBuf;

use anyhow::{Result, bail};
use serde_json::Value;

use crate::baseline::{BaselineArguments, differing_key, new_figures, worse_figures};
use crate::ending::Ending;
use crate::output;

/// The JSON of an earlier log.
pub(crate) struct LogBaseline {
    path: PathBuf,
    result: Value,
    /// By how much a figure may grow, as a share.
    share: f64,
}

impl LogBaseline {
    /// The baseline that is asked for, if it is of this machine and this part.
    pub(crate) fn read(
        arguments: &BaselineArguments,
        machine: &Value,
        part_crc32: Option<&str>,
    ) -> Result<Option<Self>> {
        let Some((path, result)) = arguments.result_of("judge")? else { return Ok(None) };
        let name = path.display();
        if let Some((key, [old, new])) = differing_key(&result["machine"], machine) {
            bail!(
                "{name} was made with {key} = {old} in the machine file, and this log is judged with {new}"
            );
        }
        match (result["part_crc32"].as_str(), part_crc32) {
            (old, new) if old == new => {}
            (Some(_), None) => bail!("{name} is of a log that followed a part: expected --part with it"),
            (None, _) => bail!("{name} is of a log without a part: expected no --part"),
            (Some(_), Some(_)) => bail!(
                "{name} is of another part, or of one that is read by other options: expected the part of the baseline"
            ),
        }
        Ok(Some(Self { path, result, share: arguments.share() }))
    }

    /// Says which figures are new, and which are worse. A good ending is [`Ending::WorseThanBaseline`] if one is.
    pub(crate) fn judge(&self, now: &Value, ending: Ending) -> Ending {
        let (path, per_cent) = (self.path.display(), 100.0 * self.share);
        let new = new_figures(&self.result, now);
        if !new.is_empty() {
            output::note(&format!(
                "new figures, which are not in {path} and are not compared: {}",
                new.join(", ")
            ));
        }
        let worse = worse_figures(&self.result, now, self.share);
        if worse.is_empty() {
            output::note(&format!("every figure is at most {per_cent} % worse than in {path}"));
            return ending;
        }
        output::say(&format!("feedbits: more than {per_cent} % worse than in {path}:"));
        worse.iter().for_each(|line| output::say(&format!("  {line}")));
        if ending == Ending::Good { Ending::WorseThanBaseline } else { ending }
    }
}
