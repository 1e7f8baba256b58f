//! A kernel compared over formats.

use std::fmt;

use feed_plan::in_parallel;
use real::FormatName;
use serde::Serialize;

use crate::case::Case;
use crate::kernel::Kernel;
use crate::reference::{Reference, ReferenceFound};
use crate::refusal::Refusal;
use crate::run::{FormatRun, judged};
use crate::table::{self, short};

/// A kernel's runs in several formats.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Comparison {
    /// The kernel.
    pub kernel: &'static str,
    /// Number of steps.
    pub steps: usize,
    /// The reference, by right values that are known otherwise.
    pub reference: ReferenceFound,
    /// The runs, in the order of formats that was asked for.
    pub formats: Vec<FormatRun>,
    /// The narrowest good format, fixed point before float; of equal width the one that takes the least share of its limits.
    pub recommended: Option<String>,
    /// Whether neither a format is good nor the reference, which breaks a requirement too or does not finish.
    pub not_a_question_of_format: bool,
}

/// Runs a kernel in each of these formats, and judges it.
///
/// # Errors
/// [`Refusal`] if the kernel's inputs or requirements are wrong, if a format is none that [`named`](crate::named) knows, or
/// if the reference does not finish though an output needs it.
pub fn compare<K: Kernel>(kernel: &K, formats: &[FormatName]) -> Result<Comparison, Refusal> {
    let case = Case::of(kernel, formats)?;
    let reference = Reference::of(&case)?;
    let runs = in_parallel(formats, |format| judged(&case, &reference, *format));
    let rank = |run: &FormatRun| (run.bits, u32::from(run.format.starts_with('f')), run.used());
    let good = runs.iter().filter(|run| run.good);
    let least = good.min_by(|one, other| {
        let (one, other) = (rank(one), rank(other));
        (one.0, one.1).cmp(&(other.0, other.1)).then(one.2.total_cmp(&other.2))
    });
    Ok(Comparison {
        kernel: kernel.name(),
        steps: case.steps,
        recommended: least.map(|run| run.format.clone()),
        not_a_question_of_format: !reference.found.good && !runs.iter().any(|run| run.good),
        reference: reference.found,
        formats: runs,
    })
}

impl Comparison {
    /// The run in the format of this name.
    #[must_use]
    pub fn run(&self, format: &str) -> Option<&FormatRun> {
        self.formats.iter().find(|run| run.format == format)
    }

    /// The comparison as JSON, on several lines.
    #[must_use]
    pub fn json(&self) -> String {
        // Names and numbers alone: there is nothing in it that JSON cannot hold.
        serde_json::to_string_pretty(self).unwrap_or_default()
    }
}

impl fmt::Display for Comparison {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let row = |run: &FormatRun| {
            let outputs = if run.ended.step() == Some(0) { &[] } else { &run.outputs[..] };
            let worst = outputs.iter().max_by(|one, other| one.worst_error.total_cmp(&other.worst_error));
            vec![
                run.format.clone(),
                run.bits.to_string(),
                if run.good { "good" } else { "bad" }.to_string(),
                worst.map_or_else(String::new, |worst| short(worst.worst_error)),
                worst.map_or_else(String::new, |worst| format!("{} at {}", worst.output, worst.worst_step)),
                run.first_bad_step.map_or_else(String::new, |step| step.to_string()),
            ]
        };
        let header = ["format", "bits", "verdict", "worst error", "of output, at step", "first bad step"];
        writeln!(f, "{}: {} steps, judged by double-double", self.kernel, self.steps)?;
        f.write_str(&table::table(&header, &self.formats.iter().map(row).collect::<Vec<_>>()))?;
        for run in &self.formats {
            run.remarks().iter().try_for_each(|remark| writeln!(f, "{}: {remark}", run.format))?;
        }
        if self.reference.ended.step().is_some() {
            writeln!(f, "double-double: {}", self.reference.ended)?;
        }
        match &self.recommended {
            Some(format) => writeln!(f, "{format} is the narrowest of them that is good."),
            None if self.not_a_question_of_format => {
                writeln!(f, "None is good, and double-double is not either: it is no question of format.")
            }
            None => writeln!(f, "None of them is good."),
        }
    }
}
