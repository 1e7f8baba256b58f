//! `trace`: runs a firmware image in QEMU and counts its instructions, every one.
//!
//! | step | where |
//! |---|---|
//! | the emulator's stream of executed instructions | [`emulator`] |
//! | addresses of the kernels in the image | [`symbols`] |
//! | what kind of instruction each is | [`instruction`] |
//! | which instructions belong to which call | [`calls`] |
//! | cycles by a processor manual's table | [`cycles`] |
//! | the data file and the table in the documentation | [`report`] |
//!
//! `trace --image IMAGE [--image IMAGE] --target NAME --out FILE.toml` measures one target, whose formats may lie in several
//! images, and fails when a checksum is not the host's;
//! `trace` built with the feature `part` prints the counts of the user's own part beside those of paper A in FILE.toml;
//! `trace --render FILE.toml DOCUMENT.md` writes the table of all targets in the file.

mod calls;
mod cycles;
mod emulator;
mod instruction;
mod report;
mod symbols;
mod target;

use std::path::{Path, PathBuf};
use std::process::ExitCode;
use std::time::Instant;

use kernel::{Board, Record};

/// An error that the user is to read.
type Failure = Box<dyn std::error::Error>;

/// The host's own run of the same calls.
#[derive(Default)]
struct Host(Vec<Record>);

impl Board for Host {
    fn paint_stack(&mut self) {}
    fn used_stack(&mut self) -> usize {
        0
    }
    fn record(&mut self, record: Record) {
        self.0.push(record);
    }
}

const USAGE: &str = "usage: trace --image IMAGE... --target NAME --out FILE.toml [--toolchain KEY=VALUE]... [--one-at-a-time]\n       \
                     trace --render FILE.toml DOCUMENT.md\n       \
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
    let (mut images, mut target, mut out) = (Vec::new(), None, None);
    let mut toolchain = Vec::new();
    let mut singly = false;
    while let Some(name) = arguments.next() {
        let mut value = || arguments.next().ok_or(USAGE);
        match name.as_str() {
            "--image" => images.push(PathBuf::from(value()?)),
            "--target" => target = Some(value()?),
            "--out" => out = Some(PathBuf::from(value()?)),
            "--toolchain" => {
                let pair = value()?;
                let (key, value) = pair.split_once('=').ok_or(USAGE)?;
                toolchain.push((key.to_owned(), value.to_owned()));
            }
            "--one-at-a-time" => singly = true,
            "--render" => return report::render(value()?.as_ref(), value()?.as_ref()),
            "--compare" => return report::compare(value()?.as_ref(), value()?.as_ref()),
            _ => return Err(USAGE.into()),
        }
    }
    let (false, Some(target), Some(out)) = (images.is_empty(), target, out) else { return Err(USAGE.into()) };
    measure(&images, &target, &out, toolchain, singly)
}

/// What the calls of images took.
#[derive(Default)]
struct Measured {
    records: Vec<Record>,
    counts: Vec<calls::Counts>,
    stack: Vec<usize>,
}

fn measure(
    images: &[PathBuf],
    name: &str,
    out: &Path,
    toolchain: Vec<(String, String)>,
    singly: bool,
) -> Result<(), Failure> {
    let target = target::find(name)?;
    let mut host = Host::default();
    kernel::run_all(&mut host);
    let (mut all, mut emulator) = (Measured::default(), String::new());
    let start = Instant::now();
    for image in images {
        emulator = all.add(&target, image, &host.0, singly)?;
    }
    if let Some(part) = kernel::own_part() {
        return report::own_part(name, &part, &all.records, (&all.counts, &all.stack), out);
    }
    if all.records.len() != host.0.len() {
        let (found, known) = (all.records.len(), host.0.len());
        return Err(format!("the images make {found} groups of calls, not the host's {known}").into());
    }
    let seconds = start.elapsed().as_secs_f64();
    let measured = report::Target::new(&target, &all.records, &all.counts, &all.stack)?;
    println!(
        "{name}: {} groups of calls, every checksum as on the host; {:.1} million instructions in {seconds:.0} s",
        all.records.len(),
        all.counts.iter().map(|c| c.total()).sum::<u64>() as f64 / 1e6,
    );
    report::merge(out, measured, toolchain, &emulator)
}

impl Measured {
    /// Adds the calls that are in this image, of those that the host makes; returns the emulator's name.
    fn add(
        &mut self,
        target: &target::Target,
        image: &Path,
        host: &[Record],
        singly: bool,
    ) -> Result<String, Failure> {
        let symbols = symbols::read(image)?;
        let records: Vec<Record> =
            host.iter().filter(|call| symbols.contains_key(call.symbol)).copied().collect();
        let mut walk = calls::Walk::new(&records, &symbols)?;
        let (printed, emulator) = emulator::run(target, image, singly, |executed| walk.step(executed))?;
        self.counts.extend(walk.finish()?);
        self.stack.extend(report::check(&records, &printed)?);
        self.records.extend(records);
        Ok(emulator)
    }
}
