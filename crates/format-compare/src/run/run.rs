//! A run: its setpoints, and the resolution of the numbers in which it was made.

use feed_plan::Lead;
use real::{Audit, Backend, Extremes, FormatName};

/// One setpoint, exactly as the format holds it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct RunStep {
    /// Index of the curve.
    pub curve: usize,
    /// The parameter, as a sum of two floats.
    pub u: (f64, f64),
    /// The commanded point, in mm.
    pub point_mm: [f64; 3],
    /// The chord that the plan wanted, in mm, as a sum of two floats.
    pub wanted_mm: (f64, f64),
    /// The planned feed at the end of the period, in mm/s; with an override, the mean over the period.
    pub feed_mm_per_s: f64,
    /// Evaluations of the curve.
    pub evaluations: u32,
}

/// A run from the start of a path to its end, with all its steps.
#[derive(Clone, Debug, Default)]
pub struct Run {
    /// The setpoints, one for each period.
    pub steps: Vec<RunStep>,
    /// What is known of it beside its steps.
    pub about: AboutRun,
}

/// A run without its steps.
#[derive(Clone, Debug, Default)]
pub struct AboutRun {
    /// Whether the last setpoint is the path's end.
    pub finished: bool,
    /// Periods that the plan takes; the run may take more or fewer when rounding delays or hastens it.
    pub planned_periods: u64,
    /// The step between two neighbouring commanded points, in mm; for a float, at the largest coordinate.
    pub resolution_mm: f64,
    /// The step between two neighbouring positions of a printer's filament where it is furthest from 0, in mm. For a
    /// fixed-point format, the range is doubled until it holds that position.
    pub filament_step_mm: Option<f64>,
    /// The fluctuation that comes from rounding the solved quantity alone: half a unit in its last place over the step.
    /// On the global parameter it is `½ ulp(u)/(u_{i+1} - u_i)`, the largest over the steps at cruise. On pieces it is
    /// `½ ulp(L)/L` for the full step `L = F·T`, since the parameter there is a 64-bit phase and the length is the
    /// coarser of the two. Other roundings of a step add to it.
    pub fluctuation_resolution: f64,
    /// By how much a run by the chords that were planned is ahead of the plan along the path, in mm, in f64; `None` if the feed is overridden
    /// or the plan sees a window alone.
    pub lead: Option<Lead<f64>>,
    /// The numbers that the format's arithmetic lost, and the range of all its signals.
    pub extremes: Extremes,
    /// The signals by name, if they are wanted ([`Observer::wants_signals`](crate::Observer::wants_signals)).
    pub audit: Option<Audit>,
}

/// The step between neighbouring numbers of `R` at the magnitude of `largest`.
pub(crate) fn resolution_at<R: Backend>(largest: f64) -> f64 {
    match R::name() {
        FormatName::Fixed { .. } => R::resolution().to_f64(),
        _ => R::resolution().to_f64() * largest,
    }
}

/// The step between neighbouring positions at `farthest_mm` from 0, in mm. For a fixed-point format it is the
/// resolution, doubled until that position is in range.
pub(crate) fn own_step_mm<R: Backend>(farthest_mm: f64) -> f64 {
    match R::name() {
        FormatName::Fixed { .. } => {
            let doublings = (farthest_mm / R::max_value().to_f64()).log2().ceil();
            R::resolution().to_f64() * doublings.max(0.0).exp2()
        }
        _ => unit_in_last_place::<R>(farthest_mm),
    }
}

/// The distance of `value` from the next larger number of `R`.
pub(crate) fn unit_in_last_place<R: Backend>(value: f64) -> f64 {
    match R::name() {
        FormatName::Fixed { .. } => R::resolution().to_f64(),
        _ => R::resolution().to_f64() * value.abs().log2().floor().exp2(),
    }
}
