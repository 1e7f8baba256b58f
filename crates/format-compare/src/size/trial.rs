//! Formats tried on a path: on the sections that are watched first, and then on the whole.
//!
//! A section is a run of its own, whose steps are those that it has in a run of the whole path. So a format that breaks a requirement
//! in one section does so in the whole, and nothing else need be run. Which sections are watched decides only how soon that is found.

use std::ops::RangeInclusive;
use std::sync::atomic::{AtomicUsize, Ordering};
use std::sync::{Mutex, PoisonError};

use limit_judge::StatedLimit;
use nurbs_core::CompileError;
use real::{Datapath, FormatName, RuntimeFixed, RuntimeFormat};

use crate::judge::judged_run::{JudgedRun, requirements_so_far};
use crate::judge::judgement::{IsEnough, Judge};
use crate::judge::reference::Reference;
use crate::judge::requirement::Requirement;
use crate::judge::stated_limits::stated_limits;
use crate::judge::tally::Tally;
use crate::refusal::Refusal;
use crate::run::by_engine;
use crate::run::formats::{Dimension, Space};
use crate::run::job::Job;
use crate::run::observer::{Observer, Stretch, stretches};
use crate::run::on_pieces::{self, PlannedSection};
use crate::run::options::{Engine, Options};
use crate::run::run::AboutRun;

/// Widths that are tried, in bits.
pub(crate) const WIDTHS: RangeInclusive<u32> = 12..=48;

/// Integer bits, with the sign, with which a search begins: 1 must be a number of the format.
pub(crate) const FEWEST_INTEGER_BITS: u32 = 2;

/// Most periods, in total, of the sections that are watched from the start, unless the hardest alone has more.
const MOST_WATCHED: u64 = 200_000;

/// The options of a search: those of a comparison's runs on pieces.
pub(crate) fn search_options(options: &Options) -> Options {
    Options { engine: Engine::Pieces, ..options.clone() }
}

/// What a format's trial came to.
pub(crate) enum Tried {
    /// The run of the whole path keeps every requirement.
    Good(Box<JudgedRun>),
    /// The run breaks a requirement.
    Broken,
    /// The path cannot be run in the format.
    Refused,
}

/// A path with its plan and its judge.
pub(crate) struct Trial<'a, const D: usize> {
    pub(crate) job: &'a Job<'a, D>,
    pub(crate) datapath: Datapath,
    reference: Reference<'a, D>,
    limits: Vec<StatedLimit>,
    /// No step of the plan is longer, in mm.
    longest_mm: f64,
    /// The sections; none if the path has no pieces, or the feed is overridden, so that a section depends on those before.
    sections: Vec<PlannedSection>,
    stretches: Vec<Stretch>,
    /// The numbers of the sections on which a format is tried before the whole, in order.
    watched: Mutex<Vec<usize>>,
    /// How often the whole path was run, or begun.
    pub(crate) runs: AtomicUsize,
}

impl<'a, const D: usize> Trial<'a, D>
where
    Space: Dimension<D>,
{
    pub(crate) fn new(job: &'a Job<'a, D>, datapath: Datapath) -> Result<Self, Refusal> {
        let sections = match job.options.overrides {
            None => on_pieces::planned_sections(job).unwrap_or_default(),
            Some(_) => Vec::new(),
        };
        let periods = sections.iter().map(|section| section.periods.end - section.periods.start);
        Ok(Self {
            job,
            datapath,
            reference: Reference::new(job.problem)?,
            limits: stated_limits(job.problem, 1.0),
            longest_mm: job.plan.greatest_feed(),
            stretches: stretches(periods),
            sections,
            watched: Mutex::default(),
            runs: AtomicUsize::new(0),
        })
    }

    /// Judges the run in this format that `run` makes in front of an observer.
    pub(crate) fn judged(
        &self,
        format: FormatName,
        run: impl FnOnce(&dyn Observer) -> Result<AboutRun, Refusal>,
    ) -> Result<JudgedRun, Refusal> {
        let Job { problem, options, .. } = self.job;
        let judged = JudgedRun::of_run((format, Engine::Pieces), problem, &self.reference, options, run);
        judged.inspect(|_| self.count_run())
    }

    /// The run at this width with the fewest integer bits for which the path compiles.
    pub(crate) fn narrowest_integer_part(&self, width: u32) -> JudgedRun {
        let mut integer_bits = FEWEST_INTEGER_BITS;
        loop {
            let datapath = self.datapath;
            let fraction_bits = width.saturating_sub(integer_bits);
            let name = FormatName::Fixed { integer_bits, fraction_bits, datapath };
            let Some(format) = self.format(width, integer_bits) else {
                let (what, value) = ("integer bits", f64::from(integer_bits));
                let refusal = Refusal::Limit { what, value, format: name };
                return JudgedRun::refused((name, Engine::Pieces), &refusal);
            };
            let tried = Space::at_run_time(format);
            match self.judged(name, |observer| tried.run_job(self.job, observer)) {
                Ok(judged) => return judged,
                Err(Refusal::Compile(CompileError::DoesNotFit { integer_bits: needed, .. }))
                    if needed > integer_bits =>
                {
                    integer_bits = needed;
                }
                Err(Refusal::Limit { .. }) if integer_bits < 8 => integer_bits += 1,
                Err(refusal) => return JudgedRun::refused((name, Engine::Pieces), &refusal),
            }
        }
    }

    fn count_run(&self) {
        self.runs.fetch_add(1, Ordering::Relaxed);
    }

    fn format(&self, width: u32, integer_bits: u32) -> Option<RuntimeFormat> {
        let Datapath { rounding, overflow } = self.datapath;
        RuntimeFormat::new(width, width.checked_sub(integer_bits)?, rounding, overflow)
    }

    /// Every format of this width, the one with the most fraction bits first.
    pub(crate) fn splits(&self, width: u32) -> Vec<RuntimeFormat> {
        (FEWEST_INTEGER_BITS..=width).filter_map(|integer_bits| self.format(width, integer_bits)).collect()
    }

    /// The numbers of the sections that are watched.
    pub(crate) fn watched(&self) -> Vec<usize> {
        self.watched.lock().unwrap_or_else(PoisonError::into_inner).clone()
    }

    /// Watches the section of this period from now on.
    fn watch(&self, period: u64) {
        let Some(section) = self.section_of(period) else { return };
        let mut watched = self.watched.lock().unwrap_or_else(PoisonError::into_inner);
        if !watched.contains(&section) {
            watched.push(section);
        }
    }

    fn section_of(&self, period: u64) -> Option<usize> {
        let section = self.sections.partition_point(|section| section.periods.end <= period);
        (section < self.sections.len()).then_some(section)
    }

    /// Watches the sections in which `runs` came nearest to their limits or broke them, the worst first.
    pub(crate) fn watch_hardest(&self, runs: &[JudgedRun]) {
        let on_pieces = runs.iter().filter(|run| run.engine == Engine::Pieces);
        let mut hard: Vec<_> = on_pieces
            .flat_map(|run| &run.requirements)
            .filter_map(|one| Some((one.used().filter(|used| used.is_finite())?, one.at?.period)))
            .collect();
        hard.sort_by(|one, other| other.0.total_cmp(&one.0));
        let mut left = MOST_WATCHED;
        for (_, period) in hard {
            // Periods of a run are numbered from 1.
            let Some(section) = self.section_of(period.saturating_sub(1)) else { continue };
            let periods = &self.sections[section].periods;
            let rest = left.checked_sub(periods.end - periods.start);
            if rest.is_some() || left == MOST_WATCHED {
                self.watch(periods.start);
                left = rest.unwrap_or(0);
            }
        }
    }

    /// Whether a format breaks nothing in these sections.
    pub(crate) fn holds_in(&self, format: RuntimeFormat, sections: &[usize]) -> bool {
        self.holds_in_each(format, sections).unwrap_or(false)
    }

    /// The same; a refusal where the path cannot be run in the format.
    fn holds_in_each(&self, format: RuntimeFormat, sections: &[usize]) -> Result<bool, Refusal> {
        for section in sections.iter().filter_map(|section| self.sections.get(*section)) {
            if !format.run::<0, _>(|| self.holds_in_section(section))? {
                return Ok(false);
            }
        }
        Ok(true)
    }

    /// Whether the run-time format breaks nothing in a section.
    fn holds_in_section(&self, section: &PlannedSection) -> Result<bool, Refusal> {
        let before = self.before_the_run()?;
        let is_enough = |_: usize, part: &Tally| !self.broken(&before, part).is_empty();
        let run =
            |observer: &dyn Observer| by_engine::section::<RuntimeFixed<0>, D>(self.job, section, observer);
        let (about, part) = self.judge(&is_enough).judge_section(run)?;
        Ok(self.broken(&about, &part).is_empty())
    }

    /// What is known of a run in the run-time format before it is made.
    fn before_the_run(&self) -> Result<AboutRun, Refusal> {
        let resolution_mm = on_pieces::resolution_mm::<RuntimeFixed<0>, D>(self.job)?;
        Ok(AboutRun { finished: true, resolution_mm, lead: self.job.lead(), ..AboutRun::default() })
    }

    /// The requirements that a part of a run breaks.
    fn broken(&self, run: &AboutRun, part: &Tally) -> Vec<Requirement> {
        let mut part = part.clone();
        part.expect_step(self.longest_mm);
        let mut all = requirements_so_far(self.job.problem, run, &part);
        all.retain(|one| !one.holds());
        all
    }

    fn judge<'b>(&'b self, is_enough: &'b IsEnough<'b>) -> Judge<'b, D> {
        Judge {
            reference: &self.reference,
            full_step_mm: self.job.problem.full_step_mm(),
            limits: &self.limits,
            starts_at_rest: self.job.options.starts_at_rest(),
            traced: None,
            progress: &|_| (),
            is_enough: Some(is_enough),
        }
    }

    /// Tries a format on the sections that are watched, and on the whole.
    pub(crate) fn tried(&self, format: RuntimeFormat) -> Tried {
        if format.run::<0, _>(|| on_pieces::compiled::<RuntimeFixed<0>, D>(self.job)).is_err() {
            return Tried::Refused;
        }
        match self.holds_in_each(format, &self.watched()) {
            Err(_) => Tried::Refused,
            Ok(true) => self.whole(format),
            Ok(false) => Tried::Broken,
        }
    }

    /// Runs the whole path in this format, until it is known to break a requirement. The section where it does is watched from then on.
    pub(crate) fn whole(&self, format: RuntimeFormat) -> Tried {
        let Ok(before) = format.run::<0, _>(|| self.before_the_run()) else { return Tried::Refused };
        let broken_in = Mutex::new(None);
        let is_enough = |stretch: usize, part: &Tally| {
            let broken = self.broken(&before, part);
            let begin = self.stretches.get(stretch).map_or(0, |stretch| stretch.first_period);
            // The first period of a stretch is judged last, so that its second is the first of these.
            let period = broken.first().map(|one| begin + one.at.map_or(0, |at| at.period));
            let mut broken_in = broken_in.lock().unwrap_or_else(PoisonError::into_inner);
            *broken_in = broken_in.or(period);
            period.is_some()
        };
        let tried = Space::at_run_time(format);
        let judged = self.judge(&is_enough).judge(|observer| tried.run_job(self.job, observer));
        let Ok((about, judgement)) = judged else { return Tried::Refused };
        self.count_run();
        if let Some(period) = broken_in.into_inner().unwrap_or_else(PoisonError::into_inner) {
            self.watch(period);
            return Tried::Broken;
        }
        let run = JudgedRun::of((format.name(), Engine::Pieces), self.job.problem, &about, &judgement);
        if run.verdict.is_good() {
            return Tried::Good(Box::new(run));
        }
        let broken = run.requirements.iter().filter(|one| !one.holds());
        broken.filter_map(|one| one.at).for_each(|at| self.watch(at.period.saturating_sub(1)));
        Tried::Broken
    }
}
