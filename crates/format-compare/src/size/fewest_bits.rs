//! The fewest bits that are enough, found after a comparison.
//!
//! The definition is that of the comparison's rows: a format is good if the run of the whole path in it, on pieces, by the plan that the
//! rows follow and with their options, keeps every requirement. The answer is the least width of which some division into integer and
//! fraction bits is good, so that every format that is narrower is bad. Each of them is tried, for a wider one is not always better.
//!
//! Most formats are bad, and break a requirement soon in a section that is hard for others too: see [`Trial`]. Only a format that keeps
//! all requirements in the sections that are watched runs the whole path, until it breaks one elsewhere. Where no format of the
//! comparison is good, the one with the most fraction bits that the path fits is tried of each width, to find whether any is.

use real::{Backend, Datapath};
use serde::Serialize;

use crate::judge::judged_run::JudgedRun;
use crate::judge::not_of_format::is_beyond_rounding;
use crate::plan::exact_plan::ExactPlan;
use crate::problem::problem::Problem;
use crate::refusal::Refusal;
use crate::run::formats::{Dimension, Space};
use crate::run::job::Job;
use crate::run::options::{Engine, Options};
use crate::size::trial::{Trial, Tried, WIDTHS, search_options};
use feed_plan::in_parallel;

/// The result of the search.
#[derive(Clone, Debug, PartialEq, Serialize)]
#[serde(rename_all = "snake_case", tag = "result")]
pub enum FewestBits {
    /// The narrowest format that is good enough for all signals alike. Of those of its width, it is the good one with the most fraction
    /// bits.
    Found {
        /// Its name.
        format: String,
        /// Its width.
        bits: u32,
        /// Its largest fluctuation at cruise.
        fluctuation: f64,
        /// The largest fluctuation allowed over the one found.
        margin: f64,
    },
    /// No width is good enough.
    None {
        /// The widest.
        up_to_bits: u32,
    },
    /// No width is good enough, for what the widest breaks f64 breaks too, and not by its rounding: more bits would not help.
    BrokenByPlan {
        /// The widest.
        up_to_bits: u32,
        /// What f64 breaks.
        broken: Vec<String>,
    },
}

/// Searches for the fewest bits with which `problem` keeps the machine's requirements. `runs` are its compared runs, and `plan` is the
/// plan that they followed.
///
/// # Errors
/// [`Refusal`] when the reference cannot be made.
pub fn fewest_bits<const D: usize>(
    problem: &Problem<D>,
    plan: &ExactPlan,
    runs: &[JudgedRun],
    options: &Options,
) -> Result<FewestBits, Refusal>
where
    Space: Dimension<D>,
{
    let options = search_options(options);
    let job = Job::new(problem, plan, &options);
    let trial = Trial::new(&job, Datapath::default())?;
    let up_to_bits = *WIDTHS.end();
    Ok(match narrowest(&trial, runs) {
        Some(run) => {
            let fluctuation = run.fluctuation.map_or(f64::NAN, |found| found.cruise_max_abs);
            let margin = problem.machine.fluctuation_limit / fluctuation;
            FewestBits::Found { format: run.format, bits: run.bits, fluctuation, margin }
        }
        None => match broken_in_f64(&trial, runs) {
            broken if broken.is_empty() => FewestBits::None { up_to_bits },
            broken => FewestBits::BrokenByPlan { up_to_bits, broken },
        },
    })
}

/// The run in the narrowest format that is good. `runs` are other runs of the path, by which its hardest sections are known.
pub(crate) fn narrowest<const D: usize>(trial: &Trial<'_, D>, runs: &[JudgedRun]) -> Option<JudgedRun>
where
    Space: Dimension<D>,
{
    trial.watch_hardest(runs);
    let is_good = |run: &JudgedRun| run.engine == Engine::Pieces && run.verdict.is_good();
    let mut widest = *WIDTHS.end();
    if !runs.iter().any(is_good) {
        let has_good = |width: &u32| matches!(with_most_fraction_bits(trial, *width), Tried::Good(_));
        widest = WIDTHS.into_iter().find(has_good)?;
    }
    (*WIDTHS.start()..=widest).find_map(|width| first_good(trial, width))
}

/// The trial of the format of this width with the most fraction bits that the path fits.
fn with_most_fraction_bits<const D: usize>(trial: &Trial<'_, D>, width: u32) -> Tried
where
    Space: Dimension<D>,
{
    let mut tried = trial.splits(width).into_iter().map(|format| trial.tried(format));
    tried.find(|tried| !matches!(tried, Tried::Refused)).unwrap_or(Tried::Refused)
}

/// The run in the first good format of this width.
fn first_good<const D: usize>(trial: &Trial<'_, D>, width: u32) -> Option<JudgedRun>
where
    Space: Dimension<D>,
{
    let (formats, watched) = (trial.splits(width), trial.watched());
    let held = in_parallel(&formats, |format| trial.holds_in(*format, &watched));
    let held = formats.into_iter().zip(held).filter_map(|(format, held)| held.then_some(format));
    held.into_iter().find_map(|format| {
        let now = trial.watched();
        let since = now.get(watched.len()..).unwrap_or_default();
        match trial.holds_in(format, since).then(|| trial.whole(format)) {
            Some(Tried::Good(run)) => Some(*run),
            _ => None,
        }
    })
}

/// Which requirements f64 breaks too, and not by its rounding.
fn broken_in_f64<const D: usize>(trial: &Trial<'_, D>, runs: &[JudgedRun]) -> Vec<String>
where
    Space: Dimension<D>,
{
    let name = f64::name();
    let is_f64 = |run: &&JudgedRun| run.engine == Engine::Pieces && run.format == name.to_string();
    let again = || {
        let format = Space::format(name)?;
        trial.judged(name, |observer| format.run_job(trial.job, observer)).ok()
    };
    let Some(run) = runs.iter().find(is_f64).cloned().or_else(again) else { return Vec::new() };
    let full_step_mm = trial.job.problem.full_step_mm();
    let of_plan =
        run.requirements.iter().filter(|one| !one.holds() && is_beyond_rounding(one, &run, full_step_mm));
    of_plan.map(|one| one.broken.clone()).collect()
}
