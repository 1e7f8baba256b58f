//! Paper C's first section: interpolation by (2) with the feed of (3) and (4), without look-ahead.

use feed_plan::chord_feedrate;
use nurbs_core::{Differentiate, Evaluate, NurbsBuf, radius};

/// One period.
pub(crate) struct AdaptiveStep {
    /// Feed, in mm/s.
    pub(crate) feed_mm_per_s: f64,
    /// Chord error by the radius at the start of the step, in mm: (3) solved for δ.
    pub(crate) chord_error_mm: f64,
}

/// The most periods of a run.
const MOST_STEPS: usize = 100_000;

/// Runs a curve at min(`feedrate`, V(u)) from its begin to its end, starting at that feed: u_{i+1} by (2) in its corrected form,
/// `u + vT/|C'| - (vT)² (C'·C'')/(2|C'|⁴)`.
pub(crate) fn adaptive_feed(
    curve: &NurbsBuf<f64, 2>,
    feedrate: f64,
    chord_error: f64,
    period: f64,
) -> Vec<AdaptiveStep> {
    let curve = curve.as_curve();
    let (mut u, end) = curve.domain();
    let mut steps = Vec::new();
    while u < end && steps.len() < MOST_STEPS {
        let here = curve.derivatives(u);
        let rho = radius(&here);
        let feed = feedrate.min(chord_feedrate(rho, chord_error, period));
        let half = 0.5 * feed * period;
        // ρ - √(ρ² - h²), without cancellation.
        let off = half * half / (rho + (rho * rho - half * half).max(0.0).sqrt());
        steps.push(AdaptiveStep { feed_mm_per_s: feed, chord_error_mm: if rho < 1e9 { off } else { 0.0 } });
        u += taylor_step(here.first, here.second, feed * period, -1.0);
    }
    steps
}

/// The step in u for a length s by (2), with the sign of its second-order term: -1 as it follows, 1 as it is printed.
pub(crate) fn taylor_step(first: [f64; 2], second: [f64; 2], s: f64, sign: f64) -> f64 {
    let square = first[0] * first[0] + first[1] * first[1];
    let product = first[0] * second[0] + first[1] * second[1];
    s / square.sqrt() + sign * s * s * product / (2.0 * square * square)
}
