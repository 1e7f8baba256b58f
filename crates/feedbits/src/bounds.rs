//! The costs that several numbers make together: each is computed before the work, and refused by its figures and by the key or
//! option to change. Each number for itself is within its domain.

use anyhow::{Result, bail};
use domains::shown;
use format_compare::{LeastPeriods, MOST_PERIODS, Options, Problem};

/// Windows that a path is planned through, at most: each is a plan of its own.
const MOST_WINDOWS: f64 = 1e6;
/// Periods of test vectors, at most.
const MOST_VECTORS: f64 = 1e5;
/// Pieces that a path may always be cut into, besides one for each span.
const PIECES: f64 = 65_536.0;
/// Pieces that it may be cut into if they are as long as they are by default.
const MOST_PIECES: f64 = 1_048_576.0;

/// Refuses a problem that takes more periods or windows than can be planned, before it is.
pub(crate) fn expect_an_end<const D: usize>(problem: &Problem<D>, options: &Options) -> Result<()> {
    let least = LeastPeriods::of(problem, options.end_feeds_mm_per_s);
    if least.are_too_many() {
        bail!("{}: {least}: expected at most {MOST_PERIODS}", problem.name);
    }
    let Some(window) = options.window_mm else { return Ok(()) };
    let windows = spans(problem).map(|(length, _)| length).sum::<f64>() / window;
    if windows > MOST_WINDOWS {
        bail!(
            "--window {}: the path has {windows:.3e} of them: expected at most {MOST_WINDOWS}, by a greater --window",
            shown(window)
        );
    }
    Ok(())
}

/// Refuses a problem whose path takes more pieces than can be compiled.
pub(crate) fn expect_few_pieces<const D: usize>(problem: &Problem<D>, options: &Options) -> Result<()> {
    let (pieces, most) = (pieces(problem, options.piece_length_mm), most_pieces(problem));
    if pieces > most {
        bail!(
            "--piece-length {}: the path takes {pieces:.3e} pieces: expected at most {most:.0}, by a greater --piece-length or a \
             shorter path",
            shown(options.piece_length_mm)
        );
    }
    Ok(())
}

/// Refuses a problem with more periods than test vectors are written for.
pub(crate) fn expect_few_vectors<const D: usize>(problem: &Problem<D>, options: &Options) -> Result<()> {
    let least = LeastPeriods::of(problem, options.end_feeds_mm_per_s);
    if least.periods > MOST_VECTORS {
        bail!(
            "{}: {least}: expected at most {MOST_VECTORS} with --vectors, of which each takes some kilobytes",
            problem.name
        );
    }
    Ok(())
}

/// The pieces of this length that a path takes, about: its length is that of its control polygons.
fn pieces<const D: usize>(problem: &Problem<D>, length_mm: f64) -> f64 {
    spans(problem).map(|(length, spans)| spans.max(length / length_mm)).sum()
}

/// The pieces that a path may be cut into.
fn most_pieces<const D: usize>(problem: &Problem<D>) -> f64 {
    let by_default = pieces(problem, Options::default().piece_length_mm).min(MOST_PIECES);
    spans(problem).map(|(_, spans)| spans).sum::<f64>() + by_default.max(PIECES)
}

/// The length of the control polygon of each curve, in mm, and the number of its spans, at most.
fn spans<const D: usize>(problem: &Problem<D>) -> impl Iterator<Item = (f64, f64)> {
    problem.curves.iter().map(|curve| {
        let legs = curve.control_points().windows(2);
        let legs = legs.map(|leg| (0..D).map(|d| (leg[1][d] - leg[0][d]).powi(2)).sum::<f64>().sqrt());
        (legs.sum(), (curve.control_points().len() - curve.degree()) as f64)
    })
}
