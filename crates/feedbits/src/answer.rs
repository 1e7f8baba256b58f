//! The first screen of `compare`: how many bits are enough, and the formats in 80 columns.

use std::fmt::Write;

use foreign_text::in_a_line;
use format_compare::{Comparison, Cost, Engine, FewestBits, JudgedRun, Requirement, Verdict};

use crate::period_costs::as_cheap;
use crate::screen::{self, BAD, COLUMNS, GOOD, duration, list, short, times, times_short};

/// The answer, and a line for each format that ran by one of `engines`. If there is a `target`, the recommended format
/// is the cheapest on it. The text has styles for a terminal.
pub(crate) fn screen(comparison: &Comparison, engines: &[Engine], target: Option<&str>) -> String {
    let mut text = screen::paragraph(&about(comparison)) + &screen::answer(&answer(comparison, target));
    let rows: Vec<_> = comparison.formats.iter().filter(|row| engines.contains(&row.engine)).collect();
    let names_path = engines.len() > 1;
    let path = if names_path { "  path  " } else { "" };
    // Writing to a String cannot fail.
    let _ = writeln!(
        text,
        "\nformat{:width$} bits{path}  fluctuation    margin  verdict",
        "",
        width = name_width(&rows) - 6
    );
    for row in &rows {
        line(&mut text, row, name_width(&rows), names_path);
    }
    text
}

/// The part, the machine and the requirements, in a sentence.
fn about(comparison: &Comparison) -> String {
    let (part, machine) = (&comparison.part, &comparison.machine);
    let name = screen::file_name(&part.name);
    let from =
        part.lowest_feedrate_mm_per_s.map_or_else(String::new, |lowest| format!("{} to ", short(lowest)));
    let time = part.planned_time_s.map_or_else(String::new, |time| format!(" in {}", duration(time)));
    let view = part.window_mm.map_or_else(String::new, |view| format!(" with {} mm in view", short(view)));
    let over = part.without_look_ahead.map_or_else(String::new, |over| {
        format!(
            ". Without look-ahead the path takes {:.1} times the acceleration and {:.1} times the jerk that the machine has",
            over.acceleration, over.jerk
        )
    });
    format!(
        "{name}: {} mm at {from}{} mm/s{time}{view}, a setpoint every {} ms, chord error {} mm, fluctuation {:.0e}{over}",
        short(part.length_mm),
        short(machine.feedrate_mm_per_s),
        short(machine.interpolation_period_ms),
        short(machine.chord_error_mm),
        machine.fluctuation_limit,
    )
}

/// How many bits are enough; and which of the compared formats is recommended, by which measure, and how sure that is.
fn answer(comparison: &Comparison, target: Option<&str>) -> String {
    let good: Vec<_> = comparison.formats.iter().filter(|row| row.verdict.is_good()).collect();
    let fastest_of_slow = fastest_of_slow(comparison).filter(|_| good.is_empty());
    let mut text = match &comparison.fewest_bits {
        Some(FewestBits::Found { format, bits, margin, .. }) => {
            let enough = if fastest_of_slow.is_some() { "precise enough" } else { "enough" };
            format!("{bits} bits are {enough}: {format}, {} better than asked.\n", times(*margin))
        }
        Some(FewestBits::None { up_to_bits }) => {
            format!("Not even {up_to_bits} bits are enough in one fixed-point format.\n")
        }
        Some(FewestBits::BrokenByPlan { broken, .. }) if comparison.not_a_question_of_format.is_none() => {
            format!("More bits would not help: f64 has {}, too.\n", broken.join("; "))
        }
        // Said below.
        Some(FewestBits::BrokenByPlan { .. }) | None => String::new(),
    };
    let first = comparison.recommended.as_ref().zip(comparison.recommended_engine);
    let Some(best) =
        first.and_then(|(name, engine)| good.iter().find(|row| row.format == *name && row.engine == engine))
    else {
        text += &fastest_of_slow.map_or_else(
            || "None of the formats compared is good enough.".to_string(),
            |(row, share)| {
                format!(
                    "None of the formats compared is fast enough: of those that are precise enough {} is the fastest, and takes {share:.1} \
                     times the interpolation period.",
                    named(row)
                )
            },
        );
        if let Some(why) = &comparison.not_a_question_of_format {
            let _ = write!(text, "\n{why}");
        }
        return text;
    };
    if target.is_none() {
        let narrowest: Vec<_> =
            good.iter().filter(|row| row.bits == best.bits).map(|row| row.format.as_str()).collect();
        let _ = writeln!(
            text,
            "Of the formats compared {}, of {} bits, {} enough.",
            list(&narrowest),
            best.bits,
            if narrowest.len() == 1 { "is" } else { "are" }
        );
    }
    let _ = write!(
        text,
        "Recommended: {}, {}",
        named(best),
        target.map_or_else(|| by_bits(best, &good), |target| by_cost(comparison, best, target))
    );
    if let Some(second) = good.iter().find(|row| row.format != best.format) {
        let _ = write!(text, " Second best: {}.", named(second));
    }
    text
}

/// The format that takes the least time of those that are good but for their time, and its dearest period as a share of the interpolation
/// period.
fn fastest_of_slow(comparison: &Comparison) -> Option<(&JudgedRun, f64)> {
    let slow = comparison.formats.iter().filter_map(|row| Some((row, row.is_only_too_slow()?)));
    slow.min_by(|a, b| a.1.total_cmp(&b.1))
}

fn named(row: &JudgedRun) -> String {
    if row.engine == Engine::Pieces { row.format.clone() } else { format!("{} ({})", row.format, row.engine) }
}

/// Why the format that is cheapest by its bits is first. Among formats of as many bits, fixed point comes before float,
/// and then the widest range.
fn by_bits(best: &JudgedRun, good: &[&JudgedRun]) -> String {
    let is_alone = good.iter().all(|row| row.bits != best.bits || row.format == best.format);
    let why = if is_alone { "for its bits" } else { "for its range among those" };
    format!("{why}; --targets goes by what a period costs.")
}

/// Why the format that is cheapest on a target is first, and which others may be as cheap, since nothing says that they are dearer.
fn by_cost(comparison: &Comparison, best: &JudgedRun, target: &str) -> String {
    let Some(Cost::Known(cost)) = best.cycles.get(target) else {
        return "though its cost on the target is not known.".to_string();
    };
    let as_cheap = as_cheap(comparison, best, target);
    let is_alone = as_cheap.is_empty();
    let what = match (cost.dsp_blocks, cost.luts) {
        (Some(blocks), Some(luts)) => {
            let size = format!("with {blocks} DSP blocks and {luts} LUTs");
            if is_alone { format!("{size} the smallest on {target}") } else { format!("{size} on {target}") }
        }
        _ if is_alone => format!("whose longest period is the shortest on {target}"),
        _ => format!("whose longest period is typically the shortest on {target}"),
    };
    if is_alone {
        return format!("{what}.");
    }
    format!("{what}; {} may cost as little there.", list(&as_cheap))
}

fn name_width(rows: &[&JudgedRun]) -> usize {
    rows.iter().map(|row| row.format.len()).max().unwrap_or(0).max(6)
}

/// A format's line, with its first broken requirement and the number of further ones.
fn line(text: &mut String, row: &JudgedRun, width: usize, names_path: bool) {
    let fluctuation =
        row.fluctuation.map_or_else(String::new, |found| format!("{:.1e}", found.cruise_max_abs));
    let path = if names_path { format!("  {:6}", row.engine.to_string()) } else { String::new() };
    let (style, margin, verdict) = match &row.verdict {
        Verdict::Good => (GOOD, margin(row).map_or_else(String::new, times_short), "good".to_string()),
        Verdict::Bad(reasons) => (BAD, String::new(), first_broken(reasons)),
        Verdict::Refused(why) => (BAD, String::new(), format!("cannot run it: {why}")),
    };
    let start = format!("{:width$} {:>4}{path}  {fluctuation:>11}  {margin:>8}  ", row.format, row.bits);
    // A refusal names the part.
    let verdict = in_a_line(&verdict);
    let mut lines =
        textwrap::wrap(&verdict, COLUMNS.saturating_sub(start.chars().count()).max(20)).into_iter();
    let first = lines.next().unwrap_or_default();
    let _ = writeln!(text, "{start}{style}{first}{style:#}");
    for more in lines {
        let _ = writeln!(text, "{:indent$}{style}{more}{style:#}", "", indent = start.chars().count());
    }
}

/// The largest fluctuation allowed over the one found.
fn margin(row: &JudgedRun) -> Option<f64> {
    let fluctuation: &Requirement =
        row.requirements.iter().find(|one| one.what == "feedrate fluctuation at cruise")?;
    Some(fluctuation.limit / fluctuation.found)
}

fn first_broken(reasons: &[String]) -> String {
    match reasons {
        [] => String::new(),
        [one] => one.clone(),
        [first, others @ ..] => format!("{first}, and {} more", others.len()),
    }
}
