//! The first screen of `compare`: how many bits are enough, and the formats in 80 columns.

use std::fmt::Write;

use anstyle::{AnsiColor, Style};
use format_compare::{Comparison, Cost, Engine, FewestBits, Requirement, Row, Verdict};

/// Columns of the first screen.
const COLUMNS: usize = 80;

const STRONG: Style = Style::new().bold();
const GOOD: Style = AnsiColor::Green.on_default();
const BAD: Style = AnsiColor::Red.on_default();

/// The answer, and a line for each format whose path is one of `engines`. Its styles are for a terminal.
pub(crate) fn screen(comparison: &Comparison, engines: &[Engine]) -> String {
    let mut text = String::new();
    for line in folded(&about(comparison)) {
        text += &(line + "\n");
    }
    for (index, line) in folded(&answer(comparison)).into_iter().enumerate() {
        if index == 0 {
            // Writing to a String does not fail.
            let _ = writeln!(text, "{STRONG}{line}{STRONG:#}");
        } else {
            text += &(line + "\n");
        }
    }
    let rows: Vec<_> = comparison.formats.iter().filter(|row| engines.contains(&row.engine)).collect();
    let names_path = engines.len() > 1;
    let path = if names_path { "  path  " } else { "" };
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

/// What was run.
fn about(comparison: &Comparison) -> String {
    let (part, machine) = (&comparison.part, &comparison.machine);
    let name = std::path::Path::new(&part.name).file_name();
    let name = name.map_or_else(|| part.name.clone(), |name| name.to_string_lossy().into_owned());
    let from =
        part.lowest_feedrate_mm_per_s.map_or_else(String::new, |lowest| format!("{} to ", short(lowest)));
    let time = part.planned_time_s.map_or_else(String::new, |time| format!(" in {}", duration(time)));
    format!(
        "{name}: {} mm at {from}{} mm/s{time}, a setpoint every {} ms, chord error {} mm, fluctuation {:.0e}",
        short(part.length_mm),
        short(machine.feedrate_mm_per_s),
        short(machine.interpolation_period_ms),
        short(machine.chord_error_mm),
        machine.fluctuation_limit,
    )
}

/// How many bits are enough, and which of the formats compared is recommended, by what, and how sure that is.
fn answer(comparison: &Comparison) -> String {
    let mut text = match &comparison.fewest_bits {
        Some(FewestBits::Found { format, bits, margin, .. }) => {
            format!("{bits} bits are enough: {format}, {} better than asked.\n", times(*margin))
        }
        Some(FewestBits::None { up_to_bits }) => {
            format!("Not even {up_to_bits} bits are enough in one fixed-point format.\n")
        }
        Some(FewestBits::LeftOut { periods }) => {
            format!(
                "The search for the fewest bits is left out: {periods} periods without a rest would be run many times. `feedbits size` makes it.\n"
            )
        }
        None => String::new(),
    };
    let good: Vec<_> = comparison.formats.iter().filter(|row| row.verdict.is_good()).collect();
    let first = comparison.recommended.as_ref().zip(comparison.recommended_engine);
    let Some(best) =
        first.and_then(|(name, engine)| good.iter().find(|row| row.format == *name && row.engine == engine))
    else {
        text += "None of the formats compared is good enough.";
        if let Some(why) = &comparison.not_a_question_of_format {
            let _ = write!(text, "\n{why}");
        }
        return text;
    };
    let is_priced = comparison.formats.iter().any(|row| !row.cycles.is_empty());
    if !is_priced {
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
        if is_priced { by_cost(best, &good) } else { by_bits(best, &good) }
    );
    if let Some(second) = good.iter().find(|row| row.format != best.format) {
        let _ = write!(text, " Second best: {}.", named(second));
    }
    text
}

fn named(row: &Row) -> String {
    if row.engine == Engine::Pieces { row.format.clone() } else { format!("{} ({})", row.format, row.engine) }
}

/// Why the cheapest by its bits is first: among as many bits, fixed point before float, and the widest range.
fn by_bits(best: &Row, good: &[&Row]) -> String {
    let is_alone = good.iter().all(|row| row.bits != best.bits || row.format == best.format);
    let why = if is_alone { "for its bits" } else { "for its range among those" };
    format!("{why}; --targets goes by what a period costs.")
}

/// Why the cheapest by its cost on the first target is first, and whether others may be as cheap: the ranges of their costs overlap.
fn by_cost(best: &Row, good: &[&Row]) -> String {
    let known = best.cycles.iter().find_map(|(target, cost)| match cost {
        Cost::Known(cost) => Some((target, cost)),
        Cost::Unknown { .. } => None,
    });
    let Some((target, cost)) = known else {
        return "though its cost on the targets is not known.".to_string();
    };
    let may_be_as_cheap = |row: &Row| match row.cycles.get(target) {
        Some(Cost::Known(other)) => {
            other.dsp_blocks == cost.dsp_blocks && other.max_range[0] <= cost.max_range[1]
        }
        _ => false,
    };
    let as_cheap = good.iter().filter(|row| row.format != best.format && may_be_as_cheap(row));
    let as_cheap: Vec<_> = as_cheap.map(|row| row.format.as_str()).collect();
    let what = match cost.dsp_blocks {
        Some(blocks) => format!("with {blocks} DSP blocks the smallest on {target}"),
        None => format!("whose longest period is the shortest on {target}"),
    };
    if as_cheap.is_empty() {
        return format!("{what}.");
    }
    format!("{what}, if not by much: the range of its cost overlaps that of {}.", list(&as_cheap))
}

fn list(names: &[&str]) -> String {
    match names {
        [] => String::new(),
        [one] => (*one).to_string(),
        [most @ .., last] => format!("{} and {last}", most.join(", ")),
    }
}

fn name_width(rows: &[&Row]) -> usize {
    rows.iter().map(|row| row.format.len()).max().unwrap_or(0).max(6)
}

/// A format's line: its first failing requirement, and how many more there are.
fn line(text: &mut String, row: &Row, width: usize, names_path: bool) {
    let fluctuation =
        row.fluctuation.map_or_else(String::new, |found| format!("{:.1e}", found.cruise_max_abs));
    let path = if names_path { format!("  {:6}", row.engine.to_string()) } else { String::new() };
    let (style, margin, verdict) = match &row.verdict {
        Verdict::Good => (GOOD, margin(row).map_or_else(String::new, times_short), "good".to_string()),
        Verdict::Bad(reasons) => (BAD, String::new(), first_broken(reasons)),
        Verdict::Refused(why) => (BAD, String::new(), format!("cannot run it: {why}")),
    };
    let start = format!("{:width$} {:>4}{path}  {fluctuation:>11}  {margin:>8}  ", row.format, row.bits);
    let mut lines =
        textwrap::wrap(&verdict, COLUMNS.saturating_sub(start.chars().count()).max(20)).into_iter();
    let first = lines.next().unwrap_or_default();
    let _ = writeln!(text, "{start}{style}{first}{style:#}");
    for more in lines {
        let _ = writeln!(text, "{:indent$}{style}{more}{style:#}", "", indent = start.chars().count());
    }
}

/// How many times the fluctuation might be what it is.
fn margin(row: &Row) -> Option<f64> {
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

/// So many times, in words: two digits, and beyond a million only that.
fn times(margin: f64) -> String {
    if margin > MANY {
        "more than a million times".to_string()
    } else {
        format!("{} times", two_digits(margin))
    }
}

fn times_short(margin: f64) -> String {
    if margin > MANY { "> 1e6".to_string() } else { format!("{}×", two_digits(margin)) }
}

/// A margin beyond which its figure says nothing.
const MANY: f64 = 1e6;

fn two_digits(x: f64) -> String {
    if x < 10.0 { format!("{x:.1}") } else { format!("{x:.0}") }
}

/// A figure of at most six digits.
fn short(x: f64) -> String {
    let digits = 5 - x.abs().max(1e-3).log10().floor().clamp(-3.0, 5.0) as i32;
    let text = format!("{x:.*}", usize::try_from(digits).unwrap_or(0).min(6));
    if text.contains('.') { text.trim_end_matches('0').trim_end_matches('.').to_string() } else { text }
}

/// A time as people say it.
pub(crate) fn duration(seconds: f64) -> String {
    let whole = seconds.round();
    if seconds < 100.0 {
        format!("{seconds:.2} s")
    } else if whole < 3600.0 {
        format!("{:.0} min {:02.0} s", (whole / 60.0).floor(), whole % 60.0)
    } else {
        format!("{:.0} h {:02.0} min", (whole / 3600.0).floor(), (whole % 3600.0 / 60.0).floor())
    }
}

/// The lines of a text, none longer than the screen.
fn folded(text: &str) -> Vec<String> {
    textwrap::wrap(text, COLUMNS).into_iter().map(Into::into).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn figures_are_short() {
        assert_eq!(
            [834.706_9, 200.0, 0.0005, 1e-3, 16_000.0, 22_368.358].map(short),
            ["834.707", "200", "0.0005", "0.001", "16000", "22368.4"]
        );
        assert_eq!([4.887, 487.231, 16_742.0].map(duration), ["4.89 s", "8 min 07 s", "4 h 39 min"]);
        assert_eq!([3.02, 41.0, 9e8].map(times), ["3.0 times", "41 times", "more than a million times"]);
    }

    #[test]
    fn no_line_is_longer_than_the_screen() {
        let text = "It is not a question of the format: f64 pieces fails too, with a chord error of 2.5 µm in line 17.";
        assert!(folded(text).iter().all(|line| line.chars().count() <= COLUMNS));
        assert_eq!(folded(text).join(" "), text);
    }
}
