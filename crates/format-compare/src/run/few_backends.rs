//! Work that need not be fast, compiled for three backends in place of one for each format: f32, f64 and the run-time
//! format, whose every operation gives the bits of the fixed-point format that it stands for.

use real::{Backend, FormatName, RuntimeFixed, RuntimeFormat};

/// Work in the numbers of one format.
pub(crate) trait Work {
    /// The result.
    type Output;

    /// Does the work in the numbers `R`.
    fn in_backend<R: Backend>(self) -> Self::Output;
}

/// Does `work` in the format of this name. Fixed point of every kind is the run-time format's.
pub(crate) fn in_format_named<W: Work>(format: FormatName, work: W) -> W::Output {
    let at_run_time = match format {
        FormatName::Float { bits: 32 } => return work.in_backend::<f32>(),
        FormatName::Fixed { .. } => RuntimeFormat::named(&format.to_string()),
        _ => None,
    };
    match at_run_time {
        Some(format) => format.run::<1, _>(|| work.in_backend::<RuntimeFixed<1>>()),
        None => work.in_backend::<f64>(),
    }
}
