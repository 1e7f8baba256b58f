//! The findings of a log as a table.

use std::fmt::Write;

use setpoint_log::{
    Faults, JudgedLimit, JudgedTolerance, Judgement, LimitVerdict, LogPlace, PartFindings, ToleranceVerdict,
};

use crate::output::counted;
use crate::screen::{self, duration, labelled, short, table};

/// The answer, the limits, the rows, and what was not judged.
pub(crate) fn text(name: &str, found: &Judgement, faults: &[String]) -> String {
    let mut text = answer(name, found, faults) + "\n" + &summary(found);
    if !found.limits.is_empty() {
        text.push('\n');
        text += &limits(found);
        text += &remarks(found);
    }
    for (label, faults) in [
        ("twice       ", &found.doubled),
        ("missing     ", &found.missing),
        ("at rest     ", &found.missing_at_rest),
    ] {
        text += &rows(label, faults);
    }
    if let Some(part) = &found.part {
        text.push('\n');
        text += &of_part(part);
        text += &tolerances(&part.tolerances);
    }
    if !found.not_judged.is_empty() {
        text.push('\n');
    }
    for one in &found.not_judged {
        text += &labelled("not judged  ", one);
    }
    text
}

fn answer(name: &str, found: &Judgement, faults: &[String]) -> String {
    let said = said(&screen::file_name(name), found, faults);
    screen::answer(&said) + &faults.iter().map(|fault| labelled("- ", fault)).collect::<String>()
}

/// The answer in a sentence.
pub(crate) fn said(name: &str, found: &Judgement, faults: &[String]) -> String {
    let count = |verdict| found.limits.iter().filter(|limit| limit.verdict == verdict).count();
    let (hidden, unseen) = (count(LimitVerdict::KeptWithin), count(LimitVerdict::NotJudged));
    let at_corners = count(LimitVerdict::BrokenUnlessCorner);
    match (faults.len(), hidden) {
        (0, 0) if found.limits.is_empty() => format!("{name}: the machine states no limit."),
        (0, _) if at_corners > 0 => {
            let those = if at_corners == 1 { "one is".to_string() } else { format!("{at_corners} are") };
            format!("{name}: no limit is broken for certain; {those}, unless the path has corners there.")
        }
        (0, 0) if unseen > 0 => {
            format!(
                "{name}: no limit is broken; {unseen} are not judged, for the log has no window for them."
            )
        }
        (0, 0) => format!("{name}: every limit is kept."),
        (0, _) => format!("{name}: no limit is broken; {} are kept within what the log resolves.", hidden),
        (1, _) => format!("{name}: one fault."),
        (count, _) => format!("{name}: {count} faults."),
    }
}

fn summary(found: &Judgement) -> String {
    let mut text = String::new();
    let rest = match found.at_rest {
        [true, true] => "from rest to rest",
        [true, false] => "from rest, to its end in motion",
        [false, true] => "from a begin in motion, to rest",
        [false, false] => "in motion at both ends",
    };
    let _ = writeln!(
        text,
        "log         {}, {}, a setpoint every {} ms, {rest}",
        counted(usize::try_from(found.rows).unwrap_or(usize::MAX), "row", "rows"),
        duration(found.time_s),
        short(1e3 * found.period_s)
    );
    let _ = writeln!(
        text,
        "resolution  r = {:.1e} mm: the motion is within r of the positions in each axis",
        found.resolution_mm
    );
    if found.uneven_s > 0.0 {
        let said = format!(
            "uneven: a row is up to {} ms off its period; they are judged as a setpoint each {} ms",
            short(1e3 * found.uneven_s),
            short(1e3 * found.period_s)
        );
        text += &labelled("times       ", &said);
    }
    if found.standstills.count > 0 {
        let at = found.standstills.at.map_or(String::new(), |at| format!(", from {}", place(&at)));
        let count = usize::try_from(found.standstills.count).unwrap_or(usize::MAX);
        let longest = duration(found.standstills.longest_s);
        text += &labelled(
            "stands      ",
            &format!("{} between motions; the longest for {longest}{at}", counted(count, "time", "times")),
        );
    }
    if found.left_out > 0 {
        let _ = writeln!(
            text,
            "left out    the way is not in the log at {} places, as of rapid moves",
            found.left_out
        );
    }
    text
}

fn limits(found: &Judgement) -> String {
    let rows = found.limits.iter().map(|limit| {
        let at = limit.at;
        let line = at.and_then(|at| at.line).map_or(String::new(), |line| line.to_string());
        vec![
            limit.what.to_string(),
            format!("{} {}", short(limit.limit), limit.unit),
            if limit.verdict == LimitVerdict::NotJudged { "-".into() } else { share(limit.raw) },
            match limit.verdict {
                LimitVerdict::Kept | LimitVerdict::NotJudged => String::new(),
                LimitVerdict::KeptWithin | LimitVerdict::Broken | LimitVerdict::BrokenUnlessCorner => {
                    share(limit.taken)
                }
            },
            verdict(limit),
            at.map_or(String::new(), |at| at.row.to_string()),
            line,
        ]
    });
    let header = ["", "limit", "as it is", "at least", "verdict", "row", "line"];
    table(&header, rows.collect())
}

pub(crate) fn verdict(limit: &JudgedLimit) -> String {
    match limit.verdict {
        LimitVerdict::Kept => "kept".into(),
        LimitVerdict::KeptWithin => "kept within r".into(),
        LimitVerdict::Broken => "broken".into(),
        LimitVerdict::BrokenUnlessCorner => "broken?".into(),
        LimitVerdict::NotJudged => "not judged".into(),
    }
}

/// A share of a limit, with digits that tell it from 1.
fn share(share: f64) -> String {
    if share.is_finite() && share < 1e5 { format!("{share:.4}") } else { format!("{share:.2e}") }
}

/// Where limits are broken, and which logs would tell where this one does not.
fn remarks(found: &Judgement) -> String {
    let mut text = String::new();
    for limit in &found.limits {
        match (limit.verdict, limit.at, limit.decided_below_mm) {
            (LimitVerdict::Broken, Some(at), _) => {
                text += &labelled("broken      ", &broken(limit, &at));
            }
            (LimitVerdict::BrokenUnlessCorner, Some(at), _) => {
                let unless = if limit.what.ends_with("along the path") {
                    "unless the path turns to and fro between two setpoints there: --part says how it runs"
                } else {
                    "unless the path has a corner there, which the machine may cut: --part says where corners are"
                };
                text += &labelled("broken?     ", &format!("{}; {unless}", broken(limit, &at)));
            }
            (LimitVerdict::KeptWithin, _, Some(within)) => {
                text += &labelled("would show  ", &would_show(found, limit, within));
            }
            (LimitVerdict::KeptWithin, _, None) if limit.seen_within_mm > Some(found.resolution_mm) => {
                let said = format!(
                    "no finer r alone, of {}: at corners it is kept within {} mm, by which the machine may cut them",
                    limit.what,
                    small(limit.seen_within_mm.unwrap_or(0.0))
                );
                text += &labelled("would show  ", &said);
            }
            (LimitVerdict::KeptWithin, _, None) if limit.what.ends_with("along the path") => {
                let said = format!(
                    "no finer r alone, of {}: its chords hide what they fall short of arcs by",
                    limit.what
                );
                text += &labelled("would show  ", &said);
            }
            (LimitVerdict::NotJudged, ..) => {
                let said = not_judged(found, limit);
                text += &labelled("not judged  ", &said);
            }
            _ => {}
        }
    }
    if text.is_empty() { text } else { format!("\n{text}") }
}

/// Why a limit was not judged.
fn not_judged(found: &Judgement, limit: &JudgedLimit) -> String {
    let rows = limit.rows_of_a_period;
    if found.longest_rows < rows as u64 {
        let longest = found.longest_rows;
        format!(
            "{}: it takes {rows} rows without a gap between them, and the log has {longest} at most",
            limit.what
        )
    } else {
        format!("{}: each window holds a corner, where the velocity may jump", limit.what)
    }
}

/// By how much a limit is broken, and where.
fn broken(limit: &JudgedLimit, at: &LogPlace) -> String {
    let over = match limit.periods {
        1 => "a period".to_string(),
        periods => format!("{periods} periods"),
    };
    format!("{} {} times its limit, over {over}, {}", limit.what, share(limit.taken), place(at))
}

/// What would show that a limit is broken: a finer log; and how long twice the limit has to last so that this one shows it.
fn would_show(found: &Judgement, limit: &JudgedLimit, within_mm: f64) -> String {
    let finer = format!("r below {within_mm:.1e} mm, of {}", limit.what);
    let Some(periods) = limit.twice_shows_over_periods else {
        return format!("{finer}; twice the limit shows over no window that is looked at");
    };
    let rows = (limit.rows_of_a_period - 1) * periods + 1;
    let longest = usize::try_from(found.longest_rows).unwrap_or(usize::MAX);
    let lacks = if rows > longest {
        format!(": {rows} rows without a gap, of which the log has {longest} at most")
    } else {
        String::new()
    };
    format!("{finer}; twice the limit shows over {} or more{lacks}", counted(periods, "period", "periods"))
}

fn place(at: &LogPlace) -> String {
    let [x, y, z] = at.point_mm;
    let line = at.line.map_or(String::new(), |line| format!(", line {line}"));
    format!("at {:.4} s, row {}{line}, X {x:.4} Y {y:.4} Z {z:.4}", at.time_s, at.row)
}

/// How the log follows the part.
fn of_part(part: &PartFindings) -> String {
    const SHOWN: usize = 5;
    let moves = counted(part.moves, "move", "moves");
    let mut text = format!("part        {moves}, {:.3} mm\n", part.length_mm);
    for (label, off) in [("off path    ", &part.nearest), ("in rapids   ", &part.nearest_rapid)] {
        if let Some(at) = off.at {
            let said = format!(
                "{} mm at most, from the nearest place of it: in line {}, {}",
                small(off.mm),
                off.line,
                place(&at)
            );
            text += &labelled(label, &said);
        }
    }
    let said = format!("at most {} mm between log and path, skipped moves and all", small(part.order_mm));
    text += &labelled("in order    ", &said);
    let visits_none = part.never_visited_mm >= part.length_mm;
    let visited = if part.leaves_some() { ", of what it visits" } else { "" };
    let said = format!(
        "{} mm at most of the path of moves at feed from the log{visited}",
        small(part.path_to_log_mm)
    );
    text += &labelled(
        "off log     ",
        if visits_none { "not judged: none of the path was visited" } else { &said },
    );
    if let Some(at) = part.chord_error.at {
        let said = format!(
            "{} mm at most of a curve from the straight line between two places on it, in line {}, {}",
            small(part.chord_error.mm),
            part.chord_error.line,
            place(&at)
        );
        text += &labelled("chord error ", &said);
    }
    if let Some(found) = &part.fluctuation {
        let said = format!(
            "{:.1e} of the feed at most at cruise, of which rounding may make {:.1e}: in line {}, {}",
            found.share,
            found.hidden,
            found.line,
            place(&found.at)
        );
        text += &labelled("fluctuation ", &said);
    }
    if part.leaves_some() {
        let said = format!(
            "{:.3} of {:.3} mm of the path, {:.1} %; the log ends at {:.3} mm, in line {}",
            part.never_visited_mm,
            part.length_mm,
            100.0 * part.never_visited_mm / part.length_mm,
            part.ends_at_mm,
            part.ends_in_line
        );
        text += &labelled("not visited ", &said);
    }
    for one in part.over_feed.iter().take(SHOWN) {
        let said = format!(
            "line {}: {} of {} mm/s, {}",
            one.line,
            short(one.largest_mm_per_s),
            short(one.commanded_mm_per_s),
            place(&one.at)
        );
        text += &labelled("feed        ", &said);
    }
    text
}

/// How the tolerances that the part states are kept.
fn tolerances(judged: &[JudgedTolerance]) -> String {
    if judged.is_empty() {
        return String::new();
    }
    let row = |one: &JudgedTolerance| {
        let at = one.off_path.at.map_or(String::new(), |at| format!("{:.4} s", at.time_s));
        let verdict = match one.verdict {
            ToleranceVerdict::Kept => "kept",
            ToleranceVerdict::KeptIfMerged => "kept within P + Q",
            ToleranceVerdict::Broken => "broken",
        };
        vec![
            format!("P {} Q {}", short(one.rounding_mm), short(one.merging_mm)),
            small(one.off_path.mm),
            one.off_path.line.to_string(),
            at,
            small(one.off_log.mm),
            one.off_log.line.to_string(),
            share(one.share),
            verdict.into(),
        ]
    };
    let header = ["G64, mm", "off path", "line", "at", "off log", "line", "of P", "verdict"];
    "\n".to_string() + &table(&header, judged.iter().map(row).collect())
}

/// A distance in mm, of three digits at least.
pub(crate) fn small(mm: f64) -> String {
    if mm > 0.0 && mm < 1e-3 { format!("{mm:.2e}") } else { format!("{mm:.6}") }
}

/// Rows that are there twice, or missing.
fn rows(label: &str, faults: &Faults) -> String {
    const SHOWN: usize = 5;
    let mut text = String::new();
    for (at, rows) in faults.first.iter().take(SHOWN) {
        let count = match rows {
            0 => "some rows".to_string(),
            rows => counted(usize::try_from(*rows).unwrap_or(usize::MAX), "row", "rows"),
        };
        let count = if label.starts_with("at rest") { format!("{count} missing") } else { count };
        text += &labelled(label, &format!("{count} before {}", place(at).trim_start_matches("at ")));
    }
    let more = faults.places.saturating_sub(SHOWN as u64);
    if more > 0 {
        let _ = writeln!(text, "{label}and at {more} more places");
    }
    text
}
