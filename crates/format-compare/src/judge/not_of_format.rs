//! Why no format is good where the format is not the cause: which requirements `f64` does not keep either, where, and
//! what changes help.
//!
//! No remedy is guessed: each change is planned and run in `f64`, and named only if that run keeps every requirement.

use std::fmt;

use feed_plan::ProfileKind;
use part_program::Junction;
use real::Backend;
use serde::Serialize;

use crate::judge::judged_run::JudgedRun;
use crate::judge::reference::Reference;
use crate::judge::requirement::Requirement;
use crate::problem::problem::Problem;
use crate::run::formats::{Dimension, Space, plan_for};
use crate::run::observer::Observer;
use crate::run::options::{Engine, Options, PlanIn};

/// A figure of `f64` that is this many times what rounding alone may cause is not a matter of rounding.
const BEYOND_ROUNDING: f64 = 1000.0;

/// Periods up to which a change is tried, so that the answer comes soon.
const MOST_TRIED: u64 = 1 << 22;

/// Why no format can be good: the requirements that `f64` does not keep, although its digits are enough.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct NotOfFormat {
    /// The run that shows it: `f64 pieces`.
    pub run: String,
    /// The time that it takes along the path, in s.
    pub time_s: f64,
    /// The requirements, with figure, limit and place, that it does not keep. No other format that reaches the end of
    /// the path keeps them either.
    pub broken: Vec<Requirement>,
    /// Changes after which `f64` keeps every requirement; each was tried alone.
    pub helps: Vec<Remedy>,
    /// Changes that were tried and are not enough.
    pub does_not_help: Vec<String>,
}

/// A change that helps.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Remedy {
    /// The change, in the words of the machine file if it has any for it.
    pub change: String,
    /// The time that the run takes after the change, in s.
    pub time_s: f64,
}

impl fmt::Display for NotOfFormat {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "It is not a question of the format: {} fails too.", self.run)?;
        for one in &self.broken {
            write!(f, "\n- {}", one.broken)?;
            if let Some(at) = one.at {
                let [x, y, z] = at.point_mm;
                write!(f, ", at X{x:.3} Y{y:.3} Z{z:.3}, {:.3} s after the start", at.time_s)?;
            }
            write!(f, ".")?;
        }
        for Remedy { change, time_s } in &self.helps {
            write!(
                f,
                "\nWhat helps: {change}. The path then takes {time_s:.3} s, not {:.3} s.",
                self.time_s
            )?;
        }
        if !self.does_not_help.is_empty() {
            write!(f, "\nTried, and not enough: {}.", self.does_not_help.join("; "))?;
        }
        Ok(())
    }
}

/// Why none of `runs` is good, if `f64` on pieces breaks requirements by more than its rounding and every run that
/// reaches the end of the path breaks them too. `None` if a run is good, if `f64` would be good, or if `f64` refuses
/// the part. Runs `problem` in `f64` unless that run is among `runs`, and once more for each change that is tried.
#[must_use]
pub fn not_of_format<const D: usize>(
    problem: &Problem<D>,
    runs: &[JudgedRun],
    options: &Options,
) -> Option<NotOfFormat>
where
    Space: Dimension<D>,
{
    if runs.iter().any(|run| run.verdict.is_good()) {
        return None;
    }
    let reference = Reference::new(problem).ok()?;
    let options = Options { engine: Engine::Pieces, plan_in: PlanIn::default(), ..options.clone() };
    let name = f64::name().to_string();
    let listed = runs.iter().find(|run| run.format == name && run.engine == Engine::Pieces);
    let own = listed.cloned().or_else(|| run(problem, &reference, &options))?;
    let fails = |run: &JudgedRun, what| run.requirements.iter().any(|one| one.what == what && !one.holds());
    let ends =
        |run: &&JudgedRun| !run.requirements.is_empty() && !fails(run, "stops before the end of the path");
    let is_shared = |one: &&Requirement| runs.iter().filter(ends).all(|run| fails(run, one.what));
    let is_broken =
        |one: &&Requirement| !one.holds() && is_beyond_rounding(one, &own, problem.full_step_mm());
    let broken: Vec<_> = own.requirements.iter().filter(is_broken).filter(is_shared).cloned().collect();
    if broken.is_empty() {
        return None;
    }
    let time = |run: &JudgedRun| run.periods.map_or(0.0, |periods| problem.period_s() * periods as f64);
    let mut found = NotOfFormat {
        run: format!("{name} {}", own.engine),
        time_s: time(&own),
        broken,
        helps: Vec::new(),
        does_not_help: Vec::new(),
    };
    for tries in changes(problem, &options) {
        for Change { words, problem, options } in tries {
            let Ok(reference) = Reference::new(&problem) else { continue };
            let Some(judged) = run(&problem, &reference, &options) else { continue };
            if judged.verdict.is_good() {
                found.helps.push(Remedy { change: words, time_s: time(&judged) });
                break;
            }
            found.does_not_help.push(words);
        }
    }
    found.helps.sort_by(|one, other| one.time_s.total_cmp(&other.time_s));
    Some(found)
}

/// The run in `f64`; `None` if it is refused or would take too long.
fn run<const D: usize>(
    problem: &Problem<D>,
    reference: &Reference<'_, D>,
    options: &Options,
) -> Option<JudgedRun>
where
    Space: Dimension<D>,
{
    let format = Space::format(f64::name())?;
    if options.is_interrupted() {
        return None;
    }
    let plan = plan_for(problem, format.as_ref(), options).ok()?;
    if plan.periods() > MOST_TRIED {
        return None;
    }
    let run = |observer: &dyn Observer| format.run_before(problem, &plan, options, observer);
    JudgedRun::of_run((f64::name(), options.engine), problem, reference, options, run).ok()
}

/// Whether a requirement concerns the path, and its figure is more than the digits of `run` can cause: rounding of its
/// positions, and of lengths and positions in a step of F·T.
pub(crate) fn is_beyond_rounding(one: &Requirement, run: &JudgedRun, full_step_mm: f64) -> bool {
    let [place, length] =
        [run.position_resolution_mm, run.fluctuation_resolution].map(Option::unwrap_or_default);
    let rounding = match (one.what, one.unit) {
        ("position error" | "overflows" | "step of the format in a period's way", _) => return false,
        (_, "mm") => place,
        (_, "ratio") => length + place / full_step_mm,
        _ => 0.0,
    };
    one.found.is_nan() || one.found > BEYOND_ROUNDING * rounding
}

/// A change that may help, in the words of the machine file or the command line.
struct Change<const D: usize> {
    words: String,
    problem: Problem<D>,
    options: Options,
}

/// Lists of changes that may help. Of each list, the first change that helps counts.
fn changes<const D: usize>(problem: &Problem<D>, options: &Options) -> Vec<Vec<Change<D>>> {
    let of_problem = |words: String, problem| Change { words, problem, options: options.clone() };
    let of_options =
        |words: &str, options| Change { words: words.to_string(), problem: problem.clone(), options };
    let mut changes = Vec::new();
    if problem.machine.junction != Junction::Stop {
        let mut stop = problem.clone();
        stop.machine.junction = Junction::Stop;
        changes.push(vec![of_problem("`junction = \"stop\"` in the machine file".to_string(), stop)]);
    }
    let slower = [("half", 0.5), ("a quarter", 0.25)].map(|(words, share)| {
        let slower = problem.at_feedrate(problem.feedrate_mm_per_s() * share);
        of_problem(format!("{words} of the feed everywhere"), slower)
    });
    let closer = [0.5, 0.25].map(|share| {
        let mut closer = problem.clone();
        closer.machine.chord_error_mm *= share;
        of_problem(
            format!("`chord_error_mm = {}` in the machine file", closer.machine.chord_error_mm),
            closer,
        )
    });
    changes.extend([slower, closer].map(Vec::from));
    if options.profile != ProfileKind::SCurve {
        let s_curves = Options { profile: ProfileKind::SCurve, ..options.clone() };
        changes.push(vec![of_options("`--profile s-curve`", s_curves)]);
    }
    let raw = Options { engine: Engine::DeBoorSecant, ..options.clone() };
    changes.push(vec![of_options("`--evaluate de-boor`", raw)]);
    changes
}
