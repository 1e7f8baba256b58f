//! A public report, and the kernel that reproduces it.

use kernel_size::{Comparison, Refusal};
use real::FormatName;
use serde::Serialize;

/// Runs a kernel in these formats, as it was reported or cured.
pub(crate) type Compare = fn(is_cured: bool, &[FormatName]) -> Result<Comparison, Refusal>;

/// A public report.
#[derive(Clone, Copy, Debug, Serialize)]
pub struct Report {
    /// The kernel's name.
    pub name: &'static str,
    /// Where it was reported, as `owner/repository#number`.
    pub thread: &'static str,
    /// What the thread says.
    pub fault: &'static str,
    /// What the cured kernel does otherwise.
    pub cure: &'static str,
    /// The format in which it was reported.
    pub reported_in: &'static str,
    #[serde(skip)]
    pub(crate) compare: Compare,
}

/// A kernel's runs, as it was reported and cured.
#[derive(Clone, Debug, Serialize)]
pub struct Found {
    /// The report.
    pub report: Report,
    /// The kernel as it was reported.
    pub as_reported: Variant,
    /// The cured kernel.
    pub cured: Variant,
}

/// One of the two.
#[derive(Clone, Debug, Serialize)]
pub struct Variant {
    /// Whether it is good in the format of the report.
    pub good_as_reported: bool,
    /// The first bad step in the format of the report, from 0.
    pub first_bad_step: Option<usize>,
    /// The formats in which it is good.
    pub good_formats: Vec<String>,
    /// All runs.
    pub comparison: Comparison,
}

impl Report {
    /// The address of the thread.
    #[must_use]
    pub fn url(&self) -> String {
        format!("https://github.com/{}", self.thread.replace('#', "/issues/"))
    }

    /// Runs the kernel in these formats and in that of the report, as it was reported and cured.
    ///
    /// # Errors
    /// As [`kernel_size::compare()`].
    pub fn judge(&self, formats: &[FormatName]) -> Result<Found, Refusal> {
        let own = kernel_size::named(self.reported_in);
        let own = own.ok_or_else(|| Refusal::Format(self.reported_in.to_string()))?;
        let mut formats = formats.to_vec();
        if !formats.contains(&own) {
            formats.push(own);
        }
        let variant = |is_cured| -> Result<Variant, Refusal> {
            let comparison = (self.compare)(is_cured, &formats)?;
            let run = comparison.run(self.reported_in);
            Ok(Variant {
                good_as_reported: run.is_some_and(|run| run.good),
                first_bad_step: run.and_then(|run| run.first_bad_step),
                good_formats: comparison
                    .formats
                    .iter()
                    .filter(|run| run.good)
                    .map(|run| run.format.clone())
                    .collect(),
                comparison,
            })
        };
        Ok(Found { report: *self, as_reported: variant(false)?, cured: variant(true)? })
    }
}

impl Found {
    /// Whether the kernel fails as it was reported, and its cure does not.
    #[must_use]
    pub fn is_as_reported(&self) -> bool {
        !self.as_reported.good_as_reported && self.cured.good_as_reported
    }
}
