//! Work that need not be fast, compiled for three backends in place of one for each format: f32, f64 and the run-time
//! format, whose every operation gives the bits of the fixed-point format that it stands for.

use crate::{Backend, FormatName, RuntimeFixed, RuntimeFormat};

/// Work in the numbers of one format.
pub trait Work {
    /// The result.
    type Output;

    /// Does the work in the numbers `R`.
    fn in_backend<R: Backend>(self) -> Self::Output;
}

/// Does `work` in the format of this name. Fixed point of every kind is the run-time format's, in force in `SLOT` meanwhile.
///
/// ```
/// use real::{Backend, FormatName, Work, in_few_backends};
///
/// struct Third;
/// impl Work for Third {
///     type Output = f64;
///     fn in_backend<R: Backend>(self) -> f64 {
///         R::from_ratio(1, 3).to_f64()
///     }
/// }
/// assert_eq!(in_few_backends::<0, _>(FormatName::fixed(2, 4), Third), 5.0 / 16.0);
/// ```
pub fn in_few_backends<const SLOT: usize, W: Work>(format: FormatName, work: W) -> W::Output {
    let at_run_time = match format {
        FormatName::Float { bits: 32 } => return work.in_backend::<f32>(),
        FormatName::Fixed { .. } => RuntimeFormat::of(format),
        _ => None,
    };
    match at_run_time {
        Some(format) => format.run::<SLOT, _>(|| work.in_backend::<RuntimeFixed<SLOT>>()),
        None => work.in_backend::<f64>(),
    }
}
