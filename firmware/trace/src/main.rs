//! `trace`: runs a firmware image in QEMU and counts its instructions, every one.
//!
//! | step | where |
//! |---|---|
//! | the emulator's stream of executed instructions | [`emulator`] |
//! | addresses of the kernels in the image | [`symbols`] |
//! | what kind of instruction each is | [`instruction`] |
//! | which instructions belong to which call | [`calls`] |
//! | cycles by a processor manual's table | [`cycles`] |
//! | what a compiled part costs, by what its periods pass | [`part`] |
//! | the data file | [`report`] |
//!
//! `trace --image IMAGE [--image IMAGE] --target NAME --out FILE.toml` measures one target, whose formats may lie in several
//! images, and fails when a checksum is not the host's;
//! `trace` built with the feature `part` prints the counts of the user's own part, and with `--program NAME` writes them into
//! FILE.toml in place of the rest;
//! `trace --compare FILE.toml FILE.toml` says what differs in the second.

mod calls;
mod cycles;
mod emulator;
mod instruction;
mod part;
mod report;
mod symbols;
mod target;

use std::path::{Path, PathBuf};
use std::process::ExitCode;
use std::time::Instant;

use kernel::{Board, PeriodKind, Record};

/// An error that the user is to read.
type Failure = Box<dyn std::error::Error>;

/// The host's own run of the same calls.
#[derive(Default)]
struct Host {
    records: Vec<Record>,
    /// What the periods of a part pass.
    kinds: Vec<PeriodKind>,
}

impl Board for Host {
    fn paint_stack(&mut self) {}
    fn used_stack(&mut self) -> usize {
        0
    }
    fn record(&mut self, record: Record) {
        self.records.push(record);
    }
    fn period(&mut self, kind: PeriodKind) {
        self.kinds.push(kind);
    }
}

const USAGE: &str = "usage: trace --image IMAGE... --target NAME --out FILE.toml [--program NAME] [--toolchain KEY=VALUE]... [--one-at-a-time]\n       \
                     trace --compare FILE.toml FILE.toml";

fn main() -> ExitCode {
    match run() {
        Ok(()) => ExitCode::SUCCESS,
        Err(failure) => {
            eprintln!("trace: {failure}");
            ExitCode::FAILURE
        }
    }
}

fn run() -> Result<(), Failure> {
    let mut arguments = std::env::args().skip(1);
    let (mut images, mut target, mut out, mut program) = (Vec::new(), None, None, None);
    let mut toolchain = Vec::new();
    let mut singly = false;
    while let Some(name) = arguments.next() {
        let mut value = || arguments.next().ok_or(USAGE);
        match name.as_str() {
            "--image" => images.push(PathBuf::from(value()?)),
            "--target" => target = Some(value()?),
            "--out" => out = Some(PathBuf::from(value()?)),
            "--program" => program = Some(value()?),
            "--toolchain" => {
                let pair = value()?;
                let (key, value) = pair.split_once('=').ok_or(USAGE)?;
                toolchain.push((key.to_owned(), value.to_owned()));
            }
            "--one-at-a-time" => singly = true,
            "--compare" => return report::compare(value()?.as_ref(), value()?.as_ref()),
            _ => return Err(USAGE.into()),
        }
    }
    let (false, Some(target)) = (images.is_empty(), target) else { return Err(USAGE.into()) };
    let (target, mut host) = (target::find(&target)?, Host::default());
    kernel::run_all(&mut host);
    match (kernel::own_part(), out) {
        (Some(own), out) => {
            let part = measure_part(&images, &target, (&host, &own), program.as_deref(), singly)?;
            part.print();
            program.zip(out).map_or(Ok(()), |(_, out)| report::merge_part(&out, part))
        }
        (None, Some(out)) => measure(&images, &target, &host, &out, toolchain, singly),
        (None, None) => Err(USAGE.into()),
    }
}

/// What the calls of images took.
#[derive(Default)]
struct Measured {
    records: Vec<Record>,
    counts: Vec<calls::Counts>,
    stack: Vec<usize>,
    /// The emulator's name.
    emulator: String,
}

fn measure(
    images: &[PathBuf],
    target: &target::Target,
    host: &Host,
    out: &Path,
    toolchain: Vec<(String, String)>,
    singly: bool,
) -> Result<(), Failure> {
    let start = Instant::now();
    let all = Measured::of(images, target, host, singly)?;
    if all.records.len() != host.records.len() {
        let (found, known) = (all.records.len(), host.records.len());
        return Err(format!("the images make {found} groups of calls, not the host's {known}").into());
    }
    let seconds = start.elapsed().as_secs_f64();
    let measured = report::Target::new(target, &all.records, &all.counts, &all.stack)?;
    println!(
        "{}: {} groups of calls, every checksum as on the host; {:.1} million instructions in {seconds:.0} s",
        target.name,
        all.records.len(),
        all.counts.iter().map(|c| c.total()).sum::<u64>() as f64 / 1e6,
    );
    report::merge(out, measured, toolchain, &all.emulator)
}

/// The costs of the user's own part.
fn measure_part(
    images: &[PathBuf],
    target: &target::Target,
    (host, own): (&Host, &kernel::OwnPart),
    program: Option<&str>,
    singly: bool,
) -> Result<part::Part, Failure> {
    let all = Measured::of(images, target, host, singly)?;
    let names = (program.unwrap_or("the part"), target.name);
    part::Part::new(names, own, &all.records, (&all.counts, &all.stack), &host.kinds)
}

impl Measured {
    /// The calls of all images.
    fn of(images: &[PathBuf], target: &target::Target, host: &Host, singly: bool) -> Result<Self, Failure> {
        let mut all = Self::default();
        for image in images {
            all.add(target, image, &host.records, singly)?;
        }
        Ok(all)
    }

    /// Adds the calls that are in this image, of those that the host makes.
    fn add(
        &mut self,
        target: &target::Target,
        image: &Path,
        host: &[Record],
        singly: bool,
    ) -> Result<(), Failure> {
        let symbols = symbols::read(image)?;
        let records: Vec<Record> =
            host.iter().filter(|call| symbols.contains_key(call.symbol)).copied().collect();
        let mut walk = calls::Walk::new(&records, &symbols)?;
        let (printed, emulator) = emulator::run(target, image, singly, |executed| walk.step(executed))?;
        self.counts.extend(walk.finish()?);
        self.stack.extend(report::check(&records, &printed)?);
        self.records.extend(records);
        self.emulator = emulator;
        Ok(())
    }
}
