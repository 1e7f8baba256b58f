//! The first screen of a set: the answer, and a line a part, the worst first.

use std::cmp::Ordering;
use std::fmt::Write;

use foreign_text::in_a_line;
use format_report::{PartOfSet, SetPage};

use crate::output::counted;
use crate::screen::{self, duration, file_name, list, times, times_short};
use crate::set::answer::{Answer, FewestOfSet, PartLine, PartStatus};
use crate::set::formats::FormatOfSet;
use crate::set::known::Limiting;
use crate::set::registers::RegistersOfSet;

/// Parts on the screen; a file has them all.
const ON_THE_SCREEN: usize = 20;

/// The answer, and its parts; at most twenty of them on the screen. `first_target` is the first of the targets on which a period is priced.
pub(crate) fn screen(
    answer: &Answer,
    lines: &[PartLine],
    is_whole: bool,
    first_target: Option<&str>,
) -> String {
    let mut text = screen::paragraph(&about(answer)) + &screen::answer(&said(answer, first_target));
    text += &not_run(lines);
    let ran: Vec<&PartLine> = worst_first(lines).into_iter().filter(|line| is_run(line)).collect();
    let shown = if is_whole { ran.len() } else { ran.len().min(ON_THE_SCREEN) };
    if !ran.is_empty() {
        text += "\n";
    }
    text += &table(&ran[..shown], &column(answer));
    if shown < ran.len() {
        let _ = writeln!(
            text,
            "… and {}; --json and --out have them all.",
            counted(ran.len() - shown, "part", "parts")
        );
    }
    text += &costs(answer);
    answer.registers.iter().for_each(|registers| text += &of_registers(registers));
    text
}

/// The page of a set.
pub(crate) fn page(answer: &Answer, lines: &[PartLine], first_target: Option<&str>) -> SetPage {
    let part = |line: &PartLine| PartOfSet {
        name: in_a_line(&line.name),
        status: line.status.word().to_string(),
        planned_time_s: line.planned_time_s,
        bits: line.bits,
        format: line.format.clone(),
        margin: line.margin,
        remark: in_a_line(&remark(line)),
    };
    SetPage {
        about: about(answer),
        answer: said(answer, first_target).lines().map(in_a_line).collect(),
        bits: answer.fewest_bits.as_ref().and_then(|fewest| fewest.bits),
        parts: worst_first(lines).into_iter().map(part).collect(),
    }
}

fn worst_first(lines: &[PartLine]) -> Vec<&PartLine> {
    let mut sorted: Vec<&PartLine> = lines.iter().collect();
    sorted.sort_by(|one, other| badness(one).partial_cmp(&badness(other)).unwrap_or(Ordering::Equal));
    sorted
}

fn is_run(line: &PartLine) -> bool {
    matches!(line.status, PartStatus::Good | PartStatus::Bad)
}

/// The parts in order: those that no format is good for, then by falling bits, and by rising margin.
fn badness(line: &PartLine) -> (PartStatus, i64, f64) {
    (line.status, -line.bits.map_or(i64::MAX, i64::from), line.margin.unwrap_or(f64::MAX))
}

/// The parts, and how they ended.
fn about(answer: &Answer) -> String {
    let time =
        answer.planned_time_s.map_or_else(String::new, |time| format!(", {} of motion", duration(time)));
    let mut left_out = Vec::new();
    for (count, what) in [
        (answer.parts_unread, "cannot be read"),
        (answer.parts_refused, "cannot be run"),
        (answer.parts_unfinished, "not run yet"),
    ] {
        if count > 0 {
            left_out.push(format!("{count} {what}"));
        }
    }
    let left_out = if left_out.is_empty() { String::new() } else { format!("; {}", left_out.join(", ")) };
    format!("{}{time}{left_out}", counted(answer.parts_run, "part", "parts"))
}

/// The answer in words.
fn said(answer: &Answer, first_target: Option<&str>) -> String {
    let mut text = answer.fewest_bits.as_ref().map_or_else(String::new, fewest);
    if !answer.formats.is_empty() {
        text += &of_formats(answer, first_target);
    }
    text.trim_end().to_string()
}

/// "for all 68 parts", or for how many of them.
fn for_which(fewest: &FewestOfSet) -> String {
    match (fewest.parts, fewest.none_for.len()) {
        (1, 0) => "the only part".to_string(),
        (parts, 0) => format!("all {parts} parts"),
        (parts, others) => format!("{parts} of {} parts", parts + others),
    }
}

fn fewest(fewest: &FewestOfSet) -> String {
    let mut text = match (&fewest.format, fewest.bits) {
        (Some(format), Some(bits)) => {
            let margin = fewest
                .margin
                .map_or_else(String::new, |margin| format!(", {} better than asked", times(margin)));
            format!("{bits} bits are enough for {}: {format}{margin}.", for_which(fewest))
        }
        _ if fewest.parts == 0 => "No format of up to 48 bits is enough for any part.".to_string(),
        _ => format!("No format of up to 48 bits is enough for {} together.", for_which(fewest)),
    };
    text += &who_decides(fewest);
    let of_none = |(count, first): (usize, &crate::set::answer::NoneFor)| {
        let others = if count > 1 { format!(", and {} more", count - 1) } else { String::new() };
        format!(
            "\nNo format is enough for {}: {}{others}.",
            file_name(&first.part),
            first.why.trim_end_matches('.')
        )
    };
    text +=
        &fewest.none_for.first().map_or_else(String::new, |first| of_none((fewest.none_for.len(), first)));
    text + "\n"
}

/// Which part decides, or which parts.
fn who_decides(fewest: &FewestOfSet) -> String {
    if let Some(deciding) = &fewest.decides {
        let place = deciding.breaks.as_ref().and_then(|by| by.line);
        let place = place.map_or_else(String::new, |line| format!(", line {line},"));
        let without = deciding.bits_without.map_or_else(String::new, |bits| format!("; without it {bits}"));
        return format!(" {}{place} decides{without}.", file_name(&deciding.part));
    }
    let needing = &fewest.needed_by;
    match (needing.first(), fewest.bits) {
        (Some(first), Some(bits)) if first.bits < bits => {
            let names: Vec<String> = needing
                .iter()
                .take(3)
                .map(|one| format!("{} {}", file_name(&one.part), one.format))
                .collect();
            format!(" No part alone needs so many: {}.", names.join(", "))
        }
        (Some(first), Some(_)) if needing.len() == 1 && fewest.parts > 1 => {
            format!(" {} needs as many alone, and so do the others together.", file_name(&first.part))
        }
        (Some(_), Some(_)) if needing.len() > 1 => {
            let names: Vec<String> = needing.iter().take(3).map(|one| file_name(&one.part)).collect();
            let more = if needing.len() > names.len() { " and others" } else { "" };
            let names: Vec<&str> = names.iter().map(String::as_str).collect();
            let names = if more.is_empty() { list(&names) } else { names.join(", ") };
            format!(" {names}{more} need as many each.")
        }
        _ => String::new(),
    }
}

/// Which of the formats compared are good for all parts, and which is recommended.
fn of_formats(answer: &Answer, first_target: Option<&str>) -> String {
    let best = answer.recommended.as_deref().zip(answer.recommended_engine.as_deref());
    let best = best.and_then(|(format, engine)| {
        answer.formats.iter().find(|one| one.format == format && one.engine == engine)
    });
    let Some(best) = best else {
        let nearest = answer.formats.iter().max_by_key(|format| format.good);
        let nearest = nearest.map_or_else(String::new, |one| {
            let part = one.bad_part.as_deref().map(file_name).unwrap_or_default();
            let why = one.bad_why.as_deref().unwrap_or_default();
            format!(" {} is for {} of {}; not for {part}: {why}.", named(one), one.good, one.of)
        });
        return format!("None of the formats compared is good enough for all parts.{nearest}");
    };
    let why = match first_target {
        Some(target) => format!(", whose dearest period of all parts costs least on {target}"),
        None => format!(", of {} bits", best.bits),
    };
    let margin = match (best.margin, &best.margin_part) {
        (Some(margin), Some(part)) => {
            format!(" Its least margin is {}, in {}.", times(margin), file_name(part))
        }
        _ => String::new(),
    };
    format!("Of the formats compared {} is good for all{why}.{margin}", named(best))
}

fn named(format: &FormatOfSet) -> String {
    if format.engine == "pieces" {
        format.format.clone()
    } else {
        format!("{} ({})", format.format, format.engine)
    }
}

/// The parts that cannot be read or run, each with the first words of why.
fn not_run(lines: &[PartLine]) -> String {
    const MOST: usize = 10;
    let refused: Vec<_> =
        lines.iter().filter(|line| matches!(line.status, PartStatus::Unread | PartStatus::Refused)).collect();
    if refused.is_empty() {
        return String::new();
    }
    let mut text = format!("\n{}:\n", counted(refused.len(), "part is not run", "parts are not run"));
    for line in refused.iter().take(MOST) {
        let why = line.why.as_deref().map(first_words).unwrap_or_default();
        text += &screen::labelled(&format!("- {}: ", file_name(&line.name)), &why);
    }
    if refused.len() > MOST {
        let _ = writeln!(text, "- and {} more; --json has them all", refused.len() - MOST);
    }
    text
}

/// The first sentence of a refusal, with its place: the lines that show the file are left out.
fn first_words(why: &str) -> String {
    const MOST: usize = 160;
    let lines = why.lines().take_while(|line| !line.trim().is_empty());
    let lines = lines
        .filter(|line| !line.trim_start_matches(|c: char| c.is_ascii_digit() || c == ' ').starts_with('|'));
    let text = lines.map(str::trim).collect::<Vec<_>>().join(" ");
    let text = text.trim_start_matches("error: ");
    match text.char_indices().nth(MOST) {
        Some((end, _)) => format!("{}…", &text[..end]),
        None => text.to_string(),
    }
}

/// What the column of margins is of.
fn column(answer: &Answer) -> String {
    let fewest = answer.fewest_bits.as_ref().and_then(|fewest| fewest.format.as_ref());
    let format = answer.recommended.as_ref().or(fewest);
    format.map_or_else(|| "margin".to_string(), |format| format!("in {format}"))
}

fn table(lines: &[&PartLine], margin: &str) -> String {
    let row = |line: &&PartLine| {
        vec![
            file_name(&line.name),
            line.planned_time_s.map_or_else(String::new, duration),
            line.bits.map_or_else(|| "none".to_string(), |bits| bits.to_string()),
            line.margin.map_or_else(String::new, times_short),
            remark(line),
        ]
    };
    screen::table(&["part", "time", "bits", margin, "limited by"], lines.iter().map(row).collect())
}

/// What limits a part and where, or why it is not good or not run.
fn remark(line: &PartLine) -> String {
    match (&line.limited_by, &line.why) {
        (Some(by), _) => limiting(by),
        (None, Some(why)) => first_words(why),
        (None, None) => String::new(),
    }
}

/// What limits a run, and where.
fn limiting(by: &Limiting) -> String {
    let place = by.line.map_or_else(String::new, |line| format!(", line {line}"));
    format!("{}{place}", by.what)
}

/// The worst cost of each format on each target.
fn costs(answer: &Answer) -> String {
    let targets: Vec<&String> =
        answer.formats.first().map(|format| format.cycles.keys().collect()).unwrap_or_default();
    let mut text = String::new();
    for target in targets {
        let row = |format: &FormatOfSet| match format.cycles.get(target)? {
            Some(cost) => Some(vec![
                named(format),
                format!("{:.0}", cost.max),
                cost.microseconds_max.map_or_else(|| "unknown".to_string(), |us| format!("{us:.1}")),
                cost.share_of_period.map_or_else(String::new, |share| format!("{:.2} %", share * 100.0)),
                file_name(&cost.part),
            ]),
            None => {
                Some(vec![named(format), "unknown".to_string(), String::new(), String::new(), String::new()])
            }
        };
        let rows = answer.formats.iter().filter(|format| format.is_good_for_all()).filter_map(row).collect();
        let header = ["format", "dearest\nperiod", "µs", "of the\nperiod", "in"];
        let table = screen::table(&header, rows);
        if !table.is_empty() {
            let _ = write!(text, "\n{target}, the dearest period of all parts:\n{table}");
        }
    }
    text
}

/// The registers, each with the parts that need it.
fn of_registers(registers: &RegistersOfSet) -> String {
    let row = |one: &crate::set::registers::RegisterOfSet| {
        vec![
            one.signal.clone(),
            one.format.clone(),
            one.bits.to_string(),
            file_name(&one.integer_bits_for),
            file_name(&one.fraction_bits_for),
        ]
    };
    let header = ["signal", "format", "bits", "integer bits for", "fraction bits for"];
    let table = screen::table(&header, registers.signals.iter().map(row).collect());
    let without = match &registers.without[..] {
        [] => String::new(),
        [first, others @ ..] => {
            let more = if others.is_empty() { String::new() } else { format!(" and {} more", others.len()) };
            format!(" {}{more} has none.", file_name(first))
        }
    };
    let added = match registers.added_bits {
        0 => String::new(),
        bits => format!(
            ", and {} wider, since together they are not enough else",
            counted(usize::try_from(bits).unwrap_or_default(), "bit", "bits")
        ),
    };
    let confirmed = if registers.is_confirmed { "" } else { " No run of all parts with them is good." };
    let said = format!(
        "With a register for each signal {} bits in all: each is as wide as the part needs that needs most{added}.{confirmed}{without}",
        registers.bits
    );
    format!("\n{}{table}", screen::paragraph(&said))
}
