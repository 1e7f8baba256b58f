//! A part for a controller: path and plan in one format, as a file of sections that is read through a small buffer.

use std::{fmt, io};

use real::Backend;
use secant_interp::{CompiledPath, NoStream, PathStream, Rate, StreamHeader, StreamOverride, StreamedRun};

use crate::refusal::Refusal;
use crate::run::constants::run;
use crate::run::job::Job;
use crate::run::on_pieces;

/// Where a stream goes, and what reads it.
pub struct StreamRequest<'a> {
    /// Bytes of the buffer that a section must fit, if they are known.
    pub buffer: Option<usize>,
    /// The file.
    pub to: &'a mut dyn io::Write,
}

/// Why there is no stream, or no whole one.
#[derive(Debug)]
#[non_exhaustive]
pub enum StreamFailure {
    /// The part is refused, and nothing is written.
    Refused(Refusal),
    /// The file cannot be written.
    Write(io::Error),
}

impl fmt::Display for StreamFailure {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Refused(refusal) => refusal.fmt(f),
            Self::Write(error) => error.fmt(f),
        }
    }
}

impl std::error::Error for StreamFailure {}

impl From<Refusal> for StreamFailure {
    fn from(refusal: Refusal) -> Self {
        Self::Refused(refusal)
    }
}

impl From<io::Error> for StreamFailure {
    fn from(error: io::Error) -> Self {
        Self::Write(error)
    }
}

/// Compiles the part and its plan, runs the result, and writes it, once everything is known to fit. The plan must rest at
/// each gap of the part. With overrides among the options, the file says how fast the rate may change.
pub(crate) fn stream<R: Backend, const D: usize>(
    job: &Job<'_, D>,
    request: &mut StreamRequest<'_>,
) -> Result<StreamHeader, StreamFailure> {
    let path = on_pieces::compiled::<R, D>(job)?;
    let (periods, checksum) = run(&path.interpolator(), path.sections(), job.most_periods())?;
    let overrides = job.options.overrides.as_ref().map(|commands| StreamOverride {
        feeds: commands.feeds,
        commanded: Rate::of(commands.commanded_share()),
    });
    let streamed = StreamedRun {
        period_s: job.problem.period_s(),
        periods: periods as u64,
        checksum,
        feed_override: overrides,
    };
    let stream = PathStream::new(&path, &streamed).map_err(|error| match error {
        NoStream::NoWord(format) => Refusal::NoType(format),
        other => Refusal::Stream(other),
    })?;
    let longest = stream.section_bytes().enumerate().max_by_key(|(_, bytes)| *bytes);
    let buffer = request.buffer.unwrap_or(usize::MAX);
    if let Some((section, bytes)) = longest
        && usize::try_from(bytes).is_ok_and(|bytes| bytes > buffer)
    {
        let (part, lines) = (job.problem.name.clone(), lines(job, &path, section));
        return Err(Refusal::SectionTooLong { part, lines, section, bytes, buffer }.into());
    }
    stream.write(request.to)?;
    Ok(*stream.header())
}

/// The lines of the part at which a section begins and ends; `None` if the lines are unknown.
fn lines<R: Backend, const D: usize>(
    job: &Job<'_, D>,
    path: &CompiledPath<R, D>,
    section: usize,
) -> Option<(usize, usize)> {
    let pieces = path.sections().get(section)?.pieces.clone();
    let places = path.table().places().get(pieces)?;
    let line = |curve: usize| job.problem.lines.get(curve).copied();
    Some((line(places.first()?.curve)?, line(places.last()?.curve)?))
}
