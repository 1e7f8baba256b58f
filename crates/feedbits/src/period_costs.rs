//! What `compare --targets` and `size --targets` print: what a period costs on each target, in each format.

use std::collections::BTreeMap;

use format_compare::{Comparison, Cost, Engine, JudgedRun, PeriodCost, Sizing, Verdict};
use target_cost::{Kind, Measure, Target};

use crate::screen::{self, labelled, list};

/// The costs of a comparison that was priced, with remarks: for these forms of the path in 80 columns, or for all forms
/// in full width.
pub(crate) fn tables(comparison: &Comparison, targets: &[Target], engines: Option<&[Engine]>) -> String {
    let mut text = String::new();
    for target in targets {
        let table = match engines {
            Some(engines) => narrow_costs(comparison, target, engines),
            None => wide_costs(comparison, target),
        };
        text += &format!("\n{}{table}", screen::paragraph(&heading(target)));
        for line in findings(comparison, target) {
            text += &labelled("- ", &line);
        }
    }
    text
}

fn heading(target: &Target) -> String {
    let level = match (target.calibrated, target.kind) {
        (true, _) => "recorded steps, costs of operations counted in an emulator",
        (false, Kind::Processor) => "recorded steps in program order, costs of operations from manuals",
        (false, _) => "recorded steps, list schedule, costs of operations from manuals",
    };
    let units: Vec<_> = target.unit.iter().map(|unit| format!("{} {}", unit.count, unit.name)).collect();
    let units = if units.is_empty() { String::new() } else { format!("; {}", units.join(", ")) };
    format!("{} ({level}{units})", target.title)
}

/// The unit of a period's costs.
fn counted_in(target: &Target) -> &'static str {
    match target.measure {
        Measure::Cycles => "cycles",
        Measure::Instructions => "instructions",
    }
}

fn range(middle: f64, [low, high]: [f64; 2]) -> String {
    format!("{middle:.0} ({low:.0}–{high:.0})")
}

fn time_and_share(cost: &PeriodCost) -> [String; 2] {
    let time = cost.microseconds_max.map_or_else(|| "unknown".to_string(), |us| format!("{us:.1}"));
    let share = cost.share_of_period.map(|share| format!("{:.2} %", share * 100.0));
    [time, share.unwrap_or_default()]
}

/// The headings of what an FPGA's costs have beside time.
const OF_FPGA: [&str; 3] = ["DSP\nblocks", "LUTs", "to the\nnext axis"];

fn size_and_interval(cost: &PeriodCost) -> [String; 3] {
    let number = |count: Option<u32>| count.map_or_else(String::new, |count| count.to_string());
    [
        number(cost.dsp_blocks),
        number(cost.luts),
        cost.initiation_interval_max.map_or_else(String::new, |i| format!("{i:.0}")),
    ]
}

/// The costs of a search that was priced: of the narrowest format, and of the registers.
pub(crate) fn of_sizing(sizing: &Sizing, targets: &[Target]) -> String {
    let uniform = sizing.uniform.as_ref().map(|row| (row.format.clone(), &row.cycles));
    let mixed = sizing.mixed.as_ref().and_then(|mixed| Some((mixed.widest()?.to_string(), &mixed.cycles)));
    let of = |target: &Target| {
        let fpga = target.kind == Kind::Fpga;
        let worst = format!("{} of the\nworst period", counted_in(target));
        let mut header = vec!["datapath", "operators", &worst, "µs", "of the\nperiod"];
        header.extend(fpga.then_some(OF_FPGA).into_iter().flatten());
        let row = |(what, (format, costs)): (&str, &(String, &BTreeMap<String, Cost>))| {
            let mut cells = vec![what.to_string(), format.clone()];
            match costs.get(&target.name)? {
                Cost::Known(cost) => {
                    cells.push(range(cost.max, cost.max_range));
                    cells.extend(time_and_share(cost));
                    cells.extend(fpga.then(|| size_and_interval(cost)).into_iter().flatten());
                }
                Cost::Unknown { unknown } => cells.push(format!("unknown: nobody publishes its {unknown}")),
            }
            Some(cells)
        };
        let rows = [("one format", &uniform), ("registers", &mixed)];
        let rows = rows.into_iter().filter_map(|(what, costs)| row((what, costs.as_ref()?))).collect();
        format!("\n{}{}", screen::paragraph(&heading(target)), screen::table(&header, rows))
    };
    targets.iter().map(of).collect()
}

/// The longest period of each format, and below the table the costs that are unknown.
fn narrow_costs(comparison: &Comparison, target: &Target, engines: &[Engine]) -> String {
    let names_path = engines.len() > 1;
    let fpga = target.kind == Kind::Fpga;
    let worst = format!("{} of the\nworst period", counted_in(target));
    let mut header = vec!["format", "path", &worst, "µs", "of the\nperiod", "most work\nin"];
    if fpga {
        header.extend(OF_FPGA);
    }
    if !names_path {
        header.remove(1);
    }
    let (mut rows, mut unknown) = (Vec::new(), Vec::new());
    let runs =
        |row: &&JudgedRun| engines.contains(&row.engine) && !matches!(row.verdict, Verdict::Refused(_));
    for row in comparison.formats.iter().filter(runs) {
        match row.cycles.get(&target.name) {
            Some(Cost::Known(cost)) => {
                let mut cells = vec![row.format.clone()];
                cells.extend(names_path.then(|| row.engine.to_string()));
                cells.push(range(cost.max, cost.max_range));
                cells.extend(time_and_share(cost));
                cells.push(format!("{} {:.0} %", cost.dominating, cost.dominating_share * 100.0));
                cells.extend(fpga.then(|| size_and_interval(cost)).into_iter().flatten());
                rows.push(cells);
            }
            Some(Cost::Unknown { unknown: what }) => {
                unknown.push((row.format.clone(), format!("unknown, as nobody publishes its {what}")));
            }
            None => {}
        }
    }
    let unknown = screen::by_what_is_said(unknown).into_iter();
    let unknown = unknown.map(|(names, words)| labelled("- ", &format!("{names}: {words}")));
    screen::table(&header, rows) + &unknown.collect::<String>()
}

fn wide_costs(comparison: &Comparison, target: &Target) -> String {
    let what = counted_in(target);
    let mean = format!("{what} a period\nmean (low–high)");
    let max = format!("{what} a period\nworst (low–high)");
    let fpga = target.kind == Kind::Fpga;
    let mut header = vec!["format", "path", &mean, &max, "µs\nworst", "of the\nperiod", "most work in"];
    if fpga {
        header.extend(OF_FPGA);
    }
    let row = |row: &JudgedRun| {
        let mut cells = vec![row.format.clone(), row.engine.to_string()];
        match row.cycles.get(&target.name) {
            Some(Cost::Known(cost)) => {
                cells.push(range(cost.mean, cost.mean_range));
                cells.push(range(cost.max, cost.max_range));
                cells.extend(time_and_share(cost));
                cells.push(format!("{} {:.0} %", cost.dominating, cost.dominating_share * 100.0));
                cells.extend(fpga.then(|| size_and_interval(cost)).into_iter().flatten());
            }
            Some(Cost::Unknown { unknown }) => cells.push(format!("unknown: nobody publishes its {unknown}")),
            None => {}
        }
        cells
    };
    let ran = comparison.formats.iter().filter(|row| !matches!(row.verdict, Verdict::Refused(_)));
    screen::wide_table(&header, ran.map(row).collect(), &[0, 1, 6])
}

/// Remarks about the figures on this target.
fn findings(comparison: &Comparison, target: &Target) -> Vec<String> {
    let known = |row: &JudgedRun| match row.cycles.get(&target.name) {
        Some(Cost::Known(cost)) => Some(cost.clone()),
        _ => None,
    };
    let good: Vec<(&JudgedRun, PeriodCost)> = comparison
        .formats
        .iter()
        .filter(|row| row.verdict.is_good())
        .filter_map(|row| Some((row, known(row)?)))
        .collect();
    let mut lines = Vec::new();
    if let Some((format, engine)) = comparison.recommended_on.get(&target.name) {
        let best = good.iter().find(|(row, _)| row.format == *format && row.engine == *engine);
        let as_cheap = best.map_or_else(Vec::new, |(best, _)| as_cheap(comparison, best, &target.name));
        let doubt = if as_cheap.is_empty() {
            String::new()
        } else {
            format!(", by typical costs; {} may be as cheap", list(&as_cheap))
        };
        lines.push(format!("Cheapest good format on {}: {format} ({engine}){doubt}", target.name));
    } else {
        lines.push(format!("No format is known to be good and fast enough on {}", target.name));
    }
    lines.extend(may_not_fit(comparison, target, &good));
    // Compares fixed point with float by the cheapest good format of each.
    let cheapest = |fixed: bool| {
        let of_kind = good.iter().filter(|(row, _)| row.format.starts_with('I') == fixed);
        of_kind.min_by(|a, b| time(&a.1).total_cmp(&time(&b.1)))
    };
    if let (Some((fixed, q)), Some((float, f))) = (cheapest(true), cheapest(false)) {
        lines.push(if f.is_longer_than(q) {
            of_other_kind(&fixed.format, &float.format, time(f) / time(q))
        } else if q.is_longer_than(f) {
            of_other_kind(&float.format, &fixed.format, time(q) / time(f))
        } else {
            format!(
                "{} and {}, the best of each kind, may take as long: their ranges overlap",
                fixed.format, float.format
            )
        });
    }
    lines.extend(divisions(comparison, &known));
    lines
}

/// How long the dearest period takes, for a ratio.
fn time(cost: &PeriodCost) -> f64 {
    cost.microseconds_max.unwrap_or(cost.max)
}

fn of_other_kind(cheap: &str, dear: &str, ratio: f64) -> String {
    format!("{cheap} takes {ratio:.1} times less time than {dear}, the best of the other kind")
}

/// The good formats that may cost as little on a target as the one that is first there.
pub(crate) fn as_cheap<'c>(comparison: &'c Comparison, best: &JudgedRun, target: &str) -> Vec<&'c str> {
    let cost = |row: &JudgedRun| match row.cycles.get(target) {
        Some(Cost::Known(cost)) => Some(cost.clone()),
        _ => None,
    };
    let Some(least) = cost(best) else { return Vec::new() };
    let others = comparison.formats.iter().filter(|row| row.verdict.is_good() && row.format != best.format);
    let mut names: Vec<&str> = others
        .filter(|row| cost(row).is_some_and(|other| !other.is_dearer_than(&least)))
        .map(|row| row.format.as_str())
        .collect();
    names.dedup();
    names
}

/// A remark if the recommended format fits the period only with the typical costs of operations, not with the highest.
fn may_not_fit(
    comparison: &Comparison,
    target: &Target,
    good: &[(&JudgedRun, PeriodCost)],
) -> Option<String> {
    let (format, engine) = comparison.recommended_on.get(&target.name)?;
    let (_, cost) = good.iter().find(|(row, _)| row.format == *format && row.engine == *engine)?;
    let most = cost.share_of_period? * cost.microseconds_range?[1] / cost.microseconds_max?;
    (most > 1.0).then(|| {
        format!("{format} fits by what operations typically take; by the most they may take, its worst step has {most:.1} periods")
    })
}

/// How much compiling saves, if both forms were priced, and the share of division and roots in the raw form.
fn divisions(comparison: &Comparison, known: &impl Fn(&JudgedRun) -> Option<PeriodCost>) -> Option<String> {
    let mut by_format: BTreeMap<&str, Vec<(&JudgedRun, PeriodCost)>> = BTreeMap::new();
    for row in &comparison.formats {
        if let Some(cost) = known(row) {
            by_format.entry(&row.format).or_default().push((row, cost));
        }
    }
    let gains = by_format.into_iter().filter_map(|(format, rows)| {
        let [(_, raw), (_, pieces)] = rows.as_slice() else { return None };
        Some((raw.mean / pieces.mean, format, raw.dominating, raw.dominating_share))
    });
    let (gain, format, dominating, share) = gains.max_by(|a, b| a.0.total_cmp(&b.0))?;
    Some(format!(
        "Compiled pieces take up to {gain:.1} times less than the raw path ({format}), {:.0} % of which is {dominating}",
        share * 100.0
    ))
}
