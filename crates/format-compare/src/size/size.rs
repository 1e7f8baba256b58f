//! The fewest bits that are enough: in one format for all signals, and in a register for each signal.
//!
//! *Uniform.* The whole path is run in every width of the range, with as few integer bits as the proven ranges of the compiled path
//! allow. The result is the narrowest format that meets every requirement, whatever its integer bits, as [`fewest_bits`](crate::fewest_bits())
//! finds it; of its width, it is the one whose run is listed.
//!
//! *Mixed.* Each named signal of the step has a register. Its integer bits follow from its proven bound. Its fraction
//! bits start from those of the uniform result and are taken away as long as the requirements are met, first from whole
//! groups of signals, then from single ones. Between registers the operators are exact to 53 bits.

use std::collections::BTreeMap;

use nurbs_core::SignalBound;
use real::{Datapath, FormatName, Quantized, Rounding};
use serde::Serialize;
use target_cost::{Cost, Target, cost, operations};

use crate::judge::judged_run::JudgedRun;
use crate::judge::not_of_format::{NotOfFormat, not_of_format};
use crate::plan::exact_plan::ExactPlan;
use crate::problem::problem::Problem;
use crate::refusal::Refusal;
use crate::run::formats::{Dimension, Space, format_named};
use crate::run::in_order::Threads;
use crate::run::job::Job;
use crate::run::observer::Observer;
use crate::run::on_pieces;
use crate::run::options::Options;
use crate::run::vectors::{Vectors, Words, vectors};
use crate::size::fewest_bits::narrowest;
use crate::size::signals::group_and_meaning;
use crate::size::trial::{Trial, WIDTHS, search_options};
use feed_plan::in_parallel;

/// The result of a search.
#[derive(Clone, Debug, Serialize)]
pub struct Sizing {
    /// The narrowest format that is good enough for all signals alike.
    pub uniform: Option<JudgedRun>,
    /// The requirement over the figure found: how much larger the fluctuation might be.
    pub uniform_margin: Option<f64>,
    /// A register for each signal.
    pub mixed: Option<Mixed>,
    /// Every uniform format that was tried, in order of width.
    pub tried: Vec<JudgedRun>,
    /// Runs of `tried` whose fluctuation is less than that of every narrower format.
    pub front: Vec<FrontPoint>,
    /// Number of runs of the whole path in the search.
    pub runs: usize,
    /// Why no format is good enough, if even `f64` is not.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub not_a_question_of_format: Option<NotOfFormat>,
}

/// A point of the front of bits against fluctuation.
#[derive(Clone, Debug, Serialize)]
pub struct FrontPoint {
    /// The format.
    pub format: String,
    /// Its width.
    pub bits: u32,
    /// Largest fluctuation at cruise.
    pub fluctuation: f64,
    /// Whether every requirement is met.
    pub good: bool,
}

/// A format for each signal.
#[derive(Clone, Debug, Serialize)]
pub struct Mixed {
    /// The registers.
    pub signals: Vec<Register>,
    /// The widths of all registers together, in bits, each signal once.
    pub bits: u32,
    /// The sum of the widths of all registers if every signal had the width of the uniform result.
    pub uniform_bits: u32,
    /// Largest fluctuation at cruise, in the run that confirms it.
    pub fluctuation: f64,
    /// The requirement over the figure found.
    pub margin: f64,
    /// The cost of a period on each target, if [`price_sizing`] was called. The operators of a target serve all signals in turn,
    /// so they are as wide as the widest register.
    #[serde(skip_serializing_if = "BTreeMap::is_empty")]
    pub cycles: BTreeMap<String, Cost>,
}

impl Mixed {
    /// The narrowest format that holds every register's width, with the most integer bits that one has.
    #[must_use]
    pub fn widest(&self) -> Option<FormatName> {
        let formats = || self.signals.iter().filter_map(|signal| FormatName::named(&signal.format));
        let FormatName::Fixed { datapath, .. } = formats().next()? else { return None };
        let bits = formats().map(FormatName::bits).max()?;
        let integer = |format| match format {
            FormatName::Fixed { integer_bits, .. } => integer_bits,
            _ => 0,
        };
        let integer_bits = formats().map(integer).max()?;
        Some(FormatName::Fixed { integer_bits, fraction_bits: bits.checked_sub(integer_bits)?, datapath })
    }
}

/// One signal and its format.
#[derive(Clone, Debug, Serialize)]
pub struct Register {
    /// Name of the signal.
    pub signal: &'static str,
    /// The group of the signal: parameter, coordinates, step or weight.
    pub group: &'static str,
    /// What the signal is, in the words of the glossary.
    pub meaning: &'static str,
    /// The format's name.
    pub format: String,
    /// Its width.
    pub bits: u32,
    /// The proven bound, from which the integer bits follow.
    pub bound: f64,
}

/// Searches for the fewest bits with which `problem` keeps the machine's requirements, in formats with this datapath.
///
/// # Errors
/// [`Refusal`] when the part cannot be planned or compiled at all.
pub fn size<const D: usize>(
    problem: &Problem<D>,
    plan: &ExactPlan,
    options: &Options,
    datapath: Datapath,
) -> Result<Sizing, Refusal>
where
    Space: Dimension<D>,
{
    let options = search_options(options);
    let job = Job::new(problem, plan, &options);
    let trial = Trial::new(&job, datapath)?;
    let widths: Vec<_> = WIDTHS.collect();
    let mut tried = in_parallel(&widths, |width| trial.narrowest_integer_part(*width));
    let uniform = narrowest(&trial, &tried);
    if let Some(uniform) = &uniform {
        tried.iter_mut().filter(|run| run.bits == uniform.bits).for_each(|run| *run = uniform.clone());
    }
    let mixed = uniform.as_ref().map(|uniform| mixed(&trial, uniform)).transpose()?.flatten();
    let limit = problem.machine.fluctuation_limit;
    Ok(Sizing {
        not_a_question_of_format: not_of_format(problem, &tried, &options),
        uniform_margin: uniform.as_ref().and_then(|row| Some(limit / row.fluctuation?.cruise_max_abs)),
        uniform,
        mixed,
        front: front(&tried),
        tried,
        runs: trial.runs.into_inner(),
    })
}

/// A register for each signal, from those of the uniform result.
fn mixed<const D: usize>(trial: &Trial<'_, D>, uniform: &JudgedRun) -> Result<Option<Mixed>, Refusal>
where
    Space: Dimension<D>,
{
    let Some(FormatName::Fixed { fraction_bits, .. }) = FormatName::named(&uniform.format) else {
        return Ok(None);
    };
    let Job { problem, plan, options, .. } = trial.job;
    let options = stopping_at(options, fraction_bits);
    let job = Job::new(problem, plan, &options);
    Ok(Search::new(trial, &job)?.mixed(uniform, fraction_bits.cast_signed()))
}

/// The run of `problem` with a register for each signal, of these fraction bits, by the signals' names; `None` if it is not good, or a
/// signal has no register. `uniform` is a format that is good for all signals alike, at whose resolution the solver stops. Integer bits
/// follow from proven bounds, so that more of them change nothing.
///
/// # Errors
/// [`Refusal`] when the part cannot be compiled.
pub fn run_in_registers<const D: usize>(
    problem: &Problem<D>,
    plan: &ExactPlan,
    options: &Options,
    uniform: FormatName,
    fraction_bits: &BTreeMap<String, u32>,
) -> Result<Option<JudgedRun>, Refusal>
where
    Space: Dimension<D>,
{
    let FormatName::Fixed { fraction_bits: of_uniform, datapath, .. } = uniform else { return Ok(None) };
    let options = search_options(options);
    let job = Job::new(problem, plan, &options);
    let trial = Trial::new(&job, datapath)?;
    let options = stopping_at(&options, of_uniform);
    let job = Job::new(problem, plan, &options);
    let search = Search::new(&trial, &job)?;
    let bits = search.bounds.iter().map(|bound| Some(fraction_bits.get(bound.signal)?.cast_signed()));
    let run = bits.collect::<Option<Vec<i32>>>().and_then(|bits| search.run(&bits));
    Ok(run.filter(|run| run.verdict.is_good()))
}

/// The options of a run in registers: the solver stops where that of the uniform format does, at its resolution. That of f64, in which
/// registers are filled, is finer.
fn stopping_at(options: &Options, fraction_bits: u32) -> Options {
    let resolution = f64::powi(0.5, fraction_bits.cast_signed());
    Options { fluctuation: options.fluctuation.or(Some(resolution)), ..options.clone() }
}

/// The test vectors of the run with a register for each signal; `None` if the search found no registers.
///
/// # Errors
/// [`Refusal`] when the run cannot be made again.
pub fn register_vectors<const D: usize>(
    sizing: &Sizing,
    problem: &Problem<D>,
    plan: &ExactPlan,
    options: &Options,
    rounding: Rounding,
) -> Result<Option<Vectors>, Refusal> {
    let (Some(uniform), Some(mixed)) = (&sizing.uniform, &sizing.mixed) else { return Ok(None) };
    let Some(FormatName::Fixed { fraction_bits, .. }) = FormatName::named(&uniform.format) else {
        return Ok(None);
    };
    let options = stopping_at(&search_options(options), fraction_bits);
    let named = |register: &Register| Some((register.signal, FormatName::named(&register.format)?));
    let words: Vec<_> = mixed.signals.iter().filter_map(named).collect();
    let fraction_bits = |&(signal, format): &(&'static str, FormatName)| match format {
        FormatName::Fixed { fraction_bits, .. } => Some((signal, fraction_bits.cast_signed())),
        _ => None,
    };
    let registers: Vec<_> = words.iter().filter_map(fraction_bits).collect();
    let job = Job::new(problem, plan, &options);
    // The registers are those of this thread.
    let run = || vectors::<Quantized, D>(&job, Words::Registers(&words));
    Quantized::run(rounding, &registers, run).map(Some)
}

/// Records the run in the narrowest format, and prices it and the registers on each of `targets`.
///
/// # Errors
/// [`Refusal`] when the run cannot be made again.
pub fn price_sizing<const D: usize>(
    sizing: &mut Sizing,
    problem: &Problem<D>,
    plan: &ExactPlan,
    options: &Options,
    targets: &[Target],
) -> Result<(), Refusal>
where
    Space: Dimension<D>,
{
    let Some(uniform) = &mut sizing.uniform else { return Ok(()) };
    let Some(format) = format_named::<D>(&uniform.format) else { return Ok(()) };
    let recorded = format.record(problem, plan, &search_options(options), usize::MAX)?;
    uniform.operations = Some(operations(&recorded));
    let widest = sizing.mixed.as_ref().and_then(Mixed::widest);
    for target in targets {
        let priced = |format| cost(&recorded, target, format, Some(problem.period_s()));
        uniform.cycles.insert(target.name.clone(), priced(format.name()));
        if let (Some(mixed), Some(widest)) = (&mut sizing.mixed, widest) {
            mixed.cycles.insert(target.name.clone(), priced(widest));
        }
    }
    Ok(())
}

/// The runs whose fluctuation is less than that of every narrower one.
fn front(tried: &[JudgedRun]) -> Vec<FrontPoint> {
    let mut best = f64::INFINITY;
    let mut front = Vec::new();
    for row in tried {
        let Some(fluctuation) = row.fluctuation else { continue };
        if fluctuation.cruise_max_abs < best {
            best = fluctuation.cruise_max_abs;
            front.push(FrontPoint {
                format: row.format.clone(),
                bits: row.bits,
                fluctuation: best,
                good: row.verdict.is_good(),
            });
        }
    }
    front
}

/// The search for register widths.
struct Search<'a, const D: usize> {
    trial: &'a Trial<'a, D>,
    job: &'a Job<'a, D>,
    bounds: Vec<SignalBound>,
}

impl<'a, const D: usize> Search<'a, D>
where
    Space: Dimension<D>,
{
    fn new(trial: &'a Trial<'a, D>, job: &'a Job<'a, D>) -> Result<Self, Refusal> {
        let path = on_pieces::compiled::<Quantized, D>(job)?;
        Ok(Self { trial, job, bounds: path.table().bounds().to_vec() })
    }

    fn run(&self, fraction_bits: &[i32]) -> Option<JudgedRun> {
        let registers: Vec<_> =
            self.bounds.iter().map(|b| b.signal).zip(fraction_bits.iter().copied()).collect();
        // The registers are those of this thread.
        let run = |observer: &dyn Observer| {
            Quantized::run(self.trial.datapath.rounding, &registers, || {
                on_pieces::run::<Quantized, D>(self.job, Threads::This, observer)
            })
        };
        self.trial.judged(FormatName::Float { bits: 64 }, run).ok()
    }

    fn is_good(&self, fraction_bits: &[i32]) -> bool {
        self.run(fraction_bits).is_some_and(|row| row.verdict.is_good())
    }

    /// Takes bits away while the requirements are met: first from groups, then from single signals, until no bit can
    /// go.
    fn mixed(&self, uniform: &JudgedRun, fraction_bits: i32) -> Option<Mixed> {
        let mut bits = vec![fraction_bits; self.bounds.len()];
        // Unrounded operators between registers differ from a uniform format's rounding; an additional bit makes up for
        // this.
        while !self.is_good(&bits) {
            bits.iter_mut().for_each(|b| *b += 1);
            if bits[0] > 52 {
                return None;
            }
        }
        for name in ["coordinates", "step", "parameter", "weight"] {
            let members: Vec<usize> =
                (0..bits.len()).filter(|&i| group_and_meaning(self.bounds[i].signal).0 == name).collect();
            self.lower(&mut bits, &members);
        }
        for signal in 0..bits.len() {
            self.lower(&mut bits, &[signal]);
        }
        self.confirmed(&bits, uniform)
    }

    /// Takes one bit at a time from all members together, as long as the requirements are met.
    fn lower(&self, bits: &mut [i32], members: &[usize]) {
        while members.iter().all(|&i| bits[i] > 1) && !members.is_empty() {
            members.iter().for_each(|&i| bits[i] -= 1);
            if !self.is_good(bits) {
                members.iter().for_each(|&i| bits[i] += 1);
                break;
            }
        }
    }

    fn confirmed(&self, bits: &[i32], uniform: &JudgedRun) -> Option<Mixed> {
        let row = self.run(bits).filter(|row| row.verdict.is_good())?;
        let fluctuation = row.fluctuation?.cruise_max_abs;
        let signals: Vec<Register> = self
            .bounds
            .iter()
            .zip(bits)
            .map(|(bound, bits)| register(bound, *bits, self.trial.datapath))
            .collect();
        Some(Mixed {
            bits: signals.iter().map(|s| s.bits).sum(),
            uniform_bits: uniform.bits * u32::try_from(signals.len()).ok()?,
            signals,
            fluctuation,
            margin: self.trial.job.problem.machine.fluctuation_limit / fluctuation,
            cycles: BTreeMap::new(),
        })
    }
}

fn register(bound: &SignalBound, fraction_bits: i32, datapath: Datapath) -> Register {
    // -2^(n-1) ≤ v < 2^(n-1) for n integer bits.
    let integer_bits = (1..64).find(|n| bound.bound < f64::powi(2.0, n - 1)).unwrap_or(64).unsigned_abs();
    let fraction_bits = fraction_bits.unsigned_abs();
    let (group, meaning) = group_and_meaning(bound.signal);
    Register {
        signal: bound.signal,
        group,
        meaning,
        format: FormatName::Fixed { integer_bits, fraction_bits, datapath }.to_string(),
        bits: integer_bits + fraction_bits,
        bound: bound.bound,
    }
}
