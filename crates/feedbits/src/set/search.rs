//! The work on all parts of a set, and the search for the fewest bits that are enough for all of them.
//!
//! A format is tried on the parts first that need the most bits alone. The plans of small parts are kept until then, so that these are not
//! planned again.

use std::cmp::Reverse;
use std::collections::BTreeMap;
use std::fs;
use std::sync::atomic::{AtomicBool, AtomicUsize, Ordering};
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};

use anyhow::{Context, Result, bail};
use feed_plan::in_parallel;
use format_compare::{
    Dimension, Engine, ExactPlan, JudgedRun, Options, Problem, Space, Watch, common_format, runs_in, splits,
};
use part_program::Machine;
use real::FormatName;
use serde_json::Value;

use crate::fingerprint::fingerprint_of;
use crate::formats::selected;
use crate::input::{AnyProblem, PartReader, in_part, part_of, with_machine};
use crate::progress::Progress;
use crate::run_arguments::RunArguments;
use crate::set::known::{Broken, Finished, GoodRun, Limiting, PartEnding, SetLine, SetOfParts, Tried};
use crate::set::parts::PartFile;
use crate::set::registers::RegistersOfSet;
use crate::set::store::Store;
use crate::set::work::{OfEachPart, Worked};
use crate::{interrupt, output};

/// The parts of a set, with what is done to them.
pub(crate) struct Search<'a, W> {
    pub(crate) work: &'a W,
    pub(crate) run: &'a RunArguments,
    reader: &'a PartReader,
    /// The machine, if the options name one.
    pub(crate) machine: Option<Machine>,
    pub(crate) files: &'a [PartFile],
    pub(crate) set: &'a SetOfParts,
    store: Mutex<Store>,
    /// Plans that are kept, with the bytes of the parts that they are of.
    plans: Mutex<(BTreeMap<usize, Arc<ExactPlan>>, usize)>,
    /// The parts with notes and warnings.
    remarked: AtomicUsize,
}

/// The fewest bits for the parts of a set that have any.
pub(crate) struct Fewest {
    /// The answer.
    pub(crate) format: Option<FormatName>,
    /// The part that alone needs as many bits, if there is one such part.
    pub(crate) decides: Option<usize>,
    /// The format with a fraction bit fewer, which is too narrow for that part.
    pub(crate) narrower: Option<FormatName>,
    /// The fewest bits without that part; `None` if it is the only one.
    pub(crate) without: Option<FormatName>,
}

/// The integer and the fraction bits of a fixed-point format.
fn integer_and_fraction(format: FormatName) -> (u32, u32) {
    match format {
        FormatName::Fixed { integer_bits, fraction_bits, .. } => (integer_bits, fraction_bits),
        _ => (0, 0),
    }
}

/// The format with a fraction bit fewer.
fn one_bit_fewer(format: FormatName) -> Option<FormatName> {
    match format {
        FormatName::Fixed { integer_bits, fraction_bits, datapath } => {
            Some(FormatName::Fixed { integer_bits, fraction_bits: fraction_bits.checked_sub(1)?, datapath })
        }
        _ => None,
    }
}

impl<'a, W: OfEachPart> Search<'a, W> {
    pub(crate) fn new(
        (work, run): (&'a W, &'a RunArguments),
        (reader, machine): (&'a PartReader, Option<Machine>),
        files: &'a [PartFile],
        set: &'a SetOfParts,
        store: Store,
    ) -> Self {
        let (store, plans, remarked) = (Mutex::new(store), Mutex::default(), AtomicUsize::new(0));
        Self { work, run, reader, machine, files, set, store, plans, remarked }
    }

    /// What is known.
    pub(crate) fn store(&self) -> MutexGuard<'_, Store> {
        self.store.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// The number of parts with notes and warnings, of those that were run in this call.
    pub(crate) fn remarked(&self) -> usize {
        self.remarked.load(Ordering::Relaxed)
    }

    /// Does the work for these parts. Where Ctrl-C ends it, what is finished is known.
    pub(crate) fn finish(&self, parts: &[usize]) -> Result<()> {
        let progress = Progress::of("parts", parts.len() + self.store().known().len());
        progress.start_at(self.store().known().len());
        let finished = in_parallel(parts, |part| -> Result<()> {
            // Once the disk is full, or Ctrl-C was pressed, no part is run in vain.
            self.store().expect_room()?;
            if interrupt::is_set() {
                return Ok(());
            }
            let (done, said) = output::kept(|| self.finish_part(*part));
            self.remarked.fetch_add(usize::from(!said.is_empty()), Ordering::Relaxed);
            progress.step();
            done
        });
        progress.finish();
        finished.into_iter().collect()
    }

    fn finish_part(&self, part: usize) -> Result<()> {
        let ending = match self.problem(part)? {
            Ok((AnyProblem::Planar(problem), checksum)) => self.work_on(part, &problem, checksum),
            Ok((AnyProblem::Spatial(problem), checksum)) => self.work_on(part, &problem, checksum),
            Err(ending) => self.add(SetLine::Finished(Finished { part, ending })),
        };
        ending.with_context(|| self.files[part].name.clone())
    }

    /// Does the work for a part.
    fn work_on<const D: usize>(&self, part: usize, problem: &Problem<D>, checksum: u32) -> Result<()>
    where
        Space: Dimension<D>,
    {
        let worked = in_part(problem, self.work.work(problem, checksum));
        let Worked { json, plan } = match worked {
            Ok(worked) => worked,
            Err(error) => {
                let ending = PartEnding::Refused(format!("{error:#}"));
                return self.add(SetLine::Finished(Finished { part, ending }));
            }
        };
        self.add(SetLine::Finished(Finished { part, ending: PartEnding::Result(json) }))?;
        plan.into_iter().for_each(|plan| self.keep(part, plan));
        Ok(())
    }

    /// Keeps the plan of a part, as long as the parts of all kept plans are small.
    fn keep(&self, part: usize, plan: ExactPlan) {
        const MOST_BYTES: usize = 4 << 20;
        let bytes = fs::metadata(&self.files[part].path).map_or(u64::MAX, |found| found.len());
        let bytes = usize::try_from(bytes).unwrap_or(usize::MAX);
        let mut plans = self.plans.lock().unwrap_or_else(PoisonError::into_inner);
        let all = plans.1.saturating_add(bytes);
        if all <= MOST_BYTES {
            plans.0.insert(part, Arc::new(plan));
            plans.1 = all;
        }
    }

    /// The plan of a part's runs: the one that is kept, or made again.
    fn plan<const D: usize>(&self, part: usize, problem: &Problem<D>) -> Result<Arc<ExactPlan>>
    where
        Space: Dimension<D>,
    {
        let kept = self.plans.lock().unwrap_or_else(PoisonError::into_inner).0.get(&part).cloned();
        match kept {
            Some(plan) => Ok(plan),
            None => match self.work.plan(problem)? {
                Some(plan) => Ok(Arc::new(plan)),
                None => bail!("each format plans for itself"),
            },
        }
    }

    /// Adds a line, unless Ctrl-C has cut its run short.
    fn add(&self, line: SetLine) -> Result<()> {
        if interrupt::is_set() { Ok(()) } else { self.store().add(line) }
    }

    fn add_tried(&self, part: usize, format: FormatName, run: Option<&JudgedRun>) -> Result<()> {
        let good = run.map(GoodRun::of).transpose()?;
        self.add(SetLine::Tried(Tried { part, format: format.to_string(), good }))
    }

    /// The problem of a part with the checksum of its text, or how it is refused.
    fn problem(&self, part: usize) -> Result<Result<(AnyProblem, u32), PartEnding>> {
        let (file, known) = (&self.files[part], &self.set.parts[part].fingerprint);
        let text = match self.reader.text_of(&file.path) {
            Ok(text) => text,
            Err(error) => return Ok(Err(PartEnding::Unread(format!("{error:#}")))),
        };
        if text.fingerprint() != *known {
            bail!("{} has changed since the call began: expected parts that stay as they are", file.name);
        }
        let parsed = match part_of(&text) {
            Ok(parsed) => parsed,
            Err(error) => return Ok(Err(PartEnding::Unread(format!("{error:#}")))),
        };
        let problem = with_machine(parsed, self.machine.clone())
            .and_then(|(part, machine)| AnyProblem::new(&part, &self.run.with_fluctuation(machine)));
        Ok(match problem {
            Ok(problem) => Ok((problem, text.checksum())),
            Err(error) => Err(PartEnding::Refused(format!("{error:#}"))),
        })
    }

    /// The fewest bits for the parts of which the answers alone are `own`.
    pub(crate) fn fewest(&self, own: &BTreeMap<usize, FormatName>) -> Result<Fewest> {
        let of_widest = own.values().map(|format| format.bits()).max();
        let mut widest = own.iter().filter(|(_, format)| Some(format.bits()) == of_widest);
        let alone = match (widest.next(), widest.next()) {
            (Some((part, _)), None) => Some(*part),
            _ => None,
        };
        let others: BTreeMap<_, _> =
            own.iter().filter(|(part, _)| Some(**part) != alone).map(|(p, f)| (*p, *f)).collect();
        let format = self.common(own)?;
        let of_width = |format: Option<FormatName>| format.map(FormatName::bits);
        let is_widest = format.is_some() && of_width(format) == of_widest;
        let without = if alone.is_some() && is_widest { self.common(&others)? } else { None };
        // Without the part that needs most alone, the others may need as many together.
        let decides = alone.filter(|_| is_widest && of_width(without) != of_width(format));
        let narrower = format.and_then(one_bit_fewer);
        if let (Some(part), Some(narrower)) = (decides, narrower) {
            self.expect_broken(part, narrower)?;
        }
        Ok(Fewest { format, decides, narrower, without })
    }

    /// The narrowest format that is good for these parts.
    fn common(&self, own: &BTreeMap<usize, FormatName>) -> Result<Option<FormatName>> {
        let alone: Vec<_> = own.values().copied().collect();
        common_format(&alone, self.work.datapath(), |format| self.is_good_for_all(format, own))
    }

    /// Whether a format is good for these parts.
    fn is_good_for_all(&self, format: FormatName, own: &BTreeMap<usize, FormatName>) -> Result<bool> {
        let known: Vec<(usize, Option<bool>)> =
            own.iter().map(|(part, own)| (*part, self.is_good(*part, *own, format))).collect();
        if known.iter().any(|(_, good)| *good == Some(false)) || interrupt::is_set() {
            return Ok(false);
        }
        let unknown = known.iter().filter(|(_, good)| good.is_none()).map(|(part, _)| *part);
        // Those first that have failed before, or need more of either kind of bits alone: they are likely to fail, and most do so at once.
        let (mut suspect, mut rest): (Vec<usize>, Vec<usize>) = unknown.partition(|part| {
            let (needed, given) = (integer_and_fraction(own[part]), integer_and_fraction(format));
            needed.0 > given.0 || needed.1 > given.1 || self.store().known().has_failed(*part)
        });
        let progress = Progress::of("parts confirmed", own.len());
        progress.start_at(own.len() - suspect.len() - rest.len());
        for parts in [&mut suspect, &mut rest] {
            parts.sort_by_key(|part| (Reverse(integer_and_fraction(own[part]).0), Reverse(own[part].bits())));
            let is_bad = AtomicBool::new(false);
            let tried = in_parallel(parts, |part| -> Result<()> {
                if is_bad.load(Ordering::Relaxed) || interrupt::is_set() {
                    return Ok(());
                }
                let good = output::kept(|| self.try_part(*part, own[part], format)).0?;
                is_bad.fetch_or(!good, Ordering::Relaxed);
                progress.step();
                Ok(())
            });
            tried.into_iter().collect::<Result<()>>()?;
            if is_bad.into_inner() || interrupt::is_set() {
                return Ok(false);
            }
        }
        Ok(true)
    }

    /// Whether a format is good for a part, as far as that is known. Its own answer is the narrowest good format, and of its width the
    /// one with the most fraction bits.
    fn is_good(&self, part: usize, own: FormatName, format: FormatName) -> Option<bool> {
        if own == format {
            return Some(true);
        }
        let (this, of_own) =
            ((format.bits(), integer_and_fraction(format).0), (own.bits(), integer_and_fraction(own).0));
        if this < of_own {
            return Some(false);
        }
        self.store().known().tried(part, &format.to_string()).map(|good| good.is_some())
    }

    /// Tries a part in a format, of which nothing is known. If it is bad, the formats of its width with fewer fraction bits are tried until one
    /// is good, since the part is at hand: it is likely to be the one by which they fail too.
    fn try_part(&self, part: usize, own: FormatName, format: FormatName) -> Result<bool> {
        let all = splits(format.bits(), self.work.datapath());
        let from_format = all.into_iter().skip_while(|one| *one != format);
        let unknown: Vec<_> = from_format.filter(|one| self.is_good(part, own, *one).is_none()).collect();
        self.try_in(part, &unknown)?;
        Ok(self.is_good(part, own, format) == Some(true))
    }

    /// Registers that are good for each of these parts: those, or with some fraction bits more in each. `uniform` is the answer in one
    /// format. That the union of registers is good is shown by a run of each part.
    pub(crate) fn confirmed(
        &self,
        mut registers: RegistersOfSet,
        parts: &[usize],
        uniform: FormatName,
    ) -> Result<RegistersOfSet> {
        const MOST_ADDED: u32 = 4;
        while !interrupt::is_set() && registers.added_bits <= MOST_ADDED {
            let progress = Progress::of("parts with these registers", parts.len());
            let good = in_parallel(parts, |part| {
                progress.step();
                self.is_good_in(*part, &registers, uniform)
            });
            if good.into_iter().collect::<Result<Vec<bool>>>()?.into_iter().all(|good| good) {
                registers.is_confirmed = true;
                break;
            }
            registers = registers.with_a_bit_more();
        }
        Ok(registers)
    }

    /// Whether the run of a part with these registers is good.
    fn is_good_in(&self, part: usize, registers: &RegistersOfSet, uniform: FormatName) -> Result<bool> {
        let bits = registers.fraction_bits();
        let name = format!("registers {}", fingerprint_of(&format!("{uniform} {bits:?}")));
        if let Some(good) = self.store().known().tried(part, &name) {
            return Ok(good.is_some());
        }
        let run = output::kept(|| match self.problem(part)? {
            Ok((AnyProblem::Planar(problem), _)) => self.run_in_registers(part, &problem, uniform, &bits),
            Ok((AnyProblem::Spatial(problem), _)) => self.run_in_registers(part, &problem, uniform, &bits),
            Err(_) => bail!("{}: it was run before, and cannot be run again", self.files[part].name),
        });
        let good = run.0?.as_ref().map(GoodRun::of).transpose()?;
        let is_good = good.is_some();
        self.add(SetLine::Tried(Tried { part, format: name, good }))?;
        Ok(is_good)
    }

    fn run_in_registers<const D: usize>(
        &self,
        part: usize,
        problem: &Problem<D>,
        uniform: FormatName,
        bits: &BTreeMap<String, u32>,
    ) -> Result<Option<JudgedRun>>
    where
        Space: Dimension<D>,
    {
        let (plan, options) = (self.plan(part, problem)?, self.work.options_for(problem)?);
        Ok(format_compare::run_in_registers(problem, &plan, &options, uniform, bits)?)
    }

    /// Sees to it that it is known what a part breaks in a format that is too narrow for it.
    fn expect_broken(&self, part: usize, format: FormatName) -> Result<()> {
        if interrupt::is_set() || self.store().known().broken(part, &format.to_string()).is_some() {
            return Ok(());
        }
        let by = output::kept(|| match self.problem(part)? {
            Ok((AnyProblem::Planar(problem), _)) => self.broken_in(&problem, format),
            Ok((AnyProblem::Spatial(problem), _)) => self.broken_in(&problem, format),
            Err(_) => bail!("{}: it was run before, and cannot be run again", self.files[part].name),
        });
        self.add(SetLine::Broken(Broken { part, format: format.to_string(), by: by.0? }))
    }

    /// What the run of the whole path in a format breaks first.
    fn broken_in<const D: usize>(&self, problem: &Problem<D>, format: FormatName) -> Result<Option<Limiting>>
    where
        Space: Dimension<D>,
    {
        let (formats, options) = (selected::<D>(&[format.to_string()])?, self.work.options_for(problem)?);
        let options = Options { engine: Engine::Pieces, ..options };
        let compared =
            format_compare::compare_with(problem, &formats, &[Engine::Pieces], &options, &Watch::default())?;
        let run = compared.comparison.formats.first().map(serde_json::to_value).transpose()?;
        Ok(run.as_ref().and_then(Limiting::broken_by))
    }

    /// Tries a part in formats until one is good.
    fn try_in(&self, part: usize, formats: &[FormatName]) -> Result<()> {
        let again = || format!("{}: it was run before, and cannot be run again", self.files[part].name);
        match self.problem(part)? {
            Ok((AnyProblem::Planar(problem), _)) => self.try_problem_in(part, &problem, formats),
            Ok((AnyProblem::Spatial(problem), _)) => self.try_problem_in(part, &problem, formats),
            Err(PartEnding::Unread(why) | PartEnding::Refused(why)) => bail!("{why}"),
            Err(PartEnding::Result(_)) => bail!("a refusal is no result"),
        }
        .with_context(again)
    }

    fn try_problem_in<const D: usize>(
        &self,
        part: usize,
        problem: &Problem<D>,
        formats: &[FormatName],
    ) -> Result<()>
    where
        Space: Dimension<D>,
    {
        let (plan, options) = (self.plan(part, problem)?, self.work.options_for(problem)?);
        for format in formats {
            let runs = runs_in(problem, &plan, &[], &options, &[*format])?;
            let run = runs.first().and_then(Option::as_ref);
            self.add_tried(part, *format, run)?;
            if run.is_some() || interrupt::is_set() {
                break;
            }
        }
        Ok(())
    }

    /// The result of each part that was run, by its number.
    pub(crate) fn results(&self) -> Result<BTreeMap<usize, Value>> {
        let store = self.store();
        let of = |part: usize| match store.known().ending(part) {
            Some(PartEnding::Result(json)) => Some(serde_json::from_str(json).map(|value| (part, value))),
            _ => None,
        };
        Ok((0..self.files.len()).filter_map(of).collect::<Result<_, _>>()?)
    }
}
