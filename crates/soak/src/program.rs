//! A program of hours, run in every format with feed overrides and holds that a seed draws, section by section.

use std::path::Path;
use std::time::Instant;

use anyhow::{Context, Result, bail, ensure};
use comfy_table::{CellAlignment, Table, presets};
use format_compare::{
    Dimension, Engine, JudgedRun, Machine, Options, OverrideTarget, Overrides, Problem, Space, Verdict,
    compare, plan_for, select,
};
use part_program::{Part, ReadOptions, read_machine, read_part_bytes};
use serde::Serialize;
use stress::SplitMix64;

/// The share of acceleration and jerk that the plan leaves for changes of the rate.
const RESERVE: f64 = 0.2;
/// The shares of the feed that are drawn; 0 is feed hold.
const SHARES: [f64; 8] = [0.0, 0.1, 0.25, 0.5, 0.75, 1.0, 1.25, 1.5];
/// Longest time from one command to the next, in s, and longest hold.
const MOST_BETWEEN_S: f64 = 20.0;
const MOST_HOLD_S: f64 = 2.0;

/// The runs of a program.
#[derive(Serialize)]
pub(crate) struct ProgramSoak {
    program: String,
    machine: String,
    date: String,
    version: String,
    seconds: f64,
    seed: u64,
    /// Sections of the plan, each from rest to rest.
    sections: usize,
    /// Commands that came into force in the run in f64, and how many of them were holds.
    commands: usize,
    holds: usize,
    /// The time that the run takes at these rates, in hours.
    hours: f64,
    formats: Vec<JudgedRun>,
}

/// Runs the program in the formats of these names.
pub(crate) fn soak(
    program: &Path,
    machine: &Path,
    names: &[&str],
    seed: u64,
    date: String,
) -> Result<ProgramSoak> {
    let read = |path: &Path| std::fs::read(path).with_context(|| format!("cannot read {}", path.display()));
    let name =
        |path: &Path| path.file_name().map_or_else(String::new, |name| name.to_string_lossy().into_owned());
    let lenient = ReadOptions { lenient: true, ..ReadOptions::default() };
    let part = read_part_bytes(&name(program), &read(program)?, lenient)?;
    let text =
        String::from_utf8(read(machine)?).with_context(|| format!("{} is no text", machine.display()))?;
    let own = read_machine(&name(machine), &text)?;
    let mut soak = if part.curves.iter().all(|curve| curve.dimension() == 2) {
        of_part::<2>(&part, &own, names, seed)?
    } else {
        of_part::<3>(&part, &own, names, seed)?
    };
    (soak.program, soak.machine, soak.date) = (name(program), name(machine), date);
    Ok(soak)
}

fn of_part<const D: usize>(part: &Part, machine: &Machine, names: &[&str], seed: u64) -> Result<ProgramSoak>
where
    Space: Dimension<D>,
{
    let started = Instant::now();
    let problem = Problem::<D>::new(part, machine)?;
    let formats = select::<D>(names).map_err(anyhow::Error::msg)?;
    let Some(any) = formats.first() else { bail!("no format") };
    let options = Options::default();
    let highest = Overrides::try_new(vec![target(0.0, greatest_share())], RESERVE)?;
    let to_plan = highest.to_plan(&problem);
    let plan = plan_for(&to_plan, any.as_ref(), &options)?;
    let planned_s = plan.periods() as f64 * problem.period_s();
    let targets = drawn(seed, planned_s);
    let overrides = Overrides::try_new(targets.clone(), RESERVE)?;
    ensure!(overrides.highest() <= greatest_share(), "a command is above the highest");
    let options = Options { overrides: Some(overrides.commands(&problem, &plan)?), ..options };
    let formats = compare(&to_plan, &formats, &[Engine::Pieces], &options)?.formats;
    let periods = formats.iter().filter_map(|run| run.periods).max().unwrap_or(0);
    let seconds = periods as f64 * problem.period_s();
    let in_force: Vec<_> = targets.iter().filter(|target| target.time_s < seconds).collect();
    Ok(ProgramSoak {
        program: String::new(),
        machine: String::new(),
        date: String::new(),
        version: env!("CARGO_PKG_VERSION").to_string(),
        seconds: started.elapsed().as_secs_f64(),
        seed,
        sections: plan.schedule().sections().count(),
        commands: in_force.len(),
        holds: in_force.iter().filter(|target| target.share <= 0.0).count(),
        hours: seconds / 3600.0,
        formats,
    })
}

fn target(time_s: f64, share: f64) -> OverrideTarget {
    OverrideTarget { time_s, share }
}

fn greatest_share() -> f64 {
    SHARES.iter().copied().fold(0.0, f64::max)
}

/// Commands from the start to beyond the end of a plan that takes `planned_s` at the highest feed. The first is the highest,
/// for which the plan is made, and the last is no hold.
fn drawn(seed: u64, planned_s: f64) -> Vec<OverrideTarget> {
    let mut words = SplitMix64::new(seed);
    let mut draw = || words.next().unwrap_or_default();
    let mut targets = vec![target(0.0, greatest_share())];
    let mut time_s = 0.0;
    while time_s < 8.0 * planned_s {
        let held = targets.last().is_some_and(|last| last.share <= 0.0);
        let most = if held { MOST_HOLD_S } else { MOST_BETWEEN_S };
        time_s += most * (draw() >> 32) as f64 / 2.0_f64.powi(32);
        let index = usize::try_from(draw() >> 61).unwrap_or_default();
        targets.push(target(time_s, SHARES.get(index).copied().unwrap_or(1.0)));
    }
    targets.push(target(time_s + MOST_HOLD_S, 1.0));
    targets
}

impl ProgramSoak {
    /// Whether every run ended, and without an overflow; refused formats do not count.
    pub(crate) fn is_kept(&self) -> bool {
        self.formats.iter().filter(|run| !run.is_refused()).all(|run| {
            let broken = |what| run.requirements.iter().any(|one| one.what == what && !one.holds());
            !broken("stops before the end of the path") && !broken("overflows")
        })
    }

    pub(crate) fn to_json(&self) -> Result<String> {
        Ok(serde_json::to_string_pretty(self)? + "\n")
    }

    pub(crate) fn to_text(&self) -> String {
        let Self { program, hours, commands, holds, sections, seed, seconds, date, .. } = self;
        let mut table = Table::new();
        table.load_preset(presets::NOTHING).set_header([
            "format",
            "periods",
            "fluctuation",
            "chord error,\nmm",
            "position error,\nmm",
            "verdict",
        ]);
        table.add_rows(self.formats.iter().map(row));
        for column in table.column_iter_mut().skip(1).take(4) {
            column.set_cell_alignment(CellAlignment::Right);
        }
        format!(
            "{program}: {hours:.2} h in {sections} sections, {commands} commands, {holds} of them holds\n\n{}\n\
             seed {seed}, {seconds:.0} s, {date}\n",
            table.trim_fmt()
        )
    }
}

fn row(run: &JudgedRun) -> Vec<String> {
    let figure = |figure: Option<f64>| figure.map_or_else(String::new, |figure| format!("{figure:.1e}"));
    let verdict = match &run.verdict {
        Verdict::Good => "good".to_string(),
        other => other.to_string(),
    };
    vec![
        run.format.clone(),
        run.periods.map_or_else(String::new, |periods| periods.to_string()),
        figure(run.fluctuation.map(|found| found.cruise_max_abs)),
        figure(run.chord_error_mm_max),
        figure(run.position_error_mm_max),
        verdict,
    ]
}
