//! The input of every subcommand: a part, and the machine that is to follow it.

use std::path::{Path, PathBuf};

use anyhow::{Context, Result, bail};
use clap::Args;
use clap_complete::{ArgValueCandidates, ArgValueCompleter};
use domains::options::START;
use format_compare::{Problem, Refusal};
use part_program::{
    Diagnostics, Dialect, Machine, Move, MoveKind, Part, ReadOptions, SIDE_AXES, Severity, ToolTable, Unit,
};
use secant_interp::crc32;

use crate::files::{MOST_OF_PART, bytes, taken};
use crate::fingerprint::fingerprint;
use crate::{candidates, claims, files, output, presets};

/// The example that runs when no part is named: paper A's curve and machine.
const EXAMPLE: &str = include_str!("../../../data/seed-000.toml");

/// The part and its machine.
#[derive(Args)]
pub(crate) struct Input {
    /// Part: a curve file (TOML), a part program, what LinuxCNC's rs274 prints of one, a drawing (DXF) or geomdl's JSON, told by its
    /// content; a program of at most 512 MiB, any other of at most 64 MiB. `-` is the standard input. Default: the built-in example.
    part: Option<PathBuf>,
    #[command(flatten)]
    reading: Reading,
}

/// The machine, and how a part is read.
#[derive(Args, Clone, Debug)]
pub(crate) struct Reading {
    /// Machine: a preset's name, as `feedbits machine` lists them, or a file (TOML with a table `machine`). A file that is named as a
    /// preset is given with its folder, as ./mill. Default: the machine in the part's own file.
    #[arg(long, value_name = "NAME|FILE", add = ArgValueCompleter::new(candidates::machines))]
    machine: Option<PathBuf>,
    /// The control that a part program is for: fanuc, linuxcnc or siemens; canon is what LinuxCNC's rs274 prints of one. Default: told
    /// by its splines, or by its lines.
    #[arg(long, value_name = "CONTROL", add = ArgValueCandidates::new(candidates::dialects))]
    dialect: Option<Dialect>,
    /// Read over unknown words of a part program, with a warning each. A block with a word that is not read is left out: it moves
    /// nothing, and nothing moves behind it until blocks in G90 have named each axis whose place is unknown. Behind a name, a call or
    /// a G word that no table has, that is every axis. After a word that turns, scales or mirrors coordinates, or changes what moves
    /// mean, such as G68, G112 or TRANSMIT, nothing moves until the word that ends it. Other G words of the block, F, M, S, T, D and
    /// H hold.
    #[arg(long)]
    lenient: bool,
    /// Where the tool is when a part program begins, in mm. Default: an axis begins where the program first sends it.
    #[arg(long, value_name = "X,Y,Z", value_parser = place, allow_hyphen_values = true)]
    start: Option<[f64; 3]>,
    /// The unit of a part program's lengths until a word names one: mm or inch.
    #[arg(long, value_name = "UNIT")]
    units: Option<Unit>,
    /// Tool table for the radii of cutter compensation, G41 and G42: LinuxCNC's, in the unit of --units, or CSV with columns tool and
    /// diameter_mm (or radius_mm, diameter_inch, radius_inch); at most 1 MiB.
    #[arg(long, value_name = "FILE")]
    tools: Option<PathBuf>,
}

/// Reads `X,Y,Z`.
fn place(text: &str) -> Result<[f64; 3], String> {
    let numbers: Vec<f64> = text.split(',').map_while(|number| number.trim().parse().ok()).collect();
    match numbers[..] {
        [x, y, z] if text.split(',').count() == 3 && [x, y, z].iter().all(|x| START.holds(*x)) => {
            Ok([x, y, z])
        }
        _ => Err(format!("expected three numbers in mm, as 0,0,5, each {}", START.expected())),
    }
}

/// A problem in the number of dimensions of its part.
pub(crate) enum AnyProblem {
    Planar(Problem<2>),
    Spatial(Problem<3>),
}

impl AnyProblem {
    /// A problem in the plane if the whole part is in it, otherwise in space. Notes say what the run leaves out.
    pub(crate) fn new(part: &Part, machine: &Machine) -> Result<Self> {
        Ok(if part.curves.iter().all(|curve| curve.dimension() == 2) {
            Self::Planar(problem(part, machine)?)
        } else {
            Self::Spatial(problem(part, machine)?)
        })
    }
}

/// The text of a part, and how it is to be read.
pub(crate) struct Text {
    pub(crate) name: String,
    bytes: Vec<u8>,
    options: ReadOptions,
    tools: ToolTable,
}

impl Text {
    /// The part, or the errors in the text.
    pub(crate) fn parsed(&self) -> Result<Part, Diagnostics> {
        part_program::read_part_bytes_with(&self.name, &self.bytes, self.options, &self.tools)
    }

    /// A checksum of what the text says: of its bytes, with lines that end alike on every system, and of the options by which it
    /// is read.
    pub(crate) fn checksum(&self) -> u32 {
        crc32(&self.said().collect::<Vec<_>>())
    }

    /// A number of 64 bits that almost certainly differs for texts that do not say the same.
    pub(crate) fn fingerprint(&self) -> String {
        fingerprint(self.said())
    }

    /// The bytes of the text, with lines that end alike on every system, and the options by which it is read.
    fn said(&self) -> impl Iterator<Item = u8> {
        let ReadOptions { dialect, lenient, start_mm, unit } = self.options;
        let mut options = format!("{:?} {lenient} {start_mm:?} {unit:?}", dialect.map(Dialect::name));
        for (tool, diameter) in self.tools.tools() {
            options += &format!(" {tool} {diameter:?}");
        }
        let text = self.bytes.iter().copied().filter(|byte| *byte != b'\r');
        text.chain(options.into_bytes())
    }
}

/// The part of a text, whose warnings are printed.
pub(crate) fn part_of(text: &Text) -> Result<Part> {
    let part = text.parsed()?;
    say_warnings(&part);
    Ok(part)
}

/// The result of work on a problem. A refusal of it says of which part, unless it does so itself.
pub(crate) fn in_part<T, const D: usize>(problem: &Problem<D>, result: Result<T>) -> Result<T> {
    result.map_err(|error| match error.downcast_ref() {
        Some(refusal) if !Refusal::names_its_place(refusal) => error.context(problem.name.clone()),
        _ => error,
    })
}

/// A part and the machine that is to run it, which is `machine` or stands in the part's own file.
pub(crate) fn with_machine(mut part: Part, machine: Option<Machine>) -> Result<(Part, Machine)> {
    if is_all_rapid(&part) {
        bail!("{}: every move is a rapid one, and nothing is cut: expected a move at feed", part.name);
    }
    match machine.or_else(|| part.machine.clone()) {
        Some(machine) => {
            if !machine.s_stops {
                part.pass_spindle_words();
            }
            Ok((part, machine))
        }
        None => bail!(
            "{} names no machine: give its limits with --machine FILE.toml, or take a preset such as --machine router; \
             `feedbits machine` lists them",
            part.name
        ),
    }
}

impl Reading {
    /// The options of the part's reader.
    fn options(&self) -> ReadOptions {
        ReadOptions { dialect: self.dialect, lenient: self.lenient, start_mm: self.start, unit: self.units }
    }

    /// The machine that the options name, if they name one.
    pub(crate) fn machine(&self) -> Result<Option<Machine>> {
        self.machine.as_deref().map(presets::read).transpose()
    }

    /// What reads parts by these options: the tool table that they name is read here, once for all parts.
    pub(crate) fn reader(&self) -> Result<PartReader> {
        let tools = match &self.tools {
            None => ToolTable::default(),
            Some(path) => {
                let text = files::text("--tools", path, files::MOST_OF_SMALL)?;
                ToolTable::read(&path.display().to_string(), &text, self.units.unwrap_or(Unit::Millimetre))?
            }
        };
        Ok(PartReader { options: self.options(), tools })
    }
}

/// The options of the part's reader, with the tool table.
pub(crate) struct PartReader {
    options: ReadOptions,
    tools: ToolTable,
}

impl PartReader {
    /// The text of the part in a file.
    pub(crate) fn text_of(&self, path: &Path) -> Result<Text> {
        Ok(self.text(path.display().to_string(), bytes("the part", path, MOST_OF_PART)?))
    }

    fn text(&self, name: String, bytes: Vec<u8>) -> Text {
        Text { name, bytes, options: self.options, tools: self.tools.clone() }
    }
}

impl Input {
    /// The part of a command that takes several, of which one is given, or none.
    pub(crate) fn new(part: Option<&Path>, reading: &Reading) -> Self {
        Self { part: part.map(Path::to_path_buf), reading: reading.clone() }
    }

    /// Reads both files as a problem to plan and run. Notes say what the run leaves out.
    pub(crate) fn read(&self) -> Result<AnyProblem> {
        let (part, machine) = self.part_and_machine()?;
        AnyProblem::new(&part, &machine)
    }

    /// Reads both files, as what is to be run.
    pub(crate) fn part_and_machine(&self) -> Result<(Part, Machine)> {
        self.part_and_machine_of(&self.text()?)
    }

    /// As [`part_and_machine`](Self::part_and_machine), of a text that is at hand.
    pub(crate) fn part_and_machine_of(&self, text: &Text) -> Result<(Part, Machine)> {
        let part = part_of(text)?;
        // A part of rapid moves is refused before a machine is asked for.
        let machine = if is_all_rapid(&part) { None } else { self.reading.machine()? };
        with_machine(part, machine)
    }

    /// Reads the part and prints its warnings.
    pub(crate) fn part(&self) -> Result<Part> {
        part_of(&self.text()?)
    }

    /// The control for which a program is written: the one that the options name for the part.
    pub(crate) fn dialect(&self) -> Option<Dialect> {
        self.reading.dialect.map(Dialect::written)
    }

    /// The part's text.
    pub(crate) fn text(&self) -> Result<Text> {
        let reader = self.reading.reader()?;
        let (name, bytes) = match &self.part {
            Some(path) if path == Path::new("-") => {
                let name = "standard input";
                claims::read_standard_input()?;
                (name.to_string(), taken(name, std::io::stdin().lock(), MOST_OF_PART)?)
            }
            Some(path) => return reader.text_of(path),
            None => ("built-in example".to_string(), EXAMPLE.into()),
        };
        Ok(reader.text(name, bytes))
    }

    /// The machine that the options name, or that the part's file contains.
    pub(crate) fn machine_of(&self, part: &Part) -> Result<Option<Machine>> {
        Ok(self.reading.machine()?.or_else(|| part.machine.clone()))
    }
}

/// Whether nothing of a part is cut.
pub(crate) fn is_all_rapid(part: &Part) -> bool {
    part.moves.iter().all(|one| one.kind == MoveKind::Rapid)
}

/// Prints the notes about a part that was read.
pub(crate) fn say_warnings(part: &Part) {
    for warning in part.warnings.iter().filter(|one| one.severity != Severity::Note || !output::is_quiet()) {
        output::warn(&warning.to_string());
    }
    if let Some(size) = part.assumed_unit() {
        output::note(&format!("{size}; `--units mm` or `--units inch` says which"));
    }
}

/// Refuses a part of which a command would lose the axes that move beside the path.
pub(crate) fn expect_no_side_axes(part: &Part, what: &str) -> Result<()> {
    let moves = |axis: usize| part.side_moves.iter().any(|one| one.from[axis] != one.to[axis]);
    let moved: Vec<_> =
        (0..SIDE_AXES.len()).filter(|axis| moves(*axis)).map(|axis| SIDE_AXES[axis]).collect();
    if let Some(letter) = moved.first() {
        bail!("{}: {letter} moves beside the path, and {what} holds X, Y and Z alone", part.name);
    }
    Ok(())
}

/// Refuses a problem with axes beside the path in what holds the path alone.
pub(crate) fn expect_path_alone<const D: usize>(problem: &Problem<D>, what: &str) -> Result<()> {
    if !problem.side_axes.is_empty() {
        bail!("{what} holds the path of X, Y and Z alone: beside it moves {}", problem.side_axes.letters());
    }
    Ok(())
}

/// Notes which axes move beside the path, and which of their limits the machine does not state.
fn say_side_axes<const D: usize>(problem: &Problem<D>) {
    if problem.side_axes.is_empty() {
        return;
    }
    output::note(&format!(
        "beside the path: {}; the plan keeps their limits, and no verdict is on them",
        problem.side_axes.letters()
    ));
    for key in problem.side_axes.unlimited(&problem.machine) {
        output::note(&format!(
            "[machine.axes.{key}] states no limit: that axis takes what the path makes of it"
        ));
    }
}

/// The problem. Notes say what it leaves out and where it differs from the part.
fn problem<const D: usize>(part: &Part, machine: &Machine) -> Result<Problem<D>> {
    let problem = Problem::new(part, machine)?;
    say_side_axes(&problem);
    say_feeds(part, problem.feedrate_mm_per_s());
    for (count, one, many, why) in [
        (
            problem.rapids_left_out,
            "rapid move is",
            "rapid moves are",
            "nothing is cut on the way, and the feed is 0 there",
        ),
        (problem.gaps, "gap is", "gaps are", "the curves do not meet there, and the feed is 0"),
    ] {
        if count > 0 {
            output::note(&format!("{} left out: {why}", output::counted(count, one, many)));
        }
    }
    Ok(problem)
}

/// Notes that some moves command no feedrate, and at which feedrate in mm/s they are run.
fn say_feeds(part: &Part, feedrate: f64) {
    let lacks = |one: &&Move| one.kind == MoveKind::Feed && one.feedrate_mm_per_s.is_none();
    // A curve file with a machine of its own gives the feedrate there.
    if part.machine.is_none()
        && let Some(first) = part.moves.iter().find(lacks)
    {
        let whose =
            if part.feedrate_mm_per_s.is_some() { "the highest of the part" } else { "the machine's" };
        output::note(&format!(
            "no feedrate is commanded in line {}: {whose}, {feedrate} mm/s, is taken",
            first.line
        ));
    }
}

/// Reads back a program that was written, before the program is kept.
pub(crate) fn read_again(text: &str, dialect: Option<Dialect>) -> Result<Part> {
    part_program::read_part_with(
        "what was written",
        text,
        ReadOptions { dialect, lenient: false, ..ReadOptions::default() },
    )
    .context("what was written does not read back: nothing is kept")
}
