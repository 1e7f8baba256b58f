//! A kernel's run in one format, judged.

use std::fmt;
use std::ops::ControlFlow;

use real::{Audit, Audited, Backend, FormatName, Watch, Watched, Watching, Work};
use serde::Serialize;

use crate::bench::{Observer, run};
use crate::case::Case;
use crate::ended::Ended;
use crate::formats::in_format;
use crate::judge::{Judge, OutputFound};
use crate::kernel::Kernel;
use crate::reference::Reference;
use crate::table::exact;

/// A run in one format.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct FormatRun {
    /// The format.
    pub format: String,
    /// Its width.
    pub bits: u32,
    /// Whether the run is finished, meets every requirement, and loses no number.
    pub good: bool,
    /// The first step in which it is not: a requirement is broken, a number lost, or the run ends.
    pub first_bad_step: Option<usize>,
    /// How the run ended.
    pub ended: Ended,
    /// The outputs.
    pub outputs: Vec<OutputFound>,
    /// Numbers that were lost, if any.
    pub overflows: Option<Overflows>,
    /// The first comparison that turned out otherwise than in the reference.
    pub divergence: Option<Divergence>,
    /// The range of each named signal, in the order of names.
    pub signals: Vec<SignalFound>,
    /// Everything that the audit of the run saw, for a picture of the signals. It is no part of JSON.
    #[serde(skip)]
    pub audit: Audit,
}

/// Numbers that a run lost.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Overflows {
    /// Results too large for the format.
    pub count: u64,
    /// Divisions by zero.
    pub divisions_by_zero: u64,
    /// The step of the first one, from 0.
    pub first_step: usize,
    /// The signal that was named next after the first overflow.
    pub first_signal: Option<&'static str>,
}

/// Where a format and the reference went different ways.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Divergence {
    /// The step, from 0.
    pub step: usize,
    /// The signal that was compared, or the one that was named last before.
    pub signal: Option<&'static str>,
    /// Whether the comparison holds in the format.
    pub holds: bool,
    /// The two numbers that were compared in the format.
    pub compared: [f64; 2],
    /// The two in the reference.
    pub in_reference: Option<[f64; 2]>,
}

/// The range of a named signal.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct SignalFound {
    /// Its name.
    pub signal: &'static str,
    /// The least value.
    pub min: f64,
    /// The greatest value.
    pub max: f64,
}

impl FormatRun {
    /// The largest share of a requirement's limit that the run takes.
    #[must_use]
    pub fn used(&self) -> f64 {
        let all = self.outputs.iter().flat_map(|output| &output.requirements);
        all.map(|one| one.used()).fold(0.0, f64::max)
    }

    /// What happened in the run besides errors, each in a sentence: its end, lost numbers, and the other way that it went.
    #[must_use]
    pub fn remarks(&self) -> Vec<String> {
        let end = self.ended.step().map(|_| self.ended.to_string());
        let lost = self.overflows.as_ref().map(ToString::to_string);
        let other = self.divergence.as_ref().map(ToString::to_string);
        [end, lost, other].into_iter().flatten().collect()
    }
}

impl fmt::Display for Overflows {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let counted = |count: u64, one: &str, others: &str| match count {
            0 => None,
            1 => Some(format!("1 {one}")),
            _ => Some(format!("{count} {others}")),
        };
        let kinds = [
            counted(self.count, "overflow", "overflows"),
            counted(self.divisions_by_zero, "division by zero", "divisions by zero"),
        ];
        let kinds = kinds.into_iter().flatten().collect::<Vec<_>>().join(" and ");
        write!(f, "{kinds}, first in step {}", self.first_step)?;
        self.first_signal.map_or(Ok(()), |signal| write!(f, ", before or at {signal}"))
    }
}

impl fmt::Display for Divergence {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let signal = self.signal.map_or_else(String::new, |signal| format!(" at {signal}"));
        let [left, right] = self.compared.map(exact);
        write!(f, "goes another way than the reference in step {}{signal}: {left} and {right}", self.step)?;
        let Some(pair) = self.in_reference else { return Ok(()) };
        let [left, right] = pair.map(exact);
        write!(f, ", in the reference {left} and {right}")
    }
}

/// Judges the steps of an audited run.
struct Judging<'a> {
    judge: Judge<'a>,
    first_lost: Option<usize>,
}

impl<R: Backend> Observer<Watched<Audited<R>>> for Judging<'_> {
    fn ends(&mut self, step: usize, outputs: &[Watched<Audited<R>>]) -> ControlFlow<()> {
        self.judge.note(step, outputs.iter().map(|number| number.to_f64_pair()));
        if self.first_lost.is_none() && Audit::lost_so_far() > 0 {
            self.first_lost = Some(step);
        }
        ControlFlow::Continue(())
    }
}

/// A run to be judged.
struct Judged<'a, 'k, K> {
    case: &'a Case<'k, K>,
    reference: &'a Reference,
}

/// The run of the kernel in this format.
pub(crate) fn judged<K: Kernel>(case: &Case<'_, K>, reference: &Reference, format: FormatName) -> FormatRun {
    in_format(format, Judged { case, reference })
}

impl<K: Kernel> Work for Judged<'_, '_, K> {
    type Output = FormatRun;

    fn in_backend<R: Backend>(self) -> FormatRun {
        let Self { case, reference } = self;
        let judge = Judge::new(&case.outputs, &reference.outputs, case.steps);
        let mut judging = Judging { judge, first_lost: None };
        let against = Watching::Against(reference.decisions.clone());
        let ((ended, watch), audit) =
            Audit::of(|| Watch::of(against, || run::<K, Watched<Audited<R>>>(case, &mut judging)));
        let Judging { judge, first_lost } = judging;
        let finished = ended == Ended::Finished;
        let outputs = if finished { judge.finished() } else { judge.so_far() };
        // Where a number does not fit, what follows from its replacement says nothing.
        let fits = !matches!(ended, Ended::DoesNotFit { .. });
        let lost = fits && audit.overflows + audit.divisions_by_zero > 0;
        let overflows = lost.then(|| Overflows {
            count: audit.overflows,
            divisions_by_zero: audit.divisions_by_zero,
            first_step: first_lost.or(ended.step()).unwrap_or(0),
            first_signal: audit.first_overflow,
        });
        let broken = outputs.iter().filter_map(OutputFound::first_broken);
        let bad = broken.chain(ended.step()).chain(overflows.iter().map(|one| one.first_step)).min();
        let signal = |(signal, range): (&&'static str, &real::SignalRange)| SignalFound {
            signal,
            min: range.min,
            max: range.max,
        };
        FormatRun {
            format: R::name().to_string(),
            bits: R::name().bits(),
            good: finished && bad.is_none(),
            first_bad_step: bad,
            ended,
            outputs,
            overflows,
            divergence: watch.found.filter(|_| fits).map(|decision| {
                let step = reference.step_of(decision.number);
                let other = Reference::decision(case, decision.number, step);
                Divergence {
                    step,
                    signal: decision.signal,
                    holds: decision.holds,
                    compared: [decision.left, decision.right],
                    in_reference: other.map(|other| [other.left, other.right]),
                }
            }),
            signals: audit.signals.iter().map(signal).collect(),
            audit,
        }
    }
}
