//! `feedbits convert`: a part as a program of another dialect, as straight moves, or as a curve file.

use std::borrow::Borrow;
use std::path::PathBuf;

use anyhow::{Context, Result, bail};
use clap::{Args, ValueEnum};
use domains::options::{CONVERT_TOLERANCE, CORNER, DIGITS, FIT, RATIOS};
use part_program::{
    Curve, GAP_MM, MoveKind, NoLargestRatio, Part, RatioWords, Rounded, inspect, write_curves, write_g1,
    write_g5_2, write_g06_2,
};
use path_smooth::{FitOptions, FitReport, Fitted, fit_curves};

use crate::ending::Ending;
use crate::input::{Input, expect_no_side_axes, read_again};
use crate::numbers::{number, whole, within};
use crate::output;
use crate::output::counted;
use crate::places::Place;
use crate::progress::Progress;

/// If rounding turns a straight move by more than this, in degrees, a note says so.
const TURN_DEG: f64 = 2.0;
/// The highest order of G06.2 (FANUC Series 15i, B-63324EN/03, section 4.17).
const FANUC_ORDER: usize = 4;

/// Options of `convert`.
#[derive(Args)]
pub(crate) struct Arguments {
    #[command(flatten)]
    input: Input,
    /// What to write. Default with --fit: g06.2.
    #[arg(
        long,
        value_enum,
        required_unless_present = "fit",
        default_value_if("fit", clap::builder::ArgPredicate::IsPresent, "g06.2")
    )]
    to: Option<Target>,
    /// Write runs of straight moves as cubic curves that are at most so far from them, in mm; the distance is proven. Corners,
    /// rests and changes of feed stay.
    #[arg(long, value_name = "MM", value_parser = number(&FIT))]
    fit: Option<f64>,
    /// With --fit: a change of direction above this, in degrees, is a corner.
    #[arg(
        long,
        value_name = "DEGREES",
        requires = "fit",
        default_value_t = 30.0,
        value_parser = number(&CORNER)
    )]
    corner: f64,
    /// With --fit: let curves pass every point between the moves, as paper D does, in place of as few as keep within MM.
    #[arg(long, requires = "fit")]
    every_point: bool,
    /// With --to g1: largest distance between the curves and the straight moves, in mm. Default: 0.001.
    #[arg(long, value_name = "MM", value_parser = number(&CONVERT_TOLERANCE))]
    tolerance: Option<f64>,
    /// Round coordinates, in mm, to so many decimals, as a control takes them. All other numbers are kept as they are.
    #[arg(long, value_name = "N", value_parser = whole::<u8>(&DIGITS))]
    digits: Option<u8>,
    /// With --to g06.2: scale knots and weights, which are ratios, to at most this number, and round them to its decimals, as a
    /// control takes them: 999999.999 with FANUC's Series 15i and IS-B, 99.9999 with Mitsubishi's M700V.
    #[arg(long, value_name = "LARGEST", value_parser = ratio_words)]
    ratios: Option<RatioWords>,
    /// Write to this file instead of the terminal.
    #[arg(long, value_name = "PATH")]
    out: Option<PathBuf>,
}

/// The words for ratios: by the largest, within its domain.
fn ratio_words(text: &str) -> Result<RatioWords, String> {
    let words = text.parse().map_err(|error: NoLargestRatio| error.to_string())?;
    within(&RATIOS, text).map(|_| words).map_err(|expected| format!("{NoLargestRatio}: {expected}"))
}

impl Arguments {
    /// The largest distance of straight moves from their curves, in mm.
    fn tolerance(&self) -> f64 {
        self.tolerance.unwrap_or(0.001)
    }

    /// What to write; clap demands it, or takes the default.
    fn to(&self) -> Target {
        self.to.unwrap_or(Target::G06_2)
    }
}

/// The forms that can be written.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
enum Target {
    /// FANUC's NURBS; every number is kept bit by bit, but for what --digits and --ratios round.
    #[value(name = "g06.2")]
    G06_2,
    /// LinuxCNC's NURBS, planar; knots other than uniform ones are cut into Bézier curves.
    #[value(name = "g5.2")]
    G5_2,
    /// Straight moves within --tolerance.
    G1,
    /// A curve file, with the machine if one is given; every number is kept bit by bit.
    Toml,
}

/// Reads the part, writes it, reads the result back, and says what has changed.
pub(crate) fn run(arguments: &Arguments) -> Result<Ending> {
    if arguments.to() != Target::G1 && arguments.tolerance.is_some() {
        bail!("--tolerance: curves are kept as they are there; expected --to g1");
    }
    if arguments.to() == Target::Toml && arguments.digits.is_some() {
        bail!("--digits: a curve file keeps every number bit by bit; expected --to g06.2, g5.2 or g1");
    }
    if arguments.to() != Target::G06_2 && arguments.ratios.is_some() {
        bail!("--ratios: no knots and weights are rounded there; expected --to g06.2");
    }
    if arguments.to() == Target::G1 && arguments.fit.is_some() {
        bail!("--fit: it makes curves, and --to g1 would cut them again; expected --to g06.2, g5.2 or toml");
    }
    let place = Place::named("--out", arguments.out.as_deref())?;
    let mut part = arguments.input.part()?;
    expect_no_side_axes(&part, "what is written")?;
    part.machine = arguments.input.machine_of(&part)?;
    let progress = Progress::spinning("converting");
    let fitted = fitted(&part, arguments)?;
    if let Some(fitted) = &fitted {
        part = fitted.path.clone();
    }
    let (mut text, mut again) = written(&part, arguments)?;
    let mut rounding = Vec::new();
    if let Some(digits) = arguments.digits {
        let rounded = rounded(&part, &again, arguments.to(), digits)?;
        (text, again) = written(&rounded.part, arguments)?;
        if !are_same(&again.curves, &rounded.part.curves) {
            bail!("what was rounded reads back as another path: nothing is kept");
        }
        rounding = rounding_notes(&part, &rounded, arguments, digits);
    }
    if let Some(words) = &arguments.ratios {
        let (fitted, moved_mm) = again.in_ratio_words(words).context("--ratios has too few digits")?;
        (text, again) = written(&fitted, arguments)?;
        if !are_same(&again.curves, &fitted.curves) {
            bail!("what was rounded reads back as another path: nothing is kept");
        }
        rounding.push(ratio_note(arguments, moved_mm));
    }
    progress.finish();
    output::write(&place, &text)?;
    if let Some(fitted) = &fitted {
        output::note(&fit_note(&fitted.report, arguments));
    }
    for note in notes(&part, &again, arguments).iter().chain(&rounding) {
        output::note(note);
    }
    Ok(Ending::Good)
}

/// The part with curves in place of runs of straight moves, if that is asked for.
fn fitted(part: &Part, arguments: &Arguments) -> Result<Option<Fitted>> {
    let Some(tolerance_mm) = arguments.fit else { return Ok(None) };
    let options =
        FitOptions { tolerance_mm, corner_deg: arguments.corner, every_point: arguments.every_point };
    match fit_curves(part, &options) {
        Ok(fitted) => Ok(Some(fitted)),
        Err(error) => {
            Err(error).with_context(|| format!("{}: --fit {tolerance_mm}: nothing is written", part.name))
        }
    }
}

/// What became of the straight moves, and the proven bound.
fn fit_note(report: &FitReport, arguments: &Arguments) -> String {
    let bound_mm = (report.bound_mm * 1e6).ceil() / 1e6;
    let rounded = arguments.digits.is_some() || arguments.ratios.is_some();
    format!(
        "{} of {} straight moves are {} of degree 3 with {} control points, at most {bound_mm} mm from the moves{}; {}",
        report.fitted,
        report.straight_moves,
        counted(report.curves, "curve", "curves"),
        report.control_points,
        if rounded { " before the rounding" } else { "" },
        counted(report.corners, "corner stays", "corners stay"),
    )
}

/// The text of a part, and the part as it reads back.
fn written(part: &Part, arguments: &Arguments) -> Result<(String, Part)> {
    let text = match arguments.to() {
        Target::G06_2 => write_g06_2(part)?,
        Target::G5_2 => write_g5_2(part)?,
        Target::G1 => write_g1(part, arguments.tolerance(), arguments.input.dialect())?,
        Target::Toml => write_curves(part),
    };
    // For the other targets, the words of the text tell the dialect.
    let dialect = arguments.input.dialect().filter(|_| arguments.to() == Target::G1);
    let again = read_again(&text, dialect)?;
    Ok((text, again))
}

/// The rounded part. Curves that the dialect cuts are cut before the rounding.
fn rounded(part: &Part, written: &Part, to: Target, digits: u8) -> Result<Rounded> {
    if to != Target::G1 {
        part.keeps_moving_rounded(digits.into()).with_context(|| {
            format!(
                "--digits {digits} is too few: give more, or --to g1, which leaves out what has no length"
            )
        })?;
    }
    let rounded = written.rounded(digits.into());
    if at_feed(&rounded.part).is_empty() {
        bail!("--digits {digits} is too few: every move at feed rounds to one point");
    }
    Ok(rounded)
}

/// A bound of how far rounding moves the path, and the moves that it leaves out.
fn rounding_notes(part: &Part, rounded: &Rounded, arguments: &Arguments, digits: u8) -> Vec<String> {
    let has_curves = at_feed(part).iter().any(|curve| curve.control_points_mm().len() > 2);
    let (off_mm, of_cutting) = match arguments.to() {
        Target::G1 if has_curves => (rounded.moved_mm + arguments.tolerance(), ""),
        Target::G5_2 if has_curves => {
            (rounded.moved_mm, ", but for the rounding of f64 where curves are cut")
        }
        _ => (rounded.moved_mm, ""),
    };
    let decimals = i32::from(digits) + 3;
    let unit = 10.0_f64.powi(decimals);
    let off_mm = (off_mm * unit).ceil() / unit;
    let others = if arguments.ratios.is_some() { "" } else { "; other numbers are kept" };
    let mut notes = vec![format!(
        "coordinates have {digits} decimals: the path is at most {off_mm} mm off the part{of_cutting}{others}"
    )];
    if rounded.left_out > 0 {
        notes.push(format!("{} moves that round to one point are left out", rounded.left_out));
    }
    if rounded.turned_deg >= TURN_DEG {
        let coarser =
            if arguments.to() == Target::G1 && has_curves { " or a larger --tolerance" } else { "" };
        notes.push(format!(
            "rounding turns straight moves by up to {:.0}°, and a control may slow down at such corners: give more --digits{coarser}",
            rounded.turned_deg
        ));
    }
    notes
}

/// A bound of how far rounding of the knots and weights moves the path.
fn ratio_note(arguments: &Arguments, moved_mm: f64) -> String {
    let off_mm = (moved_mm * 1e9).ceil() / 1e9;
    let farther = if arguments.digits.is_some() { " farther" } else { "" };
    format!("knots and weights are scaled and rounded: the path is at most {off_mm} mm{farther} off the part")
}

/// Notes for a reader of the new file.
fn notes(part: &Part, again: &Part, arguments: &Arguments) -> Vec<String> {
    let (to, before, after) = (arguments.to(), at_feed(part), at_feed(again));
    let mut notes = vec![match to {
        Target::G1 => {
            format!("{} {} straight moves", counted(before.len(), "curve is", "curves are"), after.len())
        }
        _ if arguments.digits.is_some() || arguments.ratios.is_some() => {
            format!("{} written as {}", counted(before.len(), "curve is", "curves are"), after.len())
        }
        _ if are_same(&before, &after) => {
            counted(before.len(), "curve, which reads back bit by bit", "curves, which read back bit by bit")
        }
        _ => format!(
            "{} curves, which read back as {} others: the dialect lacks words",
            before.len(),
            after.len()
        ),
    }];
    let order = after.iter().map(|curve| curve.degree() + 1).max().unwrap_or(0);
    if to == Target::G06_2 && order > FANUC_ORDER {
        notes.push(format!("there are curves of P{order}: a FANUC control takes P2 to P{FANUC_ORDER}"));
    }
    let (words, kept) = (part.auxiliary.len(), again.auxiliary.len());
    if to == Target::Toml && words > 0 {
        notes.push(format!(
            "{words} words M, S, T, D or H are left out: a curve file has none, but rests at them"
        ));
    } else if kept > words {
        notes.push("M30 was added at the end".into());
    }
    // Gaps are counted as `check` counts them.
    let gaps = inspect(part).joints.iter().filter(|joint| joint.gap_mm > GAP_MM).count();
    if gaps > 0 {
        notes.push(format!(
            "{} crossed by a rapid move: the part has nothing there",
            counted(gaps, "gap is", "gaps are")
        ));
    }
    if !part.warnings.is_empty() && to != Target::Toml {
        notes.push(
            "what the warnings name is not in what is written: look at it before a machine runs this".into(),
        );
    }
    if let Some(words) = &part.left_out {
        notes.push(format!("left out: {words}"));
    }
    if !part.standstills.is_empty() {
        notes.push(format!("{} moves that go nowhere are left out", part.standstills.len()));
    }
    let stops = |part: &Part| part.moves.iter().filter(|one| one.exact_stop).count();
    if stops(again) < stops(part) {
        notes.push(format!("{} of {} exact stops are lost", stops(part) - stops(again), stops(part)));
    }
    if part.machine.is_some() && to != Target::Toml {
        notes.push("the machine is left out: a program has none".into());
    }
    notes
}

fn at_feed(part: &Part) -> Vec<&Curve> {
    let feed = part.curves.iter().zip(&part.moves).filter(|(_, one)| one.kind == MoveKind::Feed);
    feed.map(|(curve, _)| curve).collect()
}

/// Whether two paths have the same numbers, curve by curve.
fn are_same<C: Borrow<Curve>>(one: &[C], other: &[C]) -> bool {
    let mut pairs = one.iter().zip(other);
    one.len() == other.len() && pairs.all(|(one, other)| one.borrow().has_same_numbers(other.borrow()))
}
