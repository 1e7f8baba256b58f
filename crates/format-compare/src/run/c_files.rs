//! A part for a controller: path and plan in one format, as C99.

use c_code::{CFiles, CName, COverride, CPart, ExpectedRun};
use real::Backend;

use crate::refusal::Refusal;
use crate::run::constants::run;
use crate::run::job::Job;
use crate::run::on_pieces;

/// What C files shall say and have.
#[derive(Clone, Debug)]
pub struct CRequest {
    /// The begin of all public names, and of the files' names.
    pub name: CName,
    /// What the files are of, in a line.
    pub about: String,
    /// Why the run is not good enough; `None` if it is.
    pub fault: Option<String>,
    /// Whether the files are a description for hardware, in a format of any width, and not for a compiler.
    pub is_description: bool,
}

/// Compiles the part and its plan, runs the result, and writes it in C. The plan must rest at each gap of the part. With
/// overrides among the options, the files have feed override.
pub(crate) fn c_files<R: Backend, const D: usize>(
    job: &Job<'_, D>,
    request: &CRequest,
) -> Result<CFiles, Refusal> {
    let path = on_pieces::compiled::<R, D>(job)?;
    let (periods, checksum) = run(&path.interpolator(), path.sections(), job.most_periods())?;
    let CRequest { name, about, fault, is_description } = request.clone();
    let part = CPart {
        name,
        about,
        fault,
        path: &path,
        period_s: job.problem.period_s(),
        run: ExpectedRun { periods, checksum },
        feed_override: job
            .options
            .overrides
            .as_ref()
            .map(|commands| COverride { feeds: commands.feeds, commanded: commands.commanded_share() }),
    };
    let files = if is_description { part.description() } else { part.files() };
    files.map_err(Refusal::C)
}
