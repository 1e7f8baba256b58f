//! `feedbits check`: the contents of a file, and anything suspicious in it.
//!
//! *Suspicious* is what a programmer rarely intends: a gap; a spline with a corner or a cusp inside; weights or knots over
//! many decades; a missing feedrate; a bend that takes nine tenths of the feed; words that are skipped; arcs bent to fit;
//! rapid moves alone. *Noted* is what changes nothing of the path, and is suspicious with `--strict` alone: words beside the path,
//! such as a dwell's time; moves without length or shorter than the axes resolve; an approach from an unknown place. Corners
//! between moves, moves shorter than a period's travel and bends that slow the machine down occur in most programs: they are
//! counted, not judged.

use std::collections::BTreeMap;
use std::fmt::Write;

use anyhow::Result;
use clap::Args;
use feed_plan::chord_feedrate;
use part_program::{
    Bend, Diagnostic, Diagnostics, GAP_MM, Inspection, Joint, Machine, MoveKind, Oddity, Part, Remark,
    Severity, inspect,
};
use serde::Serialize;

use crate::ending::Ending;
use crate::input::{self, Input};
use crate::output;
use crate::progress::Progress;
use crate::screen::{self, labelled, short};

/// Options of `check`.
#[derive(Args)]
pub(crate) struct Arguments {
    #[command(flatten)]
    input: Input,
    /// Take as suspicious what is only noted too: a dwell's time, a tolerance of G64, an optional block, a setting of the control, an
    /// approach from an unknown place, moves of no length or next to none.
    #[arg(long)]
    strict: bool,
    #[command(flatten)]
    output: output::Output,
}

/// Rows in a table of the worst places.
const WORST: usize = 5;
/// A bend that leaves less than this share of the feed is suspicious.
const LEAST_SHARE_OF_FEED: f64 = 0.1;

/// Reads the part, inspects it and prints the result.
pub(crate) fn run(arguments: &Arguments) -> Result<Ending> {
    let (output, place) = (&arguments.output, arguments.output.place()?);
    let progress = Progress::spinning("reading and measuring");
    let part = match arguments.input.text()?.parsed() {
        Ok(part) => part,
        Err(errors) => {
            progress.finish();
            if output.json {
                let bad = BadInput { errors: errors.iter().collect(), count: errors.count() };
                output::write(&place, &(serde_json::to_string_pretty(&bad)? + "\n"))?;
            }
            say_all(&errors);
            return Ok(Ending::Refused);
        }
    };
    let machine = arguments.input.machine_of(&part)?;
    let report = Report::new(&part, machine.as_ref(), arguments.strict);
    progress.finish();
    if output.json {
        // Item by item: a joint of a program of ten bytes a move takes three hundred.
        output::write_by(&place, |to| {
            serde_json::to_writer_pretty(&mut *to, &report)?;
            Ok(to.write_all(b"\n")?)
        })?;
    } else {
        let text = report.text()?;
        input::say_warnings(&part);
        output::write(&place, &text)?;
    }
    Ok(if report.suspicious.is_empty() { Ending::Good } else { Ending::RequirementNotMet })
}

/// Prints the errors of a text, each in a message of its own.
fn say_all(errors: &Diagnostics) {
    for (index, error) in errors.iter().enumerate() {
        output::say(&if index == 0 { format!("feedbits: {error}") } else { format!("\n{error}") });
    }
    let more = errors.count() - errors.iter().len();
    if more > 0 {
        output::say(&format!("\nand {more} more"));
    }
}

/// The JSON for a text that cannot be read.
#[derive(Serialize)]
struct BadInput<'d> {
    errors: Vec<&'d Diagnostic>,
    /// The number of errors, including those beyond the first thousand, which are not kept.
    count: usize,
}

/// The JSON for a part.
#[derive(Serialize)]
struct Report<'p> {
    part: &'p str,
    machine: Option<&'p Machine>,
    #[serde(flatten)]
    seen: Inspection<'p>,
    /// Bends that the machine must pass more slowly than commanded, the slowest first.
    slow_bends: Vec<SlowBend>,
    /// Moves at feed that are shorter than the travel of one period.
    shorter_than_a_period: Option<usize>,
    /// The size of the part in the unit that was assumed, and in the other unit.
    #[serde(skip_serializing_if = "Option::is_none")]
    assumed_unit: Option<String>,
    warnings: &'p [Diagnostic],
    /// The suspicious things, a sentence for each. They decide the exit status.
    suspicious: Vec<String>,
    /// What changes nothing of the path, a sentence for each. With `--strict` it is suspicious.
    noted: Vec<String>,
}

/// A bend that does not allow the commanded feed.
#[derive(Clone, Copy, Serialize)]
struct SlowBend {
    #[serde(flatten)]
    bend: Bend,
    commanded_mm_per_s: f64,
    allowed_mm_per_s: f64,
}

impl<'p> Report<'p> {
    fn new(part: &'p Part, machine: Option<&'p Machine>, is_strict: bool) -> Self {
        let seen = inspect(part);
        let mut report = Self {
            part: &part.name,
            machine,
            slow_bends: machine.map(|machine| slow_bends(part, &seen, machine)).unwrap_or_default(),
            shorter_than_a_period: machine.map(|machine| shorter_than_a_period(part, machine)),
            assumed_unit: part.assumed_unit(),
            warnings: &part.warnings,
            seen,
            suspicious: Vec::new(),
            noted: Vec::new(),
        };
        (report.suspicious, report.noted) = report.findings(part);
        if is_strict {
            report.suspicious.append(&mut report.noted);
        }
        report
    }

    /// What is suspicious, and what is only noted.
    fn findings(&self, part: &Part) -> (Vec<String>, Vec<String>) {
        let (mut suspicious, mut noted) = (Vec::new(), Vec::new());
        let all_rapid = "every move is a rapid one: nothing is cut".to_string();
        suspicious.extend(input::is_all_rapid(part).then_some(all_rapid));
        let say = |into: &mut Vec<String>, what: &str, lines: &mut dyn Iterator<Item = usize>| {
            let lines = Lines::of(lines);
            into.extend(lines.list().map(|list| format!("{} × {what}: {list}", lines.count)));
        };
        let (seen, joints) = (&self.seen, || self.seen.joints.iter());
        let gaps = joints().filter(|joint| joint.gap_mm > GAP_MM);
        say(&mut suspicious, "gap in the path", &mut gaps.map(|joint| joint.line));
        let in_spline = |joint: &Joint| joint.knot.is_some() && part.curves[joint.curve].degree() > 1;
        let corners = joints().filter(in_spline);
        say(&mut suspicious, "corner inside a spline", &mut corners.map(|joint| joint.line));
        let slow = self.slow_bends.iter();
        let slow = slow.filter(|slow| slow.allowed_mm_per_s < LEAST_SHARE_OF_FEED * slow.commanded_mm_per_s);
        let what = "bend that leaves less than a tenth of the feed";
        say(&mut suspicious, what, &mut slow.map(|slow| slow.bend.line));
        let of =
            |severity| self.warnings.iter().filter(move |one| one.severity == severity).map(|one| one.line);
        let what = "word or setting read over, or arc bent to fit";
        say(&mut suspicious, what, &mut of(Severity::Warning));
        say(&mut noted, "word beside the path, or approach from an unknown place", &mut of(Severity::Note));
        say(&mut noted, "move at feed that ends where it starts", &mut seen.standstills.iter().copied());
        let feed_is_known = self.machine.is_some() && seen.feedrates_mm_per_s.is_none();
        let mut odd: BTreeMap<&str, Vec<&Remark>> = BTreeMap::new();
        for remark in &seen.remarks {
            if remark.oddity != Oddity::NoFeedrate || !feed_is_known {
                odd.entry(kind(&remark.oddity)).or_default().push(remark);
            }
        }
        for (kind, remarks) in odd {
            let is_tiny = matches!(remarks[0].oddity, Oddity::Tiny(_));
            let into = if is_tiny { &mut noted } else { &mut suspicious };
            match remarks.as_slice() {
                [one] => into.push(format!("line {}: {}", one.line, one.oddity)),
                _ => say(into, kind, &mut remarks.iter().map(|remark| remark.line)),
            }
        }
        (suspicious, noted)
    }

    fn text(&self) -> Result<String> {
        let mut text = self.answer() + "\n" + &self.summary()?;
        self.joints(&mut text)?;
        self.bends(&mut text)?;
        Ok(text)
    }

    /// The suspicious things, which decide the exit status.
    fn answer(&self) -> String {
        const MOST_SUSPICIONS: usize = 20;
        let name = screen::file_name(self.part);
        let count = self.suspicious.len();
        let said = match count {
            0 => format!("{name}: nothing is suspicious."),
            1 => format!("{name}: one thing is suspicious."),
            _ => format!("{name}: {count} things are suspicious."),
        };
        let shown = self.suspicious.iter().take(MOST_SUSPICIONS);
        let mut text = screen::answer(&said) + &shown.map(|one| labelled("- ", one)).collect::<String>();
        if count > MOST_SUSPICIONS {
            text += &format!("- and {} more (--json lists all)\n", count - MOST_SUSPICIONS);
        }
        text
    }

    fn summary(&self) -> Result<String> {
        let seen = &self.seen;
        let mut text = String::new();
        let kinds =
            [(seen.lines, "line"), (seen.arcs, "arc"), (seen.splines, "spline"), (seen.rapids, "rapid move")];
        let kinds = kinds.into_iter().filter(|(count, _)| *count > 0).map(|(count, kind)| many(count, kind));
        text += &labelled("moves       ", &kinds.collect::<Vec<_>>().join(", "));
        if let Some((least, most)) = seen.degrees {
            let degrees = if least == most { format!("{least}") } else { format!("{least} to {most}") };
            writeln!(text, "curves      degree {degrees}, {}", many(seen.control_points, "control point"))?;
        }
        let rapid = match seen.rapids {
            0 => String::new(),
            _ => format!(", {:.3} mm in rapid moves", seen.rapid_length_mm),
        };
        writeln!(text, "length      {:.3} mm at feed{rapid}", seen.length_mm)?;
        if let Some((least, most)) = seen.bounding_box_mm {
            let ranges = ["X", "Y", "Z"].into_iter().zip(least.into_iter().zip(most));
            let ranges = ranges.map(|(axis, (least, most))| format!("{axis} {least:.3} to {most:.3}"));
            text += &labelled("within      ", &format!("{} mm", ranges.collect::<Vec<_>>().join(", ")));
        }
        match seen.feedrates_mm_per_s {
            Some((least, most)) if least == most => writeln!(text, "feed        {least:.3} mm/s")?,
            Some((least, most)) => writeln!(text, "feed        {least:.3} to {most:.3} mm/s")?,
            None => match self.machine {
                Some(machine) => {
                    writeln!(text, "feed        the machine's, {:.3} mm/s", machine.feedrate_mm_per_s)?;
                }
                None => writeln!(text, "feed        none commanded")?,
            },
        }
        if let Some(count) = self.shorter_than_a_period.filter(|count| *count > 0) {
            writeln!(text, "short       {} shorter than the travel of one period", many(count, "move"))?;
        }
        for one in &self.noted {
            text += &labelled("noted       ", one);
        }
        Ok(text)
    }

    fn joints(&self, text: &mut String) -> Result<()> {
        let between = (self.seen.lines + self.seen.arcs + self.seen.splines + self.seen.rapids).max(1) - 1;
        let (count, worst) = worst_joints(&self.seen);
        writeln!(text, "joints      {between} between moves; {count} with a corner or a gap")?;
        let rows = worst.iter().map(|joint| {
            let place = joint.knot.map_or(String::new(), |knot| format!("inside, at knot {}", short(knot)));
            let mut cells = row(joint.line, joint.point_mm);
            cells.extend([
                format!("{:.2}", joint.tangent_break_rad.to_degrees()),
                if joint.gap_mm > 0.0 { format!("{:.6}", joint.gap_mm) } else { String::new() },
                place,
            ]);
            cells
        });
        table(text, count, &["break\n°", "gap\nmm", ""], rows.collect())
    }

    fn bends(&self, text: &mut String) -> Result<()> {
        if let Some(bend) = self.seen.sharpest() {
            let [x, y, z] = bend.point_mm;
            *text += &labelled(
                "radius      ",
                &format!(
                    "{:.6} mm at least: line {}, X {x:.3} Y {y:.3} Z {z:.3}, u = {:.6}",
                    bend.radius_mm, bend.line, bend.parameter
                ),
            );
        }
        if self.slow_bends.is_empty() {
            return Ok(());
        }
        let slow = &self.slow_bends;
        writeln!(
            text,
            "bends       {} must be passed more slowly than commanded",
            many(slow.len(), "curve")
        )?;
        let rows = slow.iter().take(WORST).map(|slow| {
            let mut cells = row(slow.bend.line, slow.bend.point_mm);
            cells.extend([
                format!("{:.4}", slow.bend.radius_mm),
                format!("{:.3}", slow.commanded_mm_per_s),
                format!("{:.3}", slow.allowed_mm_per_s),
            ]);
            cells
        });
        table(text, slow.len(), &["radius\nmm", "commanded\nmm/s", "allowed\nmm/s"], rows.collect())
    }
}

/// How many joints there are, and the worst of them, worst first.
fn worst_joints(seen: &Inspection<'_>) -> (usize, Vec<Joint>) {
    let (mut count, mut worst) = (0, Vec::<Joint>::with_capacity(WORST + 1));
    for joint in seen.joints.iter() {
        count += 1;
        let is_no_better = |other: &Joint| {
            other
                .gap_mm
                .total_cmp(&joint.gap_mm)
                .then(other.tangent_break_rad.total_cmp(&joint.tangent_break_rad))
                .is_ge()
        };
        worst.insert(worst.partition_point(is_no_better), joint);
        worst.truncate(WORST);
    }
    (count, worst)
}

/// The bends where chord error or centripetal acceleration allow less than the commanded feed, the slowest first.
fn slow_bends(part: &Part, seen: &Inspection<'_>, machine: &Machine) -> Vec<SlowBend> {
    let period_s = machine.interpolation_period_ms / 1000.0;
    let slow = seen.bends.iter().map(|bend| {
        let chord = chord_feedrate(bend.radius_mm, machine.chord_error_mm, period_s);
        let across = machine.centripetal_acceleration_mm_per_s2;
        let across = across.map_or(f64::INFINITY, |across| (across * bend.radius_mm).sqrt());
        SlowBend {
            bend: *bend,
            commanded_mm_per_s: commanded(part, bend.curve, machine),
            allowed_mm_per_s: chord.min(across),
        }
    });
    let mut slow: Vec<_> = slow.filter(|slow| slow.allowed_mm_per_s < slow.commanded_mm_per_s).collect();
    slow.sort_by(|a, b| a.allowed_mm_per_s.total_cmp(&b.allowed_mm_per_s));
    slow
}

fn shorter_than_a_period(part: &Part, machine: &Machine) -> usize {
    let period_s = machine.interpolation_period_ms / 1000.0;
    let feeds = part.moves.iter().enumerate().filter(|(_, one)| one.kind == MoveKind::Feed);
    let short = feeds.filter(|(index, _)| {
        // A control polygon is at least as long as its curve, so each move counted is certainly shorter.
        part.curves[*index].polygon_length_mm() < commanded(part, *index, machine) * period_s
    });
    short.count()
}

fn commanded(part: &Part, curve: usize, machine: &Machine) -> f64 {
    part.moves[curve].feedrate_mm_per_s.unwrap_or(machine.feedrate_mm_per_s)
}

fn kind(oddity: &Oddity) -> &'static str {
    match oddity {
        Oddity::NoFeedrate => "move without a feedrate",
        Oddity::Tiny(_) => "move below a micrometre",
        Oddity::Cusp(_) => "cusp",
        Oddity::RepeatedControlPoint(_) => "control point given twice",
        Oddity::WeightRatio(_) => "curve with weights over decades",
        Oddity::ShortKnotSpan(..) => "knot span of next to nothing",
        _ => "curve that is odd",
    }
}

/// A count with its noun, as in "3 lines".
fn many(count: usize, noun: &str) -> String {
    format!("{count} {noun}{}", if count == 1 { "" } else { "s" })
}

/// The first of some lines, and how many there are.
struct Lines {
    first: Vec<usize>,
    count: usize,
}

impl Lines {
    fn of(lines: &mut dyn Iterator<Item = usize>) -> Self {
        const MOST: usize = 5;
        let first: Vec<usize> = lines.take(MOST).collect();
        let count = first.len() + lines.count();
        Self { first, count }
    }

    /// As in "lines 3, 4, 9 and 12 more"; `None` if there are none.
    fn list(&self) -> Option<String> {
        let numbers: Vec<_> = self.first.iter().map(ToString::to_string).collect();
        let rest = self.count - self.first.len();
        let more = if rest == 0 { String::new() } else { format!(" and {rest} more") };
        let noun = if self.count == 1 { "line" } else { "lines" };
        (self.count > 0).then(|| format!("{noun} {}{more}", numbers.join(", ")))
    }
}

fn row(line: usize, point_mm: [f64; 3]) -> Vec<String> {
    let mut cells = vec![line.to_string()];
    cells.extend(point_mm.map(|x| format!("{x:.3}")));
    cells
}

/// A table of places; nothing if there are none.
fn table(text: &mut String, count: usize, columns: &[&str], rows: Vec<Vec<String>>) -> Result<()> {
    if count > rows.len() {
        writeln!(text, "The worst {} of {count} (--json lists all):", rows.len())?;
    }
    let header: Vec<&str> = ["line", "x\nmm", "y\nmm", "z\nmm"].iter().chain(columns).copied().collect();
    *text += &screen::table(&header, rows);
    Ok(())
}
