//! The fewest bits that are enough, found after a comparison: searched where the comparison's runs were worst,
//! confirmed on the whole path.
//!
//! [`size`](crate::size()) runs the whole path in every width. This search first uses the parts of the path, from rest
//! to rest, in which the compared formats came nearest to a limit or broke it. The width found there is then run over
//! the whole path. If it is not good, wider ones follow until one is; if it is good, narrower ones follow as long as
//! they are good.

use std::borrow::Cow;
use std::collections::BTreeMap;
use std::ops::Range;
use std::sync::atomic::{AtomicU32, Ordering};
use std::sync::{Mutex, PoisonError};

use nurbs_core::Evaluate;
use real::{Datapath, FormatName, Real};
use serde::Serialize;

use crate::judge::judged_run::JudgedRun;
use crate::plan::exact_plan::ExactPlan;
use crate::problem::problem::Problem;
use crate::refusal::Refusal;
use crate::run::formats::{Dimension, Space, planned};
use crate::run::job::Job;
use crate::run::options::{Engine, Options};
use crate::size::trial::{FEWEST_INTEGER_BITS, Trial, WIDTHS, search_options};
use feed_plan::in_parallel;

/// Most periods, in total, of the parts on which widths are searched. Most searches run these parts three times, in
/// seconds.
const MOST_SEARCHED: f64 = 200_000.0;

/// The width with which a search begins if the compared formats give no hint.
const USUAL: u32 = 26;

/// Integer bits, with the sign, that most paths need.
const INTEGER_BITS: f64 = 2.0;

/// Most widths on either side of the one found that are run over the whole path.
const NEIGHBOURS: u32 = 3;

/// The result of the search.
#[derive(Clone, Debug, PartialEq, Serialize)]
#[serde(rename_all = "snake_case", tag = "result")]
pub enum FewestBits {
    /// The narrowest format that is good enough for all signals alike.
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
    /// No width that was tried is good enough.
    None {
        /// The widest.
        up_to_bits: u32,
    },
    /// The search was left out.
    LeftOut {
        /// The number of periods of the shortest part from rest to rest, which would have to be run many times.
        periods: u64,
    },
}

/// Searches for the fewest bits with which `problem` keeps the machine's requirements. `runs` are its compared runs, and
/// `plan` is the plan that they followed, if it was made in f64.
///
/// # Errors
/// [`Refusal`] when the part cannot be planned at all.
pub fn fewest_bits<const D: usize>(
    problem: &Problem<D>,
    plan: Option<&ExactPlan>,
    runs: &[JudgedRun],
    options: &Options,
) -> Result<FewestBits, Refusal>
where
    Space: Dimension<D>,
{
    let options = search_options(problem, options);
    let plan = match plan {
        Some(plan) => Cow::Borrowed(plan),
        None => Cow::Owned(planned::<f64, D>(problem, &options)?),
    };
    let parts = hardest_parts(problem, &plan, runs);
    let periods: f64 = parts.iter().map(|(_, periods)| periods).sum();
    if periods > MOST_SEARCHED {
        return Ok(FewestBits::LeftOut { periods: periods.to_phase(-32) >> 32 });
    }
    let whole = Widths::of(Job { problem, plan: &plan, options: &options })?;
    let parts = parts.into_iter().filter(|(curves, _)| curves.len() < problem.curves.len());
    let from_rest = Options { end_feeds_mm_per_s: [0.0; 2], ..options.clone() };
    let parts = parts.map(|(curves, _)| {
        let part = problem.part(curves);
        planned::<f64, D>(&part, &from_rest).map(|plan| (part, plan))
    });
    let parts = parts.collect::<Result<Vec<_>, _>>()?;
    let parts = parts.iter().map(|(part, plan)| Widths::of(Job { problem: part, plan, options: &options }));
    let parts = parts.collect::<Result<Vec<_>, _>>()?;
    let hardest = if parts.is_empty() { std::slice::from_ref(&whole) } else { &parts };
    let limit = problem.machine.fluctuation_limit;
    let start = expected_width(runs, limit);
    let width = narrowest(start, |width| hardest.iter().all(|path| path.run(width).verdict.is_good()));
    let good = |width: u32| Some(whole.run(width)).filter(|run| run.verdict.is_good());
    let last = *WIDTHS.end();
    let Some(mut row) = (width..=last.min(width + NEIGHBOURS)).find_map(good) else {
        return Ok(FewestBits::None { up_to_bits: last.min(width + NEIGHBOURS) });
    };
    for narrower in (row.bits.saturating_sub(NEIGHBOURS).max(*WIDTHS.start())..row.bits).rev() {
        let Some(better) = good(narrower) else { break };
        row = better;
    }
    let fluctuation = row.fluctuation.map_or(f64::NAN, |found| found.cruise_max_abs);
    Ok(FewestBits::Found { format: row.format, bits: row.bits, fluctuation, margin: limit / fluctuation })
}

/// The width expected from the coarsest fixed-point run, if each additional bit halves the fluctuation.
fn expected_width(runs: &[JudgedRun], limit: f64) -> u32 {
    let fraction_bits = |row: &JudgedRun| match FormatName::named(&row.format) {
        Some(FormatName::Fixed { fraction_bits, .. }) => Some(f64::from(fraction_bits)),
        _ => None,
    };
    let of_row = |row: &JudgedRun| Some((row.fluctuation?.cruise_max_abs, fraction_bits(row)?));
    let pieces = runs.iter().filter(|run| run.engine == Engine::Pieces).filter_map(of_row);
    let Some((fluctuation, bits)) = pieces.filter(|one| one.0 > 0.0).max_by(|a, b| a.0.total_cmp(&b.0))
    else {
        return USUAL;
    };
    let width = bits - (limit / fluctuation).log2() + INTEGER_BITS;
    WIDTHS.rev().find(|candidate| f64::from(*candidate) <= width).unwrap_or(*WIDTHS.start())
}

/// The narrowest good width, provided that every width above a good one is good; the widest if none is good. Three
/// neighbouring widths are tried at a time, the first three around `start`.
fn narrowest(start: u32, is_good: impl Fn(u32) -> bool + Sync) -> u32 {
    let (low, high) = (*WIDTHS.start(), *WIDTHS.end());
    let mut middle = start.clamp(low + 1, high - 1);
    // All widths below `bad_below` are bad. `found` is good, or no good width has been found yet.
    let (mut bad_below, mut found) = (low, high);
    loop {
        let tried: Vec<u32> =
            (middle - 1..=middle + 1).filter(|width| (bad_below..found).contains(width)).collect();
        if tried.is_empty() {
            return found;
        }
        let good = in_parallel(&tried, |width| is_good(*width));
        for (width, good) in tried.into_iter().zip(good) {
            if good {
                found = found.min(width);
            } else if width < found {
                bad_below = bad_below.max(width + 1);
            }
        }
        let next = if found <= middle + 1 { found.saturating_sub(2) } else { bad_below + 1 };
        middle = next.clamp(low + 1, high - 1);
    }
}

/// A path with its runs so far, by width.
struct Widths<'a, const D: usize> {
    trial: Trial<'a, D>,
    /// Integer bits that the path is known to need.
    integer_bits: AtomicU32,
    /// The runs, by their width.
    runs: Mutex<BTreeMap<u32, JudgedRun>>,
}

impl<'a, const D: usize> Widths<'a, D>
where
    Space: Dimension<D>,
{
    fn of(job: Job<'a, D>) -> Result<Self, Refusal> {
        let trial = Trial::new(job, Datapath::default())?;
        Ok(Self { trial, integer_bits: AtomicU32::new(FEWEST_INTEGER_BITS), runs: Mutex::default() })
    }

    /// The run in this width, which is made once.
    fn run(&self, width: u32) -> JudgedRun {
        let runs = || self.runs.lock().unwrap_or_else(PoisonError::into_inner);
        if let Some(run) = runs().get(&width) {
            return run.clone();
        }
        let run = self.trial.narrowest_integer_part(width, self.integer_bits.load(Ordering::Relaxed));
        if let (Some(FormatName::Fixed { integer_bits, .. }), Some(_)) =
            (FormatName::named(&run.format), run.periods)
        {
            self.integer_bits.fetch_max(integer_bits, Ordering::Relaxed);
        }
        runs().insert(width, run.clone());
        run
    }
}

/// The parts of the path, from rest to rest, in which the runs came nearest to their limits or broke them, the worst
/// first, with their periods. There is at least one; further ones are added while their periods stay within
/// [`MOST_SEARCHED`] in total. If the whole path is no longer than that, it is the only part.
fn hardest_parts<const D: usize>(
    problem: &Problem<D>,
    plan: &ExactPlan,
    runs: &[JudgedRun],
) -> Vec<(Range<usize>, f64)> {
    let all = plan.periods() as f64;
    if all <= MOST_SEARCHED {
        return vec![(0..problem.curves.len(), all)];
    }
    let parts = parts(problem, plan);
    let mut hard: Vec<(f64, usize)> = Vec::new();
    for one in runs.iter().filter(|run| run.engine == Engine::Pieces).flat_map(|run| &run.requirements) {
        let Some(at) = one.at.filter(|_| one.limit > 0.0 && one.found.is_finite()) else { continue };
        let period = at.period as f64;
        hard.push((one.found / one.limit, parts.partition_point(|(_, end)| *end < period)));
    }
    hard.sort_by(|one, other| other.0.total_cmp(&one.0));
    let (mut chosen, mut sum) = (Vec::new(), 0.0);
    for (_, index) in hard {
        let Some((curves, end)) = parts.get(index).cloned() else { continue };
        let begin = index.checked_sub(1).and_then(|before| parts.get(before)).map_or(0.0, |(_, end)| *end);
        let is_new = chosen.iter().all(|(other, _): &(Range<usize>, f64)| other.start != curves.start);
        if is_new && (chosen.is_empty() || sum + (end - begin) <= MOST_SEARCHED) {
            sum += end - begin;
            chosen.push((curves, end - begin));
        }
    }
    chosen
}

/// The ranges of curves between rests at the begins of curves, with the number of the period in which each range ends.
fn parts<const D: usize>(problem: &Problem<D>, plan: &ExactPlan) -> Vec<(Range<usize>, f64)> {
    let begins_at = |(curve, u): (usize, f64)| {
        let (first, last) = problem.curves.get(curve)?.as_curve().domain();
        if u <= first { Some(curve) } else { (u >= last).then_some(curve + 1) }
    };
    let (mut found, mut begin, mut periods) = (Vec::new(), 0, 0.0);
    for section in plan.schedule().sections() {
        periods += section.duration().value();
        let rest = section.rest().and_then(|(curve, u)| begins_at((curve, u.value())));
        if let Some(next) = rest.filter(|next| *next > begin) {
            found.push((begin..next, periods));
            begin = next;
        }
    }
    if begin < problem.curves.len() {
        found.push((begin..problem.curves.len(), periods));
    }
    found
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_narrowest_good_width_is_found_from_any_start() {
        for least in WIDTHS {
            for start in [12, 25, 26, 40, 48, 60] {
                assert_eq!(narrowest(start, |width| width >= least), least, "from {start}");
            }
        }
        assert_eq!(narrowest(30, |_| false), 48);
    }
}
