//! The fewest bits that are enough: in one format for all signals, and in a register for each.
//!
//! *Uniform.* A format is good if its run is finished, meets every requirement, and loses no number. The answer is the least
//! width from 12 to 48 bits of which some division into integer and fraction bits is good; of that width, it is the good
//! one with the most fraction bits.
//!
//! It is found without trying each format. Two fixed-point formats with the same fraction bits compute the same values as
//! long as none of them overflows. So one run at 64 bits says for all widths with these fraction bits what they compute, and how
//! many integer bits it takes: narrower ones overflow, and are bad. Where a kernel asks for the greatest or the least
//! number, which do depend on the width, each format is tried. The format found is run by itself, under audit, in either case.

use std::cell::Cell;
use std::fmt;
use std::ops::RangeInclusive;
use std::thread;

use feed_plan::in_parallel;
use real::{Datapath, FormatName, RuntimeFixed, RuntimeFormat, Watch, Watched, Watching};
use serde::Serialize;

use crate::bench::run;
use crate::case::Case;
use crate::ended::Ended;
use crate::kernel::Kernel;
use crate::reference::Reference;
use crate::refusal::Refusal;
use crate::registers::{Register, Registers, Search};
use crate::run::{FormatRun, judged};
use crate::table::{self, short};
use crate::until_bad::UntilBad;

/// Widths that are tried, in bits.
const WIDTHS: RangeInclusive<u32> = 12..=48;

/// Integer bits, with the sign, of the narrowest: 1 must be a number of the format.
const FEWEST_INTEGER_BITS: u32 = 2;

/// Width at which formats are run that stand for all with their fraction bits.
const WIDE: u32 = 64;

/// The fewest bits that are enough.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Sizing {
    /// The kernel.
    pub kernel: &'static str,
    /// Number of steps.
    pub steps: usize,
    /// The run in the narrowest format that is good for all signals alike; `None` if none of up to 48 bits is.
    pub uniform: Option<FormatRun>,
    /// A register for each named signal; `None` if no uniform format is good, or 53 bits are too few between registers.
    pub registers: Option<Registers>,
    /// Whether neither a format is good nor the reference, which breaks a requirement too or does not finish.
    pub not_a_question_of_format: bool,
    /// Number of runs of the search, of which most were ended early.
    pub runs: usize,
}

/// Searches for the fewest bits with which a kernel meets its requirements, in formats with this datapath.
///
/// # Errors
/// As [`compare`](crate::compare()).
pub fn size_in<K: Kernel>(kernel: &K, datapath: Datapath) -> Result<Sizing, Refusal> {
    let case = Case::of(kernel, &[])?;
    let reference = Reference::of(&case)?;
    let runs = Cell::new(0);
    let trials = Trials { case: &case, reference: &reference, datapath };
    let uniform = trials.narrowest(&runs);
    let registers = uniform.as_ref().and_then(|run| {
        let Some(FormatName::Fixed { fraction_bits, .. }) = FormatName::named(&run.format) else {
            return None;
        };
        let signals: Vec<_> = run.signals.iter().map(|one| one.signal).collect();
        let search = Search { case: &case, reference: &reference, datapath, runs: &runs };
        search.registers(&signals, fraction_bits, run.bits)
    });
    Ok(Sizing {
        kernel: kernel.name(),
        steps: case.steps,
        not_a_question_of_format: !reference.found.good && uniform.is_none(),
        uniform,
        registers,
        runs: runs.get(),
    })
}

/// [`size_in`] formats that round to nearest and wrap.
///
/// # Errors
/// As [`compare`](crate::compare()).
pub fn size<K: Kernel>(kernel: &K) -> Result<Sizing, Refusal> {
    size_in(kernel, Datapath::default())
}

/// A kernel that is tried in formats.
struct Trials<'a, 'k, K> {
    case: &'a Case<'k, K>,
    reference: &'a Reference,
    datapath: Datapath,
}

/// What a run at 64 bits says about all formats with its fraction bits.
struct Wide {
    fraction_bits: u32,
    is_good: bool,
    /// Integer bits that its results need.
    integer_bits: u32,
    /// Whether a result is just the first that one bit fewer does not hold: a quotient might be rounded to the one below.
    is_on_the_edge: bool,
    asked_for_bounds: bool,
}

impl<K: Kernel> Trials<'_, '_, K> {
    fn format(&self, width: u32, fraction_bits: u32) -> FormatName {
        let integer_bits = width.saturating_sub(fraction_bits);
        FormatName::Fixed { integer_bits, fraction_bits, datapath: self.datapath }
    }

    /// The run in this format, if it is good.
    fn good(&self, width: u32, fraction_bits: u32) -> Option<FormatRun> {
        Some(judged(self.case, self.reference, self.format(width, fraction_bits))).filter(|run| run.good)
    }

    /// The run in the narrowest good format.
    fn narrowest(&self, runs: &Cell<usize>) -> Option<FormatRun> {
        let cores = thread::available_parallelism().map_or(1, usize::from);
        let all: Vec<u32> = (0..=WIDTHS.end() - FEWEST_INTEGER_BITS).collect();
        let mut best: Option<FormatRun> = None;
        for some in all.chunks(cores) {
            let narrowest = best.as_ref().map_or(*WIDTHS.end(), |run| run.bits);
            let some: Vec<u32> =
                some.iter().copied().filter(|bits| bits + FEWEST_INTEGER_BITS <= narrowest).collect();
            let wide = in_parallel(&some, |fraction_bits| self.wide(*fraction_bits, narrowest));
            runs.set(runs.get() + wide.len());
            for wide in wide.iter().filter(|wide| wide.is_good || wide.asked_for_bounds) {
                if wide.asked_for_bounds {
                    return self.narrowest_of_all(runs);
                }
                let narrowest = best.as_ref().map_or(*WIDTHS.end(), |run| run.bits);
                best = self.narrowest_with(wide, narrowest).or(best);
            }
        }
        best
    }

    /// The run in the narrowest good format with the fraction bits of a good wide run, if it is not wider than `narrowest`.
    fn narrowest_with(&self, wide: &Wide, narrowest: u32) -> Option<FormatRun> {
        let needed = wide.integer_bits.max(FEWEST_INTEGER_BITS);
        let fewer = if wide.is_on_the_edge { needed.saturating_sub(1) } else { needed };
        (fewer.max(FEWEST_INTEGER_BITS)..=needed)
            .map(|integer_bits| (wide.fraction_bits + integer_bits).max(*WIDTHS.start()))
            .filter(|width| *width <= narrowest)
            .find_map(|width| self.good(width, wide.fraction_bits))
    }

    /// The run at 64 bits with these fraction bits. Formats wider than `narrowest` are of no interest.
    fn wide(&self, fraction_bits: u32, narrowest: u32) -> Wide {
        let Datapath { rounding, overflow } = self.datapath;
        // One more than fits, for what lies on the edge.
        let most_integer_bits = narrowest - fraction_bits + 1;
        let is_too_wide = || Watch::integer_bits_so_far(fraction_bits) > most_integer_bits;
        let mut until_bad = UntilBad::of(self.case, self.reference, is_too_wide);
        let run = || run::<K, Watched<RuntimeFixed<0>>>(self.case, &mut until_bad);
        let watched = || Watch::of(Watching::Nothing, run);
        let in_format = RuntimeFormat::new(WIDE, fraction_bits, rounding, overflow);
        let Some((ended, watch)) = in_format.map(|format| format.run::<0, _>(watched)) else {
            return Wide {
                fraction_bits,
                is_good: false,
                integer_bits: WIDE,
                is_on_the_edge: false,
                asked_for_bounds: false,
            };
        };
        let integer_bits = watch.integer_bits(fraction_bits);
        let edge = 1_i64.checked_shl((integer_bits + fraction_bits).saturating_sub(2));
        Wide {
            fraction_bits,
            is_good: ended == Ended::Finished && until_bad.good().is_some(),
            integer_bits,
            is_on_the_edge: edge == Some(watch.words.1),
            asked_for_bounds: watch.asked_for_bounds,
        }
    }

    /// The run in the narrowest good format, each of them tried.
    fn narrowest_of_all(&self, runs: &Cell<usize>) -> Option<FormatRun> {
        WIDTHS.into_iter().find_map(|width| {
            let splits: Vec<u32> = (0..=width - FEWEST_INTEGER_BITS).rev().collect();
            runs.set(runs.get() + splits.len());
            let tried = in_parallel(&splits, |fraction_bits| self.good(width, *fraction_bits));
            tried.into_iter().flatten().next()
        })
    }
}

impl Sizing {
    /// The result as JSON, on several lines.
    #[must_use]
    pub fn json(&self) -> String {
        // Names and numbers alone: there is nothing in it that JSON cannot hold.
        serde_json::to_string_pretty(self).unwrap_or_default()
    }
}

impl fmt::Display for Sizing {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Some(uniform) = &self.uniform else {
            let why = if self.not_a_question_of_format {
                "; double-double is not good either: it is no question of format"
            } else {
                ""
            };
            return writeln!(f, "{}: no format of {} bits is good enough{why}.", self.kernel, WIDTHS.end());
        };
        let (format, bits, used) = (&uniform.format, uniform.bits, uniform.used() * 100.0);
        writeln!(
            f,
            "{}: {format}, {bits} bits for all signals, takes {used:.0} % of what is allowed.",
            self.kernel
        )?;
        let Some(registers) = &self.registers else { return Ok(()) };
        let Registers { signals, bits, uniform_bits, .. } = registers;
        writeln!(f, "With a register for each signal {bits} bits in all, against {uniform_bits}:")?;
        let row = |one: &Register| {
            vec![one.signal.to_string(), one.format.clone(), one.bits.to_string(), short(one.bound)]
        };
        f.write_str(&table::table(
            &["signal", "format", "bits", "at most"],
            &signals.iter().map(row).collect::<Vec<_>>(),
        ))
    }
}
